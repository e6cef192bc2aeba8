"""Loads of a hinge: means over a step, of an impulse, and of one instant; and the energy it stores."""

from __future__ import annotations

from math import sqrt

from ..contract.frames import Quaternion, Vector3, rotate
from ..numerics.fourth_order_correction import stiff_load, workless_law
from ..numerics.laws import Law, mean_force, share_beyond
from ..numerics.presliding import Presliding
from ..numerics.relative_motion import conjugate_torque
from ..numerics.stiff_coordinate import MeanLoad, StepMotion, damped_load
from .friction import instant_friction, step_friction
from .state import Constants, Held, Loads, StiffLoads, from_aligned, mean_swing, shifted
from .variables import State

NO_LOAD = Loads((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, Presliding(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0)
"""Of a joint that has failed."""


def stiff_loads(c: Constants, old: State, motions: list[StepMotion]) -> StiffLoads:
    """Mean loads of bushing and latch."""
    aligned = [*motions[:3], shifted(motions[3], c.p.aligned_angle), *motions[4:]]
    each = zip(c.stiffness, c.damping, aligned, strict=True)
    bushing = [stiff_load(stiffness, damping, m, is_paired=c.paired) for stiffness, damping, m in each]
    for clearance in c.clearances:
        loads = clearance.loads(aligned, is_paired=c.paired)
        for i, load in zip(clearance.members, loads, strict=True):
            bushing[i] = load
    return StiffLoads(tuple(bushing), mean_latch_load(c, old, motions[3]))


def mean_loads(c: Constants, old: State, new: State, motions: list[StepMotion], loads: StiffLoads) -> Loads:
    """Mean loads over a step from both its ends (discrete gradients and mean rates), and their slopes of order 4."""
    stiff, latch = loads
    elastic, slope = [load.force for load in stiff], [load.slope for load in stiff]
    force_on_b = (elastic[0], elastic[1], elastic[2])
    change = new.angle - old.angle
    friction = step_friction(c, old, stiff, motions[3])
    numerical = sum(load.numerical for load in stiff) + latch.numerical
    heat = (friction.heat, latch.heat, sum(load.heat for load in stiff))
    motor, harness = _drive_load(c, c.motor, motions[3]), _drive_load(c, c.harness, motions[3])
    twist = elastic[3] + motor.force + harness.force + friction.force + latch.force
    if old.holding:
        twist -= c.p.hold_stiffness * (new.angle - old.hold_angle)
        numerical += 0.5 * c.p.hold_stiffness * change * change
    swing, rest = mean_swing(old, new), twist - elastic[3] - latch.force
    torque = conjugate_torque(twist, (elastic[4], elastic[5]), swing)
    if not c.paired:
        return Loads(force_on_b, torque, latch.force, friction, heat, numerical)
    twist = slope[3] + motor.slope + harness.slope + friction.slope + latch.slope
    slopes = (slope[0], slope[1], slope[2]), conjugate_torque(twist, (slope[4], slope[5]), swing)
    driving = rest, motor.slope + harness.slope + friction.slope
    return Loads(force_on_b, torque, latch.force, friction, heat, numerical, *slopes, driving)


def _drive_load(c: Constants, law: Law, motion: StepMotion) -> MeanLoad:
    """Load of a law that drives or brakes the hinge angle, too soft to need numerical damping."""
    if c.paired:
        return workless_law(law, 0.0, motion)
    return MeanLoad(mean_force(law, motion.start, motion.end), 0.0, 0.0)


def mean_latch_load(c: Constants, old: State, motion: StepMotion) -> MeanLoad:
    """Mean latch torque, its heat, and what the scheme took away."""
    if not old.latched or not c.latches:
        return MeanLoad(0.0, 0.0, 0.0)
    deflection = shifted(motion, old.latched_angle)
    damping = c.latch_damping * share_beyond(c.play, deflection.start, deflection.end)
    if c.paired:
        return workless_law(c.latch, damping, deflection, motion.memory.roughness)
    elastic = mean_force(c.latch, deflection.start, deflection.end)
    return damped_load(elastic, c.latch_stiffness, damping, deflection)


def _latch_damping(c: Constants, s: State) -> float:
    """Damping of the latch at an instant: none within its play."""
    deflection = s.angle - s.latched_angle
    return c.latch_damping * share_beyond(c.play, deflection, deflection)


def impulse_loads(c: Constants, old: State, new: State, h: float) -> Loads:
    """Loads that remove the relative rate in every stiff direction at the end of a vanishing step.

    An ideal joint transmits a latch impulse through its constrained directions in no time; a bushing
    would only do so after ringing at its own frequency. The heat is that of the latch; what other directions
    lose is due to the joint taken for ideal.
    """
    locked = old.latched > 0.5 and c.locks
    stiff = [k > 0.0 for k in c.stiffness]
    load = [
        -(c.p.lock_mass if i < 3 else c.p.lock_inertia) / h * new.rates[i]
        if stiff[i] or (i == 3 and locked)
        else 0.0
        for i in range(6)
    ]
    work = [-f * (b - a) for f, a, b in zip(load, old.coordinates, new.coordinates, strict=True)]
    latch = work[3] if locked else 0.0
    return Loads(
        (load[0], load[1], load[2]),
        conjugate_torque(load[3], (load[4], load[5]), mean_swing(old, new)),
        load[3] if locked else 0.0,
        Presliding(0.0, 0.0, old.presliding),
        (0.0, latch, 0.0),
        sum(work) - latch,
    )


def held_at(c: Constants, s: State) -> Held:
    """What bushing and latch exert at one instant, by their laws from coordinates and rates."""
    q, w, latch = from_aligned(c, s.coordinates), s.rates, 0.0
    if s.latched and c.latches:
        latch = c.latch.value(s.angle - s.latched_angle) + -_latch_damping(c, s) * w[3]
    bushing = [-c.stiffness[i] * q[i] - c.damping[i] * w[i] for i in range(6)]
    for clearance in c.clearances:
        for i, force in zip(clearance.members, clearance.force(q, w), strict=True):
            bushing[i] = force
    return Held(tuple(bushing), latch)


def recorded(c: Constants, s: State) -> Held:
    """What bushing and latch exert at a communication point of order 4, from what they did over the last steps."""
    at_end, (*bushing, latch, _) = held_at(c, s), s.loads
    by_coordinate = zip(bushing, at_end.bushing, s.memories, strict=True)
    return Held(
        tuple(load.load_now(law, memory.roughness) for load, law, memory in by_coordinate),
        latch.load_now(at_end.latch, s.memories[3].roughness),
    )


def lagged_loads(s: State, axis_on_port: Quaternion) -> tuple[float, float, float, Vector3, Vector3]:
    """Latch torque, axial and radial force, and both vectors, at the communication point before the last step.

    Of order 4; vectors are in the axes of the inboard port. How the swing changed in the step is nothing beside 1.
    """
    x, y, z, twist, swing_y, swing_z, latch, rest = (load.before() for load in s.loads)
    torque = conjugate_torque(twist + latch + rest, (swing_y, swing_z), s.swing)
    return latch, x, sqrt(y * y + z * z), rotate(axis_on_port, (x, y, z)), rotate(axis_on_port, torque)


def endpoint_loads(c: Constants, s: State) -> Loads:
    """Loads of one instant from coordinates and rates; heat as power (W)."""
    return instant_loads(c, s, held_at(c, s))


def instant_loads(c: Constants, s: State, held: Held) -> Loads:
    """Loads of one instant; heat as power (W)."""
    load, latch = held
    q, w, rate = s.coordinates, s.rates, s.rates[3]
    force = (load[0], load[1], load[2])
    friction = instant_friction(c, s, force, (load[4], load[5]))
    viscous = -_latch_damping(c, s) * rate if s.latched and c.latches else 0.0
    twist = load[3] + c.motor.value(s.angle) + c.harness.value(s.angle) + friction.force + latch
    if s.holding:
        twist -= c.p.hold_stiffness * (s.angle - s.hold_angle)
    damping = sum(d * v * v for d, v in zip(c.damping, w, strict=True))
    if c.clearances:
        aligned = from_aligned(c, q)
        damping += sum(clearance.heat(aligned, w) for clearance in c.clearances)
    return Loads(
        force,
        conjugate_torque(twist, (load[4], load[5]), (q[4], q[5])),
        latch,
        friction,
        (friction.heat, -viscous * rate, damping),
        0.0,
    )


def stored_energy(c: Constants, s: State) -> float:
    """Energy in bushing, motor, harness, latch, friction that sticks and hold."""
    return held_energy(c, s) + driving_energy(c, s.angle)


def driving_energy(c: Constants, angle: float) -> float:
    """Energy of motor and harness, zero at an arbitrary angle of tables and of a constant torque."""
    return c.motor.potential(angle) + c.harness.potential(angle)


def held_energy(c: Constants, s: State) -> float:
    """Energy in bushing, latch, friction that sticks and hold, which is lost where the joint fails; not negative."""
    q = from_aligned(c, s.coordinates)
    energy = sum(0.5 * k * v * v for k, v in zip(c.stiffness, q, strict=True))
    energy += sum(clearance.potential(q) for clearance in c.clearances)
    energy += latch_energy(c, s)
    energy += 0.5 * c.p.presliding_stiffness * s.presliding * s.presliding
    if s.holding:
        energy += 0.5 * c.p.hold_stiffness * (s.angle - s.hold_angle) ** 2
    return energy


def latch_energy(c: Constants, s: State) -> float:
    """Energy in the latch, which is lost where it lets go."""
    if not s.latched or not c.latches:
        return 0.0
    return c.latch.potential(s.angle - s.latched_angle) - c.latch.potential(0.0)
