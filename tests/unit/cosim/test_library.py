"""The compiled library of the coupling: an error where it is missing or outdated, and no access beyond its arrays."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from fmus import native_library
from orchestrator.cosim import coupling
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import ParticipantError, in_process
from orchestrator.cosim.settings import Settings
from tests.conformance.programs import sanitized
from tests.references.coupled import base, mastered
from tests.unit.cosim import sanitized_runs

pytestmark = pytest.mark.skipif(native_library() is None, reason="no C compiler")


@pytest.fixture(autouse=True)
def anew():
    """The library is looked for again, and once more after that."""
    coupling._library.cache_clear()
    yield
    coupling._library.cache_clear()


def refusal():
    """What a master says that has no library."""
    with pytest.raises(ParticipantError) as caught:
        mastered(Network(in_process([base()]), []), Settings())
    return str(caught.value)


def test_a_missing_library_is_told(monkeypatch):
    """Nothing stands where it belongs."""
    monkeypatch.setattr(coupling, "native_library", lambda: None)
    assert "pip install" in refusal()


def test_a_library_of_another_version_is_told(monkeypatch, tmp_path):
    """What stands there is not what the source makes: no library, or one with records of other sizes."""
    with monkeypatch.context() as patch:
        other = tmp_path / "fanfold.so"
        other.write_bytes(b"of another version")
        patch.setattr(coupling, "native_library", lambda: other)
        assert "another version" in refusal()
    monkeypatch.setattr(coupling, "sizeof", lambda structure: 8)
    assert "another version" in refusal()


def test_runs_are_clean_under_sanitizers(tmp_path_factory):
    """AddressSanitizer sees what leaves an array of NumPy by one number, as Python takes all its memory from malloc."""
    preloaded = sanitized.runtime()
    library = sanitized.library(tmp_path_factory)
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
