"""Programs of the tests in processes of their own, because a fault in a binary would end pytest.

They are forked from one that has loaded what they need, which takes longer than most of what they do.
"""

from __future__ import annotations

import json
import os
import runpy
import sys
import tempfile
from multiprocessing import get_context
from pathlib import Path

import pytest

HERE = Path(__file__).parent
_CONTEXT = get_context("forkserver" if hasattr(os, "fork") else "spawn")
_CONTEXT.set_forkserver_preload(["scipy.integrate", "tests.conformance.programs.driver"])
_LONGEST = 300.0


def findings(script, *arguments):
    """The JSON object that a script of this folder prints as its last line."""
    with tempfile.TemporaryDirectory() as folder:
        told = Path(folder) / "told"
        process = _CONTEXT.Process(target=_run, args=(HERE / script, arguments, told))
        process.start()
        process.join(_LONGEST)
        process.kill()  # where it has not ended
        process.join()
        text = told.read_text(encoding="utf-8", errors="replace")
    if process.exitcode:
        pytest.fail(f"{script} {' '.join(arguments)} ended with {process.exitcode}: {text[-2000:]}")
    return json.loads(text.splitlines()[-1])


def _run(script, arguments, told):
    """The script as if the interpreter had been started with it, but that all it prints goes into a file."""
    file = os.open(told, os.O_WRONLY | os.O_CREAT)
    os.dup2(file, 1)
    os.dup2(file, 2)
    sys.argv[:] = [str(script), *arguments]
    runpy.run_path(str(script), run_name="__main__")
