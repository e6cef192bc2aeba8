"""The project's own rules: that they are alive, and that they hold."""

from __future__ import annotations

import ast
import os
import shutil
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest

import components
import fmus
import orchestrator
from components import REGISTRY

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))

BAD_LINES = {
    "F401": '"""Module."""\n\nimport os\n',
    "E501": f'"""Module."""\n\nX = "{"x" * 120}"\n',
    "ANN201": '"""Module."""\n\n\ndef f():\n    """Give one."""\n    return 1\n',
    "D103": '"""Module."""\n\n\ndef f() -> None:\n    pass\n',
    "ERA001": '"""Module."""\n\n# x = 1\n',
    "NPY002": '"""Module."""\n\nimport numpy as np\n\nX = np.random.rand(3)\n',
    "UP007": '"""Module."""\n\nfrom typing import Union\n\nX: Union[int, str] = 1\n',
}


def tool(name):
    """A command of the environment that runs the tests."""
    found = shutil.which(name, path=str(Path(sys.executable).parent)) or shutil.which(name)
    if found is None:
        pytest.skip(f"{name} is not installed")
    return found


def output_of(*command, text=None):
    run = subprocess.run(
        command, input=text, capture_output=True, text=True, encoding="utf-8", cwd=ROOT, timeout=300
    )
    return run.returncode, run.stdout + run.stderr


def lint(text, name="components/invented.py"):
    return output_of(
        tool("ruff"), "check", "--no-cache", "--stdin-filename", str(ROOT / name), "-", text=text
    )


@pytest.mark.parametrize("rule", BAD_LINES)
def test_lint_table_is_alive(rule):
    """Control: each bad line is reported under the project's configuration, so a clean report means something."""
    code, told = lint(BAD_LINES[rule])
    assert code == 1
    assert rule in told


def test_good_module_passes_the_lint():
    """Control: the bad lines above are not reported because everything is."""
    code, told = lint('"""Module."""\n')
    assert code == 0, told


def test_code_is_lint_free_and_formatted():
    """Rule: ruff finds nothing, neither in style nor in layout."""
    assert output_of(tool("ruff"), "check", "--no-cache", ".")[0] == 0
    assert output_of(tool("ruff"), "format", "--no-cache", "--check", ".")[0] == 0


def test_types_hold():
    """Rule: mypy, strict, finds nothing."""
    code, told = output_of(tool("mypy"), "--cache-dir", os.devnull)
    assert code == 0, told


def test_types_are_checked(tmp_path):
    """Control: a wrong use of the Python face is reported, so that it is typed though it is imported lazily."""
    path = tmp_path / "wrong.py"
    path.write_text("import orchestrator\norchestrator.simulate(3)\norchestrator.simulat\n", encoding="utf-8")
    code, told = output_of(tool("mypy"), "--no-error-summary", str(path))
    assert code == 1
    assert 'type "int"' in told
    assert 'attribute "simulat"' in told


def test_import_contracts_hold():
    """Rule: components know neither FMI nor files, FMUs no scene; rooms stand in layers; there is no circle."""
    code, told = output_of(tool("lint-imports"), "--no-cache")
    assert code == 0, told
    assert "0 broken" in told
    assert len(PROJECT["tool"]["importlinter"]["contracts"]) >= 2


AGAINST_THE_ARROWS = {
    "packages": ("components/damper.py", "from fmus import build_fmu", "components.damper -> fmus"),
    "a library": ("components/numerics/laws.py", "import h5py", "components.numerics.laws -> h5py"),
    "rooms of components": (
        "components/contract/frames.py",
        "from ..numerics.laws import Law",
        "components.contract.frames -> components.numerics.laws",
    ),
    "rooms of FMUs": (
        "fmus/description/units.py",
        "from ..native import native_library",
        "fmus.description.units -> fmus.native",
    ),
    "rooms of the orchestrator": (
        "orchestrator/scene/units.py",
        "from ..cosim.network import Network",
        "orchestrator.scene.units -> orchestrator.cosim.network",
    ),
    "rooms beside each other": (
        "orchestrator/cosim/master.py",
        "from ..results.result import Result",
        "orchestrator.cosim.master -> orchestrator.results.result",
    ),
    "a circle": (
        "orchestrator/cosim/network.py",
        "from .master import Master",
        "no circle BROKEN",
    ),
    "a room without a place": ("orchestrator/attic.py", "X = 1", "orchestrator.attic"),
    "the terminal": (
        "orchestrator/analysis/modes.py",
        "import click",
        "orchestrator.analysis.modes -> click",
    ),
}


def broken_by(folder, *kinds):
    """What import-linter says of a copy of the sources that has these imports in it."""
    for name in ("components", "fmus", "orchestrator", "pyproject.toml"):
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, folder / name)
    for file, line, _ in (AGAINST_THE_ARROWS[kind] for kind in kinds):
        with (folder / file).open("a", encoding="utf-8") as opened:
            opened.write(f"\n{line}\n")
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    run = subprocess.run(
        [tool("lint-imports"), "--no-cache"],
        capture_output=True,
        text=True,
        cwd=folder,
        env=environment,
        timeout=300,
    )
    assert run.returncode == 1, run.stdout
    return " ".join(run.stdout.split())


@pytest.fixture(scope="module")
def broken(tmp_path_factory):
    """By all of them but the circle, each of which is told by the names of its two ends."""
    return broken_by(tmp_path_factory.mktemp("broken"), *(AGAINST_THE_ARROWS.keys() - {"a circle"}))


@pytest.mark.parametrize("kind", AGAINST_THE_ARROWS)
def test_import_contracts_are_alive(kind, broken, tmp_path):
    """Control: one import against the arrows breaks a contract, for every kind of arrow."""
    told = broken_by(tmp_path, kind) if kind == "a circle" else broken
    assert AGAINST_THE_ARROWS[kind][2] in told, told


@cache
def modules_of(package):
    """Every module of a package by its dotted name, with the file and the tree of its source."""
    root = Path(package.__file__).parent
    found = []
    for path in root.rglob("*.py"):
        parts = path.relative_to(root.parent).with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        found.append((name, path, ast.parse(path.read_text(encoding="utf-8"))))
    return found


def imports_of(package):
    """Pairs of modules of a package, the importing and the imported one, wherever in a file the import stands."""
    known = {name: path for name, path, _ in modules_of(package)}
    for name, path, tree in modules_of(package):
        around = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
        for node in (node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)):
            base = around[: len(around) - node.level + 1] if node.level else []
            source = ".".join([*base, *([node.module] if node.module else [])])
            for alias in node.names:
                imported = f"{source}.{alias.name}" if f"{source}.{alias.name}" in known else source
                if imported in known and imported != name:
                    yield name, imported


def test_kinds_stand_by_themselves():
    """Rule: nothing in the package imports a kind; they are found, and meet at ports."""
    kinds = {component.__module__ for component in REGISTRY.values()}
    assert kinds <= {f"components.{path.stem}" for path in (ROOT / "components").glob("*.py")}
    assert [pair for pair in imports_of(components) if pair[1] in kinds] == []


def test_no_arrows_both_ways_between_rooms():
    """Rule of the architecture: no two rooms of the orchestrator import each other."""
    rooms = {(a.split(".")[1], b.split(".")[1]) for a, b in imports_of(orchestrator) if "." in a and "." in b}
    arrows = {(a, b) for a, b in rooms if a != b}
    assert len(arrows) >= 10  # control: imports are found at all
    assert not {(b, a) for a, b in arrows} & arrows


def test_packages_share_one_folder():
    """Packaging: three generic names from one installation, not from three different ones."""
    folders = {Path(package.__file__).resolve().parents[1] for package in (components, fmus, orchestrator)}
    assert len(folders) == 1
    names = ["components", "fmus", "orchestrator"]
    assert PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"] == names
    assert PROJECT["tool"]["check-wheel-contents"]["toplevel"] == names
    assert any(classifier.startswith("Private ::") for classifier in PROJECT["project"]["classifiers"])
