"""Datasets of a result that grow row by row, made and written through the low-level interface of HDF5.

A result has a hundred of them, and the high-level interface takes more than twice as long to make them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import h5py
import numpy as np
from numpy.typing import NDArray

_TEXT = h5py.string_dtype("utf-8")


class Column(NamedTuple):
    """A dataset (its low-level identifier) and the columns of the row buffer it takes."""

    dataset: Any
    where: slice
    tail: tuple[int, ...]

    def write(self, buffer: NDArray[np.float64], start: int, end: int) -> None:
        """Make the dataset `end` rows long; the buffer holds the chunk that begins at row `start`."""
        self.dataset.set_extent((end, *self.tail))
        self.dataset.write_direct_chunk((start, *(0 for _ in self.tail)), buffer[:, self.where].tobytes())


class ColumnMaker:
    """Makes columns whose chunks have a given number of rows; what was not written reads as not a number."""

    def __init__(self, rows: int) -> None:
        self._rows = rows
        self._kinds: dict[tuple[int, ...], tuple[Any, Any]] = {}
        self._scalar = h5py.h5s.create(h5py.h5s.SCALAR)
        self._text = h5py.h5t.py_create(_TEXT, logical=True)

    def make(self, folder: Any, name: str, where: slice, attributes: Mapping[str, str]) -> Column:  # noqa: ANN401
        """A column of a group (h5py) with text attributes; (N,) where it takes one number a row, else (N, size)."""
        size = where.stop - where.start
        tail = () if size == 1 else (size,)
        space, properties = self._kind(tail)
        dataset = h5py.h5d.create(folder.id, name.encode(), h5py.h5t.NATIVE_DOUBLE, space, properties)
        for key, text in attributes.items():
            attribute = h5py.h5a.create(dataset, key.encode(), self._text, self._scalar)
            attribute.write(np.array(text, dtype=_TEXT))
        return Column(dataset, where, tail)

    def _kind(self, tail: tuple[int, ...]) -> tuple[Any, Any]:
        """Data space and creation properties, the same for all columns of a shape."""
        if tail not in self._kinds:
            properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
            properties.set_chunk((self._rows, *tail))
            properties.set_fill_value(np.array(np.nan))
            space = h5py.h5s.create_simple((0, *tail), (h5py.h5s.UNLIMITED, *tail))
            self._kinds[tail] = (space, properties)
        return self._kinds[tail]
