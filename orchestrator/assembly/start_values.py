"""Start values of connections' inputs: where the bodies' ports are before anything moves.

With them every exported FMU of a scene also runs alone, in the stowed configuration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from components import Instance
from components.contract.connection import Connection
from components.contract.ports import PortMotion

from . import Link, Part


def with_port_starts(parts: Sequence[Part], links: Sequence[Link]) -> tuple[Part, ...]:
    """The parts, with the start motions of the bodies' ports added to the start values of connections."""
    motions: dict[str, dict[str, tuple[float, ...]]] = {part.name: {} for part in parts}
    bodies = {link.body[0] for link in links}
    outputs = {part.name: _outputs(part) for part in parts if part.name in bodies}
    for link in links:
        (body, port), (connection, side) = link.body, link.connection
        for variable in ("position", "orientation"):
            motions[connection][f"{side}.{variable}"] = outputs[body][f"{port}.{variable}"]
    return tuple(replace(part, start={**part.start, **motions[part.name]}) for part in parts)


def led_to(before: Sequence[Part], now: Sequence[Part], links: Sequence[Link]) -> tuple[Part, ...]:
    """Parts whose bodies start elsewhere now, with port starts there, and connections whose springs know where from."""
    from_where = {part.name: part for part in before}
    return tuple(_led(from_where[part.name], part) for part in with_port_starts(now, links))


def _led(before: Part, now: Part) -> Part:
    component = now.component()
    if not isinstance(component, Connection):
        return now
    then, here = ([_motion(part, port.name) for port in component.ports] for part in (before, now))
    values = {name: tuple(value) for name, value in component.led(then, here).items()}
    return replace(now, start={**now.start, **values})


def _motion(part: Part, port: str) -> PortMotion:
    """Of a connection's port at rest, by its start values."""
    still = (0.0, 0.0, 0.0)
    x, y, z = np.ravel(part.start[f"{port}.position"]).tolist()
    a, b, c, d = np.ravel(part.start[f"{port}.orientation"]).tolist()
    return PortMotion((x, y, z), (a, b, c, d), still, still)


def _outputs(part: Part) -> Mapping[str, tuple[float, ...]]:
    """Outputs of a body at its start, by name."""
    body = Instance(part.component(), part.start)
    layout, outputs = body.component.output_layout, body.outputs()
    return {q.name: tuple(outputs[layout[q.name]].tolist()) for q in layout.quantities}
