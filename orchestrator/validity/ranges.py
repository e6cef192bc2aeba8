"""Values outside the plausible range that their table declares."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields

from ..scene.plausible import Plausible
from ..scene.reader import ARRAYS, TABLES
from ..scene.schema import SceneTables
from ..scene.table import Table

_KEYS = {model: key for key, model in {**TABLES, **ARRAYS}.items()}


def range_warnings(scene: SceneTables) -> Iterator[str]:
    """A message for each value outside its range."""
    for field in fields(SceneTables):
        value = getattr(scene, field.name)
        for table in value if isinstance(value, tuple) else (value,):
            if type(table) in _KEYS:
                yield from _of(_key(_KEYS[type(table)], table), table)


def _of(key: str, value: object) -> Iterator[str]:
    """Messages about a value at a key that is a table or a tuple of tables."""
    if isinstance(value, tuple):
        for entry in value:
            yield from _of(_key(key, entry), entry)
    elif isinstance(value, Table):
        for name, field in type(value).model_fields.items():
            inner = getattr(value, name)
            yield from _of(f"{key}.{name}", inner)
            for plausible in field.metadata:
                if isinstance(plausible, Plausible) and inner is not None:
                    yield from plausible.warnings(f"{key}.{name}:", inner)


def _key(key: str, table: object) -> str:
    """Key of a table, by its name where it has one."""
    name = getattr(table, "name", None)
    return key if name is None else f"{key}.{name}"
