"""Room on a disk, had before it is needed: whoever writes into what is reserved meets no full disk and no quota."""

from __future__ import annotations

import os


def reserve(descriptor: int, size: int) -> None:
    """Make an open file (its descriptor) at least so many bytes long, all of them on the disk.

    OSError where the disk, a quota or a limit of the file's size does not allow it. Where the operating system cannot
    reserve, nothing happens.
    """
    if hasattr(os, "posix_fallocate"):
        os.posix_fallocate(descriptor, 0, size)
