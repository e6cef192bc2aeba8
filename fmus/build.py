"""Write a component as an FMU, native or with Python inside, by way of the cache.

A native FMU is the compiled library of all components and the data of one; it needs nothing else. A PythonFMU
is the component's own modules around PythonFMU (`python/bundle.py`).
"""

from __future__ import annotations

import os
import shutil
import tempfile
import uuid
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from fmpy import platform, platform_tuple

from components import Component, ComponentError

from .archive import digest_of, zip_bytes
from .description.fmi2 import Backend, FmiVersion, model_description
from .description.fmi3 import model_description3, terminals
from .description.variables import StartValue, start_values
from .native import library
from .native.binary_data import component_bytes
from .native.source_files import source_files
from .python.bundle import python_files


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
                files = python_files(component, name, starts)
        return {**files, "modelDescription.xml": description}

    digest = digest_of(contents("", datetime.fromtimestamp(0, UTC)))
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


def cache_directory() -> Path:
    """FANFOLD_CACHE, else fanfold in XDG_CACHE_HOME, else ~/.cache/fanfold; FMUs stand there by content."""
    if own := os.environ.get("FANFOLD_CACHE"):
        return Path(own)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fanfold"


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
