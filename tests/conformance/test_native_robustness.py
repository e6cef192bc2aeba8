"""Native FMUs in a host without Python, under AddressSanitizer and UndefinedBehaviorSanitizer.

The library's own sources and a small C host make one program. It drives every component, misuses it, and reads
resources that are damaged in every way a random generator finds: an error and a sentence, never a crash.
"""

from __future__ import annotations

import shutil
import zipfile
from pathlib import Path

import pytest
from fmpy import read_model_description

import orchestrator as fanfold
from fmus import native_backend
from tests.conformance.programs.damage import damaged_folders
from tests.conformance.programs.driver import KINDS, built, start_of
from tests.conformance.programs.sanitized import program, told
from tests.unit.run.as_one.host import latching

HOST = Path(__file__).with_name("programs") / "host.c"
NATIVE = [kind for kind, component in KINDS.items() if native_backend(component.example())]
DAMAGED = 300


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    """The host with all native sources in one program."""
    return program(HOST, tmp_path_factory)


def unpacked(kind, folder):
    """Resources of an FMU of the kind, its token, and its numbers of scalars."""
    component = KINDS[kind].example()
    path = built(component, kind, start=start_of(component), backend="native")
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder)
    sizes = [str(layout.size) for layout in component.layouts]
    return folder / "resources", read_model_description(str(path)).guid, sizes


@pytest.mark.parametrize("kind", NATIVE)
def test_is_driven_and_misused_without_a_fault(kind, host, tmp_path):
    """Twenty lives of an instance; LeakSanitizer, a part of AddressSanitizer, sees what is not freed."""
    resources, token, sizes = unpacked(kind, tmp_path)
    made, messages = told(host, 20, *sizes, token, resources.as_uri())
    assert made == 20
    assert messages >= 10 * made


@pytest.mark.parametrize("kind", NATIVE)
def test_damaged_resources_give_a_sentence(kind, host, tmp_path):
    """Truncated, bytes changed, bytes doubled, numbers replaced; whatever is refused is refused with a message."""
    resources, token, sizes = unpacked(kind, tmp_path / "sound")
    folders = damaged_folders(resources, tmp_path, DAMAGED, seed=12)
    made, messages = told(host, 1, *sizes, token, *folders, tmp_path / "nowhere")
    assert made + messages >= DAMAGED
    assert made < DAMAGED


@pytest.fixture(scope="module")
def wing(tmp_path_factory):
    """A scene with a latch and an event as one FMU: resources, token, numbers of scalars."""
    folder = tmp_path_factory.mktemp("wing")
    event = {"name": "faster", "time": "2 ms", "set": {"root": {"motor_constant_torque": "9 N.m"}}}
    (path,) = fanfold.export(latching([event]), folder, as_one=True)
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder)
    description = read_model_description(str(path))
    counts = dict.fromkeys(("parameter", "input", "output"), 0)
    for variable in description.modelVariables:
        counts[variable.causality] += 1
    return folder / "resources", description.guid, [str(n) for n in (*counts.values(), 0)]


def test_a_scene_as_one_fmu_is_driven_and_misused_without_a_fault(wing, host):
    resources, token, sizes = wing
    made, messages = told(host, 5, *sizes, token, resources.as_uri())
    assert made == 5
    assert messages >= 10 * made


def test_damaged_resources_of_a_scene_give_a_sentence(wing, host, tmp_path):
    """Tables of indices among them, of which none may lead out of its array."""
    resources, token, sizes = wing
    folders = damaged_folders(resources, tmp_path, DAMAGED, seed=12)
    made, messages = told(host, 1, *sizes, token, *folders)
    assert made + messages >= DAMAGED
    assert made < DAMAGED


def test_another_fmus_description_is_refused(host, tmp_path):
    """The token ties model description and resources together."""
    resources, _, sizes = unpacked("hinge", tmp_path)
    made, messages = told(host, 1, *sizes, "{00000000-0000-0000-0000-000000000000}", resources)
    assert (made, messages) == (0, 1)


def test_the_path_of_the_resources_may_have_odd_characters(host, tmp_path):
    """Percent-encoded in the URI, as RFC 3986 has it."""
    resources, token, sizes = unpacked("hinge", tmp_path / "sound")
    odd = tmp_path / "wing 100 % ü"
    shutil.copytree(resources, odd)
    assert told(host, 1, *sizes, token, odd.as_uri())[0] == 1
