"""The compiled library of the coupled step, native/coupling.c: its structures, its functions, and where it is."""

from __future__ import annotations

import sys
from ctypes import CDLL, POINTER, Structure, c_double, c_int, c_size_t, c_void_p, sizeof
from functools import cache
from pathlib import Path
from typing import Any

_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}
LIBRARY = Path(__file__).parent / "native" / f"_coupling{_SUFFIX.get(sys.platform, '.so')}"
POINTS = 3
"""Steps that the native solver remembers."""


def _fields(kind: Any, names: str) -> list[tuple[str, Any]]:  # noqa: ANN401 - any type of ctypes
    return [(name, kind) for name in names.split()]


class Calls(Structure):
    """A participant as the native solver calls it: functions, references, arrays, saved state; then its ports."""

    _fields_ = (
        *_fields(c_void_p, "component set_real get_real do_step get_state set_state free_state"),
        *_fields(c_void_p, "derivative port_stiffness"),
        *_fields(c_void_p, "input_references output_references observation_references"),
        *_fields(c_size_t, "inputs outputs observations overwrites_state"),
        *_fields(c_void_p, "input output observation saved"),
        *_fields(c_size_t, "ports slopes moments"),
        *_fields(c_void_p, "links turned"),
    )


class Limits(Structure):
    """Numbers of the iteration; their values stand in orchestrator/cosim/implicit/convergence.py."""

    _fields_ = (
        *_fields(c_double, "slow diverged steepest round_off near credible agreed"),
        *_fields(c_size_t, "patience most"),
        ("refreshed", c_size_t * 3),
    )


class Matrix(Structure):
    """A block-sparse matrix with its tables of indices, see implicit/elimination.py."""

    _fields_ = (
        *_fields(c_size_t, "groups block_count size length"),
        *_fields(c_void_p, "begin blocks lower_begin lower upper_begin upper targets"),
        *_fields(c_void_p, "values transposed pivots ordered"),
    )


class Watched(Structure):
    """A torque that is judged beside an energy of its own, see implicit/local_error.py."""

    _fields_ = (*_fields(c_size_t, "connection port row"), ("axis", c_double * 3), ("weight", c_double))


class History(Structure):
    """Wrenches of the last steps."""

    _fields_ = (("count", c_size_t), ("times", c_double * POINTS), ("values", c_void_p))


class NetworkData(Structure):
    """All that a coupled step works on, `Network` in native/network.h."""

    _fields_ = (
        *_fields(c_size_t, "participants bodies links size wrench coordinates"),
        *_fields(c_void_p, "participant link mobility stiffness parts wrenches accepted law"),
        *_fields(c_void_p, "residual scale round_off steps squares product bend noise"),
        *_fields(c_void_p, "observations energy_rows energies watched"),
        *_fields(c_size_t, "energy_kinds watched_count"),
        ("limits", Limits),
        *_fields(c_double, "relative force torque"),
        ("matrix", Matrix),
        ("history", History),
        *_fields(c_double, "time h last correction seconds reach"),
        *_fields(c_size_t, "iteration kept endured sweeps worst_row singular failed failed_call"),
        ("failed_status", c_int),
    )


_FUNCTIONS: dict[str, tuple[tuple[Any, ...], Any]] = {
    "sweep": ((c_void_p, c_double, c_double), c_int),
    "iterate": ((c_void_p, c_double, c_double, c_int), c_int),
    "resume": ((c_void_p, c_int), c_int),
    "assemble": ((c_void_p,), None),
    "direction": ((c_void_p, c_void_p, c_void_p), None),
    "predict": ((c_void_p, c_double, c_double, c_void_p), None),
    "error_square": ((c_void_p, c_double, c_double, c_double), c_double),
    "save": ((c_void_p,), c_int),
    "accept": ((c_void_p, c_double, c_double), c_int),
    "restart": ((c_void_p,), None),
    "observe": ((c_void_p,), c_int),
    "mobility": ((POINTER(Calls), c_void_p, c_void_p, c_int), c_int),
    "stiffness": ((POINTER(Calls), c_void_p, c_void_p, c_int), c_int),
    "stiffness_at_once": ((POINTER(Calls), c_void_p, c_int), c_int),
}


@cache
def library() -> CDLL | None:
    """The compiled library; None where it was not built, or was built from another version of its source."""
    try:
        found = CDLL(str(LIBRARY))
        sizes = (c_size_t * 2)()
        found.coupling_sizes(sizes)
        for name, (arguments, result) in _FUNCTIONS.items():
            function = getattr(found, f"coupling_{name}")
            function.argtypes, function.restype = arguments, result
    except (OSError, AttributeError):
        return None
    return found if list(sizes) == [sizeof(Calls), sizeof(NetworkData)] else None
