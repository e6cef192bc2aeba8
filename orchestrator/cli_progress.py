"""The progress bar of a run, and Ctrl-C between its steps."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn


@contextmanager
def _interrupted_between_steps() -> Iterator[Callable[[], None]]:
    """Keep Ctrl-C until the function given is called: inside an FMU it would pass for a failure of the FMU.

    A second Ctrl-C acts at once. Nothing changes where Ctrl-C is ignored, as in a background job.
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


@contextmanager
def progress(name: str, end: float) -> Iterator[Callable[[float, float], None]]:
    """A progress bar on standard error: simulated time, step size, real-time factor."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn(
            "t = {task.completed:7.3f} s  H = {task.fields[h]:.1e} s  real-time factor {task.fields[factor]:.2f}"
        ),
        TimeElapsedColumn(),
    )
    start = perf_counter()
    with (
        _interrupted_between_steps() as check,
        Progress(*columns, console=Console(stderr=True), refresh_per_second=5) as bar,
    ):
        task = bar.add_task(name, total=end, h=0.0, factor=0.0)

        def watch(time: float, h: float) -> None:
            check()
            bar.update(task, completed=time, h=h, factor=time / max(perf_counter() - start, 1e-9))

        yield watch
