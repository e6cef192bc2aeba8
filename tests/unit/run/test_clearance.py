"""Joints with play: closed forms of a mass between two walls and of a journal that circles in a hole."""

import numpy as np
import pytest

import orchestrator as fanfold
from components import Instance
from components.hinge import Hinge
from fmus.compiled import at_work
from orchestrator.assembly.assemble import assemble
from tests.references.closed_forms import bouncing
from tests.references.native_fmus import needs_native

MASS, STIFFNESS, PLAY, RATE = 2.0, 5e6, 5e-4, 0.05
"""kg, N/m, m either way, m/s."""
FREQUENCY = np.sqrt(STIFFNESS / MASS)
BEYOND_ALL = {
    "translational_stiffness": (3e3, 5e3, 5e3), "translational_damping": (20.0, 30.0, 30.0),
    "rotational_stiffness": (700.0, 900.0, 900.0), "rotational_damping": (1.0, 4.0, 4.0),
    "axial_clearance": 1e-3, "radial_clearance": 2e-3, "twist_clearance": 3e-3, "cross_clearance": 4e-3,
}  # fmt: skip
"""Of a hinge; SI units."""


def pin(until, place=(0, 0, 0), velocity=(RATE, 0, 0), damping=0.0, **parameters):
    """A body on a bushing at rest in all directions that are not loose."""
    scene = fanfold.Scene("loose", until=until, preload=False)
    scene.base(points={"hole": (0, 0, 0)})
    rigid = {"mass": MASS, "center_of_mass": (0, 0, 0), "inertia": (1,) * 3, "points": {"pin": (0, 0, 0)}}
    at = {"body": "base", "point": "hole", "offset": place}
    scene.body("pin", place=at, velocity=velocity, rigid=rigid)
    stiff = {"translational_stiffness": (STIFFNESS,) * 3, "rotational_stiffness": (1e4,) * 3}
    scene.connection(
        "bush", preset="bushing", axes={"x": (1, 0, 0)},
        ports={"inboard": ("base", "hole"), "outboard": ("pin", "pin")},
        parameters={**stiff, "translational_damping": (damping,) * 3, **parameters},
    )  # fmt: skip
    return scene


def test_a_mass_bounces_between_two_walls():
    """Closed form, at the default tolerance, over 13 impacts: straight through the play, half a sine in each wall."""
    found = fanfold.simulate(pin(0.3, axial_clearance=PLAY), estimate=False)
    expected = bouncing(found.time, PLAY, RATE, FREQUENCY)
    assert found["pin", "frame_position"][:, 0] == pytest.approx(expected, abs=1e-5 * np.ptp(expected))
    force = np.abs(found["bush", "axial_force"][:])
    assert force.max() == pytest.approx(RATE * np.sqrt(STIFFNESS * MASS), rel=1e-4)
    assert found.headline.energy_residual < 1e-6


def test_damping_acts_beyond_the_play():
    """Closed form: each half cycle in a wall leaves exp(-pi z / sqrt(1 - z^2)) of the rate, the play all of it."""
    ratio = 0.1
    scene = pin(0.1, damping=2.0 * ratio * FREQUENCY * MASS, axial_clearance=PLAY)
    found = fanfold.simulate(scene, estimate=False)
    place = found["pin", "frame_position"][:, 0]
    loose = np.abs(place) < 0.9 * PLAY
    rates = np.abs(found["pin", "linear_momentum"][:, 0])[loose] / MASS
    bounces = np.cumsum(np.diff(np.flatnonzero(loose), prepend=0) > 1)
    assert bounces[-1] >= 2
    assert rates == pytest.approx(
        RATE * np.exp(-np.pi * ratio / np.sqrt(1.0 - ratio**2)) ** bounces, rel=1e-3
    )


def test_a_journal_that_circles_keeps_radius_rate_and_energy():
    """Closed form: m v^2 / r = k (r - c). A damper has nothing to brake but the turn of the deflection, 1e-3 of it."""
    deep = 2e-5
    radius = PLAY + deep
    rate = np.sqrt(STIFFNESS * deep * radius / MASS)
    scene = pin(0.05, (0, radius, 0), (0, 0, rate), radial_clearance=PLAY)
    found = fanfold.simulate(scene, estimate=False)
    _, y, z = found["pin", "frame_position"][:].T
    assert np.hypot(y, z) == pytest.approx(radius, abs=2e-4 * deep)
    angle = np.unwrap(np.arctan2(z, y))
    assert angle[-1] > 2.0 * np.pi
    assert angle == pytest.approx(rate / radius * found.time, abs=2e-4)
    assert found.headline.energy_residual < 1e-6


def test_hinges_of_a_line_have_the_clearances_of_the_scene_or_their_own():
    """Definition: those of [joint] where the hinge has stiffness, and 0 is a hinge without."""
    scene = fanfold.Scene("line", until=1.0)
    scene.base(points={"a": (0, 0, 0), "b": (0, 1, 0)})
    rigid = {"mass": 1, "center_of_mass": (1, 0, 0), "inertia": (1,) * 3}
    scene.body("leaf", rigid={**rigid, "points": {"a": (0, 0, 0), "b": (0, 1, 0)}})
    scene.joint(axial_clearance="0.2 mm", radial_clearance="0.1 mm", cross_clearance="1 mrad")
    hinges = [
        {"name": "left", "inboard": "a", "outboard": "a", "radial_clearance": 0},
        {
            "name": "right",
            "inboard": "b",
            "outboard": "b",
            "kind": "cylindrical",
            "cross_clearance": "2 mrad",
        },
    ]
    scene.hinge_line("HL", "base", "leaf", axis="+y", aligned_angle="90 deg", hinges=hinges)
    scene.connection("pin", preset="universal", ports={"inboard": ("base", "a"), "outboard": ("leaf", "a")})
    parts = {part.name: part.start for part in assemble(scene.check()).parts}
    found = [
        {name: parts[hinge].get(f"{name}_clearance", 0.0) for name in ("axial", "radial", "cross")}
        for hinge in ("left", "right", "pin")
    ]
    assert found == [
        {"axial": 2e-4, "radial": 0.0, "cross": 1e-3},
        {"axial": 0.0, "radial": 1e-4, "cross": 2e-3},
        {"axial": 2e-4, "radial": 1e-4, "cross": 1e-3},
    ]


@needs_native
def test_native_and_python_agree_at_an_instant():
    """Independent implementations, beyond all four clearances, to round-off; `test_native_twins` has steps."""
    component = Hinge(wrench_mode="endpoint")
    seen = []
    for one in (at_work(component, BEYOND_ALL, makes_steps=False), Instance(component, BEYOND_ALL)):
        one.set("outboard.position", (3e-3, -2e-3, 4e-3))
        one.set("outboard.orientation", (np.cos(0.01), *(np.sin(0.01) * np.array((0.6, 0.64, -0.48)))))
        one.set("outboard.velocity", (0.1, 0.2, -0.1))
        one.initialize()
        seen.append(one.outputs())
    native, python = seen
    assert np.abs(python[:6]).min() > 0.1
    assert native == pytest.approx(python, rel=1e-12, abs=1e-12)


def test_a_clearance_without_stiffness_is_refused():
    with pytest.raises(fanfold.FanfoldError, match=r"twist_clearance .* no stiffness there"):
        pin(0.1, twist_clearance="1 mrad", rotational_stiffness=(0, 1e4, 1e4)).check()
    with pytest.raises(fanfold.FanfoldError, match="radial_clearance needs equal stiffness"):
        pin(0.1, radial_clearance="1 mm", translational_stiffness=(1e6, 1e6, 2e6)).check()
