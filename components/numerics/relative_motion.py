"""Relative motion of a connection's two ports, seen from a frame on the first port whose x axis is a hinge line."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, sin, sqrt, tan
from typing import NamedTuple

from ..contract.component import ComponentError
from ..contract.frames import (
    Quaternion,
    Vector3,
    add,
    conjugate,
    cross,
    dot,
    frame_with_x_along,
    mean,
    multiply,
    norm,
    rotate,
    rotate_back,
    scaled,
    subtract,
    swing_twist,
)
from ..contract.ports import PortMoments, PortMotion


class Pose(NamedTuple):
    """Positions of two ports relative to each other at one instant.

    frame: quaternion of the hinge frame on port A; gap: from A to B, world axes, `offset` the same in
    hinge axes; twist: angle of B about x, in (-2 pi, 2 pi); swing: rotation vector (y, z) of the rest.
    """

    frame: Quaternion
    gap: Vector3
    offset: Vector3
    twist: float
    swing: tuple[float, float]


class Rates(NamedTuple):
    """Rates of change of a pose: of the offset in hinge axes, of the twist, of the swing."""

    offset: Vector3
    twist: float
    swing: tuple[float, float]


def unit_direction(given: Sequence[float] | str, name: str, what: str) -> Vector3:
    """`given` with unit length; ComponentError, naming the argument and what it is, where it is no direction."""
    if isinstance(given, str):
        raise ComponentError(f"{name} is {given!r}; give three numbers along the axes, such as [0, 1, 0]")
    if len(given) != 3:
        raise ComponentError(f"{name} has {len(given)} numbers; give the three components of {what}")
    length = norm((float(given[0]), float(given[1]), float(given[2])))
    if length == 0.0:
        raise ComponentError(f"{name} has no length; give the direction of {what}")
    if not isfinite(length):
        raise ComponentError(f"{name} is {list(given)}; give finite components of {what}")
    return scaled(1.0 / length, (float(given[0]), float(given[1]), float(given[2])))


def axis_frame(axis: Sequence[float], what: str, name: str = "axis") -> Quaternion:
    """Frame whose x axis has the direction of `what`; ComponentError where that is no direction."""
    return frame_with_x_along(unit_direction(axis, name, what))


def relative_pose(motions: Sequence[PortMotion], axis_on_port: Quaternion) -> Pose:
    """Pose of port B against port A from the motions of both."""
    a, b = motions
    frame, frame_b = multiply(a.orientation, axis_on_port), multiply(b.orientation, axis_on_port)
    gap = subtract(b.position, a.position)
    twist, swing_y, swing_z = swing_twist(multiply(conjugate(frame), frame_b))
    return Pose(frame, gap, rotate_back(frame, gap), twist, (swing_y, swing_z))


def relative_rates(motions: Sequence[PortMotion], pose: Pose) -> Rates:
    """Rates from the same motions."""
    a, b = motions
    velocity = subtract(subtract(b.velocity, a.velocity), cross(a.angular_velocity, pose.gap))
    spin = rotate_back(pose.frame, subtract(b.angular_velocity, a.angular_velocity))
    return _rates(rotate_back(pose.frame, velocity), spin, pose.swing)


def _rates(offset: Vector3, spin: Vector3, swing: tuple[float, float]) -> Rates:
    """Rates from velocity and angular velocity in hinge axes."""
    x, y, z = spin
    swing_y, swing_z = swing
    lean, shortening, across = _factors_of_swing(swing)
    twist = x + lean * (swing_z * y - swing_y * z)
    # what the twist adds to the angular velocity normal to the line, the axis of the twist being tilted
    y, z = y - shortening * swing_z * twist, z + shortening * swing_y * twist
    normal = across * (swing_z * y - swing_y * z)
    return Rates(offset, twist, (y + normal * swing_z, z - normal * swing_y))


class Passage(NamedTuple):
    """Hinge frame and gap at both ends of a step: what makes wrenches of loads, and moments of coordinates of moments.

    Over a step loads and wrenches are u + u_slope P1, P1 = 2 t / h - 1, and the moment of a rate v is the integral of
    P1 v dt. Both maps are adjoint, so that slopes do the same work on the moments of ports and of coordinates.
    """

    frame0: Quaternion
    frame1: Quaternion
    gap0: Vector3
    gap1: Vector3

    def moments(self, moments: Sequence[PortMoments]) -> tuple[Vector3, Vector3]:
        """Moments of the relative velocity and angular velocity in hinge axes, from those of both ports."""
        a, b = moments
        # the gap changes while the first port turns
        turning = cross(turn_between(self.frame0, self.frame1), self._gap_slope())
        carried = add(cross(a.angular_velocity, mean(self.gap0, self.gap1)), turning)
        apart = subtract(subtract(b.velocity, a.velocity), carried)
        return self._back(apart), self._back(subtract(b.angular_velocity, a.angular_velocity))

    def rate_moments(self, moments: Sequence[PortMoments], swing: tuple[float, float]) -> Rates:
        """Moments of the rates of a pose; `swing` is the one in the middle of the step."""
        return _rates(*self.moments(moments), swing)

    def wrench(self, force: Vector3, torque: Vector3) -> tuple[float, ...]:
        """Mean wrenches on A and B, 12 numbers, from loads on B in hinge axes that have no slopes."""
        return pair(self.forward(force), self.forward(torque), mean(self.gap0, self.gap1))

    def twist_wrench(self, torque: float, swing: tuple[float, float]) -> tuple[float, ...]:
        """The same of a torque on the twist alone; `swing` is the one in the middle of the step."""
        if torque == 0.0:
            return (0.0,) * 12
        return self.wrench((0.0, 0.0, 0.0), conjugate_torque(torque, (0.0, 0.0), swing))

    def wrenches(
        self, force: Vector3, torque: Vector3, force_slope: Vector3, torque_slope: Vector3
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Mean wrenches on A and B and their slopes, 12 numbers each, from loads on B in hinge axes.

        The angular momentum that both ports get over the step is zero about any point.
        """
        means, slopes = self.wrench(force, torque), self.wrench(force_slope, torque_slope)
        x, y, z = cross(self._gap_slope(), (slopes[6], slopes[7], slopes[8]))
        return (*means[:3], means[3] - x, means[4] - y, means[5] - z, *means[6:]), slopes

    def forward(self, v: Vector3) -> Vector3:
        """A vector held in hinge axes, as its mean in world axes."""
        return mean_direction(self.frame0, self.frame1, v)

    def _back(self, v: Vector3) -> Vector3:
        return mean(rotate_back(self.frame0, v), rotate_back(self.frame1, v))

    def _gap_slope(self) -> Vector3:
        """What a slope of a force has for an arm beside the mean gap: the gap's own slope times the mean of P1^2."""
        return scaled(1.0 / 6.0, subtract(self.gap1, self.gap0))


class Line(NamedTuple):
    """Centre line between two points over a step: mean and change of the vector, and the scale of its direction.

    A tension acts along scale x mean, and a slope of the tension also along the change of the direction within the
    step, so that no angular momentum is left over; moments of the length are taken with the adjoint.
    """

    mean: Vector3
    change: Vector3
    scale: float

    def moment(self, apart: Vector3) -> float:
        """Moment of the length's rate, from that of the velocity of the second point against the first."""
        return self.scale * dot(self.mean, apart) + dot(self._turning(), self.change)

    def forces(self, tension: float, slope: float) -> tuple[Vector3, Vector3]:
        """Mean force on the second point and its slope."""
        along, turning = scaled(self.scale, self.mean), self._turning()
        return scaled(-1.0, add(scaled(tension, along), scaled(slope, turning))), scaled(-slope, along)

    def _turning(self) -> Vector3:
        """A sixth of the change of the direction."""
        share = dot(self.mean, self.change) / dot(self.mean, self.mean)
        return scaled(self.scale / 6.0, subtract(self.change, scaled(share, self.mean)))


def turn_between(frame0: Quaternion, frame1: Quaternion) -> Vector3:
    """Twice the tangent of half the angle, along the axis, of the rotation from one frame to another, world axes."""
    w, x, y, z = multiply(frame1, conjugate(frame0))
    return scaled(2.0 / w, (x, y, z))


def conjugate_torque(twist: float, bending: tuple[float, float], swing: tuple[float, float]) -> Vector3:
    """Torque in hinge axes whose power is that of loads on the rates of `relative_rates`.

    The twist changes with the angular velocity along (a + b) / (1 + a.b), a and b the hinge line's directions
    on both ports, and a tilted line turned about itself moves the swing; a torque along a alone would make
    work of the second order in the swing out of nothing.
    """
    y, z = swing
    lean, _, across = _factors_of_swing(swing)
    normal = z * bending[0] - y * bending[1]
    twist -= normal
    return (
        twist,
        bending[0] + (across * normal + lean * twist) * z,
        bending[1] - (across * normal + lean * twist) * y,
    )


def _factors_of_swing(swing: tuple[float, float]) -> tuple[float, float, float]:
    """tan(s/2) / s, sin(s) / s and (s / sin(s) - 1) / s^2 of the swing's angle s."""
    angle = sqrt(swing[0] * swing[0] + swing[1] * swing[1])
    if angle < 1e-4:
        return 0.5, 1.0, 1.0 / 6.0
    shortening = sin(angle) / angle
    return tan(0.5 * angle) / angle, shortening, (1.0 / shortening - 1.0) / (angle * angle)


def mean_direction(frame0: Quaternion, frame1: Quaternion, v: Vector3) -> Vector3:
    """A vector held in hinge axes over a step, as its mean in world axes."""
    return mean(rotate(frame0, v), rotate(frame1, v))


def pair(force: Vector3, torque: Vector3, gap: Vector3) -> tuple[float, ...]:
    """Wrenches on A and on B, 12 numbers, that sum to zero about any point.

    force, torque: on B at its origin, world axes; gap: from A to B, the mean over the step.
    """
    reaction = scaled(-1.0, add(torque, cross(gap, force)))
    return (*scaled(-1.0, force), *reaction, *force, *torque)
