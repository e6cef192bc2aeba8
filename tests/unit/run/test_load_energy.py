"""Errors beside the energy that loads will put through a scene: a bar that is pushed slowly from nothing."""

import pytest

import orchestrator as fanfold
from orchestrator.run import load_energy

STIFFNESS, FORCE, MASS = 2e3, 5.0, 0.4


def pushed(**header):
    """A mass held by a bolt as a spring, pushed along it by a force that grows for 4 s."""
    scene = fanfold.Scene("pushed", until="5 s", tolerance=1e-5, **header)
    scene.base(points={"o": (0, 0, 0)})
    rigid = {"mass": MASS, "inertia": (1e-2,) * 3, "points": {"end": (0.0, 0.0, 0.0)}}
    scene.body("bar", rigid=rigid, place={"body": "base", "point": "o"})
    ports = {"inboard": {"body": "base", "point": "o"}, "outboard": {"body": "bar", "point": "end"}}
    scene.connection(
        "spring",
        "hinge",
        ports=ports,
        preset="fixed",
        parameters={"translational_stiffness": (STIFFNESS,) * 3},
    )
    law = [{"profile": "step5", "start": 0.0, "duration": 4.0, "change": FORCE}]
    scene.connection(
        "push", "load", ports={"body": {"body": "bar", "point": "end"}},
        structure={"direction": (1, 0, 0), "force": law},
    )  # fmt: skip
    return scene


def test_a_load_that_grows_from_nothing_takes_few_steps():
    """Closed form: F^2 / 2 k in the spring. Regression: at first all errors were large beside next to nothing."""
    found = fanfold.simulate(pushed(), estimate=False)
    assert found.costs["steps"] < 2_000
    assert found["spring", "potential_energy"][-1] == pytest.approx(0.5 * FORCE**2 / STIFFNESS, rel=1e-4)


def test_a_coarse_run_that_fails_leaves_the_run_as_it_is(monkeypatch):
    """The run asked for tells itself what is wrong."""

    def fails(*asked, **options):
        raise load_energy.RunError("no", None, "no")

    monkeypatch.setattr(load_energy, "run", fails)
    assert fanfold.simulate(pushed(), estimate=False, until="0.1 s").costs["steps"] > 0
