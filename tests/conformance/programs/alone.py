"""Run in a process of its own: FMUs run by FMPy where nothing of Fanfold can be imported, each in a fork of it.

    python -P alone.py FMU [FMU ...]

Prints one JSON object: the number of rows of each result, a sentence where there is none.
"""

from __future__ import annotations

import json
import multiprocessing
import os
import sys

from fmpy import simulate_fmu


class Absent:
    """Finds no module of the project, wherever it may lie."""

    def find_spec(self, name, path=None, target=None):
        if name in ("components", "fmus", "orchestrator", "skfem", "tests"):
            raise ModuleNotFoundError(f"{name} must not be needed")


def simulate(path, rows):
    rows.value = len(simulate_fmu(path, stop_time=0.01, output_interval=0.001))


def told(path):
    context = multiprocessing.get_context("fork" if hasattr(os, "fork") else "spawn")
    rows = context.Value("i", 0)
    process = context.Process(target=simulate, args=(path, rows))
    process.start()
    process.join(60.0)
    process.kill()  # where it has not ended
    process.join()
    return f"ended with {process.exitcode}" if process.exitcode else rows.value


sys.meta_path.insert(0, Absent())
if __name__ == "__main__":
    print(json.dumps({path: told(path) for path in sys.argv[1:]}))
