"""Native FMUs in a host without Python, under AddressSanitizer and UndefinedBehaviorSanitizer.

The library's own sources and a small C host make one program. It drives every component, misuses it, and reads
resources that are damaged in every way a random generator finds: an error and a sentence, never a crash.
"""

from __future__ import annotations

import random
import shutil
import subprocess
import zipfile
from pathlib import Path

import pytest
from fmpy import read_model_description

from fmus import native_backend
from tests.conformance.programs.driver import KINDS, built, start_of
from tests.conformance.programs.sanitized import program

HOST = Path(__file__).with_name("programs") / "host.c"
NATIVE = [kind for kind, component in KINDS.items() if native_backend(component.example())]
DAMAGED = 300


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    """The host with all native sources in one program."""
    return program(HOST, tmp_path_factory.mktemp("host"))


def unpacked(kind, folder):
    """Resources of an FMU of the kind, its token, and its numbers of scalars."""
    component = KINDS[kind].example()
    path = built(component, kind, start=start_of(component), backend="native")
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder)
    sizes = [str(layout.size) for layout in component.layouts]
    return folder / "resources", read_model_description(str(path)).guid, sizes


def told(host, cycles, sizes, token, *resources):
    command = [str(host), str(cycles), *sizes, token, *map(str, resources)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stdout + run.stderr[-3000:]
    made, _, messages, _ = run.stdout.split()
    return int(made), int(messages)


@pytest.mark.parametrize("kind", NATIVE)
def test_is_driven_and_misused_without_a_fault(kind, host, tmp_path):
    """A hundred lives of an instance; LeakSanitizer, a part of AddressSanitizer, sees what is not freed."""
    resources, token, sizes = unpacked(kind, tmp_path)
    made, messages = told(host, 100, sizes, token, resources.as_uri())
    assert made == 100
    assert messages >= 10 * made


@pytest.mark.parametrize("kind", NATIVE)
def test_damaged_resources_give_a_sentence(kind, host, tmp_path):
    """Truncated, bytes changed, bytes doubled, numbers replaced; whatever is refused is refused with a message."""
    resources, token, sizes = unpacked(kind, tmp_path / "sound")
    content = (resources / "component.bin").read_bytes()
    generator = random.Random(12)
    folders = []
    for k in range(DAMAGED):
        folder = tmp_path / f"damaged{k}"
        folder.mkdir()
        (folder / "component.bin").write_bytes(damaged(content, generator))
        folders.append(folder)
    made, messages = told(host, 1, sizes, token, *folders, tmp_path / "nowhere")
    assert made + messages >= DAMAGED
    assert made < DAMAGED


def damaged(content, generator):
    """The bytes with one kind of damage."""
    place = generator.randrange(len(content))
    kind = generator.randrange(4)
    if kind == 0:
        return content[:place]
    if kind == 1:
        return content[:place] + content[max(0, place - generator.randrange(64)) :]
    changed = bytearray(content)
    if kind == 2:
        for _ in range(generator.randrange(1, 20)):
            changed[generator.randrange(len(content))] = generator.randrange(256)
        return bytes(changed)
    numbers = (
        b"\0" * 8,
        b"\xff" * 8,
        bytes(6) + b"\xf0\x7f",
        bytes(6) + b"\xf8\x7f",
        b"\xff" * 6 + b"\xef\x7f",
    )
    changed[place : place + 8] = generator.choice(numbers)
    return bytes(changed[: len(content)])


def test_another_fmus_description_is_refused(host, tmp_path):
    """The token ties model description and resources together."""
    resources, _, sizes = unpacked("hinge", tmp_path)
    made, messages = told(host, 1, sizes, "{00000000-0000-0000-0000-000000000000}", resources)
    assert (made, messages) == (0, 1)


def test_the_path_of_the_resources_may_have_odd_characters(host, tmp_path):
    """Percent-encoded in the URI, as RFC 3986 has it."""
    resources, token, sizes = unpacked("hinge", tmp_path / "sound")
    odd = tmp_path / "wing 100 % ü"
    shutil.copytree(resources, odd)
    assert told(host, 1, sizes, token, odd.as_uri())[0] == 1
