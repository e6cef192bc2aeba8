"""Progress bars: of a run, and of work whose length nobody knows before."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

_ROOM_FOR_CLOCK = 100
"""Columns of a terminal; in a narrower one the clock would be cut off."""


@contextmanager
def progress(name: str, end: float) -> Iterator[Callable[[float, float], None]]:
    """A progress bar on standard error: simulated time, step size, real-time factor."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, ProgressColumn, TextColumn, TimeElapsedColumn

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
    with Progress(*columns, console=console, refresh_per_second=5) as bar:
        task = bar.add_task(name, total=end, h=0.0, factor=0.0)

        def watch(time: float, h: float) -> None:
            bar.update(task, completed=time, h=h, factor=time / max(perf_counter() - start, 1e-9))

        yield watch


@contextmanager
def working(name: str) -> Iterator[Callable[[str], None]]:
    """A moving bar on standard error with the elapsed time, gone when the work is done; yields what names its part."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.fields[part]}"),
    )
    console = Console(file=sys.stderr)  # this one, also while Sphinx has the output of pages in its place
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(name, total=None, part="")
        yield lambda part: bar.update(task, part=part)
