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
    """Load components or figures (.py) or bodies (.toml) from a file, as `plugins` of [scene] does.

    Parameters
    ----------
    file : str or Path
        plugin; a file that has changed is loaded again

    Raises
    ------
    FanfoldError
        with file and line if the plugin fails
    """
    load(str(file))


def trust(result: str | Path) -> None:
    """Trust the files of bodies and FMUs that a result names; plugins stay untrusted.

    Files that a scene named in a run on this computer are trusted already.

    Parameters
    ----------
    result : str or Path
        file of the result

    Raises
    ------
    ResultError
        if there is no such result
    """
    tree = scene_tree(Record.open(Path(result)))
    trust_data(data_files(tree))


def figure(name: str) -> Callable[[Draw], Draw]:
    """Decorator that registers a function as a figure of results.

    The function takes a `Result` and returns a Matplotlib figure, or None if the result lacks the signals. The first
    line of its docstring is the caption. A figure that fails is left out with a FanfoldWarning.

    Parameters
    ----------
    name : str
        name of the figure
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
                    "W-figure",
                    f"the figure {name!r} of {file}{line_in(file, error)} failed and is left out: {said}. "
                    "Correct its function.",
                )
            )
            return None

    return drawn
