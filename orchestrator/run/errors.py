"""What goes wrong with runs."""

from __future__ import annotations

from components import FanfoldError

from ..results.result import Result


class RunError(FanfoldError):
    """A run that could not start or did not reach its end: a sentence.

    result: what it did up to there, where it recorded into memory; a file keeps it. reason: the sentence without
    where that is.
    """

    def __init__(self, sentence: str, result: Result | None = None, reason: str | None = None) -> None:
        super().__init__(sentence)
        self.result = result
        self.reason = reason or sentence


class InterruptedRunError(RunError):
    """A run that was interrupted between two steps, by Ctrl-C or what ends jobs."""
