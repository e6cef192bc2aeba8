"""Bytes that are dear to compute, kept in files by the content that they follow from.

A file starts with the SHA-256 of what follows: one that is damaged in any byte is computed again. The least recently
used files go when all together pass `LIMIT`. Where the folder cannot be written to, one of the user's own among the
system's temporary files takes its place, and where that cannot be either, everything is computed every time.
"""

from __future__ import annotations

import hashlib
import os
import re
import stat
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

LIMIT = 500_000_000
"""Bytes of all files together."""
_LEFT = 0.75  # of the limit, so that not every new file makes others go
_DIGEST = hashlib.sha256().digest_size
_NAME = re.compile(r"(?P<group>[a-z]+)-[0-9a-f]{64}(\.tmp\w*)?")


class Entry(NamedTuple):
    """A file of the cache."""

    path: Path
    group: str
    size: int
    used: float
    """time of the last use, s since the epoch"""


def folder() -> Path:
    """Where the files should be: FANFOLD_CACHE, else fanfold in XDG_CACHE_HOME, else ~/.cache/fanfold."""
    if chosen := os.environ.get("FANFOLD_CACHE"):
        return Path(chosen)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fanfold"


def written_folder() -> Path | None:
    """Where files are written: `folder`, else a temporary one; None where neither can be."""
    chosen = folder()
    with suppress(OSError):
        chosen.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=chosen):
            return chosen
    return users_folder()


def unwritable_cache() -> str:
    """What to tell where files cannot be written to where they should be; empty where they can."""
    chosen, place = folder(), written_folder()
    if place == chosen:
        return ""
    instead = "nothing is cached" if place is None else f"{place} is used"
    return f"the cache {chosen} is not writable, so {instead}. Set FANFOLD_CACHE to a writable folder."


def users_folder() -> Path | None:
    """A folder among the temporary files that belongs to this user and is closed to others; None where none can be."""
    user = os.getuid() if hasattr(os, "getuid") else None
    path = Path(tempfile.gettempdir()) / ("fanfold" if user is None else f"fanfold-{user}")
    with suppress(OSError):
        path.mkdir(mode=0o700, exist_ok=True)
        found = path.lstat()
        # what others could have put there is not to be loaded
        if stat.S_ISDIR(found.st_mode) and (
            user is None or (found.st_uid == user and not found.st_mode & 0o077)
        ):
            return path
    return None


def kept(group: str, key: str, build: Callable[[], bytes]) -> bytes:
    """What `build` returns, from the file of `key` if it is there and sound.

    group: a word in small letters that tells what it is; key: 64 hexadecimal digits of all that the bytes follow from.
    """
    name = f"{group}-{key}"
    if (found := _read(folder() / name)) is not None:
        return found
    place = written_folder()
    if place is not None and place != folder() and (found := _read(place / name)) is not None:
        return found
    content = build()
    if place is not None:
        with suppress(OSError):
            replace_file(place / name, hashlib.sha256(content).digest() + content)
            _make_room(place)
    return content


def is_kept(group: str, key: str) -> bool:
    """Whether there is a sound file of this key."""
    places = dict.fromkeys(filter(None, (folder(), written_folder())))
    return any(_read(place / f"{group}-{key}") is not None for place in places)


def _read(path: Path) -> bytes | None:
    """The content of a file, marked as used; None where there is none, or a damaged one."""
    with suppress(OSError):
        stored = path.read_bytes()
        if hashlib.sha256(stored[_DIGEST:]).digest() == stored[:_DIGEST]:
            with suppress(OSError):
                os.utime(path)
            return stored[_DIGEST:]
    return None


def replace_file(path: Path, content: bytes) -> None:
    """Write a file at once or not at all, so that others only ever see it complete."""
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f"{path.name}.tmp")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


def entries(place: Path) -> list[Entry]:
    """The files of the cache in a folder, the least recently used first; what else stands there is none of them."""
    found = []
    with suppress(OSError):
        for path in place.iterdir():
            if match := _NAME.fullmatch(path.name):
                with suppress(OSError):
                    status = path.stat()
                    found.append(Entry(path, match["group"], status.st_size, status.st_mtime))
    return sorted(found, key=lambda entry: entry.used)


def _make_room(place: Path) -> None:
    """Remove the least recently used files where all are larger than the limit."""
    found = entries(place)
    size = sum(entry.size for entry in found)
    if size > LIMIT:
        for entry in found:
            if size <= _LEFT * LIMIT:
                break
            size -= entry.size
            entry.path.unlink(missing_ok=True)


def clear(place: Path) -> list[Entry]:
    """Remove the files of the cache from a folder, and return what they were."""
    found = entries(place)
    for entry in found:
        entry.path.unlink(missing_ok=True)
    return found
