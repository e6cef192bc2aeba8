"""Components kept outside of the package: a Python file whose classes register themselves when it is run."""

from __future__ import annotations

import sys
import traceback
from hashlib import sha256
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

from .component import REGISTRY
from .errors import FanfoldError
from .regular import content


class PluginError(FanfoldError):
    """A plugin that cannot be loaded, with file, line and what is wrong."""


class _Loaded(NamedTuple):
    digest: str
    kinds: frozenset[str]


_loaded: dict[Path, _Loaded] = {}


def load_plugin(path: str | Path) -> frozenset[str]:
    """Run a Python file once, again where it has changed, and return the kinds of components that it has.

    PluginError where it cannot be read or run, or has a kind that there is already.
    """
    path = Path(path).resolve()
    try:
        text = content(path)
    except OSError as error:
        raise PluginError(f"{path}: the plugin cannot be read ({error.strerror})") from None
    digest, before = sha256(text).hexdigest(), _loaded.get(path)
    if before is not None and before.digest == digest:
        return before.kinds
    for kind in before.kinds if before is not None else ():
        REGISTRY.pop(kind, None)
    others = dict(REGISTRY)
    try:
        _run(path, text, digest)
    except BaseException as error:
        REGISTRY.clear()
        REGISTRY.update(others)
        _loaded.pop(path, None)
        if not isinstance(error, Exception | SystemExit):
            raise
        raise PluginError(f"{path}{line_in(path, error)}: {type(error).__name__}: {error}") from None
    _loaded[path] = _Loaded(digest, frozenset(REGISTRY.keys() - others.keys()))
    return _loaded[path].kinds


def loaded_plugins() -> dict[Path, str]:
    """Files that this process has loaded, and the SHA-256 of their content, in hexadecimal digits."""
    return {path: known.digest for path, known in _loaded.items()}


def _run(path: Path, text: bytes, digest: str) -> None:
    name = f"fanfold_plugin_{path.stem}_{digest[:12]}"
    module = sys.modules[name] = ModuleType(name)
    module.__file__ = str(path)
    try:
        # the content that the digest is of: a loader may take a __pycache__ in its place, which others can send too
        exec(compile(text, str(path), "exec"), module.__dict__)
    except BaseException:
        del sys.modules[name]
        raise


def line_in(path: Path, error: BaseException) -> str:
    """The last line of the file that led to an error, with a colon before it; empty where none did."""
    if isinstance(error, SyntaxError) and error.filename == str(path):
        return f":{error.lineno}"
    lines = [
        frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(path)
    ]
    return f":{lines[-1]}" if lines else ""
