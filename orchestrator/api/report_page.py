"""A report as HTML text, for files and notebooks."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import NamedTuple

from ..results.key_figures import headline
from ..results.result import Result, ResultError
from ..scene.builder import listed


class Page(NamedTuple):
    """A report as HTML text, which a notebook shows in a frame of its own, `height` pixels high."""

    html: str
    height: int

    def _repr_html_(self) -> str:
        style = f"width: 100%; height: {self.height}px; border: 0"
        return f'<iframe sandbox="allow-scripts" style="{style}" srcdoc="{escape(self.html)}"></iframe>'


def page_of(
    result: Result,
    others: Sequence[Result] = (),
    frames: int = 6,
    require: str | Sequence[str] = (),
    author: str = "",
    live: bool = False,
    slider: str | Sequence[str] = (),
) -> str:
    """HTML of a report; see `report`."""
    from ..views.report.report import report

    if slider and not live:
        raise ResultError(f"{result.name}: sliders belong to a live report; add --live, in Python live=True")
    model = None
    if live:
        from ..analysis.live.model import live_model
        from ..views.report.live.part import library

        library()  # compiling it may fail, which should not take a minute
        model = live_model(result, headline(result), listed(slider))
    text = report(result, others, frames, listed(require), author, model)
    return text.encode(errors="replace").decode()  # names of files may be no text
