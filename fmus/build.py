"""Write a component as an FMU, native or with Python inside.

A native FMU is the compiled library of all components and the data of one; it needs nothing else. A PythonFMU
is the component's own modules around PythonFMU (`python/bundle.py`). What of it is code is compressed once and kept
in the cache; its data and its model description are small and written every time.
"""

from __future__ import annotations

import os
import uuid
from collections.abc import Callable, Hashable, Mapping, Sequence
from datetime import UTC, datetime
from functools import lru_cache
from pathlib import Path

import numpy as np

from components import Component, ComponentError
from components.cache.disk import kept, replace_file

from .archive import digest_of, zip_bytes
from .compiled import NO_GUID, has_kernel, native_backend
from .description.binaries import folder_here
from .description.choices import Backend, FmiVersion
from .description.documentation import documentation
from .description.fmi2 import DATE_FORMAT, WITHOUT_WORDS, About, Experiment, model_description
from .description.fmi3 import model_description3
from .description.terminals import terminals_of, terminals_xml
from .description.variables import StartValue, start_values
from .native import CompileError, native_library
from .native.binary_data import component_bytes
from .native.platforms import libraries
from .native.source_files import source_files
from .python.bundle import python_code, python_data

_NO_TIME = datetime.fromtimestamp(0, UTC)
_MOST_DESCRIPTIONS = 256
_descriptions: dict[Hashable, bytes] = {}
_MOST_ARCHIVES = 16
"""Of a megabyte and a half; scenes have about a dozen components."""
_archives: dict[str, bytes] = {}


def build_fmu(
    component: Component,
    name: str,
    directory: str | Path,
    start: Mapping[str, StartValue] | None = None,
    backend: Backend | None = None,
    fmi: FmiVersion = "2.0",
    with_sources: bool = False,
    experiment: Experiment | None = None,
    compressed: bool = True,
    platforms: Sequence[str] = (),
    about: About | None = None,
    further: Mapping[str, bytes] | None = None,
) -> Path:
    """Write `name`.fmu into `directory` (made if missing) and return its path.

    `start` are start values of parameters and inputs by name; wrong ones raise `ComponentError`, as does a
    native FMU where there is none, and FMI 3.0 or sources of a PythonFMU. Without a `backend` it is native where
    possible. `experiment` is what a tool runs by default. `with_sources` adds the C sources, for platforms that this
    one does not build for; no compiler is needed then. `platforms`, names of `native.platforms`: libraries of these
    and of no other, in place of the one of here. Not `compressed`: for files that are soon gone. `about`: what people
    read of it, which adds a page of documentation and an icon. `further`: further files, by their path in it.
    """
    starts = start_values(component, start or {})
    only_native = fmi == "3.0" or with_sources or bool(platforms)
    backend = backend or ("native" if only_native or native_backend(component) else "python")
    if only_native and backend == "python":
        raise ComponentError(
            "PythonFMUs are of FMI 2.0 for this platform and have no C sources; FMI 3.0, sources and other platforms "
            "need the native back end"
        )
    sources = source_files(name, fmi) if with_sources else {}
    listed = [path.removeprefix("sources/") for path in sources if path.endswith(".c")]

    if backend == "native":
        code = _native_code(component, name, fmi, sources, platforms)
        data = {"resources/component.bin": component_bytes(component, starts, NO_GUID)}
    else:
        code, data = python_code(component, name), python_data(component, starts)

    def described() -> bytes:
        said = about or WITHOUT_WORDS
        if fmi == "3.0":
            return model_description3(component, name, starts, NO_GUID, _NO_TIME, experiment, said)
        return model_description(
            component, name, starts, NO_GUID, _NO_TIME, backend, listed, experiment, said
        )

    asked = (type(component), name, fmi, backend, tuple(listed), experiment, about, starts, digest_of(data))
    component.prepare(np.array(starts[: component.parameter_layout.size]))
    key = digest_of(code)
    if about is not None:
        data |= documentation(component, name, starts, about, fmi, experiment)
    data |= further or {}
    files = _dated(key, {**data, "modelDescription.xml": _kept_description(asked, described)})
    target = Path(directory) / f"{name}.fmu"
    target.parent.mkdir(parents=True, exist_ok=True)
    if compressed:
        archive = kept("fmu", key, lambda: zip_bytes(code))
        replace_file(target, zip_bytes(files, archive))
    else:
        replace_file(target, zip_bytes(files, _stored(key, code), compressed=False))
    return target


def _kept_description(asked: Hashable, describe: Callable[[], bytes]) -> bytes:
    """The model description of what was asked for, made once in a process while it is among the last."""
    if asked not in _descriptions:
        if len(_descriptions) >= _MOST_DESCRIPTIONS:
            del _descriptions[next(iter(_descriptions))]
        _descriptions[asked] = describe()
    return _descriptions[asked]


def _stored(key: str, code: Mapping[str, bytes]) -> bytes:
    """An archive of code as it is, made once in a process while it is among the last."""
    if key not in _archives:
        if len(_archives) >= _MOST_ARCHIVES:
            del _archives[next(iter(_archives))]
        _archives[key] = zip_bytes(code, compressed=False)
    return _archives[key]


def _dated(key: str, files: Mapping[str, bytes]) -> dict[str, bytes]:
    """Files with a GUID that follows from them and from the key of what goes with them, and with the present time."""
    guid = "{" + str(uuid.UUID(bytes=bytes.fromhex(digest_of({"": key.encode(), **files})[:32]))) + "}"
    old, new = (date.strftime(DATE_FORMAT).encode() for date in (_NO_TIME, _now()))
    return {
        path: content.replace(NO_GUID.encode(), guid.encode()).replace(old, new)
        for path, content in files.items()
    }


def _native_code(
    component: Component,
    name: str,
    fmi: FmiVersion,
    sources: Mapping[str, bytes],
    platforms: Sequence[str],
) -> dict[str, bytes]:
    """Libraries and sources of a native FMU, by their path in it; a library's folder names its platform."""
    if not has_kernel(component):
        raise ComponentError(f"{component.kind} has no native kernel; export it as a PythonFMU")
    try:
        found = libraries(platforms, fmi) if platforms else _library_of_here(fmi)
    except CompileError as error:
        raise ComponentError(f"{error}") from None
    if not found and not sources:
        raise ComponentError(
            "there is no native library here; install Fanfold again, or export PythonFMUs or sources"
        )
    files = {f"binaries/{path.replace('*', name)}": content for path, content in found.items()}
    files.update(sources)
    if fmi == "3.0" and terminals_of(component):
        files["terminalsAndIcons/terminalsAndIcons.xml"] = terminals_xml(component)
    return files


def _library_of_here(fmi: FmiVersion) -> dict[str, bytes]:
    """By folder and suffix; nothing where the package was never installed."""
    binary = native_library()
    if binary is None:
        return {}
    status = binary.stat()
    return {f"{folder_here(fmi)}/*{binary.suffix}": _content(binary, status.st_mtime_ns, status.st_size)}


@lru_cache(maxsize=2)
def _content(path: Path, changed: int, size: int) -> bytes:
    """Of a file that was changed then and has that size."""
    return path.read_bytes()


def _now() -> datetime:
    """Time of generation; SOURCE_DATE_EPOCH fixes it where builds must be reproducible to the byte."""
    fixed = os.environ.get("SOURCE_DATE_EPOCH")
    return datetime.fromtimestamp(int(fixed), UTC) if fixed else datetime.now(UTC)
