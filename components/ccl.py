"""Closed-cable-loop (CCL) synchroniser: two preloaded strands between two pulleys on bodies 1 and 3.

The wrenches follow from the elongations of the two strands, so they are conservative by construction; in
components they are equations 2.3 to 2.6 of Bagnoli (2007), section 2.2.5, with L the free strand length,
hence a pulley distance of sqrt(L^2 + (r1 - r2)^2): only with that arm is angular momentum balanced.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import asin, atan2, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import Component, ComponentError, Port, Quantity, Vector
from .contract.frames import (
    Quaternion,
    Vector3,
    add,
    conjugate,
    cross,
    dot,
    mean,
    multiply,
    nearest_turn,
    norm,
    rotate,
    rotate_back,
    scaled,
    subtract,
    swing_twist,
)
from .numerics.laws import SlackSpring, mean_force
from .numerics.relative_motion import (
    Line,
    as_floats,
    axis_frame,
    dissipated_energies,
    gives_end_point,
    is_of_order_four,
    order_parameter,
    turn_between,
)
from .numerics.stiff_coordinate import MeanLoad, Memory, StepMotion
from .numerics.workless_pair import workless_law


class _Geometry(NamedTuple):
    """Angles of both pulleys against the strands (rad, unwrapped) and the centre line `span`, world axes.

    works_1, works_2: what a pulley's angle works on. Guided cables: the direction whose torque does the work
    of that angle. Free strands: the angle's gradient (1/m) with respect to the centre line; span x gradient
    is then the direction of the torque, so wrenches balance at any tilt of the pulleys.
    """

    angles: tuple[float, float]
    works_1: Vector3
    works_2: Vector3
    span: Vector3


class _Instant(NamedTuple):
    """Geometry, elongations and tensions of both strands, and heat (W) of their damping."""

    geometry: _Geometry
    elongations: tuple[float, float]
    tension_a: float
    tension_b: float
    heat: float


@dataclass(frozen=True, slots=True)
class _Constants:
    radius_1: float
    radius_2: float
    strand: SlackSpring
    damping: float
    end_weight: float
    paired: bool


_ANGLES, _WORKS, _SPAN, _START, _HEAT, _WRENCH = slice(0, 2), slice(2, 8), slice(8, 11), slice(11, 14), 14, 15
_FRAMES_SIZE = 8


class CableLoop(Component):
    """Synchroniser between pulley 1 (port `pulley_1`, fixed to body 1) and pulley 2 (`pulley_2`, body 3).

    axis: pulley axis in the axes of both pulley ports. guided: cables are led along body 2, which then has
    a third port `guide` and takes the torque -(T1 + T2); otherwise the strands run free and the difference
    of radii makes a lateral pair of forces on the pulleys.
    """

    kind = "ccl"

    def __init__(
        self,
        axis: Sequence[float] = (0.0, 1.0, 0.0),
        guided: bool = False,
        wrench_mode: str = "mean",
    ) -> None:
        self._endpoint = gives_end_point(wrench_mode)
        self._axis_frame = axis_frame(axis, "the pulley axes")
        self._guided = bool(guided)
        ports = 3 if guided else 2
        self._hold = 13 * ports
        self._wrench = slice(_WRENCH, _WRENCH + 6 * ports)
        self._frames = slice(self._wrench.stop, self._wrench.stop + _FRAMES_SIZE)
        self._slopes = slice(self._frames.stop, self._frames.stop + 6 * ports)
        names = ("pulley_1", "pulley_2", "guide") if guided else ("pulley_1", "pulley_2")
        self._declare(
            {"axis": tuple(axis), "guided": self._guided, "wrench_mode": wrench_mode},
            ports=[Port(name, "connection", 2 if self._endpoint else 4) for name in names],
            parameters=_parameters(),
            inputs=[
                Quantity(
                    "hold",
                    "1",
                    "1: strands are adjusted to their preload at every step",
                    variability="discrete",
                )
            ],
            observations=_observations(),
            feedthrough=self._endpoint,
        )
        if self._endpoint:
            self.continuous = dissipated_energies(_HEAT)

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        self.check_ranges(p)
        one = {q.name: float(p[self.parameter_layout[q.name]][0]) for q in self.parameter_layout.quantities}
        return _Constants(
            one["radius_1"],
            one["radius_2"],
            SlackSpring(one["strand_stiffness"], one["preload"]),
            one["strand_damping"],
            one["end_weight"],
            is_of_order_four(one["order"]) and one["end_weight"] == 0.5 and not self._endpoint,
        )

    def _geometry(self, u: list[float], reference: tuple[float, float]) -> _Geometry:
        """Geometry of one instant; angles are those nearest the reference."""
        frame_1 = multiply((u[3], u[4], u[5], u[6]), self._axis_frame)
        frame_2 = multiply((u[16], u[17], u[18], u[19]), self._axis_frame)
        span = (u[13] - u[0], u[14] - u[1], u[15] - u[2])
        if self._guided:
            link = multiply((u[29], u[30], u[31], u[32]), self._axis_frame)
            angle_1 = swing_twist(multiply(conjugate(frame_1), link))[0]
            angle_2 = swing_twist(multiply(conjugate(frame_2), link))[0]
            axis = rotate(link, (1.0, 0.0, 0.0))
            works_1, works_2 = _shared(frame_1, axis), _shared(frame_2, axis)
        else:
            angle_1, works_1 = _angle_of(span, frame_1)
            angle_2, works_2 = _angle_of(span, frame_2)
        angles = (nearest_turn(angle_1, reference[0]), nearest_turn(angle_2, reference[1]))
        return _Geometry(angles, works_1, works_2, span)

    def _elongations(
        self, c: _Constants, g: _Geometry, start: tuple[float, float, float]
    ) -> tuple[float, float]:
        """Elongation of strands a and b from the start: length change of the loop plus and minus r1 d1 - r2 d2."""
        turn = c.radius_1 * (g.angles[0] - start[0]) - c.radius_2 * (g.angles[1] - start[1])
        stretch = self._length(c, norm(g.span)) - start[2]
        return stretch + turn, stretch - turn

    def _length(self, c: _Constants, distance: float) -> float:
        """Strand length between the pulleys, the wrap that changes with the distance included."""
        if self._guided:
            return distance
        difference = c.radius_1 - c.radius_2
        return sqrt(distance * distance - difference * difference) + difference * asin(difference / distance)

    def initial(self, c: _Constants, u: Vector) -> Vector:
        """Both strands at their preload in the pose of the inputs."""
        g = self._geometry(as_floats(u), (0.0, 0.0))
        if norm(g.span) <= abs(c.radius_1 - c.radius_2):
            raise ComponentError(
                f"the pulleys are {norm(g.span):g} m apart, less than the difference of their radii; check the ports"
            )
        x = np.zeros(self._slopes.stop)
        self._store(x, g, u)
        x[_START] = (*g.angles, self._length(c, norm(g.span)))
        return x

    def _store(self, x: Vector, g: _Geometry, u: Vector) -> None:
        """Put a geometry and the orientations of both pulleys into a state."""
        x[_ANGLES], x[_WORKS], x[_SPAN] = g.angles, (*g.works_1, *g.works_2), g.span
        x[self._frames] = (*u[3:7], *u[16:20])

    def step(self, c: _Constants, x: Vector, u: Vector, h: float) -> Vector:
        """One step; mean tensions from the strands' elongations at both ends."""
        v = as_floats(x)
        start = (v[11], v[12], v[13])
        old = _Geometry((v[0], v[1]), (v[2], v[3], v[4]), (v[5], v[6], v[7]), (v[8], v[9], v[10]))
        new = self._geometry(as_floats(u), old.angles)
        result = x.copy()
        self._store(result, new, u)
        if u[self._hold] > 0.5:
            return self._adjusted(c, result, new)
        before, after = self._elongations(c, old, start), self._elongations(c, new, start)
        works = mean(old.works_1, new.works_1), mean(old.works_2, new.works_2)
        middle = _Geometry(new.angles, *works, mean(old.span, new.span))
        if c.paired:
            line = Line(middle.span, subtract(new.span, old.span), 1.0 / norm(middle.span))
            moments = self._moments(c, v, as_floats(u), middle, line)
            loads = [
                workless_law(c.strand, c.damping, StepMotion(a, b, h, Memory(0.0, 0.0), moment))
                for a, b, moment in zip(before, after, moments, strict=True)
            ]
            result[_HEAT] += sum(load.heat for load in loads)
            result[self._wrench], result[self._slopes] = self._pairs(c, middle, line, loads)
            return result
        rates = [(b - a) / h for a, b in zip(before, after, strict=True)]
        tension = [
            -mean_force(c.strand, a, b, c.end_weight) + c.damping * rate
            for a, b, rate in zip(before, after, rates, strict=True)
        ]
        result[_HEAT] += self._heat(c, before, after, rates, h)
        result[self._wrench] = self._wrenches(c, middle, tension[0], tension[1])
        result[self._slopes] = 0.0
        return result

    def _adjusted(self, c: _Constants, result: Vector, g: _Geometry) -> Vector:
        """The state with both strands at their preload in the given geometry."""
        tension = -c.strand.value(0.0)
        result[_START] = (*g.angles, self._length(c, norm(g.span)))
        result[self._wrench] = self._wrenches(c, g, tension, tension)
        result[self._slopes] = 0.0
        return result

    def _moments(
        self, c: _Constants, x: list[float], u: list[float], g: _Geometry, line: Line
    ) -> tuple[float, float]:
        """Moments of both elongations' rates; the adjoint of `_pairs`."""
        first = self._hold + 1
        parts = [(u[i], u[i + 1], u[i + 2]) for i in range(first, len(u), 3)]
        apart, spins = subtract(parts[2], parts[0]), (parts[1], parts[3])
        if self._guided:
            relative = [subtract(parts[5], spin) for spin in spins]
        else:
            now = (u[3:7], u[16:20])
            frames = [x[i : i + 4] for i in range(self._frames.start, self._frames.stop, 4)]
            change = scaled(1.0 / 6.0, line.change)
            relative = [
                subtract(subtract(apart, cross(spin, g.span)), cross(_turn(before, after), change))
                for spin, before, after in zip(spins, frames, now, strict=True)
            ]
        return self._elongation_rates(c, g, relative, line.moment(apart))

    def _pairs(
        self, c: _Constants, g: _Geometry, line: Line, loads: list[MeanLoad]
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Mean wrenches of all ports and their slopes, which give no angular momentum as the centre line moves."""
        (a, b), (slope_a, slope_b) = (
            [-load.force for load in loads],
            [-load.slope for load in loads],
        )
        means, slopes = self._wrenches(c, g, a, b), self._wrenches(c, g, slope_a, slope_b)
        axial = self._axial(c, norm(g.span)) * (slope_a + slope_b)
        force = line.forces(0.0, axial)[0]
        added = [scaled(-1.0, force), (0.0, 0.0, 0.0), force, (0.0, 0.0, 0.0)]
        if not self._guided:
            change = scaled((slope_a - slope_b) / 6.0, line.change)
            added[1] = scaled(c.radius_1, cross(change, g.works_1))
            added[3] = scaled(-c.radius_2, cross(change, g.works_2))
        more = [value for vector in added for value in vector]
        return (*(p + q for p, q in zip(means[:12], more, strict=True)), *means[12:]), slopes

    def _axial(self, c: _Constants, distance: float) -> float:
        """Force along the centre line for a tension of one: free strands cross it."""
        step = 0.0 if self._guided else c.radius_1 - c.radius_2
        return sqrt(distance * distance - step * step) / distance

    @staticmethod
    def _heat(
        c: _Constants, before: tuple[float, float], after: tuple[float, float], rates: list[float], h: float
    ) -> float:
        heat = c.damping * h * sum(rate * rate for rate in rates)
        if c.end_weight != 0.5:
            heat -= sum(
                (mean_force(c.strand, a, b, c.end_weight) - mean_force(c.strand, a, b)) * (b - a)
                for a, b in zip(before, after, strict=True)
            )
        return heat

    def _wrenches(self, c: _Constants, g: _Geometry, tension_a: float, tension_b: float) -> tuple[float, ...]:
        """Wrenches of all ports; they sum to zero about any point."""
        distance = norm(g.span)
        direction = scaled(1.0 / distance, g.span)
        difference = tension_a - tension_b
        works_1 = scaled(c.radius_1 * difference, g.works_1)
        works_2 = scaled(-c.radius_2 * difference, g.works_2)
        if self._guided:
            torque_1, torque_2 = works_1, works_2
            force_2 = scaled(-(tension_a + tension_b), direction)
            guide = scaled(-1.0, add(add(torque_1, torque_2), cross(g.span, force_2)))
            return (*scaled(-1.0, force_2), *torque_1, *force_2, *torque_2, 0.0, 0.0, 0.0, *guide)
        step = c.radius_1 - c.radius_2
        axial = (tension_a + tension_b) * sqrt(distance * distance - step * step) / distance
        force_2 = subtract(scaled(-axial, direction), add(works_1, works_2))
        torque_1, torque_2 = cross(g.span, works_1), cross(g.span, works_2)
        return (*scaled(-1.0, force_2), *torque_1, *force_2, *torque_2)

    def _now(self, c: _Constants, x: Vector, u: Vector) -> _Instant:
        """Geometry, tensions and heat of this instant; strands that are being adjusted are at their preload."""
        v, inputs = as_floats(x), as_floats(u)
        g = self._geometry(inputs, (v[0], v[1]))
        elongations = rates = (0.0, 0.0)
        if not (self._endpoint and inputs[self._hold] > 0.5):
            elongations = self._elongations(c, g, (v[11], v[12], v[13]))
            rates = self._port_rates(c, inputs, g) if c.damping > 0.0 else rates
        a, b = (-c.strand.value(s) + c.damping * rate for s, rate in zip(elongations, rates, strict=True))
        return _Instant(g, elongations, a, b, c.damping * sum(rate * rate for rate in rates))

    def _port_rates(self, c: _Constants, u: list[float], g: _Geometry) -> tuple[float, float]:
        """Elongation rates of both strands from the ports' velocities."""
        velocity = (u[20] - u[7], u[21] - u[8], u[22] - u[9])
        spins = (u[10], u[11], u[12]), (u[23], u[24], u[25])
        if self._guided:
            relative = [subtract((u[36], u[37], u[38]), spin) for spin in spins]
        else:
            relative = [subtract(velocity, cross(spin, g.span)) for spin in spins]
        along = dot(velocity, scaled(1.0 / norm(g.span), g.span))
        return self._elongation_rates(c, g, relative, along)

    def _elongation_rates(
        self, c: _Constants, g: _Geometry, relative: Sequence[Vector3], along: float
    ) -> tuple[float, float]:
        """Elongation rates from that of the centre line, and from what moves against each pulley."""
        rate_1, rate_2 = dot(relative[0], g.works_1), dot(relative[1], g.works_2)
        stretch = along if self._guided else along * self._axial(c, norm(g.span))
        turn = c.radius_1 * rate_1 - c.radius_2 * rate_2
        return stretch + turn, stretch - turn

    def outputs(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Wrenches on all ports, slopes of mean wrenches."""
        if not self._endpoint:
            return np.concatenate((x[self._wrench], x[self._slopes]))
        now = self._now(c, x, u)
        return np.array(self._wrenches(c, now.geometry, now.tension_a, now.tension_b))

    def observe(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Tensions, forces and torques of this instant, and energies."""
        g, (a, b), tension_a, tension_b, _ = self._now(c, x, u)
        distance = norm(g.span)
        step = 0.0 if self._guided else c.radius_1 - c.radius_2
        difference = tension_a - tension_b
        return np.array(
            (
                tension_a,
                tension_b,
                c.radius_1 * difference,
                -c.radius_2 * difference,
                (tension_a + tension_b) * sqrt(distance * distance - step * step) / distance,
                -difference * step / distance,
                0.5 * (a - b),
                c.strand.potential(a) + c.strand.potential(b),
                float(x[_HEAT]),
            )
        )

    def rates(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Heat of the strands' damping (W)."""
        return np.array((self._now(c, x, u).heat,))

    def update(self, c: _Constants, x: Vector, u: Vector, at_event: bool) -> Vector:
        """Follow the angles; while strands are adjusted, the present geometry is the one of their preload."""
        g = self._geometry(as_floats(u), (float(x[0]), float(x[1])))
        result = x.copy()
        result[_ANGLES] = g.angles
        if u[self._hold] > 0.5:
            result[_START] = (*g.angles, self._length(c, norm(g.span)))
        return result

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Pulley axis, course of the cables and mode."""
        return {"axis_frame": self._axis_frame, "guided": self._guided, "endpoint": self._endpoint}

    @classmethod
    def example(cls) -> CableLoop:
        """A loop whose cables are led along the body between."""
        return cls(guided=True)


def _shared(frame: Quaternion, axis: Vector3) -> Vector3:
    """Direction (a + b) / (1 + a.b) of a frame's x axis a and an axis b, along which a torque works on their twist."""
    own = rotate(frame, (1.0, 0.0, 0.0))
    return scaled(1.0 / (1.0 + dot(own, axis)), add(own, axis))


def _turn(before: Sequence[float], after: Sequence[float]) -> Vector3:
    """Turn of a port between two quaternions."""
    return turn_between(
        (before[0], before[1], before[2], before[3]), (after[0], after[1], after[2], after[3])
    )


def _angle_of(span: Vector3, frame: Quaternion) -> tuple[float, Vector3]:
    """Angle of the centre line about a frame's x axis, and its gradient (1/m) with respect to the centre line."""
    _, y, z = rotate_back(frame, span)
    square = y * y + z * z
    return atan2(z, y), rotate(frame, (0.0, -z / square, y / square))


def _parameters() -> list[Quantity]:
    def tunable(name: str, unit: str, text: str, start: float, minimum: float) -> Quantity:
        return Quantity(name, unit, text, 1, start, minimum, variability="tunable")

    return [
        tunable("radius_1", "m", "Radius of pulley 1", 0.03, 1e-6),
        tunable("radius_2", "m", "Radius of pulley 2", 0.03, 1e-6),
        tunable("preload", "N", "Tension of each strand at the start", 40.0, 0.0),
        tunable("strand_stiffness", "N/m", "Stiffness of one strand", 5000.0, 1e-9),
        tunable("strand_damping", "N.s/m", "Damping of one strand", 0.0, 0.0),
        Quantity("end_weight", "1", "Weight of the end value in mean wrenches", 1, 0.5, 0.5, 1.0, "tunable"),
        order_parameter(),
    ]


def _observations() -> list[Quantity]:
    return [
        Quantity("tension_a", "N", "Tension of strand a"),
        Quantity("tension_b", "N", "Tension of strand b"),
        Quantity("torque_1", "N.m", "Torque T1 on body 1 about the pulley axis"),
        Quantity("torque_2", "N.m", "Torque T2 on body 3 about the pulley axis"),
        Quantity("axial_force", "N", "Force between the pulleys along their centre line"),
        Quantity("lateral_force", "N", "Lateral force on each pulley"),
        Quantity("synchronization_error", "m", "r1 phi1 - r2 phi2, what the strands take up"),
        Quantity("potential_energy", "J", "Elastic energy of both strands"),
        Quantity("dissipated_energy", "J", "Energy dissipated since the start"),
    ]
