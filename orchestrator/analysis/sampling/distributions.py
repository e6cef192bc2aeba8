"""Distributions of what a study varies, as people write them: "uniform(0.05, 0.2)", "normal(1.65 N.m, 3 %)"."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import exp, log1p, sqrt
from typing import Any

import numpy as np
import scipy

from components import FanfoldError
from components.contract.component import Vector

from ...scene.units import QUANTITY

_CALL = re.compile(r"\s*([A-Za-z_]+)\s*\((.*)\)\s*", re.DOTALL)
_SIGMAS = 3.0
"""Standard deviations to either side that corners and one-at-a-time studies of unbounded distributions go to."""


class StudyError(FanfoldError):
    """A study that cannot be made, with what is wrong and what to do."""


@dataclass(frozen=True, slots=True)
class Distribution:
    """Of one number, in the unit in which it was written; unit is "" for plain numbers, which scenes take as SI.

    text: as it was written. low, high: the range of worst cases, its bounds or three standard deviations from the
    mean. nominal: its median. levels: the values of a discrete one, in rising order, else none.
    """

    text: str
    unit: str
    quantile: Callable[[Vector], Vector]
    """values (N,) of probabilities (N,) between 0 and 1"""
    low: float
    high: float
    levels: tuple[float, ...] = ()

    @property
    def nominal(self) -> float:
        """Its median; of discrete values the middle one, or the one below the middle."""
        if self.levels:
            return float(self.quantile(np.array([0.5 - 1e-9]))[0])
        return float(self.quantile(np.array([0.5]))[0])

    def spread(self, count: int) -> Vector:
        """Levels of a grid: those of a discrete distribution, else so many from low to high at even distances."""
        return np.array(self.levels) if self.levels else np.linspace(self.low, self.high, count)


def distribution(text: str) -> Distribution:
    """What a text such as "uniform(1.6 N.m, 1.7 N.m)" means; StudyError with a sentence where it means none."""
    call = _CALL.fullmatch(text)
    if call is None or call[1] not in _MAKERS:
        raise StudyError(
            f"{text!r} is no distribution; give one of {', '.join(form for form, _ in FORMS.values())}"
        )
    numbers, unit = _numbers(text, call[2], call[1])
    maker, count = _MAKERS[call[1]]
    if count is not None and len(numbers) != count:
        raise StudyError(f"{text!r} has {len(numbers)} numbers; it is written {FORMS[call[1]][0]}")
    return maker(text, unit, numbers)


def _numbers(text: str, inside: str, kind: str) -> tuple[list[float], str]:
    """Numbers between commas and the unit of all of them; a deviation in % is converted to that unit."""
    numbers: list[float] = []
    units: set[str] = set()
    for part in inside.split(","):
        found = QUANTITY.fullmatch(part)
        if found is None or not np.isfinite(float(found[1])):
            raise StudyError(f"{text!r}: {part.strip()!r} is no finite number")
        number, unit = float(found[1]), found[2]
        if (
            len(numbers) == 1
            and unit == "%"
            and (kind == "lognormal" or (kind in _RELATIVE and units != {"%"}))
        ):
            numbers.append(0.01 * number * abs(numbers[0]))
            continue
        if len(numbers) == 1 and kind == "lognormal":
            raise StudyError(
                f"{text!r}: write the coefficient of variation in %; the form is {FORMS[kind][0]}"
            )
        numbers.append(number)
        units.add(unit)
    if len(units) > 1:
        raise StudyError(f"{text!r}: its numbers have different units; write all of them in one")
    return numbers, units.pop()


def _uniform(text: str, unit: str, numbers: Sequence[float]) -> Distribution:
    low, high = numbers
    _refuse(text, low < high, "the second number must be larger than the first")
    return _bounded(text, unit, scipy.stats.uniform(low, high - low), low, high)


def _triangular(text: str, unit: str, numbers: Sequence[float]) -> Distribution:
    low, mode, high = numbers
    _refuse(text, low <= mode <= high and low < high, "its numbers must rise: lowest, most likely, highest")
    found = scipy.stats.triang((mode - low) / (high - low), low, high - low)
    return _bounded(text, unit, found, low, high)


def _normal(text: str, unit: str, numbers: Sequence[float]) -> Distribution:
    mean, deviation = numbers
    _refuse(text, deviation > 0.0, "its standard deviation must be positive")
    edge = _SIGMAS * deviation
    return _bounded(text, unit, scipy.stats.norm(mean, deviation), mean - edge, mean + edge)


def _lognormal(text: str, unit: str, numbers: Sequence[float]) -> Distribution:
    mean, deviation = numbers
    _refuse(text, mean > 0.0 and deviation > 0.0, "its mean and coefficient of variation must be positive")
    shape = sqrt(log1p((deviation / mean) ** 2))  # standard deviation of the logarithm
    median, edge = mean * exp(-0.5 * shape**2), exp(_SIGMAS * shape)
    return _bounded(text, unit, scipy.stats.lognorm(shape, scale=median), median / edge, median * edge)


def _truncated(text: str, unit: str, numbers: Sequence[float]) -> Distribution:
    mean, deviation, low, high = numbers
    _refuse(text, deviation > 0.0, "its standard deviation must be positive")
    _refuse(text, low < high, "the last number must be larger than the one before")
    found = scipy.stats.truncnorm((low - mean) / deviation, (high - mean) / deviation, mean, deviation)
    return _bounded(text, unit, found, low, high)


def _values(text: str, unit: str, numbers: Sequence[float]) -> Distribution:
    drawn = np.array(sorted(numbers))  # one that stands there twice is drawn twice as often
    levels = np.unique(drawn)

    def quantile(probability: Vector) -> Vector:
        found: Vector = drawn[np.minimum((probability * len(drawn)).astype(int), len(drawn) - 1)]
        return found

    return Distribution(text, unit, quantile, levels[0], levels[-1], tuple(levels.tolist()))


def _bounded(text: str, unit: str, found: Any, low: float, high: float) -> Distribution:  # noqa: ANN401 - SciPy's
    return Distribution(text, unit, found.ppf, low, high)


def _refuse(text: str, holds: bool, sentence: str) -> None:
    if not holds:
        raise StudyError(f"{text!r}: {sentence}")


_Maker = Callable[[str, str, Sequence[float]], Distribution]
FORMS: Mapping[str, tuple[str, str]] = {
    "uniform": ("uniform(LOW, HIGH)", "every value from LOW to HIGH is equally likely"),
    "normal": (
        "normal(MEAN, DEVIATION)",
        "mean and standard deviation; the deviation may be in % of the mean: normal(1.65 N.m, 3 %)",
    ),
    "truncated_normal": (
        "truncated_normal(MEAN, DEVIATION, LOW, HIGH)",
        "normal between LOW and HIGH; mean and deviation are those before truncation",
    ),
    "lognormal": (
        "lognormal(MEAN, COV %)",
        "mean and coefficient of variation (standard deviation over mean): lognormal(0.15 N.m, 40 %) has a mean of "
        "0.15 N.m, a deviation of 0.06 N.m and a median of 0.139 N.m",
    ),
    "triangular": ("triangular(LOW, MODE, HIGH)", "MODE is the most likely value"),
    "values": ("values(A, B, ...)", "each value is equally likely; repeat one to weight it"),
}
"""How each distribution is written, and what its numbers mean."""
_RELATIVE = ("normal", "truncated_normal")
"""Whose deviation may be in % of the mean; a mean in % has its deviation in the same %."""
_MAKERS: Mapping[str, tuple[_Maker, int | None]] = {
    "uniform": (_uniform, 2),
    "normal": (_normal, 2),
    "truncated_normal": (_truncated, 4),
    "lognormal": (_lognormal, 2),
    "triangular": (_triangular, 3),
    "values": (_values, None),
}
