"""What a scene is to be tuned to: headline numbers, and measured curves of signals."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import SequenceMatcher
from math import isfinite, sqrt
from pathlib import Path

import numpy as np

from components.contract.component import Vector
from components.contract.errors import unknown

from ...cosim.rows import recorded_layout
from ...results.identifiers import OF_A_LATCH_UP, identifier, in_order, unit_of
from ...results.key_figures import UNLATCHED
from ...scene.units import UNITS, in_unit
from .distributions import StudyError
from .sample import Sample, Task

_HEADING = re.compile(r"\s*(.*?)\s*(?:\(([^()]*)\)\s*)?", re.DOTALL)
"""A name, and the unit behind it."""
_MISSED = 1.0
"""What a number counts as missed by, relative to its target, where a run does not have it: a line has not latched."""


@dataclass(frozen=True, slots=True)
class Target:
    """A headline number, by its identifier, and what it is to be, in its unit or with one."""

    number: str
    wanted: float | str

    def value(self, unit: str) -> float:
        """What is wanted, in the unit that the number is told in; StudyError where that cannot be."""
        try:
            return in_unit(self.wanted, unit)
        except ValueError as error:
            raise StudyError(f"target {self.number}: {error}") from None

    def off(self, sample: Sample) -> float:
        """Difference over what is wanted, or plain where that is zero."""
        if self.number not in sample.numbers:
            return _MISSED
        found, unit, _ = sample.numbers[self.number]
        wanted = self.value(unit)
        return (found - wanted) / (abs(wanted) or 1.0)


def target(text: str) -> Target:
    """What NUMBER=VALUE means, such as "latch_time.HL1=11.6 s"; StudyError where it means nothing.

    `HL1.latch_time` is the same number.
    """
    name, equals, wanted = text.partition("=")
    if not equals or not name.strip() or not wanted.strip():
        raise StudyError(f"{text!r} is not of the form NUMBER=VALUE, such as latch_time.HL1=11.6")
    return Target(in_order(name.strip()), wanted.strip())


@dataclass(frozen=True, slots=True)
class Curve:
    """A signal COMPONENT.VARIABLE, with [1] for the first of several, as measured at times (s); see `of_sensors`.

    unit: of the values, empty for that of the signal.
    """

    signal: str
    times: tuple[float, ...]
    values: tuple[float, ...]
    unit: str = ""

    @property
    def pattern(self) -> str:
        """What a sample keeps for it."""
        return self.signal.partition("[")[0]

    def off(self, sample: Sample) -> Vector:
        """Differences (N,) over the measured range, such that a curve weighs as much as a number.

        The sample kept its signals at the measured times.
        """
        values, unit = sample.signals[self.signal]
        measured = self.factor(unit) * np.array(self.values)
        size = float(np.ptp(measured)) or 1.0
        found: Vector = (np.array(values) - measured) / (size * sqrt(len(self.times)))
        return found

    def factor(self, unit: str) -> float:
        """What makes values in a unit of the measured ones; StudyError where nothing does."""
        if self.unit in ("", unit):
            return 1.0
        if self.unit not in (known := UNITS.get(unit, {})):
            raise StudyError(
                f"curve {self.signal}: it is in {self.unit}; behind its name stands {' or '.join(known) or unit}, or "
                "nothing"
            )
        return known[self.unit]


def curves(path: Path) -> tuple[Curve, ...]:
    """Of a CSV file: times in the first column, others headed by their signals; StudyError for anything else.

    A unit may stand behind each heading, "time (ms)", "left.angle (deg)"; without, times are in s. All have the same
    times.
    """
    try:
        with path.open(encoding="utf-8", newline="") as file:
            rows = [row for row in csv.reader(file) if row]
    except (OSError, UnicodeDecodeError) as error:
        raise StudyError(f"{path}: cannot be read as a table of measured values ({error})") from None
    if len(rows) < 3 or len(rows[0]) < 2 or any(len(row) != len(rows[0]) for row in rows):
        raise StudyError(
            f"{path}: give a row of headings (time, COMPONENT.VARIABLE, ...), then two rows or more of as many numbers"
        )
    columns = [
        tuple(_number(cell, f"{path}, row {n}") for n, cell in enumerate(column, 2))
        for column in zip(*rows[1:], strict=True)
    ]
    head = [_HEADING.fullmatch(cell) for cell in rows[0]]
    names, units = zip(*((one[1], one[2] or "") for one in head if one), strict=True)
    if units[0] not in ("", *UNITS["s"]):
        raise StudyError(f"{path}: its times are in {units[0]}; give them in {' or '.join(UNITS['s'])}")
    times = tuple(time * UNITS["s"].get(units[0], 1.0) for time in columns[0])
    if not all(np.diff(times) > 0.0) or times[0] < 0.0:
        raise StudyError(f"{path}: its times must rise, from zero on")
    return tuple(
        Curve(name, times, values, unit)
        for name, values, unit in zip(names[1:], columns[1:], units[1:], strict=True)
    )


def of_sensors(measured: Iterable[Curve], sensors: Mapping[str, str]) -> tuple[Curve, ...]:
    """Curves; those that go by the name of a hinge line as those of its sensor."""
    parts = [(curve, *curve.signal.partition(".")[::2]) for curve in measured]
    return tuple(
        replace(curve, signal=f"{sensors[name]}.{rest}") if name in sensors else curve
        for curve, name, rest in parts
    )


def _number(text: str, where: str) -> float:
    try:
        found = float(text)
    except ValueError:
        found = float("nan")
    if not isfinite(found):
        raise StudyError(f"{where}: {text!r} is no finite number")
    return found


def refuse_unknown(targets: Sequence[Target], measured: Sequence[Curve], sample: Sample, task: Task) -> None:
    """StudyError for numbers and signals that a sample of a task does not have, and units that are not theirs."""
    problems = list(_unknown(targets, measured, sample, task))
    if problems:
        raise StudyError("\n".join(problems))
    for curve in measured:
        curve.factor(sample.signals[curve.signal][1])


def signals_of(task: Task) -> list[str]:
    """All that a run of it records, COMPONENT.VARIABLE."""
    layouts = (
        (part.name, recorded_layout(part.component().observation_layout))
        for part in task.options.assemble(task.scene.check_one_run()).parts
    )
    return [f"{name}.{scalar}" for name, layout in layouts for scalar in layout.scalar_names()]


def _nearest_order(text: str, names: Sequence[str]) -> str:
    """An unknown identifier with its parts in the order in which it resembles one of the names most."""
    first, _, last = text.rpartition(".")
    orders = (text, f"{last}.{first}")
    return max(orders, key=lambda one: max(SequenceMatcher(None, one, name).ratio() for name in names))


def _unknown(
    targets: Sequence[Target], measured: Sequence[Curve], sample: Sample, task: Task
) -> Iterator[str]:
    # what a line has of it once it latches
    missing = {
        f"{quantity}.{line}": (line, unit_of(quantity))
        for line in sample.opened
        for quantity in OF_A_LATCH_UP
        if identifier(UNLATCHED, line) in sample.numbers
    }
    for one in targets:
        line, unit = missing.get(one.number, ("", ""))
        if one.number in sample.numbers or line:
            wanted = one.value(unit or sample.numbers[one.number][1])
            if wanted < 0.0 and one.number.partition(".")[0] in OF_A_LATCH_UP:
                yield f"target {one.number}: is {one.wanted!r}; it is never negative"
        if line:
            yield (
                f"target {one.number}: {line} does not latch with the values that the search starts from; vary it from "
                "where it does"
            )
        elif one.number not in sample.numbers:
            names = [*sample.numbers, *missing]
            yield f"target {one.number}: {unknown(_nearest_order(one.number, names), names, 'number')}"
    for curve in measured:
        if curve.signal not in sample.signals:
            yield f"curve {curve.signal}: {unknown(curve.signal, signals_of(task), 'signal')}"
