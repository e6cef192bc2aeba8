"""Loads of a hinge: means over a step, of an impulse, and of one instant; and the energy it stores."""

from __future__ import annotations

from math import sqrt

from ..contract.frames import Vector3
from ..numerics.laws import mean_force, stiction_factors
from ..numerics.relative_motion import conjugate_torque
from ..numerics.stiff_coordinate import MeanLoad, StepMotion, bushing_load, damped_load
from .state import Constants, Loads, State, mean_swing, shifted

_FORCE_SMOOTHING = 1.0


def mean_loads(c: Constants, old: State, new: State, motions: list[StepMotion], h: float) -> Loads:
    """Mean loads over a step from both its ends (discrete gradients and mean rates)."""
    stiff = [
        bushing_load(
            c.stiffness[i],
            c.damping[i],
            shifted(motion, c.aligned_angle) if i == 3 else motion,
            c.end_weight,
        )
        for i, motion in enumerate(motions)
    ]
    elastic = [load.force for load in stiff]
    force_on_b = (elastic[0], elastic[1], elastic[2])
    change = new.angle - old.angle
    friction = friction_torque(c, old.latched > 0.5, force_on_b, (elastic[4], elastic[5]), change / h)
    latch = mean_latch_load(c, old, motions[3])
    numerical = sum(load.numerical for load in stiff) + latch.numerical
    twist = (
        elastic[3]
        + mean_force(c.motor, old.angle, new.angle, c.end_weight)
        + mean_force(c.harness, old.angle, new.angle, c.end_weight)
        + friction
        + latch.force
    )
    if old.holding:
        twist -= c.hold_stiffness * (new.angle - old.hold_angle)
        numerical += 0.5 * c.hold_stiffness * change * change
    return Loads(
        force_on_b,
        conjugate_torque(twist, (elastic[4], elastic[5]), mean_swing(old, new)),
        latch.force,
        friction,
        (-friction * change, latch.heat, sum(load.heat for load in stiff)),
        numerical,
    )


def friction_torque(
    c: Constants, latched: bool, force: Vector3, bending: tuple[float, float], rate: float
) -> float:
    """Coulomb torque mu r_p F_r + T_pre against the sliding rate (Bagnoli 2007, eq 2.2)."""
    preload = 0.0 if latched else c.friction_preload
    square = force[1] * force[1] + force[2] * force[2]
    normal = square / sqrt(square + _FORCE_SMOOTHING**2)
    if c.bending_arm > 0.0:
        normal += sqrt(bending[0] * bending[0] + bending[1] * bending[1]) / c.bending_arm
    sliding, constant = stiction_factors(rate, c.stiction_velocity, c.static_ratio)
    return -(c.friction * c.pin_radius * normal * sliding + preload * constant)


def mean_latch_load(c: Constants, old: State, motion: StepMotion) -> MeanLoad:
    """Mean latch torque, its heat, and what its inertial terms took away."""
    if not old.latched or not c.latches:
        return MeanLoad(0.0, 0.0, 0.0)
    deflection = shifted(motion, old.latched_angle)
    elastic = mean_force(c.latch, deflection.start, deflection.end)
    return damped_load(elastic, c.latch_stiffness, c.latch_damping, deflection, c.end_weight)


def impulse_loads(c: Constants, old: State, new: State, h: float) -> Loads:
    """Loads that remove the relative rate in every stiff direction at the end of a vanishing step.

    An ideal joint transmits a latch impulse through its constrained directions in no time; a bushing
    would only do so after ringing at its own frequency. The heat is that of the latch; what other directions
    lose is due to the joint taken for ideal.
    """
    locked = old.latched > 0.5 and c.locks
    stiff = [k > 0.0 for k in c.stiffness]
    load = [
        -(c.lock_mass if i < 3 else c.lock_inertia) / h * new.rates[i]
        if stiff[i] or (i == 3 and locked)
        else 0.0
        for i in range(6)
    ]
    work = [-f * (b - a) for f, a, b in zip(load, old.coordinates, new.coordinates, strict=True)]
    latch = work[3] if locked else 0.0
    return Loads(
        (load[0], load[1], load[2]),
        conjugate_torque(load[3], (load[4], load[5]), mean_swing(old, new)),
        0.0,
        0.0,
        (0.0, latch, 0.0),
        sum(work) - latch,
    )


def endpoint_loads(c: Constants, s: State) -> Loads:
    """Loads of one instant from coordinates and rates; heat as power (W)."""
    q, w = list(s.coordinates), s.rates
    q[3] -= c.aligned_angle
    load = [-c.stiffness[i] * q[i] - c.damping[i] * w[i] for i in range(6)]
    force = (load[0], load[1], load[2])
    friction = friction_torque(c, s.latched > 0.5, force, (load[4], load[5]), w[3])
    latch = viscous = 0.0
    if s.latched and c.latches:
        viscous = -c.latch_damping * w[3]
        latch = c.latch.value(s.angle - s.latched_angle) + viscous
    twist = load[3] + c.motor.value(s.angle) + c.harness.value(s.angle) + friction + latch
    if s.holding:
        twist -= c.hold_stiffness * (s.angle - s.hold_angle)
    damping = sum(d * rate * rate for d, rate in zip(c.damping, w, strict=True))
    return Loads(
        force,
        conjugate_torque(twist, (load[4], load[5]), (q[4], q[5])),
        latch,
        friction,
        (-friction * w[3], -viscous * w[3], damping),
        0.0,
    )


def stored_energy(c: Constants, s: State) -> float:
    """Energy in bushing, motor, harness, latch and hold."""
    q = list(s.coordinates)
    q[3] -= c.aligned_angle
    energy = sum(0.5 * k * v * v for k, v in zip(c.stiffness, q, strict=True))
    energy += c.motor.potential(s.angle) + c.harness.potential(s.angle)
    if s.latched and c.latches:
        energy += c.latch.potential(s.angle - s.latched_angle) - c.latch.potential(0.0)
    if s.holding:
        energy += 0.5 * c.hold_stiffness * (s.angle - s.hold_angle) ** 2
    return energy
