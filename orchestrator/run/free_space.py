"""Expected size of a result and free space on its disk, with a warning while a user can still act.

A result on a full disk is readable up to that time, but the run is lost; a result of many gigabytes is hard to read.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from time import monotonic

from ..messages import message
from .progress import Watch

_SECONDS = 1.0
"""Between two looks."""
_SHORTEST = 0.01
"""Part of a run by which it must have gone on between two looks, for its pace to say something of the rest."""
_MEGABYTE, _GIGABYTE = 1e6, 1e9
_LARGE = 5.0 * _GIGABYTE
"""Of a result, from where on its size is told: views read whole signals into memory."""


class FreeSpace:
    """A watch that warns once if a result will not fit on its disk, or will be large, at the end of the run (s).

    Room is reserved for many rows at a time, so growth is measured between two reservations. The rest of the run is
    expected to grow at the same rate.
    """

    def __init__(self, path: Path, end: float, warn: Callable[[str], None], watch: Watch) -> None:
        self._path, self._end, self._warn, self._watch = path, end, warn, watch
        self._looked = monotonic()
        self._size: int | None = None
        self._first: tuple[float, int] | None = None
        self._told = self._told_large = False

    def __call__(self, time: float, h: float) -> None:
        """Show a step, and look at the disk if none did for a second."""
        self._watch(time, h)
        if not self._told and monotonic() - self._looked >= _SECONDS:
            self._looked = monotonic()
            with suppress(OSError):  # what is wrong with the file is for its writer to tell
                self._look(time)

    def _look(self, time: float) -> None:
        size = self._path.stat().st_size
        before, self._size = self._size, size
        if before is None or size <= before:
            return
        if self._first is None:
            self._first = time, size
            return
        begun, least = self._first
        if time - begun < _SHORTEST * self._end:
            return
        needed = (size - least) / (time - begun) * (self._end - time)
        free = shutil.disk_usage(self._path.parent).free
        if needed > free:
            self._told = True
            self._warn(
                message(
                    "W-disk",
                    f"{self._path}: at t = {time:.6g} s the disk has {free / _MEGABYTE:.3g} MB free, and the "
                    f"result needs about {needed / _MEGABYTE:.3g} MB more. Make room now, or stop the run and choose "
                    "another --output; what is written stays readable.",
                )
            )
        elif size + needed > _LARGE and not self._told_large:
            self._told_large = True
            self._warn(
                message(
                    "W-disk",
                    f"{self._path}: the result will take about {(size + needed) / _GIGABYTE:.3g} GB by "
                    f"{self._end:.6g} s. Use --record SECONDS, a larger --tolerance or an earlier --until.",
                )
            )
