"""What `import orchestrator` offers: it is there, it is light, it is typed, and its errors have one root."""

from __future__ import annotations

import inspect
import subprocess
import sys
from importlib import import_module
from pkgutil import walk_packages
from time import perf_counter

import pytest

import components
import fmus
import orchestrator as fanfold
from orchestrator.cli.main import main
from tests.references.native_fmus import needs_native

HEAVY = ("numpy", "scipy", "h5py", "pydantic", "matplotlib", "rich", "fmpy", "skfem", "components")
BUILD_HOOK = "CompileError"
"""Raised before anything is installed, where nothing of the project can be imported."""


def test_every_name_is_there_and_typed():
    """Completeness: what is listed, what can be had and what type checkers see are the same."""
    assert dir(fanfold) == sorted(fanfold.__all__)
    for name in fanfold.__all__:
        assert (inspect.getdoc(getattr(fanfold, name)) or "").strip()
    with pytest.raises(AttributeError, match="'simulat'"):
        fanfold.simulat  # noqa: B018


@pytest.mark.parametrize("arguments", [["--help"], ["run", "--help"], ["analyse", "--help"]])
def test_help_is_light(arguments):
    """Rule: neither the face nor the command line, with all its analyses, loads a library before it needs one."""
    code = (
        "import sys; from orchestrator.cli.main import main; "
        f"main({arguments!r}, standalone_mode=False); print({set(HEAVY)!r} & set(sys.modules))"
    )
    shown = subprocess.check_output([sys.executable, "-c", code], text=True)
    assert shown.startswith("Usage:")
    assert shown.endswith("\nset()\n")


@needs_native
def test_a_run_needs_nothing_that_reduces_bodies():
    """Rule: AMOS-3, with its search for equilibrium and its tables, runs without SciPy's submodules.

    From its second run on, as the first one reduces bodies.
    """
    fanfold.simulate("amos3", rigid="all", until=0.01, estimate=False)
    code = (
        "import sys, orchestrator as fanfold; fanfold.simulate('amos3', rigid='all', until=0.1, estimate=False); "
        "print({'scipy.linalg', 'scipy.sparse', 'scipy.interpolate', 'skfem'} & {*sys.modules})"
    )
    assert subprocess.check_output([sys.executable, "-c", code], text=True) == "set()\n"


def fastest(code, *, tries=5):
    """Least wall time (s) of a fresh process."""
    times = []
    for _ in range(tries):
        start = perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)
        times.append(perf_counter() - start)
    return min(times)


def test_help_comes_at_once():
    """`fanfold --help` takes at most three times what `import numpy` takes."""
    shown = "import sys; sys.argv = ['fanfold', '--help']; from orchestrator.cli.main import main; main()"
    assert fastest(shown) < 3.0 * fastest("import numpy")


NO_MODULES = ("fmus.native.hook", "fmus.host.child")
"""Of the build, whose library is not there at run time; and a program of its own."""


def test_every_error_has_one_root():
    """Completeness: whatever the packages raise of their own is a FanfoldError."""
    found = set()
    for package in (components, fmus, fanfold):
        for module in walk_packages(package.__path__, f"{package.__name__}."):
            if module.name in NO_MODULES:
                continue
            for _, one in inspect.getmembers(import_module(module.name), inspect.isclass):
                if issubclass(one, Exception) and one.__module__.startswith(package.__name__):
                    found.add(one)
    assert len(found) >= 7  # control: they are found at all
    strangers = {one.__name__ for one in found if not issubclass(one, (fanfold.FanfoldError, Warning))}
    assert strangers == {BUILD_HOOK}


@pytest.mark.parametrize(
    "act",
    [
        lambda: fanfold.load("nothing"),
        lambda: fanfold.load("amos3", "warm"),
        lambda: fanfold.load("amos3", settings={"friction.coeficient": 0.1}),
        lambda: fanfold.load("amos3", settings={"friction.coefficient": object()}),
        lambda: fanfold.simulate("arabsat"),
        lambda: fanfold.simulate("amos3", until=-1.0),
        lambda: fanfold.simulate("amos3", until="8 m"),
        lambda: fanfold.simulate("amos3", tolerance=1.0),
        lambda: fanfold.simulate("amos3", step=0.0),
        lambda: fanfold.simulate("amos3", order=3),
        lambda: fanfold.simulate("amos3", master="newton"),
        lambda: fanfold.simulate("amos3", master="jacobi"),
        lambda: fanfold.simulate("amos3", backend="java"),
        lambda: fanfold.simulate("amos3", rigid="door"),
        lambda: fanfold.modes("amos3", "folded"),
        lambda: fanfold.modes("amos3", count=0),
        lambda: fanfold.modes("amos3", angles={"HL1": "45 m"}),
        lambda: fanfold.modes("amos3", latched="HL9", rigid="all"),
        lambda: fanfold.frequency_response("amos3", low=5.0, high=5.0),
        lambda: fanfold.frequency_response("amos3", excite="w"),
        lambda: fanfold.equilibrium("amos3", hold="HL9"),
        lambda: fanfold.quasi_static("amos3", {"HL1": (0.0, 0.0)}),
        lambda: fanfold.torque_margin("amos3", factors="guessed"),
        lambda: fanfold.torque_margin("amos3", torques={"HL1": {"XX": 1.0}}),
        lambda: fanfold.torque_margin("amos3", torques={"HL9": {"HY": 1.0}}),
        lambda: fanfold.restart("amos3", "soon"),
        lambda: fanfold.latch_tuning("amos3", "HL9"),
        lambda: fanfold.mode_study("workbench", counts=(2,)),
        lambda: fanfold.step_study("workbench", steps=(1e-3,)),
        lambda: fanfold.Result.open("nothing.h5"),
        lambda: fanfold.report("nothing.h5"),
        lambda: fanfold.stress("nothing.h5", "panel", around=(0.0, 0.0, -1.0)),
        lambda: fanfold.stress("nothing.h5", "panel", within=(1.0, 0.0, 0.0, 1.0)),
        lambda: fanfold.plot("text", "folder"),
    ],
)
def test_bad_input_is_a_sentence(act, tmp_path, monkeypatch):
    """Bad input: one kind of error, and nothing is begun."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(fanfold.FanfoldError) as caught:
        act()
    assert len(str(caught.value)) > 10
    assert list(tmp_path.iterdir()) == []


def test_every_command_is_a_function():
    """Completeness: what the terminal does can be done from Python by the same word."""
    names = {name.replace("-", "_") for name in main.commands["analyse"].list_commands(None)}
    words = {"impact": "impacts", "outputs": "body_outputs"}
    assert {words.get(name, name) for name in names} <= set(fanfold.__all__)
    words = {"run": "simulate", "list": "scenes", "analyse": "modes"}
    assert {words.get(name, name.replace("-", "_")) for name in main.commands} <= set(fanfold.__all__)
