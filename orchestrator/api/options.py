"""What annotations say of an argument beyond its type: unit and range, or the kind of file.

The command line makes its options from them.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal


@dataclass(frozen=True, slots=True)
class Within:
    """Unit and range of a number."""

    unit: str = "1"
    low: float | None = None
    high: float | None = None
    above: bool = False
    """whether the lower bound itself is excluded"""


@dataclass(frozen=True, slots=True)
class Place:
    """Kind of a file: one to write, one to read, a picture to write, or a folder."""

    kind: Literal["file", "existing", "picture", "folder"]


OutputFile = Annotated[str | Path, Place("file")]
InputFile = Annotated[str | Path, Place("existing")]
Picture = Annotated[Path, Place("picture")]
Folder = Annotated[str | Path, Place("folder")]
Positive = Annotated[int, Within(low=1)]
