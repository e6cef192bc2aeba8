"""What a PythonFMU carries: PythonFMU's binaries around the adapter and the component's own modules.

It needs Python, NumPy and SciPy, but no Fanfold. PythonFMUs in one process share every module of the same name, so
the code goes into a package whose name carries the digest of that code: equal code is shared on purpose, different
code never meets. Only modules that the component reaches by its imports are copied, with the imports between our
packages made relative.
"""

from __future__ import annotations

import ast
import inspect
import io
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
import pythonfmu
from numpy.typing import NDArray

import components
from components import Component, ComponentError

from ..archive import digest_of, zip_bytes
from . import slave
from .slave import ARRAY_KEY, ARRAYS_FILE, COMPONENT_FILE, TUPLE_KEY

_COMPONENTS = Path(components.__file__).resolve().parent
_PYTHONFMU = Path(pythonfmu.__file__).parent
_CONTRACT = "contract.component"
_IMPORT = re.compile(r"^(\s*from\s+)components(\.[\w.]+)?(\s+import\b)", re.MULTILINE)

_ENTRY = '''"""Entry point of an FMU of the component {kind!r}, run by PythonFMU for every instance."""

from {package}.adapter.slave import ComponentSlave, own_once_more
from {package}.{module} import {name} as component

own_once_more(globals())  # PythonFMU gives up a reference to them whenever it makes an instance


class Slave(ComponentSlave):
    """Slave of {name}."""

    component_class = component
'''


def python_code(component: Component, name: str) -> dict[str, bytes]:
    """Code of a PythonFMU and PythonFMU's own files, by their path in it."""
    package, code = bundle(type(component))
    resources = {**code, "slavemodule.txt": f"{package}_entry".encode()}
    return {**{f"resources/{path}": data for path, data in resources.items()}, **_binaries(name)}


def python_data(component: Component, starts: Sequence[float]) -> dict[str, bytes]:
    """What the adapter builds the component from, by its path in a PythonFMU."""
    arrays: dict[str, NDArray[Any]] = {}
    structure = pack_value(dict(component.structure), arrays)
    content = {"kind": component.kind, "structure": structure, "start": list(starts)}
    resources = {f"resources/{COMPONENT_FILE}": (json.dumps(content, indent=1) + "\n").encode()}
    if arrays:
        stored = {}
        for key, array in arrays.items():
            buffer = io.BytesIO()
            np.lib.format.write_array(buffer, array, allow_pickle=False)
            stored[f"{key}.npy"] = buffer.getvalue()
        resources[f"resources/{ARRAYS_FILE}"] = zip_bytes(stored)
    return resources


def pack_value(value: Any, arrays: dict[str, NDArray[Any]]) -> Any:  # noqa: ANN401 - any structure value
    """A structure value as JSON data; NumPy arrays go to `arrays` and leave their key behind."""
    if isinstance(value, np.ndarray) and value.dtype != object:
        key = f"a{len(arrays)}"
        arrays[key] = value
        return {ARRAY_KEY: key}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, dict):
        for key in value:
            if not isinstance(key, str) or key in (ARRAY_KEY, TUPLE_KEY):
                raise ComponentError(f"a dictionary key of the structure is {key!r}; it must be a string")
        return {key: pack_value(item, arrays) for key, item in value.items()}
    if isinstance(value, list | tuple):
        packed = [pack_value(item, arrays) for item in value]
        return {TUPLE_KEY: packed} if isinstance(value, tuple) else packed
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise ComponentError(
        f"the structure holds a {type(value).__name__}; it must be a number, a string, a tuple, list or "
        "dictionary of those, or a NumPy array"
    )


@cache
def bundle(component_class: type[Component]) -> tuple[str, Mapping[str, bytes]]:
    """Name of the package that holds the code of an FMU, and its files with the entry module beside it."""
    source = Path(inspect.getfile(component_class)).resolve()
    inside = source.is_relative_to(_COMPONENTS)
    module = f"{'components' if inside else 'extra'}.{source.stem}"
    adapter = Path(slave.__file__)
    sources = {"adapter/slave.py": adapter.read_text(encoding="utf-8")}
    if not inside:
        sources[f"extra/{source.stem}.py"] = source.read_text(encoding="utf-8")
    wanted = [source.stem] if inside else _imported_components(source)
    for path in _reachable([*_imported_components(adapter), *wanted]):
        name = path.relative_to(_COMPONENTS).as_posix()
        sources[f"components/{name}"] = path.read_text(encoding="utf-8")
    for folder in {parent for path in sources for parent in PurePosixPath(path).parents}:
        sources.setdefault((folder / "__init__.py").as_posix(), "")
    files = {path: _relative(text).encode() for path, text in sources.items()}
    names = {"kind": component_class.kind, "module": module, "name": component_class.__name__}
    entry = _ENTRY.format(package="{package}", **names).encode()
    package = f"fanfold_{digest_of({**files, 'entry': entry})[:16]}"
    code = {f"{package}/{path}": data for path, data in files.items()}
    code[f"{package}_entry.py"] = entry.replace(b"{package}", package.encode())
    return package, code


def _reachable(names: Iterable[str]) -> list[Path]:
    """Modules of the package `components` that the named ones import, directly or not, and these."""
    found: dict[str, Path] = {}
    waiting = list(names)
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name] = _file_of(name)
            waiting.extend(_imported_components(found[name]))
    return [found[name] for name in sorted(found)]


def _file_of(name: str) -> Path:
    """The file of a module of `components`, by its dotted name in it; its folder's own file for a package."""
    path = _COMPONENTS.joinpath(*name.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def _imported_components(source: Path) -> list[str]:
    """Dotted names in `components` of the modules that a file imports; an error for forms that cannot be moved."""
    names: list[str] = []
    for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import) and any(a.name.partition(".")[0] == "components" for a in node.names):
            raise ComponentError(
                f"{source.name}: write 'from components import ...', not 'import components'"
            )
        if not isinstance(node, ast.ImportFrom):
            continue
        imported = node.module.split(".") if node.module else []
        if node.level:
            names.extend(_modules(_start(source, node.level) + imported, node))
        elif imported[0] == "components":
            names.extend(_modules(imported[1:], node) if imported[1:] else [_CONTRACT])
    return names


def _start(source: Path, level: int) -> list[str]:
    """Folders in `components` from which a relative import of a file counts."""
    source = source.resolve()
    folders = list(source.relative_to(_COMPONENTS).parent.parts) if source.is_relative_to(_COMPONENTS) else []
    if level > len(folders) + source.is_relative_to(_COMPONENTS):
        raise ComponentError(f"{source.name} imports from its own package; it must be one file")
    return folders[: len(folders) - level + 1]


def _modules(path: list[str], node: ast.ImportFrom) -> list[str]:
    """Modules that one import needs: the one named and the packages around it, or modules of the package named."""
    around = [".".join(path[:k]) for k in range(1, len(path) + 1)]
    within = [".".join((*path, alias.name)) for alias in node.names]
    return [*around, *(name for name in within if _file_of(name).exists())]


def _relative(source: str) -> str:
    """Source with imports from `components` as they are within the package that an FMU carries."""
    return _IMPORT.sub(lambda m: f"{m[1]}..components{m[2] or '.' + _CONTRACT}{m[3]}", source)


@cache
def _wrapper() -> dict[str, bytes]:
    """PythonFMU itself: its Python files, and its binaries by platform folder."""
    files = {f"pythonfmu/{path.name}": path for path in sorted(_PYTHONFMU.glob("*.py"))}
    binaries = _PYTHONFMU / "resources" / "binaries"
    for path in sorted(binaries.rglob("*")):
        if path.suffix in (".so", ".dll", ".dylib"):
            files[f"binaries/{path.relative_to(binaries).parent.as_posix()}/*{path.suffix}"] = path
    return {name: path.read_bytes() for name, path in files.items()}


def _binaries(model_identifier: str) -> dict[str, bytes]:
    """PythonFMU's files by their path in an FMU."""
    return {
        path.replace("*", model_identifier) if path.startswith("binaries/") else f"resources/{path}": data
        for path, data in _wrapper().items()
    }
