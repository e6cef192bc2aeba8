"""Lines that stray, and those that an event released: made-up runs of one line."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from orchestrator.assembly import HingeLine
from orchestrator.messages import code_of
from orchestrator.results.line_travel import folded, is_released, overruns
from orchestrator.validity.travel import _of_angle

TIME = np.array([0.0, 1.0, 2.0, 2.0, 3.0, 4.0])


def result(angle, events, **line):
    found = HingeLine(
        "L", ("left", "right"), "left", line.get("latches", True), False, **line.get("more", {})
    )
    return SimpleNamespace(
        time=TIME,
        events=[(2.0, "failure", text) for text in events],
        hinge_lines=(found,),
        has=lambda component, variable: True,
        signal=lambda component, variable: np.radians(angle),
    ), found


@pytest.mark.parametrize(
    ("events", "gone"),
    [
        ([], False),
        (["left released"], False),
        (["left released, right released"], True),
        (["left released", "right released"], True),
        (["xleft released, xright released"], False),
    ],
)
def test_a_line_is_released_with_the_last_of_its_hinges(events, gone):
    assert is_released(*result([0.0] * 6, events)) == gone


def folded_back(angle, events=(), **line):
    """Sentences of a line that went behind its start angle."""
    return [one for one in _of_angle(*result(angle, events, **line)) if code_of(one) == "W-folded-back"]


def test_a_released_line_neither_folds_back_nor_passes_its_end():
    """Rule: bodies that fly apart are not looked at; until its release a line is, like any other."""
    away = [0.0, 5.0, 10.0, 10.0, -90.0, 200.0]
    both = ["left released, right released"]
    assert " 90.0 deg " in folded_back(away)[0]
    assert folded_back(away, both) == []
    beyond = {"latches": False, "more": {"deployed_angle": np.pi / 2}}
    assert overruns(result(away, [], **beyond)[0])["L"].largest == pytest.approx(np.radians(200.0))
    assert overruns(result(away, both, **beyond)[0]) == {}
    assert " 30.0 deg " in folded_back([0.0, -30.0, 10.0, 10.0, -90.0, 200.0], both)[0]


def test_a_line_of_tape_springs_ends_where_they_are_straight():
    """Rule: the verdict names a line whose tape springs are folded at the end, not one that only passed its angle."""
    more = {"deployed_angle": np.pi / 2, "tapes": ("upper", "lower")}
    run, _ = result([0.0, 50.0, 95.0, 95.0, 150.0, 60.0], [], latches=False, more=more)
    signals = {"left": run.signal("left", "angle"), "upper": np.ones(6), "lower": np.ones(6)}
    run.signal = lambda component, variable: signals[component]
    assert (overruns(run), folded(run)) == ({}, {})
    signals["lower"] = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 0.0])
    (found,) = folded(run).values()
    assert (found.largest, found.last) == pytest.approx(np.radians((150.0, 60.0)))


def test_a_line_with_an_end_stop_may_fold_back_as_well():
    """Regression: it met the back of its stop, as a load of its own, without a word; a line that swings freely may."""
    back, line = result([0.0, -30.0, 10.0, 10.0, -90.0, 20.0], [], latches=False)
    assert len(list(_of_angle(back, line))) == 1
    back.has = lambda component, variable: component == "left"
    assert list(_of_angle(back, line)) == []


def test_what_leaves_the_tables_of_its_motor_is_told():
    """Rule: by more than 0.2 rad, where it was furthest off; lines of straight motors know no end.

    Regression: one turned by 300 revolutions under a torque of 600 N.m that nobody gave, without a word of it.
    """
    back = [0.0, -10.0, -30.0, -30.0, -20.0, 95.0]
    known = {"known": (0.0, np.pi / 2)}
    *_, sentence = _of_angle(*result(back, [], more=known))
    assert code_of(sentence) == "W-table-range"
    assert " -30 deg at 2 s" in sentence
    assert list(_of_angle(*result([0.0, 5.0, -4.0, -4.0, 60.0, 95.0], [], more=known))) == []
    assert [code_of(one) for one in _of_angle(*result(back, []))] == ["W-folded-back"]
