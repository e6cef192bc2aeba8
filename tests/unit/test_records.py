"""Public records on a screen of 24 lines and 80 columns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.records import short_repr

SCREEN = 24 * 80


@pytest.fixture(scope="module")
def result():
    return fanfold.simulate("workbench", rigid="all", tolerance=1e-2, until="1 s", estimate=False)


def test_arrays_and_long_collections_are_summarised():
    """Rule: arrays show their shape, mappings their first keys, sequences their length."""

    @short_repr
    @dataclass(frozen=True)
    class Record:
        array: np.ndarray
        names: tuple[str, ...]
        table: dict[str, float]
        number: float

    shown = repr(Record(np.zeros((1000, 3)), tuple("abcdefgh"), dict.fromkeys("abcdefgh", 1.0), 0.1 + 0.2))
    assert shown == "Record(array=<array 1000 x 3>, names=<8 str>, table=<8: a, b, c, d, ...>, number=0.3)"


def test_records_of_results_fit_a_screen(result):
    """A result, its headline, a signal, an instant and a comparison fit a screen each."""
    signal = result["hinge_left", "angle"]
    for record in (result, result.headline, signal, result.at(0.5), fanfold.compare(result, result)):
        assert 0 < len(repr(record)) < SCREEN


def test_records_of_scenes_fit_a_screen():
    """A scene and what analyses return fit a screen each."""
    scene = fanfold.load("amos3")
    records = (
        scene,
        fanfold.cache(),
        fanfold.check_scene(scene),
        fanfold.constraints(scene),
        fanfold.equilibrium(scene, rigid="all"),
        fanfold.modes(scene, "deployed", rigid="all"),
        fanfold.frequency_response(scene, "deployed", rigid="all", steps=10),
        *fanfold.appendage(scene, "deployed", rigid="all"),
        fanfold.torque_margin("bepicolombo", positions=5),
        fanfold.latch_tuning("workbench", "HL"),
    )
    assert max(len(repr(record)) for record in records) < SCREEN
