"""A damper that breaks on purpose: what an FMU of somebody else may do in the middle of a run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from components import REGISTRY, ComponentError
from components.contract.component import Vector
from components.damper import EddyCurrentDamper

FAILS_AT = 0.01
"""s"""
FAULTS = ("none", "error", "nan", "observation", "load", "noise")


class FaultyDamper(EddyCurrentDamper):
    """An eddy-current damper that fails as `fault` says, and after `FAILS_AT` where time matters.

    error: a step is refused. nan: one output is no number; observation: one
    observation. load: an FMU of it cannot be made an instance.
    noise: the same motion has another answer every time, from the start.
    """

    kind = "faulty_damper"

    def __init__(
        self, fault: str, axis: Sequence[float] = (0.0, 1.0, 0.0), wrench_mode: str = "mean"
    ) -> None:
        if fault == "load" and __name__.startswith("fanfold_"):  # the package that an FMU carries
            raise ComponentError("the licence server does not answer")
        super().__init__(axis, wrench_mode)
        self.fault = fault
        self.structure = {"fault": fault, **self.structure}
        self._rng = np.random.default_rng(1)

    def initial(self, c: Any, u: Vector) -> Vector:
        return np.append(super().initial(c, u), 0.0)

    def step(self, c: Any, x: Vector, u: Vector, h: float) -> Vector:
        if self.fault == "error" and x[-1] + h > FAILS_AT:
            raise ComponentError("the magnet has come off")
        return np.append(super().step(c, x[:-1], u, h), x[-1] + h)

    def outputs(self, c: Any, x: Vector, u: Vector) -> Vector:
        y = super().outputs(c, x[:-1], u)
        if self.fault == "nan" and x[-1] > FAILS_AT:
            y[4] = np.nan
        if self.fault == "noise":
            y[7] += self._rng.normal(scale=1e3)
        return y

    def observe(self, c: Any, x: Vector, u: Vector) -> Vector:
        found = super().observe(c, x[:-1], u)
        if self.fault == "observation" and x[-1] > FAILS_AT:
            found[self.observation_layout["dissipated_energy"]] = np.nan
        return found


# Not one of Fanfold's components: tests that iterate over the registry must not find it there.
REGISTRY.pop(FaultyDamper.kind)
