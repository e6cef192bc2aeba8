"""Progress of long runs, and their interruption between steps by Ctrl-C or by signals that end jobs."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

Watch = Callable[[float, float], None]
"""Takes the time reached and the step size that led there (s)."""
Progress = Callable[[str, float], AbstractContextManager[Watch]]
"""Opens a display for a run, given what it is called and its end time (s)."""
_INTERRUPTIONS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]


@contextmanager
def silent(_: str, __: float) -> Iterator[Watch]:
    """A display that shows nothing."""
    yield lambda time, h: None


@contextmanager
def followed(progress: Progress, name: str, end: float) -> Iterator[Watch]:
    """The display of a run, which an interruption ends between two steps."""
    with _interrupted_between_steps() as check, progress(name, end) as show:

        def watch(time: float, h: float) -> None:
            check()
            show(time, h)

        yield watch


@contextmanager
def ended_like_ctrl_c() -> Iterator[None]:
    """What batch systems and closed terminals end a process with interrupts it, as Ctrl-C does.

    Where such a signal is ignored, as under nohup, or handled already, it stays so.
    """
    ends = [s for s in _INTERRUPTIONS if signal.getsignal(s) is signal.SIG_DFL] if _arrive_here() else []
    for number in ends:
        signal.signal(number, signal.default_int_handler)
    try:
        yield
    finally:
        for number in ends:
            signal.signal(number, signal.SIG_DFL)


@contextmanager
def _interrupted_between_steps() -> Iterator[Callable[[], None]]:
    """Keep interruptions until the function given is called: inside an FMU they would pass for a failure of the FMU.

    One acts in the end where no step came after it; a second one at once. Nothing changes for signals that do not
    interrupt, as Ctrl-C in a background job, or where none arrive, outside of the main thread.
    """
    kept = [s for s in _INTERRUPTIONS if signal.getsignal(s) is signal.default_int_handler]
    kept = kept if _arrive_here() else []
    interrupted = False

    def act_at_once() -> None:
        for number in kept:
            signal.signal(number, signal.default_int_handler)

    def note(*_: object) -> None:
        nonlocal interrupted
        interrupted = True
        act_at_once()

    def check() -> None:
        if interrupted:
            raise KeyboardInterrupt

    for number in kept:
        signal.signal(number, note)
    try:
        yield check
    finally:
        act_at_once()
    check()


def _arrive_here() -> bool:
    """Whether signals can be handled in this thread."""
    return threading.current_thread() is threading.main_thread()
