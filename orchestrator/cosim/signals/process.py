"""The process of an FMU with signals: its requests, and failures with name and time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any, Self

from components.cache.temporary import process_folder
from fmus.host.process import LONGEST_CALL, FmuProcess, HostError

from ...assembly import SignalFmu
from ..participant import ParticipantError
from ..shared_library import unpack

_MOST_WARNINGS = 5
"""Most different warnings of one FMU that are reported."""


class SignalProcess:
    """An FMU in its own process; a context manager. ParticipantError if it fails, crashes or hangs.

    tolerance, until: relative accuracy and end (s) of the run, passed to the FMU. longest_call: time (s) after which a
    call counts as hanging. seconds: wall time spent waiting for it.
    """

    def __init__(
        self, fmu: SignalFmu, tolerance: float, until: float, longest_call: float = LONGEST_CALL
    ) -> None:
        self.fmu, self._tolerance, self._until = fmu, tolerance, until
        self.seconds = 0.0
        self._warnings: dict[str, float] = {}  # and when (s) first
        self._inputs = tuple(signal.variable for signal in fmu.inputs)
        self.outputs = tuple(dict.fromkeys(signal.variable for signal in (*fmu.told, *fmu.outputs)))
        self._folder = TemporaryDirectory(dir=process_folder(), ignore_cleanup_errors=True)
        try:
            unpack(fmu.path, Path(self._folder.name))
            self._process = FmuProcess(longest_call)
        except Exception as error:
            self._folder.cleanup()
            problem = (
                str(error) if isinstance(error, HostError) else f"{fmu.path} cannot be unpacked: {error}"
            )
            raise ParticipantError(f"{fmu.name}: {problem}") from None

    def open(self, values: Sequence[float]) -> list[float]:
        """Initialise at t = 0 with these inputs; the outputs."""
        action = "be initialised at t = 0 s"
        start, inputs = dict(self.fmu.start), self._named(values)
        self._request(0.0, action, "instantiate", self._folder.name, self.fmu.name)
        self._request(0.0, action, "initialize", start, inputs, self._tolerance, self._until)
        found: list[float] = self._request(0.0, action, "get", self.outputs)
        return found

    def sample(self, time: float, h: float, values: Sequence[float]) -> list[float]:
        """The outputs after a step from a time (s) over h, with the inputs of its end."""
        action = f"do a step of {h:g} s at t = {time:.6g} s"
        h = min(h, self._until - time)  # sums of steps may pass the end by round-off
        found: list[float] = self._request(
            time + h, action, "sample", time, h, self._named(values), self.outputs
        )
        return found

    def _named(self, values: Sequence[float]) -> dict[str, float]:
        return dict(zip(self._inputs, values, strict=True))

    def warned(self) -> Iterator[str]:
        """Sentences with its warnings."""
        for text, time in self._warnings.items():
            yield f"{self.fmu.name}: at t = {time:.6g} s it warned: {text}"

    def _request(self, time: float, action: str, name: str, *arguments: object) -> Any:  # noqa: ANN401
        begin = perf_counter()
        try:
            found = self._process.request(name, *arguments)
        except HostError as error:
            raise ParticipantError(f"{self.fmu.name}: cannot {action}: {error}") from None
        finally:
            self.seconds += perf_counter() - begin
            for text in self._process.warned[: _MOST_WARNINGS - len(self._warnings)]:
                self._warnings.setdefault(text, time)
        return found

    def close(self) -> None:
        """End the process, by force where it does not end by itself, and remove the unpacked files."""
        self._process.close()
        self._folder.cleanup()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
