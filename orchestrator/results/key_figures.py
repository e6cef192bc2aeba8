"""Headline numbers of a result."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from math import degrees, inf, isfinite
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from components import SUPPLIED_ENERGY
from components.contract.roles import ATTITUDE, INTERFACE_LOAD, LOAD

from ..assembly import HingeLine
from ..messages import is_note, message
from ..records import short_repr
from .energy_ledger import energy_ledger, tolerance_asked, tolerance_taken
from .estimated_errors import POINT_PEAKS, Key, error_messages, round_off_of_loads
from .identifiers import load_words
from .latch_impulse import latch_impulses
from .latch_rate import latch_energies, latch_rates
from .line_travel import (
    Overrun,
    ShortOf,
    folded,
    has_motor,
    overruns,
    reached_stops,
    short_of_deployed,
    short_of_stops,
    unlatched_angles,
)
from .number import Number
from .peaks import peak
from .point_loads import point_loads
from .requirements import Judged, judged, limits_of, requirements_sentence
from .result import Result
from .round_off import noise_floor, rounded_to_floor
from .signal import EVENT_WIDTH
from .slack_strands import Slack, slack_strands
from .unlatching import Unlatching, unlatchings
from .verdict import NotOpened, lines_sentence, not_opened, unlatched_sentences

Vector = NDArray[np.float64]
T = TypeVar("T")

_SHOWN = {"1": ("", 1.0), "rad": ("deg", degrees(1.0)), "rad/s": ("deg/s", degrees(1.0))}


def shown(unit: str) -> tuple[str, float]:
    """The unit that people read a number of a unit in, and its factor."""
    return _SHOWN.get(unit, (unit, 1.0))


ERRORS_UNKNOWN = message(
    "W-error-unknown",
    "No errors could be estimated: the coarser run that shows them does not reach the end. Run again with a smaller "
    "--tolerance or --step.",
)
UNLATCHED = "final angle, not latched"
"""Headline number of a line with a latch that has not latched."""
FINAL_UNLATCHED = "final angle, unlatched"
"""Headline number of a line whose latch has let go."""


@short_repr
@dataclass(frozen=True)
class Headline:
    """What a deployment is judged by; SI units, components and hinge lines by name.

    not_opened: lines that should have latched, or come to their stop or deployed angle, and have not.
    unlatched_angles: where lines with a latch stand at the end without having latched (rad). overruns: lines without a
    latch that passed their deployed angle. short_of_deployed: such lines that never came to it, or that tape springs do
    not hold there; motors_short: those of them that a motor or a tape spring opens. short_of_stops: lines that an end
    stop alone ends and that never came to it; reached_stops: when (s) such lines came to it.
    latch_rates: size of each line's rate just before its latch-up, rad/s; latch_energies: kinetic energy that the latch
    takes up, J, see `latch_energies`.
    latch_torque_peaks: peak of the magnitude of the sum over the hinges of a line. latch_impulses: of locks, which are
    kinematic latches between rigid bodies, N.m.s; their torque is that of the lock and no load of the wing.
    interface_*_peaks:
    magnitude of each component (x, y, z) of what all ports bring onto the base, about its origin in its axes; its own
    inertia is no part of it. port_*_peaks: magnitude of the vector at each of its ports, by name, torques about the
    port; hinge_*_peaks: the same at each hinge between other bodies, on the outboard one. attitude_peaks (rad),
    attitude_rate_peaks (rad/s): magnitude of each component of a free base's rotation vector and angular velocity;
    attitude_at_end: rad. base_load_peaks: magnitude of force
    and torque on the base, by unit. torque_peaks: magnitudes, by component and signal.
    force_extremes: lowest and highest sample of the forces, as what goes slack or lifts off has a kink there.
    limits: requirements on these numbers, as they are written.
    unlatchings: lines whose latches let go; latch times, rates and energies are those of their first latch-up.
    slack: strands of cables without tension, and from when to when.
    motor_energy: released by motors and put in by drives up to the last latch-up; supplied_energy: put in by loads and
    by what moves by a law up to the end. energy_exchanged,
    numerical_dissipation and energy_residual (largest, over energy_exchanged; None where there is none): see
    `energy_ledger`. energy_messages: warnings about their balance. tolerance: requested; refined_tolerance: that of a
    repetition; None without. fixed_step: whether steps do not follow from it. estimated_errors: see `Result`.
    """

    complete: bool
    end_time: float
    latch_times: Mapping[str, float]
    unlatched_angles: Mapping[str, float]
    overruns: Mapping[str, Overrun]
    latch_torque_peaks: Mapping[str, float]
    latch_impulses: Mapping[str, float]
    interface_force_peaks: tuple[float, ...]
    interface_torque_peaks: tuple[float, ...]
    torque_peaks: Mapping[str, Mapping[str, float]]
    force_extremes: Mapping[str, Mapping[str, tuple[float, float]]]
    motor_energy: float
    supplied_energy: float
    energy_exchanged: float
    numerical_dissipation: float
    energy_residual: float | None
    energy_messages: tuple[str, ...] = ()
    tolerance: float | None = None
    refined_tolerance: float | None = None
    fixed_step: bool = False
    estimated_errors: Mapping[Key, float] | None = None
    short_of_deployed: Mapping[str, ShortOf] = field(default_factory=dict)
    motors_short: tuple[str, ...] = ()
    short_of_stops: Mapping[str, ShortOf] = field(default_factory=dict)
    port_force_peaks: Mapping[str, float] = field(default_factory=dict)
    port_torque_peaks: Mapping[str, float] = field(default_factory=dict)
    hinge_force_peaks: Mapping[str, float] = field(default_factory=dict)
    hinge_torque_peaks: Mapping[str, float] = field(default_factory=dict)
    attitude_peaks: tuple[float, ...] = ()
    attitude_at_end: tuple[float, ...] = ()
    attitude_rate_peaks: tuple[float, ...] = ()
    not_opened: Mapping[str, NotOpened] = field(default_factory=dict)
    reached_stops: Mapping[str, float] = field(default_factory=dict)
    base_load_peaks: Mapping[str, float] = field(default_factory=dict)
    latch_rates: Mapping[str, float] = field(default_factory=dict)
    latch_energies: Mapping[str, float] = field(default_factory=dict)
    slack: tuple[Slack, ...] = ()
    limits: tuple[str, ...] = ()
    unlatchings: Mapping[str, Unlatching] = field(default_factory=dict)

    @property
    def requirements(self) -> tuple[Judged, ...]:
        """Every requirement on each number that it is about."""
        return judged(self.limits, list(self.numbers()), list(self.unlatched_angles)) if self.limits else ()

    @property
    def verdict(self) -> str:
        """What became of the deployment, in a few sentences."""
        sentences = [
            lines_sentence(
                self.latch_times, self.reached_stops, self.not_opened, self.complete, self.end_time
            ),
            *unlatched_sentences(self.unlatchings),
        ]
        torques = {x: torque for x, torque in self.latch_torque_peaks.items() if x not in self.latch_impulses}
        if torques:
            line = max(torques, key=lambda name: torques[name])
            sentences.append(f"Highest latch torque {torques[line]:.4g} N.m ({line}).")
        if any(self.base_load_peaks.values()):
            loads = ", ".join(f"{peak:.4g} {unit}" for unit, peak in self.base_load_peaks.items())
            sentences.append(f"Largest load on the spacecraft {loads}.")
        if self.limits:
            sentences.append(requirements_sentence(self.requirements))
        return " ".join(sentences)

    def as_dict(self) -> dict[str, Any]:
        """Plain dictionaries, tuples and numbers, ready for JSON.

        numbers: value, unit and estimated error of every headline number, by its identifier.
        """
        found = {"verdict": self.verdict, **asdict(self), "warnings": self.warnings}
        for name in (
            "estimated_errors",
            "energy_messages",
            "tolerance",
            "refined_tolerance",
            "fixed_step",
            "limits",
        ):
            del found[name]
        found["requirements"] = [asdict(one) | {"state": one.state} for one in self.requirements]
        return {**found, "numbers": {number.id: number.as_dict() for number in self.numbers()}}

    @property
    def messages(self) -> tuple[str, ...]:
        """Warnings and notes about numbers that are less accurate than the tolerance promises."""
        if self.estimated_errors is None:
            return self.energy_messages
        if not self.estimated_errors:
            return (*self.energy_messages, ERRORS_UNKNOWN)
        numbers = [(number.key, number.value) for number in self._bare_numbers()]
        of_errors = error_messages(
            numbers,
            self.estimated_errors,
            self.tolerance,
            self.refined_tolerance,
            fixed_step=self.fixed_step,
        )
        return (*self.energy_messages, *of_errors)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Messages on numbers that are less accurate than an engineer expects."""
        return tuple(one for one in self.messages if not is_note(one))

    def numbers(self) -> Iterator[Number]:
        """Every number in a row of its own, with its estimated error where there is one."""
        errors = self.estimated_errors or {}
        for number in self._bare_numbers():
            error = errors.get(number.key, inf)
            yield number._replace(error=error if isfinite(error) else None)

    def _bare_numbers(self) -> Iterator[Number]:
        yield Number("end time", "", self.end_time, "s")
        yield from self._numbers_of_lines()
        yield from self._numbers_of_base()
        yield from self._numbers_of_loads()
        yield Number("motor work", "", self.motor_energy, "J")
        if self.supplied_energy:
            yield Number("external work", "", self.supplied_energy, "J")
        if self.energy_residual is not None:
            yield Number("energy exchanged", "", self.energy_exchanged, "J")
            yield Number("numerical energy loss", "", self.numerical_dissipation, "J")
            yield Number("energy residual", "", self.energy_residual, "1")

    def _numbers_of_lines(self) -> Iterator[Number]:
        for line, time in self.latch_times.items():
            yield Number("latch time", line, time, "s")
        for line, rate in self.latch_rates.items():
            yield Number("latch rate", line, rate, "rad/s")
        for line, energy in self.latch_energies.items():
            yield Number("latch energy", line, energy, "J")
        for line, angle in self.unlatched_angles.items():
            yield Number(UNLATCHED, line, angle, "rad")
        yield from self._numbers_of_unlatchings()
        for line, passed in self.overruns.items():
            yield Number("largest angle, no latch", line, passed.largest, "rad")
        for line, short in self.short_of_deployed.items():
            yield Number("final angle, no latch", line, short.last, "rad")
        for line, impulse in self.latch_impulses.items():
            yield Number("latch impulse", line, impulse, "N.m.s")
        for line, torque in self.latch_torque_peaks.items():
            of_what = "lock" if line in self.latch_impulses else "latch"
            yield Number(f"{of_what} torque peak", line, torque, "N.m")

    def _numbers_of_unlatchings(self) -> Iterator[Number]:
        for line, one in self.unlatchings.items():
            yield Number("unlatch time", line, one.time, "s")
            if one.again is None:
                yield Number(FINAL_UNLATCHED, line, one.angle, "rad")
            else:
                yield Number("last latch time", line, one.again, "s")

    def _numbers_of_base(self) -> Iterator[Number]:
        vectors = (
            ("attitude peak", self.attitude_peaks, "rad"),
            ("final attitude", self.attitude_at_end, "rad"),
            ("attitude rate peak", self.attitude_rate_peaks, "rad/s"),
            ("interface force peak", self.interface_force_peaks, "N"),
            ("interface torque peak", self.interface_torque_peaks, "N.m"),
        )
        for quantity, values, unit in vectors:
            yield from (Number(quantity, axis, v, unit) for axis, v in zip("xyz", values, strict=False))
            if values and unit in self.base_load_peaks:
                yield Number(magnitude_of(quantity), "", self.base_load_peaks[unit], unit)
        for quantity, peaks in _point_peaks(self):
            unit = "N" if "force" in quantity else "N.m"
            yield from (Number(quantity, point, load, unit) for point, load in peaks.items())

    def torque_numbers(self) -> Iterator[Number]:
        """Peaks of the torques of single parts, such as dampers and stops, without their errors."""
        for name, torques in self.torque_peaks.items():
            for variable, torque in torques.items():
                yield Number(peak_of(variable), name, torque, "N.m")

    def _numbers_of_loads(self) -> Iterator[Number]:
        yield from self.torque_numbers()
        for name, forces in self.force_extremes.items():
            for variable, (low, high) in forces.items():
                yield Number(min_of(variable), name, low, "N")
                yield Number(max_of(variable), name, high, "N")


def headline(result: Result) -> Headline:
    """Headline numbers of a result; what a scene does not have is left empty."""
    times = latch_times(result)
    torques = {
        line.name: peak(result, line_latch_torque(result, line))
        for line in result.hinge_lines
        if line.name in times
    }
    last = max(times.values(), default=float(result.time[-1]))
    ledger, at_points = energy_ledger(result), _peaks_at_points(result)
    bent, unlatched, stops = (
        folded(result),
        unlatched_angles(result, times),
        short_of_stops(result),
    )
    short = short_of_deployed(result) | bent
    motors_short = tuple(
        x.name for x in result.hinge_lines if x.name in bent or (x.name in short and has_motor(result, x))
    )
    rates, impulses = latch_rates(result, times), latch_impulses(result, times)
    return Headline(
        complete=result.complete,
        end_time=float(result.time[-1]),
        latch_times=times,
        unlatched_angles=unlatched,
        not_opened=not_opened(result, _missing(unlatched, {x: short[x] for x in motors_short}, stops)),
        overruns=overruns(result),
        short_of_deployed=short,
        motors_short=motors_short,
        short_of_stops=stops,
        reached_stops=reached_stops(result),
        latch_torque_peaks={name: abs(torque.value) for name, torque in torques.items()},
        latch_impulses=impulses,
        latch_rates=rates,
        latch_energies=latch_energies(result, times, rates, impulses),
        slack=slack_strands(result),
        unlatchings=unlatchings(result),
        interface_force_peaks=_component_peaks(result, INTERFACE_LOAD, "N"),
        interface_torque_peaks=_component_peaks(result, INTERFACE_LOAD, "N.m"),
        base_load_peaks={unit: _magnitude_peak(result, INTERFACE_LOAD, unit) for unit in ("N", "N.m")},
        port_force_peaks=at_points["attachment force peak"],
        port_torque_peaks=at_points["attachment torque peak"],
        hinge_force_peaks=at_points["hinge force peak"],
        hinge_torque_peaks=at_points["hinge torque peak"],
        attitude_peaks=_component_peaks(result, ATTITUDE, "rad"),
        attitude_at_end=_last(result, ATTITUDE, "rad"),
        attitude_rate_peaks=_component_peaks(result, ATTITUDE, "rad/s"),
        torque_peaks=_by_component(
            (name, label, abs(peak(result, torque).value)) for name, label, torque in loads(result, "N.m")
        ),
        force_extremes=_by_component(
            (name, label, (float(force.min()), float(force.max())))
            for name, label, force in loads(result, "N")
        ),
        motor_energy=_motor_energy(result, last),
        supplied_energy=_supplied_energy(result, float(result.time[-1])),
        energy_exchanged=ledger.exchanged if ledger else 0.0,
        numerical_dissipation=ledger.numerical if ledger else 0.0,
        energy_residual=ledger.relative_residual if ledger else None,
        energy_messages=ledger.warnings() if ledger else (),
        tolerance=tolerance_asked(result),
        refined_tolerance=tolerance_taken(result),
        fixed_step="step" in result.provenance,
        estimated_errors=result.estimated_errors,
        limits=limits_of(result.provenance.get("scene_tree", "{}")),
    )


def magnitude_of(load: str) -> str:
    """What the headline calls the peak of a vector's magnitude."""
    return load.replace(" peak", " magnitude peak")


def _missing(
    unlatched: Iterable[str], short: Mapping[str, ShortOf], stops: Mapping[str, ShortOf]
) -> dict[str, str]:
    """What lines have not done that they should have."""
    missing = dict.fromkeys(unlatched, "has not latched")
    for end, lines in (("deployed angle of", short), ("end stop at", stops)):
        for name, one in lines.items():
            done = "stayed at" if one.largest > one.angle else "come to"
            missing[name] = f"has not {done} its {end} {degrees(one.angle):.4g} deg"
    return missing


_OF_THE_RUN = {
    "interface force magnitude peak": "magnitude",
    "interface torque magnitude peak": "magnitude",
    "external work": "loads and motion laws, whole run",
    "numerical energy loss": "whole run",
    "energy residual": "relative to energy exchanged",
}
"""Column "of" for numbers of the whole run."""


def headline_rows(found: Headline) -> Iterator[tuple[str, str, str, str, str]]:
    """Quantity, of, value, unit and estimated error of every headline number as texts.

    Round-off relative to the largest component of a load reads 0; forces that are zero are omitted.
    """
    floors = round_off_floors(found)
    absent = {
        (extreme(variable), name)
        for name, forces in found.force_extremes.items()
        for variable, (low, high) in forces.items()
        for extreme in (min_of, max_of)
        if max(abs(low), abs(high)) <= floors[name]
    }
    for number in found.numbers():
        of, floor = number.of, floors.get(number.quantity, floors.get(number.of, 0.0))
        if (number.quantity, of) in absent or (number.quantity in POINT_PEAKS and number.value <= floor):
            continue
        if number.quantity == "motor work":
            of = "until last latch-up" if found.latch_times else "whole run"
        of = _OF_THE_RUN.get(number.quantity, of)
        unit, size = shown(number.unit)
        digits = ".6f" if unit == "s" else ".5g"
        value = format(size * rounded_to_floor(number.value, floor), digits)
        error = "" if number.error is None else format(size * number.error, ".1g")
        yield quantity_text(number.quantity), of, value, unit, error


def quantity_text(quantity: str) -> str:
    """A quantity for tables, where magnitudes of vectors need not be named as such."""
    return quantity.replace(" magnitude", "")


def round_off_floors(found: Headline) -> dict[str, float]:
    """Magnitudes of round-off: of loads at the base and at points by quantity, of forces by component."""
    beside = round_off_of_loads((number.key, number.value) for number in found.numbers())

    def floor(peaks: Collection[float]) -> float:
        return beside if max(peaks, default=0.0) <= beside else noise_floor(peaks)

    forces, torques = floor(found.interface_force_peaks), floor(found.interface_torque_peaks)
    return {
        "interface force peak": forces,
        "interface force magnitude peak": forces,
        "interface torque peak": torques,
        "interface torque magnitude peak": torques,
        "attitude peak": noise_floor(found.attitude_peaks),
        "final attitude": noise_floor(found.attitude_peaks),
        "attitude rate peak": noise_floor(found.attitude_rate_peaks),
        **{quantity: floor(peaks.values()) for quantity, peaks in _point_peaks(found)},
        **{
            name: noise_floor(force for extremes in forces.values() for force in extremes)
            for name, forces in found.force_extremes.items()
        },
    }


def latch_times(result: Result) -> dict[str, float]:
    """Time of latch-up of each hinge line (s)."""
    found: dict[str, float] = {}
    for line in result.hinge_lines:
        times = [time for time, _, text in result.events if text == line.latch_event]
        if times:
            found[line.name] = min(times)
    return found


def line_latch_torque(result: Result, line: HingeLine) -> Vector:
    """Sum of the latch torques of a line's hinges (N.m)."""
    torque = np.zeros(result.time.size)
    for hinge in line.hinges:
        if result.has(hinge, "latch_torque"):
            torque += result.signal(hinge, "latch_torque")
    return torque


def _vectors(result: Result, role: str, unit: str) -> dict[str, Vector]:
    """Signals (N, 3) in a role and a unit, by variable."""
    return {of[1]: result.signal(*of) for of in result.in_role(role) if result.unit(*of) == unit}


def _component_peaks(result: Result, role: str, unit: str) -> tuple[float, ...]:
    """Peak magnitudes of the components of a base's vector."""
    found = _vectors(result, role, unit).values()
    return tuple(abs(peak(result, vector[:, axis]).value) for vector in found for axis in range(3))


def _magnitude_peak(result: Result, role: str, unit: str) -> float:
    """Peak magnitude of a base's vector; zero where it has none."""
    vectors = _vectors(result, role, unit).values()
    return max((peak(result, np.linalg.norm(vector, axis=1)).value for vector in vectors), default=0.0)


def _last(result: Result, role: str, unit: str) -> tuple[float, ...]:
    """Components of a base's vector at the end."""
    return tuple(float(value) for vector in _vectors(result, role, unit).values() for value in vector[-1])


def _peaks_at_points(result: Result) -> dict[str, dict[str, float]]:
    """Peak magnitudes of loads at single points by headline number, then by point."""
    found: dict[str, dict[str, float]] = {quantity: {} for quantity in POINT_PEAKS}
    for (quantity, point), magnitude in point_loads(result):
        found[quantity][point] = peak(result, magnitude).value
    return found


def _point_peaks(found: Headline) -> Iterator[tuple[str, Mapping[str, float]]]:
    """Headline numbers of the loads at single points: what, and magnitudes by point."""
    of = (found.port_force_peaks, found.port_torque_peaks, found.hinge_force_peaks, found.hinge_torque_peaks)
    yield from zip(POINT_PEAKS, of, strict=True)


def peak_of(load: str) -> str:
    """Quantity of the peak magnitude of a load."""
    return f"{load_words(load)} peak"


def min_of(load: str) -> str:
    """Quantity of the minimum of a force."""
    return f"{load_words(load)} min"


def max_of(load: str) -> str:
    """Quantity of the maximum of a force."""
    return f"{load_words(load)} max"


def loads(result: Result, unit: str) -> Iterator[tuple[str, str, Vector]]:
    """Component, signal and values of every load of a unit; the axes of a vector are signals of their own."""
    for name, variable in result.in_role(LOAD):
        if result.unit(name, variable) != unit:
            continue
        values = result.signal(name, variable)
        if values.ndim == 1:
            yield name, variable, values
        else:
            yield from ((name, f"{variable}_{axis}", v) for axis, v in zip("xyz", values.T, strict=True))


def _by_component(found: Iterable[tuple[str, str, T]]) -> dict[str, dict[str, T]]:
    nested: dict[str, dict[str, T]] = {}
    for name, variable, value in found:
        nested.setdefault(name, {})[variable] = value
    return nested


def _motor_energy(result: Result, until: float) -> float:
    """Energy that all motors of hinges released and all drives supplied up to a time (J)."""
    given = [(name, "motor_energy") for name in result.recording("motor_energy")]
    given += [(name, SUPPLIED_ENERGY.name) for name in result.recording("drive_torque")]
    return float(sum(_given(result.time, result.signal(*one), until) for one in given))


def _supplied_energy(result: Result, until: float) -> float:
    """Energy that all else supplied up to a time (J): loads, and bodies and points that follow laws."""
    motors = {*result.recording("motor_energy"), *result.recording("drive_torque"), "scene"}
    others = [name for name in result.recording(SUPPLIED_ENERGY.name) if name not in motors]
    return float(
        sum(_given(result.time, result.signal(name, SUPPLIED_ENERGY.name), until) for name in others)
    )


def _given(time: Vector, energy: Vector, until: float) -> float:
    """Gain of an energy (J) due to motion up to a time, without jumps where an event changes a parameter."""
    gained = np.where(np.diff(time) > EVENT_WIDTH, np.diff(energy), 0.0)
    return float(np.interp(until, time, energy[0] + np.concatenate([[0.0], np.cumsum(gained)])))
