"""How much each varied parameter moves a headline number."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy

from components.contract.component import Vector
from components.contract.errors import unknown

from ...records import short_repr
from ...results.round_off import NOISE
from .distributions import StudyError
from .study import Study

_LOW, _HIGH = 0.05, 0.95
_MOST_SHARE = 2.0
"""Of a variance that a parameter has in all: beyond it, noise or too few samples were divided up."""
_TOLD = 0.1
"""Part of the tolerance, of the largest number of a unit, from which on what runs tell of a number means something."""


@short_repr
@dataclass(frozen=True, slots=True)
class Influence:
    """On one number, by parameter.

    changes: from its nominal value (or median) to that with the parameter at its low and high end, the number's unit.
    shares: of the number's variance that it explains alone, and with all its interactions; None where samples do not
    tell. explained: share of the variance that straight lines explain, None where nothing was fitted.
    """

    number: str
    unit: str
    changes: Mapping[str, tuple[float, float]]
    shares: Mapping[str, tuple[float, float]] | None = None
    explained: float | None = None

    @property
    def ranked(self) -> list[str]:
        """Parameters, the one that moves it most first."""
        return sorted(self.changes, key=lambda name: -max(map(abs, self.changes[name])))


def influence(study: Study, number: str) -> Influence | None:
    """On a headline number; None where it does not change, is below what runs tell of its like, or few samples have it.

    One at a time: the differences themselves. Other methods: a linear regression on all parameters, from the 5 % to the
    95 % quantile of each. Indices of variance are those of Sobol' (first order and total, Saltelli et al. 2010).
    """
    if number not in study.numbers:
        raise StudyError(f"{number} {unknown(number, list(study.numbers), 'headline number')}")
    values = study.numbers[number]
    known = np.isfinite(values)
    if not known.any() or np.ptp(values[known]) <= 1e-12 * np.abs(values[known]).max():
        return None
    if np.abs(values[known]).max() <= _floor(study, number):
        return None
    unit = study.units.get(number, "")
    if study.plan.method == "one-at-a-time":
        pairs = values[1:].reshape(-1, 2) - values[0]
        changes = dict(zip(study.parameters, map(_pair, pairs), strict=True))
        return Influence(
            number, unit, {name: pair for name, pair in changes.items() if np.isfinite(pair).all()}
        )
    drawn = np.stack(list(study.parameters.values()), axis=1)
    if known.sum() < drawn.shape[1] + 2:
        return None
    spread = np.ptp(drawn[known], axis=0)
    design = (drawn[known] - drawn[known].mean(axis=0)) / np.where(spread > 0.0, spread, 1.0)
    centred = values[known] - values[known].mean()
    slopes = np.linalg.lstsq(design, centred, rcond=None)[0]
    ends = [np.quantile(column, (_LOW, _HIGH)) - np.median(column) for column in design.T]
    changes = {
        name: _pair(slope * end) for name, slope, end in zip(study.parameters, slopes, ends, strict=True)
    }
    rest = float(((centred - design @ slopes) ** 2).sum() / (centred**2).sum())
    return Influence(number, unit, changes, _variance_shares(study, values), 1.0 - rest)


def _floor(study: Study, number: str) -> float:
    """Up to where a number says nothing, as runs tell it no better beside others of its unit in all samples."""
    alike = [
        values for name, values in study.numbers.items() if study.units.get(name) == study.units.get(number)
    ]
    largest = max(float(np.abs(values).max(initial=0.0, where=np.isfinite(values))) for values in alike)
    return max(NOISE, _TOLD * float(study.asked.get("tolerance", 0.0))) * largest


def _pair(values: Vector) -> tuple[float, float]:
    low, high = (float(v) for v in values)
    return low, high


def _variance_shares(study: Study, values: Vector) -> dict[str, tuple[float, float]] | None:
    """Sobol' indices where the plan was made for them, no sample is missing, and they are shares of anything."""
    if study.plan.method != "sobol-indices" or not np.isfinite(values).all():
        return None
    n, d = study.plan.runs, len(study.parameters)
    if d == 1:  # all variance is that of the only one
        return dict.fromkeys(study.parameters, (1.0, 1.0))
    blocks = values.reshape(d + 2, 1, n)
    known: dict[Literal["f_A", "f_B", "f_AB"], Vector] = {
        "f_A": blocks[0],
        "f_B": blocks[1],
        "f_AB": blocks[2:],
    }
    found = scipy.stats.sobol_indices(func=known, n=n)
    if np.max(found.total_order) > _MOST_SHARE:
        return None
    pairs = zip(np.ravel(found.first_order), np.ravel(found.total_order), strict=True)
    return {name: (float(a), float(b)) for name, (a, b) in zip(study.parameters, pairs, strict=True)}
