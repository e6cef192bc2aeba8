"""Layers of a scene: a file, what it extends, its variants and single settings, merged into one tree of tables.

Tables merge key by key, arrays of named tables by name; an entry with `remove = true` takes the one of that name away,
and an empty array all of them; a motor's spring takes the place of its table, and a table that of a spring. Everything
else replaces what was there. A merge that cannot be is a SceneError. In the end, bodies that are `like` others are laid
over these.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from itertools import permutations
from pathlib import Path
from typing import Any, NamedTuple

from components.contract.regular import is_regular
from components.imported.files import NAMES

from .system_structure import scene_of
from .table import SceneError

Tree = dict[str, Any]
Setting = str | tuple[str, Any]
"""One value laid over a scene: "table.key=value" as on a command line, or key and value."""

_EXTENDS, _VARIANT, _REMOVE, _LIKE = "extends", "variant", "remove", "like"
_HDF5 = b"\x89HDF"
"""What files of results begin with."""
_MOTOR, _WAYS_OF_MOTORS = "motor", (("stowed", "deployed"), ("angle", "torque", "closing_torque"))
_OWN = ("name", "place", "velocity", "angular_velocity")
"""Keys that a body does not share with those that are like it."""


class _Names(NamedTuple):
    """Entries of arrays that layers have added, by key, and those that they have removed."""

    added: set[str]
    removed: dict[str, Tree]


@dataclass(frozen=True, slots=True)
class Layers:
    """A scene file over what it extends, and its variants; `added` are keys of entries that the file adds by name."""

    file: str
    tree: Tree
    variants: Mapping[str, Tree]
    added: frozenset[str]

    def over(self, variants: Sequence[str], settings: Sequence[Setting] = ()) -> tuple[Tree, frozenset[str]]:
        """A new tree with variants and settings laid over it in order, and the keys of added entries.

        SceneError where a variant does not exist or a layer cannot be merged.
        """
        unknown = [name for name in variants if name not in self.variants]
        if unknown:
            every = ", ".join(self.variants) or "none"
            raise SceneError(
                [f"{self.file}: there is no variant {name!r}; variants are {every}" for name in unknown]
            )
        tree, names = deepcopy(self.tree), _Names(set(self.added), {})
        for name in variants:
            _lay_over(f"{self.file}: variant.{name}.", tree, self.variants[name], names)
        for setting in settings:
            _lay_over(f"{self.file}: ", tree, _setting(self.file, setting, tree), names)
        return tree, frozenset(names.added)


def read_layers(path: Path, find: Callable[[str], Path]) -> Layers:
    """The layers of a scene file; find: the file that a name after `extends` means.

    A variant with `remove = true` is one of an extended scene that this one does not have. SceneError where a layer is
    missing or cannot be read.
    """
    names = _Names(set(), {})
    tree = _with_extended(path, find, (), names)
    known = tree.pop(_VARIANT, {})
    if not isinstance(known, dict) or not all(isinstance(layer, dict) for layer in known.values()):
        raise SceneError([f"{path.name}: variant: give a table [variant.NAME] for each variant"])
    variants = {name: layer for name, layer in known.items() if layer.get(_REMOVE) is not True}
    return Layers(path.name, tree, variants, frozenset(names.added))


def _lay_over(place: str, tree: Tree, above: Tree, names: _Names) -> None:
    """A merge whose problems say where the layer is from."""
    try:
        _lay(tree, above, names)
    except SceneError as error:
        raise SceneError([place + problem for problem in error.problems]) from None


def _with_extended(path: Path, find: Callable[[str], Path], within: tuple[Path, ...], names: _Names) -> Tree:
    """The tree of a file merged over the one that it extends."""
    place = path.resolve()  # one file has many relative paths
    if place in within:
        raise SceneError(
            [f"{path.name}: extends: {' -> '.join(p.name for p in (*within, place))} is a circle"]
        )
    tree = _read(path)
    if _EXTENDS not in tree:
        return tree
    name = tree.pop(_EXTENDS)
    if not isinstance(name, str):
        raise SceneError([f"{path.name}: extends: is {name!r}; give the name of a scene or a file"])
    beside = path.parent / name
    below = beside if is_regular(beside) else find(name)
    under = _with_extended(below, find, (*within, place), names)
    _lay_over(f"{path.name}: ", under, tree, names)
    return under


def _read(path: Path) -> Tree:
    try:
        text = scene_of(path) if path.suffix == ".ssp" else path.read_text(encoding="utf-8-sig")
        return with_absolute_files(tomllib.loads(text), path.parent)
    except UnicodeDecodeError as error:
        if error.object.startswith(_HDF5):
            raise SceneError(
                [
                    f"{path.name}: is a result, not a scene; use `fanfold plot`, `report` or `resume`, in Python "
                    "`fanfold.load`"
                ]
            ) from None
        raise SceneError(
            [f"{path.name}: is not a text file in UTF-8: {error.reason} at byte {error.start}"]
        ) from None
    except RecursionError:
        raise SceneError([f"{path.name}: its values are nested too deeply to be those of a scene"]) from None
    except tomllib.TOMLDecodeError as error:
        raise SceneError([f"{path.name}: {error}{_bare_text(text, str(error))}"]) from None
    except (OSError, ValueError) as error:
        raise SceneError([f"{path.name}: {error}"]) from None


def _bare_text(text: str, problem: str) -> str:
    """What to add to a problem of TOML in a line whose value is a text without quotes; empty for others."""
    place = re.search(r"\(at line (\d+)", problem)
    line = text.splitlines()[int(place[1]) - 1] if place else ""
    found = re.search(r"=\s*([A-Za-z_][^\"'=#,\]}]*?)\s*(?:#.*)?$", line)
    return f'; a text stands in quotes: {line[: found.start(1)].strip()} "{found[1]}"' if found else ""


def with_absolute_files(tree: Tree, folder: Path) -> Tree:
    """The tree of a scene file in a folder, variants included, with absolute paths of what it is made of besides."""
    for table, key in _places_of_files(tree):
        table[key] = str((folder / table[key]).resolve())
    return tree


def files_besides(tree: Tree) -> list[str]:
    """Paths of the files that a scene is made of besides its own, in order."""
    return list(dict.fromkeys(table[key] for table, key in _places_of_files(tree)))


def plugin_files(tree: Tree) -> list[str]:
    """Those of its plugins."""
    return list(dict.fromkeys(table[key] for table, key in _places_of_files(tree) if isinstance(table, list)))


def data_files(tree: Tree) -> list[str]:
    """Those that are read and not run in this process: tables of bodies, finite elements, FMUs of other tools."""
    return [file for file in files_besides(tree) if not file.endswith(".py")]


def _places_of_files(tree: Tree) -> Iterator[tuple[Any, Any]]:
    """Tables and lists, and where in them a text names a file."""
    variants = tree.get("variant")
    for layer in (tree, *(variants.values() if isinstance(variants, dict) else ())):
        for body in _entries(layer, "body"):
            yield from _named_by(body.get("import") if isinstance(body, dict) else None, NAMES)
        for fmu in _entries(layer, "fmu"):
            yield from _named_by(fmu, ("file",))
        plugins = _entries(layer.get("scene") if isinstance(layer, dict) else None, "plugins")
        yield from ((plugins, k) for k, plugin in enumerate(plugins) if isinstance(plugin, str))


def _entries(table: Any, key: str) -> list[Any]:  # noqa: ANN401 - whatever a TOML file gives
    found = table.get(key) if isinstance(table, dict) else None
    return found if isinstance(found, list) else []


def _named_by(table: Any, keys: Iterable[str]) -> Iterator[tuple[Any, Any]]:  # noqa: ANN401 - whatever a TOML file gives
    for key in keys if isinstance(table, dict) else ():
        if isinstance(table.get(key), str) and table[key]:
            yield table, key


def merged(below: Tree, above: Tree) -> Tree:
    """A new tree: `above` laid over `below`."""
    tree = deepcopy(below)
    _lay(tree, above, _Names(set(), {}))
    return tree


def _lay(tree: Tree, above: Tree, names: _Names, within: str = "") -> None:
    """Lay `above` over a tree in place; names: takes up entries that `above` adds to arrays or removes."""
    for key in _replaced(within, above):
        tree.pop(key, None)
    for key, value in above.items():
        old, place = tree.get(key), f"{within}{key}"
        if isinstance(old, dict) and isinstance(value, dict):
            _lay(old, value, names, f"{place}.")
        elif value and _is_named(old) and _is_named(value):
            tree[key] = _merged_entries(place, old, value, names)
        else:
            tree[key] = deepcopy(value)


def _replaced(within: str, above: Tree) -> Iterator[str]:
    """Keys of a table that say otherwise what a layer over it says: a motor is a spring or a table."""
    if not within.endswith(f".{_MOTOR}."):
        return
    for one, other in permutations(_WAYS_OF_MOTORS):
        if any(key in above for key in one):
            yield from other


def _is_named(value: object) -> bool:
    """Whether a value is an array of tables that have names."""
    return isinstance(value, list) and all(
        isinstance(entry, dict) and isinstance(entry.get("name"), str) for entry in value
    )


def _merged_entries(key: str, below: Any, above: Any, names: _Names) -> list[Tree]:  # noqa: ANN401 - both are arrays of tables
    entries = {entry["name"]: entry for entry in below}
    if len(entries) < len(below):  # the later would hide the earlier, and nobody could say so any more
        raise SceneError([f"{key}: two entries have the same name, so a layer cannot tell which it is about"])
    laid = [entry["name"] for entry in above if entry.get(_REMOVE) is not True]
    if twice := sorted({name for name in laid if laid.count(name) > 1}):
        raise SceneError([f"{key}: a layer has two entries of the name {twice[0]!r}; rename one"])
    before = dict(names.removed)  # a layer may remove an entry and write it again
    for entry in above:
        name = entry["name"]
        if entry.get(_REMOVE) is not True:
            if name not in entries:
                place = f"{key}.{name}"
                if entry.keys() < before.get(place, {}).keys():  # a whole new entry has as many keys
                    raise SceneError(
                        [f"{place}: an earlier variant removed it; these variants do not combine"]
                    )
                names.added.add(place)
            _lay(entries.setdefault(name, {}), entry, names, f"{key}.{name}.")
        elif name in entries:
            names.removed[f"{key}.{name}"] = entries.pop(name)
        else:
            known = ", ".join(entries) or "none"
            raise SceneError([f"{key}.{name}: there is no such entry to remove; entries are {known}"])
    return list(entries.values())


def _setting(file: str, setting: Setting, tree: Tree) -> Tree:
    """A layer that holds one value: body.panel.fixed_interface_modes=5."""
    text = setting if isinstance(setting, str) else "{}={}".format(*setting)
    key, equals, right = text.partition("=")
    steps = [step.strip() for step in key.split(".")]
    if not equals or not all(steps):
        raise SceneError([f"{file}: the setting {text!r} is not of the form table.key=value"])
    value = _value(right) if isinstance(setting, str) else setting[1]
    return _nested(file, text, steps, value, tree)


def _value(text: str) -> Any:  # noqa: ANN401 - whatever TOML knows
    """What a text is in TOML; itself where it is none, such as 90 deg."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text.strip()


def _nested(file: str, setting: str, steps: Sequence[str], value: object, tree: object) -> Tree:
    """The value under its steps; a step into an array of tables is the name of an entry."""
    step, rest = steps[0], steps[1:]
    if not rest:
        return {step: value}
    inner = tree.get(step) if isinstance(tree, dict) else None
    if not (isinstance(inner, list) and inner and _is_named(inner)):
        return {step: _nested(file, setting, rest, value, inner)}
    entry = next((entry for entry in inner if entry["name"] == rest[0]), None)
    if entry is None or len(rest) == 1:
        known = ", ".join(str(entry["name"]) for entry in inner)
        raise SceneError([f"{file}: the setting {setting!r} needs a key of one of {step}: {known}"])
    return {step: [{"name": rest[0], **_nested(file, setting, rest[1:], value, entry)}]}


def resolved(tree: Tree) -> tuple[Tree, dict[str, list[str]]]:
    """The tree with every `like` of a body carried out, and what is wrong with those that cannot be, by body."""
    entries = tree.get("body")
    if not isinstance(entries, list) or not any(isinstance(e, dict) and _LIKE in e for e in entries):
        return tree, {}
    known = {e["name"]: e for e in entries if isinstance(e, dict) and isinstance(e.get("name"), str)}
    problems: dict[str, list[str]] = {}
    bodies = [
        _whole(entry, known, problems.setdefault(entry["name"], [])) if entry in known.values() else entry
        for entry in entries
    ]
    return {**tree, "body": bodies}, {name: found for name, found in problems.items() if found}


def _whole(entry: Tree, known: Mapping[str, Tree], problems: list[str]) -> Tree:
    """A body over what it is like, over what that is like; without them where there is a problem."""
    lineage = [entry]
    while (other := lineage[-1].get(_LIKE)) is not None:
        key = f"body.{lineage[-1]['name']}.{_LIKE}"
        if not isinstance(other, str) or other not in known:
            problems.append(f"{key}: there is no body {other!r}; bodies are {', '.join(known)}")
            break
        if known[other] in lineage:
            told = " -> ".join([*(one["name"] for one in lineage), other])
            problems.append(f"{key}: {told} is a circle")
            break
        lineage.append(known[other])
    whole: Tree = {}
    try:
        for one in reversed(lineage):
            below = {key: value for key, value in whole.items() if key not in _OWN}
            whole = merged(below, {key: value for key, value in one.items() if key != _LIKE})
    except SceneError as error:
        problems += [f"body.{entry['name']}.{problem}" for problem in error.problems]
    return whole
