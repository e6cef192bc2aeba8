"""The JSON schema of scene files, for editors and for the reference of keys.

Beside the words of JSON Schema, `unit` is the SI unit of a quantity, which may be written with another one as a text,
`sign` what it may be, `needed` what a table of a body needs where no entry has it, and `instead` what may stand there.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from typing import Any

from pydantic.json_schema import models_json_schema

from components import REGISTRY, Component, Quantity
from components.numerics.motion_law import PROFILES

from ..reader import ARRAYS, TABLES
from .meanings import all_tables, meanings, title

Schema = dict[str, Any]
_REFERENCE = "#/$defs/"
_CHANGE = "Change"
_COLUMNS = "Columns"
_TERM = "MotionTerm"
_BOUNDS = {"ge": "minimum", "le": "maximum", "gt": "exclusiveMinimum", "lt": "exclusiveMaximum"}
_NUMBERS = {"anyOf": [{"type": "number"}, {"type": "array", "items": {"type": "number"}}]}


def scene_schema() -> Schema:
    """JSON schema (draft 2020-12) of a scene file, where measured columns may stand for each quantity."""
    found: Schema = _with_columns(key_schema())
    lists = {"type": "array", "minItems": 2}
    found["$defs"][_COLUMNS] = {
        "type": "object",
        "description": "Values at temperatures, linear between them.",
        "properties": {"temperature": lists, "value": lists},
        "required": ["temperature", "value"],
        "additionalProperties": False,
    }
    return found


def _with_columns(schema: Any) -> Any:  # noqa: ANN401 - any part of a schema
    """A copy in which measured columns may stand for quantities, and for arrays of them."""
    if isinstance(schema, list):
        return [_with_columns(one) for one in schema]
    if not isinstance(schema, Mapping):
        return deepcopy(schema)
    if _is_quantity(schema) or _is_quantity(schema.get("items")):
        return {"anyOf": [deepcopy(schema), _reference(_COLUMNS)]}
    return {key: _with_columns(value) for key, value in schema.items()}


def _is_quantity(schema: Any) -> bool:  # noqa: ANN401 - any part of a schema
    return isinstance(schema, Mapping) and isinstance(unit := schema.get("unit"), str) and unit != "K"


def key_schema() -> Schema:
    """JSON schema of the keys of a scene file; what extends another and variants may leave keys out."""
    definitions = _definitions()
    loose = {f"{name}{_CHANGE}": _loosened(one) for name, one in definitions.items()}
    parts = _parts("")
    dropped = {"const": True, "description": "Drops the variant of that name that an extended scene has."}
    properties = {**_parts(_CHANGE), "remove": dropped}
    variant = {"type": "object", "properties": properties, "additionalProperties": False}
    root: Schema = {
        "extends": {
            "type": "string",
            "description": "Scene, or file next to this one, that this file is applied over.",
        },
        "variant": {
            "type": "object",
            "description": "By name, tables that a variant changes.",
            "additionalProperties": variant,
        },
    }
    free = dict.fromkeys((*TABLES, *ARRAYS), True)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Scene of Fanfold",
        "type": "object",
        "properties": {**root, **free},
        "additionalProperties": False,
        "if": {"required": ["extends"]},
        "then": {"properties": _parts(_CHANGE)},
        "else": {"properties": parts, "required": ["scene", "base"]},
        "$defs": {**definitions, **loose},
    }


def _parts(ending: str) -> Schema:
    """Schemas of the tables and arrays at the top of a file."""
    tables = {name: _reference(kind.__name__ + ending) for name, kind in TABLES.items()}
    arrays = {
        name: {"type": "array", "items": _reference(kind.__name__ + ending)} for name, kind in ARRAYS.items()
    }
    return {**tables, **arrays}


def _reference(name: str) -> Schema:
    return {"$ref": f"{_REFERENCE}{name}"}


def _definitions() -> dict[str, Schema]:
    """Every table by the name of its class."""
    kinds = (*TABLES.values(), *ARRAYS.values())
    _, found = models_json_schema([(kind, "validation") for kind in kinds])
    tables = all_tables()
    definitions: dict[str, Schema] = {}
    for name, schema in found["$defs"].items():
        kind = tables[name]
        told = meanings(kind)
        definitions[name] = _plain(schema) | {"description": title(kind)}
        for field, info in kind.model_fields.items():
            key = info.alias or field
            one = definitions[name]["properties"][key]
            definitions[name]["properties"][key] = one | {"description": told.get(field, "")}
    _add_components(definitions["Connection"])
    _add_terms(definitions)
    return definitions


def _plain(schema: Any) -> Any:  # noqa: ANN401 - any part of a schema
    """Without titles, and without null, which files cannot say."""
    if isinstance(schema, list):
        return [_plain(one) for one in schema]
    if not isinstance(schema, Mapping):
        return schema
    found = {}
    for key, value in schema.items():
        if key == "properties":
            found[key] = {name: _plain(one) for name, one in value.items()}
        elif key == "anyOf":
            given = [_plain(one) for one in value if one != {"type": "null"}]
            found |= given[0] if len(given) == 1 else {key: given}
        elif key in _BOUNDS:
            found[_BOUNDS[key]] = value
        elif key != "title" and not (key == "default" and value is None):
            found[key] = _plain(value)
    return found


def _add_components(connection: Schema) -> None:
    """What each kind declares; kinds of plugins have what they have."""
    connection["required"] = [key for key in connection["required"] if key != "kind"]
    connection["anyOf"] = [{"required": ["kind"]}, {"required": ["preset"]}]
    cases = []
    for kind, component in sorted(REGISTRY.items()):
        example = component.example()
        if example.ports[0].side == "connection" or component.ports_vary:
            given = {"properties": {"kind": {"const": kind}}, "required": ["kind"]}
            cases.append({"if": given, "then": {"properties": {"parameters": _parameters(example)}}})
    connection["allOf"] = cases


def _parameters(example: Component) -> Schema:
    quantities = example.parameter_layout.quantities
    return {
        "type": "object",
        "properties": {q.name: _quantity(q) for q in quantities},
        "additionalProperties": False,
    }


def _quantity(quantity: Quantity) -> Schema:
    one: Schema = {"type": ["number", "string"], "unit": quantity.unit}
    if quantity.minimum is not None:
        one["minimum"] = quantity.minimum
    if quantity.maximum is not None:
        one["maximum"] = quantity.maximum
    if quantity.size > 1:
        one = {"type": "array", "items": one}
    return one | {"description": f"{quantity.description}."}


def _add_terms(definitions: dict[str, Schema]) -> None:
    """Terms of motion laws by their profile."""
    terms = []
    for name, profile in PROFILES.items():
        keys = {"profile": {"const": name}} | dict.fromkeys((*profile.needs, *profile.may), _NUMBERS)
        terms.append(
            {
                "type": "object",
                "properties": keys,
                "required": ["profile", *profile.needs],
                "additionalProperties": False,
            }
        )
    definitions[_TERM] = {"description": "A term of a motion law.", "anyOf": terms}
    for name in ("translation", "rotation"):
        definitions["Motion"]["properties"][name]["items"] = _reference(_TERM)


def _loosened(schema: Any) -> Any:  # noqa: ANN401 - any part of a schema
    """A deep copy of changes: nothing is required, and named entries may be removed."""
    if isinstance(schema, list):
        return [_loosened(one) for one in schema]
    if not isinstance(schema, Mapping):
        return deepcopy(schema)
    found = {}
    for key, value in schema.items():
        if key == "$ref":
            found[key] = value + _CHANGE
        elif key == "properties":
            found[key] = {name: _loosened(one) for name, one in value.items()}
        elif key == "if" or (key == "required" and isinstance(value, list)):
            found |= {key: deepcopy(value)} if key == "if" else {}
        elif key not in ("anyOf",) or not _is_of_needs(value):
            found[key] = _loosened(value)
    if "name" in found.get("properties", {}):
        found["properties"]["remove"] = {"const": True, "description": "Takes the entry of that name away."}
    return found


def _is_of_needs(choices: Any) -> bool:  # noqa: ANN401 - any part of a schema
    """Whether a choice is between keys that are needed."""
    return all(set(one) == {"required"} for one in choices)
