"""Arguments of another kind than functions take: a sentence that says what to give, never an error of Python's."""

import pytest

import orchestrator as fanfold

SCENE = "workbench"
WRONG = {
    "sweeps, none": (lambda: fanfold.quasi_static(SCENE, {}), "swept"),
    "sweeps, one end": (
        lambda: fanfold.quasi_static(SCENE, {"HL1": 45}),
        "HL1 .*45",
    ),
    "sweeps, text": (lambda: fanfold.quasi_static(SCENE, "HL1"), "sweeps: .*'HL1'"),
    "torques": (
        lambda: fanfold.torque_margin(SCENE, torques={"HL1": 0.1}),
        "torques of HL1: ",
    ),
    "angles": (
        lambda: fanfold.modes(SCENE, angles="HL1=45deg"),
        "angles: .*'HL1=45deg'",
    ),
    "count": (lambda: fanfold.modes(SCENE, count=2.5), "count .*2.5"),
    "low": (lambda: fanfold.frequency_response(SCENE, low="1 N"), r"low is '1 N'"),
    "positions": (lambda: fanfold.restart(SCENE, (0.5,)), "0.5 .*restart"),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_they_are_refused_in_words(wrong):
    call, sentence = WRONG[wrong]
    with pytest.raises(fanfold.FanfoldError, match=sentence):
        call()


def test_frequencies_with_units_and_one_point():
    """Rule: quantities are numbers or texts, names one or several, as everywhere."""
    plain = fanfold.frequency_response(SCENE, "deployed", low=1.0, high=5.0, steps=5)
    told = fanfold.frequency_response(SCENE, "deployed", low="1 Hz", high="5 Hz", steps=5, points="interface")
    assert (plain.frequencies == told.frequencies).all()


def test_a_signal_refuses_times_that_are_none():
    with pytest.warns(fanfold.FanfoldWarning, match="HL .*W-not-opened"):
        result = fanfold.simulate(SCENE, until=0.01, estimate=False)
    with pytest.raises(fanfold.FanfoldError, match="'soon'"):
        result["workbench_table", "interface_force"].at("soon")
