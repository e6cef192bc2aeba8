"""Building the native library, and what happens where it was not built."""

from __future__ import annotations

import platform
import re
import shutil
import subprocess
import sys
import tomllib
from importlib.machinery import ModuleSpec
from importlib.util import module_from_spec
from pathlib import Path
from runpy import run_path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner
from fmpy import read_model_description

import fmus.build
import fmus.compiled
import fmus.native
from components import REGISTRY, ComponentError
from fmus import build_fmu, native_backend, native_library
from fmus.binary import glibc_of
from fmus.native import CompileError, compile_library, compiler, equations, sources
from fmus.native.headers import kernel_name
from orchestrator.cli import main as cli
from orchestrator.run import simulation

ROOT = Path(__file__).parents[3]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def without_library(monkeypatch):
    """As in a checkout that was never installed."""
    for module in (fmus, fmus.build, fmus.compiled, fmus.native, simulation):
        monkeypatch.setattr(module, "native_library", lambda: None, raising=False)


def test_every_kernel_is_that_of_a_component():
    """Rule: an equations file and the component's switch to native come together."""
    examples = [component.example() for component in REGISTRY.values()]
    assert set(equations()) == {kernel_name(c) for c in examples if c.native_data() is not None}


def test_sources_compile_every_equations_file_twice():
    """Control: both number types are among the sources, and every kernel in the list."""
    texts = sources()
    for name in equations():
        assert f"{name}.c" in texts
        assert f"{name}_derivative.c" in texts
        assert f"&{name}_kernel" in texts["kernels.c"]


def test_the_library_runs_with_a_c_library_of_2019():
    """A glibc of 2.29, as RHEL 9 (2.34) and Debian 11 (2.31) have it; against objdump's list of versions, where it is.

    Regression: one `hypot` asked for 2.35.
    """
    library = native_library()
    if library is None or platform.libc_ver()[0] != "glibc":
        pytest.skip("no native library for glibc here")
    found = glibc_of(library.read_bytes())
    assert found is None or found <= (2, 29)
    if shutil.which("objdump"):
        listed = subprocess.run(["objdump", "-T", library], capture_output=True, text=True, check=True).stdout
        versions = re.findall(r"GLIBC_(\d+)\.(\d+)", listed)
        assert found == max((int(major), int(minor)) for major, minor in versions)


def test_a_missing_compiler_is_a_sentence(monkeypatch, tmp_path):
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(CompileError, match="no-such-compiler"):
        compile_library(tmp_path / "fanfold.so")
    without_compilers(monkeypatch, tmp_path)
    with pytest.raises(CompileError, match="ziglang"):
        compile_library(tmp_path / "fanfold.so")


@pytest.mark.skipif(sys.platform == "win32", reason="the compiler that fails is a script of a shell")
@pytest.mark.parametrize("broken", [False, True])
def test_without_a_compiler_that_works_zig_compiles(monkeypatch, tmp_path, broken):
    """Rule: the build requires Zig where cc, gcc and clang are missing or fail, and then only."""
    if compiler() is not None:
        assert requirements(monkeypatch) == []
    without_compilers(monkeypatch, tmp_path)
    if broken:
        (tmp_path / "cc").write_text("#!/bin/sh\nexit 1\n")
        (tmp_path / "cc").chmod(0o755)
    assert compiler() is None
    (requirement,) = requirements(monkeypatch)
    assert requirement.startswith("ziglang")
    monkeypatch.setitem(sys.modules, "ziglang", module_from_spec(ModuleSpec("ziglang", None)))
    assert compiler()[:4] == [sys.executable, "-m", "ziglang", "cc"]
    assert requirements(monkeypatch) == []


def without_compilers(monkeypatch, folder):
    """As where there is no Zig, and no program but those in this folder."""
    monkeypatch.setenv("PATH", str(folder))
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setitem(sys.modules, "ziglang", None)


def requirements(monkeypatch):
    """Of the build hook, for which hatchling is a stand-in, as only a build has it."""

    class Hook:
        root = str(ROOT)
        metadata = SimpleNamespace(
            core=SimpleNamespace(optional_dependencies=PROJECT["project"]["optional-dependencies"])
        )

        def __class_getitem__(cls, item):
            return cls

    interface = SimpleNamespace(BuildHookInterface=Hook)
    monkeypatch.setitem(sys.modules, "hatchling.builders.hooks.plugin.interface", interface)
    path = ROOT / PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["hooks"]["custom"]["path"]
    return run_path(str(path))["NativeBuildHook"]().dependencies()


def test_the_compiler_may_have_arguments(monkeypatch):
    if compiler() is None:
        pytest.skip("no C compiler here")
    command = " ".join(compiler())
    monkeypatch.setenv("CC", f"{command} -DCHOSEN")
    assert compiler() == [*command.split(), "-DCHOSEN"]


def test_what_a_compiler_refuses_is_told(monkeypatch, tmp_path):
    if compiler() is None:
        pytest.skip("no C compiler here")
    with pytest.raises(CompileError, match=r"failed: .*no-such-option"):
        compile_library(tmp_path / "fanfold.so", ("--no-such-option",))
    assert list(tmp_path.iterdir()) == []


def test_without_the_library_pythonfmus_are_built(monkeypatch, tmp_path):
    without_library(monkeypatch)
    component = REGISTRY["eddy_current_damper"].example()
    assert not native_backend(component)
    description = read_model_description(str(build_fmu(component, "damper", tmp_path)))
    assert description.generationTool.endswith("PythonFMU")
    with pytest.raises(ComponentError, match="native library"):
        build_fmu(component, "damper", tmp_path, backend="native")


def test_without_the_library_the_command_line_says_so(monkeypatch, tmp_path):
    without_library(monkeypatch)
    run = CliRunner().invoke(cli.main, ["export", "amos3", "--rigid", "all", "-o", str(tmp_path)])
    assert run.exit_code == 0
    assert "PythonFMUs" in run.output
    refused = CliRunner().invoke(cli.main, ["run", "amos3", "--backend", "native"])
    assert refused.exit_code == 1
    assert "native library" in refused.output
