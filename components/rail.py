r"""Rail: a trolley guided in a plane at its orientation, with Coulomb friction against its sliding.

$$ F_n = -k_n q_n - c_n \dot q{}_n,\qquad T_i = -k_r \theta_i - c_r \dot{\theta}{}_i,\qquad \mathbf F_t =
-F_\mu\, \frac{\mathbf v}{|\mathbf v|} $$

with the displacement $q_n$ normal to the plane, rotations $\theta_i$, and friction $F_\mu$ against the sliding
velocity $\mathbf v$. Below $F_\mu$ the trolley sticks, by an elastic deflection.

Friction that sticks is that of `presliding` in two dimensions: a spring of deflection z in the plane, and a damper as
far as both stay within the friction F, in series with a slider. The force is -(k z + c v), and z' = v; but |z| is at
most L = F / k, so that z' = v - (v . z) z / L^2 where the trolley slides.

Over a step the axes are those of most and of least motion. Along the first the law is `step_force`, of the friction
that the spring across leaves it. Across, z' = v - a z with a constant a, the way slid over L: a spring while the
trolley sticks, friction against the turn of the velocity while it slides. Mean, slope and end of both are exact
integrals, and their work is that along the path. Heat is that of `step_force`, a times k z^2 across, that of damping
across, and what |z| <= L cuts off at the end, none of them negative: the law cannot generate energy.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import atan2, cos, exp, sin, sqrt
from typing import Annotated, NamedTuple

from numpy.typing import ArrayLike

from .contract.component import Vector
from .contract.connection import SLOPES, WRENCH, Connection, Impulse, Inputs
from .contract.frames import (
    Quaternion,
    Vector3,
    conjugate,
    exponential,
    multiply,
    nearest_turn,
    rotate,
    rotation_vector,
    subtract,
)
from .contract.ports import WRENCH_SIZE, PortMoments, PortMotion
from .contract.record import Record, fixed, integrated, kept, observed, tunable
from .contract.roles import (
    DISSIPATED_ENERGY,
    DISSIPATION,
    LOAD,
    NUMERICAL_DISSIPATION,
    ORDER,
    POTENTIAL_ENERGY,
)
from .numerics.fourth_order_correction import gauss_rates, memories_after, stiff_load, viscous_load
from .numerics.interval_mean import MidStep
from .numerics.laws import stiction_factors
from .numerics.presliding import Presliding, step_force
from .numerics.relative_motion import (
    Passage,
    Pose,
    axis_frame,
    conjugate_torque,
    relative_pose,
    relative_rates,
)
from .numerics.stiff_coordinate import Memory, StepMotion

Four = tuple[float, float, float, float]
Two = tuple[float, float]
_NONE: Two = (0.0, 0.0)

_AT_REST: Vector3 = (0.0, 0.0, 0.0)
_NO_WRENCH = (0.0,) * WRENCH_SIZE
_STILL = 1e-11
"""Of the largest deflection, motion over a step that has no direction: rounding of places."""
_AT_LIMIT = 1.0 - 1e-9
"""Of the largest deflection, from where on it is that."""
_TERMS = (1.0, 1.0, 0.5, 1.0 / 6.0)


class _Parameters(NamedTuple):
    normal_stiffness: Annotated[float, tunable("N/m", "Stiffness normal to the plane", 1e6, 0.0)]
    normal_damping: Annotated[float, tunable("N.s/m", "Damping normal to the plane", 0.0, 0.0)]
    rotational_stiffness: Annotated[float, tunable("N.m/rad", "Stiffness against any rotation", 1e4, 0.0)]
    rotational_damping: Annotated[float, tunable("N.m.s/rad", "Damping of any rotation", 0.0, 0.0)]
    friction_force: Annotated[float, tunable("N", "Coulomb friction against sliding", 0.0, 0.0)]
    stiction_velocity: Annotated[float, tunable("m/s", "Speed from which friction is full", 2e-2, 1e-9)]
    breakaway_deflection: Annotated[
        float,
        tunable("m", "Elastic deflection where friction breaks away; 0: it is smooth at rest", 1e-4, 0.0),
    ]
    initial_offset: Annotated[
        Vector3, fixed("m", "Of the trolley at the start, from its free place, world axes")
    ]
    initial_turn: Annotated[
        Vector3, fixed("rad", "The same of its orientation, rotation vector in world axes")
    ]
    order: Annotated[float, ORDER]

    @property
    def stiffness(self) -> Four:
        """Of the four stiff coordinates in order."""
        return (self.normal_stiffness, *(self.rotational_stiffness,) * 3)

    @property
    def damping(self) -> Four:
        """The same of damping."""
        return (self.normal_damping, *(self.rotational_damping,) * 3)

    @property
    def sticks(self) -> bool:
        """Whether there is friction and it sticks."""
        return self.friction_force > 0.0 and self.breakaway_deflection > 0.0

    @property
    def contact(self) -> Two:
        """Stiffness and damping of friction that sticks; zero where nothing does."""
        if not self.sticks:
            return _NONE
        return self.friction_force / self.breakaway_deflection, self.friction_force / self.stiction_velocity

    def friction_at(self, speed: float) -> float:
        """Smooth friction at a sliding speed."""
        return self.friction_force * stiction_factors(abs(speed), self.stiction_velocity, 1.0).constant

    def friction(self, velocity: Two) -> Two:
        """Smooth friction against a sliding velocity, in the plane's axes."""
        speed = _length(*velocity)
        if speed == 0.0:
            return _NONE
        share = -self.friction_at(speed) / speed
        return share * velocity[0], share * velocity[1]


class _Constants(NamedTuple):
    p: _Parameters
    is_paired: bool


class _State(NamedTuple):
    position: Annotated[Vector3, kept("m", "Free place of the trolley, world axes")]
    orientation: Annotated[Quaternion, kept("1", "Its orientation there")]
    offset: Annotated[Vector3, kept("m", "Offset from there, the first along the normal")]
    turn: Annotated[Vector3, kept("rad", "Turn from there: twist about the normal, swing")]
    memories: Annotated[tuple[Memory, ...], kept("1", "Memories of the stiff coordinates").sized(4)]
    slide: Annotated[MidStep, kept("m/s", "Mean sliding speeds of two steps")]
    friction_heat: Annotated[float, integrated("J", "W", "Energy dissipated since the start")]
    damping_heat: Annotated[float, integrated("J", "W", "Energy dissipated since the start")]
    numerical: Annotated[float, kept("J", "What the scheme took away")]
    wrench: Annotated[tuple[float, ...], WRENCH.sized(WRENCH_SIZE)] = _NO_WRENCH
    slopes: Annotated[tuple[float, ...], SLOPES.sized(WRENCH_SIZE)] = _NO_WRENCH
    pressed: Annotated[MidStep, kept("N", "Mean normal forces of two steps of order 4")] = MidStep.starting(
        0.0
    )
    deflection: Annotated[Two, kept("m", "Elastic deflection of friction that sticks, plane's axes")] = _NONE

    @property
    def stiff(self) -> Four:
        """The four stiff coordinates."""
        return (self.offset[0], *self.turn)


class _Observations(NamedTuple):
    normal_force: Annotated[float, observed("N", "Force on the trolley along the normal", LOAD)]
    friction_force_magnitude: Annotated[
        float, observed("N", "Friction force on the trolley, against its sliding")
    ]
    sliding_speed: Annotated[float, observed("m/s", "Speed of the trolley in the plane")]
    friction_energy: Annotated[float, observed("J", "Energy dissipated by friction", DISSIPATION)]
    potential_energy: Annotated[float, POTENTIAL_ENERGY.saying("Elastic energy of guidance and friction")]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]
    numerical_dissipation: Annotated[float, NUMERICAL_DISSIPATION]


class _Instant(NamedTuple):
    """Pose against the start, in axes with x along the normal; stiff coordinates (normal, twist, swing y, z).

    velocity: the sliding velocity in the plane's two axes.
    """

    pose: Pose
    stiff: Four
    rates: Four
    velocity: Two

    @property
    def speed(self) -> float:
        """Sliding speed."""
        return _length(*self.velocity)


class Rail(Connection[_Parameters, _State, Impulse]):
    """Rail: guides the trolley port in the plane through its start position, without rotation.

    A scene that starts in equilibrium has an initial offset and turn from there.

    normal: direction normal to the plane, world axes; the plane is fixed to the ground, so the rail has one port
    only. Stiffness and damping act along the normal and on all rotations; in the plane there is only friction. That
    sticks: a trolley that is pulled by less stays where it is. Without breakaway_deflection it is smooth at rest.
    """

    kind, port_names = "rail", ("trolley",)
    parameters, states = Record(_Parameters), Record(_State)
    commands, observations = Record(Impulse), Record(_Observations)

    def __init__(self, normal: Sequence[float] = (0.0, 0.0, 1.0), wrench_mode: str = "mean") -> None:
        self._axes = axis_frame(normal, "the normal to the rail's plane", "normal")
        super().__init__({"normal": tuple(normal)}, wrench_mode)

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        one = self._checked(p)
        return _Constants(one, self._is_paired(one.order))

    def start(self, c: _Constants, u: Inputs[Impulse]) -> _State:
        """The plane goes through the place of the inputs, less the initial offset and turn."""
        (trolley,) = u.motions
        position = subtract(trolley.position, c.p.initial_offset)
        orientation = multiply(conjugate(exponential(c.p.initial_turn)), trolley.orientation)
        now = self._instant(position, orientation, u, 0.0)
        memories = tuple(Memory(rate, rate) for rate in now.rates)
        slide = MidStep.starting(now.speed)
        place = (position, orientation, now.pose.offset, now.stiff[1:])
        return _State(*place, memories, slide, 0.0, 0.0, 0.0)

    def led(self, before: Sequence[PortMotion], now: Sequence[PortMotion]) -> Mapping[str, Sequence[float]]:
        """How the trolley has moved and turned."""
        (then,), (here,) = before, now
        turn = multiply(here.orientation, conjugate(then.orientation))
        return {
            "initial_offset": subtract(here.position, then.position),
            "initial_turn": rotation_vector(turn),
        }

    def _instant(
        self, position: Vector3, orientation: Quaternion, u: Inputs[Impulse], reference: float
    ) -> _Instant:
        """The instant of the inputs, seen from a place; the twist is the one nearest the reference."""
        axes = multiply(conjugate(orientation), self._axes)
        motions = (PortMotion(position, orientation, _AT_REST, _AT_REST), *u.motions)
        pose = relative_pose(motions, axes)
        rates = relative_rates(motions, pose)
        twist = nearest_turn(pose.twist, reference)
        return _Instant(
            pose,
            (pose.offset[0], twist, *pose.swing),
            (rates.offset[0], rates.twist, *rates.swing),
            rates.offset[1:],
        )

    def _now(self, s: _State, u: Inputs[Impulse]) -> _Instant:
        return self._instant(s.position, s.orientation, u, s.turn[0])

    def advance(self, c: _Constants, s: _State, u: Inputs[Impulse], h: float) -> _State:
        """Mean loads of the stiff coordinates, and friction against the sliding velocity within the step."""
        now, is_impulse = self._now(s, u), u.commands.impulse > 0.5
        is_paired = c.is_paired and not is_impulse
        swing_y, swing_z = (0.5 * (a + b) for a, b in zip(s.stiff[2:], now.stiff[2:], strict=True))
        bent, moments = _NONE, (0.0,) * 4
        if is_paired:
            bent, moments = _moments(now, u.moments[0], (swing_y, swing_z))
        motions = self._motions(s, now, moments, h)
        loads = [
            stiff_load(k, d, motion, is_paired=is_paired)
            for k, d, motion in zip(c.p.stiffness, c.p.damping, motions, strict=True)
        ]
        slid_y, slid_z = (a - b for a, b in zip(now.pose.offset[1:], s.offset[1:], strict=True))
        friction = self._friction(c.p, s.deflection, (slid_y, slid_z), bent, h, is_impulse=is_impulse)
        moved = s._replace(
            offset=now.pose.offset,
            turn=now.stiff[1:],
            memories=memories_after(motions, now.rates, is_paired=is_paired, is_impulse=is_impulse),
            friction_heat=s.friction_heat + friction.heat,
            damping_heat=s.damping_heat + sum(load.heat for load in loads),
            numerical=s.numerical + sum(load.numerical for load in loads),
            wrench=_wrench(now, [load.force for load in loads], friction.force, (swing_y, swing_z)),
            slopes=_NO_WRENCH,
            pressed=MidStep.starting(0.0),
            deflection=friction.deflection,
        )
        if not is_paired:
            slide = (
                MidStep.starting(now.speed) if is_impulse else s.slide.after(_length(slid_y, slid_z) / h, h)
            )
            return moved._replace(slide=slide)
        slopes = _wrench(now, [load.slope for load in loads], friction.slope, (swing_y, swing_z))
        ending = _length(slid_y + 3.0 * bent[0], slid_z + 3.0 * bent[1]) / h
        pressed = s.pressed.after(loads[0].force, h)
        return moved._replace(slopes=slopes, slide=MidStep.starting(ending), pressed=pressed)

    def _friction(
        self, p: _Parameters, start: Two, slid: Two, bent: Two, h: float, *, is_impulse: bool
    ) -> _Friction:
        """Over a step; in an impulse friction that sticks does nothing, of an end point it follows the trolley."""
        if not p.sticks:
            return _smooth_friction(p, slid, bent, h)
        if is_impulse:
            return _Friction(_NONE, _NONE, 0.0, start)
        friction = _sticking_friction(p, start, slid, bent, h)
        return friction._replace(deflection=_moved(p, start, slid)) if self.endpoint else friction

    def _motions(self, s: _State, now: _Instant, moments: Four, h: float) -> list[StepMotion]:
        """Motions of the four stiff coordinates."""
        ends = zip(s.stiff, now.stiff, s.memories, moments, strict=True)
        motions = [StepMotion(start, end, h, memory, moment) for start, end, memory, moment in ends]
        return [motion.without_inertia() for motion in motions] if self.endpoint else motions

    def wrenches(self, c: _Constants, s: _State, u: Inputs[Impulse]) -> Sequence[float]:
        """On the trolley."""
        now = self._now(s, u)
        load = [
            -k * q - d * w
            for k, d, q, w in zip(c.p.stiffness, c.p.damping, now.stiff, now.rates, strict=True)
        ]
        friction, _ = _instant_friction(c.p, _deflection_now(c.p, s, now), now.velocity)
        return _wrench(now, load, friction, now.pose.swing)

    def record(self, c: _Constants, s: _State, u: Inputs[Impulse]) -> _Observations:
        """Forces at the communication point, and energies; of order 4 from what the last steps' loads were."""
        now = self._now(s, u)
        rate, speed = now.rates[0], now.speed
        if not self.endpoint:
            memory = s.memories[0]
            rate, speed = memory.end_rate if c.is_paired else memory.mean_rate, s.slide.now()
        normal = -c.p.normal_stiffness * now.pose.offset[0] - c.p.normal_damping * rate
        if c.is_paired:
            normal = s.pressed.load_now(normal, s.memories[0].roughness)
        deflection, (y, z) = _deflection_now(c.p, s, now), now.velocity
        velocity = (y / now.speed * speed, z / now.speed * speed) if now.speed > 0.0 else _NONE
        friction = _length(*_instant_friction(c.p, deflection, velocity)[0])
        stored = zip((*c.p.stiffness, *(c.p.contact[0],) * 2), (*now.stiff, *deflection), strict=True)
        return _Observations(
            normal_force=normal,
            friction_force_magnitude=friction if c.p.sticks else c.p.friction_at(speed),
            sliding_speed=now.speed,
            friction_energy=s.friction_heat,
            potential_energy=sum(0.5 * k * q * q for k, q in stored),
            dissipated_energy=s.friction_heat + s.damping_heat,
            numerical_dissipation=s.numerical,
        )

    def powers(self, c: _Constants, s: _State, u: Inputs[Impulse]) -> Sequence[float]:
        """Heat (W) of friction and of damping."""
        now = self._now(s, u)
        damping = sum(d * w * w for d, w in zip(c.p.damping, now.rates, strict=True))
        _, heat = _instant_friction(c.p, _deflection_now(c.p, s, now), now.velocity)
        return heat, damping

    def follow(self, c: _Constants, s: _State, u: Inputs[Impulse], at_event: bool) -> _State:
        """Follow the trolley, with its turn and the deflection of friction."""
        now = self._now(s, u)
        return s._replace(
            offset=now.pose.offset,
            turn=(now.stiff[1], s.turn[1], s.turn[2]),
            deflection=_deflection_now(c.p, s, now),
        )

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Axes of the plane, normal first, and mode."""
        return {**super().native_data(), "axis_frame": self._axes}


class _Friction(NamedTuple):
    """Mean friction over a step in the plane's axes, its slope, its heat (J), and the deflection at the end."""

    force: Two
    slope: Two
    heat: float
    deflection: Two


def _smooth_friction(p: _Parameters, slid: Two, bent: Two, h: float) -> _Friction:
    """Of what the trolley slid and of the moment of its velocity, at both points of Gauss' rule."""
    rates_y, rates_z = (gauss_rates(change, moment, h) for change, moment in zip(slid, bent, strict=True))
    before, after = (p.friction(velocity) for velocity in zip(rates_y, rates_z, strict=True))
    y = viscous_load(rates_y, (before[0], after[0]), h)
    z = viscous_load(rates_z, (before[1], after[1]), h)
    return _Friction((y.force, z.force), (y.slope, z.slope), y.heat + z.heat, _NONE)


def _sticking_friction(p: _Parameters, start: Two, slid: Two, bent: Two, h: float) -> _Friction:
    """The same of friction that sticks, from a deflection on."""
    stiffness, damping = p.contact
    friction = _slipping_friction(p, start, slid, bent, h)
    if friction is None:
        y, z = (
            _with_damper(damping / h, _relaxing(stiffness, 0.0, *one), *one[1:])
            for one in zip(start, slid, bent, strict=True)
        )
        friction = _Friction(
            (y.force, z.force), (y.slope, z.slope), y.heat + z.heat, (y.deflection, z.deflection)
        )
    deflection = _within(friction.deflection, p.breakaway_deflection)
    lost = sum(a * a - b * b for a, b in zip(friction.deflection, deflection, strict=True))
    return friction._replace(heat=friction.heat + 0.5 * stiffness * lost, deflection=deflection)


def _slipping_friction(p: _Parameters, start: Two, slid: Two, bent: Two, h: float) -> _Friction | None:
    """Along the directions of most and of least motion; None where the trolley sticks, as it does in any two.

    Across, damping is no more than twice the friction, which it may be while the trolley sticks.
    """
    (stiffness, damping), limit = p.contact, p.breakaway_deflection
    if sum(map(abs, (*slid, *bent))) < _STILL * limit:
        return None
    axis = _main_axis(slid, bent)
    (z, z_across), (change, aside), (moment, turn) = (_turned(vector, axis) for vector in (start, slid, bent))
    way = max(_length(z + change, z_across + aside) / limit - 1.0, 0.0)
    across = _relaxing(stiffness, way, z_across, aside, turn)
    before, after = (
        sqrt(max(p.friction_force**2 - (across.force + at * across.slope) ** 2, 0.0))
        for at in (-sqrt(1.0 / 3.0), sqrt(1.0 / 3.0))
    )
    friction = 0.5 * (before + after), 0.5 * sqrt(3.0) * (after - before)
    if way == 0.0 and _holds(stiffness, damping / h, friction, z, change, moment):
        return None
    fastest = _length(_length(change, aside), 3.0 * _length(moment, turn))
    felt = min(damping / h, 2.0 * p.friction_force / fastest) * exp(-way)
    along, across = (
        step_force(stiffness, damping, friction[0], z, change, h, moment=moment, friction_slope=friction[1]),
        _with_damper(felt, across, aside, turn),
    )
    force, slope, deflection = (
        _turned(vector, (axis[0], -axis[1]))
        for vector in (
            (along.force, across.force),
            (along.slope, across.slope),
            (along.deflection, across.deflection),
        )
    )
    return _Friction(force, slope, along.heat + across.heat, deflection)


def _main_axis(slid: Two, bent: Two) -> Two:
    """Direction of most motion: between it and the one across, the mean of v v^T over a step has no part."""
    (slid_y, slid_z), (bent_y, bent_z) = slid, bent
    difference = slid_y * slid_y - slid_z * slid_z + 3.0 * (bent_y * bent_y - bent_z * bent_z)
    angle = 0.5 * atan2(2.0 * (slid_y * slid_z + 3.0 * bent_y * bent_z), difference)
    return cos(angle), sin(angle)


def _turned(vector: Two, axis: Two) -> Two:
    """Components along an axis of the plane and across it."""
    return axis[0] * vector[0] + axis[1] * vector[1], axis[0] * vector[1] - axis[1] * vector[0]


def _relaxing(stiffness: float, way: float, start: float, change: float, moment: float) -> Presliding:
    """Of a spring whose deflection relaxes, z' = v - way z per step."""
    left, *r = _exponentials(way)
    begin, bend = change - 3.0 * moment, 6.0 * moment
    end = start * left + begin * r[0] + bend * r[1]
    mean = start * r[0] + begin * r[1] + bend * r[2]
    first = 3.0 * mean - 6.0 * (start * r[1] + begin * r[2] + bend * r[3])
    lost = mean * change + first * moment - 0.5 * (end - start) * (end + start)
    return Presliding(-stiffness * mean, stiffness * lost, end, -stiffness * first)


def _with_damper(damping: float, load: Presliding, change: float, moment: float) -> Presliding:
    """With a damper; damping over the step size."""
    return load._replace(
        force=load.force - damping * change,
        heat=load.heat + damping * (change * change + 3.0 * moment * moment),
        slope=load.slope - 3.0 * damping * moment,
    )


def _exponentials(a: float) -> list[float]:
    """Integrals over x from 0 to 1 of e^-ax times (1 - x)^n / n!, n from 0 to 3, after e^-a."""
    if a < 1.0:
        last = 1.0
        for j in range(20, 4, -1):
            last = 1.0 - a * last / j
        integrals = [last / 24.0]
        for term in _TERMS[::-1]:
            integrals.append(term - a * integrals[-1])
        return integrals[::-1]
    integrals = [exp(-a)]
    for term in _TERMS:
        integrals.append((term - integrals[-1]) / a)
    return integrals


def _holds(
    stiffness: float, damping: float, friction: Two, start: float, change: float, moment: float
) -> bool:
    """Whether spring and damper stay within a friction of mean and slope; damping over the step size.

    Their forces are parabolas in time, which stay within the ends and where the tangents there meet.
    """
    mean, slope = friction
    begin = change - 3.0 * moment
    return all(
        abs(stiffness * z) <= most and abs(stiffness * z + damping * v) <= most
        for z, v, most in (
            (start, begin, mean - slope),
            (start + 0.5 * begin, change, mean),
            (start + change, change + 3.0 * moment, mean + slope),
        )
    )


def _within(vector: Two, limit: float) -> Two:
    """A vector, at most the limit in length."""
    length = _length(*vector)
    if length <= limit:
        return vector
    return vector[0] * (limit / length), vector[1] * (limit / length)


def _moved(p: _Parameters, deflection: Two, slid: Two) -> Two:
    """Deflection that a motion moves, no further than where friction breaks away."""
    if not p.sticks:
        return _NONE
    return _within((deflection[0] + slid[0], deflection[1] + slid[1]), p.breakaway_deflection)


def _deflection_now(p: _Parameters, s: _State, now: _Instant) -> Two:
    """Deflection at an instant."""
    _, y, z = subtract(now.pose.offset, s.offset)
    return _moved(p, s.deflection, (y, z))


def _instant_friction(p: _Parameters, deflection: Two, velocity: Two) -> tuple[Two, float]:
    """Friction of one instant in the plane's axes, and its heat as power (W)."""
    if not p.sticks:
        speed = _length(*velocity)
        return p.friction(velocity), p.friction_at(speed) * speed
    (stiffness, damping), (z_y, z_z), (v_y, v_z) = p.contact, deflection, velocity
    against_y, against_z = _within(
        (stiffness * z_y + damping * v_y, stiffness * z_z + damping * v_z), p.friction_force
    )
    stored = stiffness * (z_y * v_y + z_z * v_z)
    if stored > 0.0 and _length(z_y, z_z) >= _AT_LIMIT * p.breakaway_deflection:
        stored = 0.0
    return (-against_y, -against_z), against_y * v_y + against_z * v_z - stored


def _moments(now: _Instant, trolley: PortMoments, swing: Two) -> tuple[Two, Four]:
    """First moments of the sliding velocity, and of the rates of the stiff coordinates."""
    still = Passage(now.pose.frame, now.pose.frame, now.pose.gap, now.pose.gap)
    moments = still.rate_moments((PortMoments(_AT_REST, _AT_REST), trolley), swing)
    return moments.offset[1:], (moments.offset[0], moments.twist, *moments.swing)


def _length(y: float, z: float) -> float:
    return sqrt(y * y + z * z)


def _wrench(now: _Instant, load: Sequence[float], friction: Two, swing: Two) -> tuple[float, ...]:
    """Of the loads of the stiff coordinates and of friction, world axes."""
    normal, twist, bending_y, bending_z = load
    torque = conjugate_torque(twist, (bending_y, bending_z), swing)
    return (*rotate(now.pose.frame, (normal, *friction)), *rotate(now.pose.frame, torque))
