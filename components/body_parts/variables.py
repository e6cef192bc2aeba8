"""The variables of a body beside its ports: declared once, with unit, range, start value and meaning."""

from __future__ import annotations

from dataclasses import replace

from ..contract.component import Quantity, Vector
from ..contract.roles import DISSIPATED_ENERGY, KINETIC_ENERGY, POTENTIAL_ENERGY

_MODAL = Quantity("modal_coordinate", "kg(1/2).m", "Modal coordinates, mass-normalised", resized=True)


def parameters(modes: int) -> list[Quantity]:
    """Start motion, fixed; gravity, damping and mode of solution, tunable. Bodies with modes may start bent."""
    found = [
        Quantity(
            "initial_position",
            "m",
            "Start position of the construction frame, world axes",
            3,
            variability="fixed",
        ),
        Quantity(
            "initial_orientation",
            "1",
            "Start quaternion of the body",
            4,
            (1.0, 0.0, 0.0, 0.0),
            variability="fixed",
        ),
        Quantity("initial_velocity", "m/s", "Start velocity of the centre of mass", 3, variability="fixed"),
        Quantity(
            "initial_angular_velocity", "rad/s", "Start angular velocity, world axes", 3, variability="fixed"
        ),
        Quantity("gravity", "m/s2", "Gravitational acceleration, world axes", 3, variability="tunable"),
        Quantity(
            "damping_scale",
            "1",
            "Factor on every modal damping ratio",
            start=1.0,
            minimum=0.0,
            variability="tunable",
        ),
    ]
    if modes:
        bent = _MODAL.called("initial_modal_coordinate", modes).saying(
            "Start values of the modal coordinates"
        )
        found.append(replace(bent, variability="fixed"))
    return found


def observations(modes: int) -> list[Quantity]:
    """What is recorded of a body with this number of modes."""
    found = [
        Quantity("frame_position", "m", "Position of the construction frame, world axes", 3),
        Quantity(
            "frame_orientation", "1", "Quaternion, body to world axes, scalar first", 4, (1.0, 0.0, 0.0, 0.0)
        ),
        Quantity("linear_momentum", "N.s", "Linear momentum, world axes", 3),
        Quantity("angular_momentum", "N.m.s", "Angular momentum about the world origin, world axes", 3),
        KINETIC_ENERGY,
        POTENTIAL_ENERGY.saying("Strain energy and energy in gravity"),
        DISSIPATED_ENERGY.saying("Energy dissipated by modal damping since the start"),
    ]
    if modes:
        found.append(_MODAL.sized(modes))
    return found


def states(frequency: Vector, ports: int) -> list[Quantity]:
    """The state of a body whose modes have these frequencies (rad/s); modes of a joule each are typical.

    All is continuous but the angular velocity, which follows from the momenta, and the moments of the last step.
    """
    return [
        _state("position", "m", "Position of the centre of mass, world axes", 3, "m/s"),
        _state("orientation", "1", "Quaternion of the body as integrated", 4, "1/s"),
        _state("momentum", "N.s", "Linear momentum, world axes", 3, "N"),
        _state("spin", "N.m.s", "Angular momentum about the centre of mass, world axes", 3, "N.m"),
        _state("angular_velocity", "rad/s", "Angular velocity, body axes", 3, ""),
        replace(_state("heat", "J", "Energy dissipated by modal damping", 1, "W"), quadrature=True),
        _of_modes("modal_amplitude", "kg(1/2).m", "Modal coordinates", "kg(1/2).m/s", tuple(1.0 / frequency)),
        _of_modes("modal_momentum", "kg(1/2).m/s", "Modal momenta", "kg(1/2).m/s2", (1.0,) * frequency.size),
        replace(
            _state("moments", "m", "First moments of the ports' motion (m, rad)", 6 * ports, ""), resized=True
        ),
    ]


def _state(name: str, unit: str, text: str, size: int, rate_unit: str) -> Quantity:
    return Quantity(name, unit, text, size, rate_unit=rate_unit)


def _of_modes(name: str, unit: str, text: str, rate_unit: str, nominal: tuple[float, ...]) -> Quantity:
    return replace(_state(name, unit, text, len(nominal), rate_unit), nominal=nominal, resized=True)
