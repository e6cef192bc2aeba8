"""The variables of a hinge: declared once, with unit, range, start value and meaning."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, NamedTuple

from ..contract.connection import NO_PAIR, SLOPES, WRENCH
from ..contract.frames import Quaternion, Vector3
from ..contract.quantity import Quantity
from ..contract.record import integrated, kept, observed, switched, tunable
from ..contract.roles import (
    DISSIPATED_ENERGY,
    DISSIPATION,
    FAILURE_COMMAND,
    HINGE_LOAD,
    HOLD,
    IMPULSE,
    LATCH_COMMAND,
    LATCH_DISTANCE,
    LATCHED,
    NUMERICAL_DISSIPATION,
    ORDER,
    POTENTIAL_ENERGY,
    UNLATCH_COMMAND,
    lagged,
)
from ..numerics.interval_mean import MidStep, MidStepSlope
from ..numerics.stiff_coordinate import Memory

Six = tuple[float, float, float, float, float, float]
NO_LOADS: tuple[MidStepSlope, ...] = (MidStepSlope.starting(0.0),) * 8
OUTPUTS = (LATCH_DISTANCE, LATCHED)
"""What a master watches, beside the wrenches on both ports."""

CLEARANCES = (
    ("axial_clearance", (0,)),
    ("radial_clearance", (1, 2)),
    ("twist_clearance", (3,)),
    ("cross_clearance", (4, 5)),
)
"""Clearances by name, with the coordinates that share each."""


class Parameters(NamedTuple):
    """All tunable but the order; stiffness and damping along and about the hinge line, then the two cross axes."""

    translational_stiffness: Annotated[
        Vector3, tunable("N/m", "Stiffness along hinge line and cross axes", 0.0, 0.0)
    ]
    translational_damping: Annotated[
        Vector3, tunable("N.s/m", "Damping along hinge line and cross axes", 0.0, 0.0)
    ]
    rotational_stiffness: Annotated[Vector3, tunable("N.m/rad", "Stiffness about the same axes", 0.0, 0.0)]
    rotational_damping: Annotated[Vector3, tunable("N.m.s/rad", "Damping about the same axes", 0.0, 0.0)]
    axial_clearance: Annotated[float, tunable("m", "Play either way along the hinge line", 0.0, 0.0)]
    radial_clearance: Annotated[float, tunable("m", "Play of the pin across the line, any way", 0.0, 0.0)]
    twist_clearance: Annotated[float, tunable("rad", "Play of the bushing either way about it", 0.0, 0.0)]
    cross_clearance: Annotated[float, tunable("rad", "Play about the cross axes, any way", 0.0, 0.0)]
    aligned_angle: Annotated[float, tunable("rad", "Hinge angle where the axes of both ports coincide")]
    stowed_angle: Annotated[float, tunable("rad", "Hinge angle of the stowed configuration")]
    motor_stiffness: Annotated[float, tunable("N.m/rad", "Rate of the motorisation spring", 0.0, 0.0)]
    motor_wind_up: Annotated[float, tunable("rad", "Hinge angle at which the motorisation spring is relaxed")]
    motor_constant_torque: Annotated[
        float, tunable("N.m", "Constant torque of the motor, in addition to the spring")
    ]
    friction_coefficient: Annotated[
        float, tunable("1", "Coulomb friction of the hinge pin, sliding", 0.0, 0.0)
    ]
    static_friction_ratio: Annotated[
        float, tunable("1", "Static over sliding friction coefficient", 1.2, 1.0)
    ]
    pin_radius: Annotated[float, tunable("m", "Radius of the hinge pin", 0.006, 0.0)]
    friction_bending_arm: Annotated[
        float, tunable("m", "Arm of bending moment to pin force; 0: none", 0.0, 0.0)
    ]
    friction_preload: Annotated[
        float, tunable("N.m", "Constant friction torque; 0 from latch-up on", 0.0, 0.0)
    ]
    presliding_stiffness: Annotated[
        float, tunable("N.m/rad", "Stiffness of friction that sticks; 0: a smooth transition", 0.0, 0.0)
    ]
    presliding_damping: Annotated[float, tunable("N.m.s/rad", "Damping of friction that sticks", 0.0, 0.0)]
    stiction_velocity: Annotated[
        float, tunable("rad/s", "Stiction transition velocity as a hinge rate", 0.0167, 1e-9)
    ]
    latch_angle: Annotated[float, tunable("rad", "Hinge angle where the latch engages")]
    latch_stiffness: Annotated[float, tunable("N.m/rad", "Stiffness of a spring latch", 0.0, 0.0)]
    latch_damping: Annotated[float, tunable("N.m.s/rad", "Damping of a spring or table latch", 0.0, 0.0)]
    latch_automatic: Annotated[float, switched("1: latch without command (endpoint mode)", 1.0)]
    lock_mass: Annotated[float, tunable("kg", "Numerical: mass of an ideal joint in impulses", 1e6, 1.0)]
    lock_inertia: Annotated[float, tunable("kg.m2", "Numerical: inertia of a lock in impulses", 1e6, 1.0)]
    lock_stiffness: Annotated[
        float, tunable("N.m/rad", "Stiffness of a kinematic latch, as good as rigid", 1e8, 1.0)
    ]
    lock_damping: Annotated[
        float,
        tunable("N.m.s/rad", "Damping of a kinematic latch, so that nothing light rings in it", 2e3, 0.0),
    ]
    hold_stiffness: Annotated[float, tunable("N.m/rad", "Stiffness that holds the angle on hold", 1e7, 0.0)]
    order: Annotated[float, ORDER]

    @property
    def stiffness(self) -> Six:
        """Of the six coordinates in order."""
        return (*self.translational_stiffness, *self.rotational_stiffness)

    @property
    def damping(self) -> Six:
        """The same of damping."""
        return (*self.translational_damping, *self.rotational_damping)


class Commands(NamedTuple):
    """Beside the motions of both ports."""

    latch_command: Annotated[float, LATCH_COMMAND]
    unlatch_command: Annotated[float, UNLATCH_COMMAND]
    impulse: Annotated[float, IMPULSE]
    hold: Annotated[float, HOLD.saying("1: the angle is held")]
    failure_command: Annotated[float, FAILURE_COMMAND]


class State(NamedTuple):
    """Six coordinates: offset x, y, z, hinge angle, swing y, z (hinge axes).

    Of order 4, `loads` are those of the bushing in the six coordinates, of the latch and of all else about the hinge
    line over the last steps, and `sliding` is the hinge rate, of which `slide` knows means only.
    """

    frame: Annotated[Quaternion, kept("1", "Hinge frame on the inboard port")]
    gap: Annotated[Vector3, kept("m", "From the inboard to the outboard port, world axes")]
    coordinates: Annotated[Six, kept("1", "The six coordinates (m, rad)")]
    rates: Annotated[Six, kept("1/s", "Their rates")]
    memories: Annotated[tuple[Memory, ...], kept("1/s", "What they remember of the last step").sized(6)]
    slide: Annotated[MidStep, kept("rad/s", "Mean hinge rates of two steps")]
    friction_heat: Annotated[float, integrated("J", "W", "Energy dissipated since the start")]
    latch_heat: Annotated[float, integrated("J", "W", "Energy dissipated since the start")]
    damping_heat: Annotated[float, integrated("J", "W", "Energy dissipated since the start")]
    hold_angle: Annotated[float, kept("rad", "Angle that is held")]
    presliding: Annotated[float, kept("rad", "Elastic deflection of friction that sticks")] = 0.0
    latched: Annotated[float, kept("1", "1 from latch-up on, until it is unlatched")] = 0.0
    opened: Annotated[float, kept("1", "1 while the latch is held open")] = 0.0
    latched_angle: Annotated[float, kept("rad", "Angle where the latch engaged")] = 0.0
    holding: Annotated[float, kept("1", "1 while the angle is held")] = 0.0
    numerical: Annotated[float, kept("J", "What the scheme took away")] = 0.0
    latch_impulse: Annotated[float, kept("N.m.s", "Angular impulse of a lock")] = 0.0
    failed: Annotated[float, kept("1", "1 from the failure on")] = 0.0
    failure_angle: Annotated[float, kept("rad", "Angle at the failure")] = 0.0
    failure_heat: Annotated[float, kept("J", "Elastic energy that the failure turned to heat")] = 0.0
    power: Annotated[Vector3, kept("W", "Of the three heats at the last end-point step")] = (0.0, 0.0, 0.0)
    wrench: Annotated[tuple[float, ...], WRENCH] = NO_PAIR
    slopes: Annotated[tuple[float, ...], SLOPES] = NO_PAIR
    loads: Annotated[tuple[MidStepSlope, ...], kept("1", "Loads over two steps (N, N.m)").sized(8)] = NO_LOADS
    sliding: Annotated[MidStepSlope, kept("rad/s", "The same of the rate, with slopes")] = (
        MidStepSlope.starting(0.0)
    )

    @property
    def angle(self) -> float:
        """Hinge angle, unwrapped."""
        return self.coordinates[3]

    @property
    def rate(self) -> float:
        """Hinge rate."""
        return self.rates[3]

    @property
    def swing(self) -> tuple[float, float]:
        """Tilt of the outboard hinge line."""
        *_, y, z = self.coordinates
        return y, z

    @property
    def heat(self) -> Vector3:
        """Of friction, latch and damping."""
        return self.friction_heat, self.latch_heat, self.damping_heat

    def heated(self, added: Vector3) -> State:
        """With more heat of friction, latch and damping."""
        friction, latch, damping = (a + b for a, b in zip(self.heat, added, strict=True))
        return self._replace(friction_heat=friction, latch_heat=latch, damping_heat=damping)

    def commanded(self, commands: Commands) -> State:
        """Latched or held at the angle where the command arrives; a latch that is held open holds nothing."""
        state, is_held = self._replace(opened=float(commands.unlatch_command > 0.5)), commands.hold > 0.5
        if state.opened:
            state = state._replace(latched=0.0)
        elif commands.latch_command > 0.5 and not state.latched:
            state = state._replace(latched=1.0, latched_angle=state.angle)
        if is_held and not state.holding:
            state = state._replace(hold_angle=state.angle)
        return state._replace(holding=float(is_held))


class Observations(NamedTuple):
    """What is recorded for people."""

    angle: Annotated[float, observed("rad", "Hinge angle, unwrapped")]
    angular_rate: Annotated[float, observed("rad/s", "Hinge rate, of the ports at this instant")]
    motor_torque: Annotated[float, observed("N.m", "Torque of the motorisation, positive opening")]
    harness_torque: Annotated[float, observed("N.m", "Torque of the harness, positive opening")]
    friction_torque: Annotated[float, observed("N.m", "Torque of friction and hysteresis, positive opening")]
    friction_limit: Annotated[float, observed("N.m", "Torque up to which friction holds the line at rest")]
    latch_torque: Annotated[float, observed("N.m", "Latch torque about the hinge line, positive opening")]
    axial_force: Annotated[float, observed("N", "Force on the outboard side along the hinge line")]
    radial_force: Annotated[float, observed("N", "Magnitude of the force normal to the hinge line")]
    bending_moment: Annotated[float, observed("N.m", "Magnitude of the moment normal to the hinge line")]
    hinge_force: Annotated[
        Vector3,
        observed(
            "N",
            "Force on the outboard body at the hinge, axes of the inboard port, where its body bends too",
            HINGE_LOAD,
        ),
    ]
    hinge_torque: Annotated[
        Vector3,
        observed(
            "N.m",
            "Torque on the outboard body about the hinge, axes of the inboard port, where its body bends too",
            HINGE_LOAD,
        ),
    ]
    motor_energy: Annotated[
        float,
        observed(
            "J", "Energy released since stowed by the motorisation as it is now; it jumps where one is set"
        ),
    ]
    friction_energy: Annotated[float, observed("J", "Energy dissipated by friction", DISSIPATION)]
    latch_energy: Annotated[
        float, observed("J", "Energy dissipated by the latch, its impulse included", DISSIPATION)
    ]
    damping_energy: Annotated[
        float, observed("J", "Energy dissipated by the damping of the joint", DISSIPATION)
    ]
    latch_impulse: Annotated[
        float,
        observed("N.m.s", "Angular impulse of a kinematic latch about the hinge line, positive opening"),
    ]
    failure_energy: Annotated[float, observed("J", "Energy held at the failure, as heat", DISSIPATION)]
    potential_energy: Annotated[
        float, POTENTIAL_ENERGY.saying("Energy of bushing, motor, harness, latch and friction that sticks")
    ]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]
    numerical_dissipation: Annotated[float, NUMERICAL_DISSIPATION]


def _again(quantity: Quantity) -> Quantity:
    """A load told once more, one step later, where it is a mean over steps."""
    return replace(lagged(quantity), resized=True)


class MeanObservations(NamedTuple):
    """With mean wrenches, the loads one step earlier as well."""

    now: Observations
    latch_torque_lagged: Annotated[float, _again(observed("N.m", "Latch torque").called("latch_torque"))]
    axial_force_lagged: Annotated[float, _again(observed("N", "Axial force").called("axial_force"))]
    radial_force_lagged: Annotated[float, _again(observed("N", "Radial force").called("radial_force"))]
    hinge_force_lagged: Annotated[Vector3, _again(observed("N", "Force").called("hinge_force"))]
    hinge_torque_lagged: Annotated[Vector3, _again(observed("N.m", "Torque").called("hinge_torque"))]
