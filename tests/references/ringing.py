"""A deployed, latched wing without any damping that swings in one of its modes, and what becomes of the energy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orchestrator.assembly import Assembly, Part
from orchestrator.assembly.assemble import assemble
from orchestrator.assembly.statics.configuration import configuration
from orchestrator.assembly.statics.linear_model import linearise, normal_modes
from orchestrator.assembly.statics.mechanism import Mechanism
from orchestrator.assembly.statics.placed_body import PlacedBody
from orchestrator.cosim.master import Master
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import Participant
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import as_fmus
from orchestrator.scene import find_scene, load_scene
from tests.references.record import Record

Vector = NDArray[np.float64]

_UNDAMPED: dict[str, dict[str, Any]] = {
    "body": {"damping_scale": 0.0},
    "hinge": {
        "translational_damping": (0.0, 0.0, 0.0),
        "rotational_damping": (0.0, 0.0, 0.0),
        "latch_damping": 0.0,
        "lock_damping": 0.0,
        "friction_coefficient": 0.0,
        "friction_preload": 0.0,
        "motor_stiffness": 0.0,
        "motor_wind_up": 0.0,
    },
}


def undamped_wing(scene: str, variants: Sequence[str]) -> Assembly:
    """Bodies and hinges of a scene, deployed, without damping, friction, motors, harness, dampers and cables."""
    loaded = load_scene(find_scene(scene), variants)
    found = assemble(loaded.with_angles(configuration(loaded, "deployed").angles))
    parts = {p.name: p for p in found.parts if p.kind in ("body", "fixed_base", "hinge")}
    links = tuple(link for link in found.links if link.connection[0] in parts)
    used = {link.body for link in links}
    return replace(found, parts=tuple(_undamped(part, used) for part in parts.values()), links=links)


def _undamped(part: Part, used: set[tuple[str, str]]) -> Part:
    structure = dict(part.structure)
    if part.kind == "hinge":
        structure |= {"harness_angle": (), "harness_torque": ()}
    else:
        structure["ports"] = [port for port in structure["ports"] if (part.name, port["name"]) in used]
    return replace(part, structure=structure, start={**part.start, **_UNDAMPED.get(part.kind, {})})


def swing(wing: Assembly, number: int, periods: float, settings: Settings) -> tuple[Record, float]:
    """The latched wing with a joule in one mode (0 is the first), from its undeformed shape; period (s)."""
    hinges = [hinge for line in wing.hinge_lines for hinge in line.hinges]
    mechanism = Mechanism(wing.parts, wing.links, wing.base)
    mechanism.follow()
    mechanism.command("latch_command", 1.0, hinges)
    model = linearise(mechanism)
    modes = normal_modes(model)
    rates = np.sqrt(2.0) * modes.shapes[:, number]
    period = 1.0 / float(modes.frequencies[number])
    with as_fmus(wing) as participants:
        network = Network(participants, wing.links, settings.order or 2)
        record = Record(network)
        master = Master(network, (), record, settings)
        for hinge in hinges:
            joint = network.by_name[hinge]
            joint.inputs[joint.input_layout["latch_command"]] = 1.0
        master.initialize(preload=False)
        for body in network.bodies:
            rows, placed = mechanism.rows[body.name], mechanism.bodies[body.name]
            if placed.body is not None:
                _set_moving(body, placed, model.mass[rows, rows], rates[rows])
            body.read()
        network.carry_motion()
        record.times.clear(), record.rows.clear()
        master.run(periods * period)
    return record, period


def _set_moving(body: Participant, placed: PlacedBody, mass: Vector, rates: Vector) -> None:
    """Momenta and angular velocity of an undeformed body from the rates of its coordinates."""
    body.save()
    state = bytearray(body.serialized())
    # a serialised state ends with the states; how many there are is the fifth of the numbers behind its owner
    size = int(np.frombuffer(state, dtype=float, count=1, offset=16 + 4 * 8)[0])
    x = np.frombuffer(state, dtype=float, count=size, offset=len(state) - 8 * size)
    x[7:13] = mass[:6, :6] @ rates[:6]
    x[13:16] = placed.axes.T @ rates[3:6]
    x[17 + placed.modes : 17 + 2 * placed.modes] = rates[6:]
    sum_of_all = 14695981039346656037  # FNV-1a of all bytes but its own eight
    for byte in state[:80] + state[88:]:
        sum_of_all = (sum_of_all ^ byte) * 1099511628211 % 2**64
    state[80:88] = sum_of_all.to_bytes(8, "little")
    body.deserialize(bytes(state))
