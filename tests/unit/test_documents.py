"""Documents say what there is: every message code, and paths that exist."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from components import REGISTRY
from orchestrator.cli.main import main
from orchestrator.messages import CODES
from orchestrator.scene import list_scenes

DOCUMENTS = Path(__file__).parents[2] / "docs"
WITH_EVIDENCE = ("validation.md", "performance.md", "extending.md", "../CONTRIBUTING.md")


def test_every_message_code_is_explained():
    """Completeness: the page has the codes and meanings of `CODES`, each with something to do."""
    text = (DOCUMENTS / "messages.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([WN]-[a-z-]+)` \| (.+?) \| (.+?) \|$", text, re.MULTILINE)
    assert {code: meaning for code, meaning, _ in rows} == CODES
    assert len(rows) == len(CODES)


@pytest.mark.parametrize("page", WITH_EVIDENCE)
def test_evidence_exists(page):
    """Completeness: tests, benchmarks and files that a page names are in the repository."""
    text = (DOCUMENTS / page).read_text(encoding="utf-8")
    root = DOCUMENTS.parent
    paths = re.findall(r"((?:components|fmus|orchestrator|tests|examples)/[\w/.]*\w)", text)
    modules = [name.replace(".", "/") for name in re.findall(r"python -m ((?:tests|fmus)[.\w]*\w)", text)]
    assert paths
    missing = [path for path in paths if not (root / path).exists()]
    missing += [
        m for m in modules if not ((root / f"{m}.py").exists() or (root / m / "__main__.py").exists())
    ]
    assert missing == []


@pytest.mark.slow
def test_the_recipe_by_impulses(tmp_path, monkeypatch):
    """Independent path: latch times of the scene with the spacecraft built in, `amos3 --variant free`, all rigid."""
    monkeypatch.chdir(tmp_path)
    text = (DOCUMENTS.parent / "examples/wing_on_a_spacecraft.py").read_text(encoding="utf-8")
    found = {}
    exec(compile(text.replace("END = 10e-3, 14.0", "END = 10e-3, 8.5"), "recipe", "exec"), found)
    assert found["latch_times"]["HL3"] == pytest.approx(7.39688, abs=1e-4)
    assert found["latch_times"]["HL2"] == pytest.approx(8.47970, abs=1e-4)


README = (DOCUMENTS.parent / "README.md").read_text(encoding="utf-8")


def section(title):
    """Text of a section of the README."""
    found = re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", README, re.MULTILINE | re.DOTALL)
    assert found, f"README.md has no section {title!r}"
    return found[1]


def test_readme_lists_every_component_and_scene():
    """Completeness: the first columns of both tables are the registry and the scenes, no more and no less."""
    kinds = re.findall(r"^\| `(\w+)` \|", section("Components"), re.MULTILINE)
    assert sorted(kinds) == sorted(REGISTRY)
    assert sorted(re.findall(r"^\| `([\w-]+)` \|", section("Scenes"), re.MULTILINE)) == sorted(list_scenes())


def shown_commands():
    """Every fanfold command line in the README and the pages, without its program."""
    pages = [README, *(page.read_text(encoding="utf-8") for page in DOCUMENTS.glob("*.md"))]
    found = [
        line for page in pages for line in re.findall(r"(?:^\$ |\.venv/bin/|`)fanfold ([^`\n]+)", page, re.M)
    ]
    return [shlex.split(line.split("#")[0].split(" | ")[0].rstrip("\\ "), posix=True) for line in found]


def test_shown_commands_exist():
    """Completeness: every command and option that is shown is one; every command is shown."""
    shown = set()
    for name, *arguments in shown_commands():
        if name not in main.commands:
            assert name.isupper() or name.startswith(("-", "[")), name  # fanfold COMMAND --help
            continue
        shown.add(name)
        command = main.commands[name]
        if isinstance(command, click.Group) and arguments:
            command = command.get_command(click.Context(command), arguments[0]) or command
        options = {option for p in command.params for option in (*p.opts, *p.secondary_opts)} | {"--help"}
        assert {a.partition("=")[0] for a in arguments if a.startswith("--")} <= options, (name, arguments)
    assert shown == set(main.commands)


def test_the_python_of_the_readme_runs(tmp_path, monkeypatch):
    """What the README shows of Python runs as it stands, and prints what stands below it, to the digits shown."""
    program, output = re.findall(
        r"^```(?:python)?\n(.*?)^```", section("From Python"), re.MULTILINE | re.DOTALL
    )
    monkeypatch.chdir(tmp_path)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(program, "README.md", "exec"), {})
    assert {path.name for path in tmp_path.iterdir()} == {"amos3.cold.h5", "torques.png"}
    numbers = [[float(x) for x in re.findall(r"\d+\.\d+", text)] for text in (printed.getvalue(), output)]
    assert numbers[0] == pytest.approx(numbers[1], rel=2e-3)


VALUE = r"(?<!± )(?<![\d.])\d+\.\d+"
"""A decimal number that is no estimated error: these depend on the last bits of a run."""


def run_page(text):
    """Run every file, command and program of a page in order; per block what is shown and what is printed."""
    values = {}
    for kind, block in re.findall(r"^```(python|console|toml)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        if kind == "toml" and (name := re.match(r"# (\w+\.toml)\n", block)):
            Path(name[1]).write_text(block, encoding="utf-8")
        elif kind == "python":
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                exec(compile(block, "page", "exec"), values)
            yield " ".join(re.findall(r"^ *print\(.*#(.*)$", block, re.MULTILINE)), printed.getvalue()
        elif kind == "console":
            for line, shown in re.findall(r"^\$ fanfold (.*)\n((?:(?!\$ ).*\n)*)", block, re.MULTILINE):
                result = CliRunner().invoke(main, shlex.split(line))
                assert result.exit_code == int("problem:" in shown), (line, result.output)
                yield shown, result.output


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::orchestrator.FanfoldWarning")
@pytest.mark.parametrize("page", ["first_hour", "python"])
def test_the_code_of_a_page_runs(page, tmp_path, monkeypatch):
    """Reproduction: all code of the page works as it stands; numbers that it shows are printed, to 0.2 % or 1e-4."""
    monkeypatch.chdir(tmp_path)
    compared = 0
    for shown, printed in run_page((DOCUMENTS / f"{page}.md").read_text(encoding="utf-8")):
        numbers = [[float(x) for x in re.findall(VALUE, text)] for text in (shown, printed)]
        agree = [any(x == pytest.approx(y, rel=2e-3, abs=1e-4) for y in numbers[1]) for x in numbers[0]]
        assert [x for x, is_printed in zip(numbers[0], agree, strict=True) if not is_printed] == [], printed
        compared += len(numbers[0])
    assert compared >= {"first_hour": 30, "python": 1}[page]


def test_readme_has_the_two_commands():
    """One line installs and runs, one installs and tests; CI takes the second from here."""
    lines = [line.strip() for line in section("Two commands").splitlines() if line.startswith("    ")]
    assert len(lines) == 2
    assert all(line.startswith("python3 -m venv .venv && ") for line in lines)
    assert lines[0].endswith("fanfold run amos3")
    assert "pytest" in lines[1]


def test_contributing_names_every_room():
    """Completeness: the table of rooms has every folder of the orchestrator."""
    text = (DOCUMENTS / "extending.md").read_text(encoding="utf-8")
    folders = [
        path.name for path in (DOCUMENTS.parent / "orchestrator").iterdir() if (path / "__init__.py").exists()
    ]
    assert [name for name in folders if f"`orchestrator/{name}`" not in text] == []
