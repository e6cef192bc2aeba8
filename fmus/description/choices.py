"""What FMUs are of: back ends, versions of FMI, and the tools that FMUs name as theirs."""

from __future__ import annotations

from typing import Literal

Backend = Literal["native", "python"]
FmiVersion = Literal["2.0", "3.0"]

NATIVE_TOOL = "Fanfold"
"""Generation tool of native FMUs, which keep no state outside of their instances."""
