"""How far a run is, under the cell of a notebook."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from time import monotonic

from ..run.progress import Progress, Watch, silent

_PAUSE = 0.2
"""s between two updates"""


def chosen(progress: bool | Progress | None) -> Progress:
    """The display asked for; None is a bar in a notebook, and nothing elsewhere, as True is."""
    if callable(progress):
        return progress
    return notebook_bar if in_notebook() and progress is not False else silent


def in_notebook() -> bool:
    """Whether the code runs in the kernel of a notebook."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return getattr(shell, "kernel", None) is not None


@contextmanager
def notebook_bar(name: str, end: float) -> Iterator[Watch]:
    """A bar under the cell with the time reached and the step size."""
    from IPython.display import HTML, display  # only where it runs

    handle = display(HTML(_bar(name, 0.0, end, "")), display_id=True)
    due = 0.0

    def watch(time: float, h: float) -> None:
        nonlocal due
        if monotonic() >= due or time >= end:
            handle.update(HTML(_bar(name, time, end, f", steps of {h:.1e} s")))
            due = monotonic() + _PAUSE

    yield watch


def _bar(name: str, time: float, end: float, steps: str) -> str:
    told = f"{name}: t = {time:.3f} of {end:g} s{steps}"
    return f'<progress value="{time:g}" max="{end:g}"></progress> <code>{escape(told)}</code>'
