"""Tables of one FMU of a scene in addition to those of its coupling, for `fmus/native/coupling/assembly_model.c`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import nan
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from components import REGISTRY
from components.contract.roles import FAILURE_COMMAND, RELEASE_COMMAND

from ...assembly import Assembly, Event, HingeLine, Part
from ...cosim.network import Network
from ...cosim.participant import Participant, first_observations
from ...cosim.settings import Settings
from ...cosim.tables import coupling_tables, place_of

DRIVEN = "driven_base"
_ANGULAR_RATE = "angular_rate"
_LATCHES, _RELEASES, _UNLATCHES = range(3)
"""Kinds of commands, as in assembly_model.h."""


class Command(NamedTuple):
    """What an input does: it releases a participant, by number and place among its inputs, or latches a line.

    unlatches: it opens the latches of the line while it is 1.
    """

    release: tuple[int, int] | None
    line: int
    unlatches: bool = False


class Peak(NamedTuple):
    """A load whose peak is recorded: indices of the observations of its summands, or of its components."""

    places: Sequence[int]
    is_sum: bool


def tables(
    network: Network,
    assembly: Assembly,
    lines: Sequence[HingeLine],
    settings: Settings,
    commands: Sequence[Command],
    peaks: Sequence[Peak],
    flags: Sequence[int],
) -> Mapping[str, ArrayLike]:
    """All of them; lines: those that latch; flags: places of those among what is recorded."""
    number = {participant.name: i for i, participant in enumerate(network.participants)}
    firsts = first_observations(network.participants)
    conditions = [event.condition for event in assembly.events if event.condition is not None]
    return {
        **coupling_tables(network, assembly.hinge_lines, conditions, settings),
        "angular_rate": [
            firsts[p.name] + place_of(p.observation_layout, _ANGULAR_RATE) for p in network.participants
        ],
        **_events(network, assembly.events, [line.name for line in lines], number),
        "driven": _driven(network, assembly, len(commands)),
        "flags": flags,
        "commands": [n for command in commands for n in _command(command)],
        "peaks": [
            len(peaks),
            *(n for peak in peaks for n in (int(peak.is_sum), len(peak.places), *peak.places)),
        ],
    }


def _driven(network: Network, assembly: Assembly, first: int) -> list[int]:
    """Whether the base is driven, and where its inputs, rates and accelerations are; first: of its inputs among all."""
    for number, body in enumerate(network.bodies):
        if _kind(assembly, body.name) == DRIVEN:
            states = REGISTRY[DRIVEN](**_part(assembly, body.name).structure).state_layout
            rates = (
                states[name].start
                for name in ("velocity", "angular_velocity", "acceleration", "angular_acceleration")
            )
            return [1, number, body.input_layout["acceleration_rate"].start, *rates, first]
    return [0] * 8


def _part(assembly: Assembly, name: str) -> Part:
    return next(part for part in assembly.parts if part.name == name)


def _kind(assembly: Assembly, name: str) -> str:
    return _part(assembly, name).kind


def _events(
    network: Network, events: Sequence[Event], lines: Sequence[str], number: Mapping[str, int]
) -> dict[str, ArrayLike]:
    numbers, values, conditions = [len(events)], [], 0
    for event in events:
        conditions += event.condition is not None
        releases = [one for name in event.releases for one in _releases(network.by_name[name], number[name])]
        settings = [
            (number[s.part], place, value)
            for s in event.settings
            for place, value in _scalars(network.by_name[s.part], s.parameter, s.value)
        ]
        waits_for = 0 if event.condition is None else conditions
        opened = [(name, 1) for name in event.unlatches] + [(name, 0) for name in event.readies]
        numbers += [waits_for, len(releases), len(event.latches), len(opened), len(settings)]
        numbers += [n for one in releases for n in one]
        numbers += [lines.index(name) for name in event.latches]
        numbers += [n for name, is_open in opened for n in (lines.index(name), is_open)]
        numbers += [n for part_number, place, _ in settings for n in (part_number, place)]
        values += [nan if event.time is None else event.time, *(value for _, _, value in settings)]
    return {"events": numbers, "event_values": values}


def _releases(participant: Participant, number: int) -> Iterator[tuple[int, int]]:
    for name in (RELEASE_COMMAND.name, FAILURE_COMMAND.name):
        if name in participant.input_layout:
            yield number, participant.input_layout[name].start


def _scalars(participant: Participant, name: str, value: ArrayLike) -> Iterator[tuple[int, float]]:
    where = participant.parameter_layout[name]
    values = np.broadcast_to(np.asarray(value, dtype=float), (where.stop - where.start,))
    return zip(range(where.start, where.stop), values.tolist(), strict=True)


def _command(command: Command) -> tuple[int, int, int]:
    if command.release is not None:
        return _RELEASES, *command.release
    return (_UNLATCHES if command.unlatches else _LATCHES), command.line, 0
