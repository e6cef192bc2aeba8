"""Every kind of component as an FMU: valid, equal to the component bit for bit, and alone in the world.

FMUs are loaded in subprocesses, because a fault in a binary would end pytest.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from fmus import build_fmu, check_fmu
from tests.conformance.driver import KINDS, Reference, start_of
from tests.conformance.trial import CHECKS

ROOT = Path(__file__).resolve().parents[2]
TRIAL = Path(__file__).with_name("trial.py")

ALONE = """
import sys

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name in ("components", "fmus", "orchestrator", "skfem", "tests"):
            raise ModuleNotFoundError(f"{name} must not be needed")

sys.meta_path.insert(0, Absent())
from fmpy import simulate_fmu
result = simulate_fmu(sys.argv[1], stop_time=0.01, output_interval=0.001)
print(len(result))
"""


@cache
def path_of(kind):
    component = KINDS[kind].example()
    return str(build_fmu(component, kind, start=start_of(component)))


@cache
def findings(checks, *kinds):
    command = [sys.executable, str(TRIAL), checks, *(f"{kind}={path_of(kind)}" for kind in kinds)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
    run = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=ROOT, timeout=300)
    if run.returncode:
        pytest.fail(f"ended with {run.returncode}: {run.stderr[-2000:]}")
    return json.loads(run.stdout.splitlines()[-1])


@pytest.fixture(autouse=True, scope="session")
def cache_of_tests(tmp_path_factory):
    """FMUs of the tests do not end up in the user's cache."""
    before = os.environ.get("FANFOLD_CACHE")
    os.environ["FANFOLD_CACHE"] = str(tmp_path_factory.mktemp("cache"))
    yield
    if before is None:
        del os.environ["FANFOLD_CACHE"]
    else:
        os.environ["FANFOLD_CACHE"] = before


@pytest.mark.parametrize("kind", KINDS)
def test_has_no_problems(kind):
    assert check_fmu(path_of(kind)) == []


@pytest.mark.parametrize("kind", KINDS)
def test_runs_without_fanfold(kind, tmp_path):
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    command = [sys.executable, "-P", "-c", ALONE, path_of(kind)]
    run = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=tmp_path, timeout=120)
    assert run.returncode == 0, run.stderr[-2000:]
    assert run.stdout.split()[-1] == "11"


@pytest.mark.parametrize("check", CHECKS)
@pytest.mark.parametrize("kind", KINDS)
def test_behaves(kind, check):
    assert findings("all", kind)[check] == ""


def test_all_kinds_share_one_process():
    assert findings("together", *KINDS) == {"together": ""}


@pytest.mark.parametrize("kind", KINDS)
def test_outputs_depend_on_inputs_only_with_feedthrough(kind):
    reference = Reference(KINDS[kind].example())
    if reference.component.feedthrough:
        pytest.skip("has feedthrough")
    reference.start()
    before = reference.outputs().tobytes()
    reference.u = reference.u + 1.0
    assert reference.outputs().tobytes() == before
