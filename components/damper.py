r"""Eddy-current damper between two ports, about their common axis.

$$ T = -\frac{c\, \omega}{1 + (\omega / \omega_\mathrm{peak})^2} $$

at the rate $\omega$, largest at $\omega_\mathrm{peak}$; without a peak rate it is linear.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from .contract.connection import HEAT, Impulse, Inputs
from .contract.record import Record, kept, observed, tunable
from .contract.roles import DISSIPATED_ENERGY, LOAD, ORDER
from .numerics.axial import AxialConnection, Turn
from .numerics.fourth_order_correction import gauss_rates, viscous_load
from .numerics.interval_mean import MidStep


class _Parameters(NamedTuple):
    damping_coefficient: Annotated[float, tunable("N.m.s/rad", "Torque per rate at low rate", 1.0, 0.0)]
    peak_rate: Annotated[float, tunable("rad/s", "Rate of the largest torque; 0: linear damper", 0.0, 0.0)]
    order: Annotated[float, ORDER]

    def torque(self, rate: float) -> float:
        """Torque on the outboard side: c w / (1 + (w / w_peak)^2) against the rate w, largest at the peak rate."""
        ratio = rate / self.peak_rate if self.peak_rate else 0.0
        return -self.damping_coefficient * rate / (1.0 + ratio * ratio)


class _State(NamedTuple):
    turn: Turn
    rate: Annotated[MidStep, kept("rad/s", "Mean rates of two steps")]
    heat: Annotated[float, HEAT]


class _Observations(NamedTuple):
    angular_rate: Annotated[float, observed("rad/s", "Rate of the outboard against the inboard port")]
    damper_torque: Annotated[float, observed("N.m", "Torque on the outboard side about the axis", LOAD)]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]


class EddyCurrentDamper(AxialConnection[_Parameters, _State, Impulse]):
    """Eddy-current damper: resists the rotation rate between its ports about `axis`, in the axes of both ports."""

    kind, noun, axis_of = "eddy_current_damper", "damper", "the damper's axis"
    parameters, states = Record(_Parameters), Record(_State)
    commands, observations = Record(Impulse), Record(_Observations)

    def start(self, c: _Parameters, u: Inputs[Impulse]) -> _State:
        """At the pose of the inputs."""
        turn, rate = self._turn(u, 0.0)
        return _State(turn, MidStep.starting(rate), 0.0)

    def advance(self, c: _Parameters, s: _State, u: Inputs[Impulse], h: float) -> _State:
        """The torque along the path, at order 2 that of the mean rate, and the heat it makes."""
        (turn, rate), is_impulse = self._turn(u, s.turn.angle), u.commands.impulse > 0.5
        is_paired = self._is_paired(c.order) and not is_impulse
        arc = self._arc(s.turn, turn, u, is_paired)
        rates = before, after = gauss_rates(arc.change, arc.moment, h)
        load = viscous_load(rates, (c.torque(before), c.torque(after)), h)
        felt = s.rate.after(arc.change / h, h)
        if is_paired or is_impulse:
            felt = MidStep.starting(rate if is_impulse else (arc.change + 3.0 * arc.moment) / h)
        return _State(arc.under(load), felt, s.heat + load.heat)

    def torque(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> tuple[Turn, float, float]:
        """Of the present rate."""
        turn, rate = self._turn(u, s.turn.angle)
        return turn, rate, c.torque(rate)

    def record(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> _Observations:
        """Rate and torque, energy dissipated."""
        _, rate, torque = self.torque(c, s, u)
        return _Observations(rate, torque if self.endpoint else c.torque(s.rate.now()), s.heat)
