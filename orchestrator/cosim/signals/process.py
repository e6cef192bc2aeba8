"""The process of an FMU with signals: start, requests, and failures with name and time."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from multiprocessing import Pipe
from pathlib import Path
from tempfile import mkdtemp
from time import perf_counter
from typing import Any, Self

from components.cache.temporary import process_folder

from ...assembly import SignalFmu
from ..isolation.process import LONGEST_CALL
from ..native.shared_library import unpack
from ..participant import ParticipantError

_MOST_WARNINGS = 5
"""Different warnings of one FMU that are told."""
_LAST_MOMENT = 2.0
"""Time (s) that a process has to end by itself."""


def _step(time: float, h: float) -> str:
    """What cannot be done, by the time (s) that it begins at."""
    return f"do a step of {h:g} s at t = {time:.6g} s"


class SignalProcess:
    """An FMU in its own process; a context manager. ParticipantError if it fails, crashes or hangs.

    tolerance: relative accuracy passed to the FMU. longest_call: time (s) after which a call counts as hanging.
    seconds: wall time spent waiting for it.
    """

    def __init__(self, fmu: SignalFmu, tolerance: float, longest_call: float = LONGEST_CALL) -> None:
        self.fmu, self._tolerance = fmu, tolerance
        self.seconds = 0.0
        self._longest_call = longest_call
        self._warnings: dict[str, float] = {}  # and when (s) first
        self._inputs = tuple(signal.variable for signal in fmu.inputs)
        # one output may set several parameters
        self.outputs = tuple(dict.fromkeys(signal.variable for signal in (*fmu.outputs, *fmu.told)))
        self._folder = Path(mkdtemp(dir=process_folder()))
        try:
            unpack(fmu.path, self._folder)
        except Exception as error:
            shutil.rmtree(self._folder, ignore_errors=True)
            raise ParticipantError(f"{fmu.name}: {fmu.path} cannot be unpacked: {error}") from None
        self._connection, theirs = Pipe()
        command = [sys.executable, "-m", f"{__package__}.host", str(theirs.fileno())]
        self._process = subprocess.Popen(
            command, pass_fds=[theirs.fileno()], stdin=subprocess.DEVNULL, stdout=2, start_new_session=True
        )
        theirs.close()

    def open(self, values: Sequence[float]) -> list[float]:
        """Initialise at t = 0 with these inputs; the outputs."""
        found: list[float] = self._ask(
            "open",
            0.0,
            "be initialised at t = 0 s",
            str(self._folder),
            dict(self.fmu.start),
            self._inputs,
            self.outputs,
            values,
            self._tolerance,
        )
        return found

    def sample(self, time: float, h: float, values: Sequence[float]) -> list[float]:
        """The outputs after a step from a time (s) over h, with the inputs of its end."""
        found: list[float] = self._ask("sample", time + h, _step(time, h), time, h, values)
        return found

    def warned(self) -> Iterator[str]:
        """Sentences on what it warned of."""
        for text, time in self._warnings.items():
            yield f"{self.fmu.name}: at t = {time:.6g} s it warned: {text}"

    def _ask(self, name: str, time: float, action: str, *arguments: object) -> Any:  # noqa: ANN401
        begin = perf_counter()
        try:
            self._connection.send((name, arguments))
            if not self._connection.poll(self._longest_call):
                self._kill()
                raise ParticipantError(
                    f"{self.fmu.name}: at t = {time:.6g} s it did not answer within {self._longest_call:g} s, and "
                    "was ended"
                )
            answered, what, warned = self._connection.recv()
        except (EOFError, OSError):
            self._kill()
            raise ParticipantError(f"{self.fmu.name}: at t = {time:.6g} s {self._end()}") from None
        except ParticipantError:
            raise
        except Exception as error:  # what the other process writes is no answer
            self._kill()
            raise ParticipantError(
                f"{self.fmu.name}: at t = {time:.6g} s its process gave no answer that can be read "
                f"({type(error).__name__}); the FMU has written into files of others"
            ) from None
        finally:
            self.seconds += perf_counter() - begin
        for text in warned[: _MOST_WARNINGS - len(self._warnings)]:
            self._warnings.setdefault(" ".join(text.split()), time)
        if not answered:
            raise ParticipantError(f"{self.fmu.name}: cannot {action}: {what}")
        return what

    def _end(self) -> str:
        """What became of the process."""
        code = self._process.returncode
        if code is not None and code < 0:
            with suppress(ValueError):
                return f"its process was ended by {signal.Signals(-code).name}, so the FMU crashed"
        return f"its process ended with code {code}, so the FMU ended it"

    def _kill(self) -> None:
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(0.5)  # it may have ended already, in a way that is told
        if self._process.returncode is None:
            with suppress(OSError):  # the processes that the FMU started as well
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()

    def close(self) -> None:
        """End the process, by force where it does not end by itself, and remove the unpacked files."""
        with suppress(OSError, EOFError):
            if self._process.poll() is None:
                self._connection.send(("close", ()))
                if self._connection.poll(_LAST_MOMENT):
                    self._connection.recv()
        self._connection.close()
        self._kill()
        shutil.rmtree(self._folder, ignore_errors=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
