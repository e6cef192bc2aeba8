"""Binaries of FMUs, looked at before they are loaded: the loader dies at the end of one that was cut short."""

from __future__ import annotations

import re
import struct
from pathlib import Path

_MAGIC, _64_BITS, _LITTLE_ENDIAN = b"\x7fELF", 2, 1
_HEADER = struct.Struct("<16sHHIQQQIHHHHHH")
_SEGMENT = struct.Struct("<IIQQQQQQ")


_GLIBC = re.compile(rb"\0GLIBC_(\d+)\.(\d+)(?:\.\d+)?(?=\0)")
"""Among the strings of an ELF binary: versions of its symbols, which it needs of the C library."""


def glibc_of(content: bytes) -> tuple[int, int] | None:
    """Oldest version of the GNU C library that an ELF binary runs with; None where it names none."""
    found = [(int(major), int(minor)) for major, minor in _GLIBC.findall(content)]
    return max(found) if found and content.startswith(_MAGIC) else None


def cut_short(path: Path) -> str:
    """What is missing of an ELF binary, as a sentence; empty where nothing is, and for other formats."""
    content = path.read_bytes()
    if content[:6] != _MAGIC + bytes((_64_BITS, _LITTLE_ENDIAN)):
        return ""
    needed = _HEADER.size
    if len(content) >= needed:
        _, _, _, _, _, segments, sections, _, _, size, count, section_size, section_count, _ = (
            _HEADER.unpack_from(content)
        )
        needed = max(segments + size * count, sections + section_size * section_count)
        if len(content) >= needed and size == _SEGMENT.size:
            table = _SEGMENT.iter_unpack(content[segments : segments + size * count])
            needed = max([needed, *(start + length for _, _, start, _, _, length, _, _ in table)])
    if len(content) >= needed:
        return ""
    return f"its binary {path.name} is cut short, it has {len(content)} bytes of {needed} at least"
