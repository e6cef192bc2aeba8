"""Axes in space and labels of events: nothing collides, whatever the proportions."""

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from orchestrator.views.space import set_view
from orchestrator.views.style import spread

BOXES = [
    (9.1, 1.1, 2.3),
    (1.0, 1.0, 1.0),
    (0.0, 1.6, 2.0),
    (9.1, 1.1, 0.0),
    (1.0, 9.0, 0.5),
    (2.28, 0.9, 9.12),
    (0.216, 1.4, 2.0),
    (0.06, 1.5, 1.6),
]


@pytest.mark.parametrize("box", BOXES)
@pytest.mark.parametrize("shift", [0.0, -0.8])
def test_tick_labels_do_not_collide(box, shift):
    """At 9 m the letter x stood on the tick 4.5 and the tick 9.0 ran into -0.8 of another axis."""
    figure = Figure(figsize=(4.0, 3.0), dpi=150)
    FigureCanvasAgg(figure)
    axes = figure.add_subplot(projection="3d", proj_type="ortho")
    set_view(axes, np.array(box) * shift, np.array(box) * (1.0 + shift))
    figure.draw_without_rendering()
    texts = [label for axis in (axes.xaxis, axes.yaxis, axes.zaxis) for label in axis.get_ticklabels()]
    boxes = [text.get_window_extent() for text in texts if text.get_text()]
    boxes = [box for box in boxes if figure.bbox.overlaps(box)]  # others are of edges that are not shown
    assert {text.get_text()[0] for text in texts} >= set("xyz")
    digits = [text.get_text().split(" = ")[-1].strip("-0.").replace(".", "") for text in texts]
    assert max(map(len, digits)) <= 2  # a middle of 0.108 was told as such
    overlaps = [(k, j) for k in range(len(boxes)) for j in range(k) if boxes[k].overlaps(boxes[j])]
    assert not overlaps


@pytest.mark.parametrize("seed", range(20))
def test_labels_are_side_by_side_in_order_and_within(seed):
    """By random places and widths that fit."""
    dice = np.random.default_rng(seed)
    count = int(dice.integers(1, 12))
    places = np.sort(dice.uniform(0.0, 1.0, count)) ** 3
    widths = dice.uniform(0.01, 0.9 / count, count)
    found = np.array(spread(places.tolist(), widths.tolist()))
    assert np.all(np.diff(found) >= 0.5 * (widths[1:] + widths[:-1]) - 1e-12)
    assert found[0] >= 0.5 * widths[0] - 1e-12
    assert found[-1] <= 1.0 - 0.5 * widths[-1] + 1e-12


def test_labels_with_room_stay_where_they_belong():
    assert spread([0.1, 0.5, 0.9], [0.05] * 3) == [0.1, 0.5, 0.9]
