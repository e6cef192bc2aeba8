"""The deployment as a few still pictures, for paper and for browsers that show nothing in space."""

from __future__ import annotations

from io import BytesIO
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from ...results.result import Result
from ..placement import rows_near
from ..shapes import Structure
from ..style import STYLE, empty_figure

_SIZE = (6.4, 4.2)
_DPI = 90
_LARGEST = 700_000
"""Bytes of all pictures; as text they are a third more, a fifth of a page of 5 MB."""


class Frame(NamedTuple):
    """A picture (PNG) and its time (s)."""

    time: float
    png: bytes


def frames(result: Result, count: int) -> list[Frame]:
    """At most `count` pictures from the start to the end of a run, fewer where they would be large together.

    None where no body has a geometry.
    """
    rows = rows_near(result.time, np.linspace(result.time[0], result.time[-1], count))
    structure = Structure(result, rows)
    if not structure.names or not rows.size:
        return []
    found = []
    with mpl.rc_context(STYLE):
        figure = empty_figure(*_SIZE)
        figure.subplots_adjust(left=0.0, right=0.97, bottom=0.1, top=0.97)
        structure.legend(figure)
        axes: Any = figure.add_subplot(projection="3d", proj_type="ortho")
        for k, time in enumerate(result.time[rows].tolist()):
            for body in list(axes.collections):  # all else is the same in every picture
                body.remove()
            structure.draw(axes, k)
            figure.suptitle(f"{time:.2f} s, axes in m", y=0.985)
            found.append(Frame(time, _png(figure)))
    every = -(-sum(len(frame.png) for frame in found) // _LARGEST)
    return found[:: max(every, 1)]


def _png(figure: Figure) -> bytes:
    stream = BytesIO()
    figure.savefig(stream, dpi=_DPI, format="png")
    return stream.getvalue()
