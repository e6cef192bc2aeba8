"""A scene file, with its layers, as a checked scene."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path

from components import ComponentError
from components.contract.errors import nearest, shortened, unknown
from components.contract.frames import Vector3
from components.contract.regular import is_regular
from components.end_stop import OF_HINGE

from . import consistency
from .arrays import Array, expanded
from .bodies import attachments, body_points
from .body_tables import Base, Body
from .component_connections import connection_problems
from .connection_tables import Ccl, Connection, Damper
from .damping import StructuralDamping
from .data_sheets import with_entries
from .event_tables import Event
from .hinge_line_tables import Friction, HingeLine, Joint
from .joint_presets import with_presets
from .layers import Layers, Setting, Tree, data_files, plugin_files, read_layers, resolved
from .loops.initial_assembly import open_loops
from .placed_scene import PlacedScene
from .plugins import loading
from .plugins.trials import plugin_problems
from .requirement_tables import Requirements
from .schema import Header
from .signal_tables import Fmu
from .table import SceneError, Table
from .temperature import at_temperature
from .validation import Entries, EntryReader

_STRUCTURAL, _LIMITS = "structural_damping", "requirements"
TABLES: Mapping[str, type[Table]] = {
    "scene": Header,
    "base": Base,
    "joint": Joint,
    "friction": Friction,
    _STRUCTURAL: StructuralDamping,
    _LIMITS: Requirements,
}
"""Tables of a scene file by name."""
ARRAYS: Mapping[str, type[Table]] = {
    "body": Body,
    "hinge_line": HingeLine,
    "ccl": Ccl,
    "damper": Damper,
    "connection": Connection,
    "event": Event,
    "fmu": Fmu,
    "array": Array,
}
"""Arrays of tables of a scene file by name."""
_ANY_HEADER = Header(name="any", until=1.0)


def _scene_folder() -> Path:
    return Path(str(files(__package__))) / "scenes"


def list_scenes() -> tuple[str, ...]:
    """Names of the scenes that come with Fanfold."""
    return tuple(sorted(path.stem for path in _scene_folder().glob("*.toml")))


def find_scene(name_or_path: str) -> Path:
    """The file of a named scene or at a path; SceneError if there is neither."""
    for path in (_scene_folder() / f"{name_or_path}.toml", Path(name_or_path)):
        if is_regular(path):
            return path
    known, file = ", ".join(list_scenes()), f"{name_or_path}.toml"
    meant = f"; did you mean {file}" if is_regular(Path(file)) else ""
    raise SceneError(
        [f"there is no scene and no file {shortened(repr(name_or_path))}{meant}; scenes are {known}"]
    )


def load_scene(path: Path, variants: Sequence[str] = (), settings: Sequence[Setting] = ()) -> PlacedScene:
    """Read and check a scene file with variants and settings; SceneError with everything that is wrong with it."""
    return check_layers(read_layers(path, find_scene), variants, settings)


def check_layers(
    layers: Layers,
    variants: Sequence[str] = (),
    settings: Sequence[Setting] = (),
    accepted: Collection[str] = (),
    of_result: bool = False,
) -> PlacedScene:
    """The scene of layers with variants and settings; SceneError with everything that is wrong with them.

    Variants that are not chosen are looked at where something is wrong, and by `variant_problems`. accepted: paths of
    plugins that may run whatever is in them. of_result: whether a result names its files, of which none is loaded.
    """
    tree, added = layers.over(variants, settings)
    plugins = _loadable(layers.file, tree, accepted, of_result)
    scene, problems = _checked(layers.file, tree, added, plugins)
    sentences: list[str] = []
    if problems:
        own = _own_problems(layers, problems if not (variants or settings) else None, accepted)
        told = {problem for name in variants for problem in own[name]}
        sentences += [problem for problem in problems if problem not in told]
        sentences += [f"variant.{name}.{problem}" for name, found in own.items() for problem in found]
    if scene is not None:
        known = ", ".join(layers.variants) or "none"
        sentences += [
            f"scene.phases: there is no variant {phase!r}; variants are {known}"
            for phase in scene.header.phases
            if phase not in layers.variants
        ]
    if scene is None or sentences:
        raise SceneError([f"{layers.file}: {sentence}" for sentence in sentences])
    return scene


def _loadable(file: str, tree: Tree, accepted: Collection[str], of_result: bool) -> list[str]:
    """Plugins to load; SceneError before anything is loaded or opened that may not be."""
    plugins, data = plugin_files(tree), data_files(tree)
    found = (
        loading.refusal_of_result(plugins, data) if of_result else loading.refusal(plugins, data, accepted)
    )
    if sentences := [f"{file}: {sentence}" for sentence in found]:
        raise SceneError(sentences)
    named = [plugin for plugin in plugins if plugin in data] if of_result else plugins
    return list(dict.fromkeys([*accepted, *named]))


def variant_problems(layers: Layers, accepted: Collection[str] = ()) -> list[str]:
    """What is wrong with every variant when it alone is laid over what is below, as sentences."""
    own = _own_problems(layers, accepted=accepted)
    return [f"{layers.file}: variant.{name}.{problem}" for name, found in own.items() for problem in found]


def _own_problems(
    layers: Layers, below: Sequence[str] | None = None, accepted: Collection[str] = ()
) -> dict[str, list[str]]:
    """What is wrong with a file under each of its variants and is not `below` them."""
    if below is None and layers.variants:
        below = _problems_of(layers, (), accepted)
    return {
        name: [p for p in _problems_of(layers, (name,), accepted) if p not in (below or ())]
        for name in layers.variants
    }


def _problems_of(layers: Layers, variants: Sequence[str], accepted: Collection[str]) -> list[str]:
    """What is wrong with a file under a variant alone, or under none."""
    try:
        tree, added = layers.over(variants)
        plugins = _loadable(layers.file, tree, accepted, of_result=False)
        return _checked(layers.file, tree, added, plugins)[1]
    except SceneError as error:
        places = [f"{layers.file}: variant.{name}." for name in variants]
        problems = error.problems
        for place in (*places, f"{layers.file}: "):
            problems = [problem.removeprefix(place) for problem in problems]
        return problems


def scene_variants(path: Path) -> tuple[str, ...]:
    """Names of the variants of a scene file."""
    return tuple(read_layers(path, find_scene).variants)


def read_scene(file: str, tree: Tree, of_result: bool = False) -> PlacedScene:
    """Check a tree of tables; SceneError with everything that is wrong with it.

    of_result: whether a result holds it, whose plugins are not loaded; see `plugins.loading.refusal_of_result`.
    """
    if not isinstance(tree, dict):
        raise SceneError([f"{file}: is no table of tables; it is damaged"])
    scene, problems = _checked(file, tree, plugins=_loadable(file, tree, (), of_result))
    if scene is None:
        raise SceneError([f"{file}: {problem}" for problem in problems])
    return scene


def whole_tree(tree: Tree) -> Tree:
    """The tree of a scene with values at its temperature, arrays written out and `like` entries completed."""
    return resolved(expanded(at_temperature(tree)[0])[0])[0]


def _checked(
    file: str, tree: Tree, added: Collection[str] = (), plugins: Collection[str] = ()
) -> tuple[PlacedScene | None, list[str]]:
    """The scene of a tree with these plugins loaded, None where it has problems, and these."""
    known = sorted({*TABLES, *ARRAYS})
    mistyped = [key for key in tree if key not in known]
    tree = _as_meant(tree, mistyped, known)
    measured, unmeasured = at_temperature(tree)
    repeated, wrong_arrays = expanded(measured)
    whole, unlike = resolved(repeated)
    unloaded = list(loading.problems(plugins))
    whole, unmerged = with_entries(with_presets(whole))
    unlike |= unmerged
    reader = EntryReader(whole, added)
    reader.note([*unloaded, *unmeasured])
    reader.note([*wrong_arrays, *(problem for found in unlike.values() for problem in found)])
    reader.note(f"{key}: {unknown(key, known, 'table')}" for key in mistyped)
    header, base = reader.table("scene", Header, required=True), reader.table("base", Base, required=True)
    joint, friction = (
        reader.table("joint", Joint, required=False),
        reader.table("friction", Friction, required=False),
    )
    structural = reader.table(_STRUCTURAL, StructuralDamping, required=True) if _STRUCTURAL in tree else None
    limits = reader.table(_LIMITS, Requirements, required=True) if _LIMITS in tree else None
    bodies, lines = reader.tables("body", Body), reader.tables("hinge_line", HingeLine)
    loops, dampers = reader.tables("ccl", Ccl), reader.tables("damper", Damper)
    connections, events = reader.tables("connection", Connection), reader.tables("event", Event)
    fmus = reader.tables("fmu", Fmu)
    placed = _References(reader, base, bodies, lines, loops, dampers, connections, events, fmus).check()
    refused = {c.name for c in connections.saying("kind") if reader.note(connection_problems(c))}
    if base is None or not placed:
        return None, _told(reader.problems, unlike)
    # where bodies stand and touch can be told whatever else is wrong
    scene = PlacedScene(
        file, tree, header or _ANY_HEADER, base, joint or Joint(), structural, friction or Friction(),
        bodies.sound, lines.sound, loops.sound, dampers.sound, connections.sound, events.sound, fmus.sound,
        limits.limits if limits else (),
    )  # fmt: skip
    joints = tuple(c for c in connections.sound if c.name not in refused)
    sound = replace(scene, connections=joints) if refused else scene
    reader.note(consistency.carried_along(scene))
    reader.note(consistency.impossible_loops(sound))
    if not reader.note([*consistency.open_hinges(sound), *open_loops(sound.closed)]):
        reader.note(sound.start_rates.problems)
        reader.note(consistency.without_direction(sound))
        reader.note(consistency.buried_contacts(sound))
        reader.note(plugin_problems(sound))
    return None if reader.problems else scene, _told(reader.problems, unlike)


def _as_meant(tree: Tree, mistyped: Sequence[str], known: Sequence[str]) -> Tree:
    """The tree with mistyped tables under the names that are nearest, so that nothing is missing because of them."""
    meant = {key: near for key in mistyped if (near := nearest(key, known)) and near not in tree}
    return {meant.get(key, key): value for key, value in tree.items()}


def _told(problems: Sequence[str], unlike: Mapping[str, Sequence[str]]) -> list[str]:
    """Problems without those of bodies that are like no other, which lack what they would have had from it."""
    lacking = tuple(f"body.{name}{end}" for name in unlike for end in ".:")
    own = {problem for found in unlike.values() for problem in found}
    return [problem for problem in problems if problem in own or not problem.startswith(lacking)]


@dataclass(frozen=True, slots=True)
class _References:
    """What the tables of a scene say about each other, as far as they say enough."""

    reader: EntryReader
    base: Base | None
    bodies: Entries[Body]
    lines: Entries[HingeLine]
    loops: Entries[Ccl]
    dampers: Entries[Damper]
    connections: Entries[Connection]
    events: Entries[Event]
    fmus: Entries[Fmu]

    def check(self) -> bool:
        """Note all problems; whether the start poses of all bodies can be told."""
        note, lines = self.reader.note, self.lines.saying("inboard", "outboard", "hinges")
        components = list(self._named())
        events = [(f"event.{name}", name) for name in self.events.names]
        fmus = [(f"fmu.{name}", name) for name in self.fmus.names]
        note(consistency.repeated_names([*components, *events, *fmus]))
        known = [name for _, name in components]
        note(consistency.unknown_components(self.events.sound, known, self.fmus.names))
        points = self._points()
        note(consistency.unknown_hinges(self.dampers.saying("hinge"), self._hinges()))
        if self.base is None:
            return False
        joined = [line for line in lines if line.inboard in points and line.outboard in points]
        loops, connections = self.loops.saying("pulley_1", "pulley_2"), self.connections.saying("ports")
        found = list(attachments(joined, loops, (), connections))  # dampers sit where hinges do
        placed = [body.name for body in self.bodies.sound if body.place is not None]
        lost = [
            note(consistency.unknown_bodies(lines, points)),
            note(consistency.unknown_places(found, points)),
            note(consistency.misplaced(self.bodies.sound, points)),
            note(consistency.repeated_ports(found)),
            note(consistency.misdirected(self.base.name, joined, placed)),
        ]
        if len(joined) < self.lines.total or lost[-1]:
            return False  # of a broken tree nobody can say what hangs on it
        carried = [body.name for body in self.bodies.sound if body.place is None]
        lost.append(note(consistency.disconnected(self.base.name, carried, joined)))
        all_sound = len(self.lines.sound) == self.lines.total and None not in points.values()
        return all_sound and not any(lost)

    def _named(self) -> Iterator[tuple[str, str]]:
        """Keys and names of all components, sound or not."""
        if self.base is not None:
            yield "base", self.base.name
        for key, entries in (
            ("body", self.bodies), ("hinge_line", self.lines), ("ccl", self.loops), ("damper", self.dampers),
            ("connection", self.connections),
        ):  # fmt: skip
            for name in entries.names:
                yield f"{key}.{name}", name
        for line in self.lines.saying("hinges"):
            for hinge in line.hinges:
                yield f"hinge_line.{line.name}.hinges.{hinge.name}", hinge.name
        for line in self.lines.saying("hinges", "end_stop"):
            for hinge in line.hinges if line.end_stop is not None else ():
                yield f"hinge_line.{line.name}.end_stop of {hinge.name}", hinge.name + OF_HINGE

    def _hinges(self) -> list[str]:
        """Names of all hinges, those of unsound lines too."""
        lines = [line for line in self.reader.entries("hinge_line") if isinstance(line.get("hinges"), list)]
        hinges = [hinge for line in lines for hinge in line["hinges"] if isinstance(hinge, dict)]
        return [hinge["name"] for hinge in hinges if isinstance(hinge.get("name"), str)]

    def _points(self) -> dict[str, Mapping[str, Vector3] | None]:
        """Points by body, the base's first; None where a body does not tell its points."""
        points: dict[str, Mapping[str, Vector3] | None] = {}
        if self.base is not None:
            points[self.base.name] = self.base.points
        points |= dict.fromkeys(self.bodies.names)
        for body in self.bodies.sound:
            try:
                points[body.name] = body_points(body)
            except ComponentError as error:
                told = [f".{problem}" for problem in getattr(error, "problems", ())] or [f": {error}"]
                self.reader.note(f"body.{body.name}{problem}" for problem in told)
        return points
