"""A body of an assembly at rest: its pose, generalised forces, and their exact derivatives.

Its coordinates are six small rigid motions in world axes, the translation of its centre of mass and a rotation vector
about it, then its modal coordinates. A base that is fixed or moves by a law has the six about its reference point.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from components import ComponentError, Instance, Layout, rotation_matrix
from components.body import Body
from components.contract.component import Vector
from components.contract.frames import Quaternion, Vector3, exponential, multiply, normalized, rotate, skew
from components.contract.ports import MOTION_SIZE, WRENCH_SIZE
from components.driven_base import DrivenBase
from components.fixed_base import FixedBase
from components.moving_base import MovingBase

from ...scene.table import SceneError
from .. import Part

Memory = tuple[Any, ...]


class PlacedBody:
    """A body or base at rest: origin `position` (3,) of its coordinates, quaternion, modal coordinates.

    is_led: it stands, or moves by a law.
    """

    is_led: bool

    def __init__(self, part: Part) -> None:
        self.name = part.name
        component = part.component()
        start = {name: value for name, value in part.start.items() if name in component.parameter_layout}
        self._instance = Instance(component, start)
        try:
            self._instance.initialize()
        except ComponentError as error:
            raise SceneError([f"{self.name}: {error}"]) from None
        self.component = component
        self.ports = tuple(port.name for port in component.ports)
        self.eta = np.zeros(0)
        self._place(part)

    def _place(self, part: Part) -> None:
        component = self.component
        state, at = self._instance.state, component.state_layout
        self.is_led = not isinstance(component, Body)
        self.orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)
        if isinstance(component, Body):
            self.body: Body | None = component
            self.modes = component.modes
            self.position = state[at["position"]].copy()
            self.orientation = tuple(state[at["orientation"]].tolist())
            self._arms = component.arms
            self._shapes = np.concatenate((component.translation, component.rotation), axis=1)
            self._second_order = component.second_order
        elif isinstance(component, FixedBase | MovingBase | DrivenBase):
            self.body, self.modes = None, 0
            self.position = component.reference()
            motions = self.motions()
            self._arms = motions[:, :3] - self.position
            self._shapes = np.zeros((len(motions), 6, 0))
            self._second_order = np.zeros((len(motions), 6, 0, 0))
        else:
            raise SceneError([f"{self.name}: a {part.kind} has no linear model; bodies and fixed bases have"])
        self.eta = np.zeros(self.modes)

    @property
    def points(self) -> Vector:
        """(1, 3), about which the rigid coordinates are."""
        found: Vector = self.position[None]
        return found

    def memory(self) -> Memory:
        """Where it is."""
        return self.position, self.orientation, self.eta

    def remember(self, memory: Memory) -> None:
        """Come back to there."""
        self.position, self.orientation, self.eta = memory

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return 6 + self.modes

    @property
    def axes(self) -> Vector:
        """(3, 3) body to world."""
        return rotation_matrix(self.orientation)

    def place(self, position: Vector3, orientation: Quaternion) -> None:
        """Put the construction frame of a body there, undeformed."""
        assert self.body is not None
        center = self.body.data.center_of_mass
        self.orientation = normalized(orientation)
        self.position = np.array(position) + np.array(rotate(self.orientation, tuple(center.tolist())))
        self.eta = np.zeros(self.modes)

    def move(self, step: Vector) -> None:
        """Move by small coordinates (size,); the ports of a fixed base stay."""
        self.position = self.position + step[:3]
        turn = exponential((step[3], step[4], step[5]))
        self.orientation = normalized(multiply(turn, self.orientation))
        self.eta = self.eta + step[6:]

    def _rest(self) -> None:
        """Put the instance to rest where the body is."""
        if self.body is not None:
            state, at = self._instance.state, self.body.state_layout
            state[at["position"]], state[at["orientation"]] = self.position, self.orientation
            state[at["modal_amplitude"]] = self.eta
            for name in ("momentum", "spin", "modal_momentum"):
                state[at[name]] = 0.0

    def motions(self) -> Vector:
        """Poses of the ports with zero rates, (ports, 13), also of what follows a law: all is at rest in its axes."""
        self._rest()
        size = MOTION_SIZE * len(self.ports)
        result: Vector = self._instance.outputs()[:size].reshape(-1, MOTION_SIZE).copy()
        result[:, MOTION_SIZE - WRENCH_SIZE :] = 0.0
        return result

    def forces(self, wrenches: Vector) -> Vector:
        """Generalised forces (size,) of wrenches (ports, 6), gravity and the modes' stiffness.

        The body's own equations of motion at rest: the rates of its momenta.
        """
        if self.body is None:
            reach = self._arms
            moments = np.cross(reach, wrenches[:, :3]) + wrenches[:, 3:]
            load = np.concatenate((wrenches[:, :3].sum(0), moments.sum(0)))
            return load + self.component.weight if isinstance(self.component, FixedBase) else load
        assert self.body.continuous is not None
        self._rest()
        self._instance.inputs[: wrenches.size] = wrenches.ravel()
        rates, at = self._instance.rates(), Layout(self.body.continuous.quantities)
        names = ("momentum", "spin", "modal_momentum")[: 3 if self.modes else 2]
        return np.concatenate([rates[at[name]] for name in names])

    def port_jacobian(self, port: int) -> Vector:
        """Motion (6, size) of a port under unit coordinates."""
        return self._jacobian(self._arms[port], self._shapes[port], self._second_order[port])

    def point_jacobian(self, point: str) -> Vector:
        """Motion (6, size) of a named point of a body."""
        assert self.body is not None
        data = self.body.data
        i = data.point_names.index(point)
        arm = data.point_positions[i] - data.center_of_mass
        shapes = np.concatenate((data.translation[i], data.rotation[i]))
        count = data.second_order_modes
        second_order = data.second_order_points[i] if count else np.zeros((6, 0, 0))
        return self._jacobian(arm, shapes, second_order)

    def _bent(self, shapes: Vector, second_order: Vector) -> tuple[Vector, Vector]:
        """Displacement and turn (6,) of a point by the modes, and its shapes (6, M) where these are."""
        count = second_order.shape[2]
        pairs = np.zeros_like(shapes)
        pairs[:, :count] = second_order @ self.eta[:count]
        return (shapes + 0.5 * pairs) @ self.eta, shapes + pairs

    def _jacobian(self, arm: Vector, shapes: Vector, second_order: Vector) -> Vector:
        moved, bent = self._bent(shapes, second_order)
        axes, angle, shape, turn = self.axes, moved[3:], bent[:3], bent[3:]
        rate = np.eye(3) + 0.5 * skew(angle) + skew(angle) @ skew(angle) / 6.0
        result = np.eye(6, self.size)
        result[:3, 3:6] = -skew(axes @ (arm + moved[:3]))
        result[:3, 6:] = axes @ shape
        result[3:, 6:] = axes @ rate @ turn
        return result

    def stiffness(self, wrenches: Vector) -> Vector:
        """Minus the derivative (size, size) of the generalised forces under wrenches (ports, 6) held in world axes."""
        added = self._geometric_stiffness(wrenches) + self._tension_stiffness()
        result: Vector = self.modal_matrices()[1] + added
        return result

    def _geometric_stiffness(self, wrenches: Vector) -> Vector:
        """What wrenches (ports, 6) add to the stiffness (size, size) where they turn and bend what they act on."""
        axes = self.axes
        result = np.zeros((self.size, self.size))
        for k, wrench in enumerate(wrenches):
            moved, bent = self._bent(self._shapes[k], self._second_order[k])
            shape, turn = bent[:3], bent[3:]
            force, torque = skew(wrench[:3]), skew(wrench[3:])
            angle, local = skew(moved[3:]), axes.T @ wrench[3:]
            rate = np.eye(3) + 0.5 * angle + angle @ angle / 6.0
            reach = skew(axes @ (self._arms[k] + moved[:3]))
            result[3:6, 3:6] -= force @ reach
            result[3:6, 6:] += force @ axes @ shape
            result[6:, 3:6] -= shape.T @ axes.T @ force + turn.T @ rate.T @ axes.T @ torque
            curved = 0.5 * skew(local) - (skew(angle @ local) + angle @ skew(local)) / 6.0
            result[6:, 6:] -= turn.T @ curved @ turn
            pairs = slice(6, 6 + self._second_order.shape[3])
            conjugate = np.concatenate((axes.T @ wrench[:3], rate.T @ local))
            result[pairs, pairs] -= np.tensordot(conjugate, self._second_order[k], 1)
        return result

    def _tension_stiffness(self) -> Vector:
        """What bending that stretches adds to the stiffness (size, size) of the modes, where they are."""
        result = np.zeros((self.size, self.size))
        if self.body is not None and (forms := self.body.tension) is not None:
            here, low = forms.at(self.eta), slice(6, 6 + forms.count)
            result[low, low] = forms.curvature(here.tension, here.slope)
        return result

    def mass(self) -> Vector:
        """Mass matrix (size, size) of the undeformed body, zero for a fixed base."""
        result = np.zeros((self.size, self.size))
        if self.body is not None:
            data = self.body.data
            result[:3, :3] = data.mass * np.eye(3)
            result[3:6, 3:6] = self.axes @ data.inertia @ self.axes.T
            result[6:, 6:] = np.eye(self.modes)
        return result

    def carried_mass(self) -> Vector:
        """Mass (6, 6) of what a base carries rigidly, which is no part of the spacecraft."""
        component = self.component
        carried = component.carried if isinstance(component, Body | FixedBase) else None
        if carried is None:
            return np.zeros((6, 6))
        center = self.body.data.center_of_mass if self.body is not None else self.position
        return carried.mass_matrix(self.axes @ (carried.center_of_mass - center), self.axes)

    def modal_matrices(self) -> tuple[Vector, Vector]:
        """Damping and stiffness (size, size) of the modes."""
        damping, stiffness = np.zeros(self.size), np.zeros(self.size)
        if self.body is not None:
            frequency = self.body.data.frequency
            damping[6:] = 2.0 * self._instance.constants.damping_ratio * frequency
            stiffness[6:] = frequency**2
        return np.diag(damping), np.diag(stiffness)
