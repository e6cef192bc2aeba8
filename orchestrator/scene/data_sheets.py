"""The catalogue: bodies of the data sheets in components/data and of plugins, one table a body, as scenes have them.

A value may be a table of value, unit and source. An entry is `like` others: it has all that they have but what it says
itself. A `template` is no body, only there to be like.
"""

from __future__ import annotations

import tomllib
from collections import ChainMap
from collections.abc import Iterator, Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from components.contract.component import ComponentError

from .body_tables import Body
from .layers import Tree, merged
from .table import BodyError, SceneError
from .validation import EntryReader

_LIKE, _TEMPLATE = "like", "template"


def add_sheet(path: str | Path) -> None:
    """Add the bodies of a file as those in components/data are written, in place of what it had before.

    ComponentError where it cannot be read, has the name of a body from elsewhere or a body that cannot be.
    """
    path = Path(path).resolve()
    try:
        found = _plain(tomllib.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise ComponentError(f"{path}: the bodies cannot be read ({error.strerror})") from None
    except (ValueError, KeyError, TypeError) as error:
        raise ComponentError(f"{path}: this is no table of bodies ({error})") from None
    if wrong := [name for name, table in found.items() if not isinstance(table, dict)]:
        raise ComponentError(f"{path}: {', '.join(wrong)}: this is no table of a body")
    before = _added.pop(path, None)
    if before is not None and found == before:
        _added[path] = before
        return
    if taken := sorted(found.keys() & _tables().keys()):
        problems = [f"{', '.join(taken)}: there is such a body already; give it another name"]
    else:
        _added[path] = found
        problems = [problem for name in found for problem in _problems(name)]
    if problems:
        _added.pop(path, None)
        if before is not None:
            _added[path] = before
        raise ComponentError("\n".join(f"{path}: {problem}" for problem in problems))


def _problems(name: str) -> Iterator[str]:
    """What is wrong with a body, as sentences with their keys."""
    from .body_definitions import definition  # takes its time, which others need not

    if name not in entries():
        return
    try:
        table = entry_table(name)
    except KeyError as error:
        yield f"{name}.like: there is no body {error.args[0]!r}"
        return
    except (TypeError, RecursionError):
        yield f"{name}.like: is no list of names, or a circle of bodies that are like each other"
        return
    except SceneError as error:
        yield from (f"{name}.{problem}" for problem in error.problems)
        return
    reader = EntryReader({name: {"name": name, **table}}, ())
    body = reader.table(name, Body, required=True)
    yield from reader.problems
    if body is not None:
        try:
            definition(body)
        except BodyError as error:
            yield from (f"{name}.{problem}" for problem in error.problems)


def entries() -> tuple[str, ...]:
    """Names of all bodies."""
    return tuple(name for name, table in _tables().items() if not table.get(_TEMPLATE))


def entry_table(name: str) -> Tree:
    """The table of a body, what it is like put in."""
    table: Tree = {}
    for raw in _lineage(name):
        table = merged(table, raw)
    return {key: value for key, value in table.items() if key not in (_LIKE, _TEMPLATE)}


def check_entry(name: str) -> None:
    """BodyError where there is no entry of a name."""
    if name not in entries():
        raise BodyError([f"catalogue: there is no entry {name!r}; entries are {', '.join(entries())}"])


def with_entries(tree: Tree) -> tuple[Tree, dict[str, list[str]]]:
    """The tree where bodies have the tables of their entries, and by body the changes that cannot be merged."""
    bodies = tree.get("body")
    if not isinstance(bodies, list):
        return tree, {}
    whole: list[object] = []
    problems: dict[str, list[str]] = {}
    for body in bodies:
        name = body.get("catalogue") if isinstance(body, dict) else None
        try:
            below = entry_table(name) if isinstance(name, str) and name in entries() else {}
            whole.append(merged(below, body) if below else body)
        except SceneError as error:
            whole.append(body)
            place = str(body.get("name"))
            problems[place] = [f"body.{place}.{problem}" for problem in error.problems]
    return {**tree, "body": whole}, problems


def _lineage(name: str) -> Iterator[Tree]:
    """What an entry is like, the farthest first, then the entry itself."""
    table = _tables()[name]
    for other in table.get(_LIKE, ()):
        yield from _lineage(other)
    yield table


_added: dict[Path, dict[str, Tree]] = {}
"""Tables of files from outside."""


def _tables() -> Mapping[str, Tree]:
    """Every table of every data sheet by its name."""
    return ChainMap(_shipped(), *_added.values())


@cache
def _shipped() -> dict[str, Tree]:
    """Those that come with the package."""
    sheets = sorted((files("components") / "data").iterdir(), key=lambda file: file.name)
    texts = [file.read_text(encoding="utf-8") for file in sheets if file.name.endswith(".toml")]
    return {name: table for text in texts for name, table in _plain(tomllib.loads(text)).items()}


def _plain(value: Any) -> Any:  # noqa: ANN401 - whatever a TOML file gives
    """A table with each `{value, unit, source}` as a text of number and unit, or a list of these."""
    if isinstance(value, list):
        return [_plain(one) for one in value]
    if not isinstance(value, Mapping):
        return value
    if "value" not in value:
        return {key: _plain(one) for key, one in value.items()}
    number, unit = value["value"], value["unit"]
    return [f"{one!r} {unit}" for one in number] if isinstance(number, list) else f"{number!r} {unit}"
