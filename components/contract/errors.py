"""The root of all errors that are meant for people, and the sentence on a name that is none."""

from collections.abc import Sequence
from difflib import get_close_matches


class FanfoldError(Exception):
    """A sentence, or several in lines: what is wrong, where, and what to do."""


def unknown(given: str, known: Sequence[str], what: str = "key") -> str:
    """A sentence on a name that is not among those known, with the nearest of them."""
    near = get_close_matches(given, known, 1)
    meant = f"; did you mean {near[0]}" if near else ""
    return f"is not a known {what}{meant}; {what}s are {', '.join(known) or 'none'}"
