"""Tables of a scene's tree, each validated on its own: what is sound, what is partly so, and every problem."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import Annotated, Any, Generic, NamedTuple, TypeVar, get_args

from pydantic import TypeAdapter, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from components.contract.errors import unknown

from .layers import Tree
from .table import Table

T = TypeVar("T", bound=Table)
_MISSING = "is missing"
_OF_NAME = "[key]"
"""Last step of pydantic's location of a name in a mapping."""
_KINDS = {
    "model_type": "a table",
    "dict_type": "a table",
    "bool_type": "true or false",
    "string_type": "a text",
    "int_type": "a whole number",
}
_BOUNDS = {"le": "at most", "ge": "at least", "lt": "less than", "gt": "more than"}


class Entries(NamedTuple, Generic[T]):
    """Entries of an array of tables in the order of the file.

    sound: those without problems. all: those, and of the others the fields that are sound. names: of every entry
    that has one. total: number of entries in the file.
    """

    sound: tuple[T, ...]
    all: tuple[T, ...]
    names: tuple[str, ...]
    total: int

    def saying(self, *fields: str) -> tuple[T, ...]:
        """Entries, sound or not, that give their name and these fields."""
        return tuple(e for e in self.all if all(hasattr(e, field) for field in ("name", *fields)))


class EntryReader:
    """Validates tables of a tree and gathers their problems.

    added: keys of entries that a layer added; one that cannot stand alone was meant to change another.
    """

    def __init__(self, tree: Tree, added: Collection[str]) -> None:
        self.tree = tree
        self.problems: list[str] = []
        self._added = set(added)

    def note(self, problems: Iterable[str]) -> bool:
        """Add problems; whether there were any."""
        found = list(problems)
        self.problems += found
        return bool(found)

    def table(self, key: str, model: type[T], required: bool) -> T | None:
        """A table, or None where it has problems."""
        if required and key not in self.tree:
            self.problems.append(f"{key}: {_MISSING}")
            return None
        return self._validated(model, self.tree.get(key, {}), key)

    def entries(self, key: str) -> list[Tree]:
        """The entries of an array of tables as they were read."""
        entries = self.tree.get(key, [])
        return [entry for entry in entries if isinstance(entry, dict)] if isinstance(entries, list) else []

    def tables(self, key: str, model: type[T]) -> Entries[T]:
        """The entries of an array of tables."""
        entries = self.tree.get(key, [])
        if not isinstance(entries, list):
            self.problems.append(f"{key}: is one table; write it as [[{key}]], because there can be several")
            return Entries((), (), (), 1)
        found: list[tuple[T, bool]] = []
        for i, raw in enumerate(entries):
            if (table := self._validated(model, raw, _entry(key, raw, i))) is not None:
                found.append((table, True))
            elif isinstance(raw, dict):
                found.append((_sound_part(model, raw), False))
        return Entries(
            sound=tuple(table for table, is_sound in found if is_sound),
            all=tuple(table for table, _ in found),
            names=tuple(e["name"] for e in self.entries(key) if isinstance(e.get("name"), str)),
            total=len(entries),
        )

    def _validated(self, model: type[T], raw: object, key: str) -> T | None:
        try:
            return model.model_validate(raw)
        except ValidationError as error:
            found = [(_key(key, raw, e["loc"]), _sentence(e, model)) for e in error.errors()]
        for entry in sorted(self._added):
            lacks = [(at, sentence) for at, sentence in found if _is_lack(entry, at, sentence)]
            if lacks:
                found = [one for one in found if one not in lacks]
                missing = ", ".join(at.rpartition(".")[2] for at, sentence in lacks if sentence == _MISSING)
                needs = f"a new one needs {missing}" if missing else f"for a new one, {lacks[0][1]}"
                self.problems.append(f"{entry}: {self._nothing_to_change(entry)}; {needs}")
        self.problems += [f"{at}: {sentence}" for at, sentence in found]
        return None

    def _nothing_to_change(self, entry: str) -> str:
        """What a layer's entry that cannot stand alone lacks most likely: the right name of another."""
        array, name, listed = self._array_of(entry)
        known = [e["name"] for e in listed if f"{array}.{e['name']}" not in self._added]
        kind = array.rpartition(".")[2].removesuffix("s")  # hinges of a line
        return f"there is no {kind} {name!r} to change; those are {', '.join(known) or 'none'}"

    def _array_of(self, entry: str) -> tuple[str, str, list[Tree]]:
        """Key of the array of an entry, the name of the entry, and the array; names may have dots by mistake."""
        place, inside, rest = "", self.tree, entry
        while True:
            key = next(key for key in inside if rest.startswith(f"{key}."))
            place, listed, rest = f"{place}{key}", inside[key], rest[len(key) + 1 :]
            if isinstance(listed, list):
                here = next(e for e in listed if rest == e["name"] or rest.startswith(f"{e['name']}."))
                if rest == here["name"]:
                    return place, rest, listed
                inside, place, rest = here, f"{place}.{here['name']}.", rest[len(here["name"]) + 1 :]
            else:
                inside, place = listed, f"{place}."


def _is_lack(entry: str, at: str, sentence: str) -> bool:
    """Whether a problem at a key says that an entry is incomplete."""
    return at == entry or (sentence == _MISSING and at.rpartition(".")[0] == entry)


def _sound_part(model: type[T], raw: Tree) -> T:
    """The fields that are sound, each on its own; those that are not are absent, unless they have a default."""
    sound: dict[str, Any] = {}
    for name, field in model.model_fields.items():
        adapter: TypeAdapter[Any] = TypeAdapter(_annotation(field))
        try:
            if name in raw:
                sound[name] = adapter.validate_python(raw[name])
        except ValidationError:
            continue
    return model.model_construct(**sound)


def _annotation(field: FieldInfo) -> Any:  # noqa: ANN401 - a type
    """The type of a field with what was said about it."""
    kind: Any = field.annotation
    for said in field.metadata:
        kind = Annotated[kind, said]
    return kind


def _entry(key: str, raw: object, position: int) -> str:
    """Key of an entry of an array: by its name if it has one."""
    name = raw.get("name") if isinstance(raw, dict) else None
    return f"{key}.{name}" if isinstance(name, str) else f"{key}[{position + 1}]"


def _key(key: str, raw: object, location: tuple[int | str, ...]) -> str:
    """Dotted key of a place inside a table."""
    for step in location:
        if step == _OF_NAME:
            continue
        if isinstance(step, int):
            raw = raw[step] if isinstance(raw, list) and step < len(raw) else None
            key = _entry(key, raw, step)
        else:
            raw = raw.get(step) if isinstance(raw, dict) else None
            key = f"{key}.{step}"
    return key


def keys_of(model: type[Table], location: Sequence[int | str]) -> list[str]:
    """Keys of the table at a place inside a table."""
    kind: Any = model
    for step in location:  # positions, and names in mappings, stay within a type
        fields = (
            field
            for table in _models(kind)
            for name, field in table.model_fields.items()
            if step == (field.alias or name)
        )
        kind = next((field.annotation for field in fields), kind)
    return [field.alias or name for table in _models(kind) for name, field in table.model_fields.items()]


def _models(kind: Any) -> Iterator[type[Table]]:  # noqa: ANN401 - a type
    """Tables within a type such as tuple[Hinge, ...] or Latch | None."""
    if isinstance(kind, type) and not get_args(kind) and issubclass(kind, Table):
        yield kind
    for part in get_args(kind):
        yield from _models(part)


def _sentence(error: ErrorDetails, model: type[Table]) -> str:
    """What a validation error means to the author of the file."""
    context, given, kind = error.get("ctx", {}), f"is {error['input']!r}", error["type"]
    if kind == "missing":
        return _MISSING
    if kind == "extra_forbidden":
        key, *within = reversed(error["loc"])
        removed = None if within else model.removed.get(str(key))
        return removed or unknown(str(key), keys_of(model, error["loc"][:-1]))
    if kind == "value_error":
        return str(context["error"])
    if kind in _KINDS:
        return f"{given}; it must be {_KINDS[kind]}"
    if kind == "tuple_type" and (keys := keys_of(model, error["loc"])):
        return f"{given}; it must be an array of tables, [{{ ... }}, {{ ... }}], with keys {', '.join(keys)}"
    if kind == "tuple_type":
        return f"{given}; it must be a list, [ ... ]"
    if kind == "literal_error":
        return f"{given}; it must be {context['expected']}"
    for bound in _BOUNDS.keys() & context.keys():
        return f"{given}; it must be {_BOUNDS[bound]} {context[bound]:g}"
    return f"{given}; {error['msg'][0].lower()}{error['msg'][1:]}"
