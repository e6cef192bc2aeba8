"""The cache of reduced bodies and compressed FMU code."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from components.cache import disk


@dataclass(frozen=True, slots=True)
class Cache:
    """Location and size of the cache; sizes in bytes."""

    folder: Path | None
    """None where nothing can be written"""
    files: int
    size: int
    limit: int
    """beyond which the least recently used files are removed"""
    sentence: str
    """what is wrong with the place, empty where nothing is"""


def cache(clear: bool = False) -> Cache:
    """Location and size of the cache of reduced bodies and compressed FMU code.

    Parameters
    ----------
    clear : bool
        remove all files of the cache; the next runs compute them again

    Returns
    -------
    Cache
        folder, number of files, size (bytes); with `clear` those before the removal
    """
    place = disk.written_folder()
    found = [] if place is None else (disk.clear if clear else disk.entries)(place)
    return Cache(place, len(found), sum(entry.size for entry in found), disk.LIMIT, disk.unwritable_cache())
