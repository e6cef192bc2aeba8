"""What a native FMU carries of its component: `resources/component.bin`, read by `core/data.c`.

Declared variables with their ranges, start values, and the arrays of `Component.native_data`.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from components import Component
from components.contract.quantity import Kind

from .headers import layout_digest

_MAGIC = b"FANFOLD\2"
_HEAD = struct.Struct("<IQ")
"""Of an entry, after its kind: length of its name, number of its elements."""
_KINDS: tuple[Kind, ...] = ("real", "boolean", "integer")
"""By their numbers in `core/data.h`."""
_GROUPS = ("parameter", "input", "output", "observation")


def component_bytes(component: Component, starts: Sequence[float], token: str) -> bytes:
    """The file's content; `starts` are the start values of parameters and inputs, `token` the FMU's guid."""
    arrays = component.native_data()
    if arrays is None:
        raise ValueError(f"{component.kind} has no native kernel")
    numbers: dict[str, ArrayLike] = {
        "sizes": [layout.size for layout in component.layouts],
        "feedthrough": [float(component.feedthrough)],
        "start": starts,
        **_variables(component),
        **_continuous(component),
        **arrays,
    }
    texts = {"kind": component.kind, "token": token, "layout": layout_digest(component)}
    texts.update((f"unit:{q.name}", q.unit) for q in component.parameter_layout.quantities)
    contents = {**{name: text.encode() for name, text in texts.items()}, **component.native_parts()}
    return named_bytes(contents, numbers)


def named_bytes(contents: Mapping[str, bytes], numbers: Mapping[str, ArrayLike]) -> bytes:
    """Texts and arrays by name, as `core/data.c` reads them."""
    return _MAGIC + b"".join(
        [_entry(b"s", name, len(content), content) for name, content in contents.items()]
        + [_numbers(name, values) for name, values in numbers.items()]
    )


def arrays_in(content: bytes, first: int = 0) -> Iterator[tuple[str, int, int]]:
    """Name, place (bytes) and length of every array in a file's content, those of parts within it included."""
    at = len(_MAGIC)
    while at < len(content):
        length, count = _HEAD.unpack_from(content, at + 1)
        begin = at + 1 + _HEAD.size + length
        name = content[begin - length : begin].decode()
        if content[at : at + 1] == b"d":
            yield name, first + begin, count
            at = begin + 8 * count
            continue
        at = begin + count
        if content.startswith(_MAGIC, begin, at):
            for inner, place, size in arrays_in(content[begin:at], first + begin):
                yield f"{name}/{inner}", place, size


def _variables(component: Component) -> Mapping[str, ArrayLike]:
    """Of every quantity, by group and name: offset, size, range, whether it changes at events only, and its kind."""
    found: dict[str, ArrayLike] = {}
    for group, layout in zip(_GROUPS, component.layouts, strict=True):
        for quantity in layout.quantities:
            place = layout[quantity.name]
            low = -np.inf if quantity.minimum is None else quantity.minimum
            high = np.inf if quantity.maximum is None else quantity.maximum
            at_events = float(quantity.variability in ("tunable", "discrete"))
            found[f"{group}:{quantity.name}"] = (
                place.start,
                quantity.size,
                low,
                high,
                at_events,
                _KINDS.index(quantity.kind),
            )
    return found


def _continuous(component: Component) -> Mapping[str, ArrayLike]:
    """Numbers of continuous states and event indicators, and typical sizes; nothing without model exchange."""
    states = component.continuous
    if states is None:
        return {}
    return {"continuous": (len(states.places), states.indicators), "nominals": states.nominals()}


def _numbers(name: str, values: ArrayLike) -> bytes:
    array = np.ascontiguousarray(values, dtype="<f8").ravel()
    return _entry(b"d", name, array.size, array.tobytes())


def _entry(kind: bytes, name: str, count: int, content: bytes) -> bytes:
    encoded = name.encode()
    return kind + _HEAD.pack(len(encoded), count) + encoded + content
