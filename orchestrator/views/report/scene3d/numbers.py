"""Numbers as text that a script reads back: base64 of little-endian arrays, and JSON that ends no script."""

from __future__ import annotations

import json
from base64 import b64encode
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

Block = dict[str, Any]
"""kind, shape, data; of whole numbers that stand for others also `scale`: value = whole number x scale of its column"""

_LARGEST = 32767
STEP: Final = 1.0 / _LARGEST
"""Of the largest number of a column: two neighbours of 16 bits are as far apart, and none is off by more than half."""
_HARMFUL: Final = {ord(sign): f"\\u{ord(sign):04x}" for sign in "<>&\u2028\u2029"}


def single(values: ArrayLike) -> Block:
    """In single precision, 24 bits."""
    return _block(np.asarray(values, dtype="<f4"), "f32")


def double(values: ArrayLike) -> Block:
    """Every bit."""
    return _block(np.asarray(values, dtype="<f8"), "f64")


def whole(values: ArrayLike) -> Block:
    """Numbers of nodes and rows."""
    return _block(np.asarray(values, dtype="<u4"), "u32")


def short(values: ArrayLike) -> Block:
    """16 bits a number (..., C), to the largest of each column."""
    exact = np.asarray(values, dtype=float)
    largest = np.abs(exact).max(axis=tuple(range(exact.ndim - 1)), initial=0.0)
    scale = np.where(largest > 0.0, largest, 1.0) * STEP
    found = _block(np.rint(exact / scale).astype("<i2"), "i16")
    return found | {"scale": scale.tolist()}


def _block(values: NDArray[Any], kind: str) -> Block:
    return {"kind": kind, "shape": list(values.shape), "data": b64encode(values.tobytes()).decode()}


def safe_json(content: object) -> str:
    """JSON within a script element: no text in it ends the element or begins another."""
    return json.dumps(content, allow_nan=False).translate(_HARMFUL)
