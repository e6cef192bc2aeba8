"""Small scenes run by the master, in process or as native FMUs, with every observation kept by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
from numpy.typing import ArrayLike

from components.flexible.modal import ModalData
from fmus import native_library
from orchestrator.assembly import Event, HingeLine, Link, Part
from orchestrator.cosim.master import Master
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import Participant, in_process
from orchestrator.cosim.settings import Settings
from orchestrator.cosim.tables import coupling_tables
from orchestrator.run.run import as_fmus
from tests.references.record import Record

HAS_NATIVE = native_library() is not None


class Tolerance(NamedTuple):
    """To which wrenches are iterated: relative to the largest force and torque, and to these (N, N.m)."""

    relative: float
    force: float = 1.0
    torque: float = 1.0

    def tables(self, *scene: Any) -> Mapping[str, ArrayLike]:
        """Those of a coupling that iterates so."""
        tables = coupling_tables(*scene)
        steps, driving = np.asarray(tables["by_tolerance"])[:3], np.asarray(tables["scene"])[2]
        iterated = (0.0, self.relative, self.relative)
        return {**tables, "scene": [self.force, self.torque, driving], "by_tolerance": [*steps, *iterated]}


@dataclass
class Run(Record):
    """A master with what it recorded."""

    master: Master = field(init=False)


def mastered(
    network: Network,
    settings: Settings,
    lines: Sequence[HingeLine] = (),
    events: Sequence[Event] = (),
    iteration: Tolerance | None = None,
) -> Run:
    """A master that records, not yet initialised; `iteration` replaces the tolerance that follows from the settings."""
    run = Run(network)
    tables = coupling_tables if iteration is None else iteration.tables
    with patch("orchestrator.cosim.cosimulation.coupling_tables", tables):
        run.master = Master(network, lines, run, settings, events)
    return run


def prepared(
    parts: Sequence[Part],
    links: Sequence[Link],
    lines: Sequence[HingeLine] = (),
    settings: Settings | None = None,
    commands: Mapping[tuple[str, str], float] | None = None,
    iteration: Tolerance | None = None,
    participants: Sequence[Participant] | None = None,
    events: Sequence[Event] = (),
) -> Run:
    """An initialised scene; `commands` are discrete inputs by (participant, input) that hold from t = 0.

    `participants` replace those in process, `iteration` the tolerance to which wrenches are iterated, in which the
    conservation of angular momentum is to be seen.
    """
    settings = settings or Settings()
    network = Network(participants or in_process(parts), links, settings.order or 2)
    run = mastered(network, settings, lines, events, iteration)
    for (name, key), value in (commands or {}).items():
        participant = network.by_name[name]
        participant.inputs[participant.input_layout[key]] = value
    run.master.initialize(preload=False)
    return run


def completed(
    until: float, parts: Sequence[Part], *scene: Any, native: bool = HAS_NATIVE, **options: Any
) -> Run:
    """The scene of `prepared` after running to `until` (s); as native FMUs, it is unloaded in the end.

    Native FMUs are equal to the components (tests/conformance) and take a tenth of their time.
    """
    assembly = SimpleNamespace(name="scene", parts=parts)
    with as_fmus(assembly, "native") if native else nullcontext(in_process(parts)) as participants:  # type: ignore[arg-type]
        run = prepared(parts, *scene, participants=participants, **options)
        run.master.run(until)
    return run


def rigid(
    name: str,
    mass: float,
    inertia: Sequence[float],
    points: Mapping[str, Sequence[float]],
    center: Sequence[float] = (0.0, 0.0, 0.0),
    **start: Any,
) -> Part:
    """A rigid body with principal inertia (3,) about its centre of mass and one port per point."""
    data = ModalData.rigid(mass, center, np.diag(inertia), points)
    ports = [{"name": p, "point": p} for p in points]
    return Part(name, "body", {"modal": data.to_arrays(), "ports": ports}, start)


def base(**points: Sequence[float]) -> Part:
    """A fixed base named "base" with a port at every point."""
    ports = [{"name": name, "position": tuple(place)} for name, place in points.items()]
    return Part("base", "fixed_base", {"ports": ports}, {})


def between(
    connection: str, first: str, second: str, sides: Sequence[str] = ("inboard", "outboard")
) -> list[Link]:
    """Links of a connection's ports to two body ports given as "body.port"."""
    ends = [tuple(end.split(".")) for end in (first, second)]
    return [Link((body, port), (connection, side)) for (body, port), side in zip(ends, sides, strict=True)]


def turned(axis: Sequence[float], angle: float) -> tuple[float, float, float, float]:
    """Quaternion of a rotation by `angle` about `axis` (unit)."""
    half = 0.5 * angle
    return (float(np.cos(half)), *(float(np.sin(half) * a) for a in axis))
