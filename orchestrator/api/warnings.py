"""How people are told of what is not as it should be."""

from __future__ import annotations

import sys
import warnings


class FanfoldWarning(UserWarning):
    """A sentence on a run that is not as it should be."""


def warn(sentence: str) -> None:
    """Warn where the code stands that called us."""
    level, frame = 2, sys._getframe(1)
    while frame.f_back is not None and frame.f_globals["__name__"].partition(".")[0] == "orchestrator":
        level, frame = level + 1, frame.f_back
    warnings.warn(sentence, FanfoldWarning, stacklevel=level)
