"""From the declared quantities of a component to FMI variables, whatever version of FMI describes them.

Every fact about a variable comes from its `Quantity`. Variables stand in the order parameters, inputs,
outputs, observations; the value reference of a scalar is its position in that order, so each group, each
port and each quantity is one contiguous range.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from components import Component, ComponentError, Quantity
from components.contract.errors import nearest
from components.contract.quantity import Kind

from .units import DISPLAYED

StartValue = float | Sequence[float]
Causality = Literal["parameter", "input", "output"]

_WRITTEN: Mapping[Kind, Callable[[float], str]] = {
    "real": lambda value: repr(float(value)),
    "boolean": lambda value: "true" if value > 0.5 else "false",
    "integer": lambda value: str(round(value)),
}
_CAUSALITIES: tuple[Causality, ...] = ("parameter", "input", "output", "output")


@dataclass(frozen=True, slots=True)
class Variable:
    """One FMI variable: a quantity or one scalar of it, and where it is in the model description.

    The value reference of a whole quantity is that of its first scalar.
    """

    name: str
    value_reference: int
    causality: Causality
    quantity: Quantity

    @property
    def variability(self) -> str:
        """FMI variability; what a quantity leaves at the default is fixed for a parameter."""
        declared = self.quantity.variability
        if self.causality == "parameter":
            return "tunable" if declared == "tunable" else "fixed"
        is_discrete = declared == "discrete" or self.quantity.kind != "real"
        return "discrete" if is_discrete else "continuous"

    def attributes(self) -> dict[str, str]:
        """What it is, by the names that all versions of FMI have for it."""
        return {
            "name": self.name,
            "valueReference": str(self.value_reference),
            "description": self.quantity.description,
            "causality": self.causality,
            "variability": self.variability,
        }

    def unit_and_range(self) -> dict[str, str]:
        """The same of its unit and range; a Boolean has neither, an integer has no unit."""
        if self.quantity.kind == "boolean":
            return {}
        bounds = {"min": self.quantity.minimum, "max": self.quantity.maximum}
        given = {name: self.written([bound]) for name, bound in bounds.items() if bound is not None}
        if self.quantity.kind == "integer":
            return given
        unit = self.quantity.unit
        shown = {"displayUnit": DISPLAYED[unit]} if unit in DISPLAYED else {}
        return {"unit": unit, **shown, **given}

    def written(self, values: Sequence[float]) -> str:
        """Values as XML has them for its type."""
        return " ".join(map(_WRITTEN[self.quantity.kind], values))


def quantities(component: Component) -> Iterator[Variable]:
    """All quantities of a component in order, each as one variable."""
    reference = 0
    for layout, causality in zip(component.layouts, _CAUSALITIES, strict=True):
        for quantity in layout.quantities:
            yield Variable(quantity.name, reference, causality, quantity)
            reference += quantity.size


def scalars(component: Component) -> Iterator[Variable]:
    """All scalars of a component in order, each as one variable."""
    for variable in quantities(component):
        for i, name in enumerate(variable.quantity.scalar_names()):
            yield Variable(name, variable.value_reference + i, variable.causality, variable.quantity)


def value_references(component: Component) -> dict[str, int]:
    """Value reference of every scalar variable by name."""
    return {scalar.name: scalar.value_reference for scalar in scalars(component)}


def follows_inputs(component: Component, variable: Variable) -> bool:
    """Whether an output may depend on inputs of the same instant.

    With feedthrough all do; without it the observations, which are made for people, mostly may still do so.
    """
    observed = component.observes_inputs and variable.quantity.name in component.observation_layout
    return component.feedthrough or observed


def starts_from_inputs(component: Component, variable: Variable) -> bool:
    """Whether an output may depend on inputs in initialization mode, where all depend on parameters."""
    return component.starts_from_inputs or follows_inputs(component, variable)


def start_values(component: Component, start: Mapping[str, StartValue]) -> tuple[float, ...]:
    """Start values of parameters and inputs in order: the declared ones with those of `start` put in.

    A key is the name of a quantity (one number for all its scalars, or one each) or of one scalar.
    """
    settable = (component.parameter_layout, component.input_layout)
    values = {
        name: float(value)
        for layout in settable
        for name, value in zip(layout.scalar_names(), layout.start_values(), strict=True)
    }
    by_name = {quantity.name: quantity for layout in settable for quantity in layout.quantities}
    for key, value in start.items():
        if key not in by_name and key not in values:
            near = nearest(key, [*by_name, *values])
            hint = f"; did you mean {near!r}?" if near else ""
            raise ComponentError(f"{component.kind} has no parameter or input {key!r}{hint}")
        names = by_name[key].scalar_names() if key in by_name else (key,)
        given = np.asarray(value, dtype=float).ravel()
        if given.size not in (1, len(names)):
            raise ComponentError(f"{key} has {len(names)} scalars; {given.size} start values were given")
        values.update(zip(names, np.broadcast_to(given, (len(names),)).tolist(), strict=True))
    _check_inputs(component, values)
    return tuple(values.values())


def _check_inputs(component: Component, values: Mapping[str, float]) -> None:
    """Inputs start inside their range; `prepare` says the same of parameters, with more to check."""
    for quantity in component.input_layout.quantities:
        low = -math.inf if quantity.minimum is None else quantity.minimum
        high = math.inf if quantity.maximum is None else quantity.maximum
        for name in quantity.scalar_names():
            if not low <= values[name] <= high or math.isinf(values[name]):
                raise ComponentError(
                    f"input {name} starts at {values[name]:g} {quantity.unit}; "
                    f"it must be finite and between {low:g} and {high:g}"
                )
