"""What a master records, by name."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from orchestrator.cosim.network import Network
from orchestrator.cosim.rows import SCENE_CHANNELS, recorded_layout

Vector = NDArray[np.float64]


@dataclass
class Record:
    """A recorder that keeps everything in memory: times (N,), observations by participant, events."""

    network: Network
    times: list[float] = field(default_factory=list)
    rows: list[Vector] = field(default_factory=list)
    events: list[tuple[float, str, str]] = field(default_factory=list)

    def extend(self, times: Vector, rows: Vector) -> None:
        """Keep copies."""
        self.times += times.tolist()
        self.rows += list(rows)

    def event(self, time: float, component: str, text: str) -> None:
        """Keep it."""
        self.events.append((time, component, text))

    def signal(self, participant: str, observation: str) -> Vector:
        """An observation over time, (N,) or (N, size)."""
        parts = [*self.network.bodies, *self.network.connections]
        i = [part.name for part in parts].index(participant)
        where = parts[i].observation_layout[observation]
        first = sum(recorded_layout(part.observation_layout).size for part in parts[:i])
        values = np.array(self.rows)[:, first + where.start : first + where.stop]
        return values[:, 0] if values.shape[1] == 1 else values

    def scene(self, channel: str) -> Vector:
        """A scene channel over time, (N,)."""
        place = [name for name, _, _ in SCENE_CHANNELS].index(channel)
        return np.array(self.rows)[:, place - len(SCENE_CHANNELS)]
