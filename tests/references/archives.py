"""Damage to archives, for tests of what reads them."""

from pathlib import Path

_HEADERS = {b"PK\x03\x04": 6, b"PK\x01\x02": 8}
"""Signatures of a member's local and central header, and the place of the flags in each."""


def mark_encrypted(path: Path) -> None:
    """Set the flag of encryption in both headers of every member of a zip file."""
    content = bytearray(path.read_bytes())
    for mark, place in _HEADERS.items():
        start = -1
        while (start := content.find(mark, start + 1)) >= 0:
            content[start + place] |= 1
    path.write_bytes(content)
