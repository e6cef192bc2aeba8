"""Friction of a hinge: pin and constant friction and the hysteresis of its laws, sticking or smooth at rest."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import NamedTuple

from ..contract.frames import Vector3
from ..numerics.fourth_order_correction import gauss_rates, viscous_load
from ..numerics.laws import static_factor, stiction_factors
from ..numerics.presliding import Presliding, instant_force, step_force, within
from ..numerics.stiff_coordinate import MeanLoad, StepMotion
from .state import Constants
from .variables import State

FORCE_SMOOTHING = 1e-2
"""N, below which the friction of pins falls with the square of the load, so that it has a derivative at no load."""


class _Magnitudes(NamedTuple):
    """Friction (N.m) that is static or dynamic, and friction that is the same at any rate."""

    of_pin: float
    constant: float


def _magnitudes(
    c: Constants, latched: bool, force: Vector3, bending: tuple[float, float], angle: float
) -> _Magnitudes:
    """Coulomb torque mu r_p F_r, and T_pre (Bagnoli 2007, eq 2.2) with half the width of the hysteresis."""
    square = force[1] * force[1] + force[2] * force[2]
    normal = square / sqrt(square + FORCE_SMOOTHING**2)
    if c.p.friction_bending_arm > 0.0:
        normal += sqrt(bending[0] * bending[0] + bending[1] * bending[1]) / c.p.friction_bending_arm
    constant = 0.0 if latched else c.p.friction_preload
    return _Magnitudes(
        c.p.friction_coefficient * c.p.pin_radius * normal, constant + max(c.hysteresis.value(angle), 0.0)
    )


def _smooth(c: Constants, found: _Magnitudes, rate: float) -> float:
    """Torque against a sliding rate."""
    of_pin, constant = stiction_factors(rate, c.p.stiction_velocity, c.p.static_friction_ratio)
    return -(found.of_pin * of_pin + found.constant * constant)


def _largest(c: Constants, found: _Magnitudes, rate: float) -> float:
    """Torque that friction does not exceed at a rate."""
    factor = static_factor(rate, c.p.stiction_velocity, c.p.static_friction_ratio)
    return found.of_pin * factor + found.constant


def step_friction(c: Constants, old: State, bushing: Sequence[MeanLoad], turn: StepMotion) -> Presliding:
    """Mean torque over a step, positive opening, with its slope.

    Friction is that at both points of Gauss' rule, along lines of the bushing's loads and of the rate.
    """
    change, moment = turn.end - turn.start, turn.moment if c.paired else 0.0
    angle, place = 0.5 * (turn.start + turn.end), sqrt(1.0 / 3.0)
    rates = gauss_rates(change, moment, turn.h)
    before, after = (
        _pressed(c, old, [load.force + at * load.slope for load in bushing], angle) for at in (-place, place)
    )
    if c.p.presliding_stiffness == 0.0:
        smooth = viscous_load(rates, (_smooth(c, before, rates[0]), _smooth(c, after, rates[1])), turn.h)
        return Presliding(smooth.force, smooth.heat, 0.0, smooth.slope)
    if old.holding:
        return _taking_over(c, after, turn.end - old.hold_angle)
    most = _largest(c, before, rates[0]), _largest(c, after, rates[1])
    return step_force(
        c.p.presliding_stiffness,
        c.p.presliding_damping,
        0.5 * (most[0] + most[1]),
        old.presliding,
        change,
        turn.h,
        moment=moment,
        friction_slope=0.5 * sqrt(3.0) * (most[1] - most[0]),
    )


def _pressed(c: Constants, old: State, load: Sequence[float], angle: float) -> _Magnitudes:
    """By loads of the bushing in the six coordinates."""
    return _magnitudes(c, old.latched > 0.5, (load[0], load[1], load[2]), (load[4], load[5]), angle)


def _taking_over(c: Constants, found: _Magnitudes, held: float) -> Presliding:
    """No torque while the angle is held, but the deflection with which friction then takes over what it can."""
    most = _largest(c, found, 0.0)
    return Presliding(0.0, 0.0, within(c.p.hold_stiffness * held, most) / c.p.presliding_stiffness)


def instant_friction(c: Constants, s: State, force: Vector3, bending: tuple[float, float]) -> Presliding:
    """Torque of one instant; heat as power (W)."""
    found = _magnitudes(c, s.latched > 0.5, force, bending, s.angle)
    if c.p.presliding_stiffness == 0.0:
        torque = _smooth(c, found, s.rate)
        return Presliding(torque, -torque * s.rate, 0.0)
    if s.holding:
        return _taking_over(c, found, s.angle - s.hold_angle)
    most = _largest(c, found, s.rate)
    return instant_force(c.p.presliding_stiffness, c.p.presliding_damping, most, s.presliding, s.rate)


def friction_limit(c: Constants, s: State, bushing: Sequence[float]) -> float:
    """Torque (N.m) that friction does not exceed at rest, under loads of the bushing in the six coordinates."""
    return _largest(c, _pressed(c, s, bushing, s.angle), 0.0)


def starting_deflection(c: Constants, angle: float) -> float:
    """Deflection with which friction that sticks holds what motor, harness and joint do at an angle, as far as it can.

    Of the friction, what is there without loads on the pin.
    """
    if c.p.presliding_stiffness == 0.0:
        return 0.0
    none = (0.0, 0.0, 0.0)
    most = _largest(c, _magnitudes(c, False, none, (0.0, 0.0), angle), 0.0)
    turned = angle - c.p.aligned_angle
    driving = c.motor.value(angle) + c.harness.value(angle) - c.stiffness[3] * turned
    at_rest, turn = (0.0,) * 6, (0.0, 0.0, 0.0, turned, 0.0, 0.0)
    driving += sum(one.force(turn, at_rest)[0] for one in c.clearances if 3 in one.members)
    return within(driving, most) / c.p.presliding_stiffness
