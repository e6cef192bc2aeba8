r"""Closed-cable-loop (CCL) synchroniser: two preloaded strands between two pulleys on bodies 1 and 3.

$$ e_{a,b} = \Delta \ell \pm (r_1\, \Delta\varphi_1 - r_2\, \Delta\varphi_2) $$

$$ T_{a,b} = \max(0,\; P + k\, e_{a,b} + c\, \dot e{}_{a,b}) \text{ where the strand is taut} $$

with the preload $P$, the stiffness $k$ and the damping $c$ of one strand, the radii $r_i$, the angles $\varphi_i$ of
the pulleys against the strands, and the length $\ell$ of these.

The wrenches follow from the elongations of the two strands, so they are conservative by construction; in
components they are equations 2.3 to 2.6 of Bagnoli (2007), section 2.2.5, with L the free strand length,
hence a pulley distance of sqrt(L^2 + (r1 - r2)^2): only with that arm is angular momentum balanced.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import asin, atan2, sqrt
from typing import Annotated, NamedTuple

from numpy.typing import ArrayLike

from .contract.component import ComponentError, Vector
from .contract.connection import HEAT, SLOPES, WRENCH, Connection, Inputs
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
from .contract.ports import WRENCH_SIZE
from .contract.record import Record, kept, observed, tunable
from .contract.roles import CUT, DISSIPATED_ENERGY, HOLD, LOAD, ORDER, POTENTIAL_ENERGY
from .numerics.laws import SlackSpring
from .numerics.relative_motion import Line, axis_frame, turn_between
from .numerics.scheme import FAR_APART
from .numerics.stiff_coordinate import MeanLoad, Memory, StepMotion
from .numerics.strand import damping_power, mean_tension, strand_load, tension_at


class _Parameters(NamedTuple):
    radius_1: Annotated[float, tunable("m", "Radius of pulley 1", 0.03, 1e-6)]
    radius_2: Annotated[float, tunable("m", "Radius of pulley 2", 0.03, 1e-6)]
    preload: Annotated[float, tunable("N", "Tension of each strand at the start", 40.0, 0.0)]
    strand_stiffness: Annotated[float, tunable("N/m", "Stiffness of one strand", 5000.0, 1e-9)]
    strand_damping: Annotated[float, tunable("N.s/m", "Damping of one strand", 0.0, 0.0)]
    cut: Annotated[float, CUT.saying("1: the cable is cut, and its strands carry nothing")]
    order: Annotated[float, ORDER]


class _Preload(NamedTuple):
    """States: where both strands are at their preload."""

    preload_angles: Annotated[tuple[float, float], kept("rad", "Angles of the pulleys at the preload")]
    preload_length: Annotated[float, kept("m", "Strand length between the pulleys at the preload")]


class _Geometry(NamedTuple):
    """States: angles of both pulleys against the strands (rad, unwrapped) and the centre line `span`, world axes.

    works_1, works_2: what a pulley's angle works on. Guided cables: the direction whose torque does the work
    of that angle. Free strands: the angle's gradient (1/m) with respect to the centre line; span x gradient
    is then the direction of the torque, so wrenches balance at any tilt of the pulleys.
    """

    angles: Annotated[tuple[float, float], kept("rad", "Angles of the pulleys, unwrapped")]
    works_1: Annotated[Vector3, kept("1", "What the angle of pulley 1 works on")]
    works_2: Annotated[Vector3, kept("1", "What the angle of pulley 2 works on")]
    span: Annotated[Vector3, kept("m", "Centre line from pulley 1 to pulley 2, world axes")]


class _State(NamedTuple):
    geometry: _Geometry
    preload: _Preload
    heat: Annotated[float, HEAT]
    frames: Annotated[tuple[Quaternion, Quaternion], kept("1", "Orientations of both pulleys")]
    wrench: Annotated[tuple[float, ...], WRENCH]
    slopes: Annotated[tuple[float, ...], SLOPES]


class _Commands(NamedTuple):
    hold: Annotated[float, HOLD.saying("1: strands are adjusted to their preload at every step")]


class _Observations(NamedTuple):
    tension_a: Annotated[float, observed("N", "Tension of strand a", LOAD)]
    tension_b: Annotated[float, observed("N", "Tension of strand b", LOAD)]
    torque_1: Annotated[float, observed("N.m", "Torque T1 on body 1 about the pulley axis")]
    torque_2: Annotated[float, observed("N.m", "Torque T2 on body 3 about the pulley axis")]
    axial_force: Annotated[float, observed("N", "Force between the pulleys along their centre line", LOAD)]
    lateral_force: Annotated[float, observed("N", "Lateral force on each pulley", LOAD)]
    synchronization_error: Annotated[float, observed("m", "r1 phi1 - r2 phi2, what the strands take up")]
    potential_energy: Annotated[float, POTENTIAL_ENERGY.saying("Elastic energy of both strands")]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]


class _Instant(NamedTuple):
    """Geometry, and elongations, their rates and tensions of both strands."""

    geometry: _Geometry
    elongations: tuple[float, float]
    rates: tuple[float, float]
    tension_a: float
    tension_b: float


class _Constants(NamedTuple):
    p: _Parameters
    strand: SlackSpring
    is_paired: bool


class CableLoop(Connection[_Parameters, _State, _Commands]):
    """Closed cable loop between pulley 1 (port `pulley_1`, fixed to body 1) and pulley 2 (`pulley_2`, body 3).

    axis: pulley axis in the axes of both pulley ports. guided: cables are led along body 2, which then has
    a third port `guide` and takes the torque -(T1 + T2); otherwise the strands run free and the difference
    of radii makes a lateral pair of forces on the pulleys.
    """

    kind, noun, ports_vary = "ccl", "closed cable loop", True
    parameters = Record(_Parameters)
    commands, observations = Record(_Commands), Record(_Observations)

    def __init__(
        self,
        axis: Sequence[float] = (0.0, 1.0, 0.0),
        guided: bool = False,
        wrench_mode: str = "mean",
    ) -> None:
        self._axis_frame = axis_frame(axis, "the pulley axes")
        self._guided = bool(guided)
        self.port_names = ("pulley_1", "pulley_2", "guide") if guided else ("pulley_1", "pulley_2")
        size = WRENCH_SIZE * len(self.port_names)
        self._no_wrench = (0.0,) * size
        self.states = Record(_State, wrench=size, slopes=size)
        super().__init__({"axis": tuple(axis), "guided": self._guided}, wrench_mode)

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        one = self._checked(p)
        preload = one.preload if one.cut < 0.5 else -FAR_APART * one.strand_stiffness
        strand = SlackSpring(one.strand_stiffness, preload)
        return _Constants(one, strand, self._is_paired(one.order))

    def _geometry(self, u: Inputs[_Commands], reference: tuple[float, float]) -> _Geometry:
        """Geometry of one instant; angles are those nearest the reference."""
        pulley_1, pulley_2, *guide = u.motions
        frame_1 = multiply(pulley_1.orientation, self._axis_frame)
        frame_2 = multiply(pulley_2.orientation, self._axis_frame)
        span = subtract(pulley_2.position, pulley_1.position)
        if guide:
            link = multiply(guide[0].orientation, self._axis_frame)
            angle_1, *_ = swing_twist(multiply(conjugate(frame_1), link))
            angle_2, *_ = swing_twist(multiply(conjugate(frame_2), link))
            axis = rotate(link, (1.0, 0.0, 0.0))
            works_1, works_2 = _shared(frame_1, axis), _shared(frame_2, axis)
        else:
            angle_1, works_1 = _angle_of(span, frame_1)
            angle_2, works_2 = _angle_of(span, frame_2)
        angles = (nearest_turn(angle_1, reference[0]), nearest_turn(angle_2, reference[1]))
        return _Geometry(angles, works_1, works_2, span)

    def _elongations(self, c: _Constants, g: _Geometry, start: _Preload) -> tuple[float, float]:
        """Elongation of strands a and b from the start: length change of the loop plus and minus r1 d1 - r2 d2."""
        turn = c.p.radius_1 * (g.angles[0] - start.preload_angles[0]) - c.p.radius_2 * (
            g.angles[1] - start.preload_angles[1]
        )
        stretch = self._length(c, norm(g.span)) - start.preload_length
        return stretch + turn, stretch - turn

    def _length(self, c: _Constants, distance: float) -> float:
        """Strand length between the pulleys, the wrap that changes with the distance included."""
        if self._guided:
            return distance
        difference = c.p.radius_1 - c.p.radius_2
        return sqrt(distance * distance - difference * difference) + difference * asin(difference / distance)

    def _preload(self, c: _Constants, g: _Geometry) -> _Preload:
        """The given geometry as the one of the preload."""
        return _Preload(g.angles, self._length(c, norm(g.span)))

    def start(self, c: _Constants, u: Inputs[_Commands]) -> _State:
        """Both strands at their preload in the pose of the inputs."""
        g = self._geometry(u, (0.0, 0.0))
        if norm(g.span) <= abs(c.p.radius_1 - c.p.radius_2):
            raise ComponentError(
                f"the pulleys are {norm(g.span):g} m apart, less than the difference of their radii; check the ports"
            )
        return _State(g, self._preload(c, g), 0.0, _frames(u), self._no_wrench, self._no_wrench)

    def advance(self, c: _Constants, s: _State, u: Inputs[_Commands], h: float) -> _State:
        """Mean tensions from the strands' elongations at both ends."""
        old, new = s.geometry, self._geometry(u, s.geometry.angles)
        moved = s._replace(geometry=new, frames=_frames(u), slopes=self._no_wrench)
        if u.commands.hold > 0.5:
            tension = -c.strand.value(0.0)
            wrench = self._wrenches(c, new, tension, tension)
            return moved._replace(preload=self._preload(c, new), wrench=wrench)
        before, after = self._elongations(c, old, s.preload), self._elongations(c, new, s.preload)
        works = mean(old.works_1, new.works_1), mean(old.works_2, new.works_2)
        middle = _Geometry(new.angles, *works, mean(old.span, new.span))
        if c.is_paired:
            line = Line(middle.span, subtract(new.span, old.span), 1.0 / norm(middle.span))
            moments = self._moments(c, s, u, middle, line)
            loads = [
                strand_load(c.strand, c.p.strand_damping, StepMotion(a, b, h, Memory(0.0, 0.0), moment))
                for a, b, moment in zip(before, after, moments, strict=True)
            ]
            wrench, slopes = self._pairs(c, middle, line, loads)
            heat = s.heat + sum(load.heat for load in loads)
            return moved._replace(heat=heat, wrench=wrench, slopes=slopes)
        (tension_a, heat_a), (tension_b, heat_b) = (
            mean_tension(c.strand, c.p.strand_damping, a, b, h) for a, b in zip(before, after, strict=True)
        )
        return moved._replace(
            heat=s.heat + heat_a + heat_b,
            wrench=self._wrenches(c, middle, tension_a, tension_b),
        )

    def _moments(
        self, c: _Constants, s: _State, u: Inputs[_Commands], g: _Geometry, line: Line
    ) -> tuple[float, float]:
        """Moments of both elongations' rates; the adjoint of `_pairs`."""
        pulley_1, pulley_2, *guide = u.moments
        apart = subtract(pulley_2.velocity, pulley_1.velocity)
        spins = pulley_1.angular_velocity, pulley_2.angular_velocity
        if guide:
            relative = [subtract(guide[0].angular_velocity, spin) for spin in spins]
        else:
            change = scaled(1.0 / 6.0, line.change)
            relative = [
                subtract(subtract(apart, cross(spin, g.span)), cross(turn_between(before, after), change))
                for spin, before, after in zip(spins, s.frames, _frames(u), strict=True)
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
            added[1] = scaled(c.p.radius_1, cross(change, g.works_1))
            added[3] = scaled(-c.p.radius_2, cross(change, g.works_2))
        more = [value for vector in added for value in vector]
        return (*(p + q for p, q in zip(means[:12], more, strict=True)), *means[12:]), slopes

    def _axial(self, c: _Constants, distance: float) -> float:
        """Force along the centre line for a tension of one: free strands cross it."""
        step = 0.0 if self._guided else c.p.radius_1 - c.p.radius_2
        return sqrt(distance * distance - step * step) / distance

    def _wrenches(self, c: _Constants, g: _Geometry, tension_a: float, tension_b: float) -> tuple[float, ...]:
        """Wrenches of all ports; they sum to zero about any point."""
        distance = norm(g.span)
        direction = scaled(1.0 / distance, g.span)
        difference = tension_a - tension_b
        works_1 = scaled(c.p.radius_1 * difference, g.works_1)
        works_2 = scaled(-c.p.radius_2 * difference, g.works_2)
        if self._guided:
            torque_1, torque_2 = works_1, works_2
            force_2 = scaled(-(tension_a + tension_b), direction)
            guide = scaled(-1.0, add(add(torque_1, torque_2), cross(g.span, force_2)))
            return (*scaled(-1.0, force_2), *torque_1, *force_2, *torque_2, 0.0, 0.0, 0.0, *guide)
        step = c.p.radius_1 - c.p.radius_2
        axial = (tension_a + tension_b) * sqrt(distance * distance - step * step) / distance
        force_2 = subtract(scaled(-axial, direction), add(works_1, works_2))
        torque_1, torque_2 = cross(g.span, works_1), cross(g.span, works_2)
        return (*scaled(-1.0, force_2), *torque_1, *force_2, *torque_2)

    def _now(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> _Instant:
        """Geometry and tensions of this instant; strands that are being adjusted are at their preload."""
        g = self._geometry(u, s.geometry.angles)
        damping, elongations, rates = c.p.strand_damping, (0.0, 0.0), (0.0, 0.0)
        if not (self.endpoint and u.commands.hold > 0.5):
            elongations = self._elongations(c, g, s.preload)
            rates = self._port_rates(c, u, g) if damping > 0.0 else rates
        a, b = (
            tension_at(c.strand, damping, one, rate) for one, rate in zip(elongations, rates, strict=True)
        )
        return _Instant(g, elongations, rates, a, b)

    def _port_rates(self, c: _Constants, u: Inputs[_Commands], g: _Geometry) -> tuple[float, float]:
        """Elongation rates of both strands from the ports' velocities."""
        pulley_1, pulley_2, *guide = u.motions
        velocity = subtract(pulley_2.velocity, pulley_1.velocity)
        spins = pulley_1.angular_velocity, pulley_2.angular_velocity
        if guide:
            relative = [subtract(guide[0].angular_velocity, spin) for spin in spins]
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
        turn = c.p.radius_1 * rate_1 - c.p.radius_2 * rate_2
        return stretch + turn, stretch - turn

    def wrenches(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> Sequence[float]:
        """Of the present tensions."""
        now = self._now(c, s, u)
        return self._wrenches(c, now.geometry, now.tension_a, now.tension_b)

    def record(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> _Observations:
        """Tensions, forces and torques of this instant, and energies."""
        g, (a, b), _, tension_a, tension_b = self._now(c, s, u)
        distance = norm(g.span)
        step = 0.0 if self._guided else c.p.radius_1 - c.p.radius_2
        difference = tension_a - tension_b
        return _Observations(
            tension_a=tension_a,
            tension_b=tension_b,
            torque_1=c.p.radius_1 * difference,
            torque_2=-c.p.radius_2 * difference,
            axial_force=(tension_a + tension_b) * sqrt(distance * distance - step * step) / distance,
            lateral_force=-difference * step / distance,
            synchronization_error=0.5 * (a - b),
            potential_energy=c.strand.potential(a) + c.strand.potential(b),
            dissipated_energy=s.heat,
        )

    def powers(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> Sequence[float]:
        """Heat of the strands' damping (W)."""
        now = self._now(c, s, u)
        strands = zip(now.elongations, now.rates, strict=True)
        return (sum(damping_power(c.strand, c.p.strand_damping, one, rate) for one, rate in strands),)

    def follow(self, c: _Constants, s: _State, u: Inputs[_Commands], at_event: bool) -> _State:
        """Follow the angles; while strands are adjusted, the present geometry is the one of their preload."""
        g = self._geometry(u, s.geometry.angles)
        followed = s._replace(geometry=s.geometry._replace(angles=g.angles))
        return followed._replace(preload=self._preload(c, g)) if u.commands.hold > 0.5 else followed

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Pulley axis, course of the cables and mode."""
        return {**super().native_data(), "axis_frame": self._axis_frame, "guided": self._guided}

    @classmethod
    def example(cls) -> CableLoop:
        """A loop whose cables are led along the body between."""
        return cls(guided=True)


def _frames(u: Inputs[_Commands]) -> tuple[Quaternion, Quaternion]:
    """Orientations of both pulleys."""
    pulley_1, pulley_2, *_ = u.motions
    return pulley_1.orientation, pulley_2.orientation


def _shared(frame: Quaternion, axis: Vector3) -> Vector3:
    """Direction (a + b) / (1 + a.b) of a frame's x axis a and an axis b, along which a torque works on their twist."""
    own = rotate(frame, (1.0, 0.0, 0.0))
    return scaled(1.0 / (1.0 + dot(own, axis)), add(own, axis))


def _angle_of(span: Vector3, frame: Quaternion) -> tuple[float, Vector3]:
    """Angle of the centre line about a frame's x axis, and its gradient (1/m) with respect to the centre line."""
    _, y, z = rotate_back(frame, span)
    square = y * y + z * z
    return atan2(z, y), rotate(frame, (0.0, -z / square, y / square))
