"""An installation where no C compiler is found: Zig, which the build downloads, compiles the library."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
WORKBENCH = """
import fmus, orchestrator
print(fmus.native_library())
print(orchestrator.simulate("workbench", rigid="all", backend="native", estimate=False).latch_times["HL"])
"""


@pytest.fixture
def environment(tmp_path):
    """Of a process that finds no program; the cache and the folders of Fanfold are those of the test."""
    kept = {name: value for name, value in os.environ.items() if name not in ("CC", "PYTHONPATH")}
    (tmp_path / "programs").mkdir()
    return {**kept, "PATH": str(tmp_path / "programs"), "FANFOLD_CACHE": str(tmp_path / "cache")}


def pip(environment, *arguments):
    if find_spec("pip") is None:
        pytest.skip("there is no pip")
    command = [sys.executable, "-m", "pip", "install", "--no-deps", *map(str, arguments)]
    return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=900)


@pytest.mark.thorough
def test_without_a_compiler_zig_makes_native_fmus(environment, tmp_path):
    """And a compiler that is chosen but missing ends the installation with its name."""
    if pip(environment, "--dry-run", "--ignore-installed", "hatchling", "ziglang").returncode:
        pytest.skip("there is no package index")
    project = shutil.copytree(
        ROOT,
        tmp_path / "project",
        ignore=shutil.ignore_patterns(".*", "__pycache__", "*.so", "*.dll", "*.dylib"),
    )
    installed = tmp_path / "installed"
    refused = pip({**environment, "CC": "no-such-compiler"}, "--target", installed, project)
    assert refused.returncode == 1
    assert "no-such-compiler" in refused.stdout + refused.stderr
    assert not installed.exists()
    run = pip(environment, "--target", installed, project)
    assert run.returncode == 0, run.stdout + run.stderr
    environment["PYTHONPATH"] = str(installed)
    run = subprocess.run(
        [sys.executable, "-c", WORKBENCH], env=environment, cwd=tmp_path, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    library, latched_at = run.stdout.split()
    assert Path(library).is_relative_to(installed)
    assert float(latched_at) == pytest.approx(4.2713, abs=1e-3)
