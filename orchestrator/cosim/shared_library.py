"""One loaded library for all native FMUs of a process, though every FMU file carries its own copy.

The loader maps a file once, however often it is loaded, and the processor's instruction cache then serves
all instances: a chain of 128 panels steps three to four times as fast. Copies are not even unpacked.
"""

from __future__ import annotations

import os
import shutil
import zipfile
import zlib
from functools import cache
from pathlib import Path

from fmpy import extract, sharedLibraryExtension

from components.cache.temporary import process_folder
from fmus import native_library
from fmus.archive import archive_problems
from fmus.description.binaries import binary_member

_MOST_PROBLEMS = 3
"""Problems of an archive that a sentence has; there may be thousands."""


def library_of(unpacked: Path, model_identifier: str) -> Path:
    """Where an unpacked FMU has its binary for this platform, if it has one."""
    return Path(unpacked, binary_member("2.0", model_identifier))


def unpack(path: Path, folder: Path) -> list[Path]:
    """Unpack an FMU into a folder; returns its binaries that equal the library compiled at the installation of Fanfold.

    These have no global state, and links to one copy replace them. ValueError where the archive
    is not one to unpack.
    """
    if problems := list(archive_problems(path, contents=False)):
        raise ValueError("; ".join(problems[:_MOST_PROBLEMS]))
    compiled = native_library()
    if compiled is None:
        extract(str(path), unzipdir=str(folder))
        return []
    own = _members_like(path, compiled)
    extract(str(path), unzipdir=str(folder), include=lambda name: name not in own)
    binaries = [folder / name for name in own]
    for binary in binaries:
        binary.parent.mkdir(parents=True, exist_ok=True)
        _share(compiled, binary)
    return binaries


def _members_like(path: Path, compiled: Path) -> list[str]:
    """Members of an archive with size and CRC-32 of the compiled library, which then takes their place."""
    with zipfile.ZipFile(path) as archive:
        return [m.filename for m in archive.infolist() if (m.file_size, m.CRC) == _size_and_crc(compiled)]


@cache
def _size_and_crc(path: Path) -> tuple[int, int]:
    content = path.read_bytes()
    return len(content), zlib.crc32(content)


def _share(compiled: Path, binary: Path) -> None:
    """Put the compiled library where a binary belongs: a link, or a copy of its own where there are no links."""
    kept = process_folder() / f"fanfold{sharedLibraryExtension}"
    if not kept.exists():
        shutil.copyfile(compiled, kept)
    try:
        os.link(kept, binary)
    except OSError:
        shutil.copyfile(compiled, binary)
