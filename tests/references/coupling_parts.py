"""Parts of the coupling in C, compiled for tests with functions that call them one by one."""

from __future__ import annotations

from ctypes import CDLL, addressof, c_double, c_int, c_size_t, c_ssize_t, c_void_p
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from fmus.native.compile import FLAGS, HERE, compile_files, compiler, suffix
from orchestrator.cosim.coupling import Coupling

_SOURCE = Path(__file__).with_suffix(".c")
_PARTS = ("blocks", "convergence", "coupling", "events", "interface_jacobians", "network", "participant",
          "prediction", "rows", "solver", "step_control", "system")  # fmt: skip
_REAL, _SIZE, _POINTER = c_double, c_size_t, c_void_p
_RESULTS: dict[str, Any] = {
    "new_sizes": _POINTER, "present_size": _REAL, "new_guard": _POINTER, "crossed": c_ssize_t, "followed": _REAL,
    "new_table": _POINTER, "request_of": _SIZE, "observed": _REAL, "table": _SIZE, "matrix_size": _SIZE,
    "stiffened": _SIZE, "fastest_displaced": _REAL, "square_of_error": _REAL,
}  # fmt: skip
"""Of functions that return no int."""


@cache
def _library() -> CDLL:
    if compiler() is None:
        pytest.skip("there is no C compiler")
    folder = TemporaryDirectory()
    target = Path(folder.name) / f"parts{suffix()}"
    folders = {f"-I{path.parent}" for path in HERE.rglob("*.h")}
    files = [_SOURCE, *(HERE / "coupling" / f"{name}.c" for name in _PARTS)]
    compile_files(files, target, ("-O1", *(flag for flag in FLAGS if flag != "-O3"), *sorted(folders)))
    found = CDLL(str(target))
    found.folder = folder  # type: ignore[attr-defined]
    return found


def call(name: str, *arguments: Any) -> Any:
    """A function of the source beside this; addresses are numbers, an array is its memory, a coupling its handle."""
    function = getattr(_library(), name)
    function.restype = _RESULTS.get(name, c_int)
    return function(*map(_converted, arguments))


def _converted(argument: Any) -> Any:
    if isinstance(argument, Coupling):
        assert call("request_of", argument._handle.value) == addressof(argument._request), (
            "build the library again"
        )
        return argument._handle
    if isinstance(argument, np.ndarray):
        assert argument.flags.c_contiguous
        return c_void_p(argument.ctypes.data)
    if isinstance(argument, bool):
        return c_int(argument)
    if isinstance(argument, float):
        return c_double(argument)
    return c_size_t(argument)


def matrix_of(coupling: Coupling, number: int, h: float, *, differences: bool) -> NDArray[np.float64]:
    """The matrix of a participant by number over a step h (s), without its axes."""
    found = np.zeros(call("matrix_size", coupling, number) + 9)
    assert call("matrix_of", coupling, number, h, differences, found)
    return found[:-9]
