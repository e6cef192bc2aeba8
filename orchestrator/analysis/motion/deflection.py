"""How far bodies are deformed, when they are so most, and when they are quiet again after a prescribed motion."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...results.result import Result

Vector = NDArray[np.float64]

QUIET = 0.05
"""Share of the largest deformation: a body is quiet from when on it moves by no more."""
_LAST = 0.1
"""Part of the time after the motion that must be quiet, so that no swing ends by chance at the end of the run."""
_SLOW = 1e-9  # of the largest rate of a law
_AT_ONCE = 4_000_000  # values held at once


class Deflection(NamedTuple):
    """size: largest displacement (m) of any node against the body's frame, (N,). rows: where it is largest."""

    size: Vector
    row: int
    node: int


class Quiet(NamedTuple):
    """A body after a prescribed motion that ends at a time (s), by its largest deformation (m).

    wait: s from that end until the body swings by no more than a share of it, None where the run is too short to tell.
    left: swing (m) in the last tenth of the time behind the motion.
    """

    body: str
    motion_ends: float
    largest: float
    largest_at: float
    wait: float | None
    left: float

    def sentence(self, end: float) -> str:
        """One or two sentences for reports."""
        start = (
            f"{self.body}: largest deformation {1e3 * self.largest:.4g} mm at {self.largest_at:.4g} s; "
            f"the motion ends at {self.motion_ends:.4g} s"
        )
        limit = f"{100.0 * QUIET:g} % of that"
        if self.wait is None:
            left = f"{1e3 * self.left:.3g} mm"
            return f"{start}. Near {end:g} s it still vibrates by {left}, not long enough below {limit}"
        return f"{start}. {self.wait:.3g} s later the vibration is below {limit}"


def moving(result: Result) -> bool:
    """Whether anything follows a prescribed motion."""
    return bool(result.recording("commanded_distance") or result.recording("shift"))


def deflections(result: Result, bodies: Iterable[str]) -> dict[str, Deflection]:
    """Of bodies with modes."""
    return {name: _deflection(result, name) for name in bodies if _has_shapes(result, name)}


def _has_shapes(result: Result, body: str) -> bool:
    return body in result.geometry and np.size(result.geometry[body].shapes) > 0


def _deflection(result: Result, body: str) -> Deflection:
    shapes = np.asarray(result.geometry[body].shapes)
    eta = result.signal(body, "modal_coordinate").reshape(result.time.size, -1)
    rows = max(1, _AT_ONCE // shapes[..., 0].size)
    parts = [
        np.linalg.norm(np.einsum("dam,rm->rda", shapes, eta[k : k + rows]), axis=2)
        for k in range(0, len(eta), rows)
    ]
    sizes = np.concatenate([part.max(axis=1) for part in parts])
    row = int(np.argmax(sizes))
    node = int(np.argmax(parts[row // rows][row % rows]))
    return Deflection(sizes, row, node)


def motion_end(result: Result) -> float | None:
    """When (s) all laws rest; None where nothing is prescribed or a law still moves at the end."""
    rates = [np.abs(result.signal(name, "commanded_rate")) for name in result.recording("commanded_rate")]
    for variable in ("shift", "turn"):
        steps = [np.diff(result.signal(name, variable)) for name in result.recording(variable)]
        rates += [np.abs(np.append(step, 0.0)) for step in steps]
    last = max((_last_above(rate, _SLOW * rate.max()) for rate in rates), default=-1)
    if last < 0 or last >= result.time.size - 2:
        return None
    return float(result.time[last + 1])


def quiet(result: Result) -> Iterator[Quiet]:
    """Of every body with modes, once the prescribed motion is over."""
    end = motion_end(result)
    if end is None:
        return
    after = result.time >= end
    for name, one in deflections(result, result.recording("modal_coordinate")).items():
        largest = float(one.size[one.row])
        if largest == 0.0:
            continue
        swing = _swing(result, name, after, one.node)
        last = _last_above(swing, QUIET * largest)
        time = result.time[after]
        known = time[last] <= time[-1] - _LAST * (time[-1] - end) if last >= 0 else True
        wait = float(time[last + 1] - end) if known and last + 1 < time.size else None
        left = float(swing[time >= time[-1] - _LAST * (time[-1] - end)].max(initial=0.0))
        yield Quiet(name, end, largest, float(result.time[one.row]), wait, left)


def _swing(result: Result, body: str, rows: NDArray[np.bool_], node: int) -> Vector:
    """Distance (m) of the node that is displaced most from where it comes to rest, the mean over the last half."""
    eta = result.signal(body, "modal_coordinate").reshape(result.time.size, -1)[rows]
    path = eta @ np.asarray(result.geometry[body].shapes)[node].T
    time = result.time[rows]
    weights = np.where(time >= 0.5 * (time[0] + time[-1]), np.gradient(time), 0.0)
    rest = weights @ path / max(float(weights.sum()), np.finfo(float).tiny)
    swing: Vector = np.linalg.norm(path - rest, axis=1)
    return swing


def _last_above(values: Vector, limit: float) -> int:
    """Row of the last value above a limit; -1 where there is none."""
    above = np.flatnonzero(values > limit)
    return int(above[-1]) if above.size else -1
