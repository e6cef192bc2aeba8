"""Every analysis with wrong input, its help, and Ctrl-C: sentences and exit codes, never a traceback."""

from __future__ import annotations

import re
import signal
import sys
from importlib import import_module

import pytest
from click.testing import CliRunner

from orchestrator.cli.analyse.torque_margin import FAILED
from orchestrator.cli.main import main
from orchestrator.cli.progress import progress
from orchestrator.run.progress import followed

NAMES = main.commands["analyse"].list_commands(None)
ON_RESULTS = ("impact", "outputs", "stress")
NEEDED = {
    "gradients": ("--by", "friction.coefficient"),
    "latch-tuning": ("--line", "HL1"),
    "outputs": ("--body", "panel"),
    "stress": ("--body", "panel"),
}
"""Options without which an analysis asks for them first."""


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def fanfold(*arguments):
    """Run an analysis; no traceback, and no exception that is not click's own."""
    result = CliRunner().invoke(main, ["analyse", *map(str, arguments)])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    assert "Traceback" not in result.output
    return result


def refused(*arguments):
    """Standard error of an analysis that does not run."""
    result = fanfold(*arguments)
    assert result.exit_code in (1, 2)
    assert result.stdout == ""
    return " ".join(result.stderr.split())


@pytest.mark.parametrize("name", NAMES)
def test_help_is_readable(name):
    """Every option is explained, no range is open on both sides, no metavar is a type's."""
    shown = fanfold(name, "--help").stdout
    assert "None" not in shown
    assert not re.search(r"RANGE|e-0\d|e\+0\d| TEXT ", shown)
    assert all(
        option.help for option in import_module_of(name).command.params if option.param_type_name == "option"
    )


def import_module_of(name):
    """The module of an analysis."""
    return import_module(f"orchestrator.cli.analyse.{name.replace('-', '_')}")


@pytest.mark.parametrize("name", NAMES)
def test_what_is_not_there_is_told(name):
    told = refused(name, "nothing", *NEEDED.get(name, ()))
    assert "'nothing'" in told


@pytest.mark.parametrize("name", [name for name in NAMES if name not in ON_RESULTS])
def test_what_the_scene_does_not_have_is_told(name):
    arguments = (name, "amos3", *NEEDED.get(name, ()))
    assert "variant 'warm'" in refused(*arguments, "--variant", "warm")
    assert "'nonsense'" in refused(*arguments, "--set", "nonsense")
    if name not in ("constraints", "torque-margin"):  # which no fidelity changes
        if name == "mode-study":
            arguments = (*arguments, "--body", "yoke")
        assert "body 'door'" in refused(*arguments, "--rigid", "door")


AMOS3 = ("amos3", "--rigid", "all")


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("modes", *AMOS3, "--count", "-1"), "x>=1"),
        (("modes", *AMOS3, "--plot", "file"), "'file' is a file"),
        (("frequency-response", *AMOS3, "--from", "0"), "0.001<=x<=1e6"),
        (("frequency-response", *AMOS3, "--to", "nan"), "'--to': nan"),
        (("frequency-response", *AMOS3, "--from", "5", "--to", "5"), "--from 5 Hz"),
        (("frequency-response", *AMOS3, "--plot", "a.abc"), ".png, .pdf"),
        (("frequency-response", *AMOS3, "--plot", "."), "is a directory"),
        (("frequency-response", *AMOS3, "--points", ","), "give names"),
        (("frequency-response", *AMOS3, "--points", "yoke.no"), "'yoke.no'"),
        (("equilibrium", *AMOS3, "--sweep", "HL9=0deg:1deg"), "'HL9'"),
        (("equilibrium", *AMOS3, "--sweep", "HL1=0deg:1deg", "--steps", "0"), "1<=x"),
        (("latch-tuning", "amos3", "--line", "HL9"), "'HL9'"),
        (("latch-tuning", "amos3", "--line", "HL1", "--frequency", "0"), "x>0"),
        (
            ("latch-tuning", "amos3", "--line", "HL1", "--hinge-stiffness", "51.3"),
            "'51.3'",
        ),
        (("mode-study", *AMOS3, "--body", "yoke"), "body: yoke, rigid: panel1,panel2"),
        (("mode-study", *AMOS3), "body: yoke"),
        (("mode-study", "amos3"), "have modes"),
        (("mode-study", "workbench", "--modes", "2,nan"), "'nan' is not a valid integer"),
        (("mode-study", "workbench", "--modes", "0,100000"), "100000 modes"),
        (("mode-study", "workbench", "--output", "file"), "'file' is a file"),
        (("step-study", "workbench", "--steps", "0,1e-3"), "between 1e-7 and 1 s"),
        (("step-study", "workbench", "--output", "file/x"), "file/x: Not a directory"),
        (("torque-margin", "amos3", "--output", "file/x", "--positions", "2"), "file/x: Not a directory"),
        (("stress", "file", "--body", "panel"), "file: "),
        (("stress", ".", "--body", "panel"), "is a directory"),
        (("outputs", "file", "--body", "panel"), "file: "),
        (("stress", "file", "--body", "panel", "--around", "0", "0", "-1"), "negative"),
        (("stress", "file", "--body", "panel", "--within", "0", "nan", "0", "1"), "'--within': nan"),
        (("impact", "file", "--output", "a.abc"), ".png, .pdf"),
        (("impact", "file"), "file: "),
    ],
)  # fmt: skip
def test_wrong_input_is_told(tmp_path, arguments, sentence):
    (tmp_path / "file").write_text("x", encoding="utf-8")
    assert sentence in refused(*arguments)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]  # nothing is begun


def test_numbers_need_no_folder_to_write_to(monkeypatch, tmp_path):
    """Regression: where pictures could not be written, margins and checks ended without a number."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "amos3").write_text("where the folder would be", encoding="utf-8")
    for arguments, told in (
        (("analyse", "torque-margin", "amos3", "--positions", "2"), "margin"),
        (("check", "amos3"), "amos3: OK"),
    ):
        result = CliRunner().invoke(main, arguments)
        assert told in result.stdout
        assert result.stderr.splitlines()[-1].startswith("fanfold: warning: no pictures: amos3 cannot be")
        assert result.exit_code in (0, FAILED)  # its margin may fail, which is no error


def test_ctrl_c_is_told_in_a_sentence(monkeypatch):
    """What was interrupted, exit code 1, and nothing of what was not written, no bare 'Aborted!'."""

    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("orchestrator.analysis.modes.scene_model", interrupt)
    told = refused("modes", "amos3")
    assert told == "fanfold: analyse modes: interrupted"
    monkeypatch.setattr("orchestrator.scene.builder.find_scene", interrupt)
    result = CliRunner().invoke(main, ["run", "amos3"])
    assert result.exit_code == 1
    assert result.stderr == "fanfold: run: interrupted\n"


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGINT")
def test_ctrl_c_after_the_last_step_is_not_lost():
    """Between the runs of a study nobody would ask for it any more."""

    def study():
        with followed(progress, "study", 1.0) as watch:
            watch(1.0, 0.1)
            signal.raise_signal(signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            study()
    finally:
        signal.signal(signal.SIGINT, before)
