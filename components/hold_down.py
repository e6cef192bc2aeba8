r"""Hold-down point: a preloaded joint of two ports in three directions, until it is released.

$$ F_i = -k_i\, q_i - c_i\, \dot q{}_i - P a_i,\qquad i = x, y, z $$

on the outboard port in axes of the inboard one, with displacements $q$ from the start, the preload $P$ along the axis
$\mathbf a$; nothing from the release on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, ClassVar, NamedTuple

from numpy.typing import ArrayLike

from .contract.component import ComponentError, Vector
from .contract.connection import NO_PAIR, SLOPES, WRENCH, Connection, Inputs
from .contract.frames import Quaternion, Vector3, cross, rotate, rotate_back, subtract
from .contract.ports import PortMotion
from .contract.record import Record, fixed, flagged, integrated, kept, observed, tunable
from .contract.roles import (
    DISSIPATED_ENERGY,
    HOLD,
    IMPULSE,
    LOAD,
    NUMERICAL_DISSIPATION,
    ORDER,
    POTENTIAL_ENERGY,
    RELEASE_COMMAND,
    TIME_TO_BREAK,
)
from .numerics.fourth_order_correction import memories_after, stiff_load
from .numerics.interval_mean import MidStep
from .numerics.relative_motion import Passage, pair, unit_direction
from .numerics.scheme import INSTANT, NEVER
from .numerics.stiff_coordinate import MeanLoad, Memory, StepMotion

_NOWHERE = (0.0, 0.0, 0.0)
_REACHED = 1e-9  # distance (s) from the release time that sums of step sizes, or a solver's search, may leave
_NO_LOADS = (MidStep.starting(0.0),) * 3


class _Parameters(NamedTuple):
    translational_stiffness: Annotated[Vector3, tunable("N/m", "Stiffness along the inboard axes", 1e6, 0.0)]
    translational_damping: Annotated[Vector3, tunable("N.s/m", "Damping along the inboard axes", 0.0, 0.0)]
    preload: Annotated[float, tunable("N", "Force against the axis, before static equilibrium", 0.0, 0.0)]
    initial_displacement: Annotated[
        Vector3, fixed("m", "At the start, from where the preload is, inboard axes")
    ]
    release_time: Annotated[float, tunable("s", "Time of the release; 0: by command only", 0.0, 0.0)]
    order: Annotated[float, ORDER]


class _State(NamedTuple):
    frame: Annotated[Quaternion, kept("1", "Orientation of the inboard port")]
    gap: Annotated[Vector3, kept("m", "From the inboard to the outboard port, world axes")]
    start: Annotated[Vector3, kept("m", "Offset from which displacements count, inboard axes")]
    memories: Annotated[tuple[Memory, ...], kept("m/s", "Memories of the displacements").sized(3)]
    clock: Annotated[float, integrated("s", "1", "Time since the start, without what was held")]
    released: Annotated[float, kept("1", "1 from the release on")]
    heat: Annotated[float, integrated("J", "W", "Energy dissipated by damping")]
    release_heat: Annotated[float, kept("J", "Elastic energy that the bolt kept")]
    numerical: Annotated[float, kept("J", "What the scheme took away")]
    wrench: Annotated[tuple[float, ...], WRENCH] = NO_PAIR
    slopes: Annotated[tuple[float, ...], SLOPES] = NO_PAIR
    loads: Annotated[tuple[MidStep, ...], kept("N", "Mean loads of two steps of order 4").sized(3)] = (
        _NO_LOADS
    )


class _Commands(NamedTuple):
    release_command: Annotated[float, RELEASE_COMMAND]
    impulse: Annotated[float, IMPULSE]
    hold: Annotated[float, HOLD.saying("1: the clock stands still")]


class _Observations(NamedTuple):
    force: Annotated[Vector3, observed("N", "Force on the outboard port, inboard axes", LOAD)]
    released: Annotated[float, flagged("1 from the release on")]
    potential_energy: Annotated[float, POTENTIAL_ENERGY.saying("Elastic energy, with that of the preload")]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY.saying("Energy dissipated, in the bolt too")]
    numerical_dissipation: Annotated[float, NUMERICAL_DISSIPATION]


class _Constants(NamedTuple):
    """Parameters, and where the spring is free along the three inboard axes."""

    p: _Parameters
    free: Vector3
    is_paired: bool

    def potential(self, displacement: Vector3) -> float:
        """Elastic energy."""
        parts = zip(self.p.translational_stiffness, displacement, self.free, strict=True)
        return sum(0.5 * k * (q - free) * (q - free) for k, q, free in parts)

    def force(self, displacement: Vector3, rate: Vector3) -> Vector3:
        """Force of an instant on the outboard port, inboard axes."""
        stiffness, damping = self.p.translational_stiffness, self.p.translational_damping
        x, y, z = (
            -k * (q - free) - d * w
            for k, d, q, free, w in zip(stiffness, damping, displacement, self.free, rate, strict=True)
        )
        return (x, y, z)

    def is_due(self, clock: float) -> bool:
        """Whether the release time is reached."""
        return 0.0 < self.p.release_time <= clock + _REACHED


class _Instant(NamedTuple):
    """Orientation of the inboard port, gap (world axes), displacement and its rate (inboard axes)."""

    frame: Quaternion
    gap: Vector3
    displacement: Vector3
    rate: Vector3


class HoldDown(Connection[_Parameters, _State, _Commands]):
    """Hold-down: springs along the three inboard axes between both ports until release; free in rotation.

    axis: direction of the preload in the axes of the inboard port. Displacements count from the ports' offset at
    the start, less the initial displacement of a scene that starts in equilibrium; there the force on the outboard port
    is the preload against the axis: the bolt pulls it inboard. The
    release comes at the start of a step whose command says so, or at the end of the step that reaches the release
    time; that step is held throughout, so a master should end a step there, see the time to the break. The bolt
    keeps the elastic energy of that instant as heat. The clock starts at zero, when the scene does, and stands
    still while `hold` is 1.
    """

    kind, noun, indicator_count, own_outputs = "hold_down", "hold-down", 1, (TIME_TO_BREAK,)
    parameters, states = Record(_Parameters), Record(_State)
    commands, observations = Record(_Commands), Record(_Observations)
    scheme: ClassVar = {"REACHED": _REACHED}

    def __init__(self, axis: Sequence[float] = (0.0, 0.0, 1.0), wrench_mode: str = "mean") -> None:
        self._direction = unit_direction(axis, "axis", "the hold-down's preload")
        super().__init__({"axis": tuple(axis)}, wrench_mode)

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        one, free = self._checked(p), [0.0, 0.0, 0.0]
        for i, (stiffness, share) in enumerate(
            zip(one.translational_stiffness, self._direction, strict=True)
        ):
            if stiffness > 0.0:
                free[i] = -one.preload * share / stiffness
            elif one.preload * share != 0.0:
                raise ComponentError(
                    f"translational_stiffness[{i + 1}] is 0 N/m; a preload of {one.preload:g} N has a share along that "
                    "axis and needs stiffness there"
                )
        x, y, z = free
        return _Constants(one, (x, y, z), self._is_paired(one.order))

    def start(self, c: _Constants, u: Inputs[_Commands]) -> _State:
        """Held, in the pose of the inputs by its initial displacement away from where displacements count."""
        now = self._instant(u, c.p.initial_displacement)
        memories = tuple(Memory(rate, rate) for rate in now.rate)
        return _State(now.frame, now.gap, now.displacement, memories, 0.0, 0.0, 0.0, 0.0, 0.0)

    def led(self, before: Sequence[PortMotion], now: Sequence[PortMotion]) -> Mapping[str, Sequence[float]]:
        """What the ports' offset has changed by."""
        then, here = (
            rotate_back(inboard.orientation, subtract(outboard.position, inboard.position))
            for inboard, outboard in (before, now)
        )
        return {"initial_displacement": subtract(here, then)}

    @staticmethod
    def _instant(u: Inputs[_Commands], start: Vector3) -> _Instant:
        """The instant of the inputs; `start` is the offset (inboard axes) from which displacements count."""
        inboard, outboard = u.motions
        frame, gap = inboard.orientation, subtract(outboard.position, inboard.position)
        apart = subtract(subtract(outboard.velocity, inboard.velocity), cross(inboard.angular_velocity, gap))
        return _Instant(frame, gap, subtract(rotate_back(frame, gap), start), rotate_back(frame, apart))

    def advance(self, c: _Constants, s: _State, u: Inputs[_Commands], h: float) -> _State:
        """Held or free throughout."""
        now = self._instant(u, s.start)
        before = subtract(rotate_back(s.frame, s.gap), s.start)
        clock = s.clock if u.commands.hold > 0.5 else s.clock + h
        if not s.released and u.commands.release_command > 0.5:
            s = s._replace(released=1.0, release_heat=c.potential(before))
        moved = s._replace(
            frame=now.frame,
            gap=now.gap,
            memories=tuple(Memory(rate, rate) for rate in now.rate),
            clock=clock,
            wrench=NO_PAIR,
            slopes=NO_PAIR,
            loads=_NO_LOADS,
        )
        if s.released:
            return moved
        held = self._held(c, s, moved, before, now, u, h)
        if c.is_due(clock):
            held = held._replace(released=1.0, release_heat=c.potential(now.displacement))
        return held

    def _held(
        self,
        c: _Constants,
        s: _State,
        moved: _State,
        before: Vector3,
        now: _Instant,
        u: Inputs[_Commands],
        h: float,
    ) -> _State:
        """The moved state after a step that was held."""
        is_impulse = u.commands.impulse > 0.5
        passage, is_paired = Passage(s.frame, now.frame, s.gap, now.gap), c.is_paired and not is_impulse
        moments = passage.moments(u.moments)[0] if is_paired else _NOWHERE
        ends = zip(s.memories, before, now.displacement, moments, strict=True)
        motions = [self._motion(*end, h) for end in ends]
        loads = [self._load(c, i, motion, is_paired) for i, motion in enumerate(motions)]
        x, y, z = (load.force for load in loads)
        moved = moved._replace(
            heat=s.heat + sum(load.heat for load in loads),
            numerical=s.numerical + sum(load.numerical for load in loads),
            memories=memories_after(motions, now.rate, is_paired=is_paired, is_impulse=is_impulse),
        )
        if is_paired:
            dx, dy, dz = (load.slope for load in loads)
            wrench, slopes = passage.wrenches((x, y, z), _NOWHERE, (dx, dy, dz), _NOWHERE)
            lasting = tuple(old.after(load.force, h) for old, load in zip(s.loads, loads, strict=True))
            return moved._replace(wrench=wrench, slopes=slopes, loads=lasting)
        return moved._replace(wrench=passage.wrench((x, y, z), _NOWHERE))

    def _motion(self, memory: Memory, before: float, after: float, moment: float, h: float) -> StepMotion:
        """Motion of a displacement."""
        motion = StepMotion(before, after, h, memory, moment)
        return motion.without_inertia() if self.endpoint else motion

    @staticmethod
    def _load(c: _Constants, i: int, motion: StepMotion, is_paired: bool) -> MeanLoad:
        """Load along an axis over a step."""
        stiffness, damping = c.p.translational_stiffness[i], c.p.translational_damping[i]
        moved = motion._replace(start=motion.start - c.free[i], end=motion.end - c.free[i])
        return stiff_load(stiffness, damping, moved, is_paired=is_paired)

    def own(self, c: _Constants, s: _State) -> Sequence[float]:
        """Time to the release; an instant where a time set in mid-run is over."""
        return (max(c.p.release_time - s.clock, INSTANT) if self._is_awaited(c, s) else NEVER,)

    @staticmethod
    def _is_awaited(c: _Constants, s: _State) -> bool:
        """Whether a release by time is to come."""
        return not s.released and c.p.release_time > 0.0

    def wrenches(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> Sequence[float]:
        """Of the present displacement and its rate."""
        if s.released:
            return NO_PAIR
        now = self._instant(u, s.start)
        return pair(rotate(now.frame, c.force(now.displacement, now.rate)), _NOWHERE, now.gap)

    def record(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> _Observations:
        """Force at the communication point, and energies; of order 4, from what the last steps' loads were."""
        losses = (s.heat + s.release_heat, s.numerical)
        if s.released:
            return _Observations(_NOWHERE, 1.0, 0.0, *losses)
        now = self._instant(u, s.start)
        rate = now.rate
        if not self.endpoint:
            x, y, z = (m.end_rate if c.is_paired else m.mean_rate for m in s.memories)
            rate = (x, y, z)
        force = c.force(now.displacement, rate)
        if c.is_paired:
            lasting = zip(s.loads, force, s.memories, strict=True)
            x, y, z = (load.load_now(f, memory.roughness) for load, f, memory in lasting)
            force = (x, y, z)
        return _Observations(force, 0.0, c.potential(now.displacement), *losses)

    def powers(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> Sequence[float]:
        """Rate of the clock, and heat of damping (W)."""
        heat = 0.0
        if not s.released:
            rate = self._instant(u, s.start).rate
            heat = sum(d * w * w for d, w in zip(c.p.translational_damping, rate, strict=True))
        return 0.0 if u.commands.hold > 0.5 else 1.0, heat

    def indicate(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> Sequence[float]:
        """Time left to the release; one where none is coming."""
        return (c.p.release_time - s.clock if self._is_awaited(c, s) else 1.0,)

    def follow(self, c: _Constants, s: _State, u: Inputs[_Commands], at_event: bool) -> _State:
        """At an event, the release that is commanded or due."""
        if not at_event or s.released or not (u.commands.release_command > 0.5 or c.is_due(s.clock)):
            return s
        heat = c.potential(self._instant(u, s.start).displacement)
        return s._replace(released=1.0, release_heat=heat)

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Direction of the preload and mode."""
        return {**super().native_data(), "direction": self._direction}
