"""Every kind of component as an FMU of each back end: valid, equal to the component, and alone in the world.

FMUs are loaded in subprocesses, because a fault in a binary would end pytest.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from functools import cache

import pytest

from fmus import check_fmu, native_backend, native_library
from fmus.native import compiler
from tests.conformance.programs import apart
from tests.conformance.programs.driver import KINDS, Reference, built, start_of
from tests.conformance.programs.trial import CHECKS

BACKENDS = {
    "python": list(KINDS),
    "native": [kind for kind, component in KINDS.items() if native_backend(component.example())],
}
SUBJECTS = [
    pytest.param(kind, backend, id=f"{kind}-{backend}") for backend in BACKENDS for kind in BACKENDS[backend]
]


@cache
def path_of(kind, backend):
    component = KINDS[kind].example()
    return str(built(component, kind, start=start_of(component), backend=backend))


@cache
def findings(backend, checks, *kinds):
    return apart.findings(
        "trial.py", backend, checks, *(f"{kind}={path_of(kind, backend)}" for kind in kinds)
    )


def rows_alone(paths, folder):
    """Rows of the results of FMUs in a world without Fanfold."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    command = [sys.executable, "-P", str(apart.HERE / "alone.py"), *paths]
    run = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=folder, timeout=300)
    assert run.returncode == 0, run.stderr[-2000:]
    return json.loads(run.stdout.splitlines()[-1])


@pytest.mark.parametrize(("kind", "backend"), SUBJECTS)
def test_has_no_problems(kind, backend):
    assert check_fmu(path_of(kind, backend)) == []


@pytest.mark.parametrize("backend", BACKENDS)
def test_all_run_without_fanfold(backend, tmp_path):
    paths = [path_of(kind, backend) for kind in BACKENDS[backend]]
    assert rows_alone(paths, tmp_path) == dict.fromkeys(paths, 11)


@pytest.mark.parametrize("check", CHECKS)
@pytest.mark.parametrize(("kind", "backend"), SUBJECTS)
def test_behaves(kind, backend, check):
    assert findings(backend, "all", kind)[check] == ""


@pytest.mark.parametrize("backend", BACKENDS)
def test_all_kinds_share_one_process(backend):
    assert findings(backend, "together", *BACKENDS[backend]) == {"together": ""}


@pytest.mark.parametrize("kind", KINDS)
def test_outputs_depend_on_inputs_only_with_feedthrough(kind):
    reference = Reference(KINDS[kind].example())
    if reference.component.feedthrough:
        pytest.skip("has feedthrough")
    reference.start()
    before = reference.outputs().tobytes()
    reference.u = reference.u + 1.0
    assert reference.outputs().tobytes() == before


@pytest.mark.parametrize("kind", BACKENDS["native"])
def test_step_derivatives_are_those_of_whole_steps(kind):
    """Central differences of save, set, doStep, get, restore; their own error is below 1e-7 for these steps."""
    errors = apart.findings("derivatives.py", "native", f"{kind}={path_of(kind, 'native')}")
    assert {pair: error for pair, error in errors.items() if not error < 1e-6} == {}


def test_the_native_library_is_there_where_a_compiler_is():
    """Control: the native half of this file cannot be skipped unseen."""
    assert (native_library() is not None) == (compiler() is not None)
