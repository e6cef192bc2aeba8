"""The compiled library of the coupled step, coupling.c: its structures, its functions, and where it is."""

from __future__ import annotations

import sys
from ctypes import CDLL, POINTER, Structure, c_double, c_int, c_size_t, c_void_p, sizeof
from functools import cache
from pathlib import Path
from typing import Any

from .fields import constant, fields

_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}
LIBRARY = Path(__file__).parent / f"_coupling{_SUFFIX.get(sys.platform, '.so')}"
POINTS = constant("POINTS")
"""Steps that the native solver remembers."""


class Calls(Structure):
    """A participant as the native solver calls it: functions, references, arrays, saved state; then its ports."""

    _fields_ = fields("Participant")


class Limits(Structure):
    """Numbers of the iteration; their values stand in orchestrator/cosim/implicit/convergence.py."""

    _fields_ = fields("Limits")


class Matrix(Structure):
    """A block-sparse matrix with its tables of indices, see implicit/elimination.py."""

    _fields_ = fields("Matrix")


class Watched(Structure):
    """A torque weighted by an energy of its own, see implicit/local_error.py."""

    _fields_ = fields("Watched")


class History(Structure):
    """Wrenches of the last steps."""

    _fields_ = fields("History")


class PortWidth(Structure):
    """Numbers of a port, see `ports.Width`."""

    _fields_ = fields("Width")


class Allowed(Structure):
    """See `convergence.Tolerance`."""

    _fields_ = fields("Tolerance")


class NetworkData(Structure):
    """All that a coupled step works on."""

    _fields_ = fields(
        "Network", Width=PortWidth, Limits=Limits, Tolerance=Allowed, Matrix=Matrix, History=History
    )


class Crossing(Structure):
    """A distance that falls through zero at an event."""

    _fields_ = fields("Crossing")


class Rules(Structure):
    """Numbers of step control and energy guard; their values stand with those."""

    _fields_ = fields("Rules")


class RowBlock(Structure):
    """Rows on their way to a recorder."""

    _fields_ = fields("RowBlock")


class LoopData(Structure):
    """All that plain steps work on."""

    _fields_ = fields("Loop", RowBlock=RowBlock)


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
    "follow": ((c_void_p,), c_int),
    "mobility": ((POINTER(Calls), c_void_p, c_void_p, c_int), c_int),
    "stiffness": ((POINTER(Calls), c_void_p, c_void_p, c_int), c_int),
    "stiffness_at_once": ((POINTER(Calls), c_void_p, c_int), c_int),
}
_STRUCTURES = (Calls, NetworkData, LoopData)


@cache
def library() -> CDLL | None:
    """The compiled library; None where it was not built, or was built from another version of its source."""
    try:
        found = CDLL(str(LIBRARY))
        sizes = (c_size_t * len(_STRUCTURES))()
        found.coupling_sizes(sizes)
        for name, (arguments, result) in _FUNCTIONS.items():
            function = getattr(found, f"coupling_{name}")
            function.argtypes, function.restype = arguments, result
    except (OSError, AttributeError):
        return None
    return found if list(sizes) == [sizeof(one) for one in _STRUCTURES] else None


def missing_compiled_code() -> str:
    """What to tell where the coupled steps are made in Python for want of the library; empty where it is there."""
    if library() is not None:
        return ""
    why = "is of another version than its source" if LIBRARY.exists() else "was not built at installation"
    return f"{LIBRARY.name} {why}; the master runs in Python, several times slower. Install Fanfold again (pip install)"
