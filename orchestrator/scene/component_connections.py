"""[[connection]] tables: any registered component, checked against what it declares itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from inspect import Parameter, signature
from math import isfinite
from typing import Any, Literal

import numpy as np

from components import REGISTRY, Component, ComponentError, Instance, Quantity
from components.contract.errors import unknown
from components.contract.frames import Vector3, add
from components.hinge import Hinge

from .bodies import StartPose
from .connection_tables import Connection
from .joint_presets import DISTANCE
from .units import QUANTITY, UNITS, written

WrenchMode = Literal["mean", "endpoint"]
"""Wrench that connections return: the mean over a step, or that at the inputs as they are."""

_WRENCH_MODE = "wrench_mode"
"""Key of the structure that the master sets."""


def component_values(
    connection: Connection, mode: WrenchMode
) -> tuple[dict[str, Any], dict[str, float | tuple[float, ...]]]:
    """Structure and start values of the component of a connection that has no problems."""
    component = _component(connection, mode)
    start = {
        name: value_of(_parameter(component, name), value) for name, value in connection.parameters.items()
    }
    if connection.kind == Hinge.kind and np.ravel(start.get("rotational_stiffness", 0.0))[0] > 0.0:
        # its springs hold it about its line: what another hold took of them would be missing when that ends
        start.setdefault("hold_stiffness", 0.0)
    return dict(component.structure), start


def first_number(connection: Connection, parameter: str) -> float:
    """First number of a parameter of a connection without problems; 0 where the scene leaves it to a default of 0."""
    return float(np.ravel(component_values(connection, "mean")[1].get(parameter, 0.0))[0])


def connection_problems(connection: Connection) -> Iterator[str]:
    """Everything that the component does not accept, as sentences with their keys.

    Ports may be missing where the table of the connection has problems of its own.
    """
    key = f"connection.{connection.name}"
    if connection.kind not in REGISTRY:
        yield f"{key}.kind: {connection.kind!r} {unknown(connection.kind, sorted(REGISTRY), 'component')}"
        return
    try:
        if any(port.side == "body" for port in REGISTRY[connection.kind].example().ports):
            yield f"{key}.kind: {connection.kind} is a body; it cannot connect others"
            return
        if wrong := list(_structure_problems(connection)):
            yield from wrong
            return
        component = _component(connection, "mean")
    except ComponentError as error:
        yield f"{key}.structure: {error}"
        return
    except (
        TypeError,
        ValueError,
        LookupError,
        ArithmeticError,
    ) as error:  # what constructors do with values of another kind
        yield f"{key}.structure: {connection.kind} cannot be made of {connection.structure}: {error}"
        return
    ports = [port.name for port in component.ports]
    if hasattr(connection, "ports"):
        for name in sorted({*ports} ^ connection.ports.keys()):
            yield f"{key}.ports.{name}: " + (
                "is missing" if name in ports else f"is no port; ports are {', '.join(ports)}"
            )
    if connection.preset == DISTANCE and "preload_length" not in connection.parameters:
        yield f"{key}.parameters.preload_length: is missing; give the distance that the joint holds"
    yield from _parameter_problems(key, connection, component)


def _structure_problems(connection: Connection) -> Iterator[str]:
    """Keys of `structure` that the component does not have, or that it needs and are missing."""
    key = f"connection.{connection.name}.structure"
    declared = dict(signature(REGISTRY[connection.kind]).parameters)
    if any(one.kind is Parameter.VAR_KEYWORD for one in declared.values()):
        return
    declared.pop(_WRENCH_MODE, None)
    for name in connection.structure:
        if name not in declared:
            yield f"{key}.{name}: {unknown(name, list(declared))}"
    for name, one in declared.items():
        if one.default is Parameter.empty and name not in connection.structure:
            yield f"{key}.{name}: is missing"
        given = connection.structure.get(name, one.default)
        if isinstance(one.default, bool) and not isinstance(given, bool):
            yield f"{key}.{name}: is {given!r}; it must be true or false"


def instance_of(connection: Connection) -> Instance:
    """The component of a connection with its start values."""
    structure, start = component_values(connection, "mean")
    return Instance(REGISTRY[connection.kind](**structure), start)


def seated(
    connection: Connection, points: Mapping[str, Mapping[str, Vector3]], poses: Mapping[str, StartPose]
) -> Instance:
    """The component of a connection with its start values and its ports where bodies start, at rest."""
    instance = instance_of(connection)
    for port, seat in connection.ports.items():
        pose = poses[seat.body]
        instance.set(f"{port}.position", pose.place(add(points[seat.body][seat.point], seat.offset)))
        instance.set(f"{port}.orientation", pose.orientation)
    return instance


def _parameter_problems(key: str, connection: Connection, component: Component) -> Iterator[str]:
    layout = component.parameter_layout
    values = layout.start_values()
    sound = True
    for name, value in connection.parameters.items():
        try:
            quantity = _parameter(component, name)
            values[layout[name]] = in_range(quantity, value, value_of(quantity, value))
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
    if kind.has_wrench_mode():
        structure[_WRENCH_MODE] = mode
    return kind(**structure)


def _parameter(component: Component, name: str) -> Quantity:
    found = {quantity.name: quantity for quantity in component.parameter_layout.quantities}
    if name not in found:
        also = "; it belongs into structure" if name in component.structure else ""
        raise ComponentError(f"{unknown(name, list(found), 'parameter')}{also}")
    return found[name]


def value_of(quantity: Quantity, value: object) -> float | tuple[float, ...]:
    """The value in the unit that the component declares; 1 or 0 for true or false."""
    if isinstance(value, bool) and quantity.kind == "boolean":
        return float(value)
    if quantity.size == 1:
        return number_of(quantity, value)
    if not isinstance(value, list | tuple) or len(value) != quantity.size:
        raise ValueError(f"is {value!r}; it must be a list of {quantity.size} values in {quantity.unit}")
    return tuple(number_of(quantity, entry) for entry in value)


def in_range(
    quantity: Quantity, given: object, value: float | tuple[float, ...]
) -> float | tuple[float, ...]:
    """The value, where all its numbers are within the component's bounds and of the kind that it declares."""
    low, high = quantity.minimum, quantity.maximum
    unit = "" if quantity.unit == "1" else f" {quantity.unit}"
    for number in (value,) if isinstance(value, float) else value:
        if low is not None and number < low:
            raise ValueError(f"is {given!r}; it must be at least {low:g}{unit}")
        if high is not None and number > high:
            raise ValueError(f"is {given!r}; it must be at most {high:g}{unit}")
        if quantity.kind != "real" and not number.is_integer():
            needed = "true or false" if quantity.kind == "boolean" else "a whole number"
            raise ValueError(f"is {given!r}; it must be {needed}")
    return value


def number_of(quantity: Quantity, value: object) -> float:
    """One of its numbers, in the unit that the component declares; ValueError where it is none."""
    if quantity.unit in UNITS:
        return written(value, quantity.unit)
    own = QUANTITY.fullmatch(value) if isinstance(value, str) else None
    if own is not None and own[2] == quantity.unit:  # one that only the component knows
        value = float(own[1])
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        raise ValueError(f"is {value!r}; it must be a finite number of {quantity.unit}")
    return float(value)
