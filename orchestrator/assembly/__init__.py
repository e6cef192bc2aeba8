"""What a scene becomes before it runs: component instances with start values, and what joins them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Part:
    """One component instance: its kind in the registry, its structure, and parameter start values by name."""

    name: str
    kind: str
    structure: Mapping[str, Any]
    start: Mapping[str, float | tuple[float, ...]]


@dataclass(frozen=True, slots=True)
class Link:
    """A one-to-one connection of a body's port with a connection's port, as (part, port) pairs."""

    body: tuple[str, str]
    connection: tuple[str, str]


@dataclass(frozen=True, slots=True)
class HingeLine:
    """Hinges on one line; the sensor hinge's latch distance locks them all.

    kinematic: latch by impulse. rigid: whether the bodies that it joins are, so that a kinematic latch has no torque
    but that of its lock. deployed_angle: where it is meant to end (rad), of lines that neither a
    latch nor an end stop keeps there.
    """

    name: str
    hinges: tuple[str, ...]
    sensor: str
    latches: bool
    kinematic: bool
    rigid: bool = False
    deployed_angle: float | None = None

    @property
    def locks_rigid(self) -> bool:
        """Whether nothing gives way beside its lock, whose torque then says nothing of the wing."""
        return self.kinematic and self.rigid


@dataclass(frozen=True, slots=True)
class Geometry:
    """What a picture of a body needs, in its construction frame; shapes are (D, 3, M)."""

    positions: Any
    shapes: Any
    faces: Any


@dataclass(frozen=True, slots=True)
class Assembly:
    """A scene at one fidelity, ready to become FMUs or in-process components; `flexible` names modal bodies.

    driving_energy (J): what motorisation springs give on the way to the latch angles.
    """

    name: str
    scene_tree: Mapping[str, Any]
    flexible: tuple[str, ...]
    parts: tuple[Part, ...]
    links: tuple[Link, ...]
    hinge_lines: tuple[HingeLine, ...]
    base: str
    until: float
    tolerance: float
    largest_step: float
    preload: bool
    driving_energy: float = 0.0
    geometry: Mapping[str, Geometry] = field(default_factory=dict)
