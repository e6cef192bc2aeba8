"""The short table of a run: its main numbers as texts, rounded to their estimated errors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import floor, log10
from typing import NamedTuple

from .estimated_errors import POINT_PEAKS
from .identifiers import load_words
from .key_figures import FINAL_UNLATCHED, Headline, magnitude_of, max_of, min_of, round_off_floors, shown
from .number import Number
from .requirements import Judged
from .round_off import rounded_to_floor

_DIGITS, _WITHOUT_ERROR = 8, 4
"""Largest number of significant digits, and that of numbers without an estimated error."""
_TENSION = "tension"
_MOST_SLACK = 2
"""Strands, those that are slack the longest."""


class LineRow(NamedTuple):
    """A hinge line: when it latched (s), with which rate (deg/s) and energy (J), impulse of a lock, peak torque."""

    line: str
    latched: str
    rate: str
    energy: str
    impulse: str
    torque: str


class ShortRow(NamedTuple):
    """A number: quantity, value, unit, and component or remark."""

    quantity: str
    value: str
    unit: str
    note: str


class RequirementRow(NamedTuple):
    """A requirement, the number that it is about, what is left up to the limit, and whether it is met."""

    requirement: str
    value: str
    margin: str
    state: str


REQUIREMENT_HEADINGS = RequirementRow("requirement", "value", "margin", "state")
LINE_HEADINGS = LineRow(
    "line", "latched at, s", "rate, deg/s", "energy, J", "impulse, N.m.s", "peak torque, N.m"
)


def rounded(value: float, error: float | None) -> str:
    """A number rounded to its estimated error, followed by ± and the error; without an error to four digits."""
    if not error:
        return f"{value:.{_WITHOUT_ERROR}g}"
    return f"{_to_error(value, error)} ± {float(f'{error:.1g}'):g}"


def _to_error(value: float, error: float | None) -> str:
    """A number rounded to an error, with eight digits at most."""
    if not error:
        return f"{value:.{_WITHOUT_ERROR}g}"
    decimals = -floor(log10(float(f"{error:.1g}")))
    if value:
        decimals = min(decimals, _DIGITS - 1 - floor(log10(abs(value))))
    return f"{round(value, decimals) + 0.0:.{max(decimals, 0)}f}"


def line_rows(found: Headline) -> list[LineRow]:
    """Every line with a latch; "-" for missing numbers."""
    numbers = {number.id: number for number in found.numbers()}

    def cell(quantity: str, line: str) -> str:
        if line in found.unlatched_angles and quantity == "latch_time":
            return "not latched"
        number = numbers.get(f"{quantity}.{line}")
        return "-" if number is None else rounded(*_as_shown(number))

    return [
        LineRow(
            line,
            *(
                cell(quantity, line)
                for quantity in (
                    "latch_time", "latch_rate", "latch_energy", "latch_impulse", "latch_torque_peak"
                )
            ),
        )
        for line in (*found.latch_times, *found.unlatched_angles)
    ]  # fmt: skip


def requirement_rows(found: Headline) -> list[RequirementRow]:
    """Every requirement on each number; "-" where the run has no such number."""
    return [
        RequirementRow(
            one.text,
            "-" if one.value is None else f"{rounded(one.value, one.error)}{_behind(one.unit)}",
            "-" if one.margin is None else _margin(one),
            one.state,
        )
        for one in found.requirements
    ]


def _margin(one: Judged) -> str:
    share = "" if one.share is None else f" ({100.0 * one.share:.3g} %)"
    return f"{_to_error(one.margin or 0.0, one.error)}{_behind(one.unit)}{share}"


def _behind(unit: str) -> str:
    return "" if unit == "1" else f" {unit}"


def short_rows(found: Headline) -> Iterator[ShortRow]:
    """Loads on the spacecraft, attitude, extremes of dampers, cables and other parts, energies."""
    numbers = list(found.numbers())
    floors = round_off_floors(found)
    has_lines = bool(found.latch_times or found.unlatched_angles or found.reached_stops)
    if not has_lines:
        yield ShortRow("end time", f"{found.end_time:g}", "s", "")
    for number in numbers:
        if number.quantity in ("unlatch time", "last latch time", FINAL_UNLATCHED):
            yield ShortRow(number.quantity, rounded(*_as_shown(number)), shown(number.unit)[0], number.of)
    for line, time in found.reached_stops.items():
        yield ShortRow("end stop reached", rounded(time, None), "s", line)
    for name, load in (
        ("spacecraft force", "interface force peak"),
        ("spacecraft torque", "interface torque peak"),
    ):
        yield from _vector(f"{name} peak", load, numbers, floors)
    yield from _vector("attitude peak", "attitude peak", numbers, floors)
    for quantity in dict.fromkeys(n.quantity for n in numbers if n.quantity in _largest_of(found, has_lines)):
        yield from _largest(quantity, [n for n in numbers if n.quantity == quantity], floors)
    yield from _forces(found, numbers, floors)
    for number in numbers:
        if number.quantity in ("motor work", "external work") and number.value:
            yield ShortRow(number.quantity, rounded(number.value, number.error), number.unit, "")
    if found.energy_residual is not None:
        yield ShortRow("energy residual", f"{found.energy_residual:.1g}", "", "of the energy exchanged")


def _as_shown(number: Number) -> tuple[float, float | None]:
    """Value and error in the unit of tables."""
    factor = shown(number.unit)[1]
    return factor * number.value, None if number.error is None else factor * number.error


def _vector(
    name: str, load: str, numbers: Sequence[Number], floors: Mapping[str, float]
) -> Iterator[ShortRow]:
    """Peak of a vector's magnitude if it has one, and peaks of its components; no row if all are round-off."""
    parts = [n for n in numbers if n.quantity == load]
    if not any(rounded_to_floor(n.value, floors[load]) for n in parts):
        return
    magnitude = next((n for n in numbers if n.quantity == magnitude_of(load)), None)
    unit, factor = shown(parts[0].unit)
    of_whole = (magnitude and magnitude.error) or 0.0
    texts = []
    for n in parts:
        value, error = rounded_to_floor(n.value, floors[load]), max(n.error or 0.0, of_whole)
        texts.append(f"{n.of} {_to_error(factor * value, factor * error) if value else '0'}")
    of_parts = ", ".join(texts)
    if magnitude is None:
        yield ShortRow(name, of_parts, unit, "")
    else:
        yield ShortRow(name, rounded(*_as_shown(magnitude)), unit, of_parts)


def _largest_of(found: Headline, has_lines: bool) -> set[str]:
    """Quantities of which the largest number is shown: torques of parts, and without hinge lines loads at points."""
    torques = {n.quantity for n in found.torque_numbers()}
    return torques if has_lines else torques.union(POINT_PEAKS)


def _largest(quantity: str, numbers: Sequence[Number], floors: Mapping[str, float]) -> Iterator[ShortRow]:
    top = max(numbers, key=lambda n: n.value)
    if top.value > floors.get(quantity, 0.0):
        yield ShortRow(quantity, rounded(*_as_shown(top)), top.unit, top.of)


def _forces(found: Headline, numbers: Sequence[Number], floors: Mapping[str, float]) -> Iterator[ShortRow]:
    """Minimum and maximum of each kind of force over all parts, of cables over their strands; slack times."""
    groups: dict[str, list[tuple[str, str, str]]] = {}
    for name, forces in found.force_extremes.items():
        strands = [variable for variable in forces if variable.startswith(_TENSION)]
        for variable in strands or forces:
            low, high = forces[variable]
            if max(abs(low), abs(high)) > floors[name]:
                kind = f"cable {_TENSION}" if strands and variable != _TENSION else load_words(variable)
                label = _strand(name, variable) if strands else name
                groups.setdefault(kind, []).append((name, label, variable))
    by_key = {n.key: n for n in numbers}
    for kind, members in groups.items():
        ends = []
        for extreme, choose in ((min_of, min), (max_of, max)):
            value_of = {label: by_key[extreme(variable), name] for name, label, variable in members}
            label = choose(value_of, key=lambda one: value_of[one].value)
            ends.append((rounded(value_of[label].value, value_of[label].error), label))
        (lowest, of_low), (highest, of_high) = ends
        note = of_low if of_low == of_high else f"{of_low} / {of_high}"
        yield ShortRow(f"{kind} min/max", f"{lowest} / {highest}", "N", note)
    for one in sorted(found.slack, key=lambda one: one.start - one.end)[:_MOST_SLACK]:
        of = _strand(one.component, one.strand)
        yield ShortRow("slack", f"{one.start:.3g} s to {one.end:.3g} s", "", of)


def _strand(component: str, variable: str) -> str:
    """Name of a strand by the variable of its tension, such as "loop A"; the component alone if it has one strand."""
    strand = variable.removeprefix(_TENSION).strip("_").upper()
    return f"{component} {strand}".strip()
