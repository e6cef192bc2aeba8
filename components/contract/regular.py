"""Files that are files: no folder, no device that never ends, no name that none can have."""

from __future__ import annotations

from errno import ENOENT
from hashlib import sha256
from pathlib import Path


def is_regular(path: Path) -> bool:
    """Whether there is a file, also of a name that no file can have."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def content(path: Path) -> bytes:
    """All of a file; OSError where there is none, or it cannot be read."""
    if not is_regular(path):
        raise FileNotFoundError(ENOENT, "there is no such file", str(path))
    return path.read_bytes()


def content_digest(path: Path) -> str:
    """SHA-256 of the content of a file, in hexadecimal digits; OSError where it cannot be read."""
    return sha256(content(path)).hexdigest()
