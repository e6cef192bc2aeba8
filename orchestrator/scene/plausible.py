"""Ranges of quantities beyond which a value or its unit is probably a mistake, declared beside each quantity."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf
from typing import NamedTuple

from ..messages import message


class Plausible(NamedTuple):
    """Plausible range of a quantity; metadata of a field of a table, or of a quantity computed from several.

    code: of the warning about a value outside. unit: of the limits. reason: what the limits are. check: what to do.
    """

    code: str
    unit: str = ""
    least: float = -inf
    most: float = inf
    reason: str = ""
    check: str = "Check its unit."

    def warnings(self, quantity: str, value: float) -> Iterator[str]:
        """A message about a value outside the range; none about one within."""
        if not self.least <= value <= self.most:
            unit = f" {self.unit}".rstrip()
            limits = f"below {self.least:.3g}" if value < self.least else f"above {self.most:.3g}"
            reason = f" ({self.reason})" if self.reason else ""
            yield message(self.code, f"{quantity} {value:.3g}{unit} is {limits}{unit}{reason}. {self.check}")
