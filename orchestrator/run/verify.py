"""Error of a run by Richardson extrapolation: repeat it with steps halved and quartered.

The accepted steps are replayed segment by segment between events. The extrapolation uses the observed order of each
number, limited to between 1 and the order of the coupling: rotations have order 2, vibrations order 4, and unresolved
motion has no order. The observed order is reported with each number.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import isfinite, log2

from ..assembly import Assembly
from ..cosim.ports import Order
from ..cosim.settings import Settings
from ..results.number import Number
from .run import Loader, Outcome, RunError, as_fmus, run

_NOT_EXTRAPOLATED = ("end time", "energy exchanged", "numerical energy loss", "energy residual")
"""What is a choice, or has no limit but nothing."""


@dataclass(frozen=True, slots=True)
class Verified:
    """A headline number of the original run with its extrapolated value, estimated error, observed order.

    order is None where the differences are too small to tell.
    """

    number: Number
    extrapolated: float
    error: float
    order: float | None

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return {
            "id": self.number.id,
            "quantity": self.number.quantity,
            "of": self.number.of,
            "unit": self.number.unit,
            "value": self.number.value,
            "extrapolated": self.extrapolated,
            "estimated_error": self.error,
            "observed_order": self.order,
        }


def halved(segments: Sequence[Sequence[float]]) -> list[list[float]]:
    """Every step as two of half the size."""
    return [[0.5 * h for h in segment for _ in range(2)] for segment in segments]


def verify(
    assembly: Assembly,
    outcome: Outcome,
    settings: Settings,
    until: float | None = None,
    watch: Callable[[float, float], None] = lambda time, h: None,
    load: Loader = as_fmus,
) -> list[Verified]:
    """Run twice more, with the outcome's steps halved and quartered; results are written next to that of the first.

    A number that not all three runs have, such as the time of a latch-up near the end, has no error.
    """
    if outcome.master != "implicit":
        raise RunError(f"{assembly.name}: only a run of the implicit master can be verified")
    numbers = [_by_name(outcome)]
    segments: Sequence[Sequence[float]] = outcome.segments
    for suffix in ("halved", "quartered"):
        segments = halved(segments)
        stem = outcome.result.path
        path = None if stem is None else stem.with_suffix(f".{suffix}.h5")
        finer = run(assembly, path, replace(settings, step_plan=segments), until, watch=watch, load=load)
        numbers.append(_by_name(finer))
    first, second, third = numbers
    return [
        _verified(number, second[key].value, third[key].value, outcome.order)
        for key, number in first.items()
        if key in second and key in third
    ]


def _by_name(outcome: Outcome) -> dict[tuple[str, str], Number]:
    """Headline numbers that have a limit of vanishing step size, by quantity and component."""
    return {
        (number.quantity, number.of): number
        for number in outcome.headline.numbers()
        if number.quantity not in _NOT_EXTRAPOLATED
    }


def _verified(number: Number, second: float, third: float, coupling: Order) -> Verified:
    coarse, fine = number.value - second, second - third
    noise = 1e-9 * abs(third)
    order = log2(abs(coarse / fine)) if abs(fine) > noise and abs(coarse) > noise else None
    power = coupling if order is None else min(max(order, 1.0), coupling)
    extrapolated = third + (third - second) / (2.0**power - 1.0)
    return Verified(
        number,
        extrapolated,
        abs(number.value - extrapolated),
        order if order is None or isfinite(order) else None,
    )
