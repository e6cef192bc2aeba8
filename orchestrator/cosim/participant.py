"""Whatever takes part in a co-simulation: one protocol, with an in-process component as the plainest case.

The master sets inputs and reads outputs through arrays that a participant owns and keeps for its life, so
stepping allocates nothing on the master's side.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Protocol, TypeVar

import numpy as np

from components import REGISTRY, Component, ComponentError, FanfoldError, Instance, Layout

from ..assembly import Part
from .native.library import Calls
from .ports import PortPlaces, Width

Vector = np.ndarray[tuple[int], np.dtype[np.float64]]
Matrix = np.ndarray[tuple[int, int], np.dtype[np.float64]]
T = TypeVar("T")


class ParticipantError(FanfoldError):
    """A participant failed: a sentence with its name, and the time where there is one."""


def all_finite(values: Vector) -> bool:
    """Whether all values are finite."""
    return bool(np.isfinite(values).all())


def refuse_not_finite(
    owner: str, what: str, layout: Layout, values: Vector, time: float | None = None
) -> None:
    """ParticipantError that names the first value that is not finite: of whom, what its values are, and when (s)."""
    if not all_finite(values):
        bad = int(np.argmin(np.isfinite(values)))
        when = "" if time is None else f" at t = {time:.6g} s"
        raise ParticipantError(f"{owner}: {what} {layout.scalar_names()[bad]} is {values[bad]}{when}")


class NativeAccess(Protocol):
    """What a solver in C needs to call a participant by itself."""

    calls: Calls

    def failure(self, call: int, status: int, time: float, h: float) -> ParticipantError:
        """What to raise when a call failed, by its number in coupled_step.h and its FMI status."""


class Participant(Protocol):
    """One FMU or component in a running co-simulation.

    `inputs` and `outputs` are arrays in the order of `input_layout` and `output_layout`. `save` remembers
    the present state in the one slot there is; `restore` goes back to it, any number of times.
    `noun`: what people call its kind, empty where that is not known. `constant_mobility`: of a body, see
    `Component`; False where nothing is known. `native`: for a solver in C that makes these calls itself; None where
    only Python can.
    """

    name: str
    inputs: Vector
    outputs: Vector
    input_layout: Layout
    output_layout: Layout
    observation_layout: Layout
    parameter_layout: Layout
    can_restore: bool
    constant_mobility: bool
    noun: str

    @property
    def native(self) -> NativeAccess | None:
        """Functions and memory for a solver in C."""

    def initialize(self, time: float) -> None:
        """Leave initialisation with the inputs as they are."""

    def write(self) -> None:
        """Hand over the inputs."""

    def do_step(self, time: float, h: float) -> None:
        """Step from time over h; ParticipantError if it cannot."""

    def read(self) -> None:
        """Fetch the outputs."""

    def save(self) -> None:
        """Remember the state."""

    def restore(self) -> None:
        """Return to the remembered state."""

    def serialized(self) -> bytes:
        """The remembered state; ParticipantError where it cannot be had as bytes."""

    def deserialize(self, content: bytes) -> None:
        """Remember and return to such a state, with the same inputs as when it was remembered."""

    def observe(self) -> Vector:
        """The observations of the present state and inputs, an array of the participant's own."""

    def interface_jacobian(self, places: PortPlaces, width: Width) -> Matrix | None:
        """Derivatives of the step just made, by the inputs it was made with; None where it cannot tell.

        Of a body's motions by its wrenches (coordinates, wrenches), of a connection's wrenches by its motions.
        """

    def jacobian_at_once(self, places: PortPlaces, width: Width) -> Matrix | None:
        """A connection's interface Jacobian where it costs no more than a few steps; None otherwise."""

    def set_parameter(self, name: str, value: float | Sequence[float]) -> None:
        """Change a parameter; ParticipantError for an unknown name or an impossible value."""

    def close(self) -> None:
        """Free what it holds."""


def first_observations(participants: Iterable[Participant]) -> dict[str, int]:
    """Where the observations of each begin, by its name, in those of all, one's after the other's."""
    firsts, first = {}, 0
    for participant in participants:
        firsts[participant.name] = first
        first += participant.observation_layout.size
    return firsts


class InProcess:
    """A component as a participant, without an FMU around it."""

    can_restore = True
    native = None

    def __init__(
        self, name: str, component: Component, start: Mapping[str, float | Sequence[float]] | None = None
    ) -> None:
        self.name = name
        self.component = component
        self.constant_mobility = component.constant_mobility
        self.noun = component.noun
        self.parameter_layout = component.parameter_layout
        self.input_layout = component.input_layout
        self.output_layout = component.output_layout
        self.observation_layout = component.observation_layout
        self.outputs = self.output_layout.start_values()
        self._instance = self._trying(lambda: Instance(component, start))
        self.inputs = self._instance.inputs
        self._trying(lambda: self._instance.constants)
        self._saved = self._instance.state

    def _trying(self, act: Callable[[], T]) -> T:
        """What the component gives; what it refuses, with the name of the participant."""
        try:
            return act()
        except ComponentError as error:
            raise ParticipantError(f"{self.name}: {error}") from None

    def initialize(self, time: float) -> None:
        """Compute the state from parameters and inputs."""
        self._trying(self._instance.initialize)

    def write(self) -> None:
        """Inputs are read where they are."""

    def do_step(self, time: float, h: float) -> None:
        """Step; a state that is not finite is refused."""
        self._trying(lambda: self._instance.constants)
        try:
            self._instance.step(h)
        except ComponentError as error:
            raise ParticipantError(
                f"{self.name}: cannot do a step of {h:g} s at t = {time:.6g} s: {error}"
            ) from None
        except (ValueError, ArithmeticError) as error:
            raise ParticipantError(f"{self._refusal(time, h)} ({error})") from None
        if not all_finite(self._instance.state):
            raise ParticipantError(self._refusal(time, h))

    def _refusal(self, time: float, h: float) -> str:
        return f"{self.name}: the state is no longer finite after the step of {h:g} s from t = {time:.6g} s"

    def read(self) -> None:
        """Compute the outputs."""
        self.outputs[:] = self._trying(self._instance.outputs)

    def save(self) -> None:
        """States are never changed in place, so a reference is enough."""
        self._saved = self._instance.state

    def restore(self) -> None:
        """Return to the saved state."""
        self._instance.state = self._saved

    def serialized(self) -> bytes:
        """The numbers of the state."""
        return self._saved.tobytes()

    def deserialize(self, content: bytes) -> None:
        """From the numbers of the state."""
        self._saved = np.frombuffer(content).copy()
        self.restore()

    def observe(self) -> Vector:
        """Observations; those that are no numbers are refused."""
        found = self._trying(self._instance.observe)
        refuse_not_finite(self.name, "observation", self.observation_layout, found)
        return found

    def interface_jacobian(self, places: PortPlaces, width: Width) -> None:
        """Components tell of their steps by differences only."""

    def jacobian_at_once(self, places: PortPlaces, width: Width) -> None:
        """Differences take many steps."""

    def set_parameter(self, name: str, value: float | Sequence[float]) -> None:
        """Change a parameter; it acts from the next step on."""
        if name not in self.parameter_layout:
            raise ParticipantError(f"{self.name}: there is no parameter {name!r}")
        self._instance.set(name, value)

    def close(self) -> None:
        """Nothing to free."""


def in_process(parts: Sequence[Part]) -> list[InProcess]:
    """Every part of an assembly as an in-process participant."""
    return [InProcess(part.name, REGISTRY[part.kind](**part.structure), part.start) for part in parts]
