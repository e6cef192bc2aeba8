"""Motion laws: a number over time as a sum of terms, in pieces with the times where one ends and the next begins.

Every term is a polynomial in pieces, of degree 5 at most, or a sine between two times. So a law is known by three
tables, and the times where its form changes, its breaks, are among them: steps that end there meet no jump within.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from math import isfinite, pi, sin
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from ..contract.component import ComponentError
from ..contract.errors import unknown
from .monotone_cubic import monotone_cubics
from .scheme import NEVER

DEGREE = 5
MEANING = """A motion law is a list of terms, which add up, in SI units and Hz: `change` is reached `duration` seconds
after `start` along a straight line (`ramp`), a cubic (`step`), a polynomial of degree five (`step5`) or half a cosine
(`havsin`). With `spin_up` the rate rises along a cycloid to `rate` in `duration` seconds, and stays. A `table` goes
through points (`times`, `values`) by monotone cubics (PCHIP), a `polyline` straight from one to the next; both are
constant before and after. A `harmonic` is amplitude sin(2 pi frequency (t - start) + phase) from
`start` on, and what it is there before, so that motions do not jump: a load that begins at `start` has a `phase` of 0.
"""
_REACHED = 1e-9  # distance (s) from a break that sums of step sizes may leave
_SAME = 1e-12  # distance (s) of breaks that are one
_GAUSS = 0.6**0.5


class Sine(NamedTuple):
    """amplitude sin(frequency (t - reference) + phase) from `on` to `off`; rad/s, s, rad."""

    amplitude: float
    frequency: float
    reference: float
    phase: float
    on: float
    off: float

    def derivative(self, time: float, order: int) -> float:
        """The value (order 0) or a derivative by time."""
        if not self.on <= time < self.off:
            return 0.0
        angle = self.frequency * (time - self.reference) + self.phase + 0.5 * pi * order
        return self.amplitude * self.frequency**order * sin(angle)


class _Term(NamedTuple):
    """Polynomials of absolute time in pieces, one more than there are breaks, and sines beside them."""

    breaks: tuple[float, ...]
    pieces: tuple[Polynomial, ...]
    sines: tuple[Sine, ...] = ()


class MotionLaw:
    """A law in pieces: `breaks` (m,), `coefficients` (m + 1, 6) by rising power of the time since a piece began.

    The first piece has no beginning; its time counts from zero. terms: mappings with a `profile` and its numbers, in SI
    units, see `PROFILES`. ComponentError where a term is none.
    """

    def __init__(self, terms: Sequence[Mapping[str, Any]]) -> None:
        if not isinstance(terms, list | tuple) or not terms:
            raise ComponentError(
                f"a motion law is {terms!r}; give a list of terms such as {{ profile = 'step', duration = 1, change = "
                "2 }"
            )
        made = [_term(number, term) for number, term in enumerate(terms, 1)]
        times = sorted(time for term in made for time in term.breaks)
        self.breaks = tuple(
            t for i, t in enumerate(times) if i == 0 or t - times[i - 1] > _SAME * max(1.0, abs(t))
        )
        self.sines = tuple(sine for term in made for sine in term.sines)
        self.coefficients = tuple(_coefficients(made, start) for start in (None, *self.breaks))

    def _piece(self, time: float) -> tuple[float, tuple[float, ...]]:
        """Time since the piece of a time began, and its coefficients."""
        number = bisect_right(self.breaks, time)
        return time - (self.breaks[number - 1] if number else 0.0), self.coefficients[number]

    def value(self, time: float) -> float:
        """The law."""
        t, (a, b, c, d, e, f) = self._piece(time)
        return a + t * (b + t * (c + t * (d + t * (e + t * f)))) + self._sines(time, 0)

    def rate(self, time: float) -> float:
        """Its rate, at a break that of what follows."""
        t, (_, b, c, d, e, f) = self._piece(time)
        return b + t * (2.0 * c + t * (3.0 * d + t * (4.0 * e + t * 5.0 * f))) + self._sines(time, 1)

    def acceleration(self, time: float) -> float:
        """Its second derivative, at a break that of what follows."""
        t, (_, _, c, d, e, f) = self._piece(time)
        return 2.0 * c + t * (6.0 * d + t * (12.0 * e + t * 20.0 * f)) + self._sines(time, 2)

    def _sines(self, time: float, order: int) -> float:
        return sum(sine.derivative(time, order) for sine in self.sines)

    def mean(self, start: float, end: float) -> float:
        """Mean between two times by Gauss' rule with three points: exact for polynomials where no break is between."""
        return gauss_moments(self.samples(start, end))[0]

    def samples(self, start: float, end: float) -> tuple[float, float, float]:
        """Values at the three points of Gauss' rule."""
        first, middle, last = gauss_times(start, end)
        return self.value(first), self.value(middle), self.value(last)

    def rate_moment(self, start: float, end: float) -> float:
        """First moment of the rate, the integral of P1 l' dt = l1 + l0 - 2 mean(l)."""
        if start == end:
            return 0.0
        return self.value(start) + self.value(end) - 2.0 * self.mean(start, end)

    def time_to_break(self, time: float) -> float:
        """Time (s) from a time to the next break; NEVER behind the last."""
        number = bisect_right(self.breaks, time + _REACHED)
        return self.breaks[number] - time if number < len(self.breaks) else NEVER

    def native_data(self, name: str = "law") -> Mapping[str, ArrayLike]:
        """The tables that `fmus/native/shared/motion_law.h` reads."""
        return {
            f"{name}_breaks": self.breaks,
            f"{name}_coefficients": self.coefficients,
            f"{name}_sines": self.sines,
        }


NOTHING = ({"profile": "constant", "value": 0.0},)
"""Terms of a law that is always zero."""


def gauss_times(start: float, end: float) -> tuple[float, float, float]:
    """The three points of Gauss' rule between two times."""
    middle, arm = 0.5 * (start + end), 0.5 * _GAUSS * (end - start)
    return middle - arm, middle, middle + arm


def gauss_moments(samples: Sequence[float]) -> tuple[float, float]:
    """Mean and slope (coefficient of P1) over a step of what has these values at the points of Gauss' rule."""
    before, middle, after = samples
    return (5.0 * before + 8.0 * middle + 5.0 * after) / 18.0, 5.0 / 6.0 * _GAUSS * (after - before)


def interpolated(start: float, middle: float, end: float) -> tuple[float, float, float]:
    """The parabola through values at the start, in the middle and at the end, at the points of Gauss' rule."""
    slope, bend = 0.5 * (end - start), 0.5 * (end + start) - middle
    return middle - _GAUSS * slope + 0.6 * bend, middle, middle + _GAUSS * slope + 0.6 * bend


def _coefficients(terms: Sequence[_Term], start: float | None) -> tuple[float, ...]:
    """Of the sum of all terms in the piece that begins at a time, the first one for None."""
    found = np.zeros(DEGREE + 1)
    for term in terms:
        number = 0 if start is None else bisect_right(term.breaks, start + _SAME * max(1.0, abs(start)))
        moved = np.asarray(term.pieces[number](Polynomial([start or 0.0, 1.0])).coef, dtype=float)
        found[: moved.size] += moved
    return tuple(found.tolist())


def _term(number: int, given: Mapping[str, Any]) -> _Term:
    """A term of a law from what was written down."""
    place = f"term {number} of the law"
    if not isinstance(given, Mapping) or given.get("profile") not in PROFILES:
        told = given.get("profile") if isinstance(given, Mapping) else given
        raise ComponentError(f"{place}: profile {told!r} {unknown(f'{told}', list(PROFILES), 'profile')}")
    profile = PROFILES[given["profile"]]
    keys = set(given) - {"profile"}
    for key in sorted(keys - {*profile.needs, *profile.may}):
        raise ComponentError(
            f"{place}, {given['profile']}: {key} {unknown(key, (*profile.needs, *profile.may), 'number')}"
        )
    for key in profile.needs:
        if key not in keys:
            raise ComponentError(f"{place}, {given['profile']}: {key} is missing")
    values = {key: _numbers(f"{place}, {given['profile']}: {key}", given[key]) for key in keys}
    if values.get("duration", 1.0) <= 0.0:
        raise ComponentError(
            f"{place}, {given['profile']}: duration is {given['duration']} s; it must be positive"
        )
    try:
        return profile.make(**{**profile.may, **values})
    except ValueError as error:
        raise ComponentError(f"{place}, {given['profile']}: {error}") from None


def _numbers(place: str, value: object) -> Any:  # noqa: ANN401 - a number or a list of numbers
    if isinstance(value, list | tuple):
        return tuple(_numbers(place, entry) for entry in value)
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        plain = ", without a unit: laws are in SI units and Hz" if isinstance(value, str) else ""
        raise ComponentError(f"{place} is {value!r}; it must be a finite number{plain}")
    return float(value)


def _rise(start: float, duration: float, change: float, *shares: float) -> _Term:
    """From 0 to `change` along a polynomial in the share of the duration that has passed, by rising power."""
    share = Polynomial([-start / duration, 1.0 / duration])
    moving = change * Polynomial(shares)(share)
    return _Term((start, start + duration), (Polynomial([0.0]), moving, Polynomial([change])))


def _constant(value: float) -> _Term:
    return _Term((), (Polynomial([value]),))


def _ramp(start: float, duration: float, change: float) -> _Term:
    return _rise(start, duration, change, 0.0, 1.0)


def _step(start: float, duration: float, change: float) -> _Term:
    return _rise(start, duration, change, 0.0, 0.0, 3.0, -2.0)


def _step5(start: float, duration: float, change: float) -> _Term:
    return _rise(start, duration, change, 0.0, 0.0, 0.0, 10.0, -15.0, 6.0)


def _havsin(start: float, duration: float, change: float) -> _Term:
    """Half a wave of a cosine."""
    end = start + duration
    wave = Sine(-0.5 * change, pi / duration, start, 0.5 * pi, start, end)
    pieces = (Polynomial([0.0]), Polynomial([0.5 * change]), Polynomial([change]))
    return _Term((start, end), pieces, (wave,))


def _spin_up(start: float, duration: float, rate: float) -> _Term:
    """The rate rises along a cycloid, then stays."""
    passed = Polynomial([-start, 1.0])
    depth = rate / duration * (0.5 * duration / pi) ** 2
    wave = Sine(depth, 2.0 * pi / duration, start, 0.5 * pi, start, start + duration)
    rising = 0.5 * rate / duration * passed**2 - depth
    return _Term(
        (start, start + duration),
        (Polynomial([0.0]), rising, rate * (passed - 0.5 * duration)),
        (wave,),
    )


def _harmonic(start: float, amplitude: float, frequency: float, phase: float) -> _Term:
    """A sine from its start on, before it its value there; frequency in Hz."""
    wave = Sine(amplitude, 2.0 * pi * frequency, start, phase, start, NEVER)
    return _Term((start,), (Polynomial([amplitude * sin(phase)]), Polynomial([0.0])), (wave,))


def _check_points(times: Sequence[float], values: Sequence[float]) -> None:
    """ValueError where they are no points in order."""
    lists = isinstance(times, tuple) and isinstance(values, tuple)
    if not lists or len(times) != len(values) or len(times) < 2 or np.any(np.diff(times) <= 0.0):
        raise ValueError("give as many values as times, at least two, and the times rising")


def _polyline(times: Sequence[float], values: Sequence[float]) -> _Term:
    """Straight from point to point, constant outside."""
    _check_points(times, values)
    slopes = np.diff(values) / np.diff(times)
    own = [
        Polynomial([value - slope * time, slope])
        for time, value, slope in zip(times[:-1], values[:-1], slopes.tolist(), strict=True)
    ]
    return _Term(tuple(times), (Polynomial([values[0]]), *own, Polynomial([values[-1]])))


def _table(times: Sequence[float], values: Sequence[float]) -> _Term:
    """Monotone cubics through points, constant outside."""
    _check_points(times, values)
    cubics = monotone_cubics(np.array(times, dtype=float), np.array(values, dtype=float))
    own = [Polynomial(c[::-1])(Polynomial([-t, 1.0])) for c, t in zip(cubics.T, times, strict=False)]
    return _Term(tuple(times), (Polynomial([values[0]]), *own, Polynomial([values[-1]])))


class _Profile(NamedTuple):
    make: Callable[..., _Term]
    needs: tuple[str, ...]
    may: Mapping[str, float]


_FROM_ZERO: Mapping[str, float] = {"start": 0.0}
PROFILES: Mapping[str, _Profile] = {
    "constant": _Profile(_constant, ("value",), {}),
    "ramp": _Profile(_ramp, ("duration", "change"), _FROM_ZERO),
    "step": _Profile(_step, ("duration", "change"), _FROM_ZERO),
    "step5": _Profile(_step5, ("duration", "change"), _FROM_ZERO),
    "havsin": _Profile(_havsin, ("duration", "change"), _FROM_ZERO),
    "spin_up": _Profile(_spin_up, ("duration", "rate"), _FROM_ZERO),
    "harmonic": _Profile(_harmonic, ("amplitude", "frequency"), {"start": 0.0, "phase": 0.0}),
    "table": _Profile(_table, ("times", "values"), {}),
    "polyline": _Profile(_polyline, ("times", "values"), {}),
}
"""Kinds of terms, with the numbers that each needs and may have. STEP is s^2 (3 - 2 s), STEP5
s^3 (10 - 15 s + 6 s^2)."""
