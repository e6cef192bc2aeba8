"""What the native master of a scene as one FMU reads, `fmus/native/coupling/assembly_model.h`: tables by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from components import REGISTRY, ComponentError
from components.contract.roles import (
    FAILURE_COMMAND,
    IMPULSE,
    LATCH_COMMAND,
    LATCH_DISTANCE,
    RELEASE_COMMAND,
)

from ...assembly import Assembly, Event, HingeLine, Part
from ...cosim import energy_guard, stepping
from ...cosim.energy_balance import energy_rows
from ...cosim.events.breaks import is_hold_down, place_of_break
from ...cosim.events.contact_onset import penetrations
from ...cosim.implicit import convergence
from ...cosim.implicit.elimination import eliminate
from ...cosim.implicit.local_error import NO_LOAD
from ...cosim.native.fields import constant
from ...cosim.network import Network
from ...cosim.participant import Participant, first_observations
from ...cosim.ports import Order, carried
from ...cosim.rows import Rows
from ...cosim.settings import Settings
from ...results.recorder import NoRecorder

_NOWHERE = 10**8
"""Place of what a participant does not have."""
DRIVEN = "driven_base"
_ANGULAR_RATE = "angular_rate"
_MOST_HINGES = constant("MOST_HINGES")
_STILL = ("fixed_base", "moving_base", DRIVEN)


class Command(NamedTuple):
    """What an input does: it releases a participant, by number and place among its inputs, or latches a line."""

    release: tuple[int, int] | None
    line: int


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
    still = frozenset(i for i, body in enumerate(network.bodies) if _kind(assembly, body.name) in _STILL)
    firsts = first_observations(network.participants)
    return {
        **_master(network, assembly, settings),
        **_network(network, still),
        **_linear_system(network, still),
        **_recorded(network),
        "latch_distance": [_place(p.output_layout, LATCH_DISTANCE.name) for p in network.participants],
        "angular_rate": [
            firsts[p.name] + _place(p.observation_layout, _ANGULAR_RATE) for p in network.participants
        ],
        "latch_command": [_place(p.input_layout, LATCH_COMMAND.name) for p in network.participants],
        "impulses": [
            one
            for i, p in enumerate(network.participants)
            if IMPULSE.name in p.input_layout
            for one in (i, p.input_layout[IMPULSE.name].start)
        ],
        "strikes": [n for name, place in penetrations(network.participants) for n in (number[name], place)],
        "lines": [len(lines), *(n for line in lines for n in _line(line, number))],
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


def _place(layout: Any, name: str) -> int:  # noqa: ANN401 - a Layout
    return int(layout[name].start) if name in layout else _NOWHERE


def _master(network: Network, assembly: Assembly, settings: Settings) -> dict[str, ArrayLike]:
    """Numbers in the order of the structures of the library."""
    order = network.order
    iteration = convergence.Tolerance.beside(settings.driving.load, 0.0)
    return {
        "network": [
            len(network.participants),
            len(network.bodies),
            len(network.meetings),
            order,
            network.width.wrench,
        ],
        "limits": [
            convergence.SLOW,
            convergence.DIVERGED,
            convergence.STEEPEST,
            convergence.ROUND_OFF,
            convergence.NEAR,
            convergence.CREDIBLE,
            convergence.AGREED,
            convergence.OVERSHOT,
            convergence.ROUGH,
            convergence.LEAST_REACH,
            NO_LOAD,
            convergence.PATIENCE,
            convergence.MAX_ITERATIONS,
            convergence.HALVINGS,
            *convergence.REFRESHED,
        ],
        "rules": [
            stepping.RATIO,
            stepping.REJECTED,
            stepping.REJECTED_STIRRED,
            stepping.FORGET,
            stepping.GROWTH_MARGIN,
            stepping.LEAST_ERROR,
            stepping.STIRRED_STEPS,
            stepping.STEPS_AFTER_GROWTH,
            stepping.STEPS_AFTER_SHRINKING,
            stepping.MOST_LEVELS,
            stepping.MOST_GROWTH,
            stepping.STEPS_AFTER_DIVISION,
            energy_guard.SHARE,
            energy_guard.ROUNDED,
            energy_guard.STEADY,
            energy_guard.ALLOWANCE,
            stepping.TIME_ROUNDING,
            stepping.BREAK_REACHED,
            stepping.STRETCHED,
            stepping.SHARED,
        ],
        "master": [
            iteration.force,
            iteration.torque,
            order,
            settings.driving.energy,
        ],
        "by_tolerance": _by_tolerance(assembly, settings, order),
    }


def _by_tolerance(assembly: Assembly, settings: Settings, order: Order) -> list[float]:
    """What numbers follow from the tolerance by."""
    return [
        settings.largest_step,
        settings.smallest_step,
        settings.start_step,
        stepping.REFERENCE_TOLERANCE,
        *stepping.iterated(assembly.hinge_lines, order),
        stepping.ALLOWED_SHARE,
        stepping.LOOSE[order],
        stepping.LOOSE[2],
    ]


def _network(network: Network, still: frozenset[int]) -> dict[str, ArrayLike]:
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
                float(number in still),
            )
            for number, (participant, place) in enumerate(zip(network.participants, places, strict=True))
        ],
        "port_links": np.concatenate([found[::wrench] // wrench for found in rows]),
        "constant_mobility": [float(body.constant_mobility) for body in network.bodies],
        "energy_rows": energy_rows(network.participants),
        **_laws(network),
    }


def _laws(network: Network) -> dict[str, ArrayLike]:
    """Participants that tell times to breaks, and where among their outputs; hold-downs, and how many, come first."""
    places = {k: place_of_break(p) for k, p in enumerate(network.participants)}
    telling = [(k, place) for k, place in places.items() if place is not None]
    bolts = [one for one in telling if is_hold_down(network.participants[one[0]])]
    found = [*bolts, *(one for one in telling if one not in bolts)]
    return {"laws": [number for one in found for number in one], "bolts": [len(bolts)]}


def _linear_system(network: Network, still: frozenset[int]) -> dict[str, ArrayLike]:
    order = eliminate(network.meetings, network.width.wrench, still)
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


def _recorded(network: Network) -> dict[str, ArrayLike]:
    size = sum(p.observation_layout.size for p in network.participants)
    rows = Rows(NoRecorder(), network.participants, np.zeros(size + 1), np.zeros(0), network.coarse)
    return {"recorded": rows.recorded, "corrected": rows.corrections}


def _line(line: HingeLine, number: Mapping[str, int]) -> list[int]:
    """Hinges, the sensor first, as it stays while it is not released."""
    if len(line.hinges) > _MOST_HINGES:
        raise ComponentError(
            f"{line.name} has {len(line.hinges)} hinges; one FMU of a scene takes {_MOST_HINGES} a line"
        )
    hinges = [line.sensor, *(name for name in line.hinges if name != line.sensor)]
    return [len(hinges), int(line.kinematic), *(number[name] for name in hinges)]


def _events(
    network: Network, events: Sequence[Event], lines: Sequence[str], number: Mapping[str, int]
) -> dict[str, ArrayLike]:
    firsts = first_observations(network.participants)
    numbers, values = [len(events)], []
    for event in events:
        condition, place = event.condition, 0
        values += [nan if event.time is None else event.time, 0.0, 1.0]
        if condition is not None:
            part = network.by_name[condition.part]
            place = firsts[condition.part]
            place += part.observation_layout[condition.variable].start + condition.index
            size = max(1.0, abs(condition.value))
            values[-2:] = [condition.value, size if condition.rising else -size]
        releases = [one for name in event.releases for one in _releases(network.by_name[name], number[name])]
        settings = [
            (number[s.part], place, value)
            for s in event.settings
            for place, value in _scalars(network.by_name[s.part], s.parameter, s.value)
        ]
        numbers += [place, len(releases), len(event.latches), len(settings)]
        numbers += [n for one in releases for n in one]
        numbers += [lines.index(name) for name in event.latches]
        numbers += [n for part_number, place, _ in settings for n in (part_number, place)]
        values += [value for _, _, value in settings]
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
    return (0, command.line, 0) if command.release is None else (1, *command.release)
