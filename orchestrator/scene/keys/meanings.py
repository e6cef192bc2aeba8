"""Meanings of the fields of a table: the texts that stand behind them in its class."""

from __future__ import annotations

import ast
from functools import cache
from inspect import getdoc, getsource
from textwrap import dedent

from ..table import Table


def all_tables() -> dict[str, type[Table]]:
    """Every table of scene files by the name of its class."""
    found: dict[str, type[Table]] = {}
    waiting = [Table]
    while waiting:
        for kind in waiting.pop().__subclasses__():
            found[kind.__name__] = kind
            waiting.append(kind)
    return found


@cache
def meanings(kind: type[Table]) -> dict[str, str]:
    """Meaning by field, in one line, of those that have one; fields of a base class have it there."""
    found: dict[str, str] = {}
    for one in reversed(kind.__mro__):
        if issubclass(one, Table) and one is not Table:
            found |= _told(one)
    return found


def title(kind: type[Table]) -> str:
    """What the table is, all of its docstring, without the name that begins it."""
    text = getdoc(kind) or ""
    name, mark, rest = text.partition("]: ")
    whole = rest if mark and name.startswith("[") else text
    return whole[:1].upper() + whole[1:]


def _told(kind: type[Table]) -> dict[str, str]:
    (declared,) = ast.parse(dedent(getsource(kind))).body
    assert isinstance(declared, ast.ClassDef)
    found = {}
    for before, node in zip(declared.body, declared.body[1:], strict=False):
        if not isinstance(before, ast.AnnAssign) or not isinstance(before.target, ast.Name):
            continue
        if (
            isinstance(node, ast.Expr)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, str)
        ):
            found[before.target.id] = " ".join(node.value.value.split())
    return found
