"""[[connection]] tables as parts: any registered component, checked against what it declares itself."""

from __future__ import annotations

from collections.abc import Iterator
from inspect import signature
from math import isfinite
from typing import Any

from components import REGISTRY, Component, ComponentError, Quantity

from .assembly import Part
from .scene_connection_tables import Connection
from .scene_connections import WrenchMode
from .units import UNITS, to_si


def connection_part(connection: Connection, mode: WrenchMode) -> Part:
    """The part of a connection that has no problems."""
    component = _component(connection, mode)
    start = {
        name: _value(_parameter(component, name), value) for name, value in connection.parameters.items()
    }
    return Part(connection.name, connection.kind, dict(component.structure), start)


def connection_problems(connection: Connection) -> Iterator[str]:
    """Everything that the component does not accept, as sentences with their keys."""
    key = f"connection.{connection.name}"
    if connection.kind not in REGISTRY:
        yield f"{key}.kind: there is no component {connection.kind!r}; components are {', '.join(sorted(REGISTRY))}"
        return
    try:
        component = _component(connection, "mean")
    except ComponentError as error:
        yield f"{key}.structure: {error}"
        return
    except (TypeError, ValueError, LookupError) as error:  # what constructors do with values of another kind
        yield f"{key}.structure: {connection.kind} cannot be made of {connection.structure}: {error}"
        return
    sides = {port.name: port.side for port in component.ports}
    if "body" in sides.values():
        yield f"{key}.kind: {connection.kind} is a body; it cannot connect others"
        return
    for name in sides.keys() ^ connection.ports.keys():
        yield f"{key}.ports.{name}: " + (
            "is missing" if name in sides else f"is no port; ports are {', '.join(sides)}"
        )
    yield from _parameter_problems(key, connection, component)


def _parameter_problems(key: str, connection: Connection, component: Component) -> Iterator[str]:
    layout = component.parameter_layout
    values = layout.start_values()
    sound = True
    for name, value in connection.parameters.items():
        try:
            values[layout[name]] = _value(_parameter(component, name), value)
        except (ComponentError, ValueError) as error:
            sound = False
            yield f"{key}.parameters.{name}: {error}"
    try:
        if sound:
            component.prepare(values)
    except ComponentError as error:
        yield f"{key}.parameters: {error}"


def _component(connection: Connection, mode: WrenchMode) -> Component:
    kind = REGISTRY[connection.kind]
    structure: dict[str, Any] = dict(connection.structure)
    if "wrench_mode" in signature(kind).parameters:
        structure["wrench_mode"] = mode
    return kind(**structure)


def _parameter(component: Component, name: str) -> Quantity:
    found = {quantity.name: quantity for quantity in component.parameter_layout.quantities}
    if name not in found:
        raise ComponentError(f"is no parameter; parameters are {', '.join(found) or 'none'}")
    return found[name]


def _value(quantity: Quantity, value: object) -> float | tuple[float, ...]:
    """The value in the unit that the component declares."""
    if quantity.size == 1:
        return _number(quantity, value)
    if not isinstance(value, list | tuple) or len(value) != quantity.size:
        raise ValueError(f"is {value!r}; it must be a list of {quantity.size} values in {quantity.unit}")
    return tuple(_number(quantity, entry) for entry in value)


def _number(quantity: Quantity, value: object) -> float:
    if quantity.unit in UNITS:
        return to_si(value, quantity.unit)
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        raise ValueError(f"is {value!r}; it must be a finite number of {quantity.unit}")
    return float(value)
