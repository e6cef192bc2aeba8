"""What FMUs of other tools are joined to: units as tools write them, lines of several hinges, events."""

import zipfile

import numpy as np
import pytest

import orchestrator as fanfold
from tests.unit.cosim.signals.signal_cases import STEP, controlled, slave


def with_units(file, types="", units="", **declared):
    """The FMU with attributes of variables, and definitions of units and types."""
    copy = file.with_name("Declared.fmu")
    with zipfile.ZipFile(file) as old, zipfile.ZipFile(copy, "w") as new:
        for entry in old.namelist():
            content = old.read(entry)
            if entry == "modelDescription.xml":
                text = content.decode()
                for name, attribute in declared.items():
                    start = text.index(f'name="{name}"')
                    place = text.index("<Real", start) + len("<Real")
                    text = f"{text[:place]} {attribute}{text[place:]}"
                told = f"<UnitDefinitions>{units}</UnitDefinitions><TypeDefinitions>{types}</TypeDefinitions>"
                content = text.replace("<ModelVariables>", f"{told}<ModelVariables>").encode()
            new.writestr(entry, content)
    return copy


DEGREE = '<Unit name="deg"><BaseUnit rad="1" factor="0.017453292519943295"/></Unit>'


def test_units_of_declared_types(tmp_path):
    """Definition: the type that a variable is declared to have tells its unit. Regression: they were left out.

    A gain of 10 N.m a degree on an angle that it gets in degrees is one of 573 N.m/rad.
    """
    types = '<SimpleType name="Angle"><Real unit="deg"/></SimpleType>'
    file = with_units(slave(tmp_path), types, DEGREE, angle='declaredType="Angle"')
    run = fanfold.simulate(controlled(file), estimate=False)
    angles = run["controller", "angle"]
    assert angles.unit == "deg"
    assert angles[:][-1] == pytest.approx(
        np.degrees(run["craft", "attitude"][-1, 1]), rel=0.2
    )  # of the last sample


def rate_given(folder, unit, base):
    """Largest rate that a controller is given in a unit of this base, and the largest there is (rad/s)."""
    file = with_units(
        slave(folder), "", f'<Unit name="{unit}"><BaseUnit {base}/></Unit>', rate=f'unit="{unit}"'
    )
    run = fanfold.simulate(controlled(file, parameters={"gain": 0.0, "damping": 0.0}), estimate=False)
    return np.abs(run["controller", "rate"][:]).max(), np.abs(run["craft", "attitude_rate"][:, 1]).max()


@pytest.mark.parametrize(
    ("unit", "base"), [("Hz", 's="-1"'), ("U/min", 's="-1" factor="0.016666666666666666"'), ("rpm", 's="-1"')]
)
def test_a_frequency_is_no_angular_rate(tmp_path, unit, base):
    """Regression: turns a second have the exponents of rad/s, and went through with a factor of one."""
    with pytest.raises(fanfold.FanfoldError, match=f"inputs.rate: .*{unit}.*turns"):
        rate_given(tmp_path, unit, base)


@pytest.mark.parametrize(
    ("unit", "base", "factor"),
    [
        ("rpm", f'rad="1" s="-1" factor="{np.pi / 30!r}"', 30.0 / np.pi),
        ("rad_per_s", 's="-1"', 1.0),
        ("deg/s", f's="-1" factor="{np.pi / 180!r}"', 180.0 / np.pi),
    ],
)
def test_angular_rates_are_told_by_their_base_or_name(tmp_path, unit, base, factor):
    """Definition of base units; names of angles where a tool writes no exponent of rad. Samples miss peaks."""
    given, rate = rate_given(tmp_path, unit, base)
    assert given == pytest.approx(factor * rate, rel=0.1)


@pytest.mark.parametrize("relative", [True, False])
def test_differences_have_no_offset(tmp_path, relative):
    """FMI 2.0, 2.2.7: of a variable with relativeQuantity the offset of its unit is left out."""
    base = '<Unit name="dego"><BaseUnit rad="1" factor="0.5" offset="0.01"/></Unit>'
    declared = 'unit="dego"' + ' relativeQuantity="true"' * relative
    run = fanfold.simulate(controlled(with_units(slave(tmp_path), "", base, angle=declared)), estimate=False)
    first = run["controller", "angle"][:][0]
    assert first == pytest.approx(0.0 if relative else -0.02, abs=1e-9)


def test_an_impulse_acts_by_its_growth(tmp_path):
    """Definition: an impulse of 0.1 N.m.s more with every step of 0.05 s is a torque of 2 N.m over the step."""
    file = slave(tmp_path, fault="self.torque = 0.1 * self.count")
    units = '<Unit name="N.m.s"><BaseUnit kg="1" m="2" s="-1"/></Unit>'
    run = fanfold.simulate(controlled(with_units(file, "", units, torque='unit="N.m.s"')), estimate=False)
    assert run["wheel", "applied_torque"][-1] == pytest.approx(2.0, rel=1e-9)


def panel_on_two_hinges(file, **joined):
    scene = fanfold.Scene("line", until="0.2 s")
    scene.base("ground", points={"left": (0, -0.5, 0), "right": (0, 0.5, 0)})
    points = {"left": (0, -0.5, 0), "right": (0, 0.5, 0)}
    rigid = {"mass": 5.0, "center_of_mass": (0.5, 0, 0), "inertia": (1, 1, 1), "points": points}
    scene.body("panel", rigid=rigid)
    scene.hinge_line(
        "HL", "ground", "panel", axis="+y", aligned_angle="90 deg",
        motor={"stowed": "1 N.m", "deployed": "1 N.m"}, hinges={"a": ("left", "left"), "b": ("right", "right")},
    )  # fmt: skip
    scene.fmu("controller", file, step=STEP, **joined)
    return scene


@pytest.mark.filterwarnings("ignore")
def test_whole_numbers_and_truth_values_need_no_unit(tmp_path):
    """FMI 2.0, 2.2.7: only reals have one. Regression: they were said to have none, which nobody can mend."""
    file = slave(tmp_path)
    told = fanfold.check_scene(controlled(file, outputs={"count": "wheel.added_torque"})).warnings
    assert any("W-fmu-unit" in sentence and " rad" in sentence for sentence in told)
    assert not any("count in" in sentence for sentence in told)


def test_a_line_of_several_hinges_is_told(tmp_path):
    """Definition of a line's name: each hinge is set to the whole, the sensor alone is read."""
    joined = {"inputs": {"angle": "HL.motor_torque"}, "outputs": {"torque": "HL.motor_constant_torque"}}
    scene = panel_on_two_hinges(slave(tmp_path), **joined)
    told = [str(one) for one in caught(scene)]
    assert any("outputs.torque: " in one and "W-fmu-hinges" in one for one in told)
    assert any("inputs.angle: " in one and "W-fmu-hinges" in one for one in told)


def caught(scene):
    with pytest.warns(fanfold.FanfoldWarning) as found:
        fanfold.simulate(scene, estimate=False)
    return [one.message for one in found]


@pytest.mark.parametrize("noise", ["pass", "self.torque += 1e-15 * self.count"])
def test_an_event_takes_a_parameter_from_an_fmu(tmp_path, noise):
    """A wheel that fails stays failed. Regression: it healed at the next sample, unless that was the one before."""
    scene = controlled(slave(tmp_path, fault=noise), parameters={"gain": 0.0, "damping": 0.0})
    tree = scene.tree | {
        "event": [{"name": "fails", "time": "0.52 s", "set": {"wheel": {"added_torque": 0.25}}}]
    }
    scene = fanfold.Scene.of_tree("craft.toml", tree)
    assert any("W-fmu-events" in str(one) for one in caught(scene))
    run = fanfold.simulate(scene, estimate=False)
    after = run.time > 0.52 + 1e-6
    assert np.all(run["wheel", "applied_torque"][after] == 0.25)
