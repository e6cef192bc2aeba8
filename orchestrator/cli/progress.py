"""The progress bar of a run, and Ctrl-C between its steps."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, TextColumn, TimeElapsedColumn

_ROOM_FOR_CLOCK = 100
"""Columns of a terminal; in a narrower one the clock would be cut off."""


@contextmanager
def _interrupted_between_steps() -> Iterator[Callable[[], None]]:
    """Keep Ctrl-C until the function given is called: inside an FMU it would pass for a failure of the FMU.

    It acts in the end where no step came after it. A second Ctrl-C acts at once. Nothing changes where Ctrl-C is
    ignored, as in a background job.
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

    if before is signal.default_int_handler:
        signal.signal(signal.SIGINT, note)
    try:
        yield check
    finally:
        signal.signal(signal.SIGINT, before)
    check()


@contextmanager
def progress(name: str, end: float) -> Iterator[Callable[[float, float], None]]:
    """A progress bar on standard error: simulated time, step size, real-time factor."""
    columns: list[ProgressColumn] = [
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn(
            "t = {task.completed:7.3f} s  H = {task.fields[h]:.1e} s  real-time factor {task.fields[factor]:.2f}"
        ),
    ]
    console = Console(stderr=True)
    if console.width >= _ROOM_FOR_CLOCK:
        columns.append(TimeElapsedColumn())
    start = perf_counter()
    with (
        _interrupted_between_steps() as check,
        Progress(*columns, console=console, refresh_per_second=5) as bar,
    ):
        task = bar.add_task(name, total=end, h=0.0, factor=0.0)

        def watch(time: float, h: float) -> None:
            check()
            bar.update(task, completed=time, h=h, factor=time / max(perf_counter() - start, 1e-9))

        yield watch
