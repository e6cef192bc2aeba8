"""The documents: their code runs and is right, Sphinx finds nothing wrong, and they are built once."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from components import REGISTRY
from orchestrator.api.handbook import build
from orchestrator.api.handbook import python_face as face
from orchestrator.api.handbook.equations import EQUATIONS, SOURCES
from orchestrator.api.handbook.mathml import mathml
from orchestrator.api.handbook.python_page import python_page
from orchestrator.api.handbook.snippets import run_page, snippets
from orchestrator.api.handbook.theory import theory_page
from orchestrator.cli.main import main

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore:'myst_parser.*is deprecated"),  # of other people's code
]

FIRST_HOUR = (build.PAGES / "first_hour.md").read_text(encoding="utf-8")


def in_this_process(arguments):
    """What a command prints, without the start of a process."""
    result = CliRunner().invoke(main, arguments.split())
    assert result.exit_code == 0, result.output
    return result.output


def test_the_first_hour_runs(tmp_path):
    """Done-when: every file, command and line of Python of the page works as it stands, and its pictures are there."""
    kinds = [snippet.kind for snippet in snippets(FIRST_HOUR)]
    assert kinds.count("toml") == 2
    assert kinds.count("python") >= 4
    shown = run_page(FIRST_HOUR, tmp_path, "first_hour.md", in_this_process)
    assert ": OK" in shown
    assert re.search(r"latch torque.* +HL1 +\d", shown)
    pictures = re.findall(r"!\[[^]]+\]\(([^)]+)\)", FIRST_HOUR)
    assert len(pictures) >= 6
    assert all((tmp_path / picture).is_file() for picture in pictures)


def test_a_page_that_is_wrong_is_told_of(tmp_path):
    """Control: a command that fails and Python that raises do not pass."""
    with pytest.raises(fanfold.FanfoldError, match="deploy"):
        run_page("```console\n$ fanfold deploy\n```\n", tmp_path, "page.md")
    with pytest.raises(ZeroDivisionError):
        run_page("```python\n1 / 0\n```\n", tmp_path, "page.md")
    assert "```text\n3\n```" in run_page("```python\nprint(1 + 2)\n```\n", tmp_path, "page.md")


def test_what_pages_name_is_there():
    """Commands with their options, files and names of Python that the pages name exist."""
    root, seen = build.ROOT, set()
    for path in sorted(build.PAGES.glob("*.md")):
        page = path.read_text(encoding="utf-8")
        for line in re.findall(r"(?:`|\$ )fanfold ([a-z][^`\n]*)", page):
            name, *arguments = line.split()
            command = main.commands[name]
            if name == "analyse":
                name, command = arguments[0], command.get_command(None, arguments[0])
            seen.add(name)
            options = {option for parameter in command.params for option in parameter.opts}
            assert {word for word in arguments if word.startswith("--")} <= options, line
        files = re.findall(r"`((?:components|fmus|orchestrator|tests)/[\w/.]+)`", page)
        assert all((root / file).exists() for file in files), files
        assert set(re.findall(r"`fanfold\.(\w+)`", page)) <= set(fanfold.__all__)
    assert {"check", "run", "compare", "study", "tune", "export", "stress", "docs"} <= seen


def test_python_and_theory_are_whole():
    """Completeness: each name of the Python face, each kind with its equations, and each source that a text names."""
    page, theory = python_page(), theory_page()
    assert all(f":: orchestrator.{name}\n" in page for name in fanfold.__all__)
    assert all(f"### `{kind}`\n\n```{{math}}\n" in theory for kind in REGISTRY)
    modules = {name for name in EQUATIONS if name not in REGISTRY}
    assert all(f"### `{name.replace('.', '/')}.py`\n\n```{{math}}" in theory for name in modules)
    named = re.findall(r"((?:[A-Z]\w+(?:, | and )?)+),? \(?((?:19|20)\d\d)\b", theory.split("## Sources")[0])
    assert len(named) >= 10
    known = {name.split()[0].rstrip(",") + " " + name.split()[-1] for name in SOURCES}
    assert {f"{re.split(r'[ ,]', who)[0]} {year}" for who, year in named} <= known


def test_pages_build_without_a_warning(tmp_path):
    """Done-when: Sphinx finds nothing wrong in any page; what is measured is left out, and its pictures are blank."""
    pytest.importorskip("sphinx", reason="the extra docs is not installed")
    source = tmp_path / "source"
    build.write_sources(source, gallery=False, measure=False)
    assert "tape_spring" in (source / "extending.md").read_text(encoding="utf-8")
    for picture in re.findall(r"!\[[^]]+\]\(([^)]+)\)", FIRST_HOUR):
        path = source / picture
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(b"")
    build.run_sphinx(source, tmp_path / "pages", tmp_path / "trees", "dummy")


def test_a_page_is_built_and_a_dead_link_is_told_of(tmp_path):
    """Control: equations stand in the page without a network, and what Sphinx warns of is an error."""
    pytest.importorskip("sphinx", reason="the extra docs is not installed")
    pages, trees = tmp_path / "pages", tmp_path / "trees"
    (tmp_path / "source").mkdir()
    page = tmp_path / "source" / "index.md"
    page.write_text("(here)=\n# Title\n\n$F = m a$ [](#here)\n", encoding="utf-8")
    build.run_sphinx(page.parent, pages, trees)
    found = (pages / "index.html").read_text(encoding="utf-8")
    assert "<math" in found
    assert not re.search(r"<(script|link)[^>]+https?:", found)
    page.write_text("# Title\n\n[nowhere](#nowhere)\n", encoding="utf-8")
    with pytest.raises(fanfold.FanfoldError, match=r"index\.md"):
        build.run_sphinx(page.parent, pages, trees)
    for equations, words in EQUATIONS.values():
        assert all("</math>" in mathml(equation, True) for equation in equations)
        assert all("</math>" in mathml(letter, False) for letter in re.findall(r"\$([^$]+)\$", words))


def test_a_missing_extra_is_a_sentence(tmp_path, monkeypatch):
    """Without Sphinx the command says what to install, and builds nothing."""
    monkeypatch.setattr(build, "_NEEDS", ("no_such_library",))
    result = CliRunner().invoke(main, ["docs", "--no-browser", "--out", str(tmp_path / "pages")])
    assert result.exit_code == 1
    assert "no_such_library" in result.output
    assert ".[docs]" in result.output
    assert not (tmp_path / "pages").exists()


def test_documents_are_built_once_and_opened(tmp_path, monkeypatch):
    """Pages that are there are opened; those of other sources are built anew."""
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
    monkeypatch.setattr(face, "_digest", lambda: "of other sources")
    assert CliRunner().invoke(main, ["docs", "--no-browser", "--out", str(tmp_path)]).exit_code == 0
    assert len(built) == 2
    assert (
        CliRunner().invoke(main, ["docs", "--no-browser", "--rebuild", "--out", str(tmp_path)]).exit_code == 0
    )
    assert len(built) == 3
    assert len(opened) == 2
