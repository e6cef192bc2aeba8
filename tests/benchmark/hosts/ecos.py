"""Ecos, where it is installed, with one FMU."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from ctypes import CDLL, RTLD_GLOBAL
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ecospy import EcosSimulation

_TBB = "libtbb.so.12"
"""What Ecos needs and its package does not say; that of the package tbb lies where no loader looks."""


def load_tbb() -> None:
    """Load it from there."""
    found = Path(sys.prefix) / "lib" / _TBB
    if found.exists():
        CDLL(str(found), mode=RTLD_GLOBAL)


@contextmanager
def simulation(path: Path, step: float) -> Iterator[EcosSimulation]:
    """An initialised simulation of one FMU as `wing`, at a fixed step (s).

    ImportError or OSError where Ecos is not installed.
    """
    load_tbb()
    from ecospy import EcosSimulation, EcosSimulationStructure

    with EcosSimulationStructure() as structure:
        structure.add_model("wing", path)
        with EcosSimulation(step, structure=structure) as running:
            running.init()
            yield running
