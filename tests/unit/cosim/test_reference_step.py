"""Steps of the master against the coupling scheme in plain Python: the same motions, wrenches and energies.

Both step participants of the same kind, so that they differ by what the master's iteration leaves alone. How far that
goes the reference tells itself: in a second run the solution of each of its steps is off by the tolerance of that
iteration in every wrench, at random up or down. The worst pattern of n signs does sqrt(n) times as much.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace
from math import sqrt
from pathlib import Path

import numpy as np
import pytest

from orchestrator.assembly import Assembly, Part
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import Participant, Vector, in_process
from orchestrator.cosim.ports import Order, carried
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import as_fmus
from orchestrator.scene.builder import Scene
from tests.references.coupled import base, between, mastered, rigid
from tests.references.coupled_step import CoupledStep, Step, bend
from tests.references.native_fmus import needs_native
from tests.references.panels import one_panel

FREE = Path(__file__).parents[2] / "scenes" / "two_panels_free.toml"
TOLERANCE: Mapping[Order, float] = {2: 1e-8, 4: 1e-7}
ITERATED = 1e-10
"""Correction, of the largest wrench and 1 N, that ends iterations of runs of these tolerances."""
CLOSE = 1e-4
"""Of the largest value in a unit: the most that what the iteration leaves may be, for a comparison to tell anything."""


@dataclass(frozen=True)
class Case:
    """A scene with these bodies rigid, its order, size (s) and number of steps.

    start: values that bodies start from beside those of the scene. latched: hinges that latch at once.
    """

    scene: Callable[[], Scene]
    rigid: Sequence[str]
    order: Order
    h: float
    steps: int
    start: Mapping[str, Mapping[str, tuple[float, ...]]] = field(default_factory=dict)
    latched: Sequence[str] = ()

    def assembled(self) -> Assembly:
        """With these start values."""
        found = assemble(self.scene().check(), rigid=set(self.rigid))
        parts = [replace(part, start={**part.start, **self.start.get(part.name, {})}) for part in found.parts]
        return replace(found, parts=tuple(parts))


def panel(start_angle: str) -> Scene:
    """A rigid panel on two hinges with motor and spring latch."""
    return one_panel().with_settings({"hinge_line.line.start_angle": start_angle})


def panel_with_strip() -> Scene:
    """The panel with a strip that bends at will, whose wrenches have no slopes."""
    scene = panel("178 deg")
    section = {"width": "20 mm", "height": "20 mm", "youngs_modulus": "70 GPa", "density": "2700 kg/m3"}
    beam = {"length": "1 m", "elements": 3, "rectangle": section | {"poisson_ratio": 0.3}}
    beam |= {"attachment_points": {"root": 0, "tip": "1 m"}}
    place = {"body": "panel", "point": "left"}
    scene.body("strip", place=place, fidelity="large_deformation", damping_ratio=0.01, beam=beam)
    ports = {"inboard": {"body": "panel", "point": "left"}, "outboard": {"body": "strip", "point": "root"}}
    scene.connection("clamp", "hinge", ports=ports, preset="fixed")
    return scene


HINGES = ("left", "right")
CLOSING = {"panel": {"initial_velocity": (0.0, 0.0, 0.4), "initial_angular_velocity": (0.0, -0.5, 0.0)}}
TUMBLING = {"base": {"initial_angular_velocity": (0.01, 0.02, -0.01)}}
CASES = {
    "motor": Case(lambda: panel("20 deg"), ["all"], 4, 2e-2, 10),
    "latched": Case(lambda: panel("178 deg"), ["all"], 4, 2e-3, 10, CLOSING, HINGES),
    "latched, order 2": Case(lambda: panel("178 deg"), ["all"], 2, 2e-3, 10, CLOSING, HINGES),
    "loops, damper, friction": Case(lambda: Scene.load("amos3"), ["all"], 4, 5e-3, 10),
    "loops, damper, friction, order 2": Case(lambda: Scene.load("amos3"), ["all"], 2, 5e-3, 10),
    "flexible": Case(lambda: Scene.load("workbench"), [], 4, 5e-3, 20),
    "flexible, order 2": Case(lambda: Scene.load("workbench"), [], 2, 5e-3, 20),
    "free base": Case(lambda: Scene.load(FREE), ["all"], 4, 1e-2, 20, TUMBLING),
    "order 2 in a network of order 4": Case(panel_with_strip, ["panel"], 4, 2e-3, 10, CLOSING, HINGES),
}
IN_PROCESS = {"latched": 10, "free base": 5, "loops, damper, friction, order 2": 3}
"""Numbers of steps; the master finds derivatives of components by differences."""


def latch(network: Network, hinges: Sequence[str]) -> None:
    """Have them latch where they are."""
    for name in hinges:
        hinge = network.by_name[name]
        hinge.inputs[hinge.input_layout["latch_command"]] = 1.0


def referenced(network: Network, case: Case, seed: int | None = None) -> list[Step]:
    """Steps of the reference; with a seed its solutions are off by the tolerance of the master's."""
    reference, rng = CoupledStep(network), np.random.default_rng(seed)
    latch(network, case.latched)
    reference.initialize()
    for _ in range(case.steps):
        reference.solve(case.h)
        if seed is not None:
            loads = reference.wrenches.reshape(-1, 2, 3)
            errors = ITERATED * (1.0 + np.abs(loads).max((0, 2)))[:, None]
            loads += errors * rng.choice((-1.0, 1.0), loads.shape)
            reference.sweep(case.h)
        reference.accept(case.h)
    return reference.made


def of_master(network: Network, case: Case, assembly: Assembly) -> list[Step]:
    """Steps of the master, as participants are when it has made each."""
    settings = Settings(TOLERANCE[case.order], fixed_step=case.h, order=case.order)
    master = mastered(network, settings, assembly.hinge_lines).master
    latch(network, case.latched)
    master.initialize(preload=False)
    made = []
    for k in range(case.steps):
        master.run((k + 1) * case.h)
        outputs = {p.name: p.outputs.copy() for p in network.participants}
        observations = {p.name: p.observe().copy() for p in network.participants}
        made.append(Step(master.time, case.h, np.zeros(0), outputs, observations))
    assert master.statistics.steps == case.steps
    return made


def quantities(network: Network, made: Sequence[Step]) -> Iterator[tuple[str, str, Vector]]:
    """Name, unit and values (steps, size) of what participants exchange, and of their energies."""
    for participant in network.participants:
        name, layout = participant.name, participant.output_layout
        values = np.array([step.outputs[name] for step in made])
        for quantity in layout.quantities:
            place = layout[quantity.name]
            if place.stop <= carried(layout, network.order_of(name)):
                yield f"{name}.{quantity.name}", quantity.unit, values[:, place]
        layout = participant.observation_layout
        values = np.array([step.observations[name] for step in made])
        for quantity in layout.quantities:
            if quantity.unit == "J":
                yield f"{name}.{quantity.name}", quantity.unit, values[:, layout[quantity.name]]


def assert_alike(
    case: Case, load: Callable[[Assembly], AbstractContextManager[Sequence[Participant]]]
) -> None:
    assembly = case.assembled()
    ways = (
        lambda network: referenced(network, case),
        lambda network: referenced(network, case, seed=1),
        lambda network: of_master(network, case, assembly),
    )
    runs = []
    for make in ways:
        with load(assembly) as participants:
            network = Network(participants, assembly.links, case.order)
            runs.append(list(quantities(network, make(network))))
    worst = sqrt(network.size * case.steps)
    largest: dict[str, float] = {}
    for _, unit, values in runs[0]:
        largest[unit] = max(largest.get(unit, 0.0), float(np.abs(values).max()))
    for (name, unit, expected), (_, _, off), (_, _, found) in zip(*runs, strict=True):
        allowed = worst * float(np.abs(off - expected).max())
        assert allowed <= CLOSE * largest[unit], name
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=allowed, err_msg=name)


@needs_native
@pytest.mark.parametrize("name", CASES)
def test_native_fmus(name):
    assert_alike(CASES[name], lambda assembly: as_fmus(assembly, "native"))


@pytest.mark.parametrize("name", IN_PROCESS)
def test_in_process(name):
    case = replace(CASES[name], steps=IN_PROCESS[name])
    assert_alike(case, lambda assembly: nullcontext(in_process(assembly.parts)))


def test_reference_of_an_oscillator():
    """Closed form: a step of order 4 turns the phase by 2 atan x / (1 - x^2 / 3), x = w h / 2, and keeps the amplitude.

    That is the diagonal Pade approximant of exp(i w h). What damps unresolved coordinates goes with a power of w h, and
    takes less than rounding here.
    """
    mass, stiffness, speed, h = 4.0, 900.0, 0.3, 2e-3
    w = sqrt(stiffness / mass)
    x = 0.5 * w * h
    phase, amplitude = 2.0 * np.arctan2(x, 1.0 - x * x / 3.0), speed / w
    start = {"initial_velocity": (speed, 0.0, 0.0)}
    joint = Part("joint", "hinge", {}, {"translational_stiffness": (stiffness,) * 3})
    parts = [base(point=(0, 0, 0)), rigid("body", mass, (1, 1, 1), {"point": (0, 0, 0)}, **start), joint]
    reference = CoupledStep(Network(in_process(parts), between("joint", "base.point", "body.point"), 4))
    reference.initialize()
    found = [reference.advance(h).outputs["body"][0] for _ in range(50)]
    expected = amplitude * np.sin(phase * np.arange(1, 51))
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-13 * amplitude)


COEFFICIENTS = np.random.default_rng(1).normal(size=(5, 6))
SIZES = (0.1, 0.3, 0.2, 0.25)
H = SIZES[-1]


def steps(degree: int, order: Order, wrong: float = 0.0) -> list[Step]:
    """Steps of a port whose mean wrenches are polynomials of time at their middles, with rates that may be wrong."""
    made, end, powers = [], 0.0, np.arange(degree + 1)
    for k, h in enumerate(SIZES):
        end += h
        middle = end - 0.5 * h
        mean = middle**powers @ COEFFICIENTS[: degree + 1]
        rate = (powers * middle ** np.maximum(powers - 1, 0)) @ COEFFICIENTS[: degree + 1]
        slope = 0.5 * h * (rate + wrong * k**2)
        made.append(Step(end, h, mean if order == 2 else np.concatenate((mean, slope)), {}, {}))
    return made


@pytest.mark.parametrize("points", [3, 4])
def test_all_of_a_parabola_bends_at_order_two(points):
    """Closed form: h^2 u'' is 2 c h^2, whatever the sizes of steps."""
    np.testing.assert_allclose(bend(steps(2, 2)[-points:], 1), [2.0 * COEFFICIENTS[2] * H**2], rtol=1e-11)


def test_right_slopes_leave_the_fourth_derivative():
    """Closed form: -h^4 u''''/12 of a quartic is -2 c h^4, whatever the sizes of steps."""
    np.testing.assert_allclose(bend(steps(4, 4)[-3:], 1), [-2.0 * COEFFICIENTS[4] * H**4], rtol=1e-9)


def test_wrong_slopes_leave_a_third_derivative():
    """Closed form: h^3 u'''/12 of a cubic is c h^3 / 2, whatever slopes tell."""
    np.testing.assert_allclose(bend(steps(3, 4, 1e3), 1), [0.5 * COEFFICIENTS[3] * H**3], rtol=1e-9)


def test_error_is_the_work_of_what_bends():
    """Closed form: a force of 2 c h^2 moves a mass by h^2 / 2 m of it, a torque turns it by h^2 / 2 J.

    Of both bodies that a joint without stiffness holds the base does not move; wrenches are zero in the last step.
    """
    mass, inertia, energy = 3.0, (2.0, 3.0, 4.0), 5.0
    parts = [
        base(point=(0, 0, 0)),
        rigid("body", mass, inertia, {"point": (0, 0, 0)}),
        Part("joint", "hinge", {}, {}),
    ]
    network = Network(in_process(parts), between("joint", "base.point", "body.point"))
    reference, (*made, present) = CoupledStep(network), steps(2, 2)
    reference.initialize()
    reference.time = made[-1].time
    reference.made = [step._replace(wrenches=np.tile(step.wrenches - present.wrenches, 2)) for step in made]
    reference.sweep(H)
    bends, mobility = 2.0 * COEFFICIENTS[2] * H**2, 0.5 * H**2 / np.array((*[mass] * 3, *inertia))
    assert reference.error_square(H, energy) == pytest.approx(bends**2 @ mobility / energy, rel=1e-6)
