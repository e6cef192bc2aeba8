"""The compiled library of the master: where it is missing or outdated, that is told; it keeps to its arrays."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from orchestrator.cosim.native import library as module

from fmus.native.compile import COUPLING_FLAGS, FLAGS, compile_files
from tests.conformance.programs import sanitized
from tests.unit.cosim import sanitized_runs


@pytest.fixture
def other(monkeypatch, tmp_path):
    """Where the library is looked for, instead of where it is."""
    monkeypatch.setattr(module, "LIBRARY", tmp_path / "_coupling.so")
    module.library.cache_clear()
    yield module.LIBRARY
    module.library.cache_clear()


def test_a_missing_library_is_told(other):
    """Nothing stands where it belongs."""
    assert "not built" in module.missing_compiled_code()


def test_a_library_of_another_version_is_told(other):
    """What stands there is not what the source makes."""
    other.write_bytes(b"of another version")
    assert "another version" in module.missing_compiled_code()
    assert "pip install" in module.missing_compiled_code()


def test_runs_are_clean_under_sanitizers(tmp_path):
    """AddressSanitizer sees what leaves an array of NumPy by one number, as Python takes all its memory from malloc."""
    preloaded = sanitized.runtime()
    library = tmp_path / "_coupling.so"
    source = module.LIBRARY.parent / "coupling.c"
    compile_files([source], library, (*sanitized.flags(), *COUPLING_FLAGS[len(FLAGS) :]))
    environment = os.environ | {
        "LD_PRELOAD": preloaded,
        "ASAN_OPTIONS": "detect_leaks=0",  # the interpreter's own
        "PYTHONMALLOC": "malloc",
        "PYTHONPATH": str(Path(__file__).parents[3]),
    }
    command = [sys.executable, sanitized_runs.__file__, str(library)]
    run = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=300, check=False)
    assert run.returncode == 0, run.stderr[-3000:]
    counts = [tuple(map(int, line.split())) for line in run.stdout.splitlines()]
    assert all(steps > 10 for steps, _ in counts)
    assert [events for _, events in counts] == [0, 0, 2, 0, 0]
