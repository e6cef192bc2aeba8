"""What goes wrong with runs."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

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


@contextmanager
def whole_if_interrupted(name: str, result: Result, what: str, lacks: str = "") -> Iterator[None]:
    """Say to whoever interrupts what follows a run that its result is whole.

    what: such as "it was repeated". lacks: what the result does not have without it.
    """
    try:
        yield
    except (KeyboardInterrupt, InterruptedRunError):
        where = f"the result in {result.path}" if result.path else "the result"
        sentence = f"{name}: interrupted while {what}"
        whole = f"{where} is whole but for {lacks}" if lacks else f"{where} is whole"
        raise InterruptedRunError(f"{sentence}; {whole}", result, sentence) from None
