"""A scene: every table of its file, each checked on its own; `consistency` checks what they say about each other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import Field

from .body_tables import Base, Body
from .connection_tables import Ccl, Connection, Damper
from .damping import StructuralDamping
from .event_tables import Event
from .hinge_line_tables import Friction, HingeLine, Joint
from .signal_tables import Fmu
from .table import ORIGIN, Name, SceneName, Table
from .units import Acceleration, Duration, PositiveRatio, Temperature

TOLERANCES = (1e-10, 0.1)
"""Smallest and largest that can be asked for."""
SMALLEST_STEP = 1e-7
"""Smallest communication step size that can be asked for, s."""


class Header(Table):
    """[scene]: what to run, how long and how accurately."""

    name: SceneName
    """Name of the scene, which names its result too."""
    description: str = ""
    """One line of description, printed by `fanfold list`."""
    author: str = ""
    """Who made the scene, for exported FMUs."""
    version: str = ""
    """Version of the scene, for exported FMUs."""
    license: str = ""
    """Licence or distribution statement of the scene, for exported FMUs."""
    until: Duration
    """Time at which a run ends."""
    tolerance: Annotated[PositiveRatio, Field(ge=TOLERANCES[0], le=TOLERANCES[1])] = 1e-4
    """Relative accuracy of the headline numbers."""
    largest_step: Annotated[Duration, Field(ge=SMALLEST_STEP)] = 0.02
    """Largest communication step."""
    preload: bool = False
    """Whether a run starts in static equilibrium, bodies bent and cables taut."""
    gravity: Acceleration = ORIGIN
    """Gravitational acceleration, world axes."""
    temperature: Temperature | None = None
    """Temperature that chooses values from measured columns `{ temperature = [...], value = [...] }`."""
    phases: tuple[Name, ...] = ()
    """Variants that run one after the other, each from its own start."""
    plugins: tuple[str, ...] = ()
    """Files of components and figures (.py) and of bodies (.toml) that the scene uses, from its folder."""


@dataclass(frozen=True, slots=True)
class SceneTables:
    """Tables of a scene file, with its layers merged into one tree."""

    file: str
    tree: Mapping[str, Any]
    header: Header
    base: Base
    joint: Joint
    structural_damping: StructuralDamping | None
    friction: Friction
    bodies: tuple[Body, ...]
    hinge_lines: tuple[HingeLine, ...]
    loops: tuple[Ccl, ...]
    dampers: tuple[Damper, ...]
    connections: tuple[Connection, ...]
    events: tuple[Event, ...] = ()
    fmus: tuple[Fmu, ...] = ()
    limits: tuple[str, ...] = ()
    """requirements, see `requirement_tables`"""

    def lines_inward(self, body: str) -> Iterator[HingeLine]:
        """The hinge lines that carry a body, from it inward to the base."""
        carrying = {line.outboard: line for line in self.hinge_lines}
        while (line := carrying.get(body)) is not None:
            yield line
            body = line.inboard
