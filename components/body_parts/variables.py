"""The variables of a body beside its ports: declared once, with unit, range, start value and meaning."""

from __future__ import annotations

from numpy.typing import ArrayLike

from ..contract.component import ContinuousStates, Quantity, Vector


def parameters() -> list[Quantity]:
    """Start motion, fixed; gravity, damping and mode of solution, tunable."""
    return [
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
        Quantity(
            "quasi_static",
            "1",
            "1: steps seek static equilibrium instead of following time",
            minimum=0.0,
            maximum=1.0,
            variability="tunable",
        ),
    ]


def observations(modes: int) -> list[Quantity]:
    """What is recorded of a body with this number of modes."""
    found = [
        Quantity("frame_position", "m", "Position of the construction frame, world axes", 3),
        Quantity("frame_orientation", "1", "Quaternion of the body", 4, (1.0, 0.0, 0.0, 0.0)),
        Quantity("linear_momentum", "N.s", "Linear momentum, world axes", 3),
        Quantity("angular_momentum", "N.m.s", "Angular momentum about the world origin", 3),
        Quantity("kinetic_energy", "J", "Kinetic energy"),
        Quantity("potential_energy", "J", "Strain energy and energy in gravity"),
        Quantity("dissipated_energy", "J", "Energy dissipated by modal damping since the start"),
    ]
    if modes:
        found.append(Quantity("modal_coordinate", "kg(1/2).m", "Modal coordinates, mass-normalised", modes))
    return found


def continuous_states(frequency: Vector) -> ContinuousStates:
    """All states but the angular velocity, which follows from the momenta; modes of a joule each are typical."""
    modes = frequency.size
    states: list[tuple[Quantity, str, ArrayLike]] = [
        (Quantity("position", "m", "Position of the centre of mass, world axes", 3), "m/s", 1.0),
        (Quantity("orientation", "1", "Quaternion of the body as integrated", 4), "1/s", 1.0),
        (Quantity("momentum", "N.s", "Linear momentum, world axes", 3), "N", 1.0),
        (Quantity("spin", "N.m.s", "Angular momentum about the centre of mass, world axes", 3), "N.m", 1.0),
        (Quantity("heat", "J", "Energy dissipated by modal damping"), "W", 1.0),
    ]
    if modes:
        amplitude = Quantity("modal_amplitude", "kg(1/2).m", "Modal coordinates", modes)
        momentum = Quantity("modal_momentum", "kg(1/2).m/s", "Modal momenta", modes)
        states += [(amplitude, "kg(1/2).m/s", 1.0 / frequency), (momentum, "kg(1/2).m/s2", 1.0)]
    quantities, units, nominal = zip(*states, strict=True)
    places = (*range(13), 16, *range(17, 17 + 2 * modes))
    return ContinuousStates(quantities, units, nominal, places, quadratures=("heat",))
