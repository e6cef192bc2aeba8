"""Checkpoints: a file next to a result, from which its run continues bit-identically.

It contains a snapshot of the run, the length of the result, and the settings of the run. It is replaced as a whole, so
a kill leaves the previous one. It is removed when the run reaches its end.
"""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from components.cache.disk import replace_file

from ..cosim.snapshot import Snapshot
from ..results.result_file import Place
from .errors import RunError

_FORMAT = 8
_DIGEST = sha256().digest_size
"""Bytes at the end of the file, that tell any damage."""
_DAMAGES = (OSError, ValueError, KeyError, TypeError, AttributeError, EOFError, zipfile.BadZipFile)
"""What NumPy, JSON and ZIP raise of files whose bytes are not what they should be."""


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """A moment of a run.

    place: rows and events of the result. asked: options of the run. of: digests and versions that must be the same.
    wall_time: s, spent so far.
    """

    snapshot: Snapshot
    place: Place
    asked: Mapping[str, Any]
    of: Mapping[str, str]
    wall_time: float

    def write(self, result: Path) -> None:
        """Write to the file next to a result; RunError if it cannot be written."""
        snapshot = self.snapshot
        numbers = {
            "format": _FORMAT,
            "snapshot": snapshot.numbers,
            "place": self.place,
            "asked": self.asked,
            "of": self.of,
            "wall_time": self.wall_time,
        }
        content = io.BytesIO()
        arrays = {f"array {name}": values for name, values in snapshot.arrays.items()}
        states = {f"state {name}": np.frombuffer(s, np.uint8) for name, s in snapshot.states.items()}
        text = np.frombuffer(json.dumps(numbers).encode(), np.uint8)
        np.savez(content, allow_pickle=False, numbers=text, **arrays, **states)
        path = checkpoint_file(result)
        try:
            replace_file(path, content.getvalue() + sha256(content.getvalue()).digest())
        except OSError as error:
            raise RunError(f"{path}: the checkpoint cannot be written ({error.strerror})") from None

    @classmethod
    def read(cls, result: Path) -> Checkpoint:
        """The checkpoint of a result; RunError where there is none, or a damaged one."""
        path = checkpoint_file(result)
        if not path.is_file():
            raise RunError(
                f"{result}: there is no checkpoint {path.name} to go on from; runs keep one with --checkpoint, until "
                "they are complete"
            )
        try:
            written = path.read_bytes()
            body, digest = written[:-_DIGEST], written[-_DIGEST:]
            if sha256(body).digest() != digest:
                raise ValueError("its check sum is another, or another version wrote it")
            with np.load(io.BytesIO(body), allow_pickle=False) as found:
                content = {name: found[name] for name in found.files}
            numbers = json.loads(content.pop("numbers").tobytes())
            arrays, states = (
                {name[6:]: values for name, values in content.items() if name.startswith(f"{kind} ")}
                for kind in ("array", "state")
            )
            if numbers["format"] != _FORMAT:
                raise RunError(f"{path}: the checkpoint was written by another version of Fanfold")
            return cls(
                Snapshot(numbers["snapshot"], arrays, {name: s.tobytes() for name, s in states.items()}),
                Place(*numbers["place"]),
                numbers["asked"],
                numbers["of"],
                numbers["wall_time"],
            )
        except _DAMAGES as error:
            raise RunError(f"{path}: the checkpoint is damaged and cannot be read ({error})") from None

    def refuse_other(self, name: str, of: Mapping[str, str]) -> None:
        """RunError where a run of other FMUs or versions than this one's is to go on."""
        unlike = sorted(key for key in {*of, *self.of} if of.get(key) != self.of.get(key))
        if unlike:
            raise RunError(
                f"{name}: the run cannot go on as it began, {', '.join(unlike)} "
                f"{'is' if len(unlike) == 1 else 'are'} not the same; run it anew"
            )


def checkpoint_file(result: Path) -> Path:
    """The checkpoint file next to a result."""
    return result.with_name(f"{result.name}.checkpoint")
