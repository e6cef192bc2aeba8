r"""Driven base: ports of a frame whose accelerations change at rates that are inputs, and what this motion takes.

$$ \mathbf v(t) = \mathbf v_0 + \mathbf a_0\, t + \tfrac{1}{2}\, \mathbf j\, t^2,\qquad
\boldsymbol\varphi(t) = \boldsymbol\omega_0\, t + \tfrac{1}{2}\, \boldsymbol\alpha_0\, t^2 + \tfrac{1}{6}\,
\mathbf k\, t^3 + \left(\tfrac{1}{12}\, t^3\, \boldsymbol\alpha_0 + \tfrac{1}{24}\, t^4\, \mathbf k\right)
\times \boldsymbol\omega_0 $$

over a step, with the velocity and the rotation vector of the frame, whose accelerations change at the rates $\mathbf
j$ and $\mathbf k$ that the inputs hold.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import Component, ContinuousStates, Port, Vector
from .contract.frames import (
    Quaternion,
    Vector3,
    add,
    conjugate,
    cross,
    exponential,
    multiply,
    normalized,
    rotation_matrix,
    scaled,
)
from .contract.ports import WRENCH_SIZE
from .contract.quantity import Quantity
from .contract.record import Record, integrated, kept, observed
from .contract.roles import HOLD, IMPULSE, SUPPLIED_ENERGY
from .numerics.port_loads import PortLoads

_GAUSS = 0.5 * 0.6**0.5
"""Distance of the outer points of Gauss's rule from the middle, over a step."""
_MOMENT_WEIGHTS = ((-0.5, 1.0), (-_GAUSS, -5.0 / 9.0), (_GAUSS, -5.0 / 9.0), (0.5, 1.0))
"""Of displacements from the middle, at parts of a step from there, in a first moment of velocity."""


class _Frame(NamedTuple):
    """The frame at a communication point, and how it moved in the step that led there."""

    position: Annotated[Vector3, integrated("m", "m/s", "Position of the frame, world axes", False)]
    orientation: Annotated[
        Quaternion, integrated("1", "1/s", "Quaternion of the frame, body to world axes", False)
    ]
    velocity: Annotated[Vector3, integrated("m/s", "m/s2", "Velocity of the frame, world axes", False)]
    angular_velocity: Annotated[
        Vector3, integrated("rad/s", "rad/s2", "Angular velocity of the frame, world axes", False)
    ]
    acceleration: Annotated[
        Vector3, integrated("m/s2", "m/s3", "Acceleration of the frame, world axes", False)
    ]
    angular_acceleration: Annotated[
        Vector3, integrated("rad/s2", "rad/s3", "Angular acceleration of the frame, world axes", False)
    ]
    work: Annotated[float, integrated("J", "W", "Work of the motion since the start")]
    impulse: Annotated[
        Vector3, integrated("N.s", "N", "Impulse of all loads since the start, axes of the frame")
    ]
    angular_impulse: Annotated[
        Vector3, integrated("N.m.s", "N.m", "Angular impulse of all loads about the frame's origin, its axes")
    ]
    middle: Annotated[Quaternion, kept("1", "Quaternion of the frame in the middle of the last step")]
    last_rate: Annotated[Vector3, kept("m/s3", "Rate of the acceleration in the last step")]
    last_angular_rate: Annotated[Vector3, kept("rad/s3", "Rate of the angular acceleration in the last step")]
    passed: Annotated[float, kept("s", "Size of the last step, 0 while held")]


_FRAME = Record(_Frame)
_ZERO, _UPRIGHT = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
_REST = _Frame(_ZERO, _UPRIGHT, _ZERO, _ZERO, _ZERO, _ZERO, 0.0, _ZERO, _ZERO, _UPRIGHT, _ZERO, _ZERO, 0.0)


class _Step(NamedTuple):
    """Motion over a step about its middle: rates, orientation and accelerations there, and how fast these change."""

    h: float
    velocity: Vector3
    angular_velocity: Vector3
    orientation: Quaternion
    acceleration: Vector3
    angular_acceleration: Vector3
    change: Vector3
    angular_change: Vector3

    def turned(self, t: float) -> Quaternion:
        """Rotation from the middle to a time t (s) after it."""
        return exponential(
            _rotation(self.angular_velocity, self.angular_acceleration, self.angular_change, t)
        )

    def moved(self, arms: Vector, t: float) -> Vector:
        """Displacements (ports, 3) from the middle to a time t (s) after it, free of the cancellation of positions."""
        shift = np.array(_way(self.velocity, self.acceleration, self.change, t))
        w, *vector = self.turned(t)
        turn = np.array(vector)
        chord = np.cross(turn, arms @ rotation_matrix(self.orientation).T)
        moved: Vector = shift + 2.0 * w * chord + 2.0 * np.cross(turn, chord)
        return moved

    def moments(self, arms: Vector) -> Vector:
        """First moments of the ports' velocities and angular velocities (ports, 6)."""
        found = np.zeros((len(arms), WRENCH_SIZE))
        for part, weight in _MOMENT_WEIGHTS:
            found[:, :3] += weight * self.moved(arms, part * self.h)
        found[:, 3:] = scaled(self.h * self.h / 6.0, self.angular_acceleration)
        return found


def _way(rate: Vector3, acceleration: Vector3, change: Vector3, t: float) -> Vector3:
    """What a rate, whose acceleration changes linearly, adds up to in a time."""
    found = add(scaled(t, rate), scaled(0.5 * t * t, acceleration))
    return add(found, scaled(t**3 / 6.0, change))


def _rate_after(rate: Vector3, acceleration: Vector3, change: Vector3, t: float) -> Vector3:
    return add(rate, add(scaled(t, acceleration), scaled(0.5 * t * t, change)))


def _rotation(rate: Vector3, acceleration: Vector3, change: Vector3, t: float) -> Vector3:
    """Rotation vector after a time under an angular velocity like that (Magnus, to t^4)."""
    lean = add(scaled(t**3 / 12.0, acceleration), scaled(t**4 / 24.0, change))
    return add(_way(rate, acceleration, change, t), cross(lean, rate))


class DrivenBase(Component):
    """Spacecraft as a rigid frame driven by inputs: its accelerations change at rates that are constant over a step.

    The frame starts at rest at the world's origin, upright. ports: one mapping per port with `name`, `position` (3, m)
    and optional `orientation` (quaternion), in the axes of the frame. Interface loads are in these axes, in sum about
    the frame's origin, and so are their impulses since the start, to which kinematic latches add theirs at once. The
    work of all loads on the moving ports, with its sign changed, is the energy supplied. While `hold` is 1 nothing
    moves.
    """

    kind = "driven_base"
    noun = "interface"
    ports_vary = True
    constant_mobility = True
    prescribed_motion = True
    starts_from_inputs = False

    def __init__(self, ports: Sequence[Mapping[str, Any]]) -> None:
        self._arms = np.array([port["position"] for port in ports], dtype=float).reshape(-1, 3)
        turns = [port.get("orientation", (1.0, 0.0, 0.0, 0.0)) for port in ports]
        self._orientations = [normalized((w, x, y, z)) for w, x, y, z in turns]
        self._loads = PortLoads(ports, self._arms)
        self._wrenches = WRENCH_SIZE * len(ports)
        drive = [
            Quantity("acceleration_rate", "m/s3", "Rate of the frame's acceleration, world axes", 3),
            Quantity(
                "angular_acceleration_rate", "rad/s3", "Rate of the angular acceleration, world axes", 3
            ),
        ]
        told = [
            observed("m", "Position of the frame, world axes").called("frame_position", 3),
            observed("1", "Quaternion of the frame, body to world axes, scalar first").called(
                "frame_orientation", 4
            ),
            SUPPLIED_ENERGY.saying("Work of the motion since the start"),
            observed("N.s", "Impulse on the base since the start, its axes").called("interface_impulse", 3),
            observed(
                "N.m.s", "Angular impulse on the base since the start, its axes, about its reference point"
            ).called("interface_angular_impulse", 3),
        ]
        self._declare(
            {"ports": [dict(port) for port in ports]},
            ports=[Port(port["name"], "body", 4) for port in ports],
            inputs=[IMPULSE, HOLD.saying("1: the frame stands still"), *drive],
            observations=[*told, *self._loads.observations],
            states=[*_FRAME.quantities, *self._loads.states],
        )
        self.continuous = ContinuousStates.of(self.state_layout)

    def reference(self) -> Vector:
        """Point (3, m, world) that loads are about, at the start."""
        return np.zeros(3)

    def prepare(self, p: Vector) -> None:
        """Nothing to prepare."""

    def initial(self, c: None, u: Vector) -> Vector:
        """At rest."""
        return np.concatenate((_FRAME.write(_REST), np.zeros(self._loads.size)))

    def step(self, c: None, x: Vector, u: Vector, h: float) -> Vector:
        """Move on; remember the wrenches of the step and their work."""
        before, n = _FRAME.read(x[: _FRAME.size]), self._wrenches
        wrenches, own, slopes = u[:n], u[n : n + 8], u[n + 8 :]
        loads = self._loads.after(x[_FRAME.size :], wrenches, slopes, h, bool(own[0] > 0.5))
        if own[1] > 0.5:
            after = before._replace(middle=before.orientation, passed=0.0)
        else:
            after = self._moved(before, own, h, wrenches, slopes)
        return np.concatenate((_FRAME.write(after), loads))

    def _moved(self, before: _Frame, own: Vector, h: float, wrenches: Vector, slopes: Vector) -> _Frame:
        jx, jy, jz, kx, ky, kz = own[2:].tolist()
        change, angular_change = (jx, jy, jz), (kx, ky, kz)
        turning = before.angular_velocity, before.angular_acceleration, angular_change
        moving = before.velocity, before.acceleration, change
        made = _Step(
            h,
            _rate_after(*moving, 0.5 * h),
            _rate_after(*turning, 0.5 * h),
            multiply(exponential(_rotation(*turning, 0.5 * h)), before.orientation),
            add(before.acceleration, scaled(0.5 * h, change)),
            add(before.angular_acceleration, scaled(0.5 * h, angular_change)),
            change,
            angular_change,
        )
        orientation = multiply(made.turned(0.5 * h), made.orientation)
        # what mean torques of connections do their work on, see `turn_between`
        w, *turn = multiply(orientation, conjugate(before.orientation))
        travel = np.zeros((len(self._arms), WRENCH_SIZE))
        travel[:, :3] = made.moved(self._arms, 0.5 * h) - made.moved(self._arms, -0.5 * h)
        travel[:, 3:] = 2.0 * np.array(turn) / w
        work = wrenches @ travel.ravel() + slopes @ made.moments(self._arms).ravel()
        fx, fy, fz, tx, ty, tz = self._loads.sums(wrenches, rotation_matrix(made.orientation)).tolist()
        return _Frame(
            add(before.position, _way(*moving, h)),
            orientation,
            _rate_after(*moving, h),
            _rate_after(*turning, h),
            add(before.acceleration, scaled(h, change)),
            add(before.angular_acceleration, scaled(h, angular_change)),
            before.work - float(work),
            add(before.impulse, scaled(h, (fx, fy, fz))),
            add(before.angular_impulse, scaled(h, (tx, ty, tz))),
            made.orientation,
            change,
            angular_change,
            h,
        )

    def outputs(self, c: None, x: Vector, u: Vector) -> Vector:
        """Motion of the ports, first moments of the last step."""
        now, count = _FRAME.read(x[: _FRAME.size]), len(self._arms)
        reach = self._arms @ rotation_matrix(now.orientation).T
        ports = np.zeros((count, 13))
        ports[:, :3] = np.array(now.position) + reach
        ports[:, 3:7] = np.array([multiply(now.orientation, q) for q in self._orientations]).reshape(-1, 4)
        ports[:, 7:10] = np.array(now.velocity) + np.cross(np.array(now.angular_velocity), reach)
        ports[:, 10:] = now.angular_velocity
        h, change, angular_change = now.passed, now.last_rate, now.last_angular_rate
        made = _Step(
            h,
            _rate_after(now.velocity, now.acceleration, change, -0.5 * h),
            _rate_after(now.angular_velocity, now.angular_acceleration, angular_change, -0.5 * h),
            now.middle,
            add(now.acceleration, scaled(-0.5 * h, change)),
            add(now.angular_acceleration, scaled(-0.5 * h, angular_change)),
            change,
            angular_change,
        )
        moments = made.moments(self._arms) if h else np.zeros((count, WRENCH_SIZE))
        return np.concatenate((ports.ravel(), moments.ravel()))

    def observe(self, c: None, x: Vector, u: Vector) -> Vector:
        """Frame and work; loads now and one step earlier, see `PortLoads.observe`."""
        now = _FRAME.read(x[: _FRAME.size])
        turning = now.angular_velocity, now.angular_acceleration, now.last_angular_rate
        back = exponential(_rotation(*turning, -now.passed))
        axes_before = rotation_matrix(multiply(back, now.orientation))
        axes = rotation_matrix(now.orientation)
        loads = self._loads.observe(x[_FRAME.size :], u[: self._wrenches], axes, axes_before)
        impulses = now.impulse, now.angular_impulse
        return np.concatenate((now.position, now.orientation, (now.work,), *impulses, loads))

    def rates(self, c: None, x: Vector, u: Vector) -> Vector:
        """Rates of the frame's motion and of its accelerations, power of the motion (W), and loads in sum."""
        n = self._wrenches
        if u[n + 1] > 0.5:
            return np.zeros(26)
        now = _FRAME.read(x[: _FRAME.size])
        turning = multiply((0.0, *scaled(0.5, now.angular_velocity)), now.orientation)
        speeds = self.outputs(c, x, u)[: 13 * len(self._arms)].reshape(-1, 13)[:, 7:]
        power = -float(u[:n] @ speeds.ravel())
        accelerations = now.acceleration, now.angular_acceleration
        loads = self._loads.sums(u[:n], rotation_matrix(now.orientation))
        return np.concatenate((now.velocity, turning, *accelerations, u[n + 2 : n + 8], (power,), loads))

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Arrays that `fmus/native/kernels/driven_base.c` reads."""
        return {"base_arms": self._arms, "base_orientations": np.array(self._orientations).reshape(-1, 4)}

    @classmethod
    def example(cls) -> DrivenBase:
        """Two ports, one of them turned."""
        pulley = {"name": "pulley", "position": (0.0, 0.6, 0.0), "orientation": (0.6, 0.0, 0.8, 0.0)}
        return cls([{"name": "hinge", "position": (0.0, 0.0, 0.0)}, pulley])
