"""Directional derivatives of the step of a scene as one FMU against a host's differences, from restored states."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

import orchestrator as fanfold
from fmus import native_library
from orchestrator.cosim.settings import TIME_ROUNDING
from tests.unit.run.as_one.host import Host, latching
from tests.unit.run.as_one.host3 import Host3

pytestmark = pytest.mark.skipif(native_library() is None, reason="a scene as one FMU is native")
WIDTH = 1e-4
"""Of a host's differences, over the value: its square, their truncation, is below what is asked."""
ASKED, MET = 1e-6, 1e-11
"""Of derivatives; angle (rad) to which a latch-up is met, which stays in what a host makes differences of."""
TORQUE, ENERGY = "root.motor_constant_torque", "stored_energy"
MESSAGES = [ENERGY, "root.angle", "HL.latch_time", "HL.latch_torque_peak"]


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """On a base that is driven, at rest where nobody drives it."""
    folder = tmp_path_factory.mktemp("derivatives")
    (found,) = fanfold.export(latching(), folder, as_one=True, driven_base=True)
    return found


def derivatives(host, unknowns, known):
    references = [host.references[name] for name in unknowns]
    return np.array(host.fmu.getDirectionalDerivative(references, [host.references[known]], [1.0]))


def differences(path, time, step, unknowns, known):
    """Of the outputs after a step from a time, central, from one state; and what may be wrong with them."""
    host = Host(path).start().to(time, step)
    state, value = host.fmu.getFMUstate(), host[known]
    width = WIDTH * (abs(value) or 1.0)
    found = []
    for side in (1.0, -1.0):
        host.fmu.setFMUstate(state)
        host[known] = value + side * width
        host.fmu.doStep(time, step)
        found.append(np.array([host[name] for name in unknowns]))
    return (found[0] - found[1]) / (2.0 * width), MET / (2.0 * width)


def described(path):
    """Its model description, of which FMPy reads what FMI 2.0 has."""
    with zipfile.ZipFile(path) as archive:
        return archive.read("modelDescription.xml")


def stepped(path, time, step):
    host = Host(path).start().to(time, step)
    host.fmu.doStep(time, step)
    return host


@pytest.mark.parametrize("known", [TORQUE, "root.latch_stiffness"])
def test_by_parameters_through_latch_up(path, known):
    """What changes at the communication point before latch-up: when that comes and how hard it is."""
    found = derivatives(stepped(path, 0.9, 0.1), MESSAGES, known)
    expected, met = differences(path, 0.9, 0.1, MESSAGES, known)
    np.testing.assert_allclose(found, expected, rtol=ASKED, atol=met)
    assert found[3] > 0.0
    assert (found[2] < 0.0) == (known == TORQUE)


@pytest.mark.parametrize("known", ["base.acceleration[3]", "base.angular_velocity[2]"])
def test_by_the_drive_of_the_base(path, known):
    for time, step in ((0.5, 0.1), (0.9, 0.1)):
        found = derivatives(stepped(path, time, step), MESSAGES, known)
        expected, met = differences(path, time, step, MESSAGES, known)
        np.testing.assert_allclose(found, expected, rtol=ASKED, atol=met)
        assert abs(found[0]) > 0.0


def test_a_motor_that_becomes_stronger_has_less_energy_left(path):
    """A constant torque M has the potential -M q, and what it does more over the step is in the motion."""
    host = Host(path).start().to(0.3, 0.01)
    angle = host["root.angle"]
    host.fmu.doStep(0.3, 0.01)
    assert derivatives(host, [ENERGY], TORQUE)[0] == pytest.approx(-angle, rel=1e-5)


def test_asking_changes_nothing(path):
    asked, plain = stepped(path, 0.85, 0.05), stepped(path, 0.85, 0.05)
    derivatives(asked, MESSAGES, TORQUE)
    for host in (asked, plain):
        host.time = 0.9
        host.to(1.2, 0.05)
    assert asked["HL.latch_time"] == pytest.approx(plain["HL.latch_time"], rel=1e-9)
    assert asked[ENERGY] == pytest.approx(plain[ENERGY], rel=1e-6)


def test_what_does_not_act_over_the_step_has_none(path):
    """What is read at a communication point depends on no input there; Booleans have no derivatives."""
    host = stepped(path, 0.3, 0.01)
    with pytest.raises(FMICallException):
        derivatives(host, MESSAGES, "HL.latch_command")
    with pytest.raises(FMICallException):
        derivatives(host, ["HL.latched"], TORQUE)
    host.fmu.setFMUstate(host.fmu.getFMUstate())
    assert not derivatives(host, MESSAGES, "base.acceleration[3]").any()


def test_at_the_bound_of_a_range(path):
    """Friction that begins takes energy."""
    assert derivatives(stepped(path, 0.3, 0.1), [ENERGY], "root.friction_coefficient")[0] < 0.0


def test_an_event_at_a_time_moves_with_nothing(tmp_path):
    """So the step that ends there has derivatives: see `test_a_motor_that_becomes_stronger_has_less_energy_left`."""
    event = {"name": "weaker", "time": "0.3 s", "set": {"root": {"motor_constant_torque": "4 N.m"}}}
    (path,) = fanfold.export(latching([event]), tmp_path, as_one=True)
    host = Host(path).start().to(0.2, 0.1)
    angle = host["root.angle"]
    host.fmu.doStep(0.2, 0.1)
    assert derivatives(host, [ENERGY], TORQUE)[0] == pytest.approx(-angle, rel=1e-5)


def test_they_are_about_what_an_event_has_set(tmp_path):
    """Differences about that value. Regression: about the host's own, which acts no more, 12 % off in an energy."""
    event = {"name": "rougher", "time": "0.2 s", "set": {"root": {"friction_preload": "12 N.m"}}}
    scene = latching([event])
    (path,) = fanfold.export(scene, tmp_path, as_one=True)
    known, told = "root.friction_preload", ["root.angle", ENERGY]
    # both runs choose steps of their own, which differ by 1e-6 in their ends
    wide = 50.0 * WIDTH
    host = Host(path).start().to(0.3, 0.1)
    state = host.fmu.getFMUstate()
    host.fmu.doStep(0.3, 0.4)
    found, ends = derivatives(host, told, known), []
    for value in (12.0 + wide, 12.0 - wide):
        host.fmu.setFMUstate(state)
        host[known] = value
        host.fmu.doStep(0.3, 0.4)
        ends.append(np.array([host[name] for name in told]))
    np.testing.assert_allclose(found, (ends[0] - ends[1]) / (2.0 * wide), rtol=0.01)


def test_a_step_that_ends_at_latch_up_has_none(path):
    time = Host(path).start().to(1.0, 0.1)["HL.latch_time"]
    host = Host(path).start()
    host.fmu.doStep(0.0, time + TIME_ROUNDING)
    with pytest.raises(FMICallException):
        derivatives(host, MESSAGES, TORQUE)


def test_both_versions_of_fmi_give_and_declare_them(path, tmp_path):
    (newer,) = fanfold.export(latching(), tmp_path, as_one=True, driven_base=True, fmi="3.0")
    host, expected = Host3(newer, events=False, early=False), stepped(path, 0.3, 0.01)
    for _ in range(31):
        host.step(0.01)
    references = [host.reference(name) for name in MESSAGES]
    found = host.fmu.getDirectionalDerivative(references, [host.reference(TORQUE)], [1.0])
    rounding = 4.0 * np.finfo(float).eps / (8.0 * WIDTH)
    np.testing.assert_allclose(found, derivatives(expected, MESSAGES, TORQUE), rtol=1e-9, atol=rounding)
    assert b' providesDirectionalDerivatives="true"' in described(newer)
    assert b' providesDirectionalDerivative="true"' in described(path)
