"""Bodies of the data sheets in components/data: one table a body, values with unit and source.

An entry is `like` others: it has all that they have but what it says itself. A `template` is no body, only there to
be like.
"""

from __future__ import annotations

import tomllib
from collections import ChainMap
from collections.abc import Iterator, Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from ..contract.component import ComponentError
from .definition import BodyDefinition
from .reader import read_body
from .tables import TableError, Tree, laid_over


def add_sheet(path: str | Path) -> bool:
    """Add the bodies of a file as those in components/data are written; whether any of them changed.

    ComponentError where it cannot be read, has the name of a body from elsewhere or a body that cannot be; what it had
    before is replaced.
    """
    path = Path(path).resolve()
    try:
        found = {
            name: _values(table) for name, table in tomllib.loads(path.read_text(encoding="utf-8")).items()
        }
    except OSError as error:
        raise ComponentError(f"{path}: the bodies cannot be read ({error.strerror})") from None
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ComponentError(f"{path}: this is no table of bodies ({error})") from None
    if found == _added.get(path):
        return False
    elsewhere = _shipped().keys() | {
        name for other, known in _added.items() if other != path for name in known
    }
    if taken := sorted(found.keys() & elsewhere):
        raise ComponentError(
            f"{path}: {', '.join(taken)}: there is such a body already; give it another name"
        )
    before = _added.get(path)
    _added[path] = found
    if problems := list(_problems(found)):
        if before is None:
            del _added[path]
        else:
            _added[path] = before
        raise ComponentError("\n".join(f"{path}: {problem}" for problem in problems))
    entry.cache_clear()
    return True


def _problems(tables: Mapping[str, Tree]) -> Iterator[str]:
    """What is wrong with the bodies of a file, as sentences with their keys."""
    for name, table in tables.items():
        try:
            if not table.get("template"):
                read_body(entry_table(name))
        except TableError as error:
            yield from (f"{name}.{problem}" for problem in error.problems)
        except KeyError as error:
            yield f"{name}.like: there is no body {error.args[0]!r}"


def entries() -> tuple[str, ...]:
    """Names of all bodies."""
    return tuple(name for name, table in _tables().items() if not table.get("template"))


@cache
def entry(name: str) -> BodyDefinition:
    """The body of a name; ComponentError where there is none."""
    return read_body(entry_table(name))


def entry_table(name: str) -> Tree:
    """The table of a body, what it is like put in; values are pairs of number and unit."""
    if name not in entries():
        raise ComponentError(f"there is no catalogue entry {name!r}; entries are {', '.join(entries())}")
    table: Tree = {}
    for raw in _lineage(name):
        table = laid_over(table, raw)
    return {key: value for key, value in table.items() if key not in ("like", "template")}


def _lineage(name: str) -> Iterator[Tree]:
    """What an entry is like, the farthest first, then the entry itself."""
    table = _tables()[name]
    for other in table.get("like", ()):
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
    return {name: _values(table) for text in texts for name, table in tomllib.loads(text).items()}


def _values(table: Mapping[str, Any]) -> Any:  # noqa: ANN401 - a table, or a value
    """A table with its `{value, unit, source}` as pairs of number and unit, lists as lists of pairs."""
    if "value" in table:
        value, unit = table["value"], table["unit"]
        return [(number, unit) for number in value] if isinstance(value, list) else (value, unit)
    return {key: _entry(value) for key, value in table.items()}


def _entry(value: Any) -> Any:  # noqa: ANN401 - whatever a TOML file gives
    if isinstance(value, Mapping):
        return _values(value)
    return [_entry(one) for one in value] if isinstance(value, list) else value
