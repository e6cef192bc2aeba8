"""The journal of a study: what was asked for, and a line for every sample as soon as it is finished.

It is a text file beside the study's result, and goes when that is whole; a killed study goes on from it. Every line is
JSON, a tab and its checksum (CRC-32). A line that a kill cut off, or that is damaged, is one sample that runs again.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any, Self
from zlib import crc32

from components.cache.locks import hold, is_held

from .distributions import StudyError
from .sample import Sample

_FORMAT, _VERSION = "fanfold study", 2
Asked = Mapping[str, Any]
"""What a study was asked for, as JSON holds it."""


class Journal:
    """An open journal, which no other study writes to meanwhile; a context manager."""

    def __init__(self, study: Path, whole: int) -> None:
        """study: whose journal has its first line; whole: bytes up to the end of its last line that ends."""
        path = journal_file(study)
        if is_held(path):
            raise StudyError(f"{path}: another study is writing here; wait for it, or name another file")
        self._lock = hold(path)
        os.truncate(path, whole)
        self._file = path.open("ab")
        self.path, self.study = path, study

    @classmethod
    def begin(cls, study: Path, asked: Asked) -> Self:
        """A new one for the study of this file; StudyError where an interrupted study would be lost."""
        path = journal_file(study)
        if path.exists():
            raise StudyError(
                f"{path}: an interrupted study stands here; go on with it by `fanfold study {study}`, name another "
                "file, or delete it"
            )
        head = _line({"format": _FORMAT, "version": _VERSION, "asked": asked})
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(head)
        return cls(study, len(head))

    @classmethod
    def resume(cls, study: Path) -> tuple[Self, Asked, list[Sample]]:
        """The one of an interrupted study, what that was asked for, and its finished samples; StudyError for none."""
        path = journal_file(study)
        if not path.is_file():
            absent = "there is no" if study.exists() else "there is neither such a file nor a"
            raise StudyError(f"{study}: {absent} journal {path.name} of an interrupted study to go on with")
        try:
            text = path.read_bytes()
            whole = text.rfind(b"\n") + 1
            first, *lines = text[:whole].split(b"\n")
            asked = _asked(first)
            samples = {one["index"]: Sample(**one) for one in map(_content, lines) if one is not None}
        except (OSError, ValueError, TypeError, KeyError) as error:
            raise StudyError(f"{path}: this is no journal of a study, or it is damaged ({error})") from None
        return cls(study, whole), asked, list(samples.values())

    def append(self, sample: Sample) -> None:
        """Write a sample down, so that a kill cannot take it."""
        self._file.write(_line(asdict(sample)))
        self._file.flush()

    def remove(self) -> None:
        """Take it away, as its study is whole."""
        with suppress(FileNotFoundError):
            self.path.unlink()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()
        os.close(self._lock)


def journal_file(study: Path) -> Path:
    """The journal of the study that is written to this file."""
    return study.with_name(f"{study.name}.journal")


def _line(content: Mapping[str, Any]) -> bytes:
    text = json.dumps(content).encode()
    return b"%b\t%08x\n" % (text, crc32(text))


def _content(line: bytes) -> dict[str, Any] | None:
    """What a line holds; None where its checksum is not that of its text."""
    text, _, checksum = line.rpartition(b"\t")
    if checksum != b"%08x" % crc32(text):
        return None
    found: dict[str, Any] = json.loads(text)
    return found


def _asked(first: bytes) -> Asked:
    head = _content(first)
    if head is None:
        raise ValueError(
            "its first line is damaged, or of an earlier version of Fanfold; delete it and begin again"
        )
    if head["format"] != _FORMAT or head["version"] != _VERSION:
        raise ValueError(f"it is a {head['format']!r} of version {head['version']}")
    asked: Asked = head["asked"]
    return asked
