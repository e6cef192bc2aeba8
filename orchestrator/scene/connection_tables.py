"""Tables of a scene file about what connects bodies beside hinges."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from .table import Y_AXIS, Axis, Name, Orientation, Seat, Table
from .units import Damping, Force, PeakRate, Radius, Stiffness, TurningDamping

Preset = Literal["spherical", "revolute", "cylindrical", "fixed", "bushing"]


class Pulley(Seat):
    """A pulley fixed to a body."""

    radius: Radius


class Ccl(Table):
    """[[ccl]]: closed cable loop; values of one strand. With a guide the cables are led along that body."""

    name: Name
    axis: Axis = Y_AXIS
    preload: Force
    strand_stiffness: Stiffness
    strand_damping: Damping = 0.0
    pulley_1: Pulley
    pulley_2: Pulley
    guide: Seat | None = None


class Damper(Table):
    """[[damper]]: eddy-current damper that sits at a hinge; a peak rate of 0 is a linear damper."""

    name: Name
    hinge: str
    damping_coefficient: TurningDamping
    peak_rate: PeakRate = 0.0


class Connection(Table):
    """[[connection]]: any registered component between points of bodies, by its own ports and parameters.

    structure: what its constructor takes beside `wrench_mode`, in SI units. parameters: values by the names
    that the component declares, with units. preset: the joint that a hinge is, its x axis along the hinge line; a
    layer of the scene gives its stiffnesses, see `presets`, and it is closed where bodies are placed. axes: of all
    ports in the world, at the start, in place of those of the bodies.
    """

    name: Name
    kind: str
    preset: Preset | None = None
    axes: Orientation | None = None
    ports: dict[str, Seat]
    structure: dict[str, Any] = Field(default_factory=dict)
    parameters: dict[str, Any] = Field(default_factory=dict)
