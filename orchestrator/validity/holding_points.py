"""Points where joints hold a modal body."""

from __future__ import annotations

from ..assembly import Assembly, Part


def holding_points(part: Part, assembly: Assembly) -> list[tuple[str, str]]:
    """Names of connections and of the points of a body that they have ports at."""
    points = {port["name"]: port["point"] for port in part.structure["ports"]}
    return [
        (link.connection[0], points[link.body[1]]) for link in assembly.links if link.body[0] == part.name
    ]
