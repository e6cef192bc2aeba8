"""The root of all errors that are meant for people, and the sentence on a name that is none."""

from collections.abc import Sequence
from difflib import get_close_matches

_LONGEST = 1000
"""Characters of a text of others, of which nobody reads more."""


class FanfoldError(Exception):
    """A sentence, or several in lines: what is wrong, where, and what to do."""


def nearest(given: str, known: Sequence[str]) -> str:
    """The known name that looks most like one given; empty where none does."""
    return next(iter(get_close_matches(given, known, 1)), "")


def unknown(given: str, known: Sequence[str], what: str = "key") -> str:
    """A sentence on a name that is not among those known, with the nearest of them."""
    near = nearest(given, known)
    meant = f"; did you mean {near}" if near else ""
    return f"is not a known {what}{meant}; {what}s are {', '.join(known) or 'none'}"


def shortened(text: str) -> str:
    """A text of others as people read it, cut off where it goes on and on."""
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]} ... ({len(text)} characters)"
