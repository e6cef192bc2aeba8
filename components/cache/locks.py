"""Locks on files and folders that the operating system takes back when a process ends, in whatever way."""

from __future__ import annotations

import os
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows: nothing is held, and nothing is taken for abandoned
    fcntl = None  # type: ignore[assignment]

AVAILABLE = fcntl is not None


def hold(path: Path) -> int:
    """Wait for the lock of a file or folder and hold it until the descriptor that is returned is closed."""
    descriptor = os.open(path, os.O_RDONLY)
    if AVAILABLE:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        except OSError:  # a file system without locks
            os.close(descriptor)
            raise
    return descriptor


def is_held(path: Path) -> bool:
    """Whether somebody holds the lock of a file or folder for writing, this process included."""
    if not AVAILABLE:
        return False
    try:
        descriptor = os.open(path, os.O_RDONLY)
    except FileNotFoundError:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)
    return False
