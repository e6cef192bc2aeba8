"""What a run records: signals of its components, one row a communication point; here into memory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np

from ..assembly import Geometry, HingeLine
from .parts import Event, Meaning, Scalar
from .result import Result, Vector

if TYPE_CHECKING:
    from components import Layout

_ROWS = 1000


@dataclass(frozen=True)
class SignalGroup:
    """Signals of one component; their values arrive as one flat array per communication point."""

    component: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    sizes: tuple[int, ...]
    descriptions: tuple[str, ...]
    roles: tuple[str, ...] = ()
    noun: str = ""

    @classmethod
    def of(cls, component: str, layout: Layout, noun: str = "") -> Self:
        """Every quantity of a layout, in its order."""
        found = layout.quantities
        return cls(
            component,
            tuple(q.name for q in found),
            tuple(q.unit for q in found),
            tuple(q.size for q in found),
            tuple(q.description for q in found),
            tuple(q.role for q in found),
            noun,
        )

    def meanings(self) -> Iterator[tuple[str, int, Meaning]]:
        """Name, size and meaning of every signal."""
        roles = self.roles or ("",) * len(self.names)
        rows = zip(self.names, self.sizes, self.units, self.descriptions, roles, strict=True)
        for name, size, *meaning in rows:
            yield name, size, Meaning(*meaning)


class NoRecorder:
    """Keeps nothing, where what a master leads to is read from the participants."""

    def extend(self, times: Vector, rows: Vector) -> None:
        """Drop rows."""

    def event(self, time: float, component: str, text: str) -> None:
        """Drop an event."""


class MemoryRecorder:
    """Keeps a result in memory while the run goes; what `ResultWriter` is for files, with the same arguments."""

    def __init__(
        self,
        groups: Sequence[SignalGroup],
        provenance: Mapping[str, str],
        geometry: Mapping[str, Geometry],
        hinge_lines: Sequence[HingeLine],
    ) -> None:
        self._groups = groups
        self._provenance, self._geometry, self._hinge_lines = provenance, geometry, tuple(hinge_lines)
        self._width = sum(sum(group.sizes) for group in groups)
        self._blocks: list[Vector] = []
        self._times: list[float] = []
        self._events: list[Event] = []
        self._statistics: dict[str, Scalar] = {}
        self._complete = False

    def extend(self, times: Vector, rows: Vector) -> None:
        """Add communication points (n,), their values (n, all groups in their order)."""
        while len(rows):
            row = len(self._times) % _ROWS
            if row == 0:
                self._blocks.append(np.zeros((_ROWS, self._width)))
            count = min(len(rows), _ROWS - row)
            self._blocks[-1][row : row + count] = rows[:count]
            self._times.extend(times[:count].tolist())
            times, rows = times[count:], rows[count:]

    def event(self, time: float, component: str, text: str) -> None:
        """Add an event; the text of a latch-up contains "latch"."""
        self._events.append((time, component, text))

    def statistics(self, values: Mapping[str, Scalar]) -> None:
        """Set scalars about the run by name; a name given before gets the new value."""
        self._statistics |= values

    def result(self) -> Result:
        """What was recorded up to now."""
        whole = np.empty((len(self._blocks) * _ROWS, self._width))
        for k, block in enumerate(self._blocks):
            own = whole[k * _ROWS : (k + 1) * _ROWS]
            own[:], self._blocks[k] = block, own  # frees the block, so that nothing is in memory twice
        rows = whole[: len(self._times)]
        signals: dict[tuple[str, str], Vector] = {}
        catalogue: dict[str, dict[str, Meaning]] = {}
        place = 0
        for group in self._groups:
            known = catalogue.setdefault(group.component, {})
            for name, size, meaning in group.meanings():
                known[name] = meaning
                signals[group.component, name] = (
                    rows[:, place] if size == 1 else rows[:, place : place + size]
                )
                place += size
        return Result(
            None, np.array(self._times), self._events, self._statistics, self._provenance, self._hinge_lines,
            self._geometry, self._complete, catalogue, signals, {g.component: g.noun for g in self._groups},
        )  # fmt: skip

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        self._complete = kind is None
