"""Write a component as an FMU, native or with Python inside.

A native FMU is the compiled library of all components and the data of one; it needs nothing else. A PythonFMU
is PythonFMU's binaries around the adapter and the component's own modules, and needs Python, NumPy and SciPy,
but no Fanfold. PythonFMUs in one process share every module of the same name, so the code goes into a package
whose name carries the digest of that code: equal code is shared on purpose, different code never meets. Only
modules that the component reaches by its imports are copied, with the imports between our packages made
relative.
"""

from __future__ import annotations

import ast
import hashlib
import inspect
import io
import json
import os
import re
import shutil
import tempfile
import uuid
import zipfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from datetime import UTC, datetime
from functools import cache
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
import pythonfmu
from fmpy import platform, platform_tuple
from numpy.typing import NDArray

import components
from components import Component, ComponentError

from . import slave
from .description import Backend, FmiVersion, model_description
from .description3 import model_description3, terminals
from .native import library
from .native_data import component_bytes
from .slave import ARRAY_KEY, ARRAYS_FILE, COMPONENT_FILE, TUPLE_KEY
from .sources import source_files
from .variables import StartValue, start_values

_COMPONENTS = Path(components.__file__).resolve().parent
_PYTHONFMU = Path(pythonfmu.__file__).parent
_CONTRACT = "contract.component"
_IMPORT = re.compile(r"^(\s*from\s+)components(\.[\w.]+)?(\s+import\b)", re.MULTILINE)
_EPOCH = (1980, 1, 1, 0, 0, 0)

_ENTRY = '''"""Entry point of an FMU of the component {kind!r}, run by PythonFMU for every instance."""

from {package}.adapter.slave import ComponentSlave, own_once_more
from {package}.{module} import {name} as component

own_once_more(globals())  # PythonFMU gives up a reference to them whenever it makes an instance


class Slave(ComponentSlave):
    """Slave of {name}."""

    component_class = component
'''


def native_backend(component: Component) -> bool:
    """Whether a component can be exported as a native FMU here: compiled at installation, and with a kernel."""
    return library() is not None and component.native_data() is not None


def build_fmu(
    component: Component,
    name: str,
    directory: str | Path | None = None,
    start: Mapping[str, StartValue] | None = None,
    backend: Backend | None = None,
    fmi: FmiVersion = "2.0",
    with_sources: bool = False,
) -> Path:
    """Write `name`.fmu into `directory` and return its path; without a directory, the file in the cache.

    `start` are start values of parameters and inputs by name; wrong ones raise `ComponentError`, as does a
    native FMU where there is none, and FMI 3.0 or sources of a PythonFMU. Without a `backend` it is native where
    possible. `with_sources` adds the C sources, for platforms that this one does not build for; no compiler is
    needed then. Nothing is built when the cache holds an FMU of the same content.
    """
    starts = start_values(component, start or {})
    only_native = fmi == "3.0" or with_sources
    backend = backend or ("native" if only_native or native_backend(component) else "python")
    if only_native and backend == "python":
        raise ComponentError(
            "PythonFMUs are of FMI 2.0 and have no C sources; FMI 3.0 and sources need the native back end"
        )
    code = source_files(name, fmi) if with_sources else {}
    listed = [path.removeprefix("sources/") for path in code if path.endswith(".c")]

    def contents(guid: str, generated: datetime) -> dict[str, bytes]:
        if fmi == "3.0":
            files = _native_files(component, name, starts, guid, platform_tuple, code)
            description = model_description3(component, name, starts, guid, generated)
            if component.ports:
                files["terminalsAndIcons/terminalsAndIcons.xml"] = terminals(component)
        else:
            description = model_description(component, name, starts, guid, generated, backend, listed)
            if backend == "native":
                files = _native_files(component, name, starts, guid, platform, code)
            else:
                files = _python_files(component, name, starts)
        return {**files, "modelDescription.xml": description}

    digest = _digest(contents("", datetime.fromtimestamp(0, UTC)))
    cached = cache_directory() / digest / f"{name}.fmu"
    if not cached.exists():
        component.prepare(np.array(starts[: component.parameter_layout.size]))
        guid = "{" + str(uuid.UUID(bytes=bytes.fromhex(digest[:32]))) + "}"
        _write(cached, lambda path: path.write_bytes(zip_bytes(contents(guid, _now()))))
    if directory is None:
        return cached
    target = Path(directory) / cached.name
    _write(target, lambda path: shutil.copyfile(cached, path))
    return target


def _native_files(
    component: Component,
    name: str,
    starts: Sequence[float],
    guid: str,
    folder: str,
    code: Mapping[str, bytes],
) -> dict[str, bytes]:
    """Library, data and sources of a native FMU, by their path in it; the library's folder names its platform."""
    binary = library()
    if binary is None and not code:
        raise ComponentError(
            "there is no native library here; install with a C compiler, or export PythonFMUs or sources"
        )
    if component.native_data() is None:
        raise ComponentError(f"{component.kind} has no native kernel; export it as a PythonFMU")
    binaries = {} if binary is None else {f"binaries/{folder}/{name}{binary.suffix}": binary.read_bytes()}
    return {**binaries, **code, "resources/component.bin": component_bytes(component, starts, guid)}


def _python_files(component: Component, name: str, starts: Sequence[float]) -> dict[str, bytes]:
    """Code, data and PythonFMU's own files of a PythonFMU, by their path in it."""
    package, code = bundle(type(component))
    resources = {**_resources(component, starts), **code, "slavemodule.txt": f"{package}_entry".encode()}
    return {**{f"resources/{path}": data for path, data in resources.items()}, **_binaries(name)}


def cache_directory() -> Path:
    """FANFOLD_CACHE, else fanfold in XDG_CACHE_HOME, else ~/.cache/fanfold; FMUs stand there by content."""
    if own := os.environ.get("FANFOLD_CACHE"):
        return Path(own)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fanfold"


def _resources(component: Component, starts: Sequence[float]) -> dict[str, bytes]:
    """What the adapter builds the component from."""
    arrays: dict[str, NDArray[Any]] = {}
    structure = pack_value(dict(component.structure), arrays)
    content = {"kind": component.kind, "structure": structure, "start": list(starts)}
    resources = {COMPONENT_FILE: (json.dumps(content, indent=1) + "\n").encode()}
    if arrays:
        stored = {}
        for key, array in arrays.items():
            buffer = io.BytesIO()
            np.lib.format.write_array(buffer, array, allow_pickle=False)
            stored[f"{key}.npy"] = buffer.getvalue()
        resources[ARRAYS_FILE] = zip_bytes(stored)
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
    sources = {"adapter/slave.py": Path(slave.__file__).read_text(encoding="utf-8")}
    if not inside:
        sources[f"extra/{source.stem}.py"] = source.read_text(encoding="utf-8")
    wanted = [_CONTRACT, *([source.stem] if inside else _imported_components(source))]
    for path in _reachable(wanted):
        name = path.relative_to(_COMPONENTS).as_posix()
        sources[f"components/{name}"] = path.read_text(encoding="utf-8")
    for folder in {parent for path in sources for parent in PurePosixPath(path).parents}:
        sources.setdefault((folder / "__init__.py").as_posix(), "")
    files = {path: _relative(text).encode() for path, text in sources.items()}
    names = {"kind": component_class.kind, "module": module, "name": component_class.__name__}
    entry = _ENTRY.format(package="{package}", **names).encode()
    package = f"fanfold_{_digest({**files, 'entry': entry})[:16]}"
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


def zip_bytes(files: Mapping[str, bytes]) -> bytes:
    """A zip archive whose bytes depend on names and contents only."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as archive:
        for name, data in sorted(files.items()):
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data)
    return buffer.getvalue()


def _digest(files: Mapping[str, bytes]) -> str:
    digest = hashlib.sha256()
    for name, data in sorted(files.items()):
        digest.update(f"{name}\0{len(data)}\0".encode())
        digest.update(data)
    return digest.hexdigest()


def _now() -> datetime:
    """Time of generation; SOURCE_DATE_EPOCH fixes it where builds must be reproducible to the byte."""
    fixed = os.environ.get("SOURCE_DATE_EPOCH")
    return datetime.fromtimestamp(int(fixed), UTC) if fixed else datetime.now(UTC)


def _write(target: Path, write: Callable[[Path], object]) -> None:
    """Write a file under a temporary name first, so that others only ever see it complete."""
    target.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}")
    os.close(handle)
    try:
        write(Path(temporary))
        os.chmod(temporary, 0o644)
        os.replace(temporary, target)
    except BaseException:
        os.unlink(temporary)
        raise
