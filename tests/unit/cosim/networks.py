"""Networks of participants that no master has."""

from __future__ import annotations

from orchestrator.cosim.network import Network


def start(network: Network) -> None:
    """Bring the participants to t = 0."""
    for body in network.bodies:
        body.write()
        body.read()
    network.carry_motion()
    for participant in network.participants:
        participant.initialize(0.0)
        participant.read()
