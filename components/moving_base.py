r"""Moving base: ports that follow prescribed motions together, a shift and a turn, and the loads that this takes.

$$ \mathbf r_k = \mathbf r_P + s(t)\, \mathbf a + \mathbf R(\theta(t)\, \mathbf b)\, \mathbf R_0\, (\mathbf
x_k - \mathbf x_P) $$

with the laws $s$ of the shift along $\mathbf a$ and $\theta$ of the turn about $\mathbf b$, the pivot $P$ and the
orientation $\mathbf R_0$ where both are zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sin, tan
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import Component, ContinuousStates, Port, Vector
from .contract.frames import Quaternion, exponential, multiply, normalized, rotation_matrix, scaled
from .contract.ports import WRENCH_SIZE
from .contract.record import integrated, kept, observed
from .contract.roles import HOLD, IMPULSE, SUPPLIED_ENERGY, TIME_TO_BREAK
from .numerics.motion_law import NOTHING, MotionLaw, gauss_times
from .numerics.port_loads import PortLoads
from .numerics.relative_motion import unit_direction

_OWN = 3
"""States beside the loads."""


class MovingBase(Component):
    """Base with prescribed motion: ports of one rigid frame, and the loads and work that the motion needs.

    Where the laws are zero the frame is at `position` (3, m) with `orientation` (quaternion). From there it is shifted
    along `translation_axis` by the law `translation` (m) and turned about `rotation_axis`, through its own point
    `pivot`, by the law `rotation` (rad); both axes are in the world, terms of laws as in `MotionLaw`. ports: one
    mapping per port with `name`, `position` (3, m) and optional `orientation` (quaternion), in the axes of the frame,
    `outside` where what acts there is no interface load.
    The clock starts at zero, when the scene does, and stands still while `hold` is 1; rates are those of the laws.
    Interface loads are in the axes of the base, in sum about the pivot. The work of all loads on the moving ports, with
    its sign changed, is the energy supplied. is_base: whether it is the spacecraft, whose loads are interface loads;
    otherwise they are reactions of the motion.
    """

    kind = "moving_base"
    ports_vary = True
    constant_mobility = True
    prescribed_motion = True
    starts_from_inputs = False

    def __init__(
        self,
        ports: Sequence[Mapping[str, Any]],
        translation: Sequence[Mapping[str, Any]] = NOTHING,
        rotation: Sequence[Mapping[str, Any]] = NOTHING,
        translation_axis: Sequence[float] = (1.0, 0.0, 0.0),
        rotation_axis: Sequence[float] = (0.0, 0.0, 1.0),
        pivot: Sequence[float] = (0.0, 0.0, 0.0),
        position: Sequence[float] = (0.0, 0.0, 0.0),
        orientation: Sequence[float] = (1.0, 0.0, 0.0, 0.0),
        is_base: bool = True,
    ) -> None:
        self._shift = np.array(unit_direction(translation_axis, "translation_axis", "the base's shift"))
        self._turn = unit_direction(rotation_axis, "rotation_axis", "the base's turn")
        self._laws = MotionLaw(translation), MotionLaw(rotation)
        w, x, y, z = orientation
        self._frame = normalized((w, x, y, z))
        self._own_pivot = np.array(pivot, dtype=float)
        self._pivot = np.array(position, dtype=float) + rotation_matrix(self._frame) @ self._own_pivot
        self._arms = (
            np.array([port["position"] for port in ports], dtype=float).reshape(-1, 3) - self._own_pivot
        )
        turns = [port.get("orientation", (1.0, 0.0, 0.0, 0.0)) for port in ports]
        self._orientations = [normalized((w, x, y, z)) for w, x, y, z in turns]
        self._loads = PortLoads(ports, self._arms, is_base)
        own = [
            integrated("s", "1", "Time since the start, without what was held", False).called("clock"),
            kept("s", "How far the clock went in the last step").called("passed"),
            integrated("J", "W", "Work of the motion since the start").called("work"),
        ]
        told = [
            observed("m", "Shift of the base along its axis").called("shift"),
            observed("rad", "Turn of the base about its axis").called("turn"),
            observed("m", "Position of the frame, world axes").called("frame_position", 3),
            observed("1", "Quaternion of the frame, body to world axes, scalar first").called(
                "frame_orientation", 4
            ),
            SUPPLIED_ENERGY.saying("Work of the motion since the start"),
        ]
        self.noun = "interface" if is_base else "motion"
        self._declare(
            {
                "ports": [dict(port) for port in ports],
                "translation": [dict(term) for term in translation],
                "rotation": [dict(term) for term in rotation],
                "translation_axis": tuple(translation_axis),
                "rotation_axis": tuple(rotation_axis),
                "pivot": tuple(pivot),
                "position": tuple(position),
                "orientation": tuple(orientation),
                "is_base": is_base,
            },
            ports=[Port(port["name"], "body", 4) for port in ports],
            inputs=[IMPULSE, HOLD.saying("1: the clock stands still, and so do the positions")],
            outputs=[TIME_TO_BREAK],
            observations=[*told, *self._loads.observations],
            states=[*own, *self._loads.states],
        )
        self._wrenches = WRENCH_SIZE * len(ports)
        self.continuous = ContinuousStates.of(self.state_layout)

    def reference(self) -> Vector:
        """Point (3, m, world) that loads are about, at the start."""
        reference: Vector = self._pivot + self._laws[0].value(0.0) * self._shift
        return reference

    def prepare(self, p: Vector) -> None:
        """Nothing to prepare."""

    def initial(self, c: None, u: Vector) -> Vector:
        """At the start of the laws."""
        return np.zeros(_OWN + self._loads.size)

    def _is_held(self, u: Vector) -> bool:
        return bool(u[self._wrenches + 1] > 0.5)

    def _moved(self, before: float, after: float) -> Vector:
        """Displacements (ports, 3) from one time to another, free of the cancellation of positions."""
        shift = self._laws[0].value(after) - self._laws[0].value(before)
        start, end = self._laws[1].value(before), self._laws[1].value(after)
        chord = 2.0 * sin(0.5 * (end - start)) * np.array(self._turn)
        moved: Vector = shift * self._shift + np.cross(chord, self._arms @ self._axes(0.5 * (start + end)).T)
        return moved

    def _places(self, clock: float) -> Vector:
        """Positions of the ports (ports, 3)."""
        shift, turn = (law.value(clock) for law in self._laws)
        places: Vector = self._pivot + shift * self._shift + self._arms @ self._axes(turn).T
        return places

    def _turned(self, turn: float) -> Quaternion:
        """Orientation of the frame."""
        return multiply(exponential(scaled(turn, self._turn)), self._frame)

    def _axes(self, turn: float) -> Vector:
        axes: Vector = rotation_matrix(self._turned(turn))
        return axes

    def _moments(self, before: float, clock: float) -> Vector:
        """First moments of the ports' velocities and angular velocities over a step (ports, 6)."""
        found = np.zeros((len(self.ports), WRENCH_SIZE))
        if clock == before:
            return found
        first, middle, last = gauss_times(before, clock)
        # positions against that in the middle, whose own weights cancel
        start, early, late, end = (self._moved(middle, time) for time in (before, first, last, clock))
        found[:, :3] = start + end - 5.0 / 9.0 * (early + late)
        found[:, 3:] = self._laws[1].rate_moment(before, clock) * np.array(self._turn)
        return found

    def step(self, c: None, x: Vector, u: Vector, h: float) -> Vector:
        """Follow the laws; remember the wrenches of the step and their work."""
        clock, n = float(x[0]), self._wrenches
        after, wrenches, slopes = clock if self._is_held(u) else clock + h, u[:n], u[n + 2 :]
        is_impulse = bool(u[n] > 0.5)
        moved = np.zeros((len(self.ports), WRENCH_SIZE))
        moved[:, :3] = self._moved(clock, after)
        # what mean torques of connections do their work on, see `turn_between`
        angle = self._laws[1].value(after) - self._laws[1].value(clock)
        moved[:, 3:] = 2.0 * tan(0.5 * angle) * np.array(self._turn)
        work = wrenches @ moved.ravel() + slopes @ self._moments(clock, after).ravel()
        own = (after, after - clock, x[2] - work)
        return np.concatenate((own, self._loads.after(x[_OWN:], wrenches, slopes, h, is_impulse)))

    def _motion(self, clock: float) -> tuple[Vector, Vector]:
        """Poses (ports, 7) and rates (ports, 6) of the ports."""
        speed, spin = (law.rate(clock) for law in self._laws)
        places, angle = self._places(clock), self._laws[1].value(clock)
        turned = self._turned(angle)
        poses = np.concatenate(
            (places, np.array([multiply(turned, q) for q in self._orientations]).reshape(-1, 4)), axis=1
        )
        rates = np.zeros((len(self.ports), WRENCH_SIZE))
        around = spin * np.array(self._turn)
        rates[:, :3] = speed * self._shift + np.cross(around, self._arms @ self._axes(angle).T)
        rates[:, 3:] = around
        return poses, rates

    def outputs(self, c: None, x: Vector, u: Vector) -> Vector:
        """Motion by the laws, time to their next break, first moments of the last step."""
        clock, passed, _ = x[:_OWN].tolist()
        poses, rates = self._motion(clock)
        left = min(law.time_to_break(clock) for law in self._laws)
        ports = np.concatenate((poses, rates), axis=1)
        return np.concatenate((ports.ravel(), (left,), self._moments(clock - passed, clock).ravel()))

    def observe(self, c: None, x: Vector, u: Vector) -> Vector:
        """Shift, turn, frame, work; loads now and one step earlier, see `PortLoads.observe`."""
        clock, passed, work = x[:_OWN].tolist()
        shift, turn = (law.value(clock) for law in self._laws)
        axes, axes_before = self._axes(turn), self._axes(self._laws[1].value(clock - passed))
        loads = self._loads.observe(x[_OWN:], u[: self._wrenches], axes, axes_before)
        self._loads.leave_outside(loads)
        origin = self._pivot + shift * self._shift - axes @ self._own_pivot
        return np.concatenate(((shift, turn), origin, self._turned(turn), (work,), loads))

    def rates(self, c: None, x: Vector, u: Vector) -> Vector:
        """Rate of the clock, and power of the motion (W)."""
        if self._is_held(u):
            return np.zeros(2)
        _, rates = self._motion(float(x[0]))
        return np.array([1.0, -(u[: self._wrenches] @ rates.ravel())])

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Arrays that `fmus/native/kernels/moving_base.c` reads."""
        return {
            "base_pivot": self._pivot,
            "base_own_pivot": self._own_pivot,
            "base_frame": self._frame,
            "base_arms": self._arms,
            "base_orientations": np.array(self._orientations).reshape(-1, 4),
            "base_outside": self._loads.outside,
            "base_translation_axis": self._shift,
            "base_rotation_axis": self._turn,
            **self._laws[0].native_data("translation"),
            **self._laws[1].native_data("rotation"),
        }

    @classmethod
    def example(cls) -> MovingBase:
        """Three ports, one turned, one for what acts from outside, on a base that is shaken and spun up."""
        pulley = {"name": "pulley", "position": (0.0, 0.6, 0.0), "orientation": (0.6, 0.0, 0.8, 0.0)}
        drag = {"name": "drag", "position": (0.3, -0.2, 0.1), "outside": True}
        return cls(
            [{"name": "hinge", "position": (0.0, 0.0, 0.0)}, pulley, drag],
            [{"profile": "harmonic", "amplitude": 0.02, "frequency": 2.0}],
            [{"profile": "spin_up", "duration": 0.05, "rate": 0.4}],
            (1.0, 0.0, 1.0),
            (0.0, 0.6, 0.8),
            (0.1, 0.2, -0.1),
            (0.3, -0.2, 0.5),
            (0.5, 0.5, -0.5, 0.5),
        )
