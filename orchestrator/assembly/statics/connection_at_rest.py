"""A connection at rest: its end-point wrenches, and their derivatives by the motion of its ports.

Frictionless, unless friction sticks: smooth friction has no derivative at rest. A kinematic latch is the lock that it
becomes, a spring of `lock_stiffness` at every hinge.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from components import REGISTRY, Component, ComponentError, Instance, left_product, rotation_matrix
from components.contract.component import Vector
from components.contract.frames import exponential, skew
from components.contract.instance import Value
from components.contract.ports import MOTION_SIZE, WRENCH_SIZE
from components.contract.roles import ORDER
from fmus.compiled import CompiledInstance, at_work

from ...scene.table import SceneError
from .. import Part

_STEP = 1e-5
"""m, rad, m/s and rad/s; central differences, whose errors of truncation and of round-off are then both 1e-11."""
_BENT, _FINE_STEP = 1e-3, 1e-8
"""Of the largest derivative, by which both sides of a step differ that is taken for too long, and one that is not."""
_KINKED = 0.5
"""Of the larger of both sides' derivatives, by which they differ between contact and none."""
_RIGID_MOTION = (0.31, -0.42, 0.27, 0.3, 0.5, -0.2)
"""m and rad; any motion on which the wrenches of a connection between bodies do not depend."""
_SAME = 1e-6
LEADING, LEADING_STEP = 4, 1.0
"""Steps, and their size (s), that lead connections to where bodies start at rest; they remember three at most."""


def at_rest(part: Part, *, sticks: bool = False) -> Part:
    """The part with end-point wrenches, without friction or hysteresis, and with a kinematic latch as its lock.

    sticks: friction that does stays, and holds what it can.
    """
    structure, start = dict(part.structure), dict(part.start)
    if REGISTRY[part.kind].has_wrench_mode():
        structure["wrench_mode"] = "endpoint"
    layout = replace(part, structure=structure).component().parameter_layout
    if structure.get("latch") == "kinematic":
        lock = float(layout.start_values()[layout["lock_stiffness"]][0])
        structure["latch"] = "spring"
        start |= {"latch_stiffness": start.get("lock_stiffness", lock), "latch_damping": 0.0}
    if "latch_automatic" in layout:
        start["latch_automatic"] = 0.0
    if not sticks:
        structure = {k: v for k, v in structure.items() if not k.startswith("hysteresis")}
        start |= {q.name: 0.0 for q in layout.quantities if q.name.startswith("friction")}
    return replace(part, structure=structure, start=start)


class Connection:
    """One connection with its state, which remembers the pose it was last moved to.

    `ports` are the names of its ports in order; motions are (ports, 13), wrenches (ports, 6), in world axes.
    """

    def __init__(self, part: Part, motions: Mapping[str, Vector]) -> None:
        self._build(at_rest(part), motions, Instance)

    def _build(
        self,
        resting: Part,
        motions: Mapping[str, Vector],
        make: Callable[[Component, Mapping[str, Value]], Instance | CompiledInstance],
    ) -> None:
        self.name = resting.name
        self.component = resting.component()
        self.ports = tuple(port.name for port in self.component.ports)
        start = {k: v for k, v in resting.start.items() if k in self.component.parameter_layout}
        self._law = make(self.component, start)
        self.put(np.array([motions[port] for port in self.ports]))
        try:
            self._law.initialize()
        except ComponentError as error:
            raise SceneError([f"{self.name}: {error}"]) from None

    @property
    def _instance(self) -> Instance:
        """Where its state and parameters can be changed."""
        assert isinstance(self._law, Instance)
        return self._law

    def put(self, motions: Vector) -> None:
        """Move the ports."""
        self._law.inputs[: MOTION_SIZE * len(self.ports)] = motions.ravel()

    def follow(self) -> None:
        """Remember the present pose, from which angles are counted on."""
        self._instance.update(False)

    def memory(self) -> tuple[Vector, Vector]:
        """State and parameters, which `remember` brings back."""
        return self._instance.state.copy(), self._instance.parameters.copy()

    def remember(self, state: Vector, parameters: Vector) -> None:
        """Bring a state and its parameters back; the ports stay where they are."""
        self._instance.state = state.copy()
        self._instance.set_parameters(parameters)

    def command(self, name: str, value: float) -> None:
        """Give a command where the component has it."""
        if name in self.component.input_layout:
            self._law.set(name, value)
            self._law.update(True)

    @property
    def state(self) -> Vector:
        """The state, as the component lays it out."""
        return self._instance.state

    @state.setter
    def state(self, state: Vector) -> None:
        self._instance.state = state

    def parameter(self, name: str) -> float:
        """Value of a scalar parameter."""
        return self._instance.parameter(name)

    def set_parameter(self, name: str, value: Value) -> None:
        """Change a parameter; SceneError where it does not fit the others."""
        self._instance.set(name, value)
        try:
            self._instance.constants  # noqa: B018 - checks them
        except ComponentError as error:
            raise SceneError([f"{self.name}: {error}"]) from None

    @property
    def commands_angle(self) -> bool:
        """Whether it turns its ports to an angle that it commands."""
        return "commanded_angle" in self.component.observation_layout

    def observe(self) -> dict[str, float]:
        """Scalars of the observations by name, in the present pose."""
        names = self.component.observation_layout.scalar_names()
        return dict(zip(names, self._instance.observe().tolist(), strict=True))

    @property
    def motions(self) -> Vector:
        """Motions (ports, 13) as they are put."""
        return self._law.inputs[: MOTION_SIZE * len(self.ports)].reshape(-1, MOTION_SIZE).copy()

    def wrenches(self) -> Vector:
        """Wrenches (ports, 6) in the present pose."""
        result: Vector = self._law.outputs()[: WRENCH_SIZE * len(self.ports)].reshape(-1, WRENCH_SIZE)
        return result

    def resting_wrenches(self) -> Vector:
        """The same of what comes to rest there."""
        return self.wrenches()

    def _wrenches_at(self, motions: Vector) -> Vector:
        held = self.motions
        self.put(motions)
        result = self.wrenches().copy()
        self.put(held)
        return result

    def stiffness(self) -> Vector:
        """(6 ports, 6 ports): minus the derivatives of the wrenches by small motions of the ports, in world axes.

        What connects bodies depends on their relative motion only: there the first port's columns follow from the
        others', so that a stiff connection resists no rigid motion by round-off.
        """
        motions = self.motions
        if not self._is_relative(motions):
            return self._differences(motions, False, 0)
        motions[:, :3] -= motions[0, :3]
        result = self._differences(motions, False, 1)
        turned = np.zeros((6 * len(motions), 6))
        for k, wrench in enumerate(self.wrenches()):
            turned[6 * k : 6 * k + 3, 3:] = -skew(wrench[:3])
            turned[6 * k + 3 : 6 * k + 6, 3:] = -skew(wrench[3:])
        result[:, :6] = -turned - result @ _rigid_motions(motions[:, :3])
        return result

    def damping(self) -> Vector:
        """(6 ports, 6 ports): the same by the rates of the ports."""
        motions = self.motions
        if not self._is_relative(motions):
            return self._differences(motions, True, 0)
        motions[:, :3] -= motions[0, :3]
        result = self._differences(motions, True, 1)
        result[:, :6] = -result @ _rigid_motions(motions[:, :3])
        return result

    def _differences(self, motions: Vector, of_rates: bool, first: int) -> Vector:
        """Minus the derivatives by the motions (or rates) of the ports from `first` on; other columns are zero.

        Where one side differs from the other, as at a contact that touches or a rope that goes slack within the step,
        by a step so small that it hardly leaves the side it is on; just between both, that of the stiffer side, as what
        touches there stays in touch.
        """
        result = np.zeros((6 * len(motions), 6 * len(motions)))
        bent = np.zeros(result.shape[1])
        here = self._wrenches_at(motions).ravel()
        for column in range(6 * first, 6 * len(motions)):
            low, high = self._beside(motions, of_rates, column, _STEP)
            result[:, column] = (low - high) / (2.0 * _STEP)
            bent[column] = np.abs(low + high - 2.0 * here).max() / (2.0 * _STEP)
        for column in np.flatnonzero(bent > _BENT * np.abs(result).max(initial=0.0)).tolist():
            low, high = self._beside(motions, of_rates, column, _FINE_STEP)
            sides = (low - here) / _FINE_STEP, (here - high) / _FINE_STEP
            between = np.abs(sides[0] - sides[1]).max() > _KINKED * max(np.abs(side).max() for side in sides)
            stiffer = max(sides, key=lambda side: float(np.abs(side).max()))
            result[:, column] = stiffer if between else 0.5 * (sides[0] + sides[1])
        return result

    def _beside(self, motions: Vector, of_rates: bool, column: int, size: float) -> tuple[Vector, Vector]:
        """Wrenches with one coordinate of one port (6 port + coordinate) smaller and larger by so much."""
        port, coordinate = divmod(column, 6)
        found = []
        for sign in (-1.0, 1.0):
            moved, step = motions.copy(), np.zeros(6)
            step[coordinate] = sign * size
            moved[port] = _with_rates(moved[port], step) if of_rates else displaced(moved[port], step)
            found.append(self._wrenches_at(moved).ravel())
        return found[0], found[1]

    def _is_relative(self, motions: Vector) -> bool:
        """Whether the wrenches go with a rigid motion of all ports, two or more, and take no note of a common rate."""
        if len(self.ports) < 2:
            return False
        step = np.array(_RIGID_MOTION)
        turn = rotation_matrix(exponential((step[3], step[4], step[5])))
        before = self.wrenches()
        moved = np.array([displaced(m, np.concatenate((np.zeros(3), step[3:]))) for m in motions])
        moved[:, :3] = motions[:, :3] @ turn.T + step[:3]
        carried = np.array([_with_rates(m, _rigid(m[:3] - motions[0, :3]) @ step) for m in motions])
        after = self._wrenches_at(moved).reshape(-1, 3) @ turn
        allowed = _SAME * (1.0 + np.abs(before).max(initial=0.0))
        return bool(
            np.abs(after - before.reshape(-1, 3)).max(initial=0.0) < allowed
            and np.abs(self._wrenches_at(carried) - before).max(initial=0.0) < allowed
        )


class LedConnection(Connection):
    """One that rests as in a run that starts there: led by a few steps from where it was built, with all its friction.

    Its derivatives are those of friction that sticks. Every pose is led to anew, so it remembers none.
    """

    def __init__(self, part: Part, motions: Mapping[str, Vector]) -> None:
        self._build(at_rest(part, sticks=True), motions, partial(at_work, makes_steps=False))
        component = part.component()
        start = {k: v for k, v in part.start.items() if k in component.parameter_layout}
        if ORDER.name in component.parameter_layout:
            start[ORDER.name] = 4.0
        self._led = at_work(component, start, makes_steps=True)
        self._led.inputs[: MOTION_SIZE * len(self.ports)] = self.motions.ravel()
        self._led.initialize()

    def follow(self) -> None:
        """Nothing to remember."""

    def memory(self) -> tuple[Vector, Vector]:
        """Nothing to bring back."""
        return np.zeros(0), np.zeros(0)

    def remember(self, state: Vector, parameters: Vector) -> None:
        """Nothing to bring back."""

    def command(self, name: str, value: float) -> None:
        """Give a command where the component has it."""
        super().command(name, value)
        if name in self.component.input_layout:
            self._led.set(name, value)

    def resting_wrenches(self) -> Vector:
        """Wrenches (ports, 6) of what comes to rest in the present pose."""
        led = self._led
        led.return_to_start()
        led.inputs[: MOTION_SIZE * len(self.ports)] = self.motions.ravel()
        for _ in range(LEADING):
            led.step(LEADING_STEP)
        result: Vector = led.outputs()[: WRENCH_SIZE * len(self.ports)].reshape(-1, WRENCH_SIZE)
        return result


def displaced(motion: Vector, step: Vector) -> Vector:
    """A port's motion (13,) after a translation and a rotation vector (6,) in world axes."""
    result = motion.copy()
    result[:3] += step[:3]
    result[3:7] = left_product(exponential((step[3], step[4], step[5]))) @ motion[3:7]
    return result


def _with_rates(motion: Vector, rates: Vector) -> Vector:
    result = motion.copy()
    result[7:] = rates
    return result


def _rigid(arm: Vector) -> Vector:
    """Motion (6, 6) of a point at an arm under unit translations and rotations about the origin."""
    result = np.eye(6)
    result[:3, 3:] = -skew(arm)
    return result


def _rigid_motions(arms: Vector) -> Vector:
    """The same (6 points, 6) of points at arms (points, 3)."""
    return np.concatenate([_rigid(arm) for arm in arms])
