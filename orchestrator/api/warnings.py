"""Warnings of the Python face."""

from __future__ import annotations

import sys
import warnings

from ..messages import code_of


class FanfoldWarning(UserWarning):
    """A problem that an engineer should act on; `code` names its kind, such as "W-motor-short"."""

    @property
    def code(self) -> str:
        """Code of the message, which stays when its wording changes."""
        return code_of(str(self))


def warn(sentence: str) -> None:
    """Issue a FanfoldWarning at the caller's line of code outside of this package."""
    level, frame = 2, sys._getframe(1)
    while (
        frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] == "orchestrator"
    ):
        level, frame = level + 1, frame.f_back
    warnings.warn(sentence, FanfoldWarning, stacklevel=level)
