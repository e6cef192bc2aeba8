"""Events of a scene, checked against what the components of its parts declare."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from math import inf
from typing import Any

from components import LAGGED, Component, ComponentError, Quantity
from components.contract.errors import unknown
from components.contract.roles import (
    CUT,
    FAILURE_COMMAND,
    LATCH_COMMAND,
    RELEASE_COMMAND,
    UNLATCH_COMMAND,
)
from components.drive import Drive
from components.end_stop import OF_HINGE, EndStop
from components.point_motion import PointMotion

from ..scene.component_connections import in_range, number_of, value_of
from ..scene.event_tables import Event as EventTable
from ..scene.event_tables import When
from ..scene.placed_scene import PlacedScene
from ..scene.signal_tables import Fmu
from ..scene.table import SceneError
from . import Condition, Event, HingeLine, Part, Setting, SignalFmu

RELEASES = (RELEASE_COMMAND.name, FAILURE_COMMAND.name)
"""Inputs by which a component lets go."""
COMMANDS = (LATCH_COMMAND.name, UNLATCH_COMMAND.name, *RELEASES)
"""Inputs that scenes can command, by events and outputs of FMUs."""
_TRUE = 0.5
"""What an output of an FMU passes as it becomes true."""
_SCALAR = re.compile(r"([\w.]+)(?:\[(\d+)\])?")
_COUPLINGS = (Drive.kind, PointMotion.kind)
"""Components that lead by a law, through a stiffness and a damping."""
_OF_A_MOTOR_SPRING = ("motor_stiffness", "motor_wind_up", "motor_constant_torque")
"""Parameters of a hinge that do nothing where its motor is a table."""
_ACT_IN_LATCHES = {"latch_stiffness": ("spring",), "latch_damping": ("spring", "table")}
"""Kinds of latches that parameters of them act in."""
_MOTORS = {"motor_stiffness": "motor_constant_torque", "motor_constant_torque": "motor_stiffness"}
"""Parameters by which a motor drives, and the other one."""


def assembly_events(
    scene: PlacedScene, parts: Sequence[Part], lines: Sequence[HingeLine], fmus: Sequence[SignalFmu]
) -> tuple[Event, ...]:
    """The events of a scene, those of one time as one; SceneError with what its components do not know or cannot do.

    An output of an FMU that gives commands is an event when it becomes true.
    """
    reader = _EventReader(parts, lines, fmus)
    found = [reader.event(table) for table in scene.events]
    found += [event for fmu in scene.fmus for event in reader.commands(fmu)]
    events = _of_one_time(found)
    reader.problems += _released_and_locked(events, lines)
    if reader.problems:
        raise SceneError([f"{scene.file}: {problem}" for problem in dict.fromkeys(reader.problems)])
    return events


def _of_one_time(events: Sequence[Event]) -> tuple[Event, ...]:
    """Events; in place of the first of those that come at one time, which have no order, all of them."""
    found: dict[float | str, Event] = {}
    for event in events:
        key = event.name if event.time is None else event.time
        found[key] = found[key].with_another(event) if key in found else event
    return tuple(found.values())


def _released_and_locked(events: Sequence[Event], lines: Sequence[HingeLine]) -> Iterator[str]:
    """Problems of events that lock what they let go of."""
    hinges = {line.name: line.hinges for line in lines}
    for event in events:
        for line in (*event.latches, *event.readies):
            if line in event.unlatches:
                yield f"event.{event.name}: opens the latch of {line} and closes it; leave one of both out"
        for line in event.latches:
            if set(hinges[line]) <= set(event.releases):
                yield f"event.{event.name}: locks {line}, which it releases as well; leave one of both out"


class _EventReader:
    """Reads events against parts, and gathers what is wrong with them."""

    def __init__(self, parts: Sequence[Part], lines: Sequence[HingeLine], fmus: Sequence[SignalFmu]) -> None:
        self._fmus = {fmu.name: fmu for fmu in fmus}
        self.problems: list[str] = []
        self._parts = {part.name: part for part in parts}
        self._lines = {line.name: line for line in lines}

    def event(self, table: EventTable) -> Event:
        """The event of a table; where there are problems, what is left of it."""
        key = f"event.{table.name}"
        condition = None if table.when is None else self._condition(f"{key}.when", table.when)
        found = Event(table.name, table.time, condition)
        for name in table.release:
            for part in self._parts_of(f"{key}.release", name):
                found = self._released(f"{key}.release", found, part)
        for name, variables in table.set.items():
            for part in self._parts_of(f"{key}.set.{name}", name):
                found = self._with_settings(f"{key}.set.{name}", found, part, variables)
        return found

    def commands(self, fmu: Fmu) -> Iterator[Event]:
        """An event for each output of an FMU that gives commands."""
        recorded = self._fmus[fmu.name].recorded()
        for output in fmu.outputs:
            targets = [target.rpartition(".")[::2] for target in fmu.targets(output)]
            commands = [(name, command) for name, command in targets if command in COMMANDS]
            condition = Condition(fmu.name, recorded[output].name, 0, _TRUE, True, True)
            event, key = Event(f"{fmu.name}.{output}", None, condition), f"fmu.{fmu.name}.outputs.{output}"
            for name, command in commands:
                for part in self._parts_of(key, name):
                    try:
                        event = self._commanded(event, part, command, 1)
                    except ValueError as error:
                        self.problems.append(f"{key}: {error}")
            if commands:
                yield event

    def _parts_of(self, key: str, name: str) -> Iterator[Part]:
        """The part of a name, or those of a line."""
        for one in self._lines[name].hinges if name in self._lines else (name,):
            if one in self._parts:
                yield self._parts[one]
            else:
                self.problems.append(
                    f"{key}: {one} is held or within a piece of held lines, so it does not take part in the run"
                )

    def _released(self, key: str, event: Event, part: Part) -> Event:
        """With a part that lets go, or is cut."""
        component = part.component()
        if any(command in component.input_layout for command in RELEASES):
            return event.also(releases=self._with_stop(part))
        if CUT.name in component.parameter_layout:
            return event.also(settings=(Setting(part.name, CUT.name, 1.0, CUT.unit),))
        if part.kind in _COUPLINGS:
            units = {q.name: q.unit for q in component.parameter_layout.quantities}
            return event.also(
                settings=tuple(Setting(part.name, x, 0.0, units[x]) for x in ("stiffness", "damping"))
            )
        self.problems.append(
            f"{key}: {part.name} is a {part.kind}, which cannot be released; hinges, hold-downs, cable loops, drives "
            "and point motions can. Set a parameter of it instead, such as a stiffness"
        )
        return event

    def _with_stop(self, part: Part) -> tuple[str, ...]:
        """Names of a part and of the end stop beside it, which goes with the hinge."""
        stop = self._parts.get(part.name + OF_HINGE)
        return (part.name, stop.name) if stop is not None and stop.kind == EndStop.kind else (part.name,)

    def _condition(self, key: str, when: When) -> Condition | None:
        name = self._lines[when.component].sensor if when.component in self._lines else when.component
        rising, given = when.below is None, when.above if when.below is None else when.below
        side = "above" if rising else "below"
        if (fmu := self._fmus.get(when.component)) is not None:
            quantity = fmu.recorded()[when.variable]
            try:
                value = _passed(quantity, given, rising)
                return Condition(fmu.name, quantity.name, 0, value, rising, True)
            except ValueError as error:
                self.problems.append(f"{key}.{side}: {error}")
                return None
        for part in self._parts_of(f"{key}.component", name):
            quantities = {
                q.name: q
                for q in part.component().observation_layout.quantities
                if not q.name.endswith(LAGGED)
            }
            try:
                quantity, index = scalar(when.variable, quantities, part.kind)
            except ValueError as error:
                self.problems.append(f"{key}.variable: {error}")
                continue
            try:
                return Condition(part.name, quantity.name, index, number_of(quantity, given), rising)
            except ValueError as error:
                self.problems.append(f"{key}.{side}: {error}")
        return None

    def _with_settings(self, key: str, event: Event, part: Part, variables: Mapping[str, Any]) -> Event:
        component = part.component()
        values = dict(part.start)
        for name, given in variables.items():
            try:
                if name in component.input_layout:
                    event = self._commanded(event, part, name, given)
                    continue
                quantity = tunable(name, component, part.kind)
                value = in_range(quantity, given, value_of(quantity, given))
                _check_motor(part, name, value, variables)
            except (ComponentError, ValueError) as error:
                self.problems.append(f"{key}.{name}: {error}")
                continue
            values[name] = value
            event = event.also(settings=(Setting(part.name, name, value, quantity.unit),))
        try:
            p = component.parameter_layout.start_values()
            for name, value in values.items():
                if name in component.parameter_layout:
                    p[component.parameter_layout[name]] = value
            component.prepare(p)
        except ComponentError as error:
            self.problems.append(f"{key}: {error}")
        return event

    def _commanded(self, event: Event, part: Part, name: str, given: object) -> Event:
        """With what a command stands for; ValueError where it is none that a scene can give."""
        line = next((line.name for line in self._lines.values() if part.name in line.hinges), None)
        if name not in COMMANDS:
            raise ValueError("is an input, which follows from the run; set tunable parameters")
        takes_back = name == UNLATCH_COMMAND.name and given == 0
        if not (given == 1 or takes_back):
            also = ", or taken back, with 0" if name == UNLATCH_COMMAND.name else ", but not taken back"
            raise ValueError(f"is {given!r}; commands can be given, with 1{also}")
        if name in RELEASES:
            return event.also(releases=self._with_stop(part))
        if line is None or not self._lines[line].latches:
            raise ValueError(f"{part.name} is no hinge of a line that has a latch")
        if name == LATCH_COMMAND.name:
            return event.also(latches=(line,))
        return event.also(readies=(line,)) if takes_back else event.also(unlatches=(line,))


def _passed(quantity: Quantity, given: object, rising: bool) -> float:
    """The value that an output of an FMU passes; ValueError for one that a Boolean never passes."""
    if quantity.kind != "boolean":
        return number_of(quantity, given)
    value = inf if isinstance(given, bool) else number_of(quantity, given)
    if not (0.0 <= value < 1.0 if rising else 0.0 < value <= 1.0):
        raise ValueError(f"is {given!r}; {quantity.name} is false or true, 0 or 1, so give {_TRUE}")
    return value


def scalar(name: str, quantities: Mapping[str, Quantity], kind: str) -> tuple[Quantity, int]:
    """The quantity of a scalar, and its place within it; ValueError where there is none."""
    found = _SCALAR.fullmatch(name)
    base, number = found.groups() if found else (name, None)
    if base not in quantities:
        raise ValueError(f"{name!r} {unknown(base, list(quantities), 'variable')} (of a {kind})")
    size = quantities[base].size
    if number is None and size > 1:
        raise ValueError(f"{name!r} has {size} components; write {base}[1] for the first")
    if number is not None and not 1 <= int(number) <= size:
        raise ValueError(f"{name!r} has no such component; {base} has {size}")
    return quantities[base], int(number or 1) - 1


def _check_motor(part: Part, name: str, value: object, set_with: Collection[str]) -> None:
    """ValueError where a torque of a motor is taken away that it does not have, or a spring wound up that is none."""
    if (
        name == "motor_wind_up"
        and not part.start.get("motor_stiffness")
        and "motor_stiffness" not in set_with
    ):
        raise ValueError("has no effect, as the motor is no spring; set its motor_stiffness with it")
    if name in _MOTORS and not value and not part.start.get(name):
        raise ValueError(f"is nothing already; what drives this hinge is {_MOTORS[name]}, if anything does")


def tunable(name: str, component: Component, kind: str) -> Quantity:
    """The parameter of a name; ValueError where there is none that can be set in mid-run."""
    known = {q.name: q for q in component.parameter_layout.quantities}
    free = [q.name for q in known.values() if q.variability == "tunable"]
    if name in _OF_A_MOTOR_SPRING and component.structure.get("motor_angle"):
        raise ValueError("has no effect, as the motor is a table; give it by its torques stowed and deployed")
    latch = component.structure.get("latch", "spring")
    if latch not in _ACT_IN_LATCHES.get(name, (latch,)):
        raise ValueError(f"has no effect, as the latch is {latch}")
    if name in free:
        return known[name]
    if name in known:
        raise ValueError(f"cannot be set in mid-run; of a {kind}, these can: {', '.join(free) or 'none'}")
    commands = [command for command in COMMANDS if command in component.input_layout]
    raise ValueError(f"{name!r} {unknown(name, [*free, *commands], 'parameter')} (of a {kind})")
