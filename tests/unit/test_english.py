"""Plain English: no banned words in what a user reads: documents, help, docstrings of the Python face, messages."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

import orchestrator as fanfold
from components import REGISTRY
from orchestrator.cli.main import main
from orchestrator.messages import CODES
from orchestrator.scene.keys.listing import key_tables

ROOT = Path(__file__).parents[2]
BANNED = re.compile(
    r"\b(told|tells|besides?|hardly meant|hangs? on|vouch\w*|doubts?|at the most|as far as|of those that)\b",
    re.IGNORECASE,
)
CODE_BLOCK = re.compile(r"```.*?```|`[^`\n]*`|^ {4}.*$", re.DOTALL | re.MULTILINE)
DOCUMENTS = (
    "README.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    "docs/*.md",
)
CLEAN_ROOMS = ("api", "cli", "validity", "run", "results", "cosim")
"""Packages of the orchestrator all of whose docstrings are checked."""


def banned_in(text: str) -> list[str]:
    """Banned words of a text, each with the words around it."""
    return [text[max(0, found.start() - 40) : found.end() + 20] for found in BANNED.finditer(text)]


def helps(command: click.Command, name: str) -> Iterator[tuple[str, str]]:
    """Help texts of a command, its options and its subcommands."""
    yield name, command.help or ""
    for parameter in command.params:
        yield f"{name} {parameter.opts[0]}", getattr(parameter, "help", None) or ""
    if isinstance(command, click.Group):
        for sub in command.list_commands(click.Context(command)):
            yield from helps(command.get_command(click.Context(command), sub), f"{name} {sub}")


def docstrings(name: str) -> Iterator[tuple[str, str]]:
    """Docstrings of a name of the Python face, and of the public methods of a class."""
    found = getattr(fanfold, name)
    yield name, inspect.getdoc(found) or ""
    for member, value in inspect.getmembers(found) if inspect.isclass(found) else ():
        if not member.startswith("_") and (callable(value) or isinstance(value, property)):
            yield f"{name}.{member}", inspect.getdoc(value) or ""


def literals(node: ast.AST) -> str:
    """All text of the string literals below a node."""
    strings = (one for one in ast.walk(node) if isinstance(one, ast.Constant) and isinstance(one.value, str))
    return " ".join(one.value for one in strings)


def messages(tree: ast.Module) -> Iterator[str]:
    """Texts of messages in a module: of calls of `message`, and of generators of sentences."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "message":
            yield from (literals(argument) for argument in node.args[1:])
        if (
            isinstance(node, ast.FunctionDef)
            and ast.unparse(node.returns or ast.Constant(None)) == "Iterator[str]"
        ):
            yield from (
                literals(one.value) for one in ast.walk(node) if isinstance(one, ast.Yield) and one.value
            )


def problems(tree: ast.Module) -> Iterator[str]:
    """Texts of errors that a module raises."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
            yield from (literals(argument) for argument in node.exc.args)


def parsed(*packages: str) -> Iterator[tuple[str, ast.Module]]:
    for package in packages:
        for path in sorted((ROOT / package).rglob("*.py")):
            yield str(path.relative_to(ROOT)), ast.parse(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    "bad",
    [
        "joints that laws pull open are told of",
        "a friction beside the mean",
        "nobody vouches for it",
        "five times at the most",
        "how many it takes hangs on the load",
        "of those that never latch",
    ],
)
def test_checker_finds_bad_sentences(bad):
    """Control: each banned word is found in a text, in a message and in an error."""
    assert banned_in(bad)
    tree = ast.parse(
        f"def f() -> Iterator[str]:\n    yield f'{{x}}: {bad}'\nwarn(message('W-x', '{bad}'))\nraise E(['{bad}'])"
    )
    assert [bool(banned_in(text)) for text in (*messages(tree), *problems(tree))] == [True] * 3


def test_documents():
    """No banned words in documents, code apart."""
    paths = [path for pattern in DOCUMENTS for path in ROOT.glob(pattern)]
    assert len(paths) > len(DOCUMENTS)
    found = {path.name: banned_in(CODE_BLOCK.sub("", path.read_text(encoding="utf-8"))) for path in paths}
    assert {name: words for name, words in found.items() if words} == {}


def test_help():
    """No banned words in help texts of commands and options."""
    found = dict(helps(main, "fanfold"))
    assert len(found) > 150
    assert {name: banned_in(text) for name, text in found.items() if banned_in(text)} == {}


def test_python_face():
    """No banned words in public docstrings."""
    found = dict(one for name in fanfold.__all__ for one in docstrings(name))
    assert {name: banned_in(text) for name, text in found.items() if banned_in(text)} == {}


def test_list():
    """No banned words in what `fanfold list` prints of components and tables of scene files."""
    found = {kind: inspect.getdoc(component) or "" for kind, component in REGISTRY.items()}
    for kind, component in REGISTRY.items():
        example = component.example()
        layouts = (
            example.parameter_layout.quantities,
            example.own_inputs,
            example.observation_layout.quantities,
        )
        found |= {f"{kind}.{one.name}": one.description for layout in layouts for one in layout}
    for table in key_tables():
        found |= {
            table.place: table.meaning,
            **{f"{table.place}.{key.name}": key.meaning for key in table.keys},
        }
    assert len(found) > 250
    assert {name: banned_in(text) for name, text in found.items() if banned_in(text)} == {}


def test_messages():
    """No banned words in meanings of codes, texts of messages and sentences of errors."""
    texts = {f"CODES {code}": meaning for code, meaning in CODES.items()}
    for path, tree in parsed("components", "fmus", "orchestrator"):
        texts |= {f"{path} {k}": text for k, text in enumerate((*messages(tree), *problems(tree)))}
    assert len(texts) > 500
    assert {name: banned_in(text) for name, text in texts.items() if banned_in(text)} == {}


def test_docstrings_of_clean_rooms():
    """No banned words in docstrings of modules, classes and functions, private ones included."""
    kinds = (ast.Module, ast.ClassDef, ast.FunctionDef)
    texts = {
        f"{path} {getattr(node, 'name', '')}": ast.get_docstring(node) or ""
        for path, tree in parsed(*(f"orchestrator/{room}" for room in CLEAN_ROOMS))
        for node in ast.walk(tree)
        if isinstance(node, kinds)
    }
    assert len(texts) > 1000
    assert {name: banned_in(text) for name, text in texts.items() if banned_in(text)} == {}
