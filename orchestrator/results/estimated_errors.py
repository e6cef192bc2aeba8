"""Estimated errors of headline numbers relative to what they are judged by, and messages about large ones."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from math import inf, isfinite

from ..messages import message
from .round_off import noise_floor

Key = tuple[str, str]
"""Quantity and component, which identify a headline number of a run."""
MOST_TOLERANCES = 10.0
"""Error of a number in tolerances, beyond which a run is repeated or a note says so."""
_NOTABLE = 0.01
"""Relative error from which on a run warns: it changes the second digit."""
_LOADS = ("interface force peak", "interface torque peak")
TORQUE_PEAKS = ("attachment torque peak", "hinge torque peak")
"""Of single hinges, with the torque about their line."""
POINT_PEAKS = ("attachment force peak", TORQUE_PEAKS[0], "hinge force peak", TORQUE_PEAKS[1])
"""Headline numbers of the loads at single points: ports of the base, hinges between other bodies."""
_PER_JOULE = 100.0
"""N or N.m: largest reference for round-off for each joule that a scene exchanges."""
_ADDED_UP = 10.0
"""Round-off of a scene over that of one joint."""
OF_STOPS, OF_CONTACTS = "stop torque peak", "contact force max"
OF_LATCHES = ("latch time", "latch impulse", "latch torque peak")
_AMONG = {
    **dict.fromkeys(_LOADS, "its largest component"),
    OF_STOPS: "the largest of all stops",
    OF_CONTACTS: "the largest of all contacts",
    **dict.fromkeys(POINT_PEAKS[:2], "the largest of all ports"),
    **dict.fromkeys(POINT_PEAKS[2:], "the largest of all hinges"),
}
"""Quantities that are judged relative to the largest of their kind, and that in words."""
PROMISED = (*OF_LATCHES, OF_STOPS, OF_CONTACTS, *_LOADS)
"""Quantities that the tolerance is meant for: a run is repeated where they miss it."""
JUDGED = (*PROMISED, *POINT_PEAKS)
"""Quantities whose errors are compared with the tolerance."""


def error_messages(
    numbers: Sequence[tuple[Key, float]],
    errors: Mapping[Key, float],
    tolerance: float | None,
    refined: float | None = None,
    *,
    fixed_step: bool = False,
) -> list[str]:
    """Warnings of headline numbers (key and value) with large errors, and notes on those beyond ten tolerances.

    Only promised quantities warn. Latch times, impulses and torques are judged relative to their own values,
    components of a load relative to the largest, stops and contacts relative to the one with the largest load.
    refined: the smaller tolerance of the repetition, if there was one. fixed_step: whether steps do not follow from
    the tolerance.
    """
    if tolerance is None:
        return []
    shares = relative_errors(numbers, errors, JUDGED)
    notable = max(_NOTABLE, MOST_TOLERANCES * tolerance)
    large = {key: share for key, share in shares.items() if key[0] in PROMISED and share > notable}
    smaller = f"a smaller --{'step' if fixed_step else 'tolerance'}"
    advice = (
        f"Run again with {smaller}."
        if refined is None
        else f"A repetition at {refined:.2g} did not reduce it."
    )
    messages = [
        message("W-error", f"{subject}: the estimated error is {100 * share:.2g} % of {whole}. {advice}")
        for subject, share, whole in _together({key: s for key, s in large.items() if isfinite(s)})
    ]
    messages += [
        message("W-error", f"{quantity} of {of}: it happens in only one of two runs. {advice}")
        for (quantity, of), share in large.items()
        if not isfinite(share)
    ]
    small = {
        key: share
        for key, share in shares.items()
        if share > MOST_TOLERANCES * tolerance and key not in large
    }
    messages += [
        message(
            "N-tolerance",
            f"{subject}: the error may be up to {100 * share:.2g} % of {whole}, over ten tolerances.",
        )
        for subject, share, whole in _together(small)
    ]
    return messages


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
    `Tolerance` of native/coupling/network.h; their residuals in several joints add up.
    """
    known = dict(numbers)
    loads = (value for key, value in known.items() if key[0] in (*_LOADS, *POINT_PEAKS, "latch torque peak"))
    exchanged = _PER_JOULE * known.get(("energy exchanged", ""), 0.0)
    return _ADDED_UP * noise_floor((min(1.0, exchanged) if exchanged else 1.0, *loads))


def relative_errors(
    numbers: Sequence[tuple[Key, float]],
    errors: Mapping[Key, float],
    quantities: Collection[str] = PROMISED,
) -> dict[Key, float]:
    """Errors of the numbers of some quantities relative to their reference values; infinite where unknown.

    Forces that are round-off relative to torques of the scene, or vice versa, are left out, and so are components that
    are round-off relative to others.
    """
    largest = {
        load: max((abs(value) for key, value in numbers if key[0] == load), default=0.0) for load in _AMONG
    }
    round_off, values = round_off_of_loads(numbers), dict(numbers)
    found = {}
    for key, error in errors.items():
        if key[0] not in quantities or largest.get(key[0], inf) <= round_off:
            continue
        value = abs(values.get(key, 0.0))
        size = largest.get(key[0], value)
        if not isfinite(error):
            found[key] = inf
        elif size and (key[0] not in _AMONG or max(value, error) > noise_floor([size])):
            found[key] = error / size
    return found


def largest_error(numbers: Sequence[tuple[Key, float]], errors: Mapping[Key, float]) -> tuple[str, float]:
    """The promised number with the largest relative error, in words, and that error; "" and 0 if there is none."""
    shares = relative_errors(numbers, errors)
    if not shares:
        return "", 0.0
    quantity, of = max(shares, key=lambda key: shares[key])
    return f"{quantity} of {of}", shares[quantity, of]
