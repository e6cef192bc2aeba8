"""Requirements in a scene file: limits of headline numbers."""

from __future__ import annotations

import re
from typing import Annotated, NamedTuple

from pydantic import AfterValidator, Field

from .table import Table

_FORM = re.compile(r"\s*([A-Za-z][\w.]*)\s*([<>])\s*(.*\S)\s*")
_EXAMPLE = "latch_rate.HL1 < 15 deg/s"


class Limit(NamedTuple):
    """A limit of a headline number, by its identifier: the most (`<`) or the least (`>`) that it may be.

    value: with its unit, as it is written.
    """

    number: str
    sign: str
    value: str


def limit(text: str) -> Limit:
    """What a text such as "latch_rate.HL1 < 15 deg/s" means; ValueError with a sentence where it means nothing."""
    found = _FORM.fullmatch(text)
    if found is None:
        raise ValueError(f"is {text!r}; write NUMBER < VALUE or NUMBER > VALUE, as in {_EXAMPLE}")
    return Limit(found[1], found[2], found[3])


def _readable(text: str) -> str:
    limit(text)
    return text


class Requirements(Table):
    """[requirements]: limits of headline numbers by which a run is judged."""

    limits: tuple[Annotated[str, AfterValidator(_readable), Field(examples=[_EXAMPLE])], ...]
    """Limits such as "latch_rate.HL1 < 15 deg/s"; a number without its line holds for every line."""
