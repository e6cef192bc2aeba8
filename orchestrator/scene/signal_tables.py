"""The table of a scene file for an FMU of another tool that takes and gives signals, such as a controller."""

from __future__ import annotations

from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Self

from pydantic import AfterValidator, Field, model_validator

from components.contract.regular import is_regular

from .table import Name, Table
from .units import Duration


def _is_there(path: str) -> str:
    if not is_regular(Path(path)):
        raise ValueError(f"there is no file {path}")
    return path


class Fmu(Table):
    """[[fmu]]: an FMU 2.0 or 3.0 that reads signals of components and sets parameters of them."""

    removed = MappingProxyType(
        {
            "iterated": "FMUs are sampled at their step and no longer iterated; remove the key, and use a small "
            "step, or build the wing into the scene"
        }
    )
    name: Name
    """Name of the FMU in the scene."""
    file: Annotated[str, AfterValidator(_is_there)]
    """Path from the scene's folder."""
    step: Duration | None = None
    """Its communication step; by default what it says itself."""
    parameters: dict[str, Any] = Field(default_factory=dict)
    """Start values by the FMU's names."""
    inputs: dict[str, str] = Field(default_factory=dict)
    """By the FMU's names, where each comes from: "component.variable" or "component.variable[1]".

    A signal, an output such as the motion of a body's port, or the output of another FMU.
    """
    outputs: dict[str, str | tuple[str, ...]] = Field(default_factory=dict)
    """By the FMU's names, the tunable parameter or command that each sets, or several; [] for what is only recorded."""

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
