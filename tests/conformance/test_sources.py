"""FMUs with sources: compiled by a tool that knows nothing but the FMU, they are what the binary is."""

from __future__ import annotations

import shutil
import zipfile

import numpy as np
import pytest
from fmpy import extract, platform, platform_tuple, simulate_fmu
from fmpy.build import build_platform_binary

import fmus.build
from components import REGISTRY, ComponentError
from fmus import build_fmu, check_fmu
from fmus.native import compiler
from tests.conformance.programs.driver import start_of

needs_compiler = pytest.mark.skipif(
    "ziglang" in (compiler() or ["ziglang"]) or shutil.which("cmake") is None,
    reason="needs cmake and a C compiler that it finds",
)

PLATFORMS = {"2.0": platform, "3.0": platform_tuple}


def with_sources(kind, folder, fmi, **options):
    component = REGISTRY[kind].example()
    return build_fmu(component, kind, folder, start_of(component), fmi=fmi, with_sources=True, **options)


def texts(archive):
    return {name: archive.read(name) for name in archive.namelist() if name.endswith((".c", ".h"))}


@pytest.mark.thorough
@needs_compiler
def test_a_compiled_fmu_equals_the_binary(tmp_path, monkeypatch):
    """FMPy's build of source FMUs, without any binary in the file; other compiler flags, hence not bit for bit.

    Both versions of FMI carry the same sources, so what is built from those of one serves the other.
    """
    references = {
        fmi: simulate_fmu(str(with_sources("body", tmp_path / f"whole{fmi}", fmi)), stop_time=0.05)
        for fmi in PLATFORMS
    }
    monkeypatch.setattr(fmus.build, "native_library", lambda: None)
    carried, folders = [], {}
    for fmi in PLATFORMS:
        path, folders[fmi] = (
            with_sources("body", tmp_path / f"sources{fmi}", fmi),
            tmp_path / f"unpacked{fmi}",
        )
        with zipfile.ZipFile(path) as archive:
            assert not any(name.startswith("binaries/") for name in archive.namelist())
            carried.append(texts(archive))
        extract(path, str(folders[fmi]))
    assert carried[0] == carried[1] != {}
    build_platform_binary(folders["2.0"], configuration="None")  # without flags, which compiles soonest
    shutil.copytree(
        folders["2.0"] / "binaries" / PLATFORMS["2.0"], folders["3.0"] / "binaries" / PLATFORMS["3.0"]
    )
    for fmi, reference in references.items():
        found = simulate_fmu(str(folders[fmi]), stop_time=0.05)
        assert len(found) == len(reference)
        for name in reference.dtype.names:
            np.testing.assert_allclose(found[name], reference[name], rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("kind", sorted(REGISTRY))
@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_has_no_problems(kind, fmi, tmp_path):
    """In the file; that it runs is seen where it has no sources, and that it may be compressed above."""
    assert check_fmu(with_sources(kind, tmp_path, fmi, compressed=False), run=False) == []


def test_pythonfmus_have_none(tmp_path):
    with pytest.raises(ComponentError, match="native"):
        build_fmu(REGISTRY["hinge"].example(), "hinge", tmp_path, backend="python", with_sources=True)
