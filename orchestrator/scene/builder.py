"""Scenes built in code: the same tree of tables as in a scene file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from typing import Any, Self

import numpy as np
import tomli_w

from components.contract.plugins import loaded_plugins

from .body_tables import Base, Body
from .connection_tables import Ccl, Connection, Damper
from .damping import StructuralDamping
from .data_sheets import with_entries
from .event_tables import Event
from .hinge_line_tables import Friction, HingeLine, Joint
from .joint_presets import kind_of
from .layers import Layers, Setting, Tree, plugin_files, read_layers, resolved, with_absolute_files
from .placed_scene import PlacedScene
from .plugins.trust import trust_programs
from .reader import check_layers, find_scene, variant_problems
from .requirement_tables import Requirements
from .schema import Header
from .signal_tables import Fmu
from .table import SceneError, Table
from .temperature import at_temperature
from .validation import EntryReader

Names = str | Sequence[str] | frozenset[str]
"""Names, or one of them."""
Hinges = Mapping[str, str | tuple[str, str] | Mapping[str, object]] | Sequence[Mapping[str, object]]
"""Hinges by name: the point that both bodies have, or inboard and outboard point, or all keys of a hinge; or the tables
of a scene file in a list."""


class Scene:
    """A scene to build, change, check, save and run.

        wing = Scene("one_panel", until="8 s")
        base = wing.base(points={"left": (0, 0.565, 0), "right": (0, -0.565, 0)})
        panel = wing.body("panel", catalogue="workbench_panel")
        wing.hinge_line("HL", base, panel, axis="+y", aligned_angle="180 deg", hinges={...})

    Methods that add a table accept its keys of scene files, as SI numbers or texts such as "90 deg", and return its
    name. An unknown key or an invalid value raises a SceneError at once. `check`, which every run calls first, checks
    the tables against each other. Variants and settings are applied last, over all tables.
    """

    def __init__(self, name: str, *, until: float | str, **header: object) -> None:
        """An empty scene; header: further keys of [scene], such as tolerance, largest_step, preload, gravity."""
        self._begin(Layers(name, {}, {}, frozenset()))
        self._set("scene", Header, {"name": name, "until": until, **header})
        self._accepted: frozenset[str] = frozenset(
            plugin_files(self._layers.tree)
        )  # whoever writes the name in code means it

    @classmethod
    def load(
        cls,
        scene: str | Path,
        variants: Names = (),
        settings: Mapping[str, object] | Sequence[Setting] = (),
        trust: bool = False,
    ) -> Self:
        """Read a built-in scene by its name, or a scene file; SceneError with every problem of it.

        trust: its plugins may run, now and until they change.
        """
        found = cls.read(scene).with_variants(*listed(variants)).with_settings(settings)
        if trust:
            trust_programs(plugin_files({**found.tree, "variant": found._layers.variants}))
        found.check()
        return found

    @classmethod
    def read(cls, scene: str | Path) -> Self:
        """Read the tables of a built-in scene or a scene file, which are not checked."""
        found = cls.__new__(cls)
        found._begin(read_layers(find_scene(str(scene)), find_scene))
        return found

    @classmethod
    def of_tree(cls, file: str, tree: Tree, *, of_result: bool = False) -> Self:
        """The scene of tables as a scene file holds them; file: its name in problems.

        of_result: a result or a study kept the tables, so the plugins and files that they name are not trusted.
        """
        found = cls.__new__(cls)
        found._begin(Layers(file, tree, {}, frozenset()), of_result=of_result)
        return found

    def _begin(self, layers: Layers, of_result: bool = False) -> None:
        self._layers, self._of_result = layers, of_result
        self._variants: tuple[str, ...] = ()
        self._settings: tuple[tuple[str, Any], ...] = ()
        self._checked: PlacedScene | None = None
        self._accepted = frozenset()

    @property
    def name(self) -> str:
        """Name of the scene, and of its results."""
        return str(self.tree["scene"]["name"])

    @property
    def tree(self) -> Tree:
        """Tables as in a scene file, with variants and settings applied; a copy."""
        return self._layers.over(self._variants, self._settings)[0]

    @property
    def variants(self) -> tuple[str, ...]:
        """Names of all variants; `chosen` are the applied ones."""
        return tuple(self._layers.variants)

    @property
    def chosen(self) -> tuple[str, ...]:
        """Names of the applied variants, in order."""
        return self._variants

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies."""
        return _names(self.tree, "body")

    @property
    def hinge_lines(self) -> tuple[str, ...]:
        """Names of the hinge lines."""
        return _names(self.tree, "hinge_line")

    @property
    def runs(self) -> dict[str, Scene]:
        """Scenes to run in order, by phase; the scene itself under "" if it has no phases, or one is chosen."""
        phases = self.tree["scene"].get("phases", [])
        if not phases or set(phases) & set(self._variants):
            return {"": self}
        return {phase: self.with_variants(phase) for phase in phases}

    def with_variants(self, *names: str) -> Self:
        """Copy with further variants applied; SceneError if there is no such variant."""
        found = self.copy()
        found._variants = (*self._variants, *names)
        found._checked = None if names else self._checked
        found._layers.over(found._variants)
        return found

    def with_settings(self, settings: Mapping[str, object] | Sequence[Setting]) -> Self:
        """Copy with single values changed, such as {"friction.coefficient": 0.1, "hinge_line.HL.held": True}."""
        pairs = list(settings.items()) if isinstance(settings, Mapping) else settings
        found = self.copy()
        found._settings = (*self._settings, *(_plain_setting(self._layers.file, pair) for pair in pairs))
        found._checked = None if pairs else self._checked
        found._layers.over(found._variants, found._settings)
        return found

    def copy(self) -> Self:
        """Independent copy of the scene."""
        found = self.__class__.__new__(self.__class__)
        found.__dict__.update(self.__dict__)
        found._layers = deepcopy(self._layers)
        return found

    def base(self, name: str = "base", *, points: Mapping[str, object], **keys: object) -> str:
        """Set the spacecraft, [base], with points (m) by name; free: mass, center_of_mass and inertia of a moving base.

        motion: prescribed motion laws, see `scene.body_tables.Motion`.
        """
        return self._set("base", Base, {"name": name, "points": points, **keys})

    def body(self, name: str, **keys: object) -> str:
        """Add a [[body]]: panel, frame, beam, import, catalogue, or rigid: mass, center_of_mass, inertia and points.

        Further keys: like, rigid_twin, place, motion, velocity, angular_velocity, fidelity, fixed_interface_modes,
        second_order_modes, inertia_coupling, damping_ratio, structural_damping, damping_scale, modes_off,
        frequencies_off, attached_masses.
        """
        return self._add("body", Body, {"name": name, **keys})

    def hinge_line(self, name: str, inboard: str, outboard: str, *, hinges: Hinges, **keys: object) -> str:
        """Add a [[hinge_line]] between two bodies by name: axis, aligned_angle, motor, friction, latch, end stop.

        Further keys: stowed_angle, start_angle, start_rate, latch_angle, held, motor, harness, friction_preload,
        presliding, latch, end_stop.
        Keys of a hinge: kind, translational_stiffness, rotational_stiffness, axial_clearance, radial_clearance,
        cross_clearance, harness, sensor.
        """
        tables = (
            [{"name": hinge, **_ends(ends)} for hinge, ends in hinges.items()]
            if isinstance(hinges, Mapping)
            else hinges
        )
        entry = {"name": name, "inboard": inboard, "outboard": outboard, **keys, "hinges": tables}
        return self._add("hinge_line", HingeLine, entry)

    def ccl(self, name: str, **keys: object) -> str:
        """Add a closed cable loop, [[ccl]]: preload, strand_stiffness, pulley_1, pulley_2, optional guide.

        Further keys: axis, strand_damping.
        """
        return self._add("ccl", Ccl, {"name": name, **keys})

    def damper(self, name: str, hinge: str, **keys: object) -> str:
        """Add an eddy-current damper at a hinge, [[damper]]: damping_coefficient, peak_rate."""
        return self._add("damper", Damper, {"name": name, "hinge": hinge, **keys})

    def connection(
        self, name: str, kind: str | None = None, *, ports: Mapping[str, object], **keys: object
    ) -> str:
        """Add any registered component, [[connection]]: ports as (body, point), or tables with an offset.

        Further keys: structure, parameters, preset (a joint; replaces kind), axes.
        """
        seats = {
            port: dict(zip(("body", "point"), seat, strict=True))
            if isinstance(seat, tuple) and len(seat) == 2
            else seat
            for port, seat in ports.items()
        }
        kind = kind_of(keys["preset"]) if kind is None and "preset" in keys else kind
        of_kind = {} if kind is None else {"kind": kind}
        return self._add("connection", Connection, {"name": name, **of_kind, "ports": seats, **keys})

    def fmu(self, name: str, file: str | Path, **keys: object) -> str:
        """Add an FMU of another tool, [[fmu]], by its file, with its inputs and outputs."""
        return self._add("fmu", Fmu, {"name": name, "file": str(file), **keys})

    def event(self, name: str, **keys: object) -> str:
        """Add an event, [[event]]: time or condition (when), and its action: release, latch or set."""
        return self._add("event", Event, {"name": name, **keys})

    def joint(self, **keys: object) -> None:
        """Set [joint], stiffnesses of all hinges: axial_stiffness, radial_stiffness, cross_stiffness.

        Further keys: axial_clearance, radial_clearance, cross_clearance, damping_ratio, damping_frequency.
        """
        self._set("joint", Joint, keys)

    def friction(self, **keys: object) -> None:
        """Set [friction] of all hinges: law, coefficient, static_ratio, pin_radius, bending_arm.

        Further keys: stiction_velocity, flexible_stiction_factor.
        """
        self._set("friction", Friction, keys)

    def structural_damping(self, ratio: float | str, reference_frequency: float | str) -> None:
        """Set [structural_damping]: fraction of critical damping of a mode at the reference frequency (Hz)."""
        keys = {"ratio": ratio, "reference_frequency": reference_frequency}
        self._set("structural_damping", StructuralDamping, keys)

    def requirements(self, *limits: str) -> None:
        """Set [requirements]: limits of headline numbers, such as "latch_rate.HL1 < 15 deg/s"."""
        self._set("requirements", Requirements, {"limits": limits})

    def with_requirements(self, limits: Names) -> Self:
        """Copy with further limits of headline numbers, see `requirements`."""
        if not (added := listed(limits)):
            return self
        given = self.tree.get("requirements", {}).get("limits", [])
        return self.with_settings({"requirements.limits": [*given, *added]})

    def variant(self, name: str, layer: Mapping[str, object]) -> str:
        """Add a [variant.NAME]: tables applied over the others; arrays of named entries merge by name."""
        self._checked = None
        self._layers = Layers(
            self._layers.file,
            self._layers.tree,
            {**self._layers.variants, name: _plain(f"{self._layers.file}: variant.{name}", layer)},
            self._layers.added,
        )
        return name

    def check(self) -> PlacedScene:
        """Checked records of the scene; SceneError with every problem of it."""
        if self._checked is None:
            self._checked = check_layers(
                self._layers, self._variants, self._settings, sorted(self._accepted), self._of_result
            )
            # processes that get the scene load what this one has loaded
            self._accepted |= {str(path) for path in loaded_plugins()}
        return self._checked

    def variant_problems(self) -> list[str]:
        """Problems of each variant when it alone is applied, as sentences."""
        return variant_problems(self._layers, sorted(self._accepted))

    def check_one_run(self) -> PlacedScene:
        """Checked records of the scene; SceneError also if it runs in phases and none is chosen."""
        runs = self.runs
        if len(runs) > 1 or "" not in runs:
            raise SceneError(
                [f"{self._layers.file}: it runs in phases; choose one of its variants {', '.join(runs)}"]
            )
        return self.check()

    def to_toml(self) -> str:
        """Text of the scene file, with its variants; applied variants and settings are merged into it."""
        tree = self.tree
        if self._variants or self._settings:
            tree["scene"].pop("phases", None)
        elif self.variants:
            tree["variant"] = deepcopy(dict(self._layers.variants))
        return tomli_w.dumps(tree)

    def save(self, path: str | Path) -> Path:
        """Write the scene file, replacing an earlier one, and return its path."""
        path = Path(path)
        path.write_text(self.to_toml(), encoding="utf-8")
        return path

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scene):
            return NotImplemented
        return self.tree == other.tree and self._layers.variants == other._layers.variants

    __hash__ = None  # type: ignore[assignment] # it can be changed

    def __repr__(self) -> str:
        parts = {"bodies": self.bodies, "hinge lines": self.hinge_lines, "variants": self.variants}
        told = [f"{what} {', '.join(names)}" for what, names in parts.items() if names]
        return f"<Scene {'.'.join((self.name, *self._variants))}: {'; '.join(told) or 'empty'}>"

    def _set(self, key: str, model: type[Table], keys: Mapping[str, object]) -> str:
        """Put a table where it belongs and return its name; SceneError with its problems."""
        table = _plain(f"{self._layers.file}: {key}", keys)
        with_absolute_files({key: table}, Path.cwd())
        reader = EntryReader(at_temperature({key: table})[0], ())
        reader.table(key, model, required=True)
        self._refuse(reader.problems)
        self._layers.tree[key], self._checked = table, None
        return str(table.get("name", key))

    def _add(self, key: str, model: type[Table], keys: Mapping[str, object]) -> str:
        """Put an entry behind the others of its array and return its name; SceneError with its problems."""
        entry = _plain(f"{self._layers.file}: {key}.{keys['name']}", keys)
        with_absolute_files({key: [entry]}, Path.cwd())
        whole, unlike = resolved({key: [*self._layers.tree.get(key, ()), entry]})
        whole, unmerged = with_entries(at_temperature({key: whole[key][-1:]})[0])
        if not unlike:  # what it is like may follow
            reader = EntryReader(whole, ())
            reader.tables(key, model)
            self._refuse([problem for found in unmerged.values() for problem in found] or reader.problems)
        self._layers.tree.setdefault(key, []).append(entry)
        self._checked = None
        return str(entry["name"])

    def _refuse(self, problems: Sequence[str]) -> None:
        if problems:
            raise SceneError([f"{self._layers.file}: {problem}" for problem in problems])


def listed(names: Names) -> tuple[str, ...]:
    """Names in order; SceneError if they are no names."""
    if not isinstance(names, Iterable):
        raise SceneError([f"{names!r} is no name, and no list of names"])
    return (names,) if isinstance(names, str) else tuple(names)


def _names(tree: Tree, key: str) -> tuple[str, ...]:
    return tuple(entry["name"] for entry in tree.get(key, []))


def _ends(ends: str | tuple[str, str] | Mapping[str, object]) -> dict[str, object]:
    """Keys of a hinge from the short forms for its points."""
    if isinstance(ends, Mapping):
        return dict(ends)
    if not isinstance(ends, str) and len(ends) != 2:
        raise SceneError(
            [f"the points of a hinge are {ends!r}; give one name, or an inboard and an outboard one"]
        )
    inboard, outboard = (ends, ends) if isinstance(ends, str) else ends
    return {"inboard": inboard, "outboard": outboard}


def _plain_setting(file: str, setting: Setting) -> Any:  # noqa: ANN401 - a setting
    if isinstance(setting, str):
        return setting
    if not (isinstance(setting, Sequence) and len(setting) == 2 and isinstance(setting[0], str)):
        raise SceneError(
            [f'{file}: the setting {setting!r} is neither "table.key=value" nor a key and its value']
        )
    return setting[0], _plain(f"{file}: {setting[0]}", setting[1])


def _plain(key: str, value: object) -> Any:  # noqa: ANN401 - whatever a TOML file gives
    """A value as a TOML file gives it: tables, lists, texts, numbers; SceneError where it is none of them.

    What is None in a table is not given.
    """
    if isinstance(value, Mapping):
        return {
            str(name): _plain(f"{key}.{name}", entry) for name, entry in value.items() if entry is not None
        }
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(f"{key}[{k + 1}]", entry) for k, entry in enumerate(value)]
    if isinstance(value, bool | int | float | str):
        return value
    raise SceneError([f"{key}: is {value!r}; give a number, a text, a list or a table"])
