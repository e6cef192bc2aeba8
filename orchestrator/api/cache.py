"""The cache of reduced bodies and compressed FMU code."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from components.cache import disk


@dataclass(frozen=True, slots=True)
class Cache:
    """Where the cache is and how large; sizes in bytes."""

    folder: Path | None
    """None where nothing can be written"""
    files: int
    size: int
    limit: int
    """beyond which the least recently used files are removed"""
    sentence: str
    """what is wrong with the place, empty where nothing is"""


def cache(clear: bool = False) -> Cache:
    """The cache as it is; with `clear`, as it was before all its files were removed."""
    place = disk.written_folder()
    found = [] if place is None else (disk.clear if clear else disk.entries)(place)
    return Cache(place, len(found), sum(entry.size for entry in found), disk.LIMIT, disk.unwritable_cache())
