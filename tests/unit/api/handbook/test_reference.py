"""The reference says everything that is declared."""

import json
import re

import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from components import LAGGED, REGISTRY
from orchestrator.api.handbook.reference import components_page, scene_page
from orchestrator.cli.main import main
from orchestrator.scene.keys.listing import key_tables


@pytest.fixture(scope="module")
def pages():
    return {"scene": scene_page(), "components": components_page()}


def test_every_scene_key_is_in_the_reference(pages):
    """Completeness: each key stands in the section of its table, with its unit, and every link has its target."""
    parts = re.split(r"^###? ", pages["scene"], flags=re.MULTILINE)
    sections = {part.split("\n")[0].strip("`[]"): part for part in parts}
    for table in key_tables():
        section = sections[table.place or "Outside of the tables"]
        for key in table.keys:
            row = next(line for line in section.splitlines() if line.startswith(f"| `{key.name}` |"))
            assert key.unit in row
            assert key.meaning.split("\n")[0][:40] in row
    targets = set(re.findall(r"^\(([\w-]+)\)=", pages["scene"], re.MULTILINE))
    assert set(re.findall(r"\]\(#([\w-]+)\)", pages["scene"])) <= targets


@pytest.mark.parametrize("kind", sorted(REGISTRY))
def test_every_signal_is_in_the_reference(kind, pages):
    """Completeness: each variable of each component has a row with its unit and a meaning."""
    section = pages["components"].split(f"## `{kind}`")[1].split("\n## ")[0]
    examples = [REGISTRY[kind].example(), *REGISTRY[kind].other_examples().values()]
    for example in examples:
        layouts = (example.parameter_layout, example.observation_layout)
        for quantity in (
            *(q for layout in layouts for q in layout.quantities),
            *example.own_inputs,
            *example.own_outputs,
        ):
            if not quantity.name.endswith(LAGGED):
                assert quantity.description
                rows = [line for line in section.splitlines() if line.startswith(f"| `{quantity.name}` |")]
                unit = "" if quantity.unit == "1" else f"`{quantity.unit}`"
                assert any(quantity.description in row and unit in row for row in rows)


def test_the_command_writes_the_schema(tmp_path):
    """The file is what Python gives."""
    path = tmp_path / "scene.json"
    result = CliRunner().invoke(main, ["docs", "--json-schema", str(path)])
    assert result.exit_code == 0
    assert json.loads(path.read_text(encoding="utf-8")) == fanfold.json_schema()
