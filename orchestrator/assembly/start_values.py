"""Start values of connections' inputs: where the bodies' ports are before anything moves.

With them every exported FMU of a scene also runs alone, in the stowed configuration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from components import REGISTRY, Instance

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


def _outputs(part: Part) -> Mapping[str, tuple[float, ...]]:
    """Outputs of a body at its start, by name."""
    body = Instance(REGISTRY[part.kind](**part.structure), part.start)
    layout, outputs = body.component.output_layout, body.outputs()
    return {q.name: tuple(outputs[layout[q.name]].tolist()) for q in layout.quantities}
