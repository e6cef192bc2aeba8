"""FMUs with sources: compiled by a tool that knows nothing but the FMU, they are what the binary is."""

from __future__ import annotations

import shutil
import zipfile

import numpy as np
import pytest
from fmpy import extract, simulate_fmu
from fmpy.build import build_platform_binary

import fmus.build
from components import REGISTRY, ComponentError
from fmus import build_fmu, check_fmu
from fmus.native import compiler
from tests.conformance.programs.driver import start_of

needs_compiler = pytest.mark.skipif(
    compiler() is None or shutil.which("cmake") is None, reason="needs a C compiler and cmake"
)


def with_sources(kind, folder, fmi):
    component = REGISTRY[kind].example()
    return build_fmu(component, kind, folder, start_of(component), fmi=fmi, with_sources=True)


@needs_compiler
@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_a_compiled_fmu_equals_the_binary(fmi, tmp_path, monkeypatch):
    """FMPy's build of source FMUs, without any binary in the file; other compiler flags, hence not bit for bit."""
    reference = simulate_fmu(str(with_sources("body", tmp_path / "whole", fmi)), stop_time=0.05)
    monkeypatch.setattr(fmus.build, "library", lambda: None)
    path = with_sources("body", tmp_path / "sources", fmi)
    with zipfile.ZipFile(path) as archive:
        assert not any(name.startswith("binaries/") for name in archive.namelist())
    folder = tmp_path / "unpacked"
    extract(path, str(folder))
    build_platform_binary(folder)
    found = simulate_fmu(str(folder), stop_time=0.05)
    assert len(found) == len(reference)
    for name in reference.dtype.names:
        np.testing.assert_allclose(found[name], reference[name], rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("kind", sorted(REGISTRY))
@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_has_no_problems(kind, fmi, tmp_path):
    assert check_fmu(with_sources(kind, tmp_path, fmi)) == []


def test_pythonfmus_have_none(tmp_path):
    with pytest.raises(ComponentError, match="need the native back end"):
        build_fmu(REGISTRY["hinge"].example(), "hinge", tmp_path, backend="python", with_sources=True)
