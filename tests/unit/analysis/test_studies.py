"""Mode and step studies of a panel that starts close to its latch angle."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.figure import Figure

from orchestrator.analysis.studies import Case
from orchestrator.cli.main import main
from orchestrator.views.studies import draw_changes


def study(folder, name, *arguments, angle="170 deg", until=1.3, code=0):
    start = ("--set", f"hinge_line.HL.start_angle={angle}", "--set", f"scene.until={until}")
    options = ("--json", "--output", str(folder), *start, *arguments)
    result = CliRunner().invoke(main, ["analyse", name, "workbench", *options])
    assert result.exit_code == code, result.output
    return result


def test_steps_converge_with_second_order(tmp_path):
    """Errors c h^2 against the smallest step: (4^2 - 1) / (2^2 - 1) = 5; the next order is (w h)^2 = 1e-6 of it."""
    found = study(tmp_path, "step-study", "--rigid", "all", "--steps", "4e-3,2e-3,1e-3")
    controlled, coarse, middle, fine = json.loads(found.stdout)["cases"]
    assert [case["value"] for case in (controlled, coarse, middle, fine)] == [0.0, 4e-3, 2e-3, 1e-3]
    shifts = [case["lines"]["HL"]["shift"] for case in (coarse, middle)]
    # shifts of 1e-7 and 2e-8 s, instants of latch-up found to 1e-10 s
    assert shifts[0] / shifts[1] == pytest.approx(5.0, rel=0.02)
    assert fine["lines"]["HL"]["shift"] == 0.0
    assert abs(controlled["lines"]["HL"]["change_percent"]) < 0.1  # within a run's promise
    for picture in ("latch_torques.png", "changes.png"):
        assert (tmp_path / picture).stat().st_size > 10_000


@pytest.mark.thorough
def test_more_modes_come_closer_from_above(tmp_path):
    """Rayleigh and Ritz: frequencies of a reduced body are above those of the whole, and fall with every mode."""
    found = study(tmp_path, "mode-study", "--modes", "1,3,8", angle="179.9 deg", until=0.2)
    content = json.loads(found.stdout)
    whole = np.array(content["free_hz"])
    few, some, many = (np.array(content["reduced_free_hz"][count][:6]) for count in ("1", "3", "8"))
    for above, below in ((few, some), (some, many), (many, whole[:6])):
        assert np.all(above >= below * (1.0 - 1e-9))
    assert many[0] == pytest.approx(whole[0], rel=1e-3)
    assert [case["case"] for case in content["cases"]] == ["1 mode", "3 modes", "8 modes"]


@pytest.mark.parametrize(
    ("name", "arguments", "code", "sentence"),
    [
        ("step-study", ("--rigid", "all", "--steps", "2e-3,1e-3"), 1, "0.01 s"),
        ("step-study", ("--steps", "1e-3,nan,1e-4"), 2, "'--steps': nan"),
        ("step-study", ("--steps", "1e-3,1.0000001e-3"), 1, "step sizes"),
        ("step-study", ("--tolerance", "nan"), 2, "'--tolerance': nan"),
        ("mode-study", ("--modes", "2,3"), 1, "0.01 s"),
        ("mode-study", ("--modes", "2"), 1, "of modes"),
        ("mode-study", ("--rigid", "all"), 1, "no body"),
        (
            "mode-study",
            ("--rigid", "panel", "--body", "panel"),
            1,
            "panel has",
        ),
        ("mode-study", ("--set", "hinge_line.HL.held=true"), 1, "modes are none"),
    ],
)
def test_what_cannot_be_studied_is_told(tmp_path, name, arguments, code, sentence):
    result = study(tmp_path, name, *arguments, until=0.01, code=code)
    assert sentence in " ".join(result.stderr.replace("│", " ").split())


def test_changes_have_plain_numbers_at_the_studied_values(tmp_path, monkeypatch):
    """Interface: ticks at what was studied, and at least two on the other axis."""
    drawn = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, _, **options: drawn.append(figure))

    def case(value, peak):
        found = SimpleNamespace(latch_times={"HL": 1.0}, latch_torque_peaks={"HL": peak})
        return Case(str(value), value, SimpleNamespace(headline=found))

    cases = [case(2, 101.5), case(3, 100.3), case(5, 100.2), case(10, 100.0)]
    draw_changes(tmp_path / "changes.png", "title", "modes", cases, cases[-1])
    (axes,) = drawn[0].axes
    assert [text.get_text() for text in axes.get_xticklabels()] == ["2", "3", "5"]
    assert not axes.get_xticklabels(minor=True)
    low, high = axes.get_ylim()
    assert (low, high) == (0.1, 10.0)
    inside = [text.get_text() for text in axes.get_yticklabels() if low <= text.get_position()[1] <= high]
    assert inside == ["0.1", "1", "10"]
