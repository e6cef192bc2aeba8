r"""Tape-spring hinge: stiff while it is straight, and soft once it has folded; it snaps from one law to the other.

$$ T = T_b(\varphi) - c\, \dot\varphi,\qquad b \in \{\text{straight},\ \text{folded}\} $$

with the angle $\varphi$, 0 where the tape is straight. Beyond the last angle of the straight law the tape folds; what
it stores above the folded law is heat. Below the first angle of the folded law it is straight again. So the torque that
folds exceeds the one that opens, by measured tables or from the geometry of the strips (Wuest 1954; Seffen and
Pellegrino 1999).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar, NamedTuple

from numpy.typing import ArrayLike

from .contract.component import ComponentError, Vector
from .contract.connection import HEAT, Impulse, Inputs
from .contract.record import Record, flagged, kept, observed, tunable
from .contract.roles import DISSIPATED_ENERGY, LOAD, NUMERICAL_DISSIPATION, ORDER, POTENTIAL_ENERGY
from .numerics.axial import AxialConnection, Turn
from .numerics.fourth_order_correction import memories_after, workless_load
from .numerics.interval_mean import MidStep
from .numerics.laws import Table, mean_force
from .numerics.stiff_coordinate import MeanLoad, Memory, StepMotion
from .numerics.tape import Laws, Tape, laws_of

_REACHED = 1e-9  # distance (rad) from the angle of a snap that a solver may leave when it has found the event
_MOST_SNAPS = 3
_NAMES = ("negative", "straight", "positive")


class _Parameters(NamedTuple):
    damping: Annotated[float, tunable("N.m.s/rad", "Torque per rate", 0.0, 0.0)]
    stowed_angle: Annotated[float, tunable("rad", "Angle to which the first one is the nearest")]
    order: Annotated[float, ORDER]


class _State(NamedTuple):
    turn: Turn
    memory: Annotated[Memory, kept("rad/s", "Remembered rates of the angle, and roughness")]
    heat: Annotated[float, HEAT]
    slide: Annotated[MidStep, kept("rad/s", "Mean rates of the angle over two steps")]
    fold: Annotated[float, kept("1", "0 straight, 1 folded to positive angles, -1 to negative ones")]
    snap_heat: Annotated[float, kept("J", "Energy that snaps have turned to heat")] = 0.0
    numerical: Annotated[float, kept("J", "What the scheme took away")] = 0.0


class _Observations(NamedTuple):
    angle: Annotated[
        float, observed("rad", "Angle of the outboard against the inboard port, 0 where straight")
    ]
    angular_rate: Annotated[float, observed("rad/s", "Rate of the angle")]
    tape_torque: Annotated[float, observed("N.m", "Torque on the outboard side about the axis", LOAD)]
    straight: Annotated[float, flagged("1: straight, on the stiff law; 0: folded")]
    potential_energy: Annotated[float, POTENTIAL_ENERGY]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]
    numerical_dissipation: Annotated[float, NUMERICAL_DISSIPATION]


class _Course(NamedTuple):
    """Of a step: mean torque of the laws and its tangent, state of the fold at the end, heat of snaps (J)."""

    elastic: float
    tangent: float
    fold: int
    heat: float


class TapeHinge(AxialConnection[_Parameters, _State, Impulse]):
    """Torque of tape springs between two ports about `axis`, in the axes of both ports, which coincide where straight.

    tape: geometry and material of the strips (radius, subtended_angle, thickness, length, youngs_modulus,
    poisson_ratio, opposite, equal: numbers of strips that a positive angle bends in the opposite and the equal sense),
    SI units. Or tables: straight_angle, straight_torque up to the angles of the snaps; folded_angle, folded_torque with
    points at negative and positive angles, from the angles on where folds snap back. Torques act on the outboard side.
    """

    kind, noun, axis_of = "tape_hinge", "tape-spring hinge", "the axis of the tape springs"
    parameters, states = Record(_Parameters), Record(_State)
    commands, observations = Record(Impulse), Record(_Observations)
    indicator_count = 1
    scheme: ClassVar = {"REACHED": _REACHED, "MOST_SNAPS": _MOST_SNAPS}

    def __init__(
        self,
        axis: Sequence[float] = (0.0, 1.0, 0.0),
        tape: Mapping[str, Any] | None = None,
        straight_angle: Sequence[float] = (),
        straight_torque: Sequence[float] = (),
        folded_angle: Sequence[float] = (),
        folded_torque: Sequence[float] = (),
        wrench_mode: str = "mean",
    ) -> None:
        tables = Laws(
            *(
                tuple(float(value) for value in values)
                for values in (straight_angle, straight_torque, folded_angle, folded_torque)
            )
        )
        if bool(tape) == any(tables):
            raise ComponentError("give either the geometry of the `tape`, or tables of both laws")
        laws = laws_of(Tape.read(tape)) if tape else tables
        self._laws, self._snaps, self._backs = _tables(laws)
        negative, straight, positive = self._laws
        self._offsets = (  # energies are continuous where a fold snaps back
            straight.potential(self._backs[0]) - negative.potential(self._backs[0]) - straight.potential(0.0),
            -straight.potential(0.0),
            straight.potential(self._backs[1]) - positive.potential(self._backs[1]) - straight.potential(0.0),
        )
        for fold, snap in zip((-1, 1), self._snaps, strict=True):
            if self._energy(0, snap) < self._energy(fold, snap) - 1e-9 * abs(self._energy(0, snap)):
                raise ComponentError(
                    f"a fold at {snap:.4g} rad would gain energy; the straight law must need more work up to there "
                    "than the folded law returns"
                )
        self._turn_about(axis, {"tape": dict(tape or {}), **tables._asdict()}, wrench_mode)

    def _energy(self, fold: int, angle: float) -> float:
        """Of a law, 0 where the tape is straight."""
        return self._laws[fold + 1].potential(angle) + self._offsets[fold + 1]

    def _limit(self, fold: int, way: float) -> float | None:
        """Angle up to which a law acts on the way up or down; None where it goes on."""
        if fold == 0:
            return self._snaps[1] if way > 0.0 else self._snaps[0]
        return self._backs[(fold + 1) // 2] if fold * way < 0.0 else None

    @staticmethod
    def _next(fold: int, way: float) -> int:
        """Law after the limit of one."""
        return (1 if way > 0.0 else -1) if fold == 0 else 0

    def _course(self, fold: int, start: float, end: float) -> _Course:
        """Along the angles of a step, law by law."""
        way, at, work, heat, first = end - start, start, 0.0, 0.0, fold
        for snap in range(_MOST_SNAPS + 1):
            law, limit = self._laws[fold + 1], self._limit(fold, way)
            if limit is None or snap == _MOST_SNAPS or (end - limit) * way <= 0.0:
                break
            stop = limit if (limit - at) * way > 0.0 else at
            work += mean_force(law, at, stop) * (stop - at)
            following = self._next(fold, way)
            heat += self._energy(fold, stop) - self._energy(following, stop)
            fold, at = following, stop
        law = self._laws[fold + 1]
        last = mean_force(law, at, end)
        if fold == first and heat == 0.0 and at == start:
            return _Course(last, law.tangent(start, end), fold, 0.0)
        return _Course((work + last * (end - at)) / way, 0.0, fold, heat)

    def prepare(self, p: Vector) -> _Parameters:
        """Checked."""
        return self._checked(p)

    def start(self, c: _Parameters, u: Inputs[Impulse]) -> _State:
        """At the pose of the inputs, folded where it is beyond a snap."""
        turn, rate = self._turn(u, c.stowed_angle)
        fold = float(turn.angle > self._snaps[1]) - float(turn.angle < self._snaps[0])
        return _State(turn, Memory(rate, rate), 0.0, MidStep.starting(rate), fold)

    def advance(self, c: _Parameters, s: _State, u: Inputs[Impulse], h: float) -> _State:
        """The mean torque is the discrete gradient of the energy along the laws; a snap turns the rest to heat."""
        (turn, rate), is_impulse = self._turn(u, s.turn.angle), u.commands.impulse > 0.5
        is_paired = self._is_paired(c.order) and not is_impulse
        arc = self._arc(s.turn, turn, u, is_paired)
        motion = StepMotion(s.turn.angle, turn.angle, h, s.memory, arc.moment)
        course = self._course(int(s.fold), motion.start, motion.end)
        viscous = -c.damping * arc.change / h
        load = MeanLoad(course.elastic + viscous, -viscous * arc.change, 0.0)
        if is_paired:
            load = workless_load(course.elastic, course.tangent, c.damping, motion, s.memory.roughness)
        (memory,) = memories_after([motion], [rate], is_paired=is_paired, is_impulse=is_impulse)
        slide = s.slide.after(arc.change / h, h)
        if is_paired or is_impulse:
            slide = MidStep.starting(rate if is_impulse else memory.end_rate)
        return _State(
            arc.under(load),
            memory,
            s.heat + load.heat,
            slide,
            float(course.fold),
            s.snap_heat + course.heat,
            s.numerical + load.numerical,
        )

    def torque(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> tuple[Turn, float, float]:
        """Of the law that acts, and the damper."""
        turn, rate = self._turn(u, s.turn.angle)
        return turn, rate, self._laws[int(s.fold) + 1].value(turn.angle) - c.damping * rate

    def record(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> _Observations:
        """At the communication point."""
        turn, rate, torque = self.torque(c, s, u)
        if not self.endpoint:
            torque += c.damping * (rate - s.slide.now())
        energy = self._energy(int(s.fold), turn.angle)
        return _Observations(
            turn.angle, rate, torque, float(s.fold == 0.0), energy, s.heat + s.snap_heat, s.numerical
        )

    def powers(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> Sequence[float]:
        """Heat (W) of the damper."""
        _, rate = self._turn(u, s.turn.angle)
        return (c.damping * rate * rate,)

    def indicate(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> Sequence[float]:
        """Angle left up to the next snap."""
        angle = self._turn(u, s.turn.angle)[0].angle
        if s.fold == 0.0:
            return (min(self._snaps[1] - angle, angle - self._snaps[0]),)
        return (s.fold * (angle - self._backs[int(s.fold + 1.0) // 2]),)

    def follow(self, c: _Parameters, s: _State, u: Inputs[Impulse], at_event: bool) -> _State:
        """Follow the angle; at an event snap where the angle is reached."""
        turn, _ = self._turn(u, s.turn.angle)
        moved = s._replace(turn=s.turn._replace(angle=turn.angle))
        if not at_event or self.indicate(c, moved, u)[0] > _REACHED:
            return moved
        fold, middle = int(s.fold), 0.5 * (self._snaps[0] + self._snaps[1])
        following = self._next(fold, turn.angle - middle) if fold == 0 else 0
        heat = self._energy(fold, turn.angle) - self._energy(following, turn.angle)
        return moved._replace(fold=float(following), snap_heat=s.snap_heat + heat)

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Axis, mode, laws, and the angles between them."""
        tables = zip(_NAMES, self._laws, strict=True)
        return {
            **super().native_data(),
            **{name: array for law, table in tables for name, array in table.native_data(law).items()},
            "snaps": self._snaps,
            "backs": self._backs,
            "offsets": self._offsets,
        }

    @classmethod
    def example(cls) -> TapeHinge:
        """Two strips of steel, back to back."""
        return cls(
            tape={
                "radius": 0.0133, "subtended_angle": 1.5, "thickness": 1e-4, "length": 0.1,
                "youngs_modulus": 131e9, "poisson_ratio": 0.3, "opposite": 1, "equal": 1,
            }
        )  # fmt: skip


def _tables(laws: Laws) -> tuple[tuple[Table, Table, Table], tuple[float, float], tuple[float, float]]:
    """Laws by the sign of the fold, angles of snaps, and angles where folds snap back; each negative and positive."""
    straight = Table(laws.straight_angle, laws.straight_torque)
    points = list(zip(laws.folded_angle, laws.folded_torque, strict=False))
    if len(laws.folded_angle) != len(laws.folded_torque):
        raise ComponentError("folded_angle and folded_torque differ in their numbers of values")
    sides = [[p for p in points if p[0] < 0.0], [p for p in points if p[0] > 0.0]]
    if any(len(side) < 2 for side in sides):
        raise ComponentError("folded_angle needs two points below 0 and two above")
    negative, positive = (Table(*zip(*side, strict=True)) for side in sides)
    snaps, backs = (laws.straight_angle[0], laws.straight_angle[-1]), (sides[0][-1][0], sides[1][0][0])
    if not snaps[0] <= backs[0] < backs[1] <= snaps[1]:
        raise ComponentError(
            f"a fold must snap back between {snaps[0]:.4g} and {snaps[1]:.4g} rad, where the straight tape snaps; "
            f"folded_angle has {backs[0]:.4g} and {backs[1]:.4g} rad nearest to 0"
        )
    return (negative, straight, positive), snaps, backs
