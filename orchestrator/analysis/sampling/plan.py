"""Which values the samples of a study have: drawn at random, by quasi-random designs, on grids, at worst cases."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import prod
from typing import Final, Literal

import numpy as np
import scipy

from components.contract.component import Vector

from .distributions import StudyError
from .varied import Varied

Method = Literal["latin-hypercube", "random", "sobol", "sobol-indices", "grid", "one-at-a-time", "corners"]
"""Designs of the samples."""
_MOST = 1_000_000
_LEVELS = 5


@dataclass(frozen=True, slots=True)
class Plan:
    """How the values of D parameters are chosen; StudyError where that cannot be.

    method: see `Method`. runs: samples of random designs, and base samples N of "sobol-indices", which takes
    N (D + 2); other methods have as many as they need. levels: of each parameter of a grid. seed: of what is random.
    """

    varied: tuple[Varied, ...]
    method: Method = "latin-hypercube"
    runs: int = 100
    levels: int = _LEVELS
    seed: int = 0

    def __post_init__(self) -> None:
        if not self.varied:
            raise StudyError(
                "nothing is varied; give what is, such as friction.coefficient=uniform(0.05, 0.2)"
            )
        if self.method not in METHODS:
            raise StudyError(f"there is no method {self.method!r}; methods are {', '.join(METHODS)}")
        keys = [key for one in self.varied for key in one.keys]
        if twice := sorted({key for key in keys if keys.count(key) > 1}):
            raise StudyError(f"{', '.join(twice)}: varied twice; a key gets one value")
        if self.runs < 1:
            raise StudyError(f"{self.runs} runs are none; give one at least")
        if self.seed < 0:
            raise StudyError(f"seed {self.seed} is none; give a whole number of 0 or more")
        if self.levels < 2:
            raise StudyError(f"a grid of {self.levels} levels has no range; give two at least")
        if self.method in _POWERS and self.runs & (self.runs - 1):
            near = 1 << max(self.runs.bit_length() - 1, 1)
            raise StudyError(
                f"{self.runs} runs leave a Sobol sequence unbalanced; give a power of two: {near} or {2 * near}"
            )
        if self.count > _MOST:
            raise StudyError(f"this takes {self.count:,} runs; vary fewer keys, or draw samples at random")

    @property
    def count(self) -> int:
        """Number of samples."""
        d = len(self.varied)
        if self.method == "grid":
            return prod(len(one.distribution.spread(self.levels)) for one in self.varied)
        sizes = {"corners": 1 + (1 << d), "one-at-a-time": 1 + 2 * d, "sobol-indices": self.runs * (d + 2)}
        return sizes.get(self.method, self.runs)

    @property
    def independent(self) -> int:
        """Number of samples, the first ones, that repeat no value of others."""
        return 2 * self.runs if self.method == "sobol-indices" else self.count

    def samples(self) -> Vector:
        """Values (samples, D), the same for the same plan on every machine."""
        return METHODS[self.method](self)

    @property
    def is_random(self) -> bool:
        """Whether samples stand for the distributions, so that shares of them are probabilities."""
        return self.method in ("random", "latin-hypercube", "sobol", "sobol-indices")


def _of_probabilities(plan: Plan, probabilities: Vector) -> Vector:
    # neither end of an unbounded distribution is a number
    inside = np.clip(probabilities, 1e-12, 1.0 - 1e-12)
    columns = [one.distribution.quantile(column) for one, column in zip(plan.varied, inside.T, strict=True)]
    return np.stack(columns, axis=1)


def _random(plan: Plan) -> Vector:
    drawn = np.random.default_rng(plan.seed).random((plan.runs, len(plan.varied)))
    return _of_probabilities(plan, drawn)


def _latin_hypercube(plan: Plan) -> Vector:
    design = scipy.stats.qmc.LatinHypercube(len(plan.varied), rng=np.random.default_rng(plan.seed))
    return _of_probabilities(plan, design.random(plan.runs))


def _sobol(plan: Plan) -> Vector:
    design = scipy.stats.qmc.Sobol(len(plan.varied), rng=np.random.default_rng(plan.seed))
    return _of_probabilities(plan, design.random(plan.runs))


def _sobol_indices(plan: Plan) -> Vector:
    """A, B, and for each parameter A with that column of B (Saltelli et al. 2010), one below the other."""
    d = len(plan.varied)
    design = scipy.stats.qmc.Sobol(2 * d, rng=np.random.default_rng(plan.seed)).random(plan.runs)
    a, b = design[:, :d], design[:, d:]
    mixed = [np.where(np.arange(d) == k, b, a) for k in range(d)]
    return _of_probabilities(plan, np.concatenate([a, b, *mixed]))


def _grid(plan: Plan) -> Vector:
    return np.array(list(product(*(one.distribution.spread(plan.levels) for one in plan.varied))))


def _ends(plan: Plan) -> tuple[Vector, Vector, Vector]:
    """Nominal, lowest and highest values (D,)."""
    found = [one.distribution for one in plan.varied]
    nominal, low, high = ([getattr(one, name) for one in found] for name in ("nominal", "low", "high"))
    return np.array(nominal), np.array(low), np.array(high)


def _one_at_a_time(plan: Plan) -> Vector:
    """The nominal values, then each parameter at its lowest and its highest."""
    nominal, *ends = _ends(plan)
    rows = [nominal]
    for k in range(len(nominal)):
        rows += [np.where(np.arange(len(nominal)) == k, end, nominal) for end in ends]
    return np.array(rows)


def _corners(plan: Plan) -> Vector:
    """The nominal values, then all combinations of lowest and highest."""
    nominal, *ends = _ends(plan)
    return np.array([nominal, *product(*zip(*ends, strict=True))])


_POWERS = ("sobol", "sobol-indices")
METHODS: Final[Mapping[Method, Callable[[Plan], Vector]]] = {
    "random": _random,
    "latin-hypercube": _latin_hypercube,
    "sobol": _sobol,
    "grid": _grid,
    "one-at-a-time": _one_at_a_time,
    "corners": _corners,
    "sobol-indices": _sobol_indices,
}
"""Values (samples, D) of a plan, by what the method is called."""


def names(varied: Sequence[Varied]) -> tuple[str, ...]:
    """What parameters are called, in order."""
    return tuple(one.name for one in varied)
