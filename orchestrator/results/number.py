"""A headline number."""

from __future__ import annotations

from typing import NamedTuple

from .estimated_errors import Key
from .identifiers import identifier


class Number(NamedTuple):
    """One headline number for people: what, of which component, value, unit, and its estimated error, if known."""

    quantity: str
    of: str
    value: float
    unit: str
    error: float | None = None

    @property
    def key(self) -> Key:
        """Unique key of the number."""
        return self.quantity, self.of

    @property
    def id(self) -> str:
        """Its fixed identifier, such as `latch_time.HL1`, by which commands and files name it."""
        return identifier(self.quantity, self.of)

    def as_dict(self) -> dict[str, str | float | None]:
        """Value, unit and estimated error (None where there is none), for JSON."""
        return {"value": self.value, "unit": self.unit, "estimated_error": self.error}
