"""`fanfold list`: built-in scenes, components with their keys, ports and signals, tables of scene files."""

from __future__ import annotations

import sys
from inspect import Parameter, signature
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from .command import PLUGIN, made_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from components import Component, Quantity

    from ..scene.keys.listing import KeyTable


@made_of(name="list", plugin=PLUGIN)
@click.argument("name", required=False)
def command(name: str | None, names: bool = False, plugin: Sequence[str] = ()) -> None:
    """List scenes and components, or describe NAME.

    NAME is a component, a table of scene files such as hinge_line, latch or panel, or `distributions` of studies.

    Options
    -------
    names
        print only scenes and their variants, one per line, as arguments of `fanfold run`
    """
    from components import REGISTRY

    if names:
        if name is not None:
            raise click.UsageError("--names lists all scenes; leave NAME out")
        _list_names()
    elif name is None:
        _list_all()
    else:
        from ..scene.keys.listing import key_tables, tables_called

        component, tables = REGISTRY.get(name), tables_called(name)
        if component is not None:
            _describe(component)
        for table in tables:
            _print_table(table)
        if name == _DISTRIBUTIONS:
            _print_distributions()
        elif component is None and not tables:
            from components.contract.errors import unknown

            known = {*REGISTRY, _DISTRIBUTIONS, *(one.place.rpartition(".")[2] for one in key_tables()[1:])}
            sentence = unknown(name, sorted(known), "name")
            raise click.BadParameter(f"{name!r} {sentence}")


_DISTRIBUTIONS = "distributions"


def _list_names() -> None:
    from ..scene.builder import Scene

    for name in fanfold.scenes():
        click.echo(name)
        for variant in Scene.read(name).variants:
            click.echo(f"{name} --variant {variant}")


def _print_distributions() -> None:
    """Distributions of `fanfold study` with their numbers."""
    from ..analysis.sampling.distributions import FORMS
    from .tables import table_of, terminal

    title = "distributions of `fanfold study --vary KEY=DISTRIBUTION`"
    headings = ("distribution", "meaning")
    terminal().print(table_of(title, headings, FORMS.values(), headings, headings[:1]))


def _print_table(table: KeyTable) -> None:
    """Keys of a table of scene files with unit, default and meaning, and an example."""
    from .tables import table_of, terminal

    console = terminal()
    heading = f"[[{table.place}]]" if table.array else f"[{table.place}]"
    meaning = " ".join(table.meaning.split())
    console.print(f"{heading} in scene files: {meaning}\n", highlight=False)
    rows = [
        (key.name, key.unit, key.default, f"{key.meaning} ({key.value}{key.table and f' {key.table}'})")
        for key in table.keys
    ]
    headings = ("key", "unit", "default", "meaning")
    cells = ([cell.replace("`", "") for cell in row] for row in rows)
    console.print(table_of("keys", headings, cells, headings, headings[:1]))
    console.print(f"example:\n\n{table.example}\n", highlight=False)


def _list_all() -> None:
    from components import REGISTRY

    from ..scene.builder import Scene
    from .tables import table_of, terminal

    rows = []
    for name in fanfold.scenes():
        scene = Scene.read(name)
        description = scene.tree["scene"].get("description", "")
        rows.append((name, description, ", ".join(scene.bodies), ", ".join(scene.variants)))
    kinds = [
        (kind, (component.__doc__ or "").strip().splitlines()[0])
        for kind, component in sorted(REGISTRY.items())
    ]
    console = terminal()
    for headings, cells in (
        (("scene", "description", "bodies", "variants"), rows),
        (("component", "what it is"), kinds),
    ):
        console.print(table_of(None, headings, cells, headings))
    console.print(
        "`fanfold list NAME` shows the keys of a component or of a table of scene files, such as latch"
    )


def _describe(kind: type[Component]) -> None:
    """Print the declarations of a component; variables are those of its example."""
    from inspect import getdoc

    from .tables import table_of, terminal

    console, example = terminal(), kind.example()
    paragraphs = [" ".join(part.split()) for part in (getdoc(kind) or "").split("\n\n")]
    console.print(f"{kind.kind}: " + "\n\n".join(paragraphs) + "\n", highlight=False)
    ports = ", ".join(port.name for port in example.ports)
    side = (
        "receive motion and return a wrench"
        if example.ports[0].side == "connection"
        else "receive a wrench and return motion"
    )
    varies = "set by its structure, such as " if kind.ports_vary else ""
    console.print(f"ports: {varies}{ports}; they {side}\n", highlight=False)
    structure = [
        (key.name, "needed" if key.default is Parameter.empty else repr(key.default))
        for key in signature(kind).parameters.values()
    ]
    if structure:
        console.print(table_of("structure", ("key", "default"), structure, ("key", "default")))
    _print_laws(kind)
    for title, quantities in (
        ("parameters", example.parameter_layout.quantities),
        ("commands", example.own_inputs),
        ("recorded signals", example.observation_layout.quantities),
    ):
        _print_quantities(title, quantities)


def _print_laws(kind: type[Component]) -> None:
    """Print the terms of motion laws, if the component has such laws."""
    from components.numerics.motion_law import MEANING, PROFILES, MotionLaw

    from .tables import table_of, terminal

    if getattr(sys.modules[kind.__module__], MotionLaw.__name__, None) is not MotionLaw:
        return
    headings = ("profile", "needs", "may have")
    rows = [
        (
            name,
            ", ".join(profile.needs),
            ", ".join(f"{key} ({value:g})" for key, value in profile.may.items()),
        )
        for name, profile in PROFILES.items()
    ]
    console = terminal()
    console.print(table_of("terms of motion laws", headings, rows, headings))
    console.print(" ".join(MEANING.replace("`", "").split()) + "\n", highlight=False)


def _print_quantities(title: str, quantities: Iterable[Quantity]) -> None:
    """Name, unit, default and meaning of variables; those that only correct others are left out."""
    from components import LAGGED

    from .tables import table_of, terminal

    has_start = title == "parameters"
    rows = []
    for quantity in quantities:
        if quantity.name.endswith(LAGGED):
            continue
        start = [", ".join(f"{value:g}" for value in quantity.start_values())] if has_start else []
        unit = "" if quantity.unit == "1" else quantity.unit
        rows.append((quantity.name, unit, *start, quantity.description))
    headings = ("name", "unit", *["default"] * has_start, "meaning")
    if rows:
        terminal().print(table_of(title, headings, rows, headings, headings[:2]))
