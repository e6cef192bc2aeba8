"""An FMU in a process of its own: start, requests, and one way to say that it crashed, hangs or refuses."""

from __future__ import annotations

import os
import pickle
import select
import signal
import subprocess
import sys
from contextlib import suppress
from multiprocessing import Pipe
from pathlib import Path
from time import monotonic
from typing import Any, Self

from components import FanfoldError

from .child import REFUSED, SAID, WARNING

LONGEST_CALL = 60.0
"""Time (s) after which a request without an answer counts as hanging."""
_CHILD = Path(__file__).with_name("child.py")
_SLICE = 50
"""Time (ms) between two looks at whether the process is still there."""
_LAST_MOMENT = 2.0
"""Time (s) that a process has to end by itself."""


class HostError(FanfoldError):
    """Why a request to the process of an FMU failed, as a part of a sentence."""


class FmuProcess:
    """A process for one FMU; a context manager.

    Parameters
    ----------
    longest_call : float
        Time (s) after which a request without an answer counts as hanging.
    quiet : bool
        Whether what the FMU prints is dropped; it goes to standard error otherwise.

    Attributes
    ----------
    is_sound : bool
        Whether the process is there and answers.
    said : str
        What the FMU said last during the last request that is no good news.
    warned : list of str
        What it warned of during the last request.
    """

    def __init__(self, longest_call: float = LONGEST_CALL, *, quiet: bool = False) -> None:
        if not hasattr(select, "poll"):
            raise HostError("an FMU cannot have a process of its own on this system")
        self._longest_call = longest_call
        self.is_sound = True
        self.said = ""
        self.warned: list[str] = []
        self._connection, theirs = Pipe()
        self._poll = select.poll()
        self._poll.register(self._connection, select.POLLIN)
        output = subprocess.DEVNULL if quiet else sys.__stderr__
        with theirs:
            try:
                self._process = subprocess.Popen(
                    [sys.executable, "-P", str(_CHILD), str(theirs.fileno())],
                    pass_fds=[theirs.fileno()],
                    stdin=subprocess.DEVNULL,
                    stdout=output,
                    stderr=output,
                    start_new_session=True,
                )
            except OSError as error:
                self._connection.close()
                raise HostError(f"its process cannot be started: {error}") from None
        try:
            self._answered("the start of its process", max(longest_call, LONGEST_CALL))
        except BaseException:
            self.close()
            raise

    def request(self, name: str, *arguments: object, doing: str = "the call") -> Any:  # noqa: ANN401
        """What a method of `child.Instance` returns. HostError where it fails, with what was being done."""
        if not self.is_sound:
            raise HostError(self.said)
        self.said, self.warned = "", []
        with suppress(OSError):  # of a process that has ended, which has no answer
            self._connection.send_bytes(pickle.dumps((name, arguments)))
        return self._answered(doing, self._longest_call)

    def _answered(self, doing: str, longest: float) -> Any:  # noqa: ANN401
        try:
            return self._answer(doing, monotonic() + longest, longest)
        except HostError:
            raise
        except (EOFError, OSError):
            raise self._broken(self._end(doing)) from None
        except Exception as error:  # what the other process writes is no answer
            raise self._broken(
                f"its process gave no answer to {doing} that can be read ({type(error).__name__}); the FMU has written "
                "into files of others"
            ) from None
        except BaseException:
            self._broken(f"it was interrupted during {doing}")
            raise

    def _answer(self, doing: str, end: float, longest: float) -> Any:  # noqa: ANN401
        while True:
            while not self._poll.poll(_SLICE):
                if self._process.poll() is not None:
                    raise EOFError
                if monotonic() > end:
                    raise self._broken(f"it hangs, {doing} has not come to its end in {longest:g} s")
            kind, content = pickle.loads(self._connection.recv_bytes())
            if kind == SAID:
                status, self.said = content
                if status == WARNING:
                    self.warned.append(self.said)
            elif kind == REFUSED:
                raise HostError(content)
            else:
                return content

    def _broken(self, why: str) -> HostError:
        """End the process; the reason for this request and all others."""
        self.is_sound = False
        self._kill()
        self.said = f"{why}; its last message is: {self.said}" if self.said else why
        return HostError(self.said)

    def _end(self, doing: str) -> str:
        """What became of the process, whose end may be a moment away."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(_LAST_MOMENT)
        code = self._process.returncode
        if code is None:
            return f"its process ended the exchange during {doing}"
        if code >= 0:
            return f"it ended its process with exit code {code} during {doing}"
        with suppress(ValueError):
            return f"it crashed during {doing}, with signal {-code} ({signal.Signals(-code).name})"
        return f"it crashed during {doing}, with signal {-code}"

    def _kill(self) -> None:
        with suppress(OSError):  # the processes that the FMU started as well
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()

    def close(self) -> None:
        """End the process, by force where it does not end by itself."""
        if self._connection.closed:
            return
        if self.is_sound:
            self._longest_call = _LAST_MOMENT
            with suppress(HostError, subprocess.TimeoutExpired):
                self.request("close")
                self._process.wait(_LAST_MOMENT)
        self._kill()
        self._connection.close()
        self.is_sound = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
