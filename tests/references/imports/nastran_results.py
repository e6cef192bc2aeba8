"""Results that Nastran itself wrote to the op2 files which come with pyYeti: displacements, forces, stresses by mode.

The tables are OUGV1, OEF1X and OES1X1 of real eigenvalue runs: for each mode an IDENT record of 146 words, then a
record with so many words for each node or element (word 10 of IDENT), of which the first is ten times its number.
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np


def by_mode(path: Path, table: str) -> list[tuple[float, dict[int, np.ndarray]]]:
    """Eigenvalue (rad2/s2), and what the table has of each node or element, of every mode."""
    from pyyeti.nastran import op2  # takes long, and whoever collects tests imports this file

    (first, last), _, _ = op2.OP2(str(path)).dbnames[table][-1]
    content = path.read_bytes()[first:last]
    records, place = [], 0
    while place < len(content):
        size = struct.unpack_from("<i", content, place)[0]
        records.append(content[place + 4 : place + 4 + size])
        place += size + 8
    records = [record for record in records if len(record) > 4]
    found = []
    for ident, data in zip(records[3::2], records[4::2], strict=True):
        words, eigenvalue = struct.unpack_from("<i", ident, 36)[0], struct.unpack_from("<f", ident, 20)[0]
        rows = np.frombuffer(data, "<f4").reshape(-1, words)
        numbers = np.frombuffer(data, "<i4").reshape(-1, words)[:, 0] // 10
        found.append(
            (eigenvalue, {int(n): row[1:].astype(float) for n, row in zip(numbers, rows, strict=True)})
        )
    return found
