"""Files of others opened: what is no file is refused, and whatever fails in reading one is a sentence."""

from __future__ import annotations

import zipfile
from collections.abc import Container, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from numpy.lib import format as npy

from ..contract.component import ComponentError
from ..contract.regular import is_regular

LARGEST = 1_000_000_000
"""Bytes of all matrices that are taken from an archive: two dense ones of 7900 degrees of freedom."""
_HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


@contextmanager
def reading(path: Path, kind: str) -> Iterator[None]:
    """ComponentError where a path is no file, such as a device that never ends, or anything within fails."""
    try:
        if not is_regular(path):
            raise ComponentError(f"{path.name}: is not there, or no file")
        yield
    except ComponentError:
        raise
    except Exception as error:  # libraries do not list what damaged files make of them
        raise ComponentError(f"{path.name}: cannot be read as {kind}: {_reason(error)}") from None


def _reason(error: Exception) -> str:
    """Its first line; its kind as well, but for those that libraries put into words."""
    text = f"{error}".split("\n", 1)[0]
    return text if text and isinstance(error, ValueError | OSError) else f"{type(error).__name__}: {text}"


def arrays(path: Path, wanted: Container[str]) -> Mapping[str, Any]:
    """Arrays of an npz file by name, of those that are wanted; others are not read. To be called within `reading`."""
    with zipfile.ZipFile(path) as archive:
        members = {member.filename.removesuffix(".npy"): member for member in archive.infolist()}
        chosen = {name: member for name, member in members.items() if name in wanted}
        size = sum(member.file_size for member in chosen.values())
        if size > LARGEST:
            raise ComponentError(
                f"{path.name}: its matrices have {size / 1e6:.0f} MB, and {LARGEST / 1e6:.0f} MB are taken; give "
                "sparse ones by their entries (NAME_entries)"
            )
        found = {}
        for name, member in chosen.items():
            with archive.open(member) as stream:
                _refuse_other_size(stream, member.file_size)
            with archive.open(member) as stream:
                found[name] = npy.read_array(stream, allow_pickle=False)
    return found


def _refuse_other_size(stream: IO[bytes], size: int) -> None:
    """ValueError before memory is taken for an array that is not in its member of `size` bytes."""
    version = npy.read_magic(stream)
    if version not in _HEADERS:
        raise ValueError(f"arrays of version {version} are not known")
    shape, _, kind = _HEADERS[version](stream)
    announced = kind.itemsize
    for length in shape:
        announced *= length
    if announced != size - stream.tell():
        raise ValueError(f"an array of {announced} bytes is announced, and there are {size - stream.tell()}")
