"""A damper of another tool, which cannot return to a saved state, on a wing that the implicit master steps."""

from pathlib import Path

import numpy as np
import pytest
from pythonfmu.builder import FmuBuilder

import orchestrator as fanfold

COEFFICIENT = 28.76
"""N.m.s/rad, of the wing's own damper"""
_SLAVE = """
from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class SpringDamper(Fmi2Slave):
    def __init__(self, **keys):
        super().__init__(**keys)
        self.angle = self.rate = self.torque = self.stiffness = self.damping = 0.0
        self.default_experiment = DefaultExperiment(step_size=0.01)
        for name in ("angle", "rate"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in ("stiffness", "damping"):
            self.register_variable(
                Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed)
            )
        self.register_variable(Real("torque", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.torque = -(self.stiffness * self.angle + self.damping * self.rate)
        return True
"""
HINGES = ("hl1_hinge", "hl2_left", "hl3_left")

pytestmark = pytest.mark.filterwarnings("ignore:fmu.foreign.*W-fmu-unit")


@pytest.fixture(scope="module")
def spring_damper(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fmu")
    source = folder / "springdamper.py"
    source.write_text(_SLAVE, encoding="utf-8")
    return Path(FmuBuilder.build_FMU(str(source), dest=str(folder)))


def angles(wing):
    """Angles (rad) of all lines after 0.7 s."""
    run = fanfold.simulate(wing, rigid="all", tolerance=1e-3, until=0.7, estimate=False)
    return np.array([run[hinge, "angle"][-1] for hinge in HINGES])


def with_foreign(file, **keys):
    """AMOS-3 whose damper is that FMU: it reads the root hinge and loads the yoke about its line."""
    wing = fanfold.load("amos3").with_settings({"damper.damper.damping_coefficient": 1e-9})
    wing.connection(
        "brake", "load", ports={"body": {"body": "yoke", "point": "hl1"}}, structure={"direction": (0, 1, 0)}
    )
    wing.fmu(
        "foreign", file, parameters={"damping": COEFFICIENT}, **keys,
        inputs={"angle": "hl1_hinge.angle", "rate": "hl1_hinge.angular_rate"},
        outputs={"torque": "brake.added_torque"},
    )  # fmt: skip
    return wing


@pytest.mark.filterwarnings("ignore:.*W-not-opened")  # it ends before
def test_a_foreign_damper_acts_as_ours(spring_damper):
    """Independent path: the damper within the implicit step; one that is sampled errs with its step.

    By half a step of delay, from 10 ms, which its file documents, to 4 ms.
    """
    own = angles("amos3")
    documented, finer = (
        np.abs(angles(with_foreign(spring_damper, **keys)) / own - 1.0).max()
        for keys in ({}, {"step": "4 ms"})
    )
    assert documented < 0.01
    assert 0.35 < finer / documented < 0.45
