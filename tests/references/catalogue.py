"""Bodies from their tables, and entries of the catalogue."""

from __future__ import annotations

from collections.abc import Mapping

from components.catalogue import BodyDefinition
from orchestrator.scene import SceneError
from orchestrator.scene.bodies import body_definition
from orchestrator.scene.body_tables import Body
from orchestrator.scene.data_sheets import entries, entry_table, with_entries
from orchestrator.scene.validation import EntryReader

__all__ = ["body", "built", "entries", "entry", "entry_table"]


def body(tables: Mapping[str, object]) -> Body:
    """The body that a scene has by these tables; SceneError with everything that is wrong with them."""
    tree, unmerged = with_entries({"body": [{"name": "b", **tables}]})
    reader = EntryReader(tree, ())
    found = reader.tables("body", Body).sound
    if problems := unmerged.get("b", reader.problems):
        raise SceneError([problem.removeprefix("body.b").removeprefix(".") for problem in problems])
    return found[0]


def built(tables: Mapping[str, object]) -> BodyDefinition:
    """How it is built; SceneError or BodyError with everything that is wrong with it."""
    return body_definition(body(tables))


def entry(name: str) -> BodyDefinition:
    """An entry of the catalogue."""
    return built({"catalogue": name})
