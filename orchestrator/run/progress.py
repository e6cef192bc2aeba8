"""What a long run tells while it goes, and Ctrl-C between its steps."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

Watch = Callable[[float, float], None]
"""Takes the time reached and the step size that led there (s)."""
Progress = Callable[[str, float], AbstractContextManager[Watch]]
"""Opens a display for a run, given what it is called and its end time (s)."""


@contextmanager
def silent(_: str, __: float) -> Iterator[Watch]:
    """A display that shows nothing."""
    yield lambda time, h: None


@contextmanager
def followed(progress: Progress, name: str, end: float) -> Iterator[Watch]:
    """The display of a run, which Ctrl-C ends between two steps."""
    with _interrupted_between_steps() as check, progress(name, end) as show:

        def watch(time: float, h: float) -> None:
            check()
            show(time, h)

        yield watch


@contextmanager
def _interrupted_between_steps() -> Iterator[Callable[[], None]]:
    """Keep Ctrl-C until the function given is called: inside an FMU it would pass for a failure of the FMU.

    It acts in the end where no step came after it. A second Ctrl-C acts at once. Nothing changes where Ctrl-C is
    ignored, as in a background job, or does not arrive, as outside of the main thread.
    """
    before = signal.getsignal(signal.SIGINT)
    pressed = False

    def note(*_: object) -> None:
        nonlocal pressed
        pressed = True
        signal.signal(signal.SIGINT, before)

    def check() -> None:
        if pressed:
            raise KeyboardInterrupt

    kept = before is signal.default_int_handler and threading.current_thread() is threading.main_thread()
    if kept:
        signal.signal(signal.SIGINT, note)
    try:
        yield check
    finally:
        if kept:
            signal.signal(signal.SIGINT, before)
    check()
