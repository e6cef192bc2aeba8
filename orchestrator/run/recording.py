"""What of a finished run its result keeps: all rows and signals, or fewer without any headline number changing.

All rows are kept unless fewer are asked for, as steps are as long as errors of fourth order allow: a straight line over
two of them is off by more than the tolerance nearly everywhere. While a run goes it records all, so that estimates of
errors, checkpoints and what a kill leaves are the same whatever is kept in the end.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from components.contract.roles import ATTITUDE, INTERFACE_LOAD, LOAD

from ..messages import message
from ..results.energy_ledger import rows_of_exchange
from ..results.key_figures import headline, line_latch_torque
from ..results.line_travel import overruns
from ..results.peaks import jumps, sides, tops
from ..results.point_loads import point_loads
from ..results.result import Result, Vector
from ..results.result_file import save
from ..results.signal import EVENT_WIDTH, matches

_BESIDE = 7
"""Rows beside an event or a touch: what interpolants at the edge of a smooth stretch go through and are judged by."""
_AROUND = 3
"""Samples on either side of a high one that its cubics go through or are judged by."""
_POSE = ("frame_position", "frame_orientation", "modal_coordinate", "node_position")
Rows = NDArray[np.int64]
Key = tuple[str, str]


@dataclass(frozen=True, slots=True)
class Recording:
    """What to keep. spacing: s, of rows between events and peaks, None for all rows; signals: patterns, none for all.

    A pattern is as in file names, of COMPONENT or COMPONENT.VARIABLE.
    """

    spacing: float | None = None
    signals: Collection[str] = ()

    def applied(self, result: Result, warn: Callable[[str], None]) -> Result:
        """The result reduced to what is kept, in its file as well; ResultError if that cannot be written.

        warn: called about patterns without a match, which keep all signals.
        """
        if self.spacing is None and not self.signals:
            return result
        kept = _part(result, self._rows(result), self._signals(result, warn))
        told = {
            "recorded_rows": "all" if self.spacing is None else f"one in {self.spacing:g} s, events, peaks"
        }
        if self.signals:
            told["recorded_signals"] = ", ".join(sorted(self.signals))
        kept = replace(kept, provenance={**result.provenance, **told})
        return kept if result.path is None else _replaced(kept, result.path)

    def _rows(self, result: Result) -> Rows:
        if self.spacing is None:
            return np.arange(result.time.size)
        return kept_rows(result, self.spacing)

    def _signals(self, result: Result, warn: Callable[[str], None]) -> set[Key]:
        every = {(name, variable) for name in result.components for variable in result.variables(name)}
        matching = {one: {key for key in every if matches(key, one)} for one in self.signals}
        unmatched = [one for one, keys in matching.items() if not keys]
        if unmatched:
            warn(
                message(
                    "W-signals",
                    f"{result.name}: no signal matches {', '.join(unmatched)}, so all are kept. Use patterns of "
                    f"COMPONENT or COMPONENT.VARIABLE; components are {', '.join(result.components)}.",
                )
            )
        if unmatched or not self.signals:
            return every
        return set().union(*matching.values()) | _of_headline(result)


def kept_rows(result: Result, spacing: float) -> Rows:
    """Rows, in order, of which every headline number and touch comes out as of all rows; one at least per spacing (s).

    Among them are those of the largest and smallest value of every signal.
    """
    time = result.time
    begins = np.flatnonzero(np.diff(np.floor(time / spacing), prepend=-1.0))
    passed = [int(np.searchsorted(time, over.passed_at)) for over in overruns(result).values()]
    chosen = [begins, np.array([*passed, *rows_of_exchange(result)], dtype=np.int64)]
    chosen += [_beside(time, event, event) for event in (time[0], time[-1], *(e[0] for e in result.events))]
    chosen += [_beside(time, time[a], time[b]) for a, b in _touches(result)]
    chosen += [np.array(sorted(_rows_of_peaks(result)), dtype=np.int64)]
    for name in result.components:
        for variable in result.variables(name):
            values = result.signal(name, variable).reshape(time.size, -1)
            chosen += [values.argmin(axis=0), values.argmax(axis=0)] if values.size else []
    return np.unique(np.concatenate(chosen)).astype(np.int64)


def _beside(time: Vector, first: float, last: float) -> Rows:
    """Rows of a stretch of time (s), and some on either side."""
    low = int(np.searchsorted(time, first - EVENT_WIDTH)) - _BESIDE
    high = int(np.searchsorted(time, last + EVENT_WIDTH, side="right")) + _BESIDE
    return np.arange(max(low, 0), min(high, time.size))


def _touches(result: Result) -> Iterator[tuple[int, int]]:
    """First and last row of every stretch in which a contact touches."""
    for name in result.recording("penetration"):
        edges = np.diff(result.signal(name, "penetration") > 0.0, prepend=False, append=False)
        yield from np.flatnonzero(edges).reshape(-1, 2) - [0, 1]


def _rows_of_peaks(result: Result) -> set[int]:
    """Rows that determine the peaks of all loads and latch torques: nodes of their cubics, and of the error bounds."""
    events = jumps(result)
    return {
        row
        for values in _peaked(result)
        for sign in sides(values)
        for segment, found in tops(result.time, sign * values, events)
        for top in found.tolist()
        for row in range(
            max(segment.start, segment.start + top - _AROUND),
            min(segment.stop, segment.start + top + _AROUND + 1),
        )
    }


def _peaked(result: Result) -> Iterator[Vector]:
    """Every signal (N,) with a peak among the headline numbers."""
    yield from (line_latch_torque(result, line) for line in result.hinge_lines)
    for of in result.in_role(INTERFACE_LOAD, ATTITUDE, LOAD):
        yield from result.signal(*of).reshape(result.time.size, -1).T
    yield from (magnitude for _, magnitude in point_loads(result))


@dataclass(frozen=True)
class _Watched(Result):
    """A result that notes which signals are read."""

    read: set[Key] = field(default_factory=set)

    def signal(self, component: str, variable: str) -> Vector:
        self.read.add((component, variable))
        return super().signal(component, variable)


def _of_headline(result: Result) -> set[Key]:
    """Signals that headline numbers are computed from."""
    watched = _Watched(**{one.name: getattr(result, one.name) for one in fields(Result)})
    headline(watched)
    return watched.read


def _part(result: Result, rows: Rows, signals: Collection[Key]) -> Result:
    """Rows and signals of a result, in memory; no body is drawn whose pose is not among them."""
    catalogue = {
        name: {v: result._catalogue[name][v] for v in result.variables(name) if (name, v) in signals}
        for name in result.components
    }
    drawn = {
        name: body
        for name, body in result.geometry.items()
        if all((name, v) in signals for v in _POSE if result.has(name, v))
    }
    return replace(
        result,
        path=None,
        time=result.time[rows],
        geometry=drawn,
        _catalogue={name: found for name, found in catalogue.items() if found},
        _signals={key: result.signal(*key)[rows] for key in signals},
    )


def _replaced(result: Result, path: Path) -> Result:
    """A result in memory in the place of a file, which stays whole until the other is."""
    with TemporaryDirectory(dir=path.parent) as folder:
        written = save(result, Path(folder, path.name))
        os.replace(Path(folder, path.name), path)
    return replace(written, path=path)
