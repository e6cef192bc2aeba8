"""The table of a scene file for an FMU of another tool that takes and gives signals, such as a controller."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import AfterValidator, Field, model_validator

from ..table import Name, Table
from ..units import Duration


def _is_there(path: str) -> str:
    if not Path(path).is_file():
        raise ValueError(f"there is no file {path}")
    return path


class Fmu(Table):
    """[[fmu]]: a co-simulation FMU, of FMI 2.0 or 3.0, that reads signals of components and sets parameters of them.

    file: from the scene's folder. step: its communication step size, by default what it says itself. parameters: start
    values by the FMU's names. inputs: by the FMU's names, where each comes from, "component.variable" or
    "component.variable[1]": an observation, or an output such as the motion of a body's port. outputs: by the FMU's
    names, tunable parameters that they set, one or several.
    """

    name: Name
    file: Annotated[str, AfterValidator(_is_there)]
    step: Duration | None = None
    parameters: dict[str, Any] = Field(default_factory=dict)
    inputs: dict[str, str] = Field(default_factory=dict)
    outputs: dict[str, str | tuple[str, ...]] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _is_joined(self) -> Self:
        if not self.inputs and not self.outputs:
            raise ValueError(
                'nothing joins it to the scene; give inputs = { name = "component.variable" }, or outputs'
            )
        return self

    def targets(self, output: str) -> tuple[str, ...]:
        """What an output sets."""
        given = self.outputs[output]
        return (given,) if isinstance(given, str) else given
