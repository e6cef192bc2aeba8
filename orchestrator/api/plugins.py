"""Plugins from Python: components, bodies and figures kept outside of the package."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING

from components.contract.plugins import line_in

from ..analysis.stress.model import scene_tree
from ..messages import message
from ..results.result import Result as Record
from ..scene.layers import data_files
from ..scene.plugins.loading import load
from ..scene.plugins.trust import trust_data
from .warnings import warn

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    Draw = Callable[[Record], Figure | None]


def load_plugin(file: str | Path) -> None:
    """Load a file of components or figures (.py), or of bodies (.toml), as `plugins` of [scene] does.

    A file that has changed since is loaded again. FanfoldError with file and line where it cannot be.
    """
    load(str(file))


def trust(result: str | Path) -> None:
    """Let the files of bodies and FMUs that a result names be opened for it, now and later; plugins stay out.

    Files that a scene named in a run on this computer need no trust. ResultError where there is no such result.
    """
    tree = scene_tree(Record.open(Path(result)))
    trust_data(data_files(tree))


def figure(name: str) -> Callable[[Draw], Draw]:
    """Decorator of a function that draws a result, or returns None where it lacks what it takes.

    The figure is drawn with those that Fanfold has, its caption the first line of the function's docstring. One that
    fails is left out, and a FanfoldWarning says with what and where.
    """
    from ..views.plots import add_figure

    def register(draw: Draw) -> Draw:
        add_figure(name, _left_out_where_it_fails(name, draw))
        return draw

    return register


def _left_out_where_it_fails(name: str, draw: Draw) -> Draw:
    @wraps(draw)
    def drawn(result: Record) -> Figure | None:
        try:
            return draw(result)
        except Exception as error:  # of whoever wrote it
            code = getattr(draw, "__code__", None)  # none of what is no function but can be called
            file = Path(code.co_filename if code else draw.__module__)
            said = f"{type(error).__name__}: {error}"
            warn(
                message(
                    "W-figure", f"the figure {name!r} of {file}{line_in(file, error)}: {said}; it is left out"
                )
            )
            return None

    return drawn
