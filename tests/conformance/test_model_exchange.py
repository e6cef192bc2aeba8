"""Native FMUs in model exchange: valid, equal to their components, integrated by others, safe to misuse.

FMUs are loaded in subprocesses, because a fault in a binary would end pytest.
"""

from __future__ import annotations

import zipfile
from functools import cache
from pathlib import Path

import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu

from components import REGISTRY
from components.hinge import Hinge
from fmus import build_fmu, native_backend, native_library
from tests.conformance.programs import exchange, exchange_runs
from tests.conformance.programs.apart import findings
from tests.conformance.programs.damage import damaged_folders
from tests.conformance.programs.driver import built, start_of
from tests.conformance.programs.exchange import SUBJECTS
from tests.conformance.programs.sanitized import program, told

HOST = Path(__file__).with_name("programs") / "host_model_exchange.c"
DAMAGED = 200

pytestmark = pytest.mark.skipif(native_library() is None, reason="there is no native library here")


@cache
def path_of(subject):
    component = SUBJECTS[subject]()
    return str(built(component, subject, start=start_of(component), backend="native"))


@cache
def findings_of(subject):
    return findings("exchange.py", f"{subject}={path_of(subject)}")


@cache
def findings_of_runs(folder):
    return findings("exchange_runs.py", str(folder))


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("exchange")


@pytest.mark.parametrize("check", exchange.CHECKS)
@pytest.mark.parametrize("subject", SUBJECTS)
def test_behaves(subject, check):
    assert findings_of(subject)[check] == ""


@pytest.mark.parametrize("run", exchange_runs.RUNS)
def test_is_integrated_by_another_solver(run, folder):
    assert findings_of_runs(folder)[run] == ""


def test_a_monolithic_wing_moves_as_the_coupled_one(folder):
    """Two bodies and a hinge as one system in SciPy, against Fanfold's master at 0.25 ms with mean wrenches."""
    found = findings("exchange_wing.py", str(folder))
    (monolithic,), (coupled,) = found.pop("latch_times")
    assert abs(monolithic - coupled) < 1e-5
    assert {name: error for name, error in found.items() if not error < 2e-3} == {}


@pytest.mark.parametrize("kind", REGISTRY)
def test_every_native_kind_is_a_subject(kind):
    """Control: whatever has a kernel and rates for another solver is tested here."""
    component = REGISTRY[kind].example()
    if native_backend(component) and component.continuous is not None:
        assert kind in {make().kind for make in SUBJECTS.values()}


@pytest.mark.parametrize("subject", SUBJECTS)
def test_the_description_is_valid(subject):
    """No problem that FMPy knows; states and rates belong together, and no other value reference has moved."""
    component, path = SUBJECTS[subject](), path_of(subject)
    assert validate_fmu(path) == []
    description = read_model_description(path)
    assert description.modelExchange.modelIdentifier == description.coSimulation.modelIdentifier
    n, nx = sum(layout.size for layout in component.layouts), len(component.continuous.places)
    assert description.numberOfContinuousStates == nx
    assert description.numberOfEventIndicators == component.continuous.indicators
    assert [v.valueReference for v in description.modelVariables] == list(range(n + 2 * nx))
    for i, unknown in enumerate(description.derivatives):
        rate, state = unknown.variable, description.modelVariables[n + i]
        assert (rate.valueReference, rate.derivative, rate.name) == (n + nx + i, state, f"der({state.name})")
    listed = {unknown.variable.name for unknown in description.initialUnknowns}
    assert {v.name for v in description.modelVariables[n:]} <= listed


@pytest.mark.parametrize("subject", SUBJECTS)
def test_what_is_not_listed_as_a_dependency_is_none(subject):
    """Ports depend on what the structure says; heat moves nothing."""
    component = SUBJECTS[subject]()
    description = read_model_description(path_of(subject))
    ports = {name for name in component.output_layout.scalar_names()}
    for unknown in description.outputs:
        names = {v.name for v in unknown.dependencies}
        assert (names & set(component.input_layout.scalar_names()) != set()) == (
            component.feedthrough or unknown.variable.name not in ports
        )
        if unknown.variable.name in ports:
            assert not names & set(component.continuous.quadratures)


def test_mean_wrenches_and_python_fmus_are_for_co_simulation_only():
    """What they give is no function of an instant, or has no derivatives."""
    for component, backend in ((Hinge(), "native"), (Hinge(wrench_mode="endpoint"), "python")):
        description = read_model_description(str(built(component, "hinge", backend=backend)))
        assert description.modelExchange is None
        assert description.numberOfContinuousStates == 0


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    return program(HOST, tmp_path_factory)


def sizes(component):
    found = [layout.size for layout in component.layouts]
    if component.continuous:
        found += [len(component.continuous.places), component.continuous.indicators]
    return found


def unpacked(path, folder):
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder)
    return folder / "resources", read_model_description(str(path)).guid


@pytest.mark.parametrize("subject", SUBJECTS)
def test_is_driven_and_misused_without_a_fault(subject, host, tmp_path):
    resources, token = unpacked(path_of(subject), tmp_path)
    made, messages = told(host, 10, *sizes(SUBJECTS[subject]()), token, resources)
    assert made == 10
    assert messages >= 10 * made


@pytest.mark.parametrize("subject", ["body", "hinge", "free_loop", "fixed_base"])
def test_damaged_resources_give_a_sentence(subject, host, tmp_path):
    resources, token = unpacked(path_of(subject), tmp_path / "sound")
    folders = damaged_folders(resources, tmp_path, DAMAGED, seed=13)
    made, messages = told(host, 1, *sizes(SUBJECTS[subject]()), token, *folders)
    assert made + messages >= DAMAGED
    assert made < DAMAGED


def test_an_fmu_of_mean_wrenches_cannot_be_instantiated(host, tmp_path):
    component = Hinge()
    resources, token = unpacked(build_fmu(component, "hinge", tmp_path), tmp_path)
    component.continuous = SUBJECTS["hinge"]().continuous
    assert told(host, 1, *sizes(component), token, resources) == (0, 1)
