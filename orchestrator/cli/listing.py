"""`fanfold list`: what comes with Fanfold, and the keys, ports and signals of a component."""

from __future__ import annotations

import sys
from inspect import Parameter, signature
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from .options import plugin_option

if TYPE_CHECKING:
    from collections.abc import Iterable

    from components import Component, Quantity


@click.command("list")
@click.argument("component", required=False)
@plugin_option
def command(component: str | None) -> None:
    """Scenes that come with Fanfold and components, or of a COMPONENT its keys, ports and recorded signals."""
    from components import REGISTRY

    if component is None:
        _list_all()
    elif component in REGISTRY:
        _describe(REGISTRY[component])
    else:
        raise click.BadParameter(
            f"there is no component {component!r}; components are {', '.join(sorted(REGISTRY))}"
        )


def _list_all() -> None:
    from rich.table import Table

    from components import REGISTRY

    from .tables import terminal

    scenes = Table("scene", "description", "bodies", "variants")
    for name in fanfold.scenes():
        scene = fanfold.load(name)
        description = scene.tree["scene"].get("description", "")
        scenes.add_row(name, description, ", ".join(scene.bodies), ", ".join(scene.variants))
    kinds = Table("component", "what it is")
    for kind, component in sorted(REGISTRY.items()):
        kinds.add_row(kind, (component.__doc__ or "").strip().splitlines()[0])
    console = terminal()
    console.print(scenes)
    console.print(kinds)
    console.print("fanfold list COMPONENT tells its keys, ports and recorded signals")


def _describe(kind: type[Component]) -> None:
    """What a component takes and tells, from its own declarations; variables are those of its example."""
    from inspect import getdoc

    from .tables import plain_table, terminal

    console, example = terminal(), kind.example()
    paragraphs = [" ".join(part.split()) for part in (getdoc(kind) or "").split("\n\n")]
    console.print(f"{kind.kind}: " + "\n\n".join(paragraphs) + "\n", markup=False, highlight=False)
    ports = ", ".join(port.name for port in example.ports)
    side = (
        "take motion and give a wrench"
        if example.ports[0].side == "connection"
        else "take a wrench and give motion"
    )
    varies = "as its structure says, such as " if kind.ports_vary else ""
    console.print(f"ports: {varies}{ports}; they {side}\n", markup=False, highlight=False)
    structure = plain_table("structure")
    structure.add_column("key", no_wrap=True)
    structure.add_column("default")
    for key in signature(kind).parameters.values():
        structure.add_row(key.name, "needed" if key.default is Parameter.empty else repr(key.default))
    if structure.row_count:
        console.print(structure, markup=False)
    _print_laws(kind)
    for title, quantities in (
        ("parameters", example.parameter_layout.quantities),
        ("commands", example.own_inputs),
        ("recorded signals", example.observation_layout.quantities),
    ):
        _print_quantities(title, quantities)


def _print_laws(kind: type[Component]) -> None:
    """Terms that a motion law has, of a component whose file knows of such laws."""
    from components.numerics.motion_law import MEANING, PROFILES, MotionLaw

    from .tables import plain_table, terminal

    if getattr(sys.modules[kind.__module__], MotionLaw.__name__, None) is not MotionLaw:
        return
    table = plain_table("terms of motion laws")
    for name in ("profile", "needs", "may have"):
        table.add_column(name)
    for name, profile in PROFILES.items():
        defaults = ", ".join(f"{key} ({value:g})" for key, value in profile.may.items())
        table.add_row(name, ", ".join(profile.needs), defaults)
    console = terminal()
    console.print(table, markup=False)
    console.print(" ".join(MEANING.replace("`", "").split()) + "\n", markup=False, highlight=False)


def _print_quantities(title: str, quantities: Iterable[Quantity]) -> None:
    """Name, unit, default and meaning of variables; those that only correct others are left out."""
    from components import LAGGED

    from .tables import plain_table, terminal

    shown = [quantity for quantity in quantities if not quantity.name.endswith(LAGGED)]
    has_start = title == "parameters"
    table = plain_table(title)
    table.add_column("name", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    if has_start:
        table.add_column("default")
    table.add_column("meaning")
    for quantity in shown:
        start = [", ".join(f"{value:g}" for value in quantity.start_values())] if has_start else []
        table.add_row(
            quantity.name, "" if quantity.unit == "1" else quantity.unit, *start, quantity.description
        )
    if shown:
        terminal().print(table, markup=False)
