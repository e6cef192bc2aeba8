"""The documents: Sphinx reports nothing wrong, a wheel has what they are made of, and they are built once."""

from __future__ import annotations

import re
import tomllib
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages

import pytest
from click.testing import CliRunner

import components
import orchestrator as fanfold
from components import REGISTRY
from orchestrator.api.handbook import build
from orchestrator.api.handbook import python_face as face
from orchestrator.api.handbook.measured import validation
from orchestrator.cli.main import main

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore:.* is deprecated"),  # of other people's code
]
SOURCES = build.ROOT / "docs"


def needs_sphinx():
    for name in build._NEEDS:
        pytest.importorskip(name, reason="the extra docs is not installed")


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """All pages but the gallery, as HTML by name; nothing is simulated. A warning of Sphinx fails here."""
    needs_sphinx()
    folder = tmp_path_factory.mktemp("built")
    build.write_sources(folder / "docs", gallery=False, measure=False)
    build.run_sphinx(folder / "docs", folder / "pages", folder / "trees")
    assert {path.name for path in (SOURCES / "drawings").glob("*.svg")} <= {
        path.name for path in (folder / "pages" / "_images").iterdir()
    }
    return {path.stem: path.read_text(encoding="utf-8") for path in (folder / "pages").glob("*.html")}


def test_every_page_is_built_and_linked(pages):
    """Completeness: each document and reference has a page that the first page links to."""
    names = {path.stem for path in SOURCES.glob("*.md")} | build.GENERATED.keys() | set(build._TOP)
    assert names <= pages.keys()
    assert set(re.findall(r'href="(\w+)\.html"', pages["index"])) >= names - {"index"}


def test_references_are_complete(pages):
    """Completeness: commands with analyses, names of Python, equations of components."""
    commands = [*main.commands, *(f"analyse-{name}" for name in main.commands["analyse"].list_commands(None))]
    assert [name for name in commands if f'id="fanfold-{name}"' not in pages["command_line"]] == []
    assert [name for name in fanfold.__all__ if f'id="orchestrator.{name}"' not in pages["functions"]] == []
    sections = re.split(r"<h2>", pages["components"])
    with_equation = {
        kind for kind in REGISTRY for part in sections if f">{kind}<" in part and "<math" in part
    }
    assert {kind for kind, one in REGISTRY.items() if not one.comes_from_outside()} <= with_equation


def test_pages_need_no_network(pages):
    """Equations are MathML, and no script or style is loaded from elsewhere."""
    assert "<math" in pages["theory"]
    assert [name for name, page in pages.items() if re.search(r"<(script|link)[^>]+https?:", page)] == []


def test_a_dead_link_and_a_wrong_equation_are_reported(tmp_path):
    """Control: what Sphinx warns of is an error that names the page."""
    needs_sphinx()
    page = tmp_path / "source" / "index.md"
    page.parent.mkdir()
    for text in ("[nowhere](#nowhere)", r"$\nosuchcommand$"):
        page.write_text(f"# Title\n\n{text}\n", encoding="utf-8")
        with pytest.raises(fanfold.FanfoldError, match=r"index"):
            build.run_sphinx(page.parent, tmp_path / "pages", tmp_path / "trees")


def test_figures_of_this_machine():
    """Closed forms and published latch times (Bagnoli 2007, two or three digits) agree with what the page computes."""
    rows = [row.split(" | ") for row in validation().splitlines() if re.search(r"\d \| ", row)]
    pairs = [(float(row[2]), float(row[3]), row[4]) for row in rows if "exchanged" not in row[3]]
    assert len(pairs) == 7
    for expected, here, source in pairs:
        assert here == pytest.approx(expected, rel=1e-3 if "closed form" in source else 0.01)


def test_every_source_is_listed():
    """Completeness: each author and year that a docstring of a module names stands in the list of sources."""
    listed = (SOURCES / "theory.md").read_text(encoding="utf-8").split("## Sources")[1].replace("\n  ", " ")
    entries = re.findall(r"^\* (.+)$", listed, re.MULTILINE)
    modules = [
        module.name
        for package in (components, fanfold)
        for module in walk_packages(package.__path__, f"{package.__name__}.")
        if not {"cli", "native", "__main__"} & set(module.name.split("."))
    ]
    texts = " ".join(" ".join((import_module(name).__doc__ or "").split()) for name in modules)
    named = re.findall(r"((?:[A-Z]\w+(?:, | and )?)+),? \(?((?:19|20)\d\d)\b", texts)
    assert len(named) >= 10
    missing = {
        (who, year)
        for who, year in named
        if not any(re.split(r"[ ,]", who)[0] in entry and year in entry for entry in entries)
    }
    assert missing == set()


def test_a_wheel_has_the_documents():
    """Packaging: what is read from a checkout is put where an installed package looks for it."""
    project = tomllib.loads((build.ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    included = project["tool"]["hatch"]["build"]["targets"]["wheel"]["hooks"]["custom"]["documents"]
    target = build._PACKAGED.relative_to(build.ROOT).as_posix()
    names = ("docs", "examples", *(f"{name}.md" for name in build._TOP))
    assert included == {name: f"{target}/{name}" for name in names}
    assert all((build.ROOT / name).exists() for name in included)


def test_a_missing_extra_is_a_sentence(tmp_path, monkeypatch):
    """Without Sphinx the command says what to install, and builds nothing."""
    monkeypatch.setattr(build, "_NEEDS", ("no_such_library",))
    result = CliRunner().invoke(main, ["docs", "--no-browser", "--out", str(tmp_path / "pages")])
    assert result.exit_code == 1
    assert "no_such_library" in result.output
    assert ".[docs]" in result.output
    assert not (tmp_path / "pages").exists()


def test_documents_are_built_once_and_opened(tmp_path, monkeypatch):
    """Pages that are there are opened; those of other sources are built again."""
    built: list[Path] = []

    def fake(target, gallery):
        built.append(target)
        target.mkdir(exist_ok=True)
        (target / "index.html").write_text("", encoding="utf-8")

    opened = []
    monkeypatch.setattr(build, "build", fake)
    monkeypatch.setattr("webbrowser.open", opened.append)
    for _ in range(2):
        assert CliRunner().invoke(main, ["docs", "--out", str(tmp_path)]).exit_code == 0
    assert built == [tmp_path]
    assert opened == [(tmp_path / "index.html").as_uri()] * 2
    monkeypatch.setattr(face, "_digest", lambda documents: "of other sources")
    assert CliRunner().invoke(main, ["docs", "--no-browser", "--out", str(tmp_path)]).exit_code == 0
    assert len(built) == 2
    again = CliRunner().invoke(main, ["docs", "--no-browser", "--rebuild", "--out", str(tmp_path)])
    assert again.exit_code == 0
    assert len(built) == 3
    assert len(opened) == 2
