"""FMI 3.0 in a host without Python, under sanitizers: driven, misused, with damaged resources, and nothing leaks."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from fmpy import read_model_description

from fmus import native_library
from tests.conformance.programs.damage import damaged_folders
from tests.conformance.programs.driver import KINDS, built, start_of
from tests.conformance.programs.latching import START, hinge
from tests.conformance.programs.sanitized import program, told
from tests.conformance.test_native_robustness import NATIVE

HOST = Path(__file__).with_name("programs") / "host3.c"
DAMAGED = 200
ROUNDS = 6

pytestmark = pytest.mark.skipif(native_library() is None, reason="there is no native library here")


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    """The host with all native sources in one program."""
    return program(HOST, tmp_path_factory)


def unpacked(path, folder):
    """Resources of an FMU with the separator that FMI 3 has at their end, and its token."""
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder)
    return f"{folder}/resources/", read_model_description(str(path)).guid


def scalars(component):
    return sum(layout.size for layout in component.layouts)


@pytest.mark.parametrize("kind", [*NATIVE, "latching"])
def test_is_driven_and_misused_without_a_fault(kind, host, tmp_path):
    component = hinge() if kind == "latching" else KINDS[kind].example()
    start = START if kind == "latching" else start_of(component)
    resources, token = unpacked(built(component, kind, start=start, fmi="3.0"), tmp_path)
    made, messages = told(host, ROUNDS, token, scalars(component), resources)
    assert made == ROUNDS
    assert messages >= 10 * made


@pytest.mark.parametrize("kind", NATIVE)
def test_damaged_resources_give_a_sentence(kind, host, tmp_path):
    component = KINDS[kind].example()
    path = built(component, kind, start=start_of(component), fmi="3.0")
    resources, token = unpacked(path, tmp_path / "sound")
    folders = [f"{folder}/" for folder in damaged_folders(resources, tmp_path, DAMAGED, seed=13)]
    made, messages = told(host, 1, token, scalars(component), *folders, f"{tmp_path}/nowhere/")
    assert made + messages >= DAMAGED
    assert made < DAMAGED
