"""Pages of docs/: scenes are sound, keys are those of scene files, links lead somewhere, drawings are current."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from pythonfmu.builder import FmuBuilder

import orchestrator as fanfold
from orchestrator.scene.keys.listing import key_tables

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
CONTROLLER = ROOT / "examples" / "controllers" / "attitude_controller.py"
PAGES = sorted(DOCS.glob("*.md"))
SVG_TEXT = "{http://www.w3.org/2000/svg}text"


def drawing_program():
    spec = importlib.util.spec_from_file_location("draw", DOCS / "drawings" / "draw.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


DRAW = drawing_program()
BLOCKS = {name: text for page in PAGES for name, text in DRAW.blocks(page).items()}
SCENES = sorted(name for name in BLOCKS if name.endswith(".toml") and "\nplugins" not in BLOCKS[name])
"""Without those of plugins, which are programs that stay loaded."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """All scenes of the pages, with the files that their commands make."""
    path = tmp_path_factory.mktemp("pages")
    for name, text in BLOCKS.items():
        (path / name).write_text(text, encoding="utf-8")
    if "imported.toml" in SCENES:
        fanfold.export_body(path / "two_panels.toml", "panel1", path / "panel1.npz")
    if "controlled.toml" in SCENES:
        FmuBuilder.build_FMU(str(CONTROLLER), dest=str(path))
    return path


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.filterwarnings("ignore::orchestrator.FanfoldWarning")
def test_scenes_of_the_pages_are_sound(folder, name):
    """Rule: what a reader copies has no problem, variants included."""
    assert fanfold.check_scene(folder / name, rigid="all").problems == ()


def without_blocks(page):
    return re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)


def test_pages_have_every_key_of_scene_files():
    """Rule: a key that is added to scene files is added to the pages."""
    code = " ".join(found for page in PAGES for found in re.findall(r"`[^`]+`", without_blocks(page)))
    keys = {key.name for table in key_tables() for key in table.keys}
    assert sorted(keys - set(re.findall(r"\w+", code))) == []


def anchors(page):
    heads = re.findall(r"^#+ (.+)$", without_blocks(page), re.M)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_links_of_pages_lead_somewhere(page):
    """Rule: relative links name a file of the repository and a heading in it."""
    for link in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
        if "://" not in link:
            file, _, anchor = link.partition("#")
            target = (page.parent / file).resolve() if file else page
            assert target.exists(), link
            assert not anchor or anchor in anchors(target), link


def texts(path):
    return sorted("".join(found.itertext()) for found in ElementTree.parse(path).iter(SVG_TEXT))


def test_drawings_are_those_of_the_program(tmp_path):
    """Rule: the program still makes the committed drawings, by their texts; each stays below 60 kB."""
    drawn = DRAW.draw(tmp_path)
    assert {path.name for path in drawn} == {path.name for path in (DOCS / "drawings").glob("*.svg")}
    for path in drawn:
        kept = DOCS / "drawings" / path.name
        assert texts(path) == texts(kept), path.name
        assert kept.stat().st_size < 60_000


def test_the_wing_of_the_pages_deploys(folder):
    """As it stands: no warning, both lines latch, loads on the free spacecraft and at hinges are there."""
    result = fanfold.simulate(folder / "two_panels.toml", rigid="all")
    assert result.warnings == ()
    assert set(result.latch_times) == {"HL1", "HL2"}
    quantities = {number.quantity for number in result.headline.numbers()}
    assert {"attitude peak", "attachment force peak", "hinge torque peak"} <= quantities
