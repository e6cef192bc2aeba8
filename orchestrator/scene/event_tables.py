"""Tables of a scene file about what happens in mid-run."""

from __future__ import annotations

from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from .table import Name, Table
from .units import quantity


class When(Table):
    """The condition of an event: a signal of a component, of a line's sensor or of an FMU passes a value."""

    component: str
    """Component, hinge line (its sensor) or FMU that is watched."""
    variable: str
    """One of its signals, of a vector with its number, such as "force[3]"."""
    above: Any = None
    """The event happens where the signal first exceeds this, in the signal's unit."""
    below: Any = None
    """The event happens where the signal first falls below this, in the signal's unit."""

    @model_validator(mode="after")
    def _has_one_side(self) -> Self:
        if (self.above is None) == (self.below is None):
            raise ValueError("give either above or below, the value that the variable passes")
        return self


class Event(Table):
    """[[event]]: at a time, or when a condition first holds, joints are released and variables are set."""

    name: Name
    """Name of the event."""
    time: Annotated[float, quantity("s", "zero or positive")] | None = None
    """When it happens."""
    when: When | None = None
    """Condition on which it happens, in place of a time."""
    release: tuple[str, ...] = ()
    """Names that let go: hold-downs, joints, drives, point motions, or hinge lines for all their hinges."""
    set: dict[str, dict[str, Any]] = Field(default_factory=dict)
    """Values by component or line, and by tunable parameter or command."""

    @model_validator(mode="after")
    def _happens_and_acts(self) -> Self:
        if (self.time is None) == (self.when is None):
            raise ValueError("give either time or when, a condition")
        if not self.release and not any(self.set.values()):
            raise ValueError(
                "give what it does: release = [names], or set = { component = { variable = value } }"
            )
        return self

    @property
    def targets(self) -> dict[str, str]:
        """Key in the table by name of every component that it acts on."""
        return {name: "release" for name in self.release} | {name: f"set.{name}" for name in self.set}
