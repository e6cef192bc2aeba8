"""Small scenes run by the master in process, with every observation kept by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from components.flexible.modal import ModalData
from orchestrator.assembly import HingeLine, Link, Part
from orchestrator.cosim.cosimulation import SCENE_CHANNELS
from orchestrator.cosim.implicit.convergence import Tolerance
from orchestrator.cosim.master import Master, Settings
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import in_process

Vector = NDArray[np.float64]


@dataclass
class Run:
    """A master with what it recorded: times (N,), and per participant the observations (N, size)."""

    master: Master
    names: list[str] = field(default_factory=list)
    times: list[float] = field(default_factory=list)
    rows: list[list[Vector]] = field(default_factory=list)
    events: list[tuple[float, str, str]] = field(default_factory=list)

    def append(self, time: float, values: Sequence[Vector]) -> None:
        """Called by the master."""
        self.times.append(time)
        self.rows.append([v.copy() for v in values])

    def event(self, time: float, component: str, text: str) -> None:
        """Called by the master."""
        self.events.append((time, component, text))

    def signal(self, participant: str, observation: str) -> Vector:
        """An observation over time, (N,) or (N, size)."""
        index = self.names.index(participant)
        rows = self.master.network.by_name[participant].observation_layout[observation]
        table = np.array([values[index][rows] for values in self.rows])
        return table[:, 0] if table.shape[1] == 1 else table

    def scene(self, channel: str) -> Vector:
        """A scene channel over time."""
        place = [name for name, _, _ in SCENE_CHANNELS].index(channel)
        return np.array([values[-1][place] for values in self.rows])


class Recording:
    """Passes what the master records on to a run that exists only after the master does."""

    def __init__(self) -> None:
        self.run: Run | None = None

    def append(self, time: float, values: Sequence[Vector]) -> None:
        """Called by the master."""
        assert self.run is not None
        self.run.append(time, values)

    def event(self, time: float, component: str, text: str) -> None:
        """Called by the master."""
        assert self.run is not None
        self.run.event(time, component, text)


def prepared(
    parts: Sequence[Part],
    links: Sequence[Link],
    lines: Sequence[HingeLine] = (),
    settings: Settings | None = None,
    commands: Mapping[tuple[str, str], float] | None = None,
    iteration: Tolerance | None = None,
) -> Run:
    """An initialised scene; `commands` are discrete inputs by (participant, input) that hold from t = 0.

    `iteration` replaces the tolerance to which wrenches are iterated, in which the conservation of angular
    momentum is to be seen.
    """
    settings = settings or Settings()
    network = Network(in_process(parts), links, settings.order or 2)
    recording = Recording()
    master = Master(network, lines, recording, settings)
    if iteration is not None:
        master.solver.tolerance = iteration
    run = Run(master, [p.name for p in (*network.bodies, *network.connections)])
    recording.run = run
    for (name, key), value in (commands or {}).items():
        participant = network.by_name[name]
        participant.inputs[participant.input_layout[key]] = value
    master.initialize(preload=False)
    return run


def completed(until: float, *scene: Any, **options: Any) -> Run:
    """The scene of `prepared` after running to `until` (s)."""
    run = prepared(*scene, **options)
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
