"""Changes to texts that are sure to have been made: where nothing was found to change, a test would test nothing."""

from __future__ import annotations


def edited(text: str, *changes: tuple[str, str], count: int = -1) -> str:
    """The text with every old part replaced by its new one, in order, all of them or the first `count`."""
    for old, new in changes:
        assert old in text, f"{old!r} is not in the text, so there is nothing to change"
        text = text.replace(old, new, count)
    return text
