"""Estimated errors of headline numbers as stored in a result, and messages about large ones."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from math import inf
from typing import Literal, NamedTuple

from ..messages import message
from .result import Result, ResultError
from .round_off import noise_floor

Key = tuple[str, str]
"""Quantity and what it is of, which tell a headline number from all others of a run."""
ESTIMATED_ERRORS = "estimated_errors"
"""Name of the statistic that holds them."""
MOST_TOLERANCES = 10.0
"""What a number may be off by before a run is repeated for it, or a note says so."""
_NOTABLE = 0.01
"""Error of a number, relative to what it is judged by, from which on a run warns: it changes the second digit."""
_LOADS = ("interface force peak", "interface torque peak")
TORQUE_PEAKS = ("attachment torque peak", "hinge torque peak")
"""Of single hinges, with the torque about their line."""
POINT_PEAKS = ("attachment force peak", TORQUE_PEAKS[0], "hinge force peak", TORQUE_PEAKS[1])
"""Headline numbers of the loads at single points: ports of the base, hinges between other bodies."""
_PER_JOULE = 100.0
"""N or N.m, of which no more is round-off's yardstick for each joule that a scene exchanges."""
_ADDED_UP = 10.0
"""Times which round-off of one joint is that of a scene."""
OF_STOPS = "stop torque peak"
"""Judged beside the stop that is struck the hardest."""
OF_CONTACTS = "contact force max"
"""Judged beside the contact that is pressed the hardest."""
OF_LATCHES = ("latch time", "latch impulse", "latch torque peak")
_OF_VECTOR = 0.1
"""Of the largest error of a vector's components, that none of them is less than at the most."""
_AMONG = {
    **dict.fromkeys(_LOADS, "its largest component"),
    OF_STOPS: "the largest of all stops",
    OF_CONTACTS: "the largest of all contacts",
    **dict.fromkeys(POINT_PEAKS[:2], "the largest of all ports"),
    **dict.fromkeys(POINT_PEAKS[2:], "the largest of all hinges"),
}
"""What is judged beside the largest of its kind, and that in words."""
SIZING = (*OF_LATCHES, OF_STOPS)
"""Quantities that size hinges."""
PROMISED = (*SIZING, OF_CONTACTS, *_LOADS)
"""Quantities that a run is repeated for where they are likely to miss."""
JUDGED = (*PROMISED, *POINT_PEAKS)
"""Quantities whose errors are compared with the tolerance."""


class EstimatedError(NamedTuple):
    """Error of a headline number in its unit: likely, and largest possible."""

    likely: float
    most: float


def beside_their_vector(errors: Mapping[Key, EstimatedError]) -> dict[Key, EstimatedError]:
    """The errors; no largest possible error of a load component is below a tenth of the largest among the components.

    All components have the errors of the same vibration, and one of them may agree in two runs by chance.
    """
    least = {
        load: _OF_VECTOR * max((error.most for key, error in errors.items() if key[0] == load), default=0.0)
        for load in _LOADS
    }
    return {
        key: error._replace(most=max(error.most, least.get(key[0], 0.0))) for key, error in errors.items()
    }


def errors_text(errors: Mapping[Key, EstimatedError]) -> str:
    """Estimated errors as the text that a result keeps in its statistics."""
    return json.dumps([[quantity, of, *error] for (quantity, of), error in errors.items()])


def estimated_errors(result: Result) -> dict[Key, EstimatedError]:
    """Estimated errors that a result keeps; empty where none were estimated."""
    text = str(result.statistics.get(ESTIMATED_ERRORS, "[]"))
    try:
        rows = json.loads(text)
        return {
            (str(name), str(of)): EstimatedError(float(error), float(most)) for name, of, error, most in rows
        }
    except (ValueError, TypeError, RecursionError):
        raise ResultError(f"{result.name}: the estimated errors of the result are damaged") from None


def unknown_errors(result: Result) -> list[str]:
    """A warning where errors were to be estimated and could not be."""
    if ESTIMATED_ERRORS not in result.statistics or estimated_errors(result):
        return []
    return [
        message(
            "W-error-unknown",
            "No errors could be estimated: the run with steps twice as long does not reach the end. Run again with a "
            "smaller --tolerance.",
        )
    ]


def error_messages(
    numbers: Sequence[tuple[Key, float]],
    errors: Mapping[Key, EstimatedError],
    tolerance: float | None,
    refined: float | None = None,
    *,
    fixed_step: bool = False,
) -> list[str]:
    """Warnings of headline numbers (key and value) with large errors, and notes on those beyond ten tolerances.

    Only promised quantities warn. Latch times, impulses and torques are judged relative to their own values,
    components of a load relative to the largest, stops and contacts relative to the one that is struck the hardest.
    refined: the smaller tolerance of the repetition, if there was one. fixed_step: whether steps do not follow from
    the tolerance.
    """
    if tolerance is None:
        return []
    shares = _shares(numbers, errors, JUDGED)
    notable = max(_NOTABLE, MOST_TOLERANCES * tolerance)
    large = {
        key: share.most for key, share in shares.items() if key[0] in PROMISED and share.likely > notable
    }
    smaller = f"a smaller --{'step' if fixed_step else 'tolerance'}"
    advice = (
        f"Run again with {smaller}."
        if refined is None
        else f"A repetition at {refined:.2g} did not reduce it."
    )
    messages = [
        message("W-error", f"{subject}: the estimated error is {100 * share:.2g} % of {whole}. {advice}")
        for subject, share, whole in _together(large)
    ]
    small = {key: share for key, share in _beyond(shares, tolerance).items() if key not in large}
    messages += [
        message(
            "N-tolerance",
            f"{subject}: the error may be up to {100 * share:.2g} % of {whole}, over ten tolerances.",
        )
        for subject, share, whole in _together(small)
    ]
    return messages


def beyond_ten_tolerances(
    numbers: Sequence[tuple[Key, float]], errors: Mapping[Key, EstimatedError], tolerance: float
) -> dict[Key, float]:
    """Numbers whose largest possible error exceeds ten tolerances, and that error.

    It is relative to the reference value of each number, see `error_messages`.
    """
    return _beyond(_shares(numbers, errors, JUDGED), tolerance)


def _beyond(shares: Mapping[Key, EstimatedError], tolerance: float) -> dict[Key, float]:
    return {key: share.most for key, share in shares.items() if share.most > MOST_TOLERANCES * tolerance}


def tabulated_errors(
    numbers: Sequence[tuple[Key, float]], errors: Mapping[Key, EstimatedError], tolerance: float | None
) -> dict[Key, float]:
    """The error of each number in tables: beyond ten tolerances the largest possible one, otherwise the likely one."""
    warned = {} if tolerance is None else beyond_ten_tolerances(numbers, errors, tolerance)
    return {key: error.most if key in warned else error.likely for key, error in errors.items()}


def _together(shares: Mapping[Key, float]) -> Iterator[tuple[str, float, str]]:
    """Subject, largest share and reference value of numbers; numbers with a common reference value together."""
    for quantity, of in shares:
        whole = _AMONG.get(quantity)
        if whole is None:
            yield f"{quantity} of {of}", shares[quantity, of], "its value"
            continue
        members = [one for like, one in shares if like == quantity]
        if of == members[0]:
            most = max(shares[quantity, one] for one in members)
            yield f"{quantity} of {', '.join(members)}", most, whole


def round_off_of_loads(numbers: Iterable[tuple[Key, float]]) -> float:
    """Magnitude below which all loads of a kind (N or N.m) are round-off relative to loads at base, hinges, latches.

    Iterations end relative to these and to 1 N (N.m), or less in scenes with less energy, see
    `cosim.implicit.convergence.Tolerance`; their residuals in several joints add up.
    """
    known = dict(numbers)
    beside = (value for key, value in known.items() if key[0] in (*_LOADS, *POINT_PEAKS, "latch torque peak"))
    exchanged = _PER_JOULE * known.get(("energy exchanged", ""), 0.0)
    return _ADDED_UP * noise_floor((min(1.0, exchanged) if exchanged else 1.0, *beside))


def largest_shares(
    numbers: Sequence[tuple[Key, float]],
    errors: Mapping[Key, EstimatedError],
    quantities: Collection[str] = PROMISED,
) -> EstimatedError:
    """The largest relative errors of promised quantities; 0 if there are none."""
    shares = _shares(numbers, errors, quantities).values()
    return EstimatedError(
        max((share.likely for share in shares), default=0.0),
        max((share.most for share in shares), default=0.0),
    )


def least_sure(
    numbers: Sequence[tuple[Key, float]],
    errors: Mapping[Key, EstimatedError],
    quantities: Collection[str] = PROMISED,
    by: Literal["likely", "most"] = "likely",
) -> tuple[str, EstimatedError]:
    """The number with the largest relative error of promised quantities, and its relative errors."""
    shares = _shares(numbers, errors, quantities)
    quantity, of = max(shares, key=lambda key: float(getattr(shares[key], by)))
    return f"{quantity} of {of}", shares[quantity, of]


def _shares(
    numbers: Sequence[tuple[Key, float]], errors: Mapping[Key, EstimatedError], quantities: Collection[str]
) -> dict[Key, EstimatedError]:
    return {
        key: EstimatedError(*(e / size for e in errors[key]))
        for key, size in _sizes(numbers, errors)
        if size and key[0] in quantities
    }


def _sizes(
    numbers: Sequence[tuple[Key, float]], errors: Mapping[Key, EstimatedError]
) -> Iterator[tuple[Key, float]]:
    """Promised numbers with errors, and their reference values.

    Forces that are round-off relative to torques of the scene, or vice versa, are not promised, nor are components that
    are round-off relative to others.
    """
    largest = {
        load: max((abs(value) for key, value in numbers if key[0] == load), default=0.0) for load in _AMONG
    }
    round_off = round_off_of_loads(numbers)
    for key, value in numbers:
        if key[0] not in JUDGED or key not in errors or largest.get(key[0], inf) <= round_off:
            continue
        size = largest.get(key[0], abs(value))
        if key[0] not in _AMONG or max(abs(value), errors[key].likely) > noise_floor([size]):
            yield key, size
