"""Comparison of two results: latch events, peaks with ratios and time shifts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from operator import attrgetter
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from components.contract.roles import ATTITUDE, INTERFACE_LOAD, LOAD

from ..records import short_repr
from .crests import Peak
from .energy_ledger import tolerance_asked
from .estimated_errors import POINT_PEAKS
from .identifiers import identifier
from .key_figures import latch_times, line_latch_torque, peak_of, shown
from .latch_impulse import latch_impulses
from .latch_rate import latch_energies, latch_rates
from .peaks import peak
from .point_loads import point_loads
from .result import Result
from .round_off import NOISE, noise_floor, rounded_to_floor

Vector = NDArray[np.float64]
T = TypeVar("T")

_LARGE_RATIO = 1e3
_LATCH_UP = "latch-up"
_SAME_END = 1e-9  # of the end: what summing steps leaves


@dataclass(frozen=True)
class Compared:
    """One quantity of two results: peak magnitudes and their times (s), None if a result lacks them.

    A latch event has no magnitude. noise_a, noise_b: the peak is round-off relative to other loads of the component.
    is_small: it is below the tolerance relative to the largest of them in either result, so a ratio means nothing.
    """

    quantity: str
    of: str
    unit: str
    a: float | None
    b: float | None
    time_a: float | None
    time_b: float | None
    noise_a: bool = False
    noise_b: bool = False
    is_small: bool = False

    @property
    def id(self) -> str:
        """Identifier of the headline number; loads of a base by their axis."""
        if self.quantity == _LATCH_UP:
            return identifier("latch time", self.of)
        return identifier(self.quantity, self.of.rpartition(" ")[2])

    @property
    def ratio(self) -> float | None:
        """B over A; None if either is missing, round-off or small, or A is zero."""
        return self.b / self.a if self.a and self.b is not None and not self._says_nothing else None

    @property
    def shift(self) -> float | None:
        """Time of B minus time of A (s); None if either is missing, round-off or small."""
        if self.time_a is None or self.time_b is None or self._says_nothing:
            return None
        return self.time_b - self.time_a

    @property
    def _says_nothing(self) -> bool:
        return self.noise_a or self.noise_b or self.is_small

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers, for JSON."""
        return {"id": self.id, **asdict(self), "ratio": self.ratio, "shift": self.shift}


@short_repr
@dataclass(frozen=True)
class Comparison:
    """Compared quantities of two results, and the signals ("component.variable") that only one of them has."""

    rows: tuple[Compared, ...]
    only_a: tuple[str, ...]
    only_b: tuple[str, ...]


def compare(a: Result, b: Result) -> Comparison:
    """Latch events, rates, energies and torques by hinge line, then peaks of attitude and loads by component and point.

    Quantities that are zero or round-off in both are omitted.
    """
    every = [*_load_rows(a, b), *_point_rows(a, b)]
    loads = (row for row in _with_noise(every, _tolerance(a, b)) if not _is_nothing(row))
    rows = [*_latch_rows(a, b), *_rate_rows(a, b), *_torque_rows(a, b), *loads]
    order = list(dict.fromkeys(row.quantity for row in rows))
    rows.sort(key=lambda row: order.index(row.quantity))
    return Comparison(tuple(rows), _only_in(a, b), _only_in(b, a))


def labels(a: Result, b: Result) -> tuple[str, str]:
    """Short names of two results that differ."""
    stems = [result.name if result.path is None else result.path.stem for result in (a, b)]
    if stems[0] != stems[1]:
        return stems[0], stems[1]
    return (a.name, b.name) if a.name != b.name else (f"A {stems[0]}", f"B {stems[1]}")


def in_either(first: Sequence[T], second: Sequence[T]) -> list[T]:
    """Names of both, in order, each once."""
    return list(dict.fromkeys((*first, *second)))


def loads(a: Result, b: Result) -> list[tuple[str, str]]:
    """Components and variables of attitude and loads of either result, those of the spacecraft first."""
    roles = (ATTITUDE, INTERFACE_LOAD, LOAD)
    return in_either(*(tuple(of for role in roles for of in result.in_role(role)) for result in (a, b)))


def _latch_rows(a: Result, b: Result) -> Iterator[Compared]:
    times_a, times_b = latch_times(a), latch_times(b)
    for line in in_either(tuple(times_a), tuple(times_b)):
        yield Compared(_LATCH_UP, line, "s", None, None, times_a.get(line), times_b.get(line))


def _rate_rows(a: Result, b: Result) -> Iterator[Compared]:
    """Rates at latch-up and the energies that latches take up."""
    found: list[tuple[dict[str, float], dict[str, float]]] = []
    for result in (a, b):
        times = latch_times(result)
        rates = latch_rates(result, times)
        found.append((rates, latch_energies(result, times, rates, latch_impulses(result, times))))
    for quantity, unit, values in zip(
        ("latch rate", "latch energy"), ("rad/s", "J"), zip(*found, strict=True), strict=True
    ):
        for line in in_either(*(tuple(one) for one in values)):
            yield Compared(quantity, line, unit, values[0].get(line), values[1].get(line), None, None)


def _torque_rows(a: Result, b: Result) -> Iterator[Compared]:
    def line_peak(result: Result, name: str) -> Peak | None:
        if name not in latch_times(result):
            return None
        line = next(line for line in result.hinge_lines if line.name == name)
        return peak(result, line_latch_torque(result, line))

    for name in in_either(tuple(latch_times(a)), tuple(latch_times(b))):
        yield _compared("latch torque peak", name, "N.m", line_peak(a, name), line_peak(b, name))


def _load_rows(a: Result, b: Result) -> Iterator[Compared]:
    for name, variable in loads(a, b):
        known = a if a.has(name, variable) else b
        columns = known.signal(name, variable).reshape(known.time.size, -1).shape[1]
        for k in range(columns):
            of = f"{name} {'xyz'[k]}" if columns == 3 else name
            peaks = [_peak_of(result, name, variable, k) for result in (a, b)]
            yield _compared(peak_of(variable), of, known.unit(name, variable), *peaks)


def _point_rows(a: Result, b: Result) -> Iterator[Compared]:
    """Magnitudes of the loads at single ports of the spacecraft and at hinges between bodies."""
    found = [dict(point_loads(result)) for result in (a, b)]
    for quantity in POINT_PEAKS:
        names = (tuple(point for what, point in magnitudes if what == quantity) for magnitudes in found)
        for key in ((quantity, point) for point in in_either(*names)):
            peaks = [
                peak(result, magnitudes[key]) if key in magnitudes else None
                for result, magnitudes in zip((a, b), found, strict=True)
            ]
            yield _compared(*key, "N" if "force" in quantity else "N.m", *peaks)


def _tolerance(a: Result, b: Result) -> float:
    """The larger tolerance of both results, 0 if none is recorded."""
    return max((tolerance_asked(result) or 0.0 for result in (a, b)), default=0.0)


def _with_noise(rows: Sequence[Compared], tolerance: float) -> Iterator[Compared]:
    """The rows, with marks for round-off and for values below a tolerance.

    Both are relative to all rows of the same component, or of all points, and the same unit in the same result.
    """

    def group(row: Compared) -> tuple[str, str]:
        return row.quantity if row.quantity in POINT_PEAKS else row.of.partition(" ")[0], row.unit

    floors = {
        key: [
            noise_floor(value for row in rows if group(row) == key and (value := values(row)) is not None)
            for values in (attrgetter("a"), attrgetter("b"))
        ]
        for key in {group(row) for row in rows}
    }
    for row in rows:
        floor_a, floor_b = floors[group(row)]
        small = any(
            bool(value) and abs(value or 0.0) < tolerance / NOISE * floor
            for value, floor in ((row.a, floor_a), (row.b, floor_b))
        )
        yield replace(
            row, noise_a=_is_noise(row.a, floor_a), noise_b=_is_noise(row.b, floor_b), is_small=small
        )


def _is_noise(value: float | None, floor: float) -> bool:
    return bool(value) and rounded_to_floor(value or 0.0, floor) == 0.0


def _is_nothing(row: Compared) -> bool:
    """Whether neither result has more than round-off."""
    return (not row.a or row.noise_a) and (not row.b or row.noise_b)


def _peak_of(result: Result, name: str, variable: str, column: int) -> Peak | None:
    if not result.has(name, variable):
        return None
    return peak(result, result.signal(name, variable).reshape(result.time.size, -1)[:, column])


def _compared(quantity: str, of: str, unit: str, a: Peak | None, b: Peak | None) -> Compared:
    values = [None if p is None else abs(p.value) for p in (a, b)]
    times = [None if p is None else p.time for p in (a, b)]
    return Compared(quantity, of, unit, values[0], values[1], times[0], times[1])


def _only_in(result: Result, other: Result) -> tuple[str, ...]:
    return tuple(
        f"{name}.{variable}"
        for name in result.components
        for variable in result.variables(name)
        if not other.has(name, variable)
    )


def cells(row: Compared) -> tuple[str, ...]:
    """A, B, ratio, time of A, time of B, shift and unit of a row as texts; empty if missing.

    A and B of a latch event are its times.
    """
    unit, factor = shown(row.unit)
    if row.a is None and row.b is None:
        return _text(row.time_a, ".5f"), _text(row.time_b, ".5f"), "", "", "", _text(row.shift, "+.5f"), unit
    a, b = (None if value is None else factor * value for value in (row.a, row.b))
    return (
        "noise" if row.noise_a else _text(a, ".5g"),
        "noise" if row.noise_b else _text(b, ".5g"),
        "-" if row.is_small else _text(row.ratio, ".4f" if abs(row.ratio or 0.0) < _LARGE_RATIO else ".4g"),
        "" if row.noise_a else _text(row.time_a, ".4f"),
        "" if row.noise_b else _text(row.time_b, ".4f"),
        "-" if row.is_small else _text(row.shift, "+.4f"),
        unit,
    )


def _text(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)


def end_note(a: Result, b: Result, names: tuple[str, str]) -> str:
    """A sentence where two results end at different times; empty where they do not."""
    ends = float(a.time[-1]), float(b.time[-1])
    if abs(ends[1] - ends[0]) <= _SAME_END * max(ends):
        return ""
    return (
        f"The runs differ in length: {names[0]} ends at {ends[0]:.6g} s, {names[1]} at {ends[1]:.6g} s. Peaks after "
        "the shorter run are in one result only."
    )


def by_component(signals: Sequence[str]) -> dict[str, list[str]]:
    """Variables by component, of signals named "component.variable"."""
    found: dict[str, list[str]] = {}
    for signal in signals:
        component, _, variable = signal.partition(".")
        found.setdefault(component, []).append(variable)
    return found
