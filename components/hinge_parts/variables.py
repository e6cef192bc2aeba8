"""The variables of a hinge: declared once, with unit, range, start value and meaning."""

from __future__ import annotations

from ..contract.component import Quantity, lagged
from ..numerics.relative_motion import numerical_dissipation, order_parameter


def parameters() -> list[Quantity]:
    """Parameters, all tunable but the order."""

    def tunable(
        name: str, unit: str, text: str, start: float = 0.0, minimum: float | None = 0.0, size: int = 1
    ) -> Quantity:
        return Quantity(name, unit, text, size, start, minimum, variability="tunable")

    return [
        tunable(
            "translational_stiffness",
            "N/m",
            "Stiffness along hinge line and the two radial directions",
            size=3,
        ),
        tunable(
            "translational_damping", "N.s/m", "Damping along hinge line and the two radial directions", size=3
        ),
        tunable(
            "rotational_stiffness", "N.m/rad", "Stiffness about hinge line and the two cross axes", size=3
        ),
        tunable("rotational_damping", "N.m.s/rad", "Damping about hinge line and the two cross axes", size=3),
        tunable("aligned_angle", "rad", "Hinge angle where the axes of both ports coincide", minimum=None),
        tunable("stowed_angle", "rad", "Hinge angle of the stowed configuration", minimum=None),
        tunable("motor_stiffness", "N.m/rad", "Rate of the motorisation spring"),
        tunable(
            "motor_wind_up", "rad", "Hinge angle at which the motorisation spring is relaxed", minimum=None
        ),
        tunable("friction_coefficient", "1", "Coulomb friction coefficient of the hinge pin, sliding"),
        tunable("static_friction_ratio", "1", "Static over sliding friction coefficient", 1.2, 1.0),
        tunable("pin_radius", "m", "Radius of the hinge pin", 0.006),
        tunable(
            "friction_bending_arm", "m", "Arm that turns bending moment into pin force; 0 switches it off"
        ),
        tunable("friction_preload", "N.m", "Constant friction torque; 0 from latch-up on"),
        tunable("stiction_velocity", "rad/s", "Stiction transition velocity as a hinge rate", 0.0167, 1e-9),
        tunable("latch_angle", "rad", "Hinge angle where the latch engages", minimum=None),
        tunable("latch_stiffness", "N.m/rad", "Stiffness of a spring latch"),
        tunable("latch_damping", "N.m.s/rad", "Damping of a spring or table latch"),
        tunable("latch_automatic", "1", "1: latch at the latch angle without command (endpoint mode)", 1.0),
        tunable(
            "lock_mass", "kg", "Numerical: mass that an ideal joint sets against residual velocity", 1e6, 1.0
        ),
        tunable(
            "lock_inertia", "kg.m2", "Numerical: inertia that a lock sets against residual rate", 1e6, 1.0
        ),
        tunable("lock_stiffness", "N.m/rad", "Stiffness of a kinematic latch, as good as rigid", 1e8, 1.0),
        tunable("hold_stiffness", "N.m/rad", "Stiffness that holds the angle while hold is 1", 1e7),
        Quantity("end_weight", "1", "Weight of the end value in mean wrenches", 1, 0.5, 0.5, 1.0, "tunable"),
        order_parameter(),
    ]


def inputs() -> list[Quantity]:
    """Commands, beside the motions of both ports."""
    return [
        Quantity(
            "latch_command", "1", "1: the latch engages at the start of the next step", variability="discrete"
        ),
        Quantity(
            "impulse", "1", "1: the next step is an impulse through ideal joints", variability="discrete"
        ),
        Quantity("hold", "1", "1: the angle is held", variability="discrete"),
    ]


def outputs() -> list[Quantity]:
    """What a master watches, beside the wrenches on both ports."""
    return [
        Quantity("latch_distance", "rad", "Latch angle minus hinge angle; falls through zero at latch-up"),
        Quantity("latched", "1", "1 from latch-up on"),
    ]


def observations(endpoint: bool) -> list[Quantity]:
    """What is recorded for people; loads that are means over steps are told once more, one step later."""
    found = _observations()
    loads = ("latch_torque", "axial_force", "radial_force")
    return found if endpoint else [*found, *(lagged(q) for q in found if q.name in loads)]


def _observations() -> list[Quantity]:
    return [
        Quantity("angle", "rad", "Hinge angle, unwrapped"),
        Quantity("angular_rate", "rad/s", "Hinge rate, of the ports at this instant"),
        Quantity("motor_torque", "N.m", "Torque of the motorisation spring, positive opening"),
        Quantity("harness_torque", "N.m", "Torque of the harness, positive opening"),
        Quantity("friction_torque", "N.m", "Friction torque, positive opening"),
        Quantity("latch_torque", "N.m", "Torque of the latch about the hinge line, positive opening"),
        Quantity("axial_force", "N", "Force on the outboard side along the hinge line"),
        Quantity("radial_force", "N", "Magnitude of the force normal to the hinge line"),
        Quantity("bending_moment", "N.m", "Magnitude of the moment normal to the hinge line"),
        Quantity("motor_energy", "J", "Energy released by the motorisation spring since the stowed angle"),
        Quantity("friction_energy", "J", "Energy dissipated by friction"),
        Quantity("latch_energy", "J", "Energy dissipated by the latch, its impulse included"),
        Quantity("damping_energy", "J", "Energy dissipated by the damping of the joint"),
        Quantity("potential_energy", "J", "Energy in bushing, motorisation spring, harness and latch"),
        Quantity("dissipated_energy", "J", "Energy dissipated since the start"),
        numerical_dissipation(),
    ]
