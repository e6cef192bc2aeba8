"""Results in HDF5: written while the run goes, so that an interrupted run can be read, and read back.

    /time                              s, one row per communication point (two at an event, before and after)
    /signals/<component>/<variable>    (N,) or (N, size), attributes `unit` and `description`
    /events/{time, component, event}   equally long
    /statistics                        attributes
    /provenance/<name>                 text
    /geometry/<body>/{positions, shapes, faces}
    /hinge_lines                       JSON text

Rows are collected in memory and written once a second, at the latest when they fill a chunk. The file format
is the one of HDF5 1.8: it has no mark "open for writing" that would keep other tools from an interrupted run.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any, Self

import h5py
import numpy as np
from numpy.typing import NDArray

from ..assembly import Geometry, HingeLine
from .columns import Column, ColumnMaker

if TYPE_CHECKING:
    from components import Layout

Vector = NDArray[np.float64]
Event = tuple[float, str, str]
Scalar = float | int | str

_FORMAT = "fanfold result"
_FORMAT_VERSION = 1
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_ROWS = 1000
_SECONDS = 1.0
_TEXT = h5py.string_dtype("utf-8")
_EVENT_BYTES = 255
_EVENT_TEXT = h5py.string_dtype("utf-8", _EVENT_BYTES)
_HDF5_ERRORS = (OSError, RuntimeError, KeyError, ValueError)


class ResultError(Exception):
    """A sentence for the user: what is wrong with a result, or what it does not hold."""


@dataclass(frozen=True)
class SignalGroup:
    """Signals of one component; their values arrive as one flat array per communication point."""

    component: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    sizes: tuple[int, ...]
    descriptions: tuple[str, ...]

    @classmethod
    def of(cls, component: str, layout: Layout) -> Self:
        """Every quantity of a layout, in its order."""
        found = layout.quantities
        return cls(
            component,
            tuple(q.name for q in found),
            tuple(q.unit for q in found),
            tuple(q.size for q in found),
            tuple(q.description for q in found),
        )


class ResultWriter:
    """Writes a result while the run goes; a context manager that leaves `complete` unset after an exception.

    groups: signals in the order `append` gets their values in; channels of the whole scene are a group named
    "scene". provenance: texts by name (scene, versions, digests).
    """

    def __init__(
        self,
        path: str | Path,
        groups: Sequence[SignalGroup],
        provenance: Mapping[str, str],
        geometry: Mapping[str, Geometry],
        hinge_lines: Sequence[HingeLine],
    ) -> None:
        self.path = Path(path)
        if self.path.is_symlink():  # its target is what is meant
            self.path = self.path.resolve()
        width = sum(sum(group.sizes) for group in groups)
        self._buffer = np.zeros((_ROWS, width + 1))
        self._rows = [row[:-1] for row in self._buffer]
        self._times = self._buffer[:, -1]
        self._start = 0
        self._filled = 0
        self._due = 0.0
        self._events: list[Event] = []
        try:
            self._spare_other_files()
            self.path.unlink(missing_ok=True)  # opening "w" would empty a file that another run is writing
            self._file: Any = h5py.File(self.path, "x", libver=("v108", "v108"))
        except _HDF5_ERRORS as error:
            raise ResultError(f"{self.path}: the result cannot be written here ({_reason(error)})") from None
        self._file.attrs["format"] = _FORMAT
        self._file.attrs["format_version"] = _FORMAT_VERSION
        self._file.attrs["complete"] = False
        maker = ColumnMaker(_ROWS)
        self._columns = self._create_columns(maker, groups)
        clock = {"unit": "s", "description": "Time of the communication points"}
        self._time = maker.make(self._file, "time", slice(width, width + 1), clock)
        self._create_events()
        self._file.create_group("statistics")
        _write_provenance(self._file.create_group("provenance", track_order=True), provenance)
        _write_geometry(self._file.create_group("geometry", track_order=True), geometry)
        lines = json.dumps([asdict(line) for line in hinge_lines])
        self._file.create_dataset("hinge_lines", data=lines, dtype=_TEXT)

    def _spare_other_files(self) -> None:
        """Refuse to replace what cannot be an earlier result, such as a scene or a device given as output."""
        if self.path.exists() and not self.path.is_file():
            raise ResultError(
                f"{self.path}: this is not a file that a result can be written to; name another"
            )
        if self.path.is_file() and self.path.stat().st_size:
            with self.path.open("rb") as file:
                if file.read(len(_SIGNATURE)) != _SIGNATURE:
                    raise ResultError(
                        f"{self.path}: this file is not a result and would be lost; name another"
                    )

    def _create_columns(self, maker: ColumnMaker, groups: Sequence[SignalGroup]) -> list[Column]:
        signals = self._file.create_group("signals", track_order=True)
        columns, position = [], 0
        for group in groups:
            folder = signals.create_group(group.component, track_order=True)
            rows = zip(group.names, group.units, group.sizes, group.descriptions, strict=True)
            for name, unit, size, description in rows:
                where = slice(position, position + size)
                columns.append(maker.make(folder, name, where, {"unit": unit, "description": description}))
                position += size
        return columns

    def _create_events(self) -> None:
        events = self._file.create_group("events")
        kinds = {"time": np.float64, "component": _EVENT_TEXT, "event": _EVENT_TEXT}
        for name, kind in kinds.items():
            events.create_dataset(name, (0,), kind, maxshape=(None,), chunks=(16,))
        events["time"].attrs["unit"] = "s"

    def append(self, time: float, values: Sequence[Vector]) -> None:
        """Add a communication point: one flat array per group, in the order of the groups."""
        k = self._filled
        np.concatenate(values, out=self._rows[k])
        self._times[k] = time
        self._filled = k + 1
        if k + 1 == _ROWS or monotonic() > self._due:
            self.flush()

    def event(self, time: float, component: str, text: str) -> None:
        """Add an event; the text of a latch-up contains "latch"."""
        self._events.append((time, component, text))

    def statistics(self, values: Mapping[str, Scalar]) -> None:
        """Set scalars about the run by name; a name given before gets the new value."""
        for name, value in values.items():
            self._file["statistics"].attrs[name] = value

    def flush(self) -> None:
        """Write what was collected; from then on an interrupted run holds it.

        Times reach the disk after everything else, and readers believe the times. ResultError where it
        cannot be written, or where the file was taken away.
        """
        if not self.path.exists():
            raise ResultError(f"{self.path}: the result was removed while the run was writing it")
        try:
            self._write_rows(self._columns)
            self._append_events("component", [_event_text(event[1]) for event in self._events])
            self._append_events("event", [_event_text(event[2]) for event in self._events])
            self._file.flush()
            self._write_rows([self._time])
            self._append_events("time", [event[0] for event in self._events])
            self._file.flush()
        except _HDF5_ERRORS as error:
            raise ResultError(f"{self.path}: the result cannot be written ({_reason(error)})") from None
        self._events = []
        if self._filled == _ROWS:
            self._start, self._filled = self._start + _ROWS, 0
        self._due = monotonic() + _SECONDS

    def _write_rows(self, columns: Sequence[Column]) -> None:
        if self._filled:
            for column in columns:
                column.write(self._buffer, self._start, self._start + self._filled)

    def _append_events(self, name: str, values: Sequence[float | bytes]) -> None:
        if values:
            dataset = self._file["events"][name]
            before = dataset.shape[0]
            dataset.resize(before + len(values), 0)
            dataset[before:] = values

    def close(self, complete: bool = True) -> None:
        """Write the rest and close the file; complete: the run came to its end."""
        if not self._file:
            return
        try:
            self.flush()
            self._file.attrs.modify("complete", complete)
        finally:
            with suppress(*_HDF5_ERRORS):  # a full disk was told of by the flush before
                self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        self.close(complete=kind is None)


@dataclass(frozen=True)
class Result:
    """A result as read from a file; signals are read when asked for. See `open`."""

    path: Path
    time: Vector
    events: list[Event]
    statistics: Mapping[str, Scalar]
    provenance: Mapping[str, str]
    hinge_lines: tuple[HingeLine, ...]
    geometry: Mapping[str, Geometry]
    complete: bool
    _catalogue: Mapping[str, Mapping[str, tuple[str, str]]] = field(repr=False)

    @classmethod
    def open(cls, path: str | Path) -> Self:
        """Read everything but the signals; ResultError for a file that is no result or is damaged."""
        path = Path(path)
        try:
            with _open_file(path) as file:
                if file.attrs.get("format") != _FORMAT:
                    raise ResultError(f"{path}: this is an HDF5 file, but not a result of Fanfold")
                if int(file.attrs["format_version"]) > _FORMAT_VERSION:
                    raise ResultError(f"{path}: the result was written by a later version of Fanfold")
                found = cls(
                    path,
                    _time(file),
                    _events(file["events"]),
                    {name: _scalar(value) for name, value in file["statistics"].attrs.items()},
                    {name: _text(text) for name, text in file["provenance"].items()},
                    tuple(_hinge_line(line) for line in json.loads(_text(file["hinge_lines"]))),
                    {name: _geometry(group) for name, group in file["geometry"].items()},
                    bool(file.attrs["complete"]),
                    {name: _catalogue(group) for name, group in file["signals"].items()},
                )
        except _HDF5_ERRORS as error:
            raise ResultError(
                f"{path}: the result is damaged and cannot be read ({_reason(error)})"
            ) from None
        if not found.time.size:
            raise ResultError(f"{path}: the run ended before its first communication point was written")
        return found

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components that have signals."""
        return tuple(self._catalogue)

    def variables(self, component: str) -> tuple[str, ...]:
        """Names of the signals of a component."""
        if component not in self._catalogue:
            known = ", ".join(self._catalogue) or "none"
            raise ResultError(f"{self.path}: there is no component {component!r}; components are {known}")
        return tuple(self._catalogue[component])

    def has(self, component: str, variable: str) -> bool:
        """Whether the signal was recorded."""
        return variable in self._catalogue.get(component, {})

    def recording(self, variable: str) -> tuple[str, ...]:
        """Components that recorded the variable."""
        return tuple(name for name, variables in self._catalogue.items() if variable in variables)

    def unit(self, component: str, variable: str) -> str:
        """Unit of a signal, in FMI syntax."""
        return self._entry(component, variable)[0]

    def description(self, component: str, variable: str) -> str:
        """What a signal means."""
        return self._entry(component, variable)[1]

    def _entry(self, component: str, variable: str) -> tuple[str, str]:
        known = self.variables(component)
        if variable not in known:
            raise ResultError(
                f"{self.path}: {component} has no signal {variable!r}; its signals are {', '.join(known)}"
            )
        return self._catalogue[component][variable]

    def signal(self, component: str, variable: str) -> Vector:
        """Values at the times of `time`: shape (N,), or (N, size) for a vector quantity."""
        self._entry(component, variable)
        try:
            with _open_file(self.path) as file:
                values: Vector = file["signals"][component][variable][: self.time.size]
        except _HDF5_ERRORS as error:
            raise ResultError(
                f"{self.path}: {component}.{variable} is damaged and cannot be read ({_reason(error)})"
            ) from None
        return values


def add_statistics(path: str | Path, values: Mapping[str, Scalar]) -> None:
    """Set scalars about a finished run by name; ResultError where the file cannot be written."""
    try:
        with h5py.File(path, "r+") as file:
            for name, value in values.items():
                file["statistics"].attrs[name] = value
    except _HDF5_ERRORS as error:
        raise ResultError(f"{path}: the result cannot be written ({_reason(error)})") from None


def _write_provenance(folder: Any, provenance: Mapping[str, str]) -> None:  # noqa: ANN401
    for name, text in provenance.items():
        folder.create_dataset(name, data=text, dtype=_TEXT)


def _write_geometry(folder: Any, geometry: Mapping[str, Geometry]) -> None:  # noqa: ANN401
    for name, body in geometry.items():
        group = folder.create_group(name)
        group["positions"] = np.asarray(body.positions, dtype=float)
        group["shapes"] = np.asarray(body.shapes, dtype=float)
        group["faces"] = np.asarray(body.faces, dtype=np.int64)


def _open_file(path: Path) -> Any:  # noqa: ANN401
    """The file, open for reading; ResultError if it cannot be."""
    if not path.is_file():
        raise ResultError(f"{path}: there is no such file")
    try:
        if not h5py.is_hdf5(path):
            raise ResultError(f"{path}: this is not a result of Fanfold, nor any other HDF5 file")
        return h5py.File(path, "r")
    except BlockingIOError:
        raise ResultError(f"{path}: the result is still being written; read it after the run") from None
    except OSError as error:
        raise ResultError(
            f"{path}: the file cannot be read, it may be truncated ({_reason(error)})"
        ) from None


def _reason(error: BaseException) -> str:
    """What the operating system or the first line of a library says, without its full stop."""
    if isinstance(error, OSError) and error.errno:
        return os.strerror(error.errno)
    return (str(error).splitlines() or [type(error).__name__])[0].rstrip(".")


def _event_text(text: str) -> bytes:
    """UTF-8 of at most as many bytes as an event takes, cut between characters."""
    return text.encode()[:_EVENT_BYTES].decode(errors="ignore").encode()


def _time(file: Any) -> Vector:  # noqa: ANN401
    """Times of the rows that every signal has; fewer than some have where a run was interrupted."""
    lengths = [d.shape[0] for group in file["signals"].values() for d in group.values()]
    time: Vector = file["time"][: min(lengths, default=None)]
    return time[np.isfinite(time)]


def _events(folder: Any) -> list[Event]:  # noqa: ANN401
    components, texts = folder["component"].asstr()[:], folder["event"].asstr()[:]
    times = folder["time"][:].tolist()
    return [(time, str(name), str(text)) for time, name, text in zip(times, components, texts, strict=False)]


def _text(dataset: Any) -> str:  # noqa: ANN401
    return str(dataset.asstr()[()])


def _scalar(value: Any) -> Scalar:  # noqa: ANN401
    found: Scalar = value.item() if isinstance(value, np.generic) else value
    return found


def _catalogue(group: Any) -> dict[str, tuple[str, str]]:  # noqa: ANN401
    return {name: (str(d.attrs["unit"]), str(d.attrs["description"])) for name, d in group.items()}


def _geometry(group: Any) -> Geometry:  # noqa: ANN401
    return Geometry(group["positions"][:], group["shapes"][:], group["faces"][:])


def _hinge_line(fields: dict[str, Any]) -> HingeLine:
    return HingeLine(**{**fields, "hinges": tuple(fields["hinges"])})
