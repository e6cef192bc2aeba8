"""An FMI 2.0 FMU in a process of its own, with functions that C and Python call like those of a loaded FMU."""

from __future__ import annotations

from collections.abc import Callable
from ctypes import CFUNCTYPE, c_int, c_void_p, memmove, sizeof, string_at
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

from fmus.host.child import RAW
from fmus.host.process import FmuProcess, HostError

from .participant import ERROR, FATAL, OK

_REFERENCE, _NUMBER, _POINTER = 4, 8, sizeof(c_void_p)
_SIZES = {"Real": _NUMBER, "Boolean": sizeof(c_int), "Integer": sizeof(c_int)}
"""Of a value, by types of FMI 2.0."""
_PORT = 12 * 18
"""Size of the stiffness of one port by the motion of one port."""
_OFFERED = "fmi2GetDirectionalDerivative", "fanfoldGetPortStiffness", "fanfoldAcceptNumbers"
"""Functions that an FMU may lack."""


class _Written(NamedTuple):
    """Memory that a function may write to: its address, and its size in bytes."""

    address: int
    size: int


def _given(size: int) -> Callable[..., tuple[Any, ...]]:
    """Arguments of a function that sets values of a size."""
    return lambda of, n, values: (string_at(of, _REFERENCE * n), n, string_at(values, size * n))


def _asked(size: int) -> Callable[..., tuple[Any, ...]]:
    """Arguments of a function that gets values of a size."""
    return lambda of, n, values: (string_at(of, _REFERENCE * n), n, _Written(values, size * n))


_MEMORY: dict[str, Callable[..., tuple[Any, ...]]] = {
    **{f"fmi2Set{kind}": _given(size) for kind, size in _SIZES.items()},
    **{f"fmi2Get{kind}": _asked(size) for kind, size in _SIZES.items()},
    "fmi2GetFMUstate": lambda cell: (_Written(cell, _POINTER),),
    "fmi2FreeFMUstate": lambda cell: (_Written(cell, _POINTER),),
    "fmi2SerializedFMUstateSize": lambda state, size: (state, _Written(size, _POINTER)),
    "fmi2SerializeFMUstate": lambda state, content, size: (state, _Written(content, size), size),
    "fmi2DeSerializeFMUstate": lambda content, size, cell: (
        string_at(content, size),
        size,
        _Written(cell, _POINTER),
    ),
    "fmi2GetDirectionalDerivative": lambda of, n, by, m, seed, slope: (
        string_at(of, _REFERENCE * n),
        n,
        string_at(by, _REFERENCE * m),
        m,
        string_at(seed, _NUMBER * m),
        _Written(slope, _NUMBER * n),
    ),
    "fanfoldGetPortStiffness": lambda ports, matrix: (
        ports,
        _Written(matrix, _NUMBER * _PORT * ports * ports),
    ),
}
"""Contents of the memory that a function reads, by the addresses in its arguments; others have numbers only."""


class IsolatedFmu:
    """An FMU in a process of its own.

    dll: its functions, by their names; component: their first argument. failure: why the process does not answer, or
    what interrupted the last call. HostError where it cannot be instantiated.
    """

    def __init__(self, folder: Path, name: str, longest_call: float) -> None:
        self.component = 0
        self.failure: BaseException | None = None
        self._process = FmuProcess(longest_call)
        try:
            self._process.request("instantiate", str(folder), name, doing="fmi2Instantiate")
            lacks = {name for name in _OFFERED if not self._process.request("offers", name)}
        except BaseException:
            self._process.close()
            raise
        self.dll = SimpleNamespace(**{name: self._function(name) for name in RAW if name not in lacks})

    def _function(self, name: str) -> Any:  # noqa: ANN401 - of ctypes
        content = _MEMORY.get(name)

        def call(_: object, *arguments: Any) -> int:  # noqa: ANN401
            if self.failure is not None and not isinstance(self.failure, HostError):
                return FATAL  # it was interrupted
            try:
                return self._call(name, content(*arguments) if content else arguments)
            except BaseException as error:  # which would be lost on its way through C
                self.failure = error
                return FATAL

        return CFUNCTYPE(c_int, c_void_p, *RAW[name])(call)

    def _call(self, name: str, arguments: tuple[Any, ...]) -> int:
        written = [one for one in arguments if isinstance(one, _Written)]
        given = (bytearray(string_at(*one)) if isinstance(one, _Written) else one for one in arguments)
        status, contents = self._process.request("raw", name, *given, doing=name)
        for one, content in zip(written, contents, strict=True):
            memmove(one.address, bytes(content), one.size)
        return int(status) if status >= OK else ERROR

    @property
    def reason(self) -> str:
        """Why the last call failed: the message of the FMU, or the state of its process."""
        return str(self.failure) if isinstance(self.failure, HostError) else self._process.said

    @property
    def is_sound(self) -> bool:
        """Whether the process runs and answers."""
        return self._process.is_sound

    def close(self) -> None:
        """End the process."""
        self._process.close()
