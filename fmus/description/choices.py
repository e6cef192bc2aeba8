"""What FMUs are of: back ends, versions of FMI and their types, and the tools that FMUs name as theirs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from components.contract.quantity import Kind

Backend = Literal["native", "python"]
FmiVersion = Literal["2.0", "3.0"]
TYPES: Mapping[FmiVersion, Mapping[Kind, str]] = {
    "2.0": {"real": "Real", "boolean": "Boolean", "integer": "Integer"},
    "3.0": {"real": "Float64", "boolean": "Boolean", "integer": "Int32"},
}
"""Types of variables by kinds of quantities."""

NATIVE_TOOL = "Fanfold"
"""Generation tool of native FMUs, which keep no state outside of their instances."""
