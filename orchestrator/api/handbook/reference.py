"""Pages of the reference in Markdown, generated from what models and components declare."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from importlib import import_module
from inspect import Parameter, getdoc, signature

from components import LAGGED, REGISTRY, Component, Quantity
from components.contract import component as contract
from components.contract.connection import Connection
from components.numerics.motion_law import MEANING, PROFILES

from ...scene.keys.listing import KeyTable, key_tables
from ...scene.units import UNITS

_ROLES = {
    "load": "peaks in the headline numbers",
    "interface load": "peaks in the headline numbers, load on the spacecraft",
    "interface load of a port": "share of one port of the load on the spacecraft",
    "load at a hinge": "peaks in the headline numbers, load at a hinge",
    "attitude": "peaks in the headline numbers",
    "dissipation": "share of the dissipated energy",
    "penetration": "struck where it rises through zero",
}
"""Meaning of the roles that components declare, for readers of a result."""


def scene_page() -> str:
    """Keys of scene files with unit, default and meaning, as Markdown."""
    lines = ["# Keys of scene files", "", _SCENE, ""]
    lines += _table(
        ("SI unit", "what may be written"),
        (
            ("none" if unit == "1" else f"`{unit}`", ", ".join(f"`{name}`" for name in units))
            for unit, units in UNITS.items()
        ),
    )
    for table in key_tables():
        lines += _keys(table)
    lines += ["", "(key-motion-law)=", "## Terms of motion laws", "", MEANING, ""]
    lines += _table(
        ("profile", "needs", "may have"),
        (
            (
                f"`{name}`",
                _names(profile.needs),
                ", ".join(f"`{key}` ({value:g})" for key, value in profile.may.items()),
            )
            for name, profile in PROFILES.items()
        ),
    )
    return "\n".join(lines) + "\n"


_SCENE = """*Needed* keys have no default; an empty default means that
nothing is there. A plain number is in the SI unit of its key; a text such as `"90 deg"` brings its own unit, one
of:"""


def _keys(table: KeyTable) -> Iterator[str]:
    """One table of a scene file; those within others are a heading deeper."""
    yield ""
    if table.place:
        yield f"({_anchor(table.place)})="
    yield (
        "## Outside of the tables"
        if not table.place
        else f"{'##' if '.' not in table.place else '###'} {_heading(table)}"
    )
    yield ""
    yield table.meaning
    yield ""
    rows = []
    for key in table.keys:
        value = f"[{key.value}](#{_anchor(key.table)})" if key.table else key.value
        default = (
            key.default if key.default == "needed" or key.default.startswith("or `") else _code(key.default)
        )
        rows.append((f"`{key.name}`", value, _code(key.unit), default, key.meaning))
    yield from _table(("key", "value", "SI unit", "default", "meaning"), rows)


def _heading(table: KeyTable) -> str:
    if "." in table.place or not table.array:
        return f"`[{table.place}]`"
    return f"`[[{table.place}]]`"


def _anchor(place: str) -> str:
    return "key-" + place.replace(".", "-").replace("_", "-")


def components_page() -> str:
    """Components with equations, structure, parameters, commands and recorded signals, as Markdown."""
    lines = ["# Components and signals", "", _SIGNALS, ""]
    for kind, component in sorted(REGISTRY.items()):
        lines += _component(kind, component)
    lines += ["## The contract of a component", "", "```text", (contract.__doc__ or "").strip(), "```", ""]
    lines += ["Of a connection:", "", "```text", getdoc(Connection) or "", "```"]
    return "\n".join(lines) + "\n"


_SIGNALS = """A signal of a result is
`result["component", "signal"]`, in SI units; a vector has its three components in the axes that its meaning says,
*world axes* being those of the scene. Forces and torques on a body are positive along the positive axis; torques of
hinges, drives and dampers are those on the *outboard* body about the hinge line, so that a positive one opens.
Energies count from the start of the run. Signals by which runs are compared and that stand among the headline
numbers say so. Every port also has, by its name, `position`, `orientation`, `velocity`, `angular_velocity`, and
`force`, `torque` on the body there, all in world axes."""


def _component(kind: str, component: type[Component]) -> Iterator[str]:
    example = component.example()
    yield f"(component-{kind.replace('_', '-')})="
    yield f"## `{kind}`"
    yield ""
    yield from _prose(getdoc(component) or "")
    yield from _prose((import_module(component.__module__).__doc__ or "").strip())
    ports = ", ".join(f"`{port.name}`" for port in example.ports)
    side = (
        "take motion and give a wrench"
        if example.ports[0].side == "connection"
        else "take a wrench and give motion"
    )
    yield f"Ports: {'as its structure says, such as ' if component.ports_vary else ''}{ports}; they {side}."
    yield ""
    structure = [
        (f"`{key.name}`", "needed" if key.default is Parameter.empty else _code(repr(key.default)))
        for key in signature(component).parameters.values()
    ]
    yield from _titled("Structure", ("key", "default"), structure)
    yield from _titled("Parameters", _PARAMETERS, _parameters(example.parameter_layout.quantities))
    yield from _titled("Commands", _SIGNAL, _rows(example.own_inputs))
    yield from _titled("Outputs", _SIGNAL, _rows(example.own_outputs))
    yield from _titled("Recorded signals", _SIGNAL, _rows(example.observation_layout.quantities))
    for words, other in component.other_examples().items():
        for title, quantities in (("Commands", _commands), ("Recorded signals", _signals)):
            usual = {quantity.name for quantity in quantities(example)}
            more = [quantity for quantity in quantities(other) if quantity.name not in usual]
            yield from _titled(f"{title} of {words} in addition", _SIGNAL, _rows(more))


def _prose(docstring: str) -> Iterator[str]:
    """A docstring as Markdown: paragraphs, and as it stands what is indented."""
    for part in docstring.split("\n\n"):
        lines = part.strip("\n").split("\n")
        if all(line.startswith("    ") for line in lines):
            yield from ("```text", *(line[4:] for line in lines), "```", "")
        else:
            yield from (" ".join(" ".join(lines).split()).replace("*", r"\*"), "")


def _commands(component: Component) -> Sequence[Quantity]:
    return component.own_inputs


def _signals(component: Component) -> Sequence[Quantity]:
    return component.observation_layout.quantities


_SIGNAL = ("name", "size", "SI unit", "meaning")
_PARAMETERS = ("name", "size", "SI unit", "default", "meaning")


def _parameters(quantities: Iterable[Quantity]) -> Iterator[tuple[str, ...]]:
    for quantity in _shown(quantities):
        values = sorted(set(quantity.start_values().tolist()))
        default = ", ".join(
            f"{value:g}" for value in (values if len(values) == 1 else quantity.start_values())
        )
        name, size, unit, meaning = _row(quantity)
        yield name, size, unit, _code(default), meaning


def _rows(quantities: Iterable[Quantity]) -> Iterator[tuple[str, ...]]:
    return map(_row, _shown(quantities))


def _row(quantity: Quantity) -> tuple[str, str, str, str]:
    unit = "" if quantity.unit == "1" else quantity.unit
    role = f"; {_ROLES[quantity.role]}" if quantity.role else ""
    size = "varies" if quantity.resized else str(quantity.size)
    return f"`{quantity.name}`", size, _code(unit), quantity.description + role


def _shown(quantities: Iterable[Quantity]) -> Iterator[Quantity]:
    """Without those that only correct others."""
    return (quantity for quantity in quantities if not quantity.name.endswith(LAGGED))


def _titled(title: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """A table with a title, nothing where it has no rows."""
    listed = list(rows)
    if listed:
        yield f"**{title}**"
        yield ""
        yield from _table(head, listed)
        yield ""


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    yield "| " + " | ".join(head) + " |"
    yield "|" + "---|" * len(head)
    for row in rows:
        yield "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in row) + " |"


def _names(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _code(text: str) -> str:
    return f"`{text}`" if text else ""
