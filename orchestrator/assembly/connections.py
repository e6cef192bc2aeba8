"""[[connection]] tables as parts."""

from __future__ import annotations

from ..scene.component_connections import WrenchMode, component_values
from ..scene.connection_tables import Connection
from . import Part


def connection_part(connection: Connection, mode: WrenchMode) -> Part:
    """The part of a connection that has no problems."""
    structure, start = component_values(connection, mode)
    return Part(connection.name, connection.kind, structure, start)
