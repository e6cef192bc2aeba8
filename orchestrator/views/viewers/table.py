"""Signals as a table of comma-separated values (RFC 4180): a line of names with units, then a line a row."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from components.contract.component import Vector

from .output import whole
from .signals import Chosen

_AT_ONCE = 1000
"""Rows that are texts at a time."""
_FORMULA = ("=", "+", "-", "@")
"""What spreadsheets take for the beginning of a formula."""


def write_csv(path: Path, found: Chosen) -> None:
    """Write a table in UTF-8; numbers are as short as it takes to read the same bits back."""
    signals = [found.values(key) for key in found.keys]
    columns = [found.time[:, None], *(values.reshape(found.time.size, -1) for values in signals)]
    with whole(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(_headings(found, signals))
        for first in range(0, found.time.size, _AT_ONCE):
            rows.writerows(np.hstack([column[first : first + _AT_ONCE] for column in columns]).tolist())


def _headings(found: Chosen, signals: Sequence[Vector]) -> Iterator[str]:
    """Name and unit of every column, such as `time (s)` or `panel.frame_position[1] (m)`."""
    yield "time (s)"
    for key, values in zip(found.keys, signals, strict=True):
        name, unit = ".".join(key), found.result.unit(*key)
        guarded = f"'{name}" if name.startswith(_FORMULA) else name
        indices = [""] if values.ndim == 1 else [f"[{k}]" for k in range(1, values.shape[1] + 1)]
        yield from (f"{guarded}{index} ({unit})" for index in indices)
