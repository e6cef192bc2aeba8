"""Errors beside the energy that loads will put through a scene: a strip that is bent slowly, from nothing."""

import pytest

import orchestrator as fanfold
from orchestrator.run import load_energy, simulation

FORCE, LENGTH, MODULUS, WIDTH, HEIGHT = 0.03, 1.0, 70e9, 0.02, 0.002


def bent(until="5 s"):
    """A clamped strip, well damped, whose tip is pulled across by a force that grows for 4 s."""
    scene = fanfold.Scene("bent", until=until, tolerance=1e-3)
    scene.base(points={"o": (0, 0, 0)})
    section = {
        "width": WIDTH,
        "height": HEIGHT,
        "youngs_modulus": MODULUS,
        "poisson_ratio": 0.3,
        "density": 2700,
    }
    beam = {"length": LENGTH, "elements": 8, "rectangle": section}
    beam |= {"attachment_points": {"root": 0, "tip": LENGTH}}
    place = {"body": "base", "point": "o"}
    scene.body("strip", place=place, fidelity="large_deformation", damping_ratio=0.3, beam=beam)
    ports = {"inboard": {"body": "base", "point": "o"}, "outboard": {"body": "strip", "point": "root"}}
    scene.connection("clamp", "hinge", ports=ports, preset="fixed")
    law = [{"profile": "step5", "start": 0.0, "duration": 4.0, "change": FORCE}]
    scene.connection(
        "pull", "load", ports={"body": {"body": "strip", "point": "tip"}},
        structure={"direction": (0, 0, 1), "force": law},
    )  # fmt: skip
    return scene


def test_a_load_that_grows_from_nothing_takes_few_steps(monkeypatch):
    """Closed form: F^2 l^3 / 6 E I in the strip. Regression: at first all errors were large beside next to nothing."""
    found = fanfold.simulate(bent(), estimate=False)
    stored = FORCE**2 * LENGTH**3 / (6.0 * MODULUS * WIDTH * HEIGHT**3 / 12.0)
    # eight elements, shear, and the give of the clamp: below 1 %
    assert found["scene", "supplied_energy"][-1] == pytest.approx(stored, rel=1e-2)
    monkeypatch.setattr(simulation, "with_energy_of_loads", lambda assembly, *others: assembly)
    assert found.costs["steps"] < 0.65 * fanfold.simulate(bent(), estimate=False).costs["steps"]


def test_a_coarse_run_that_fails_leaves_the_run_as_it_is(monkeypatch):
    """The run asked for tells itself what is wrong."""

    def fails(*asked, **options):
        raise load_energy.RunError("no", None, "no")

    monkeypatch.setattr(load_energy, "run", fails)
    assert fanfold.simulate(bent("0.1 s"), estimate=False).costs["steps"] > 0
