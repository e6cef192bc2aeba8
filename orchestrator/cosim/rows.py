"""Rows on their way to a recorder: the last one waits for what components know better one step later."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from math import inf
from typing import Protocol

import numpy as np

from components import LAGGED, Layout

from .participant import Matrix, Participant, Vector

_TELLING = 2
"""Steps whose means tell loads at the end of the last."""


class Recorder(Protocol):
    """Takes what happened, in order."""

    def append(self, time: float, values: Sequence[Vector]) -> None:
        """Observations of every participant, then the scene channels of `SCENE_CHANNELS`."""

    def extend(self, times: Vector, rows: Matrix) -> None:
        """Several such rows (n, values), at their times (n,)."""

    def event(self, time: float, component: str, text: str) -> None:
        """Something switched."""


def recorded_layout(layout: Layout) -> Layout:
    """What is recorded of observations: all but the lagged ones, which correct others."""
    return Layout(q for q in layout.quantities if not q.name.endswith(LAGGED))


class Rows:
    """Passes observations and scene channels to a recorder, those of an accepted step when the next one is known.

    observations: of all participants in order; scene: channels. Both are read with each row. coarse: names of
    participants coupled at order 2, without better values; bodies: of those with loads from connections. recorded:
    indices of recorded observations; corrections (n, 2): indices of corrections of a delayed row, and of the corrected
    observations.
    """

    def __init__(
        self,
        recorder: Recorder,
        participants: Sequence[Participant],
        observations: Vector,
        scene: Vector,
        coarse: Collection[str] = (),
        bodies: Collection[str] = (),
    ) -> None:
        self._recorder = recorder
        self._now, self._held = (observations, scene), (observations.copy(), scene.copy())
        self._time: float | None = None
        self._last = -inf
        layouts = [p.observation_layout for p in participants]
        first = np.cumsum([0, *(layout.size for layout in layouts)]).tolist()
        self._slices = [
            slice(a, a + recorded_layout(layout).size) for a, layout in zip(first, layouts, strict=False)
        ]
        self.recorded = np.concatenate([np.arange(s.start, s.stop, dtype=np.uintp) for s in self._slices])
        pairs = [
            (pair, one)
            for one, a in zip(participants, first, strict=False)
            for pair in _pairs(a, one.observation_layout)
        ]
        self._brought = np.array([told for (_, told), one in pairs if one.name in bodies], dtype=np.uintp)
        known = [pair for pair, one in pairs if one.name not in coarse]
        self.corrections = np.array(known, dtype=np.uintp).reshape(-1, 2)
        self._known, self._corrected = self.corrections.T

    def add(self, time: float) -> None:
        """A row that stands as it is."""
        self.release()
        self._append(time, *self._now)

    def hold(self, time: float, *, continues: bool) -> None:
        """A row that the next one may correct; continues: what is held comes right before, and nothing jumped."""
        observations, scene = self._held
        if continues:
            observations[self._corrected] = self._now[0][self._known]
        self.release()
        observations[:], scene[:] = self._now
        self._time = time

    def roughness(self, time: float, steps: int) -> Vector | None:
        """Differences of loads at the present instant from the delayed ones, if steps end at the same time.

        If steps do not resolve the vibration of joints, an instant may be anywhere in its period. steps: since the last
        event; after one step alone loads are means from before it, and the instant is right.
        """
        if self._time != time:
            return None
        if steps < _TELLING:
            self._held[0][self._corrected] = self._now[0][self._corrected]
            return None
        found: Vector = self._now[0][self._corrected] - self._held[0][self._corrected]
        return found

    def brought(self) -> Vector:
        """What bodies tell of the loads that connections bring them."""
        found: Vector = self._now[0][self._brought]
        return found

    def bring(self, loads: Vector) -> None:
        """Such loads now."""
        self._now[0][self._brought] = loads

    def smooth(self, roughness: Vector) -> None:
        """Take it off loads of the instant after an event, which then are those before it and its jump.

        A load of zero is that of a joint that has let go.
        """
        found = self._now[0][self._corrected]
        self._now[0][self._corrected] = np.where(found == 0.0, 0.0, found - roughness)

    def release(self) -> None:
        """Hand on what is held."""
        if self._time is not None:
            self._append(self._time, *self._held)
            self._time = None

    def held(self) -> tuple[float | None, Vector, Vector]:
        """What is held back: time, None for nothing, observations and channels."""
        return self._time, *self._held

    def held_since(self, time: float | None) -> None:
        """What is held back is of this time, None for nothing."""
        self._time = time

    def take(self, time: float | None, observations: Vector, scene: Vector) -> None:
        """Hold such back."""
        self._time = time
        self._held[0][:], self._held[1][:] = observations, scene

    def extend(self, times: Vector, rows: Matrix) -> None:
        """Hand on rows that were made elsewhere, all of them before the one held."""
        if len(times):
            self._recorder.extend(np.maximum(times, self._last), rows)
            self._last = max(self._last, float(times[-1]))

    def _append(self, time: float, observations: Vector, scene: Vector) -> None:
        # the instant after an event lies behind it, where another may follow at once
        self._last = time = max(time, self._last)
        self._recorder.append(time, [*(observations[part] for part in self._slices), scene])


def _pairs(first: int, layout: Layout) -> Iterator[tuple[int, int]]:
    """Indices of every scalar of a lagged observation, and of its source."""
    for quantity in layout.quantities:
        if quantity.name.endswith(LAGGED):
            known, corrected = layout[quantity.name], layout[quantity.name.removesuffix(LAGGED)]
            yield from ((first + known.start + i, first + corrected.start + i) for i in range(quantity.size))
