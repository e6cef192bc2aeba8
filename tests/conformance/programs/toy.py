"""A component without mechanics: the smallest thing that has every kind of variable and structure value."""

from __future__ import annotations

from typing import Any, Self

import numpy as np

from components import REGISTRY, Component, ComponentError, Quantity
from components.contract.component import Vector


class Toy(Component):
    """Coupled first-order lags driven by inputs; what a component outside Fanfold looks like."""

    kind = "toy"

    def __init__(self, mixing: Vector, options: dict[str, Any]) -> None:
        if mixing.ndim != 2 or mixing.shape[0] != mixing.shape[1]:
            raise ComponentError(f"mixing has shape {mixing.shape}; it must be square")
        self.mixing = mixing
        self.nested = options["nested"][1]["weights"]
        n = mixing.shape[0]
        start = tuple(0.1 * i for i in range(n))
        self._declare(
            {"mixing": mixing, "options": options},
            ports=(),
            parameters=[
                Quantity("start", "m", "State at the start", n, start, variability="fixed"),
                Quantity("rate", "1/s", "Rate of the lags", 1, 2.0, 0.0, variability="tunable"),
                Quantity("angle", "deg", "Any angle", 1, 30.0, -180.0, 180.0, variability="tunable"),
            ],
            inputs=[
                Quantity("drive", "m/s", "Drive of each lag", n),
                Quantity("switch", "1", "Sign of the drive", 1, 1.0, variability="discrete"),
            ],
            outputs=[
                Quantity("level", "m", "Level of each lag", n),
                Quantity("force", "N.m.s/(rad.kg)", "Weighted sum with feedthrough"),
            ],
            observations=[Quantity("stored_energy", "J", "Sum of squares")],
            feedthrough=bool(options.get("feedthrough", True)),
        )

    def prepare(self, p: Vector) -> dict[str, Any]:
        self.check_ranges(p)
        at = self.parameter_layout
        if p[at["rate"]][0] == 13.0:
            raise ComponentError("rate = 13 1/s brings bad luck; choose another")
        weight = float(np.cos(np.deg2rad(p[at["angle"]][0])))
        return {"start": p[at["start"]], "rate": float(p[at["rate"]][0]), "weight": weight}

    def initial(self, c: dict[str, Any], u: Vector) -> Vector:
        return np.concatenate([c["start"] + 0.01 * u[self.input_layout["drive"]], [0.0]])

    def step(self, c: dict[str, Any], x: Vector, u: Vector, h: float) -> Vector:
        drive = u[self.input_layout["drive"]] * u[self.input_layout["switch"]]
        lags = x[:-1] + h * (drive - c["rate"] * (self.mixing @ x[:-1]))
        return np.concatenate([lags, [x[-1] + h]])

    def outputs(self, c: dict[str, Any], x: Vector, u: Vector) -> Vector:
        through = u[self.input_layout["drive"]].sum() if self.feedthrough else 0.0
        return np.concatenate([x[:-1], [c["weight"] * (self.nested @ x[:-1] + through)]])

    def observe(self, c: dict[str, Any], x: Vector, u: Vector) -> Vector:
        return np.array([x @ x])

    @classmethod
    def example(cls) -> Self:
        weights = np.array([1.0, 1.0 / 3.0, np.pi])
        mixing = np.array([[1.0, 0.2, 0.0], [0.1, 1.5, 0.3], [0.0, 0.4, 0.7]])
        return cls(mixing, {"nested": (1, {"weights": weights}), "label": "toy", "pair": (0.1, [1, 2])})


# Not one of Fanfold's components: tests that iterate over the registry must not find it there.
REGISTRY.pop(Toy.kind)
