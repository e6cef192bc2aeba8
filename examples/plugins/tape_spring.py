"""A tape-spring hinge: torque over angle by one table where the angle rises and by another where it falls.

It snaps through, and resists folding more than it opens (Seffen and Pellegrino 1999): the mean of both tables, with its
potential, and half their difference as friction, which settles along a spring; what slides is heat.
"""

from collections.abc import Sequence
from operator import gt
from typing import Annotated, NamedTuple

from components.contract.component import ComponentError
from components.contract.connection import HEAT, Impulse, Inputs
from components.contract.record import Record, kept, observed, tunable
from components.contract.roles import DISSIPATED_ENERGY, LOAD, POTENTIAL_ENERGY
from components.numerics.axial import AxialConnection, Turn
from components.numerics.laws import Table, mean_force
from components.numerics.presliding import instant_force, step_force
from components.numerics.stiff_coordinate import MeanLoad


class Parameters(NamedTuple):
    settling_stiffness: Annotated[float, tunable("N.m/rad", "Stiffness between the tables", 20.0, 1e-3)]


class State(NamedTuple):
    turn: Turn
    deflection: Annotated[float, kept("rad", "Deflection of the spring between the tables")]
    heat: Annotated[float, HEAT]


class Observations(NamedTuple):
    angle: Annotated[
        float, observed("rad", "Angle of the outboard against the inboard port, 0 where straight")
    ]
    tape_torque: Annotated[float, observed("N.m", "Torque on the outboard side about the axis", LOAD)]
    potential_energy: Annotated[float, POTENTIAL_ENERGY]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]


class TapeSpring(AxialConnection[Parameters, State, Impulse]):
    """Axis in the axes of both ports, angles (rad), torques (N.m) where they rise and where they fall, not below."""

    kind, order, axis_of = "tape_spring", 2, "the axis of the tape spring"
    parameters, states = Record(Parameters), Record(State)
    commands, observations = Record(Impulse), Record(Observations)

    def __init__(
        self, axis: Sequence[float] = (0.0, 1.0, 0.0), angles: Sequence[float] = (-3.2, -0.3, -0.1, 0.0, 0.1, 0.3, 3.2),
        rising: Sequence[float] = (0.4, 0.4, 2.4, 0.0, -5.0, -0.5, -0.5),
        falling: Sequence[float] = (0.5, 0.5, 3.0, 0.0, -3.0, -0.4, -0.4), wrench_mode: str = "mean",
    ) -> None:  # fmt: skip
        if not len(angles) == len(rising) == len(falling) or any(map(gt, rising, falling)):
            raise ComponentError("tables need one length, and `falling` must nowhere be below `rising`")
        self._middle, self._half = (
            Table(angles, [0.5 * (b + sign * a) for a, b in zip(rising, falling, strict=True)])
            for sign in (1.0, -1.0)
        )
        self._turn_about(axis, {"angles": angles, "rising": rising, "falling": falling}, wrench_mode)

    def start(self, c: Parameters, u: Inputs[Impulse]) -> State:
        return State(self._turn(u, 0.0)[0], 0.0, 0.0)

    def advance(self, c: Parameters, s: State, u: Inputs[Impulse], h: float) -> State:
        now, _ = self._turn(u, s.turn.angle)
        arc = self._arc(s.turn, now, u, False)
        half = max(self._half.value(0.5 * (s.turn.angle + now.angle)), 0.0)
        slid = step_force(c.settling_stiffness, 0.0, half, s.deflection, arc.change, h)
        mean = mean_force(self._middle, s.turn.angle, now.angle) + slid.force
        return State(arc.under(MeanLoad(mean, slid.heat, 0.0)), slid.deflection, s.heat + slid.heat)

    def torque(self, c: Parameters, s: State, u: Inputs[Impulse]) -> tuple[Turn, float, float]:
        turn, rate = self._turn(u, s.turn.angle)
        half = max(self._half.value(turn.angle), 0.0)
        held = instant_force(c.settling_stiffness, 0.0, half, s.deflection, rate)
        return turn, rate, self._middle.value(turn.angle) + held.force

    def record(self, c: Parameters, s: State, u: Inputs[Impulse]) -> Observations:
        _, _, torque = self.torque(c, s, u)
        stored = 0.5 * c.settling_stiffness * s.deflection**2
        return Observations(s.turn.angle, torque, self._middle.potential(s.turn.angle) + stored, s.heat)
