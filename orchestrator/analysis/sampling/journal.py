"""The journal of a study: what was asked for, and a line for every sample as soon as it is finished.

It is a text file beside the study's result, and goes when that is whole; a killed study goes on from it. A line that a
kill cut off is one sample that runs again.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any, Self

from components.cache.locks import hold, is_held

from .distributions import StudyError
from .sample import Sample

_FORMAT, _VERSION = "fanfold study", 1
Asked = Mapping[str, Any]
"""What a study was asked for, as JSON holds it."""


class Journal:
    """An open journal, which no other study writes to meanwhile; a context manager."""

    def __init__(self, path: Path, whole: int) -> None:
        """path: of a journal whose first line stands; whole: bytes up to the end of its last whole line."""
        if is_held(path):
            raise StudyError(f"{path}: another study is writing here; wait for it, or name another file")
        self._lock = hold(path)
        os.truncate(path, whole)
        self._file = path.open("a", encoding="utf-8")
        self.path = path

    @classmethod
    def begin(cls, study: Path, asked: Asked) -> Self:
        """A new one for the study of this file; StudyError where an interrupted study would be lost."""
        path = journal_file(study)
        if path.exists():
            raise StudyError(
                f"{path}: an interrupted study stands here; go on with it by `fanfold study {study}`, name another "
                "file, or delete it"
            )
        head = json.dumps({"format": _FORMAT, "version": _VERSION, "asked": asked}) + "\n"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(head, encoding="utf-8")
        return cls(path, len(head.encode()))

    @classmethod
    def resume(cls, study: Path) -> tuple[Self, Asked, list[Sample]]:
        """The one of an interrupted study, what that was asked for, and its finished samples; StudyError for none."""
        path = journal_file(study)
        if not path.is_file():
            absent = "there is no" if study.exists() else "there is neither such a file nor a"
            raise StudyError(f"{study}: {absent} journal {path.name} of an interrupted study to go on with")
        try:
            first, *lines = path.read_bytes().splitlines(keepends=True)
            asked = _asked(json.loads(first))
            samples = [Sample(**json.loads(line)) for line in lines if line.endswith(b"\n")]
        except (OSError, ValueError, TypeError, KeyError) as error:
            raise StudyError(f"{path}: this is no journal of a study, or it is damaged ({error})") from None
        whole = len(first) + sum(len(line) for line in lines if line.endswith(b"\n"))
        return cls(path, whole), asked, samples

    def append(self, sample: Sample) -> None:
        """Write a sample down, so that a kill cannot take it."""
        self._file.write(json.dumps(asdict(sample)) + "\n")
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


def _asked(head: Mapping[str, Any]) -> Asked:
    if head["format"] != _FORMAT or head["version"] != _VERSION:
        raise ValueError(f"it is a {head['format']!r} of version {head['version']}")
    asked: Asked = head["asked"]
    return asked
