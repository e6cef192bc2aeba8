"""The balance of energy: every participant's energies are found, and work from outside is not an error."""

import numpy as np
import pytest

from components import REGISTRY, SUPPLIED_ENERGY, Component, Layout, Quantity
from components.contract.component import Port
from orchestrator.assembly import Link
from orchestrator.cosim.energy_balance import Energies, energy_rows
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import InProcess, in_process
from orchestrator.cosim.settings import Settings
from tests.references.coupled import mastered, rigid

FORCE, MASS, END = 2.0, 3.0, 0.5


class Thruster(Component):
    """A constant force (N, x) on one port, and the work it has put in since the start."""

    kind = "thruster"

    def __init__(self):
        self._declare(
            {},
            ports=[Port("mount", "connection")],
            observations=[SUPPLIED_ENERGY],
        )

    def prepare(self, p):
        return None

    def initial(self, c, u):
        return np.array([u[0], 0.0])

    def step(self, c, x, u, h):
        return np.array([u[0], x[1] + FORCE * (u[0] - x[0])])

    def outputs(self, c, x, u):
        return np.array([FORCE, 0.0, 0.0, 0.0, 0.0, 0.0])

    def observe(self, c, x, u):
        return x[1:]

    @classmethod
    def example(cls):
        return cls()


# not one of Fanfold's components: tests that iterate over the registry must not find it there
REGISTRY.pop(Thruster.kind)


def test_supplied_energy_closes_the_balance():
    """Closed form: a constant force F on a mass m puts in (F t)^2 / 2 m, all of it kinetic; nothing is left over."""
    (body,) = in_process([rigid("ship", MASS, (1.0, 1.0, 1.0), {"tail": (0.0, 0.0, 0.0)})])
    network = Network(
        [body, InProcess("thruster", Thruster())], [Link(("ship", "tail"), ("thruster", "mount"))]
    )
    run = mastered(network, Settings(fixed_step=0.01))
    run.master.initialize(preload=False)
    run.master.run(END)
    stored, supplied = run.scene("stored_energy"), run.scene("supplied_energy")
    expected = (FORCE * END) ** 2 / (2.0 * MASS)
    assert supplied[-1] == pytest.approx(expected, rel=1e-9)
    assert stored[-1] - stored[0] == pytest.approx(expected, rel=1e-9)
    # rounding of a hundred sums of energies of 0.2 J
    assert np.abs(run.scene("energy_residual")).max() < 1e-12


class Observer:
    """A participant that only has observations."""

    def __init__(self, *names):
        self.observation_layout = Layout(Quantity(name, "J", "") for name in names)


def test_rows_of_all_energies():
    """Every energy is found where it stands, and what is missing points at the zero behind all."""
    rows = energy_rows(
        [
            Observer("angle", "potential_energy", "kinetic_energy"),
            Observer(),
            Observer("supplied_energy", "dissipated_energy", "numerical_dissipation"),
        ]
    )
    np.testing.assert_array_equal(rows, [[2, 6, 6], [1, 6, 6], [6, 6, 4], [6, 6, 5], [6, 6, 3]])


def test_balance_of_energies():
    found = Energies(kinetic=1.0, potential=2.0, dissipated=4.0, numerical=16.0, supplied=8.0)
    assert found.stored == 3.0
    assert found.balance == 15.0
