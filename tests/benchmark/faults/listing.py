"""Faults of a sample, listed with the seeds that repeat them."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple


class Fault(NamedTuple):
    """What did not answer with a sentence: the seed that repeats it, and what happened."""

    seed: int
    what: str


def main(faults: Callable[[int, int, Path], Iterator[Fault]], samples: str, usual: int) -> None:
    """List the faults of COUNT samples, by default the usual number, from FIRST_SEED on; exit code 1 for any."""
    count, first = map(int, (*sys.argv[1:], *(f"{usual}", "0")[len(sys.argv) - 1 :])[:2])
    listed = 0
    with tempfile.TemporaryDirectory() as folder:
        for fault in faults(count, first, Path(folder)):
            listed += 1
            print(f"seed {fault.seed}: {fault.what}", flush=True)
    print(f"{count} {samples} from seed {first}: {listed} answers that are no sentence")
    sys.exit(bool(listed))
