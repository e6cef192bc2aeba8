"""One loaded library for all native FMUs of a process, though every FMU file carries its own copy.

The loader maps a file once however often it is asked for, and the processor's instruction cache then serves
all instances: a chain of 128 panels steps three to four times as fast.
"""

from __future__ import annotations

import hashlib
import os
from functools import cache
from pathlib import Path

from fmpy import platform, sharedLibraryExtension

from components.cache.temporary import process_folder
from fmus import native_library


def library_of(unpacked: Path, model_identifier: str) -> Path:
    """Where an unpacked FMU has its binary for this platform, if it has one."""
    return Path(unpacked, "binaries", platform, f"{model_identifier}{sharedLibraryExtension}")


def is_own(binary: Path) -> bool:
    """Whether a binary is the one that was compiled when Fanfold was installed here."""
    compiled = native_library()
    return compiled is not None and binary.is_file() and _digest(binary) == _own_digest(compiled)


@cache
def _own_digest(compiled: Path) -> str:
    return _digest(compiled)


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def share_library(binary: Path) -> None:
    """Make a binary that `is_own` a link to the first one, if the file system allows; it has no state of its own."""
    kept = process_folder() / f"fanfold{sharedLibraryExtension}"
    try:
        if not kept.exists():
            os.link(binary, kept)
            return
        replacement = binary.with_suffix(".link")
        os.link(kept, replacement)
        os.replace(replacement, binary)
    except OSError:
        return  # other file systems, or one without links: the FMU's own copy does as well
