"""Results written into HDF5 files while the run goes, so that an interrupted run can be read.

    /time                              s, one row per communication point (two at an event, before and after)
    /signals/<component>/<variable>    (N,) or (N, size), attributes `unit` and `description`
    /events/{time, component, event}   equally long
    /estimated_errors/{quantity, of, error}  equally long; absent where none were requested
    /statistics                        attributes
    /provenance/<name>                 text
    /geometry/<body>/{positions, shapes, faces}
    /hinge_lines                       JSON text

Rows are collected in memory and written once a second, however long a step takes, and when they fill a chunk. The
file takes its name when it can be read, and a lock keeps other runs from it. The file format is the one of HDF5 1.8:
it has no mark "open for writing" that would keep other tools from an interrupted run. Room is reserved before rows are
made that need it, for the first ones before the run: HDF5 that meets a full disk or a quota halfway leaves a file that
nobody can read, and rows without room would be lost.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import asdict, replace
from pathlib import Path
from threading import Event as Signal
from threading import Lock, Thread
from typing import Any, NamedTuple, Self
from zlib import crc32

import h5py
import numpy as np

from components.cache.locks import is_held
from components.cache.room import reserve

from ..assembly import Geometry, HingeLine
from .columns import Column, ColumnMaker
from .compact import compact
from .parts import ESTIMATED_ERRORS, MESSAGES, Event, Scalar
from .recorder import SignalGroup
from .result import FORMAT, FORMAT_VERSION, HDF5_ERRORS, Result, ResultError, Vector, reason

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_ROWS = 1000
_SECONDS = 1.0
_TEXT = h5py.string_dtype("utf-8")
_EVENT_BYTES = 255
_EVENT_TEXT = h5py.string_dtype("utf-8", _EVENT_BYTES)
_EVENT_COLUMNS = {"time": np.float64, "component": _EVENT_TEXT, "event": _EVENT_TEXT}
_NODE = 8192
"""Bytes that the index of a dataset grows by at the most with a chunk: its nodes have 64 children, and split in two."""
_EVENT_ROOM = 3 * (16 * _EVENT_BYTES + _NODE)
_ATTRIBUTE_ROOM = 65536
"""Bytes for what closes a run: statistics and the mark that it is complete."""


class Place(NamedTuple):
    """A moment of a run in its result: rows and events before it, and a checksum of both."""

    rows: int
    events: int
    checksum: int


def refuse_to_replace(path: Path) -> None:
    """ResultError where another run is writing, or for what cannot be a result: a scene given as output, a device."""
    if path.exists() and not path.is_file():
        raise ResultError(f"{path}: this is not a file that a result can be written to; name another")
    if path.is_file() and path.stat().st_size:
        with path.open("rb") as file:
            if file.read(len(_SIGNATURE)) != _SIGNATURE:
                raise ResultError(f"{path}: this file is not a result and would be lost; name another")
    with suppress(OSError):  # a file system without locks
        if is_held(path):
            raise ResultError(f"{path}: another run is writing its result here; name another file")
    with suppress(*HDF5_ERRORS), h5py.File(path, "r") as file:  # none is there, or it is damaged
        if file.attrs.get("format") != FORMAT:
            raise ResultError(f"{path}: this file is not a result and would be lost; name another")


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
        self._prepare(path, groups)
        unfinished = self.path.with_name(f"{self.path.name}.new")
        try:
            refuse_to_replace(self.path)
            self._file: Any = h5py.File(unfinished, "w", libver=("v108", "v108"))
        except HDF5_ERRORS as error:
            raise ResultError(f"{self.path}: the result cannot be written here ({reason(error)})") from None
        try:
            self._lay_out(groups, provenance, geometry, hinge_lines)
            self._file.flush()
            self._reserve()
            os.replace(unfinished, self.path)
        except BaseException as error:
            with suppress(*HDF5_ERRORS):  # of a full disk
                self._file.close()
            unfinished.unlink(missing_ok=True)
            if isinstance(error, OSError | RuntimeError):  # of a disk, as HDF5 has them
                raise ResultError(
                    f"{self.path}: the result cannot be written here ({reason(error)})"
                ) from None
            raise
        self._identity = _identity(self.path)

    @classmethod
    def resumed(cls, path: str | Path, groups: Sequence[SignalGroup], place: Place) -> Self:
        """The result of an interrupted run, to go on after a place in it; ResultError where it is not there."""
        writer = cls.__new__(cls)
        writer._prepare(path, groups)
        refuse_to_replace(writer.path)
        try:
            writer._file = h5py.File(writer.path, "r+", libver=("v108", "v108"))
            with ExitStack() as stack:
                stack.callback(writer._file.close)
                writer._find_columns(groups)
                writer._go_back_to(place)
                stack.pop_all()
        except HDF5_ERRORS as error:
            raise ResultError(f"{path}: the result cannot be gone on with ({reason(error)})") from None
        writer._identity = _identity(writer.path)
        return writer

    def _prepare(self, path: str | Path, groups: Sequence[SignalGroup]) -> None:
        self.path = Path(path)
        if self.path.is_symlink():  # its target is what is meant
            self.path = self.path.resolve()
        width = sum(sum(group.sizes) for group in groups)
        self._buffer = np.zeros((_ROWS, width + 1))
        self._times = self._buffer[:, -1]
        self._start = 0
        self._filled = 0
        self._events: list[Event] = []
        self._events_written = 0
        self._rows_checksum = self._events_checksum = 0
        self._reserved = 0
        self._kept: float | None = None
        self._lock, self._closing = Lock(), Signal()
        self._clock = Thread(target=self._flush_by_time, daemon=True)
        self._failure: ResultError | None = None

    def _find_columns(self, groups: Sequence[SignalGroup]) -> None:
        """The columns of a file that is there already."""
        self._columns, position = [], 0
        for group in groups:
            folder = self._file["signals"][group.component]
            for name, size, _ in group.meanings():
                where = slice(position, position + size)
                self._columns.append(Column(folder[name].id, where, folder[name].shape[1:]))
                position += size
        self._time = Column(self._file["time"].id, slice(position, position + 1), ())

    def _go_back_to(self, place: Place) -> None:
        """Drop what was written after a place; the chunk that it lies in is written anew as a whole."""
        rows, events, _ = place
        columns = [(h5py.Dataset(column.dataset), column.where) for column in (*self._columns, self._time)]
        for dataset, _ in columns:
            if len(dataset) < rows or dataset.chunks[0] != _ROWS:
                raise ValueError(f"it has {len(dataset)} rows of {rows}")
        for start in range(0, rows + 1, _ROWS):
            self._start, self._filled = start, min(_ROWS, rows - start)
            for dataset, where in columns:
                found = dataset[start : start + self._filled]
                self._buffer[: self._filled, where] = found if found.ndim == 2 else found[:, None]
            self._turn_over()
        folder = self._file["events"]
        for time, component, text in zip(*(folder[name][:events] for name in _EVENT_COLUMNS), strict=True):
            self._check_event(time, component, text)
        self._events_written = events
        if self._place() != place:
            raise ValueError(
                "rows or events before its checkpoint are not those that were written; run it anew"
            )
        for dataset, _ in columns:
            dataset.resize(rows, 0)
        for dataset in folder.values():
            dataset.resize(events, 0)
        self._kept = float(self._file["time"][-1]) if rows else None

    def place(self) -> Place:
        """How far the result goes, all of it written."""
        with self._lock:
            self._flush()
            return self._place()

    def _place(self) -> Place:
        checksum = crc32(self._buffer[: self._filled].data, self._rows_checksum)
        return Place(self._start + self._filled, self._events_written, checksum ^ self._events_checksum)

    @property
    def is_empty(self) -> bool:
        """Whether no row has reached the file or is on its way."""
        return self._start + self._filled == 0

    def _lay_out(
        self,
        groups: Sequence[SignalGroup],
        provenance: Mapping[str, str],
        geometry: Mapping[str, Geometry],
        hinge_lines: Sequence[HingeLine],
    ) -> None:
        """Everything that does not grow, and empty datasets for what does."""
        width = self._buffer.shape[1] - 1
        self._file.attrs["format"] = FORMAT
        self._file.attrs["format_version"] = FORMAT_VERSION
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

    def _create_columns(self, maker: ColumnMaker, groups: Sequence[SignalGroup]) -> list[Column]:
        signals = self._file.create_group("signals", track_order=True)
        columns, position = [], 0
        for group in groups:
            folder = signals.create_group(group.component, track_order=True)
            folder.attrs["noun"] = group.noun
            for name, size, meaning in group.meanings():
                where = slice(position, position + size)
                columns.append(maker.make(folder, name, where, meaning.attributes()))
                position += size
        return columns

    def _create_events(self) -> None:
        events = self._file.create_group("events")
        for name, kind in _EVENT_COLUMNS.items():
            events.create_dataset(name, (0,), kind, maxshape=(None,), chunks=(16,))
        events["time"].attrs["unit"] = "s"

    def append(self, time: float, values: Sequence[Vector]) -> None:
        """Add a communication point: one flat array per group, in the order of the groups."""
        self.extend(np.array([time]), np.concatenate(values)[None])

    def extend(self, times: Vector, rows: Vector) -> None:
        """Add several points (n,), their values (n, all groups)."""
        if self._failure is not None:
            raise self._failure
        with self._lock:
            while len(rows):
                first = self._filled
                self._filled = min(first + len(rows), _ROWS)
                count = self._filled - first
                self._buffer[first : self._filled, :-1] = rows[:count]
                self._times[first : self._filled] = times[:count]
                times, rows = times[count:], rows[count:]
                if self._filled == _ROWS or self._start + first == 0:
                    self._flush()

    def event(self, time: float, component: str, text: str) -> None:
        """Add an event; the text of a latch-up contains "latch"."""
        with self._lock:
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
        with self._lock:
            self._flush()

    def _flush_by_time(self) -> None:
        """Flush once a second until the file is closed; a failure is raised with the next row."""
        while not self._closing.wait(_SECONDS):
            try:
                self.flush()
            except ResultError as error:
                self._failure = error
                return

    def _flush(self) -> None:
        if _identity(self.path) != self._identity:
            raise ResultError(f"{self.path}: the result was removed or replaced while the run was writing it")
        events = [(time, _event_text(name), _event_text(text)) for time, name, text in self._events]
        try:
            self._reserve()
            self._write_rows(self._columns)
            self._append_events("component", [event[1] for event in events])
            self._append_events("event", [event[2] for event in events])
            self._file.flush()
            self._write_rows([self._time])
            self._append_events("time", [event[0] for event in events])
            self._file.flush()
            self._kept = float(self._times[self._filled - 1]) if self._filled else self._kept
            self._events_written += len(events)
            self._events = []
            for event in events:
                self._check_event(*event)
            self._turn_over()
            self._reserve()
        except HDF5_ERRORS as error:
            kept = "nothing yet" if self._kept is None else f"what was up to t = {self._kept:.6g} s"
            raise ResultError(
                f"{self.path}: the result cannot be written ({reason(error)}); it holds {kept}"
            ) from None

    def _turn_over(self) -> None:
        """Begin the next chunk where this one is full."""
        if self._filled == _ROWS:
            self._rows_checksum = crc32(self._buffer.data, self._rows_checksum)
            self._start, self._filled = self._start + _ROWS, 0

    def _check_event(self, time: float, component: bytes, text: bytes) -> None:
        """Take an event into the checksum."""
        content = np.float64(time).tobytes() + component + b"\0" + text + b"\0"
        self._events_checksum = crc32(content, self._events_checksum)

    def _reserve(self) -> None:
        """Room for the chunk of every column that comes next, and for events; OSError where there is none."""
        begins = self._start >= self._reserved
        if begins or self._events:
            chunk = self._buffer.nbytes + _NODE * (len(self._columns) + 1) if begins else 0
            chunks_of_events = len(self._events) // 16 + 2
            size = self._file.id.get_filesize() + chunk + chunks_of_events * _EVENT_ROOM + _ATTRIBUTE_ROOM
            reserve(self._file.id.get_vfd_handle(), size)
        if begins:
            self._reserved = self._start + _ROWS

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
        self._closing.set()
        if self._clock.is_alive():
            self._clock.join()
        try:
            self.flush()
            self._file.attrs.modify("complete", complete)
        finally:
            with suppress(*HDF5_ERRORS):  # a full disk was told of by the flush before
                size = self._file.id.get_filesize()
                self._file.close()
                if _identity(self.path) == self._identity:
                    os.truncate(self.path, size)  # what was reserved in vain
        if complete:
            with suppress(*HDF5_ERRORS):  # without room for both it stays as it is
                compact(self.path)

    def __enter__(self) -> Self:
        self._clock.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        self.close(complete=kind is None)

    def result(self) -> Result:
        """What was written, once it is closed."""
        return Result.open(self.path)


def save(result: Result, path: str | Path) -> Result:
    """Write a result into a file, replacing an earlier result there, and return it as read from that file."""
    signals = {name: result.variables(name) for name in result.components}
    values = [result.signal(name, variable) for name, found in signals.items() for variable in found]
    sizes = iter([1 if v.ndim == 1 else v.shape[1] for v in values])
    groups = [
        SignalGroup(
            name,
            found,
            tuple(result.unit(name, variable) for variable in found),
            tuple(next(sizes) for _ in found),
            tuple(result.description(name, variable) for variable in found),
            tuple(result.role(name, variable) for variable in found),
            result.noun(name),
        )
        for name, found in signals.items()
    ]
    rows = np.column_stack(values) if values else np.zeros((result.time.size, 0))
    with ResultWriter(path, groups, result.provenance, result.geometry, result.hinge_lines) as writer:
        for time, row in zip(result.time.tolist(), rows, strict=True):
            writer.append(time, [row])
        for event in result.events:
            writer.event(*event)
        writer.statistics(result.statistics)
        writer.close(result.complete)
    found = writer.result()
    return found if result.estimated_errors is None else with_errors(found, result.estimated_errors)


def with_errors(result: Result, errors: Mapping[tuple[str, str], float]) -> Result:
    """The result with estimated errors, in its file as well; ResultError where that cannot be written."""
    columns = (
        ("quantity", [quantity for quantity, _ in errors], _TEXT),
        ("of", [of for _, of in errors], _TEXT),
        ("error", list(errors.values()), np.float64),
    )
    with _changed(result) as file:
        if file is not None:
            file.pop(ESTIMATED_ERRORS, None)
            group = file.create_group(ESTIMATED_ERRORS)
            for name, values, kind in columns:
                group.create_dataset(name, data=values, dtype=kind)
    return replace(result, estimated_errors=errors)


@contextmanager
def _changed(result: Result) -> Iterator[Any]:
    """The file of a result, open to be changed; None for one in memory; ResultError where it cannot be written."""
    if result.path is None:
        yield None
        return
    try:
        with h5py.File(result.path, "r+") as file:
            yield file
    except HDF5_ERRORS as error:
        raise ResultError(f"{result.path}: the result cannot be written ({reason(error)})") from None


def with_messages(result: Result, sentences: Sequence[str]) -> Result:
    """The result with the messages of its run, in its file as well; ResultError where that cannot be written.

    `Result.stored_messages` reads it.
    """
    text = json.dumps(list(dict.fromkeys(sentences)))
    with _changed(result) as file:
        if file is not None:
            file["provenance"].pop(MESSAGES, None)
            _write_provenance(file["provenance"], {MESSAGES: text})
    return replace(result, provenance={**result.provenance, MESSAGES: text})


def _write_provenance(folder: Any, provenance: Mapping[str, str]) -> None:  # noqa: ANN401
    for name, text in provenance.items():
        folder.create_dataset(name, data=text, dtype=_TEXT)


def _write_geometry(folder: Any, geometry: Mapping[str, Geometry]) -> None:  # noqa: ANN401
    for name, body in geometry.items():
        group = folder.create_group(name)
        group["positions"] = np.asarray(body.positions, dtype=float)
        group["shapes"] = np.asarray(body.shapes, dtype=float)
        group["faces"] = np.asarray(body.faces, dtype=np.int64)


def _identity(path: Path) -> tuple[int, int] | None:
    """Identity of a file among files of its name; None if there is none."""
    try:
        status = path.stat()
    except FileNotFoundError:
        return None
    return status.st_dev, status.st_ino


def _event_text(text: str) -> bytes:
    """UTF-8 of at most as many bytes as an event takes, cut between characters."""
    return text.encode()[:_EVENT_BYTES].decode(errors="ignore").encode()
