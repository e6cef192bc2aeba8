"""The keys of scene files as they are told to people and to editors: all of them, each with its meaning."""

import tomllib
from pathlib import Path

import jsonschema
import pytest

from orchestrator.scene import find_scene, list_scenes
from orchestrator.scene.keys.json_schema import scene_schema
from orchestrator.scene.keys.listing import key_tables
from orchestrator.scene.keys.meanings import all_tables, meanings
from orchestrator.scene.reader import ARRAYS, TABLES
from tests.references.edits import edited
from tests.unit.scene.scene_cases import SCENES, TWO_PANELS

FILES = [*map(find_scene, list_scenes()), *sorted(SCENES.glob("*.toml"))]


@pytest.fixture(scope="module")
def schema():
    found = scene_schema()
    jsonschema.Draft202012Validator.check_schema(found)
    return jsonschema.Draft202012Validator(found)


def problems(schema, text):
    return list(schema.iter_errors(tomllib.loads(text)))


def test_every_field_has_a_meaning():
    """Completeness: each key of each model has a sentence where it is declared."""
    tables = all_tables()
    assert len(tables) > 20
    assert [
        f"{name}.{key}"
        for name, kind in tables.items()
        for key in kind.model_fields
        if not meanings(kind).get(key)
    ] == []


def test_every_key_is_in_the_list():
    """Completeness: the list has every field of every model that files reach."""
    listed = {(table.place, key.name) for table in key_tables() for key in table.keys}
    names = {name for _, name in listed}
    for kind in all_tables().values():
        assert {info.alias or key for key, info in kind.model_fields.items()} <= names, kind
    for name, kind in (*TABLES.items(), *ARRAYS.items()):
        told = {key for place, key in listed if place == name}
        assert told == {info.alias or key for key, info in kind.model_fields.items()}


def test_units_and_defaults_are_those_of_the_models():
    """Spot checks by hand against the models and the reader: unit, default, sign, choice, bounds, what is needed."""
    listed = {(table.place, key.name): key for table in key_tables() for key in table.keys}
    assert listed["scene", "tolerance"][1:4] == ("number, positive, from 1e-10 to 0.1", "", "0.0001")
    assert listed["joint", "radial_stiffness"][1:4] == ("quantity, positive", "N/m", "5e+06")
    assert listed["hinge_line.latch", "stiffness"][1:4] == ("quantity, positive", "N.m/rad", "needed")
    assert listed["body.panel", "sandwich"].default == "or `stiffness` or `layers`"
    assert listed["body.panel.arm", "patch"][1:4] == ("quantity, positive", "m", "0.03")
    assert listed["body.panel.arms", "patch"].default == ""  # that of `arm`
    assert listed["body", "frequencies_off"].unit == "Hz"


def test_the_example_of_a_table_is_a_table():
    """Truth: every example is TOML; those at the top of a file are without a problem in the schema."""
    loose = jsonschema.Draft202012Validator(scene_schema())
    for table in key_tables()[1:]:
        tree = tomllib.loads(table.example)
        assert set(tree) == {table.place.split(".")[0]}
        if "." not in table.place and table.place not in (
            "connection",
            "event",
        ):  # one of several keys is needed
            assert list(loose.iter_errors({"extends": "amos3"} | tree)) == [], table.place


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_scene_is_valid(schema, path):
    """Truth: what is read without a problem has none for an editor either."""
    assert problems(schema, Path(path).read_text(encoding="utf-8")) == []


WRONG = {
    "a mistyped key": ("aligned_angle", "start_angle = 0.0\nalined_angle"),
    "a table of no such name": ("[base]", "[bass]"),
    "a missing key": ("axis =", "# axis ="),
    "a value of another type": ("until = ", "until = [1] # "),
}


@pytest.mark.parametrize("what", WRONG)
def test_mistakes_are_found(schema, what):
    """Control: the schema refuses what the reader refuses, so that the scenes above mean something."""
    before, after = WRONG[what]
    text = TWO_PANELS.replace(before, after)
    assert text != TWO_PANELS
    assert problems(schema, text)


def test_mistakes_in_parameters_and_bodies_are_found(schema):
    """Control: parameters by the kind of a connection, keys of a panel, and keys within variants."""
    stop = '[[connection]]\nname = "s"\nkind = "contact"\nports = {}\nparameters = { %s = 1 }\n'
    assert problems(schema, TWO_PANELS + stop % "gap") == []
    assert problems(schema, TWO_PANELS + stop % "gape")
    body = '[[body]]\nname = "p"\n[body.panel]\n%s = "1 m"\n'
    assert problems(schema, TWO_PANELS + body % "width") == []
    assert problems(schema, TWO_PANELS + body % "widht")
    assert problems(schema, TWO_PANELS + "[variant.cold.friction]\ncoefficient = 0.1\n") == []
    assert problems(schema, TWO_PANELS + "[variant.cold.friction]\ncoeficient = 0.1\n")


def test_layers_may_leave_keys_out(schema):
    """A file that extends another gives changes by name alone; one that stands alone must be whole."""
    change = '[[hinge_line]]\nname = "HL1"\nlatch = { damping_ratio = 0.01 }\n'
    assert problems(schema, 'extends = "amos3"\n' + change) == []
    assert problems(schema, change)
    assert problems(schema, edited('extends = "amos3"\n' + change, ("damping_ratio", "damping_ration")))
