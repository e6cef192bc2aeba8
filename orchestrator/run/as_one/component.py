"""A scene as one component: what it shows of its components, and the data that its native kernel reads."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from components import REGISTRY, Component, ComponentError, Layout, Quantity
from components.contract.ports import Terminal, TerminalMember
from components.contract.quantity import Vector
from components.contract.roles import (
    FAILURE_COMMAND,
    INTERFACE_LOAD,
    LATCH_COMMAND,
    LATCHED,
    LOAD,
    RELEASE_COMMAND,
    UNLATCH_COMMAND,
)
from components.end_stop import OF_HINGE
from fmus.compiled import component_data
from fmus.native.compile import ASSEMBLY

from ...assembly import Assembly, HingeLine, Part
from ...assembly.signal_fmus import MEETS_RATES
from ...cosim.network import Network
from ...cosim.participant import InProcess
from ...cosim.ports import Order
from ...cosim.rows import recorded_layout
from ...cosim.settings import Settings
from ...scene.schema import TOLERANCES
from .initial_equilibrium import rest
from .tables import DRIVEN, Command, Peak, tables

_TOLD = (
    Quantity("stored_energy", "J", "Kinetic and potential energy of all components"),
    Quantity("dissipated_energy", "J", "Energy dissipated by all components since the start"),
    Quantity(
        "numerical_dissipation", "J", "Energy taken by the scheme itself since the start, not a physical loss"
    ),
    Quantity("supplied_energy", "J", "Work put in from outside, such as by drives, since the start"),
    Quantity("energy_residual", "J", "Stored and lost less supplied energy, minus their value at the start"),
    Quantity(
        "steps",
        "1",
        "Steps that the master has made, some of them ahead of the communication point",
        variability="discrete",
        kind="integer",
    ),
    Quantity(
        "rejected_steps",
        "1",
        "Steps that it has made again with a smaller size",
        variability="discrete",
        kind="integer",
    ),
)
"""Outputs that come first, in the order of native/coupling/assembly.c."""
ERRORS = ("numerical_dissipation", "energy_residual", "steps", "rejected_steps")
"""Outputs that say how a run was made, not what the scene does."""
_DRIVES = (
    ("velocity", "m/s", "velocity of the frame"),
    ("angular_velocity", "rad/s", "angular velocity of the frame"),
    ("acceleration", "m/s2", "acceleration of the frame"),
    ("angular_acceleration", "rad/s2", "angular acceleration of the frame"),
)
_CARRIED = (
    ("appendage_mass", "kg", "mass of all bodies of the scene", 1),
    ("appendage_center_of_mass", "m", "centre of mass of these, from the origin of the frame, its axes", 3),
    (
        "appendage_inertia",
        "kg.m2",
        "inertia tensor of these as one rigid body about the origin of the frame, its axes: xx, yy, zz, xy, xz, yz",
        6,
    ),
)
"""Observations that come last, in the order of native/coupling/appendage.h."""
_FRAME = ("frame_position", "frame_orientation")
_PEAKED = (LOAD, INTERFACE_LOAD)
_TOLERANCE = Quantity(
    "tolerance",
    "1",
    "Relative accuracy that steps are chosen for; an experiment's takes its place unless another was set before",
    minimum=TOLERANCES[0],
    maximum=TOLERANCES[1],
    variability="fixed",
)
"""The last parameter, as the native core expects of what `steps_inside`."""
_MEETS_RATES = Quantity(
    MEETS_RATES,
    "1",
    "true: at the end of a step the base has the rates given before it, by constant accelerations; false: they are "
    "those of its beginning, and what follows is extrapolated",
    minimum=0.0,
    maximum=1.0,
    variability="fixed",
    kind="boolean",
)
"""Of a driven base, the last parameter but one."""
_INITIAL = "initial_"
_ORDER, _LATCH_TORQUE, _ANGLE = "order", "latch_torque", "angle"
_FLOWS = ("interface_force", "interface_torque")


class AssembledScene(Component, registered=False):
    """A deployable structure with the master that couples its components, which steps as its tolerance asks.

    Parameters are those of all components, `component.parameter`; outputs what is observed of them, latch times and
    peaks of loads. Inputs command latches of hinge lines and releases, and drive the base where it is a driven one. A
    scene with preload starts in the static equilibrium of the parameters that it was made with.
    """

    kind = ASSEMBLY
    noun = "deployable structure"
    observes_inputs = False
    starts_from_inputs = False

    def __init__(self, assembly: Assembly, settings: Settings, order: Order | None = None) -> None:
        for part in assembly.parts:
            if REGISTRY[part.kind].comes_from_outside():
                raise ComponentError(
                    f"{part.name}: a {part.kind} comes from outside and has no native kernel"
                )
        events = [one for one in assembly.events if one.condition is None or not one.condition.is_sampled]
        assembly = replace(assembly, events=tuple(events))  # those of FMUs stay outside, as these do
        self._made = [(part, REGISTRY[part.kind](**part.structure)) for part in assembly.parts]
        made = [InProcess(p.name, c, p.start) for p, c in self._made]
        network = Network.ordered(made, assembly.links, order)
        self._names = [participant.name for participant in network.participants]
        by_name = {part.name: (part, component) for part, component in self._made}
        self._parts = [by_name[name] for name in self._names]
        lines = tuple(line for line in assembly.hinge_lines if line.latches)
        commands = [*_latch_commands(lines), *_release_commands(network)]
        observed = [recorded_layout(component.observation_layout) for _, component in self._parts]
        peaks = list(_peaks(self._names, observed, lines))
        self.returns_early = bool(lines or assembly.events)
        self._orders = {name: network.order_of(name) for name in self._names}
        self._tolerance, self._rests = settings.tolerance, assembly.preload
        ports = (network.port_of_row(network.width.wrench * link) for link in range(len(network.meetings)))
        self._texts = {f"link:{number}": port.encode() for number, port in enumerate(ports)}
        self._texts |= {
            f"event:{number}": event.name.encode() for number, event in enumerate(assembly.events)
        }
        self._tables = {
            **tables(
                network,
                assembly,
                lines,
                settings,
                [command for command, _ in commands],
                [peak for peak, _ in peaks],
                list(_flags(observed)),
            ),
            **_masses(self._names, observed, self._parts),
            "angles": list(_angles(self._names, observed, assembly.hinge_lines)),
            **rest(assembly, settings, network.order),
        }
        self._declare(
            {},
            (),
            parameters=(
                *self._as_here(_of_parts(self._names, [c.parameter_layout for _, c in self._parts])),
                *([_MEETS_RATES] if _is_driven(assembly) else ()),
                _TOLERANCE,
            ),
            inputs=[*(quantity for _, quantity in commands), *_drives(assembly)],
            outputs=(
                *_TOLD,
                *(q for line in lines for q in _told_of(line)),
                *(_angle_of(line) for line in assembly.hinge_lines),
                *(quantity for _, quantity in peaks),
            ),
            observations=[*_of_parts(self._names, observed), *_carried(assembly)],
        )
        known = [*self.output_layout.quantities, *self.observation_layout.quantities]
        self.terminals = tuple(_terminals(assembly, self.input_layout.quantities, known))

    def _as_here(self, parameters: Iterable[Quantity]) -> Iterator[Quantity]:
        """What is the master's stays: a component of another order or scheme would not fit; and where all starts."""
        for one in parameters:
            if one.name.endswith(f".{_ORDER}"):
                order = self._orders[one.name.removesuffix(f".{_ORDER}")]
                yield replace(one, minimum=order, maximum=order)
            elif self._rests and f".{_INITIAL}" in one.name:
                yield one.saying(f"{one.description}; does nothing, as all starts in static equilibrium")
            else:
                yield one

    def start(self) -> dict[str, tuple[float, ...]]:
        """Start values of all parameters, by name."""
        found: dict[str, tuple[float, ...]] = {_TOLERANCE.name: (self._tolerance,)}
        for name, (part, component) in zip(self._names, self._parts, strict=True):
            for quantity in component.parameter_layout.quantities:
                given = part.start.get(quantity.name, quantity.start)
                if quantity.name == _ORDER:
                    given = self._orders[name]
                found[f"{name}.{quantity.name}"] = tuple(np.broadcast_to(given, (quantity.size,)).tolist())
        return found

    def components(self) -> Iterator[tuple[str, Component]]:
        """Components by name, bodies before connections, in the order of their observations."""
        return ((name, component) for name, (_, component) in zip(self._names, self._parts, strict=True))

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Tables of the network and numbers of the master."""
        return self._tables

    def native_parts(self) -> Mapping[str, bytes]:
        """The data of every component, bodies before connections, and their names."""
        found: dict[str, bytes] = {}
        for number, (name, (part, component)) in enumerate(zip(self._names, self._parts, strict=True)):
            found[f"part:{number}"] = component_data(component, part.start)
            found[f"name:{number}"] = name.encode()
        return found | self._texts

    def prepare(self, p: Vector) -> Any:  # noqa: ANN401
        """Have every component check its parameters; ComponentError with the name of the one that refuses."""
        first = 0
        for name, (_, component) in zip(self._names, self._parts, strict=True):
            size = component.parameter_layout.size
            try:
                component.check_ranges(p[first : first + size])
                component.prepare(p[first : first + size])
            except ComponentError as error:
                raise ComponentError(f"{name}: {error}") from None
            first += size

    def _only_native(self, *_: object) -> Vector:
        raise ComponentError(
            "a scene as one component runs in its native FMU; in Python its master couples FMUs"
        )

    initial = step = outputs = observe = _only_native  # type: ignore[assignment]

    @classmethod
    def example(cls) -> Self:
        """There is none without a scene."""
        raise ComponentError("a scene as one component is made of a scene")


def _of_parts(names: Sequence[str], layouts: Iterable[Layout]) -> Iterator[Quantity]:
    """Quantities of all components under the names that say whose they are."""
    for name, layout in zip(names, layouts, strict=True):
        for quantity in layout.quantities:
            yield replace(
                quantity, name=f"{name}.{quantity.name}", description=f"{name}: {quantity.description}"
            )


def _flags(layouts: Iterable[Layout]) -> Iterator[int]:
    """Places of flags among the observations of all components."""
    first = 0
    for layout in layouts:
        for quantity in layout.quantities:
            if quantity.variability == "discrete":
                yield first + layout[quantity.name].start
        first += layout.size


def _angles(names: Sequence[str], layouts: Sequence[Layout], lines: Sequence[HingeLine]) -> Iterator[int]:
    """Places of the angles of lines among the observations of all components."""
    firsts = dict(zip(names, np.cumsum([0, *(layout.size for layout in layouts)]).tolist(), strict=False))
    of_names = dict(zip(names, layouts, strict=True))
    return (firsts[line.sensor] + of_names[line.sensor][_ANGLE].start for line in lines)


def _masses(
    names: Sequence[str], layouts: Sequence[Layout], parts: Sequence[tuple[Part, Component]]
) -> Mapping[str, ArrayLike]:
    """Places of the frame of a driven base and of all masses among the observations, and the masses."""
    firsts = np.cumsum([0, *(layout.size for layout in layouts)]).tolist()
    frame, places, values = [], [], []
    for first, layout, (part, component) in zip(firsts, layouts, parts, strict=False):
        if part.kind == DRIVEN:
            frame = [first + layout[name].start for name in _FRAME]
        for mass in component.masses():
            places += [first + place for place in (*mass.ends, mass.orientation)]
            values += [mass.mass, *mass.center_of_mass.tolist(), *mass.inertia.ravel().tolist()]
    return {"masses": [*frame, *places] if frame else [], "mass_values": values}


def _latch_commands(lines: Sequence[HingeLine]) -> Iterator[tuple[Command, Quantity]]:
    for number, line in enumerate(lines):
        for command, unlatches, text in (
            (LATCH_COMMAND, False, "1: its latches engage at this communication point"),
            (
                UNLATCH_COMMAND,
                True,
                "1: its latches let go at this communication point; 0: they may engage again",
            ),
        ):
            quantity = command.called(f"{line.name}.{command.name}")
            yield Command(None, number, unlatches), quantity.saying(f"{line.name}: {text}")


def _release_commands(network: Network) -> Iterator[tuple[Command, Quantity]]:
    for number, participant in enumerate(network.participants):
        for command in (RELEASE_COMMAND, FAILURE_COMMAND):
            if command.name in participant.input_layout:
                place = participant.input_layout[command.name].start
                quantity = command.called(f"{participant.name}.{command.name}")
                text = f"{participant.name}: 1: lets go at this communication point, for good"
                if (stop := participant.name + OF_HINGE) in network.by_name:
                    text += f"; {stop} has a command of its own"
                yield Command((number, place), 0), quantity.saying(text)


def _is_driven(assembly: Assembly) -> bool:
    return any(part.kind == DRIVEN for part in assembly.parts)


def _drives(assembly: Assembly) -> Iterator[Quantity]:
    """Rates of a driven base at a communication point, and their rates."""
    for name in (part.name for part in assembly.parts if part.kind == DRIVEN):
        for variable, unit, text in _DRIVES:
            yield Quantity(
                f"{name}.{variable}", unit, f"{name}: {text} at the communication point, world axes", 3
            )


def _carried(assembly: Assembly) -> Iterator[Quantity]:
    """Mass properties of what a driven base carries."""
    for name in (part.name for part in assembly.parts if part.kind == DRIVEN):
        for variable, unit, text, size in _CARRIED:
            yield Quantity(f"{name}.{variable}", unit, f"{name}: {text}", size)


def _told_of(line: HingeLine) -> Iterator[Quantity]:
    yield Quantity(
        f"{line.name}.latch_time",
        "s",
        f"{line.name}: time of latch-up since the start time; -1 before",
        start=-1.0,
        variability="discrete",
    )
    yield Quantity(
        f"{line.name}.latch_rate",
        "rad/s",
        f"{line.name}: size of its rate just before latch-up; 0 before",
        variability="discrete",
    )
    yield LATCHED.called(f"{line.name}.{LATCHED.name}").saying(f"{line.name}: {LATCHED.description}")


def _angle_of(line: HingeLine) -> Quantity:
    return Quantity(f"{line.name}.{_ANGLE}", "rad", f"{line.name}: angle of its sensor, {line.sensor}")


def _terminals(
    assembly: Assembly, inputs: Sequence[Quantity], known: Sequence[Quantity]
) -> Iterator[Terminal]:
    """The base that a host drives, with its loads, and every hinge line."""
    driving = [quantity.name for quantity in inputs]
    others = [quantity.name for quantity in known]
    for base in (part.name for part in assembly.parts if part.kind == DRIVEN):
        told = (f"{base}.interface_", f"{base}.appendage_")
        loads = [name for name in others if name.startswith(told) and not name.endswith("_peak")]
        members = (
            *(_member(base, name, "signal") for name in driving if name.startswith(f"{base}.")),
            *(_member(base, name, "outflow" if name.endswith(_FLOWS) else "signal") for name in loads),
        )
        text = f"Motion of the base {base}, loads of the wing on it, mass properties of the wing"
        yield Terminal(base, "driven-base", text, members, "bus")
    for line in assembly.hinge_lines:
        found = [name for name in (*driving, *others) if name.startswith(f"{line.name}.")]
        members = tuple(_member(line.name, name, "signal") for name in found)
        yield Terminal(line.name, "hinge-line", f"Hinge line {line.name}", members, "bus")


def _member(owner: str, name: str, kind: Literal["signal", "outflow"]) -> TerminalMember:
    return TerminalMember(name.removeprefix(f"{owner}."), name, kind)


def _peaks(
    names: Sequence[str], layouts: Sequence[Layout], lines: Sequence[HingeLine]
) -> Iterator[tuple[Peak, Quantity]]:
    """Latch torques of lines and loads of components, whose peaks are recorded."""
    firsts = dict(zip(names, np.cumsum([0, *(layout.size for layout in layouts)]).tolist(), strict=False))
    of_names = dict(zip(names, layouts, strict=True))
    for line in lines:
        torques = [
            firsts[h] + of_names[h][_LATCH_TORQUE].start for h in line.hinges if _LATCH_TORQUE in of_names[h]
        ]
        text = f"{line.name}: largest sum so far of the latch torques of its hinges"
        yield Peak(torques, True), Quantity(f"{line.name}.{_LATCH_TORQUE}_peak", "N.m", text)
    for name, layout in of_names.items():
        for quantity in layout.quantities:
            if quantity.role in _PEAKED:
                first = firsts[name] + layout[quantity.name].start
                text = f"{name}: largest so far of: {quantity.description}"
                yield (
                    Peak(range(first, first + quantity.size), False),
                    Quantity(f"{name}.{quantity.name}_peak", quantity.unit, text),
                )
