"""The keys of scene files as a list of tables, each with its keys, from their JSON schema."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any, NamedTuple

from ..reader import ARRAYS, TABLES
from .json_schema import Schema, key_schema


class Key(NamedTuple):
    """A key of a table; `table` is the place of the table that it holds, empty where it holds none."""

    name: str
    value: str
    unit: str
    default: str
    meaning: str
    table: str


class KeyTable(NamedTuple):
    """A table of scene files at its first place, such as `hinge_line.motor`; `array` where there can be several.

    example: TOML of its needed keys, or of its first key where none is needed; quantities are 1 in their SI unit.
    """

    place: str
    array: bool
    meaning: str
    keys: tuple[Key, ...]
    example: str = ""


def key_tables() -> list[KeyTable]:
    """All tables; one that stands at several places is told at the first of them."""
    schema = key_schema()
    listing = _Listing(schema["$defs"])
    top = {
        "extends": schema["properties"]["extends"],
        "variant": {"type": "object"} | schema["properties"]["variant"],
    }
    rows = tuple(Key(name, _kind(one), "", "", one["description"], "") for name, one in top.items())
    found = [KeyTable("", False, "A file may have these keys outside of its tables.", rows)]
    for name, kind in (*TABLES.items(), *ARRAYS.items()):
        found += listing.tables(name, {"$ref": f"#/$defs/{kind.__name__}"}, name in ARRAYS)
    return found


def tables_called(name: str) -> list[KeyTable]:
    """Tables at a place such as `hinge_line.latch`, or all whose last word it is, such as `latch`."""
    every = [table for table in key_tables() if table.place]
    at = [table for table in every if table.place == name]
    return at or [table for table in every if table.place.rpartition(".")[2] == name]


class _Listing:
    """Where each definition was told first."""

    def __init__(self, definitions: Mapping[str, Schema]) -> None:
        self._definitions = definitions
        self._places: dict[str, str] = {}
        self._arrays: set[str] = set()

    def tables(self, place: str, schema: Schema, array: bool) -> Iterator[KeyTable]:
        """The table at a place, then those within it that were not told before."""
        whole = self._whole(schema)
        inner: list[tuple[str, Schema, bool]] = []
        keys = []
        for name, one in whole["properties"].items():
            table, several = _table_in(one, self._definitions)
            at = ""
            if table is not None:
                at = self._places.get(str(table.get("$ref")), f"{place}.{name}")
                if at == f"{place}.{name}":
                    inner.append((at, {"description": one["description"]} | table, several))
                    if "$ref" in table:
                        self._places[table["$ref"]] = at
            needed = _default(name, one, whole)
            keys.append(Key(name, _kind(one), _unit(one), needed, one.get("description", ""), at))
        if array:
            self._arrays.add(place)
        example = _example(place, self._arrays, self._sample(whole))
        yield KeyTable(place, array, whole.get("description", ""), tuple(keys), example)
        for at, table, several in inner:
            yield from self.tables(at, table, several)

    def _sample(self, schema: Schema) -> dict[str, Any]:
        """Values of the needed keys of a table, or of its first key where none is needed."""
        needed = [
            name for name, one in schema["properties"].items() if _default(name, one, schema) == _NEEDED
        ]
        return {
            name: self._value(schema["properties"][name]) for name in needed or list(schema["properties"])[:1]
        }

    def _value(self, schema: Schema) -> Any:  # noqa: ANN401 - any value of a schema
        """A value that the schema accepts."""
        whole = self._whole(schema)
        kind = whole.get("type", "")
        if whole.get("default") not in (None, "") or "const" in whole or "enum" in whole:
            return whole.get("default", whole.get("const", whole.get("enum", [None])[0]))
        if "examples" in whole:
            return whole["examples"][0]
        if "anyOf" in whole:
            return self._value(whole["anyOf"][0])
        if "unit" in whole:
            return 1 if whole["unit"] == "1" else f"1 {whole['unit']}"
        if kind == "array":
            items = whole.get("items", whole.get("prefixItems", [{}])[0])
            return [self._value(items)] * whole.get("minItems", 1)
        if "properties" in whole:
            return self._sample(whole)
        if kind == "object":
            inner = whole.get("additionalProperties")
            return {"NAME": self._value(dict(inner))} if isinstance(inner, Mapping) and inner else {}
        return {"integer": max(1, whole.get("minimum", 1)), "number": 1, "boolean": True}.get(kind, "NAME")

    def _whole(self, schema: Schema) -> Schema:
        reference = schema.get("$ref", "")
        return self._definitions[reference.rpartition("/")[2]] if reference else schema


_NEEDED = "needed"


def _example(place: str, arrays: Collection[str], sample: Mapping[str, Any]) -> str:
    """A heading and the lines below it: the keys of a table at the top of a file, or an inner table as one line."""
    outer, _, name = place.rpartition(".")
    heading = outer or name
    keys = {name: [sample] if place in arrays else sample} if outer else sample
    lines = [f"[[{heading}]]" if heading in arrays else f"[{heading}]"]
    return "\n".join([*lines, *(f"{key} = {_text(value)}" for key, value in keys.items())])


def _default(name: str, schema: Schema, table: Schema) -> str:
    """Default of a key, or that it is needed, or what may stand in its place."""
    if instead := schema.get("instead"):
        return "or " + " or ".join(f"`{other}`" for other in instead)
    if name in (*table.get("required", ()), *table.get("needed", ())):
        return _NEEDED
    return _text(schema.get("default"))


def _table_in(schema: Schema, definitions: Mapping[str, Schema]) -> tuple[Schema | None, bool]:
    """The table that a key holds, None where it holds none, and whether it holds several."""
    inner = schema.get("additionalProperties")
    for one, several in ((schema, False), (schema.get("items"), True), (inner, True)):
        if not isinstance(one, Mapping):
            continue
        whole = definitions[one["$ref"].rpartition("/")[2]] if "$ref" in one else one
        if "properties" in whole:
            return dict(one), several
    return None, False


def _kind(schema: Schema) -> str:
    """What a value is, in words."""
    if "enum" in schema:
        return " or ".join(f"`{one}`" for one in schema["enum"])
    if "anyOf" in schema:
        return " or ".join(_kind(one) for one in schema["anyOf"])
    if "unit" in schema:
        sign = schema.get("sign", "any")
        return (
            ("number" if schema["unit"] == "1" else "quantity")
            + ("" if sign == "any" else f", {sign}")
            + _range(schema)
        )
    return _KINDS.get(str(schema.get("type")), _held)(schema)


def _held(schema: Schema) -> str:
    return "table" if "$ref" in schema or schema.get("type") == "object" else "any value"


def _list(schema: Schema) -> str:
    items = schema.get("items", schema.get("prefixItems", [{}])[0])
    count = schema.get("minItems")
    if "$ref" in items or items.get("type") == "object":
        return "tables"
    number = (
        "" if count is None else f" of {count}" if count == schema.get("maxItems") else f" of {count} or more"
    )
    return f"list{number}: {_kind(items)}"


def _named(schema: Schema) -> str:
    inner = schema.get("additionalProperties")
    if isinstance(inner, Mapping) and inner:
        return f"by name: {_kind(dict(inner))}"
    return "table"


_KINDS = {
    "string": lambda schema: "text",
    "boolean": lambda schema: "`true` or `false`",
    "integer": lambda schema: "whole number" + _range(schema),
    "number": lambda schema: "number" + _range(schema),
    "array": _list,
    "object": _named,
}


def _range(schema: Schema) -> str:
    low, high = (schema.get(end, schema.get(f"exclusive{end.title()}")) for end in ("minimum", "maximum"))
    if low is None:
        return "" if high is None else f", at most {high:g}"
    return f", from {low:g}" + ("" if high is None else f" to {high:g}")


def _unit(schema: Schema) -> str:
    """SI unit of a key, of whatever it holds."""
    for inner in (schema.get("items"), schema.get("additionalProperties"), *schema.get("prefixItems", ())):
        if isinstance(inner, Mapping):
            return _unit(dict(inner))
    unit = str(schema.get("unit", ""))
    return "" if unit == "1" else unit


def _text(default: Any) -> str:  # noqa: ANN401 - any value of a schema
    """A default as a scene writes it; empty where there is none."""
    if default is None or default in ([], {}, ""):
        return ""
    if isinstance(default, bool):
        return str(default).lower()
    if isinstance(default, list):
        return "[" + ", ".join(_text(one) for one in default) + "]"
    if isinstance(default, Mapping):
        return "{ " + ", ".join(f"{key} = {_text(value)}" for key, value in default.items()) + " }"
    return f'"{default}"' if isinstance(default, str) else f"{default:g}"
