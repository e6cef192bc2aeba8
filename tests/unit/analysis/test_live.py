"""The wing whose values slide: its data are those of the scene at these values; what cannot slide is refused."""

import numpy as np
import pytest

import orchestrator as fanfold
from components import FanfoldError
from orchestrator.analysis.live.model import Maker, live_model, numbers_at


@pytest.fixture(scope="module")
def result():
    return fanfold.simulate("workbench", rigid="all", until=4.5, estimate=False)


@pytest.fixture(scope="module")
def model(result):
    ranges = "hinge_line.HL.motor.stowed=1.8..3.2 N.m", "joint.axial_stiffness*=0.9..1.2"
    return live_model(result, result.headline, ranges)


def test_data_at_values_are_those_of_the_scene(result, model):
    """Identity: assembling the scene at values between the nodes; the tolerance is that of the run."""
    maker = Maker(result)
    values = [2.71, 1.07]
    settings = {}
    for slider, value in zip(model.sliders, values, strict=True):
        settings |= slider.settings(maker.tree, value)
    exact, found = (numbers_at(data, model.offsets) for data in (maker.data(settings), model.data_at(values)))
    known = np.isfinite(exact)
    assert np.any(exact[known] != model.numbers[known])
    assert found[known] == pytest.approx(exact[known], rel=maker.tolerance, abs=1e-12)
    assert model.outputs(model.data_at(values))["HL.latch_time"] == pytest.approx(
        fanfold.simulate(
            fanfold.load("workbench", settings=settings), rigid="all", until=4.5, estimate=False
        ).latch_times["HL"],
        rel=maker.tolerance,
    )


def test_data_at_the_values_of_the_scene_are_its_own(model):
    """Identity, to the last bit."""
    assert model.data_at([one.start for one in model.sliders]) == model.data


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("hinge_line.HL.motor.stowed", "of the form"),
        ("hinge_line.HL.motor.stoved=1..3 N.m", "did you mean hinge_line.HL.motor.stowed"),
        ("hinge_line.HL.motor.stowed=1..3 mm", "in N.m"),
        ("hinge_line.HL.motor.stowed=2.5..3 N.m", "2.304 N.m"),
        ("hinge_line.HL.motor.stowed=1..3 N.m", "stowed must not be below deployed"),
        ("scene.until=5..6 s", "changes nothing"),
        ("body.panel.fixed_interface_modes=5..16", "valid integer"),
    ],
)
def test_what_does_not_slide(result, text, words):
    """Bad input: sentences."""
    with pytest.raises(FanfoldError, match=words):
        live_model(result, result.headline, [text])
