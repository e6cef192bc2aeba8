"""Pictures of gradients: which key moves which headline number, and how much."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.colors import SymLogNorm

from .style import STYLE, as_written, empty_figure, save_figure

if TYPE_CHECKING:
    from ..analysis.sampling.gradients import Gradients

_LEAST = 1e-4
"""Relative change of a number over that of a key; rows where nothing reaches it are left out."""
_MOST_ROWS = 40
_LINEAR, _DARK = 0.1, 0.3


def plot_gradients(found: Gradients, path: Path) -> Path:
    """Numbers over keys, coloured by the relative change of one over that of the other; the path written.

    Rows that nobody vouches for are crossed out.
    """
    relative = np.where(found.round_off[:, None], 0.0, np.nan_to_num(found.relative))
    rows = np.flatnonzero(np.abs(relative).max(axis=1, initial=0.0) >= _LEAST)[:_MOST_ROWS]
    shown = relative[rows]
    limit = float(np.abs(shown).max(initial=_LEAST))
    names = [found.names[i] for i in rows]
    unreliable = found.unreliable
    doubted = [i for i, name in enumerate(names) if name in unreliable]
    with mpl.rc_context(STYLE):
        figure = empty_figure(3.6 + 1.1 * len(found.keys), 2.2 + 0.25 * len(rows), "constrained")
        axes = figure.subplots()
        scale = SymLogNorm(_LINEAR, vmin=-limit, vmax=limit)
        image = axes.imshow(shown, cmap="RdBu_r", norm=scale, aspect="auto")
        for i, row in enumerate(shown.tolist()):
            for k, value in enumerate(row):
                colour = "white" if abs(scale(value) - 0.5) > _DARK else "black"
                axes.text(k, i, f"{value:+.2f}", ha="center", va="center", color=colour)
        for i in doubted:
            axes.axhspan(i - 0.5, i + 0.5, facecolor="none", edgecolor="grey", hatch="xx", linewidth=0.0)
        axes.grid(visible=False)
        axes.set_xticks(range(len(found.keys)), [_wrapped(key) for key in found.keys])
        axes.set_yticks(range(len(rows)), names)
        axes.set_title(found.scene + ("\ncrossed out: unreliable" if doubted else ""))
        figure.colorbar(image, ax=axes, label="change of a number in % for 1 % of a key")
        save_figure(as_written(figure), path)
    return path


def _wrapped(key: str) -> str:
    return key.replace(",", ",\n").replace(".", ".\n")
