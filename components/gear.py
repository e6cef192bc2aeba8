r"""Gear between two bodies on a carrier: keeps the angle of one in a ratio to the angle or the distance of the other.

$$ T = -k\, s - c\, \dot s,\qquad s = \varphi_1 - r\, q_2 - (\varphi_1 - r\, q_2)_\mathrm{start} $$

on the first body, and $-r T$ on the second, with the angle $\varphi_1$ and the angle or distance $q_2$, both relative
to the carrier. A rack or a screw has a distance. The ratio is negative for an external pair. With a carrier for each
body it is a coupler of any two joints: each carrier takes the reaction of its own body. With play (backlash) the law is
that of the deflection beyond it, see `numerics.clearance`; a gear starts in the middle of its play.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, NamedTuple

from numpy.typing import ArrayLike

from .contract.component import ComponentError, Vector
from .contract.connection import HEAT, SLOPES, WRENCH, Connection, Impulse, Inputs
from .contract.frames import Quaternion, Vector3, nearest_turn, rotate
from .contract.ports import WRENCH_SIZE, PortMoments, PortMotion
from .contract.record import Record, kept, observed, tunable
from .contract.roles import DISSIPATED_ENERGY, LOAD, NUMERICAL_DISSIPATION, ORDER, POTENTIAL_ENERGY
from .numerics.clearance import Clearance
from .numerics.fourth_order_correction import memories_after, stiff_load
from .numerics.interval_mean import MidStep
from .numerics.relative_motion import (
    Passage,
    axis_frame,
    conjugate_torque,
    pair,
    relative_pose,
    relative_rates,
)
from .numerics.stiff_coordinate import MeanLoad, Memory, StepMotion

_MOTIONS = ("rotation", "translation")
_BODIES = (1, 2)
"""Ports of the first and of the second body."""
_NONE: Vector3 = (0.0, 0.0, 0.0)


class _Parameters(NamedTuple):
    ratio: Annotated[
        float, tunable("1", "Angle of the first body per angle (rad) or distance (m) of the second", 1.0)
    ]
    stiffness: Annotated[float, tunable("N.m/rad", "Torque on the first body per angle", 2e4, 0.0)]
    damping: Annotated[float, tunable("N.m.s/rad", "Torque on the first body per rate", 2.0, 0.0)]
    play: Annotated[float, tunable("rad", "Backlash of the first body either way, without torque", 0.0, 0.0)]
    order: Annotated[float, ORDER]


class _Seat(NamedTuple):
    """A body on its carrier: frame of its axis, gap from the carrier (m, world axes), tilt, coordinate (rad or m)."""

    frame: Quaternion
    gap: Vector3
    swing: tuple[float, float]
    coordinate: float


class _State(NamedTuple):
    seats: Annotated[tuple[_Seat, ...], kept("1", "Both bodies on their carriers (rad, m)").sized(2)]
    start: Annotated[float, kept("rad", "Deflection that counts as none")]
    memory: Annotated[Memory, kept("rad/s", "Remembered rates of the deflection, and roughness")]
    heat: Annotated[float, HEAT]
    slide: Annotated[MidStep, kept("rad/s", "Mean rates of the deflection over two steps")]
    numerical: Annotated[float, kept("J", "What the scheme took away")]
    wrench: Annotated[tuple[float, ...], WRENCH]
    slopes: Annotated[tuple[float, ...], SLOPES]


class _Observations(NamedTuple):
    first_angle: Annotated[float, observed("rad", "Angle of the first body against its carrier")]
    second_coordinate: Annotated[float, observed("1", "Angle (rad) or distance (m) of the second body")]
    gear_torque: Annotated[float, observed("N.m", "Torque on the first body", LOAD)]
    potential_energy: Annotated[float, POTENTIAL_ENERGY]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]
    numerical_dissipation: Annotated[float, NUMERICAL_DISSIPATION]


class Gear(Connection[_Parameters, _State, Impulse]):
    """Gear of two bodies, ports `first` and `second`, on the port `carrier`; loads of teeth on bearings are not in it.

    first_axis, second_axis: of both motions, in the axes of a body and its carrier when they coincide. second_motion:
    "rotation", or "translation" for a rack or a screw. second_carrier: the second body moves on the port
    `second_carrier`, as a coupler of two hinge lines anywhere in a wing has it.
    """

    kind, ports_vary = "gear", True
    parameters = Record(_Parameters)
    commands, observations = Record(Impulse), Record(_Observations)

    def __init__(
        self,
        first_axis: Sequence[float] = (0.0, 1.0, 0.0),
        second_axis: Sequence[float] = (0.0, 1.0, 0.0),
        second_motion: Literal["rotation", "translation"] = "rotation",
        second_carrier: bool = False,
        wrench_mode: str = "mean",
    ) -> None:
        if second_motion not in _MOTIONS:
            raise ComponentError(f"second_motion is {second_motion!r}; it must be rotation or translation")
        self._axes = (
            axis_frame(first_axis, "the axis of the first body", "first_axis"),
            axis_frame(second_axis, "the axis of the second body", "second_axis"),
        )
        self._slides = (False, second_motion == "translation")
        has_two = bool(second_carrier)
        self.port_names = ("carrier", "first", "second", *["second_carrier"] * has_two)
        self._carriers = (0, len(self.port_names) - 1 if has_two else 0)
        size = WRENCH_SIZE * len(self.port_names)
        self._no_wrench = (0.0,) * size
        self.states = Record(_State, wrench=size, slopes=size)
        structure = {
            "first_axis": tuple(first_axis),
            "second_axis": tuple(second_axis),
            "second_motion": second_motion,
            "second_carrier": has_two,
        }
        super().__init__(structure, wrench_mode)

    def _seat(self, i: int, motions: Sequence[PortMotion], reference: float) -> tuple[_Seat, float]:
        """Of one body and its rate; the angle is the one nearest the reference."""
        of_pair = (motions[self._carriers[i]], motions[_BODIES[i]])
        pose = relative_pose(of_pair, self._axes[i])
        rates = relative_rates(of_pair, pose)
        slides = self._slides[i]
        coordinate = pose.offset[0] if slides else nearest_turn(pose.twist, reference)
        return _Seat(pose.frame, pose.gap, pose.swing, coordinate), rates.offset[0] if slides else rates.twist

    def _seats(
        self, u: Inputs[Impulse], first: float, second: float
    ) -> tuple[tuple[_Seat, _Seat], tuple[float, float]]:
        """Of both bodies, and their rates."""
        (one, rate), (other, other_rate) = (
            self._seat(i, u.motions, reference) for i, reference in enumerate((first, second))
        )
        return (one, other), (rate, other_rate)

    def _loads(self, i: int, load: float, swing: tuple[float, float]) -> tuple[Vector3, Vector3]:
        """Force and torque on a body, in the axes of its frame."""
        if self._slides[i]:
            return (load, 0.0, 0.0), _NONE
        return _NONE, conjugate_torque(load, (0.0, 0.0), swing)

    def prepare(self, p: Vector) -> _Parameters:
        """The checked parameters by name."""
        one = self._checked(p)
        if one.ratio == 0.0:
            raise ComponentError("ratio is 0; a gear has another ratio, negative for an external pair")
        return one

    def start(self, c: _Parameters, u: Inputs[Impulse]) -> _State:
        """In mesh at the pose of the inputs."""
        (first, second), (rate, other) = self._seats(u, 0.0, 0.0)
        start, rate = first.coordinate - c.ratio * second.coordinate, rate - c.ratio * other
        memory, slide = Memory(rate, rate), MidStep.starting(rate)
        no_wrench = self._no_wrench
        return _State((first, second), start, memory, 0.0, slide, 0.0, no_wrench, no_wrench)

    def advance(self, c: _Parameters, s: _State, u: Inputs[Impulse], h: float) -> _State:
        """The mean torque over the step, on both bodies and their carriers."""
        old = s.seats
        new, rates = self._seats(u, *(seat.coordinate for seat in old))
        is_impulse = u.commands.impulse > 0.5
        is_paired, shares = self._is_paired(c.order) and not is_impulse, (1.0, -c.ratio)
        passages = [Passage(a.frame, b.frame, a.gap, b.gap) for a, b in zip(old, new, strict=True)]
        swings = [_middle(a.swing, b.swing) for a, b in zip(old, new, strict=True)]
        moment = 0.0
        if is_paired:
            moment = sum(
                share * self._moment(i, passages[i], u.moments, swings[i]) for i, share in enumerate(shares)
            )
        before, after = (a.coordinate - c.ratio * b.coordinate - s.start for a, b in (old, new))
        motion = StepMotion(before, after, h, s.memory, moment)
        if self.endpoint:
            motion = motion.without_inertia()
        load = _load(c, motion, is_paired)
        pairs = [
            passage.wrenches(
                *self._loads(i, share * load.force, swing), *self._loads(i, share * load.slope, swing)
            )
            for i, (passage, swing, share) in enumerate(zip(passages, swings, shares, strict=True))
        ]
        rate = rates[0] - c.ratio * rates[1]
        (memory,) = memories_after([motion], [rate], is_paired=is_paired, is_impulse=is_impulse)
        slide = s.slide.after((after - before) / h, h)
        if is_paired or is_impulse:
            slide = MidStep.starting(rate if is_impulse else memory.end_rate)
        return s._replace(
            seats=new,
            memory=memory,
            heat=s.heat + load.heat,
            slide=slide,
            numerical=s.numerical + load.numerical,
            wrench=self._on_ports([mean for mean, _ in pairs]),
            slopes=self._on_ports([slope for _, slope in pairs]) if is_paired else self._no_wrench,
        )

    def _moment(
        self, i: int, passage: Passage, moments: Sequence[PortMoments], swing: tuple[float, float]
    ) -> float:
        """First moment of the rate of a coordinate."""
        rates = passage.rate_moments((moments[self._carriers[i]], moments[_BODIES[i]]), swing)
        return rates.offset[0] if self._slides[i] else rates.twist

    def _on_ports(self, pairs: Sequence[Sequence[float]]) -> tuple[float, ...]:
        """Wrenches on all ports, from those on each carrier and its body."""
        wrenches = list(self._no_wrench)
        for carrier, body, both in zip(self._carriers, _BODIES, pairs, strict=True):
            for k in range(WRENCH_SIZE):
                wrenches[WRENCH_SIZE * carrier + k] += both[k]
                wrenches[WRENCH_SIZE * body + k] += both[WRENCH_SIZE + k]
        return tuple(wrenches)

    def _deflection(
        self, c: _Parameters, s: _State, u: Inputs[Impulse]
    ) -> tuple[tuple[_Seat, _Seat], float, float]:
        """Both bodies, the deflection and its rate at an instant."""
        seats, rates = self._seats(u, *(seat.coordinate for seat in s.seats))
        deflection = seats[0].coordinate - c.ratio * seats[1].coordinate - s.start
        return seats, deflection, rates[0] - c.ratio * rates[1]

    def wrenches(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> Sequence[float]:
        """Of the torque of an instant."""
        seats, deflection, rate = self._deflection(c, s, u)
        torque, pairs = _torque(c, deflection, rate), []
        for i, (seat, share) in enumerate(zip(seats, (1.0, -c.ratio), strict=True)):
            force, moment = self._loads(i, share * torque, seat.swing)
            pairs.append(pair(rotate(seat.frame, force), rotate(seat.frame, moment), seat.gap))
        return self._on_ports(pairs)

    def record(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> _Observations:
        """At the communication point."""
        (first, second), deflection, rate = self._deflection(c, s, u)
        torque = _torque(c, deflection, rate if self.endpoint else s.slide.now())
        stored = _beyond_play(c).potential((deflection,))
        return _Observations(first.coordinate, second.coordinate, torque, stored, s.heat, s.numerical)

    def powers(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> Sequence[float]:
        """Heat (W) of the damper."""
        _, deflection, rate = self._deflection(c, s, u)
        return (_beyond_play(c).heat((deflection,), (rate,)) if c.play else c.damping * rate * rate,)

    def follow(self, c: _Parameters, s: _State, u: Inputs[Impulse], at_event: bool) -> _State:
        """Follow the angles."""
        now, _ = self._seats(u, *(seat.coordinate for seat in s.seats))
        seats = zip(s.seats, now, strict=True)
        return s._replace(seats=tuple(a._replace(coordinate=b.coordinate) for a, b in seats))

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Axes, kind of the second motion, whether it has a carrier of its own, and mode."""
        first, second = self._axes
        return {
            **super().native_data(), "first_frame": first, "second_frame": second, "second_slides": self._slides[1],
            "second_carrier": self._carriers[1] != self._carriers[0],
        }  # fmt: skip

    @classmethod
    def example(cls) -> Gear:
        """A coupler: each body on a carrier of its own."""
        return cls(second_carrier=True)


def _middle(a: tuple[float, float], b: tuple[float, float]) -> tuple[float, float]:
    return 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])


def _torque(c: _Parameters, deflection: float, rate: float) -> float:
    """Torque (N.m) on the first body."""
    if c.play:
        return _beyond_play(c).force((deflection,), (rate,))[0]
    return -c.stiffness * deflection - c.damping * rate


def _load(c: _Parameters, motion: StepMotion, is_paired: bool) -> MeanLoad:
    """Load on the deflection over a step."""
    if c.play:
        return _beyond_play(c).loads((motion,), is_paired=is_paired)[0]
    return stiff_load(c.stiffness, c.damping, motion, is_paired=is_paired)


def _beyond_play(c: _Parameters) -> Clearance:
    return Clearance((0,), c.play, c.stiffness, c.damping)
