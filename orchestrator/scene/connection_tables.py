"""Tables of a scene file about what connects bodies beside hinges."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from .plausible import Plausible
from .table import Y_AXIS, Axis, Name, Orientation, Seat, Table
from .units import Damping, Force, PeakRate, Radius, Stiffness, TurningDamping

Preset = Literal[
    "spherical", "revolute", "cylindrical", "prismatic", "universal", "fixed", "bushing", "distance"
]


class Pulley(Seat):
    """A pulley fixed to a body."""

    radius: Radius
    """Radius of the pulley."""


class Ccl(Table):
    """[[ccl]]: closed cable loop; values of one strand. With a guide the cables are led along that body."""

    name: Name
    """Name of the loop."""
    axis: Axis = Y_AXIS
    """Axis of both pulleys."""
    preload: Force
    """Tension of each strand at the start."""
    strand_stiffness: Annotated[
        Stiffness, Plausible("W-loop-data", "N/m", most=1e8, reason="1 m of steel with 1 cm2 has 2e7")
    ]
    """Stiffness of one strand."""
    strand_damping: Damping = 0.0
    """Damping of one strand."""
    pulley_1: Pulley
    """Pulley on the inboard side."""
    pulley_2: Pulley
    """Pulley on the outboard side."""
    guide: Seat | None = None
    """Where the cables are led along a body in between."""


class Damper(Table):
    """[[damper]]: eddy-current damper that sits at a hinge; a peak rate of 0 is a linear damper."""

    name: Name
    """Name of the damper."""
    hinge: str
    """Name of the hinge at which it sits."""
    damping_coefficient: TurningDamping
    """Torque per rate at low rate."""
    peak_rate: PeakRate = 0.0
    """Rate of the largest torque; 0 is a linear damper."""


class Connection(Table):
    """[[connection]]: any registered component between points of bodies, by its own ports and parameters."""

    name: Name
    """Name of the connection."""
    kind: str
    """Kind of component, of this package or a plugin; with a preset a hinge or a spring."""
    preset: Preset | None = None
    """The joint that a hinge is, x along its line, stiff as [joint] says; it is closed where bodies are placed."""
    axes: Orientation | None = None
    """Axes of all ports in the world, at the start, in place of those of the bodies."""
    ports: dict[str, Seat]
    """Where each port of the component sits, by its name."""
    structure: dict[str, Any] = Field(default_factory=dict)
    """What the constructor of the component takes, in SI units."""
    parameters: dict[str, Any] = Field(default_factory=dict)
    """Values of the parameters that the component declares."""
