"""Plugins from Python: components, bodies and figures kept outside of the package."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from ..results.result import Result as Record
from ..scene.plugins.loading import load

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    Draw = Callable[[Record], Figure | None]


def load_plugin(file: str | Path) -> None:
    """Load a file of components or figures (.py), or of bodies (.toml), as `plugins` of [scene] does.

    A file that has changed since is loaded again. FanfoldError with file and line where it cannot be.
    """
    load(str(file))


def figure(name: str) -> Callable[[Draw], Draw]:
    """Decorator of a function that draws a result, or returns None where it lacks what it takes.

    The figure is drawn with those that Fanfold has, its caption the first line of the function's docstring.
    """
    from ..views.plots import add_figure

    def register(draw: Draw) -> Draw:
        add_figure(name, draw)
        return draw

    return register
