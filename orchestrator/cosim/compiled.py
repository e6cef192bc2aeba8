"""A part in the compiled library of this process as a participant: what its native FMU is, without the file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import accumulate, pairwise

import numpy as np

from fmus import start_values
from fmus.compiled import CO_SIMULATION, InLibrary

from ..assembly import Part
from .fmi_participant import FmiParticipant, arguments_of


class CompiledParticipant(FmiParticipant):
    """One instance of a part; ComponentError where its start values cannot be."""

    def __init__(self, part: Part) -> None:
        super().__init__(part.name, {})
        self._made_of = component = part.component()
        self.parameter_layout, self.input_layout, self.output_layout, self.observation_layout = (
            component.layouts
        )
        self.constant_mobility = component.constant_mobility
        self.prescribed_motion = component.prescribed_motion
        self.noun = component.noun
        self._values = np.array(start_values(component, part.start))
        component.prepare(self._values[: self.parameter_layout.size])
        self._instance = InLibrary(component, part.name, CO_SIMULATION, self._hear)
        ends = list(accumulate((layout.size for layout in component.layouts), initial=0))
        parameters, inputs, outputs, observations = (range(first, end) for first, end in pairwise(ends))
        self._bind(
            self._instance.library, self._instance.handle.value, (parameters, inputs, outputs, observations)
        )
        self._first = self.outputs.copy(), self._observations.copy()
        self._known = range(outputs.start)
        self._set_values()

    @property
    def digest(self) -> str:
        """SHA-256 of the library, of the data of its component and of its start values."""
        return self._instance.digest(self._values)

    def reset(self, start: Mapping[str, float | Sequence[float]] | None = None) -> None:
        """fmi2Reset: back to the state after instantiation, with its arrays in place, ready for another run.

        start: start values of parameters and inputs that replace its own.
        """
        if start is not None:
            self._values[:] = start_values(self._made_of, start)
        self._free_saved()
        self._time = 0.0
        self.check(self._functions.fmi2Reset(self._component), "reset")
        self.outputs[:], self._observations[:] = self._first
        self._set_values()

    def _set_values(self) -> None:
        """Give it all its start values and enter initialization mode."""
        self.inputs[:] = self._values[self.parameter_layout.size :]
        given = self._set_real(self._component, *arguments_of(self._known, self._values))
        self.check(given, "take its start values")
        self._set_up()

    def close(self) -> None:
        """Free state and instance."""
        if self._instance.close.alive:
            self._free_saved()
            self._instance.close()
