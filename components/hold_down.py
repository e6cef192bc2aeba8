"""Hold-down point: a preloaded joint of two ports in three directions, until it is released."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import Component, ComponentError, ContinuousStates, Port, Quantity, Vector
from .contract.frames import Quaternion, Vector3, cross, rotate, rotate_back, subtract
from .numerics.mid_step import MidStep
from .numerics.relative_motion import (
    Passage,
    as_floats,
    gives_end_point,
    is_of_order_four,
    numerical_dissipation,
    order_parameter,
    pair,
    port_moments,
    unit_direction,
)
from .numerics.stiff_coordinate import MeanLoad, Memory, StepMotion, bushing_load, remembered
from .numerics.workless_pair import remembered_path, workless_spring

_START, _MEAN_RATES, _END_RATES = slice(7, 10), 10, 13
_CLOCK, _RELEASED, _HEAT, _RELEASE_HEAT, _WRENCH, _NUMERICAL = 16, 17, 18, 19, slice(20, 32), 32
_ROUGHNESS, _SLOPES, _LOADS = 33, slice(36, 48), 48
_COMMANDS, _MOMENTS = 26, slice(29, 41)
_NOWHERE = (0.0, 0.0, 0.0)
_REACHED = 1e-9  # distance (s) from the release time that sums of step sizes, or a solver's search, may leave


@dataclass(frozen=True, slots=True)
class _Constants:
    """Stiffness, damping and where the spring is free, along the three inboard axes; `paired`: of order 4."""

    stiffness: Vector3
    damping: Vector3
    free: Vector3
    release_time: float
    end_weight: float
    paired: bool

    def potential(self, displacement: Vector3) -> float:
        """Elastic energy."""
        parts = zip(self.stiffness, displacement, self.free, strict=True)
        return sum(0.5 * k * (q - free) * (q - free) for k, q, free in parts)

    def force(self, displacement: Vector3, rate: Vector3) -> Vector3:
        """Force of an instant on the outboard port, inboard axes."""
        x, y, z = (
            -k * (q - free) - d * w
            for k, d, q, free, w in zip(
                self.stiffness, self.damping, displacement, self.free, rate, strict=True
            )
        )
        return (x, y, z)

    def is_due(self, clock: float) -> bool:
        """Whether the release time is reached."""
        return 0.0 < self.release_time <= clock + _REACHED


class _Instant(NamedTuple):
    """Orientation of the inboard port, gap (world axes), displacement and its rate (inboard axes)."""

    frame: Quaternion
    gap: Vector3
    displacement: Vector3
    rate: Vector3


class HoldDown(Component):
    """Holds the outboard on the inboard port by springs along the three inboard axes, in no rotation.

    axis: direction of the preload in the axes of the inboard port. Displacements count from the ports' offset at
    the start, where the force on the outboard port is the preload against the axis: the bolt pulls it inboard. The
    release comes at the start of a step whose command says so, or at the end of the step that reaches the release
    time; that step is held throughout. The bolt keeps the elastic energy of that instant as heat. The clock starts
    at zero, when the scene does, and stands still while `hold` is 1.
    """

    kind = "hold_down"

    def __init__(self, axis: Sequence[float] = (0.0, 0.0, 1.0), wrench_mode: str = "mean") -> None:
        self._endpoint = gives_end_point(wrench_mode)
        self._direction = unit_direction(axis, "axis", "the hold-down's preload")
        self._declare(
            {"axis": tuple(axis), "wrench_mode": wrench_mode},
            ports=[Port(name, "connection", 2 if self._endpoint else 4) for name in ("inboard", "outboard")],
            parameters=_parameters(),
            inputs=_inputs(),
            observations=[
                Quantity("force", "N", "Force on the outboard port, inboard axes", 3),
                Quantity("released", "1", "1 from the release on"),
                Quantity("potential_energy", "J", "Elastic energy, with that of the preload"),
                Quantity("dissipated_energy", "J", "Energy dissipated since the start, in the bolt too"),
                numerical_dissipation(),
            ],
            feedthrough=self._endpoint,
        )
        if self._endpoint:
            self.continuous = ContinuousStates(
                (
                    Quantity("clock", "s", "Time since the start, without what was held"),
                    Quantity("heat", "J", "Energy dissipated by damping"),
                ),
                ("1", "W"),
                (1.0, 1.0),
                (_CLOCK, _HEAT),
                ("clock", "heat"),
                1,
            )

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        self.check_ranges(p)
        value = {
            q.name: as_floats(p[self.parameter_layout[q.name]]) for q in self.parameter_layout.quantities
        }
        preload, stiffness, free = value["preload"][0], value["translational_stiffness"], [0.0, 0.0, 0.0]
        for i, share in enumerate(self._direction):
            if stiffness[i] > 0.0:
                free[i] = -preload * share / stiffness[i]
            elif preload * share != 0.0:
                raise ComponentError(
                    f"translational_stiffness[{i + 1}] is 0 N/m; a preload of {preload:g} N has a share along that "
                    "axis and needs stiffness there"
                )
        damping = value["translational_damping"]
        return _Constants(
            (stiffness[0], stiffness[1], stiffness[2]),
            (damping[0], damping[1], damping[2]),
            (free[0], free[1], free[2]),
            value["release_time"][0],
            value["end_weight"][0],
            is_of_order_four(value["order"][0]) and value["end_weight"][0] == 0.5 and not self._endpoint,
        )

    def initial(self, c: _Constants, u: Vector) -> Vector:
        """Held, without displacement in the pose of the inputs."""
        inputs = as_floats(u)
        now = self._instant(inputs, _NOWHERE)
        rates = (*now.rate, *now.rate)
        return np.array((*now.frame, *now.gap, *now.displacement, *rates, *(0.0,) * 4, *(0.0,) * 40))

    @staticmethod
    def _instant(u: list[float], start: Vector3) -> _Instant:
        """The instant of the inputs; `start` is the offset (inboard axes) from which displacements count."""
        frame, gap = (u[3], u[4], u[5], u[6]), (u[13] - u[0], u[14] - u[1], u[15] - u[2])
        apart = subtract((u[20] - u[7], u[21] - u[8], u[22] - u[9]), cross((u[10], u[11], u[12]), gap))
        return _Instant(frame, gap, subtract(rotate_back(frame, gap), start), rotate_back(frame, apart))

    def _now(self, x: Vector, u: Vector) -> _Instant:
        v = as_floats(x[_START])
        return self._instant(as_floats(u), (v[0], v[1], v[2]))

    def step(self, c: _Constants, x: Vector, u: Vector, h: float) -> Vector:
        """One step: held or free throughout."""
        v, inputs = as_floats(x), as_floats(u)
        start = (v[7], v[8], v[9])
        frame, gap = (v[0], v[1], v[2], v[3]), (v[4], v[5], v[6])
        before, now = subtract(rotate_back(frame, gap), start), self._instant(inputs, start)
        released_by_command, impulse, hold = (value > 0.5 for value in inputs[_COMMANDS : _COMMANDS + 3])
        clock = v[_CLOCK] if hold else v[_CLOCK] + h
        released, heat, bolt, numerical = v[_RELEASED], v[_HEAT], v[_RELEASE_HEAT], v[_NUMERICAL]
        if not released and released_by_command:
            released, bolt = 1.0, c.potential(before)
        memories = [Memory(rate, rate) for rate in now.rate]
        wrench: tuple[float, ...] = (0.0,) * 12
        slopes = wrench
        lasting = [MidStep.starting(0.0)] * 3
        if not released:
            passage, fourth = Passage(frame, now.frame, gap, now.gap), c.paired and not impulse
            moments = passage.moments(port_moments(inputs[_MOMENTS]))[0] if fourth else _NOWHERE
            motions = [self._motion(v, i, before[i], now.displacement[i], moments[i], h) for i in range(3)]
            loads = [self._load(c, i, motion, fourth) for i, motion in enumerate(motions)]
            heat += sum(load.heat for load in loads)
            numerical += sum(load.numerical for load in loads)
            force = (loads[0].force, loads[1].force, loads[2].force)
            if fourth:
                slope = (loads[0].slope, loads[1].slope, loads[2].slope)
                wrench, slopes = passage.wrenches(force, _NOWHERE, slope, _NOWHERE)
                memories = [remembered_path(m) for m in motions]
                lasting = [_load_of(v, i).after(load.force, h) for i, load in enumerate(loads)]
            else:
                wrench = passage.wrench(force, _NOWHERE)
                if not impulse:
                    memories = [remembered(m, rate) for m, rate in zip(motions, now.rate, strict=True)]
            if c.is_due(clock):
                released, bolt = 1.0, c.potential(now.displacement)
        mean_rates, end_rates, roughness = zip(*memories, strict=True)
        moved = (*now.frame, *now.gap, *start, *mean_rates, *end_rates, clock, released)
        last = (value for load in lasting for value in load)
        return np.array((*moved, heat, bolt, *wrench, numerical, *roughness, *slopes, *last))

    def _motion(
        self, v: list[float], i: int, before: float, after: float, moment: float, h: float
    ) -> StepMotion:
        """Motion of a displacement; inertial terms tame held forces, which an end-point force is not."""
        mean_rate = (after - before) / h
        memory = Memory(mean_rate, mean_rate)
        if not self._endpoint:
            memory = Memory(v[_MEAN_RATES + i], v[_END_RATES + i], v[_ROUGHNESS + i])
        return StepMotion(before, after, h, memory, moment)

    @staticmethod
    def _load(c: _Constants, i: int, motion: StepMotion, fourth: bool) -> MeanLoad:
        """Load along an axis over a step."""
        moved = motion._replace(start=motion.start - c.free[i], end=motion.end - c.free[i])
        if fourth:
            return workless_spring(c.stiffness[i], c.damping[i], moved)
        return bushing_load(c.stiffness[i], c.damping[i], moved, c.end_weight)

    def outputs(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Wrenches on both ports, slopes of mean wrenches."""
        if not self._endpoint:
            return np.concatenate((x[_WRENCH], x[_SLOPES]))
        if x[_RELEASED]:
            return np.zeros(12)
        now = self._now(x, u)
        force = rotate(now.frame, c.force(now.displacement, now.rate))
        return np.array(pair(force, _NOWHERE, now.gap))

    def observe(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Force at the communication point, and energies; of order 4, from what the last steps' loads were."""
        losses = (x[_HEAT] + x[_RELEASE_HEAT], x[_NUMERICAL])
        if x[_RELEASED]:
            return np.array((0.0, 0.0, 0.0, 1.0, 0.0, *losses))
        now = self._now(x, u)
        rate = now.rate
        if not self._endpoint:
            first = _END_RATES if c.paired else _MEAN_RATES
            rate = (float(x[first]), float(x[first + 1]), float(x[first + 2]))
        force: tuple[float, ...] = c.force(now.displacement, rate)
        if c.paired:
            v = as_floats(x)
            force = tuple(_load_of(v, i).load_now(f, v[_ROUGHNESS + i]) for i, f in enumerate(force))
        return np.array((*force, 0.0, c.potential(now.displacement), *losses))

    def rates(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Rate of the clock, and heat of damping (W)."""
        heat = 0.0
        if not x[_RELEASED]:
            heat = sum(d * w * w for d, w in zip(c.damping, self._now(x, u).rate, strict=True))
        return np.array((0.0 if u[_COMMANDS + 2] > 0.5 else 1.0, heat))

    def indicators(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Time left to the release; one where none is coming."""
        awaited = not x[_RELEASED] and c.release_time > 0.0
        return np.array((c.release_time - x[_CLOCK] if awaited else 1.0,))

    def update(self, c: _Constants, x: Vector, u: Vector, at_event: bool) -> Vector:
        """At an event, the release that is commanded or due."""
        result = x.copy()
        if at_event and not x[_RELEASED] and (u[_COMMANDS] > 0.5 or c.is_due(float(x[_CLOCK]))):
            result[_RELEASED] = 1.0
            result[_RELEASE_HEAT] = c.potential(self._now(x, u).displacement)
        return result

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Direction of the preload and mode."""
        return {"direction": self._direction, "endpoint": self._endpoint}

    @classmethod
    def example(cls) -> HoldDown:
        """A hold-down point along z."""
        return cls()


def _load_of(v: list[float], i: int) -> MidStep:
    """Load along an axis over the last steps of order 4."""
    first = _LOADS + 4 * i
    return MidStep(*v[first : first + 4])


def _parameters() -> list[Quantity]:
    def tunable(name: str, unit: str, text: str, start: float = 0.0, size: int = 1) -> Quantity:
        return Quantity(name, unit, text, size, start, 0.0, variability="tunable")

    return [
        tunable("translational_stiffness", "N/m", "Stiffness along the three inboard axes", 1e6, 3),
        tunable("translational_damping", "N.s/m", "Damping along the three inboard axes", 0.0, 3),
        tunable("preload", "N", "Force at the start that pulls the outboard port against the axis"),
        tunable("release_time", "s", "Time of the release; 0 for one by command only"),
        Quantity("end_weight", "1", "Weight of the end value in mean wrenches", 1, 0.5, 0.5, 1.0, "tunable"),
        order_parameter(),
    ]


def _inputs() -> list[Quantity]:
    return [
        Quantity("release_command", "1", "1: released at the start of the next step", variability="discrete"),
        Quantity("impulse", "1", "1: the next step is an impulse", variability="discrete"),
        Quantity("hold", "1", "1: the clock stands still", variability="discrete"),
    ]
