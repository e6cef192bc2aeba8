"""What a scene becomes before it runs: component instances with start values, and what joins them."""

from __future__ import annotations

import pickle
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from components import Component, Quantity

_MOST_COMPONENTS = 256
_components: dict[bytes, Component] = {}
"""Those that were made last, by their kind and structure."""


@dataclass(frozen=True, slots=True)
class Part:
    """One component instance: its kind in the registry, its structure, and parameter start values by name."""

    name: str
    kind: str
    structure: Mapping[str, Any]
    start: Mapping[str, float | tuple[float, ...]]

    def component(self) -> Component:
        """The component of its structure; equal structures share one, as a component keeps no state."""
        from components import REGISTRY  # helps of commands know parts, and need no numpy

        key = sha256(pickle.dumps((self.kind, dict(self.structure)))).digest()
        if key not in _components:
            if len(_components) >= _MOST_COMPONENTS:
                del _components[next(iter(_components))]
            _components[key] = REGISTRY[self.kind](**self.structure)
        return _components[key]


@dataclass(frozen=True, slots=True)
class Link:
    """A one-to-one connection of a body's port with a connection's port, as (part, port) pairs."""

    body: tuple[str, str]
    connection: tuple[str, str]


@dataclass(frozen=True, slots=True)
class HingeLine:
    """Hinges on one line; the sensor hinge's latch distance locks them all.

    kinematic: latch by impulse. rigid: whether the bodies that it joins are, so that a kinematic latch has no torque
    but that of its lock. deployed_angle: where it is meant to end (rad), of lines that neither a latch nor an end stop
    keeps there. tapes: names of tape springs, which lock it where they are straight. parts: of the bodies that it
    joins; axis: where a run begins, world axes. bolted: whether hold-downs or a drive keep it there. known: the range
    (rad) of its way and of what tables of its motor and harness tell; empty without any. coupled: lines that cable
    loops or gears couple, this one included, and their rates over that of this one; empty without any. inertia:
    effective one at latch-up (kg.m2) as in `effective_inertia` or the scene's own; None without a latch.
    """

    name: str
    hinges: tuple[str, ...]
    sensor: str
    latches: bool
    kinematic: bool
    rigid: bool = False
    deployed_angle: float | None = None
    tapes: tuple[str, ...] = ()
    parts: tuple[str, ...] = ()
    axis: tuple[float, ...] = ()
    bolted: bool = False
    known: tuple[float, ...] = ()
    coupled: tuple[tuple[str, float], ...] = ()
    inertia: float | None = None

    @property
    def latch_event(self) -> str:
        """Text of the event of its latch-up."""
        return f"{self.name} latch-up"

    @property
    def unlatch_event(self) -> str:
        """Text of the event that its latch lets go."""
        return f"{self.name} unlatched"

    @property
    def locks_rigid(self) -> bool:
        """Whether nothing gives way beside its lock, whose torque then says nothing of the wing."""
        return self.kinematic and self.rigid


def bolted_hinges(lines: Iterable[HingeLine]) -> list[str]:
    """Hinges of lines that hold-downs or drives keep where a run begins, so that no search need hold them."""
    return [hinge for line in lines if line.bolted for hinge in line.hinges]


@dataclass(frozen=True, slots=True)
class Condition:
    """A signal of a part, its number `index`, passes a value: `rising` from below, otherwise from above.

    is_sampled: the part is an FMU with signals, whose values change at its communication points only.
    """

    part: str
    variable: str
    index: int
    value: float
    rising: bool
    is_sampled: bool = False


@dataclass(frozen=True, slots=True)
class Setting:
    """A value that a parameter of a part gets in mid-run."""

    part: str
    parameter: str
    value: float | tuple[float, ...]
    unit: str


@dataclass(frozen=True, slots=True)
class Event:
    """What happens at a time (s) or when a condition first holds: parts released, lines latched, parameters set.

    unlatches: lines whose latches let go and stay open; readies: lines whose latches may engage again.
    """

    name: str
    time: float | None
    condition: Condition | None
    releases: tuple[str, ...] = ()
    latches: tuple[str, ...] = ()
    settings: tuple[Setting, ...] = ()
    unlatches: tuple[str, ...] = ()
    readies: tuple[str, ...] = ()

    def also(
        self,
        releases: tuple[str, ...] = (),
        latches: tuple[str, ...] = (),
        settings: tuple[Setting, ...] = (),
        unlatches: tuple[str, ...] = (),
        readies: tuple[str, ...] = (),
    ) -> Self:
        """The event with more that happens, nothing of it twice."""
        return replace(
            self,
            releases=tuple(dict.fromkeys((*self.releases, *releases))),
            latches=tuple(dict.fromkeys((*self.latches, *latches))),
            settings=(*self.settings, *settings),
            unlatches=tuple(dict.fromkeys((*self.unlatches, *unlatches))),
            readies=tuple(dict.fromkeys((*self.readies, *readies))),
        )

    def with_another(self, event: Event) -> Self:
        """The event with all that another one does at the same time, and both names."""
        both = replace(self, name=f"{self.name} and {event.name}")
        return both.also(event.releases, event.latches, event.settings, event.unlatches, event.readies)

    @property
    def text(self) -> str:
        """What it does, for people."""
        done = [f"{name} released" for name in self.releases]
        done += [f"{name} locked" for name in self.latches]
        done += [f"latch of {name} opened" for name in self.unlatches]
        done += [f"latch of {name} ready" for name in self.readies]
        for s in self.settings:
            unit = "" if s.unit == "1" else f" {s.unit}"
            done.append(f"{s.part}.{s.parameter} set to {s.value}{unit}")
        return ", ".join(done)


@dataclass(frozen=True, slots=True)
class Signal:
    """A scalar variable of an FMU, joined to number `index` of an observation, output or parameter of a part.

    An input may also come from another FMU, which is then the part, with its output as the quantity.

    kind: of the variable, as FMI calls its type. factor, offset: make the value that arrives of the one that leaves.
    unit, description: of the variable. start: of a parameter that is set, all its numbers before anything sets it.
    is_impulse: the variable is the impulse of the load that it sets, and acts by what it has grown by over a step.
    says_unit: whether the unit is the FMU's word, and not ours.
    """

    variable: str
    kind: str
    part: str
    quantity: str
    index: int
    factor: float = 1.0
    offset: float = 0.0
    unit: str = "1"
    description: str = ""
    start: tuple[float, ...] = ()
    is_impulse: bool = False
    says_unit: bool = True

    def arriving(self, value: float) -> float:
        """What arrives of a value that leaves."""
        return value * self.factor + self.offset


@dataclass(frozen=True, slots=True)
class SignalFmu:
    """An FMU that reads signals of parts and sets parameters of them, every `step` (s).

    start: values of its parameters by name. inputs: signals that it is given; outputs: those that set parameters. told:
    all outputs that are recorded; events and other FMUs may read them. is_wing: it is a scene as one FMU whose base its
    inputs drive.
    """

    name: str
    path: Path
    step: float
    start: Mapping[str, float | int | bool | str]
    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    told: tuple[Signal, ...] = ()
    is_wing: bool = False

    def recorded(self) -> dict[str, Quantity]:
        """What is recorded of it, by variable, in its own units: inputs, then outputs."""
        from components import Quantity  # needs numpy, see `Part.component`

        signals = {s.variable: s for s in (*self.inputs, *self.told, *self.outputs)}
        return {
            name: Quantity(
                name.replace("/", "_"),
                s.unit,
                s.description or f"Signal of {self.path.name}",
                kind="boolean" if s.kind == "Boolean" else "real",
            )
            for name, s in signals.items()
        }


@dataclass(frozen=True, slots=True)
class Geometry:
    """What a picture of a body needs, in its construction frame; shapes are (D, 3, M)."""

    positions: Any
    shapes: Any
    faces: Any


@dataclass(frozen=True, slots=True)
class Driving:
    """What drives a scene, beside which errors are judged before it moves, and loads that are less.

    energy (J): what motors give on the way to the latch angles, or loads over a run. load (N, N.m): of all at once, and
    no more than one.
    """

    energy: float = 0.0
    load: float = 1.0


@dataclass(frozen=True, slots=True)
class Assembly:
    """A scene at one fidelity, ready to become FMUs or in-process components.

    flexible: names of modal bodies; large_deformation: of beams. at_rest: whether its bodies start where the search of
    static equilibrium has placed them.
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
    driving: Driving = field(default_factory=Driving)
    geometry: Mapping[str, Geometry] = field(default_factory=dict)
    events: tuple[Event, ...] = ()
    large_deformation: tuple[str, ...] = ()
    signal_fmus: tuple[SignalFmu, ...] = ()
    at_rest: bool = False
