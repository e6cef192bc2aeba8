"""Any part of a result may be wrong: readers answer with sentences, names are shown and not obeyed."""

import json
import shutil
from functools import partial
from pathlib import Path

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

from orchestrator.cli.main import main
from orchestrator.results.parts import printable
from orchestrator.results.result import Result
from tests.benchmark.faults import results as tampering
from tests.references import synthetic_result as reference

SPOILED = {
    "a value that is no number": (
        "signals/hl1_left/angle", lambda d: np.where(np.arange(len(d)) == 7, np.nan, d), "angle has",
    ),
    "huge values": ("signals/hl1_left/angle", lambda d: 1e200 * (1.0 + d), "angle has"),
    "times that run back": ("time", lambda d: d[::-1], "times"),
    "texts for numbers": ("signals/hl1_left/angle", lambda d: np.full(len(d), b"a"), "array"),
    "complex numbers": ("signals/hl1_left/angle", lambda d: d * 1j, "array"),
    "too many columns": ("signals/hl1_left/angle", lambda d: np.stack([d, d], 1), "one number"),
    "no hinge lines": ("hinge_lines", lambda d: "null", "hinge lines"),
    "hinge lines of numbers": ("hinge_lines", lambda d: "[1]", "damaged"),
    "deep JSON": ("hinge_lines", lambda d: "[" * 100_000, "damaged"),
    "faces of other nodes": ("geometry/panel1/faces", lambda d: d + 10_000, "panel1"),
    "a signal that is a group": ("signals/hl1_left/angle", lambda d: None, "damaged"),
}  # fmt: skip

EVERY = tuple(reference.signals()[1])
LATER_LINES = tuple(name for name in EVERY if name.startswith(("hl2", "hl3")))
"""A result without them has fewer figures, of which each takes a good part of a second."""


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    return reference.write(tmp_path_factory.mktemp("sound") / "run.h5")


def spoil(path: Path, place, change):
    with h5py.File(path, "r+") as file:
        value = file[place][()]
        attributes = dict(file[place].attrs)
        del file[place]
        new = change(value)
        if new is None:
            file.create_group(place)
        else:
            file[place] = new
            file[place].attrs.update(attributes)


def answer(*arguments):
    run = CliRunner().invoke(main, [str(one) for one in arguments])
    assert run.exception is None or isinstance(run.exception, SystemExit), run.exception
    return run


def test_section_forces_of_beams_are_read(tmp_path):
    """They have three numbers of every element, though their name ends like that of one number a row."""
    path = reference.write(tmp_path / "run.h5", leave_out=LATER_LINES)
    with h5py.File(path, "r+") as file:
        forces = np.arange(6.0 * len(file["time"])).reshape(-1, 6)
        file["signals/yoke/section_force"] = forces
    np.testing.assert_array_equal(Result.open(path).signal("yoke", "section_force"), forces)


@pytest.mark.parametrize("kind", SPOILED)
@pytest.mark.parametrize("command", ["plot", "report"])
def test_spoiled_parts_are_told_of(tmp_path, sound, kind, command):
    """Each was a traceback."""
    place, change, sentence = SPOILED[kind]
    path = Path(shutil.copy(sound, tmp_path))
    spoil(path, place, change)
    run = answer(command, path)
    assert run.exit_code == 1
    assert sentence in run.stderr
    assert len(run.stderr.splitlines()) == 1
    assert not list(tmp_path.glob("*.html"))


def test_a_run_that_ended_after_its_first_row_is_drawn(tmp_path):
    """The axis of step sizes had nothing to be logarithmic about."""
    path = reference.write(tmp_path / "run.h5", leave_out=(*LATER_LINES, "ccl", "damper", "base"))
    with h5py.File(path, "r+") as file:
        file["time"].resize(1, 0)
    assert answer("plot", path).exit_code == 0
    assert answer("report", path, "--frames", "1").exit_code == 0


def test_markup_in_names_is_shown(tmp_path):
    """[/bold] ended a comparison, and a dollar sign began a formula."""
    others = tuple(name for name in EVERY if not name.startswith(("hl1", "hl2")))
    path, other = (reference.write(tmp_path / name, leave_out=others) for name in ("a.h5", "b.h5"))
    for one in (path, other):
        with h5py.File(one, "r+") as file:
            lines = json.loads(file["hinge_lines"].asstr()[()])
            lines[0]["name"], lines[1]["name"] = "[/bold]", "$\\frac{$"
            del file["hinge_lines"]
            file["hinge_lines"] = json.dumps(lines)
            texts = [
                text.replace("hl1", "[/bold]").replace("hl2", "$\\frac{$")
                for text in file["events/event"].asstr()
            ]
            file["events/event"][:] = texts
    run = answer("compare", path, other, "--output", tmp_path / "out")
    assert run.exit_code == 0
    assert "[/bold]" in run.output
    assert "$\\frac{$" in run.output
    assert answer("plot", path).exit_code == 0


def test_terminal_escapes_are_shown(tmp_path):
    others = tuple(name for name in EVERY if name not in ("damper", "hl1_left"))
    path = reference.write(tmp_path / "run.h5", leave_out=others)
    with h5py.File(path, "r+") as file:
        file["signals"].move("damper", "\x1b[31mdamper")
    run = answer("compare", path, path, "--output", tmp_path / "out")
    assert "\x1b" not in run.output
    assert r"'\x1b[31mdamper'" in run.stderr
    assert printable("a\x1b[2Jb\nc\u0085") == "a\\x1b[2Jb\nc\\x85"


def test_a_report_that_cannot_be_written_leaves_nothing(tmp_path, monkeypatch):
    """A full disk left an empty file; what stood there before stays."""
    path = reference.write(tmp_path / "run.h5", leave_out=tuple(name for name in EVERY if name != "base"))
    target = tmp_path / "page.html"
    target.write_text("earlier", encoding="utf-8")

    def full(self, text, encoding=None):
        with self.open("w", encoding=encoding) as file:
            file.write(text[:100])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    run = answer("report", path, "--output", target, "--frames", "0")
    assert run.exit_code == 1
    assert f"{target}: " in run.stderr
    assert target.read_text(encoding="utf-8") == "earlier"
    assert {one.name for one in tmp_path.iterdir()} == {"run.h5", "page.html"}


def test_tampered_results_are_answered_with_sentences(tmp_path, monkeypatch):
    """A sample of the benchmark, on the result of one hinge line."""
    monkeypatch.setattr(
        reference, "write", partial(reference.write, leave_out=(*LATER_LINES, "ccl", "scene"))
    )
    assert list(tampering.faults(7, 3, tmp_path)) == []


def test_what_is_no_sentence_is_seen(tmp_path, monkeypatch):
    """Control: an exception of another kind is a fault."""
    monkeypatch.setattr(tampering, "_COMMANDS", (lambda bad, good, out: ["no such command"],))
    assert tampering.answer(["plot", "none.h5"]) == ""
    monkeypatch.setattr(main, "invoke", lambda ctx: 1 / 0)
    assert "ZeroDivisionError" in tampering.answer(["plot", "none.h5"])
