"""What may be loaded of the files that scenes and results name.

Programs where someone trusts them; data of results where a scene has named them on this computer, or someone says so.
Trust is remembered among the files of the cache: of a program by its content, so that a changed one is asked for again,
of data by their path.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from hashlib import sha256
from pathlib import Path

from components.cache.disk import is_kept, kept
from components.contract.plugins import loaded_plugins
from components.contract.regular import content_digest

_GROUP = "trusted"
_remembered: set[str] = set()


def is_program(file: str) -> bool:
    """Whether a plugin is run; others are read."""
    return file.endswith(".py")


def trust_programs(files: Iterable[str]) -> None:
    """Remember that plugins with the content of these files may run."""
    for file in filter(is_program, files):
        if digest := _digest(file):
            _remember(digest)


def trust_data(files: Iterable[str]) -> None:
    """Remember that results may open these files."""
    for file in files:
        _remember(_of_path(file))


def refused_programs(files: Collection[str], accepted: Collection[str]) -> list[str]:
    """Plugins of a scene that nobody trusts; `accepted` are paths that whoever runs it has accepted."""
    return [file for file in files if is_program(file) and file not in accepted and not _is_trusted(file)]


def is_absent(file: str) -> bool:
    """Whether a program cannot be read."""
    return is_program(file) and _digest(file) is None


def _is_trusted(file: str) -> bool:
    """Whether the content may run, or was loaded already."""
    digest = _digest(file)
    # of one that cannot be read there is nothing to run, and loading it says so
    return digest is None or digest in loaded_plugins().values() or _is_remembered(digest)


def _digest(file: str) -> str | None:
    """Of the content; None where it cannot be read."""
    try:
        return content_digest(Path(file))
    except OSError:
        return None


def missing_programs(files: Collection[str]) -> list[str]:
    """Plugins of whose name no file is loaded."""
    names = {path.name for path in loaded_plugins()}
    return [file for file in files if is_program(file) and Path(file).name not in names]


def refused_data(files: Iterable[str]) -> Iterator[str]:
    """Files of data that no scene has opened here."""
    return (file for file in files if not _is_remembered(_of_path(file)))


def _of_path(file: str) -> str:
    return sha256(f"path {file}".encode(errors="surrogateescape")).hexdigest()


def _remember(key: str) -> None:
    if key not in _remembered:
        _remembered.add(key)
        kept(_GROUP, key, lambda: b"")


def _is_remembered(key: str) -> bool:
    return key in _remembered or is_kept(_GROUP, key)
