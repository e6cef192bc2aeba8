"""One component at work: its parameter values, the constants they lead to, its inputs and its state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .component import Component, ComponentError, Vector

Value = float | Sequence[float] | Vector


class Instance:
    """A component with values by name; what follows from them is computed when it is next needed.

    inputs: (input_layout.size,), written to in place. state: (n,), computed from the inputs by `initialize`. Errors are
    those of the component, and `ComponentError` for a name that it does not have.
    """

    def __init__(self, component: Component, start: Mapping[str, Value] | None = None) -> None:
        self.component = component
        self.parameters = component.parameter_layout.start_values()
        self.inputs = component.input_layout.start_values()
        self.state: Vector = np.zeros(0)
        self._first = self.state
        self._constants: tuple[Any] | None = None
        for name, value in (start or {}).items():
            self.set(name, value)

    def set(self, name: str, value: Value) -> None:
        """Change a parameter or an input."""
        if name in self.component.input_layout:
            self.inputs[self.component.input_layout[name]] = value
        elif name in self.component.parameter_layout:
            self.parameters[self.component.parameter_layout[name]] = value
            self._constants = None
        else:
            raise ComponentError(f"there is no parameter or input {name!r}")

    def set_parameters(self, values: Vector) -> None:
        """Change all parameters."""
        self.parameters[:] = values
        self._constants = None

    def parameter(self, name: str) -> float:
        """Value of a scalar parameter."""
        return float(self.parameters[self.component.parameter_layout[name]][0])

    @property
    def constants(self) -> Any:  # noqa: ANN401 - opaque to everybody but the component
        """Constants of the present parameters; the copy keeps the component from seeing later changes."""
        if self._constants is None:
            self._constants = (self.component.prepare(self.parameters.copy()),)
        return self._constants[0]

    def initialize(self) -> None:
        """Take the state that belongs to the present parameters and inputs."""
        self.state = self._first = self.component.initial(self.constants, self.inputs)

    def return_to_start(self) -> None:
        """Take the state of `initialize` again."""
        self.state = self._first

    def step(self, h: float) -> None:
        """Step over h (s)."""
        self.state = self.component.step(self.constants, self.state, self.inputs, h)

    def update(self, at_event: bool) -> None:
        """Remember the present instant, or let happen what does at an event."""
        self.state = self.component.update(self.constants, self.state, self.inputs, at_event)

    def outputs(self) -> Vector:
        """Outputs in declared order; before `initialize` those of the state that it would take."""
        state = self.state if self.state.size else self.component.initial(self.constants, self.inputs)
        return self.component.outputs(self.constants, state, self.inputs)

    def rates(self) -> Vector:
        """Rates of the continuous states."""
        return self.component.rates(self.constants, self.state, self.inputs)

    def observe(self) -> Vector:
        """Observations in declared order."""
        return self.component.observe(self.constants, self.state, self.inputs)

    def observed(self) -> dict[str, Vector]:
        """Observations by name, each (size,)."""
        layout, values = self.component.observation_layout, self.observe()
        return {q.name: values[layout[q.name]] for q in layout.quantities}
