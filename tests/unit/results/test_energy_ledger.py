"""The accounts of a run's energy: what was exchanged, and when a residual is more than the tolerance allows."""

import json

import numpy as np
import pytest

from orchestrator.results.energy_ledger import EnergyLedger, energy_ledger
from orchestrator.results.key_figures import headline
from orchestrator.results.recorder import SignalGroup
from orchestrator.results.result import Result
from orchestrator.results.result_file import ResultWriter

TIME = np.linspace(0.0, 1.0, 11)
STANDING = 24e3
"""J that a spring keeps all the time."""


def written(path, accounts, residual=0.0, tolerance="0.0001"):
    """A result of energies by component and variable, with a largest residual."""
    scene = {"energy_residual": residual * TIME, "numerical_dissipation": 0.0 * TIME}
    found = {**accounts, "scene": scene}
    groups = [
        SignalGroup(name, tuple(v), ("J",) * len(v), (1,) * len(v), tuple(v)) for name, v in found.items()
    ]
    with ResultWriter(path, groups, {"tolerance": tolerance}, {}, ()) as writer:
        for k, time in enumerate(TIME):
            writer.append(
                time, [np.array([v[k] for v in variables.values()]) for variables in found.values()]
            )
    return Result.open(path)


def pendulum(path, **options):
    """Two joules to and fro beside a spring under load, without any motor."""
    moving = 2.0 * np.sin(np.pi * TIME) ** 2
    accounts = {
        "bob": {"kinetic_energy": moving, "potential_energy": 5.0 - moving},
        "spring": {"potential_energy": STANDING + 0.0 * TIME},
    }
    return written(path, accounts, **options)


def test_energy_that_only_stands_there_is_not_exchanged(tmp_path):
    """Definition: what one account gains the others lose; 24 kJ that no one touches are no part of it."""
    found = energy_ledger(pendulum(tmp_path / "run.h5"))
    assert found.exchanged == pytest.approx(2.0, rel=1e-12)


def test_what_rounding_leaves_where_nothing_moves_is_no_warning(tmp_path):
    """A panel that sags at rest. Regression: "numbers may be wrong by as much", of 2e-9 J beside 1.4 J."""
    tremble = 5e-8 * np.sin(np.pi * TIME) ** 2
    accounts = {"panel": {"kinetic_energy": tremble, "potential_energy": -1.4 - tremble}}
    assert energy_ledger(written(tmp_path / "rest.h5", accounts, residual=2e-9)).warnings() == ()
    assert energy_ledger(written(tmp_path / "off.h5", accounts, residual=2e-8)).warnings()


def test_a_gain_within_one_kind_counts(tmp_path):
    """Definition: energy that goes from spring to spring is exchanged, though their sum stays."""
    accounts = {"a": {"potential_energy": 3.0 - TIME}, "b": {"potential_energy": TIME}}
    assert energy_ledger(written(tmp_path / "run.h5", accounts)).exchanged == pytest.approx(1.0)


def test_supplied_energy_is_exchanged_once(tmp_path):
    """Definition: the work of a drive is a loss of what is outside and a gain of the body."""
    accounts = {"drive": {"supplied_energy": 4.0 * TIME}, "body": {"kinetic_energy": 4.0 * TIME}}
    assert energy_ledger(written(tmp_path / "run.h5", accounts)).exchanged == pytest.approx(4.0)


def test_free_flight_is_judged_by_its_motion(tmp_path):
    """Nothing is exchanged there; the residual is that of what moves."""
    result = written(tmp_path / "run.h5", {"body": {"kinetic_energy": 7.0 + 0.0 * TIME}}, residual=7e-6)
    assert energy_ledger(result).relative_residual == pytest.approx(1e-6)


@pytest.mark.parametrize(("residual", "warned"), [(3.9e-4, False), (4.1e-4, True)])
def test_a_residual_beyond_the_tolerance_is_told(tmp_path, residual, warned):
    """Twice the relative accuracy of velocities, 1e-4, of 2 J."""
    found = headline(pendulum(tmp_path / "run.h5", residual=residual))
    assert len(found.warnings) == warned
    assert len(json.loads(json.dumps(found.as_dict()))["warnings"]) == warned
    assert any("energy balance" in sentence for sentence in found.warnings) == warned


def test_a_result_that_tells_no_tolerance_is_not_judged(tmp_path):
    assert headline(pendulum(tmp_path / "run.h5", residual=1.0, tolerance="unknown")).warnings == ()


def test_nothing_moved():
    found = EnergyLedger(exchanged=0.0, numerical=0.0, residual=0.0, tolerance=1e-4)
    assert found.relative_residual is None
    assert found.warnings() == ()
