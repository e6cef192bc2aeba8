"""Start the process of an FMU, share memory with it, and call the FMU's functions as if it were here."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from contextlib import suppress
from ctypes import (
    CDLL,
    POINTER,
    byref,
    c_char_p,
    c_double,
    c_int,
    c_size_t,
    c_uint,
    c_void_p,
    cast,
    pythonapi,
)
from functools import cache
from pathlib import Path
from tempfile import TemporaryFile
from types import SimpleNamespace
from typing import IO, Any

from components import FanfoldError
from components.cache.temporary import process_folder

LIBRARY = Path(__file__).parent / "native" / f"_isolation{'.dylib' if sys.platform == 'darwin' else '.so'}"
LONGEST_CALL = 60.0
"""Time (s) after which a call that has not come to its end is taken to hang."""
_CHILD = Path(__file__).with_name("child.py")
_ROOM, _ROOM_PER_NUMBER = 1 << 17, 64
_LAST_MOMENT = 2.0
"""Time (s) that a process has to end by itself."""
_INTERPRETER = ("PyGILState_Ensure", "PyGILState_Release", "PyErr_CheckSignals", "PyErr_Clear")
_REFERENCES, _NUMBERS = POINTER(c_uint), POINTER(c_double)
_SIGNATURES: dict[str, tuple[Any, ...]] = {
    "SetupExperiment": (c_int, c_double, c_double, c_int, c_double),
    "EnterInitializationMode": (),
    "ExitInitializationMode": (),
    "Reset": (),
    "FreeInstance": (),
    "SetReal": (_REFERENCES, c_size_t, _NUMBERS),
    "post_SetReal": (_REFERENCES, c_size_t, _NUMBERS),
    "GetReal": (_REFERENCES, c_size_t, _NUMBERS),
    "DoStep": (c_double, c_double, c_int),
    "GetFMUstate": (POINTER(c_void_p),),
    "SetFMUstate": (c_void_p,),
    "post_SetFMUstate": (c_void_p,),
    "FreeFMUstate": (POINTER(c_void_p),),
    "SerializedFMUstateSize": (c_void_p, POINTER(c_size_t)),
    "SerializeFMUstate": (c_void_p, c_char_p, c_size_t),
    "DeSerializeFMUstate": (c_char_p, c_size_t, POINTER(c_void_p)),
    "GetDirectionalDerivative": (_REFERENCES, c_size_t, _REFERENCES, c_size_t, _NUMBERS, _NUMBERS),
    "GetPortStiffness": (c_size_t, _NUMBERS),
    "reason": (),
    "interrupted": (),
    "is_sound": (),
    "close": (),
    "set_process": (c_int,),
    "load": (c_char_p, POINTER(c_int)),
    "instantiate": (c_char_p, c_char_p, c_char_p, c_int),
}
_OFFERED = {1: "GetDirectionalDerivative", 2: "GetPortStiffness"}


class IsolationError(FanfoldError):
    """A process that could not be started, or could not make an instance of its FMU: why, as a part of a sentence."""


@cache
def library() -> CDLL | None:
    """The compiled library of both processes; None where it was not built."""
    try:
        found = CDLL(str(LIBRARY))
        for name, arguments in _SIGNATURES.items():
            getattr(found, f"isolated_{name}").argtypes = (c_void_p, *arguments)
        found.isolated_open.argtypes = (c_int, c_size_t, c_void_p, c_int, c_int, c_double)
        found.isolated_open.restype, found.isolated_reason.restype = c_void_p, c_char_p
    except (OSError, AttributeError):
        return None
    return found


class IsolatedFmu:
    """An FMI 2.0 co-simulation FMU in a process of its own.

    dll: its functions; component: what each takes first. binary, guid, resources, name: of the FMU and its instance.
    formatted: whether its messages have the form of printf, as the standard says. numbers: of its real variables,
    by which memory is shared. longest_call: time (s) after which a call is taken to hang. IsolationError where there is
    no instance.
    """

    def __init__(
        self,
        binary: Path,
        guid: str,
        resources: str,
        name: str,
        *,
        formatted: bool,
        numbers: int,
        longest_call: float = LONGEST_CALL,
    ) -> None:
        found = library()
        if found is None:
            raise IsolationError(
                "it cannot have a process of its own here, where Fanfold was installed without a C compiler"
            )
        self._library = found
        self.component: int | None = None
        self._start(found, _ROOM + _ROOM_PER_NUMBER * numbers, longest_call)
        offered = c_int()
        try:
            self._refuse(found.isolated_load(self.component, os.fsencode(binary), byref(offered)))
            texts = (text.encode() for text in (name, guid, resources))
            self._refuse(found.isolated_instantiate(self.component, *texts, formatted))
        except BaseException:
            self.close()
            raise
        self.dll = _functions(found, offered.value)

    def _start(self, found: CDLL, room: int, longest_call: float) -> None:
        """The process, waiting for its first request; files that only it needs are closed here."""
        interpreter = (c_void_p * 4)(*(cast(getattr(pythonapi, name), c_void_p) for name in _INTERPRETER))
        from_here, to_there = os.pipe()
        from_there, to_here = os.pipe()
        self._ends = [to_there, from_there]
        with _shared_memory() as memory:
            ends = (memory.fileno(), from_here, to_here)
            self.component = found.isolated_open(
                ends[0], room, interpreter, to_there, from_there, longest_call
            )
            command = [sys.executable, "-P", str(_CHILD), str(LIBRARY), *map(str, (*ends, os.getpid()))]
            try:
                if self.component is None:
                    raise OSError(f"{room} bytes of memory cannot be shared")
                self._process = subprocess.Popen(
                    command, pass_fds=ends, stdin=subprocess.DEVNULL, stdout=2, start_new_session=True
                )
            except OSError as error:
                self._release()
                raise IsolationError(f"its process cannot be started: {error}") from None
            finally:
                os.close(from_here)
                os.close(to_here)
        found.isolated_set_process(self.component, self._process.pid)

    def _refuse(self, status: int) -> None:
        if self.interrupted:
            raise KeyboardInterrupt
        if status > 1:
            raise IsolationError(self.reason)

    @property
    def reason(self) -> str:
        """What the FMU said last, or what became of its process."""
        said: bytes = self._library.isolated_reason(self.component)
        return said.decode("utf-8", "replace").strip()

    @property
    def interrupted(self) -> bool:
        """Whether a call was given up because this process was asked to end."""
        return bool(self._library.isolated_interrupted(self.component))

    @property
    def is_sound(self) -> bool:
        """Whether the process is there and answers."""
        return bool(self._library.isolated_is_sound(self.component))

    def close(self) -> None:
        """End the process, by force where it does not end by itself, and free what is shared with it."""
        if self.component is None:
            return
        self._library.isolated_FreeInstance(self.component)
        if self.is_sound:
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(_LAST_MOMENT)
        if self._process.returncode is None:
            with suppress(OSError):  # the processes that the FMU started as well
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
        self._release()

    def _release(self) -> None:
        for end in self._ends:
            os.close(end)
        if self.component is not None:
            self._library.isolated_close(self.component)
            self.component = None


def _shared_memory() -> IO[bytes]:
    """A file without a name, which is gone with its last process; in memory where the system has such files."""
    if hasattr(os, "memfd_create"):
        return os.fdopen(os.memfd_create("fanfold"), "r+b", buffering=0)
    return TemporaryFile(dir=process_folder())


def _functions(found: CDLL, offered: int) -> SimpleNamespace:
    """Functions by the names of the standard, and `post_` ones; without those that the FMU does not offer."""
    missing = {name for bit, name in _OFFERED.items() if not offered & bit}
    names = [name for name in _SIGNATURES if name[0].isupper() and name not in missing]
    functions = {f"fmi2{name}": getattr(found, f"isolated_{name}") for name in names}
    if "GetPortStiffness" in names:
        functions["fanfoldGetPortStiffness"] = functions.pop("fmi2GetPortStiffness")
    posts = {f"post_{name}": getattr(found, f"isolated_post_{name}") for name in ("SetReal", "SetFMUstate")}
    return SimpleNamespace(**functions, **posts)
