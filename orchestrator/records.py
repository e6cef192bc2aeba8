"""Short representations of public records, which would fill pages with arrays otherwise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from reprlib import Repr
from typing import TypeVar

C = TypeVar("C", bound=type)

_SHORT = Repr()
_SHORT.maxother = _SHORT.maxstring = 40
_NAMED = 4
"""Keys of a mapping that are shown."""


def short_repr(cls: C) -> C:
    """Class decorator of a dataclass: arrays show their shape, long collections their length."""

    def shown(self: object) -> str:
        parts = (
            f"{one.name}={_summary(getattr(self, one.name))}"
            for one in fields(self)  # type: ignore[arg-type]
            if one.repr
        )
        return f"{type(self).__name__}({', '.join(parts)})"

    type.__setattr__(cls, "__repr__", shown)
    return cls


def _summary(value: object) -> str:
    """A few words."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if (shape := getattr(value, "shape", None)) is not None and shape:
        return f"<array {' x '.join(map(str, shape))}>"
    if isinstance(value, Mapping):
        names = [*map(str, list(value)[:_NAMED]), *(["..."] if len(value) > _NAMED else [])]
        return f"<{len(value)}: {', '.join(names)}>" if value else "{}"
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        plain = all(isinstance(one, int | float | str) for one in value)
        if plain and len(value) <= _NAMED:
            return f"({', '.join(map(_summary, value))})"
        return f"<{len(value)} {type(value[0]).__name__}>"
    if hasattr(value, "__dataclass_fields__"):
        return f"<{type(value).__name__}>"
    return _SHORT.repr(value)
