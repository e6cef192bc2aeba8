"""`check_fmu` names each problem; one FMU is spoiled in one way at a time."""

from __future__ import annotations

import re
import zipfile

import pytest

from components import ComponentError
from fmus import check_fmu
from fmus.archive import LARGEST_BYTES, MOST_MEMBERS, zip_bytes
from fmus.description.units import base_unit
from tests.conformance.programs.driver import built
from tests.conformance.programs.toy import Toy


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FANFOLD_CACHE", str(tmp_path_factory.mktemp("cache")))
        return built(Toy.example(), "toy")


def spoiled(good, tmp_path, member, pattern, replacement):
    with zipfile.ZipFile(good) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    (name,) = (name for name in files if re.fullmatch(member, name))
    text = files.pop(name)
    if replacement is not None:
        files[name] = re.sub(pattern, replacement, text, flags=re.DOTALL)
        assert files[name] != text
    path = tmp_path / "spoiled.fmu"
    path.write_bytes(zip_bytes(files))
    return path


DESCRIPTION = "modelDescription.xml"
ENTRY = "resources/fanfold_.*_entry.py"


@pytest.mark.parametrize(
    ("member", "pattern", "replacement", "sentence"),
    [
        (DESCRIPTION, b"", None, "modelDescription.xml"),
        (DESCRIPTION, b"</fmiModelDescription>", b"", "not well-formed"),
        (DESCRIPTION, b'fmiVersion="2.0"', b'fmiVersion="1.0"', "FMU 2.0"),
        (
            DESCRIPTION,
            b"<InitialUnknowns>.*</InitialUnknowns>",
            b"",
            "level[1] ",
        ),
        (
            DESCRIPTION,
            b'index="10" dependencies="[0-9 ]*"',
            b'index="10" dependencies="99"',
            "to variable 99",
        ),
        (
            DESCRIPTION,
            b'(name="rate" valueReference=")[0-9]+"',
            rb'\g<1>0"',
            "reference 0, ",
        ),
        (DESCRIPTION, b'(generationDateAndTime="[^"]*)Z"', rb'\1+00:00"', " 2026"),
        (DESCRIPTION, b'name="rate"', b'name="the rate"', "the rate"),
        (DESCRIPTION, b'"structured"', b'"flat"', "variableNamingConvention"),
        (DESCRIPTION, b'unit="J" ?', b"", "stored_energy"),
        (DESCRIPTION, b'<Unit name="J">.*?</Unit>', b"", 'unit "J" of variable "stored_energy"'),
        (DESCRIPTION, b'canGetAndSetFMUstate="true"', b"", "canGetAndSetFMUstate"),
        (".*linux64.*|.*darwin64.*", b"", None, "binary"),
        (ENTRY, b"class Slave", b"raise OSError\n\nclass Slave", "instantiated"),
        (ENTRY, b"class Slave", b"import os; os.abort()\n\nclass Slave", "SIGABRT"),
        ("resources/component.json", b'"start": .*', b'"start": [0,0,0,13.0,0,0,0,0,1]}', "choose another"),
        (
            "resources/component.json",
            b'"start": .*',
            b'"start": [0,0,0,-1.0,0,0,0,0,1]}',
            "least 0",
        ),
        ("resources/component.json", b"__array__", b"__spoiled__", "initialized"),
        (".*extra/toy.py", b"c\\[.weight.\\] \\*", b"np.inf *", "force is"),
        (".*extra/toy.py", b"x\\[-1\\] \\+ h", b"np.nan", "x[3] = nan"),
    ],
)
def test_problem_is_named(good, tmp_path, member, pattern, replacement, sentence):
    problems = check_fmu(spoiled(good, tmp_path, member, pattern, replacement))
    assert any(sentence in problem for problem in problems), problems
    assert all("\n" not in problem for problem in problems)


def test_advice_does_not_stop_the_trial_run(good, tmp_path):
    """House rules stopped the run of a foreign FMU, and nobody could tell them from breaches of the standard."""
    flat = spoiled(good, tmp_path, DESCRIPTION, b'"structured"', b'"flat"')
    (advice,) = check_fmu(flat)
    assert advice.kind == "advice"
    with zipfile.ZipFile(flat) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    (entry,) = (name for name in files if re.fullmatch(ENTRY, name))
    flat.write_bytes(
        zip_bytes({**files, entry: files[entry].replace(b"class Slave", b"raise OSError\n\nclass Slave")})
    )
    kinds = [problem.kind for problem in check_fmu(flat)]
    assert kinds == ["advice", "breaks the standard"]
    assert [problem.kind for problem in check_fmu(flat, run=False)] == ["advice"]


def test_what_fanfold_needs_is_told_apart(good, tmp_path):
    path = spoiled(good, tmp_path, ".*linux64.*|.*darwin64.*", b"", None)
    assert "Fanfold needs" in {problem.kind for problem in check_fmu(path)}


def test_another_interface_breaks_no_standard(good, tmp_path):
    """FMI 3.0, 2.4: an FMU has at least one interface type, any. Regression: this was a breach of the standard."""
    path = spoiled(good, tmp_path, DESCRIPTION, b"CoSimulation", b"ScheduledExecution")
    (problem,) = check_fmu(path)
    assert problem.kind == "Fanfold needs"
    assert "scheduled execution" in problem
    (problem,) = check_fmu(spoiled(good, tmp_path, DESCRIPTION, b"<CoSimulation", b"<None"))
    assert problem.kind == "breaks the standard"


def test_archives_that_cannot_be_unpacked_are_told_of(good, tmp_path):
    """Members that lead out of the folder, bombs by size and by number, damaged contents: R19 and R20."""
    with zipfile.ZipFile(good) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    path = tmp_path / "bad.fmu"
    path.write_bytes(zip_bytes({**files, "../../evil": b"x"}))
    assert "'../../evil'" in check_fmu(path)[0]
    path.write_bytes(zip_bytes({**files, "resources/zeros": bytes(LARGEST_BYTES)}))
    assert "unpack" in check_fmu(path)[0]
    path.write_bytes(zip_bytes({**files, **{f"resources/{k}": b"" for k in range(MOST_MEMBERS)}}))
    assert "files" in check_fmu(path)[0]
    content = bytearray(zip_bytes(files))
    with zipfile.ZipFile(good) as archive:
        start = archive.getinfo("modelDescription.xml").header_offset + 60
    content[start : start + 20] = bytes(20)
    path.write_bytes(bytes(content))
    assert "damaged" in check_fmu(path)[0]


def test_indices_that_are_no_numbers_are_told(good, tmp_path):
    path = spoiled(good, tmp_path, DESCRIPTION, b'<Unknown index="[0-9]*"', b'<Unknown index="x"')
    assert any("index" in problem for problem in check_fmu(path))


def test_files_that_are_no_fmu(tmp_path):
    assert "none.fmu" in check_fmu(tmp_path / "none.fmu")[0]
    assert tmp_path.name in check_fmu(tmp_path)[0]
    (tmp_path / "text.fmu").write_text("text")
    assert check_fmu(tmp_path / "text.fmu") == ["text.fmu is not a zip archive"]


@pytest.mark.parametrize(
    ("unit", "exponents", "factor"),
    [
        ("1", {}, 1.0),
        ("N.m.s/rad", {"kg": 1, "m": 2, "s": -1, "rad": -1}, 1.0),
        ("kg.m2", {"kg": 1, "m": 2}, 1.0),
        ("m/s2", {"m": 1, "s": -2}, 1.0),
        ("1/s", {"s": -1}, 1.0),
        ("J/(kg.K)", {"m": 2, "s": -2, "K": -1}, 1.0),
        ("N.s/m", {"kg": 1, "s": -1}, 1.0),
        ("deg/s", {"rad": 1, "s": -1}, 0.017453292519943295),
    ],
)
def test_units_have_base_exponents(unit, exponents, factor):
    found, scale = base_unit(unit)
    assert {name: power for name, power in found.items() if power} == exponents
    assert scale == pytest.approx(factor, rel=1e-15)


@pytest.mark.parametrize("unit", ["furlong", "N m", "N/m.s", "m/s/s", "", "/s", "N.", "m^2"])
def test_unknown_units_give_a_sentence(unit):
    with pytest.raises(ComponentError, match="unit"):
        base_unit(unit)
