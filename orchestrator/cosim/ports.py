"""What ports exchange: names of their variables, how many numbers, and where a participant has them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

from components import Layout

MOTION = ("position", "orientation", "velocity", "angular_velocity")
WRENCH = ("force", "torque")
SLOPES = ("force_slope", "torque_slope")
MOMENTS = ("velocity_moment", "angular_velocity_moment")
UNITS = {
    "position": "m",
    "orientation": "1",
    "velocity": "m/s",
    "angular_velocity": "rad/s",
    "force": "N",
    "torque": "N.m",
}
Order = Literal[2, 4]
Side = Literal["body", "connection"]


class Width(NamedTuple):
    """How many numbers a port has: of its wrench, with slope, and of its motion as coordinates.

    Coordinates are translation and rotation vector, at order 4 first moments of both rates, then the rates, world axes.
    """

    wrench: int
    coordinates: int


WIDTHS = {2: Width(6, 12), 4: Width(12, 18)}


class PortPlaces(NamedTuple):
    """Where a participant has the numbers of its ports, port after port: wrenches and motions begin its arrays.

    side: which side of a link they are. ports: how many. slopes, moments: where the first port's begin in the array
    on the same side; None without.
    """

    side: Side
    ports: int
    slopes: int | None = None
    moments: int | None = None


def port_places(
    side: Side, inputs: Layout, outputs: Layout, ports: Sequence[str], order: Order
) -> PortPlaces:
    """Places of a participant's ports by name; slopes and moments only where it has them all, in order."""
    if order == 2:
        return PortPlaces(side, len(ports))
    wrenches, motions = (inputs, outputs) if side == "body" else (outputs, inputs)
    slopes = _consecutive(wrenches, ports, SLOPES)
    moments = _consecutive(motions, ports, MOMENTS)
    if slopes is None or moments is None:
        return PortPlaces(side, len(ports))
    return PortPlaces(side, len(ports), slopes, moments)


def _consecutive(layout: Layout, ports: Sequence[str], names: Sequence[str]) -> int | None:
    """Where vectors of three of all ports begin; None unless they are there, one after the other."""
    wanted = [f"{port}.{name}" for port in ports for name in names]
    if not all(name in layout for name in wanted):
        return None
    places = [layout[name].start for name in wanted]
    return places[0] if places == list(range(places[0], places[0] + 3 * len(places), 3)) else None


def carried(layout: Layout, order: Order) -> int:
    """How many numbers of inputs or outputs a network exchanges: slopes, which come last, only at order 4."""
    if order == 4:
        return layout.size
    slopes = (q for q in layout.quantities if q.name.rpartition(".")[2] in (*SLOPES, *MOMENTS))
    return min((layout[q.name].start for q in slopes), default=layout.size)
