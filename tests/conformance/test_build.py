"""Building: equal content gives equal files, other content another GUID, wrong values a sentence."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
from fmpy import read_model_description

from components import REGISTRY, Component, ComponentError
from fmus import build_fmu, value_references
from fmus.python.bundle import bundle, pack_value
from fmus.python.slave import unpack_value
from tests.conformance.programs.driver import KINDS, built
from tests.conformance.programs.toy import Toy


@pytest.fixture(autouse=True)
def fresh_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("FANFOLD_CACHE", str(tmp_path / "cache"))


def guid(path):
    return read_model_description(path, validate=False).guid


@pytest.mark.parametrize("kind", KINDS)
def test_bytes_depend_on_content_only(kind, tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1794880800")
    first = build_fmu(KINDS[kind].example(), kind, tmp_path).read_bytes()
    monkeypatch.setenv("FANFOLD_CACHE", str(tmp_path / "other"))
    assert built(KINDS[kind].example(), kind).read_bytes() == first


def test_guid_follows_the_content():
    guids = {
        guid(built(Toy.example(), "a")),
        guid(built(Toy.example(), "b")),
        guid(built(Toy.example(), "a", start={"rate": 3.0})),
        guid(built(Toy(np.eye(3), Toy.example().structure["options"]), "a")),
    }
    assert len(guids) == 4
    assert guid(built(Toy.example(), "a", start={"rate": 2.0})) in guids


def cached_files(tmp_path):
    return {path.name: path.stat().st_ino for path in (tmp_path / "cache").iterdir()}


def test_start_values_share_all_code(tmp_path):
    """Bookkeeping: what differs in a start value or in data adds nothing to the cache; another name is other code."""
    built(Toy.example(), "toy")
    first = cached_files(tmp_path)
    assert len(first) == 1
    built(Toy.example(), "toy", start={"rate": 3.0})
    built(Toy(np.eye(3), Toy.example().structure["options"]), "toy")
    assert cached_files(tmp_path) == first
    built(Toy.example(), "other")
    assert len(cached_files(tmp_path)) == 2


@pytest.mark.parametrize("damage", [b"", b"not an archive", "half", "one bit"])
def test_damaged_code_is_never_handed_on(damage, tmp_path, monkeypatch):
    """Bookkeeping: an FMU made over a damaged cache is the one made before, and the cache is whole again."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1794880800")
    component = REGISTRY["eddy_current_damper"].example()
    sound = built(component, "brake").read_bytes()
    (file,) = (tmp_path / "cache").iterdir()
    kept = file.read_bytes()
    spoilt = {"half": kept[: len(kept) // 2], "one bit": kept[:900] + bytes([kept[900] ^ 1]) + kept[901:]}
    file.write_bytes(damage if isinstance(damage, bytes) else spoilt[damage])
    assert built(component, "brake").read_bytes() == sound
    assert file.read_bytes() == kept


def test_start_values_reach_the_description():
    path = built(Toy.example(), "toy", start={"start": (1, 2, 3), "drive[2]": 0.1, "rate": 1e-17})
    starts = {v.name: v.start for v in read_model_description(path).modelVariables}
    assert [float(starts[f"start[{i}]"]) for i in (1, 2, 3)] == [1.0, 2.0, 3.0]
    assert (float(starts["drive[1]"]), float(starts["drive[2]"]), float(starts["rate"])) == (0.0, 0.1, 1e-17)
    assert starts["level[1]"] is None


@pytest.mark.parametrize(
    ("start", "sentence"),
    [
        ({"rat": 1.0}, "'rate'"),
        ({"start": (1.0, 2.0)}, "start has 3 scalars; 2 start values"),
        ({"rate": -1.0}, "rate = -1 1/s"),
        ({"rate": 13.0}, "bad luck"),
        ({"level": 1.0}, "'level'"),
        ({"drive": float("nan")}, r"drive\[1\] .*nan"),
    ],
)
def test_wrong_start_values_give_a_sentence(start, sentence):
    with pytest.raises(ComponentError, match=sentence):
        built(Toy.example(), "toy", start=start)


def test_wrong_name_gives_a_sentence():
    with pytest.raises(ComponentError, match="identifier"):
        built(Toy.example(), "left wing")


def test_references_are_contiguous_in_declared_order():
    component = Toy.example()
    references = value_references(component)
    names = [name for layout in component.layouts for name in layout.scalar_names()]
    assert list(references) == names
    assert list(references.values()) == list(range(len(names)))
    described = read_model_description(built(component, "toy")).modelVariables
    assert {v.name: v.valueReference for v in described} == references


def test_dependencies_follow_feedthrough():
    options = Toy.example().structure["options"]
    for feedthrough in (False, True):
        component = Toy(np.eye(3), {**options, "feedthrough": feedthrough})
        description = read_model_description(built(component, f"toy{int(feedthrough)}"))
        inputs = {v.name for v in description.modelVariables if v.causality == "input"}
        for unknown in description.outputs:
            expected = inputs if feedthrough or unknown.variable.name == "stored_energy" else set()
            assert {v.name for v in unknown.dependencies} == expected
        assert len(description.initialUnknowns) == 5
        for unknown in description.initialUnknowns:
            assert unknown.dependencies is None  # which means all that is known, says the standard


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != Toy.kind])
def test_only_reachable_modules_are_carried(kind):
    package, files = bundle(KINDS[kind])
    carried = {path for path in files if path.startswith(f"{package}/components/")}
    assert f"{package}/components/contract/component.py" in carried
    assert f"{package}/components/{KINDS[kind].__module__.rpartition('.')[2]}.py" in carried
    assert not any(b"from components" in source for source in files.values())


def test_structure_survives_packing():
    arrays = {}
    value = {
        "a": (1, [2.5, "x"], {"b": np.arange(4.0)}),
        "c": np.array([[1]]),
        "d": True,
        "e": np.float64(0.1),
    }
    result = unpack_value(pack_value(value, arrays), arrays)
    assert result["a"][:2] == (1, [2.5, "x"])
    np.testing.assert_array_equal(result["a"][2]["b"], np.arange(4.0))
    assert (result["c"].dtype, result["d"], result["e"]) == (value["c"].dtype, True, 0.1)


@pytest.mark.parametrize("value", [{1: 2}, {"__array__": 1}, {1, 2}, lambda: 0, np.array([None])])
def test_other_structure_values_are_refused(value):
    with pytest.raises(ComponentError, match=r"structure"):
        pack_value([value], {})


def test_component_outside_the_package_is_one_file():
    assert issubclass(Toy, Component)
    _, files = bundle(Toy)
    assert sum(path.endswith("extra/toy.py") for path in files) == 1
    with zipfile.ZipFile(built(Toy.example(), "toy")) as archive:
        assert not any("modal" in name or "panel" in name for name in archive.namelist())
