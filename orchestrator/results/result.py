"""A result, read from its file or kept in memory: times, signals of components, events, provenance."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

import h5py
import numpy as np
from numpy.typing import NDArray

from components import FanfoldError

from ..assembly import Geometry, HingeLine
from ..records import short_repr
from . import parts
from .parts import Event, Meaning, Scalar

Vector = NDArray[np.float64]

FORMAT = "fanfold result"
FORMAT_VERSION = 1
HDF5_ERRORS = (
    OSError, RuntimeError, KeyError, ValueError, TypeError, AttributeError, IndexError, OverflowError, MemoryError,
)  # fmt: skip
"""What h5py and NumPy raise of files whose bytes are not what they should be."""


class ResultError(FanfoldError):
    """A sentence for the user: what is wrong with a result, or what it does not hold."""


@short_repr
@dataclass(frozen=True)
class Result:
    """A result, in a file or in memory (`path` is None); signals of a file are read when asked for. See `open`.

    time: s, shape (N,), one row per communication point, events having two: before and after. events: time (s),
    component, what happened. statistics: scalars about the run. provenance: texts. geometry: by body, for pictures.
    complete: the run came to its end. estimated_errors: of headline numbers by quantity and component, in their units,
    infinite where two runs disagree on whether it happens; empty where none could be estimated, None where none were
    requested.
    """

    path: Path | None
    time: Vector
    events: list[Event]
    statistics: Mapping[str, Scalar]
    provenance: Mapping[str, str]
    hinge_lines: tuple[HingeLine, ...]
    geometry: Mapping[str, Geometry]
    complete: bool
    _catalogue: Mapping[str, Mapping[str, Meaning]] = field(repr=False)
    _signals: Mapping[tuple[str, str], Vector] = field(repr=False, default_factory=dict)
    """of a result in memory"""
    _nouns: Mapping[str, str] = field(repr=False, default_factory=dict)
    estimated_errors: Mapping[tuple[str, str], float] | None = field(repr=False, default=None)

    @classmethod
    def open(cls, path: str | Path) -> Self:
        """Read everything but the signals; ResultError for a file that is no result or is damaged."""
        path = Path(path)
        try:
            with _open_file(path) as file:
                if file.attrs.get("format") != FORMAT:
                    raise ResultError(f"{path}: this is an HDF5 file, but not a result of Fanfold")
                if int(file.attrs["format_version"]) > FORMAT_VERSION:
                    raise ResultError(f"{path}: the result was written by a later version of Fanfold")
                found = cls(
                    path,
                    parts.times(file),
                    parts.events(file["events"]),
                    {name: parts.scalar(value) for name, value in file["statistics"].attrs.items()},
                    {name: parts.text(text) for name, text in file["provenance"].items()},
                    parts.hinge_lines(file["hinge_lines"]),
                    {name: parts.geometry(file, name) for name in file["geometry"]},
                    bool(file.attrs["complete"]),
                    {name: parts.catalogue(name, group) for name, group in file["signals"].items()},
                    _nouns={name: parts.noun(group) for name, group in file["signals"].items()},
                    estimated_errors=parts.estimated_errors(file),
                )
        except HDF5_ERRORS as error:
            raise ResultError(f"{path}: the result is damaged and cannot be read ({reason(error)})") from None
        if not found.time.size:
            raise ResultError(f"{path}: the run ended before its first communication point was written")
        return found

    @property
    def name(self) -> str:
        """Its file, or its scene, for messages."""
        return str(self.path) if self.path is not None else self.provenance.get("scene", "result")

    @property
    def stored_messages(self) -> tuple[str, ...]:
        """Messages of the run, with their codes."""
        return parts.sentences_of(self.provenance.get(parts.MESSAGES, "[]"))

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components that have signals."""
        return tuple(self._catalogue)

    def variables(self, component: str) -> tuple[str, ...]:
        """Names of the signals of a component."""
        if component not in self._catalogue:
            known = ", ".join(self._catalogue) or "none"
            raise ResultError(f"{self.name}: there is no component {component!r}; components are {known}")
        return tuple(self._catalogue[component])

    def has(self, component: str, variable: str) -> bool:
        """Whether the signal was recorded."""
        return variable in self._catalogue.get(component, {})

    def recording(self, variable: str) -> tuple[str, ...]:
        """Components that recorded the variable."""
        return tuple(name for name, variables in self._catalogue.items() if variable in variables)

    def unit(self, component: str, variable: str) -> str:
        """Unit of a signal, in FMI syntax."""
        return self._entry(component, variable).unit

    def description(self, component: str, variable: str) -> str:
        """What a signal means."""
        return self._entry(component, variable).description

    def role(self, component: str, variable: str) -> str:
        """What a signal is to those who show results; empty for most."""
        return self._entry(component, variable).role

    def in_role(self, *roles: str) -> tuple[tuple[str, str], ...]:
        """Components and variables of all signals in one of the roles, in recorded order."""
        every = ((name, v, m) for name, found in self._catalogue.items() for v, m in found.items())
        return tuple((name, variable) for name, variable, meaning in every if meaning.role in roles)

    def noun(self, component: str) -> str:
        """What people call a component of this kind; its own name where the result does not say."""
        return self._nouns.get(component) or component

    def _entry(self, component: str, variable: str) -> Meaning:
        known = self.variables(component)
        if variable not in known:
            raise ResultError(
                f"{self.name}: {component} has no signal {variable!r}; its signals are {', '.join(known)}"
            )
        return self._catalogue[component][variable]

    def signal(self, component: str, variable: str) -> Vector:
        """Values at the times of `time`: shape (N,), or (N, size) for a vector quantity."""
        self._entry(component, variable)
        if self.path is None:
            return self._signals[component, variable]
        try:
            with _open_file(self.path) as file:
                if not parts.ends_alike(file, self.time):
                    raise ResultError(
                        f"{self.name}: another result has taken the place of this one since it was opened; "
                        "open it again"
                    )
                values = parts.signal(file["signals"][component][variable], variable, self.time.size)
        except HDF5_ERRORS as error:
            raise ResultError(
                f"{self.name}: {component}.{variable} is damaged and cannot be read ({reason(error)})"
            ) from None
        return values


def _open_file(path: Path) -> Any:  # noqa: ANN401
    """The file, open for reading; ResultError if it cannot be."""
    if not path.is_file():
        raise ResultError(f"{path}: there is no such file")
    try:
        return h5py.File(path, "r")
    except BlockingIOError:
        raise ResultError(f"{path}: the result is still being written; read it after the run") from None
    except OSError as error:
        if not h5py.is_hdf5(path):
            raise ResultError(f"{path}: this is not a result of Fanfold, nor any other HDF5 file") from None
        raise ResultError(f"{path}: the file cannot be read, it may be truncated ({reason(error)})") from None


def reason(error: BaseException) -> str:
    """What the operating system or the first line of a library says, without its full stop."""
    if isinstance(error, OSError) and error.errno:
        return os.strerror(error.errno)
    if number := re.search(r"\berrno = (\d+)", str(error)):  # as HDF5 passes it on
        return os.strerror(int(number[1]))
    if isinstance(error, AttributeError | TypeError | IndexError):  # Python's words, of what bytes were not
        return "a part of it is missing or is of another kind"
    return (str(error).splitlines() or [type(error).__name__])[0].rstrip(".")
