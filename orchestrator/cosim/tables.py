"""Tables of numbers by name, from which the library makes a coupling (`fmus/native/coupling/tables.c`)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from components.contract.roles import (
    IMPULSE,
    LATCH_COMMAND,
    LATCH_DISTANCE,
    PENETRATION,
    RELEASE_COMMAND,
    TIME_TO_BREAK,
    UNLATCH_COMMAND,
)

from ..assembly import Condition, HingeLine
from .elimination import eliminate
from .energy_balance import energy_rows
from .network import Network
from .participant import Participant, first_observations
from .ports import Order, carried
from .rows import lagged_pairs, recorded_places
from .settings import Settings

NOWHERE = 10**8
"""Place of a quantity that a participant does not have."""
_ITERATED, _MOST_ITERATED = {2: 1e-2, 4: 1e-3}, 1e-6
"""Tolerance of an iteration over that of the run by order, and the largest one. At order 4 errors that an iteration
leaves in stiff joints go into slopes and recorded loads."""
_LOCKED, _LEAST_LOCKED = 1e-2, 1e-9
"""Factor of both where rigid bodies lock, as errors in a lock of 1e8 N.m/rad are torques as large as those of light
bodies; and the smallest tolerance that round-off permits."""


def coupling_tables(
    network: Network,
    lines: Sequence[HingeLine],
    conditions: Sequence[Condition],
    settings: Settings,
    signals: int = 0,
) -> Mapping[str, ArrayLike]:
    """All tables. lines: those of the scene; the latching ones are written. signals: channels of FMUs with signals."""
    participants = network.participants
    number = {participant.name: i for i, participant in enumerate(participants)}
    latching = [line for line in lines if line.latches]
    bodies = {body.name for body in network.bodies}
    pairs = [(p.name, pair) for p, first in _with_firsts(participants) for pair in lagged_pairs(first, p)]
    return {
        "network": [len(participants), len(network.bodies), len(network.meetings), network.order],
        "scene": [settings.driving.load, settings.driving.load, settings.driving.energy],
        "by_tolerance": _by_tolerance(lines, settings, network.order),
        **_participants(network),
        **_linear_system(network),
        **_laws(participants),
        "latch_distance": [place_of(p.output_layout, LATCH_DISTANCE.name) for p in participants],
        "latch_command": [place_of(p.input_layout, LATCH_COMMAND.name) for p in participants],
        "unlatch_command": [place_of(p.input_layout, UNLATCH_COMMAND.name) for p in participants],
        "impulses": [
            one
            for i, p in enumerate(participants)
            if IMPULSE.name in p.input_layout
            for one in (i, p.input_layout[IMPULSE.name].start)
        ],
        "lines": [len(latching), *(n for line in latching for n in _line(line, number))],
        "conditions": [observed_place(participants, condition) for condition in conditions],
        "condition_values": [n for condition in conditions for n in _passage(condition)],
        "strikes": [n for name, place in _penetrations(participants) for n in (number[name], place)],
        "recorded": recorded_places(participants),
        "corrected": [place for name, pair in pairs if name not in network.coarse for place in pair],
        "brought": [corrected for name, (_, corrected) in pairs if name in bodies],
        "signals": [signals],
    }


def place_of(layout: Any, name: str) -> int:  # noqa: ANN401 - a Layout
    """First place of a quantity, or NOWHERE."""
    return int(layout[name].start) if name in layout else NOWHERE


def is_hold_down(participant: Participant) -> bool:
    """Whether a participant can let go, so that a break of its law may be a release."""
    return RELEASE_COMMAND.name in participant.input_layout


def _with_firsts(participants: Sequence[Participant]) -> Iterator[tuple[Participant, int]]:
    firsts = first_observations(participants)
    return ((participant, firsts[participant.name]) for participant in participants)


def _by_tolerance(lines: Sequence[HingeLine], settings: Settings, order: Order) -> list[float]:
    """Numbers from which others follow by the tolerance, in the order of coupling.c."""
    locks = any(line.locks_rigid for line in lines)
    share, most, least = _ITERATED[order], _MOST_ITERATED, 0.0
    if locks:
        share, most, least = _LOCKED * share, _LOCKED * most, _LEAST_LOCKED
    return [settings.largest_step, settings.smallest_step, settings.start_step, share, least, most]


def _participants(network: Network) -> dict[str, ArrayLike]:
    wrench = network.width.wrench
    places = [*network.body_places, *network.connection_places]
    rows = [*(np.arange(r.start, r.stop) for r in network.rows), *network.connection_rows]
    return {
        "participants": [
            (
                carried(participant.input_layout, network.order),
                carried(participant.output_layout, network.order),
                place.ports,
                place.slopes or 0,
                place.moments or 0,
                float(participant.prescribed_motion),
                float(participant.constant_mobility and not participant.prescribed_motion),
            )
            for participant, place in zip(network.participants, places, strict=True)
        ],
        "port_links": np.concatenate([np.zeros(0), *(found[::wrench] // wrench for found in rows)]),
        "constant_mobility": [float(body.constant_mobility) for body in network.bodies],
        "energy_rows": energy_rows(network.participants),
    }


def _linear_system(network: Network) -> dict[str, ArrayLike]:
    still = frozenset(i for i, body in enumerate(network.bodies) if body.prescribed_motion)
    rigid = frozenset(i for i, body in enumerate(network.bodies) if body.constant_mobility) - still
    order = eliminate(network.meetings, network.width.wrench, still, rigid)
    first = len(network.bodies)
    return {
        "links": [
            (m.body, m.body_port, first + m.connection, m.connection_port, place)
            for m, place in zip(network.meetings, order.place.tolist(), strict=True)
        ],
        "matrix_length": [order.length],
        "matrix_begin": order.begin,
        "matrix_blocks": order.blocks,
        "matrix_lower": order.lower,
        "matrix_upper": order.upper,
        "matrix_lower_begin": order.lower_begin,
        "matrix_upper_begin": order.upper_begin,
        "matrix_targets": order.targets,
        "matrix_parts": order.parts,
    }


def _laws(participants: Sequence[Participant]) -> dict[str, ArrayLike]:
    """Participants with times to breaks and the places of these outputs, hold-downs first; number of hold-downs."""
    telling = [
        (k, p.output_layout[TIME_TO_BREAK.name].start)
        for k, p in enumerate(participants)
        if TIME_TO_BREAK.name in p.output_layout
    ]
    bolts = [one for one in telling if is_hold_down(participants[one[0]])]
    found = [*bolts, *(one for one in telling if one not in bolts)]
    return {"laws": [number for one in found for number in one], "bolts": [len(bolts)]}


def _line(line: HingeLine, number: Mapping[str, int]) -> list[int]:
    """Hinges of a line, the sensor first, as the first hinge that is not released is the sensor."""
    hinges = [line.sensor, *(name for name in line.hinges if name != line.sensor)]
    return [len(hinges), int(line.kinematic), *(number[name] for name in hinges)]


def observed_place(participants: Sequence[Participant], condition: Condition) -> int:
    """Place of the quantity of a condition among the observations of all."""
    part = next(p for p in participants if p.name == condition.part)
    first = first_observations(participants)[condition.part]
    return first + int(part.observation_layout[condition.variable].start) + condition.index


def _passage(condition: Condition) -> tuple[float, float]:
    """The value, and the divisor of distances to it: positive before it is passed, relative if it is large."""
    size = max(1.0, abs(condition.value))
    return condition.value, size if condition.rising else -size


def _penetrations(participants: Sequence[Participant]) -> Iterator[tuple[str, int]]:
    """Names of stops and contacts, and the place of each penetration among the observations of all."""
    for participant, first in _with_firsts(participants):
        layout = participant.observation_layout
        for quantity in layout.quantities:
            if quantity.role == PENETRATION:
                yield participant.name, first + layout[quantity.name].start
