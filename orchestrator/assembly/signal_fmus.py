"""FMUs of other tools in a scene: what their variables are joined to, with units converted; and what they cannot be."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import isclose, isfinite
from operator import le
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from fmpy import read_model_description

from components import LAGGED, ComponentError, FanfoldError
from components.contract.errors import unknown
from fmus.archive import archive_problems
from fmus.description.binaries import binary_member, folder_here
from fmus.description.units import base_unit, has_root

from ..scene.placed_scene import PlacedScene
from ..scene.schema import SMALLEST_STEP
from ..scene.signal_tables import Fmu
from ..scene.table import SceneError
from . import HingeLine, Part, Signal, SignalFmu
from .events import COMMANDS, scalar, tunable

_NUMBERS = ("Real", "Float64", "Float32")
_WHOLE = ("Integer", "Enumeration", *(f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64)))
_BASE = ("kg", "m", "s", "A", "K", "mol", "cd")
"""Exponents that must agree; angles are ratios as well."""
_FACTOR = 1e-6
"""By which factors of one unit may differ: those of angles are written with seven digits."""
MEETS_RATES = "base_meets_rates"
"""Parameter of a scene as one FMU with a driven base."""
_ELEMENT = re.compile(r"(.+)\[([1-9]\d*(?:,[1-9]\d*)*)\]")
_ANGLE = re.compile(r"rad|deg|grad|°|gon|arc", re.IGNORECASE)
"""Names of angles. Many units say them by their name only, without an exponent of rad."""
_IMPULSES = {"N": "N.s", "N.m": "N.m.s"}
"""Units of impulses by those of loads."""


def signal_fmus(
    scene: PlacedScene, parts: Sequence[Part], lines: Sequence[HingeLine]
) -> tuple[SignalFmu, ...]:
    """The FMUs of a scene that have signals, in the order in which they step at one time.

    SceneError with everything that they or the components do not know.
    """
    problems: list[str] = []
    readers: dict[str, _Reader] = {}
    for table in scene.fmus:
        try:
            readers[table.name] = _Reader(table, parts, lines, readers, problems)
        except _NoFmuError as error:
            problems.append(f"fmu.{table.name}.file: {table.file} {error}")
    found = [reader.fmu() for reader in readers.values()]
    for event in scene.events:
        if (when := event.when) is not None and when.component in readers:
            try:
                readers[when.component].told(when.variable)
            except ValueError as error:
                problems.append(f"event.{event.name}.when.variable: {error}")
    problems += _set_twice(found)
    if problems:
        raise SceneError([f"{scene.file}: {problem}" for problem in problems])
    return _in_order([replace(fmu, told=readers[fmu.name].all_told()) for fmu in found])


def _in_order(fmus: Sequence[SignalFmu]) -> tuple[SignalFmu, ...]:
    """FMUs after those that they read; in a loop the first of the scene comes first."""
    left, found = list(fmus), []
    while left:
        waited_for = {fmu.name for fmu in left}
        free = (fmu for fmu in left if waited_for.isdisjoint(signal.part for signal in fmu.inputs))
        found.append(next(free, left[0]))
        left.remove(found[-1])
    return tuple(found)


def _set_twice(fmus: Sequence[SignalFmu]) -> Iterator[str]:
    """Parameters that more than one output sets, of which the last would win."""
    setters: dict[tuple[str, str, int], str] = {}
    for fmu in fmus:
        for signal in fmu.outputs:
            here, target = f"{fmu.name}.{signal.variable}", (signal.part, signal.quantity, signal.index)
            first = setters.setdefault(target, here)
            if first != here:
                yield (
                    f"fmu.{fmu.name}.outputs.{signal.variable}: {signal.part}.{signal.quantity} is set by {first} "
                    "already; one output sets a parameter, give each a load or another component of its own"
                )


class _NoFmuError(FanfoldError):
    """Why a file is no FMU that can take part."""


class _Reader:
    """Reads the table of one FMU against its model description and the parts, and gathers what is wrong."""

    def __init__(
        self,
        table: Fmu,
        parts: Sequence[Part],
        lines: Sequence[HingeLine],
        readers: Mapping[str, _Reader],
        problems: list[str],
    ) -> None:
        self._table, self._readers, self._problems = table, readers, problems
        self._told: dict[str, Signal] = {}
        self._parts = {part.name: part for part in parts}
        self._lines = {line.name: line for line in lines}
        self._description = _description(Path(table.file))
        self._variables = {v.name: v for v in self._description.modelVariables}
        self._units = {u.name: u.baseUnit for u in self._description.unitDefinitions}
        self._differences = _differences(Path(table.file), self._variables)

    def fmu(self) -> SignalFmu:
        """The FMU, as far as it is sound."""
        table = self._table
        return SignalFmu(
            table.name,
            Path(table.file),
            self._step(),
            {name: value for name, value in table.parameters.items() if self._is_start(name, value)},
            tuple(s for name, source in table.inputs.items() for s in self._input(name, source)),
            tuple(s for name in table.outputs for s in self._output(name)),
            is_wing=bool(table.inputs) and MEETS_RATES in self._variables,
        )

    def _note(self, key: str, sentence: str) -> None:
        self._problems.append(f"fmu.{self._table.name}.{key}: {sentence}")

    def _step(self) -> float:
        """Of the table, or what the FMU says itself (s)."""
        experiment = self._description.defaultExperiment
        said = float(experiment.stepSize or 0.0) if experiment is not None else 0.0
        step = self._table.step or said
        if not (step >= SMALLEST_STEP and isfinite(step)):
            self._note(
                "step",
                f"is {step:g} s; it must be finite, and {SMALLEST_STEP:g} s at least"
                if self._table.step
                else f"is missing, and the FMU says none of {SMALLEST_STEP:g} s or more itself; give one",
            )
        return step

    def _is_start(self, name: str, value: Any) -> bool:  # noqa: ANN401 - of any type
        try:
            variable = self._scalar_variable(name, ("parameter", "structuralParameter"))
            if variable.type == "Boolean":
                sound, kind = isinstance(value, bool), "true or false"
            elif variable.type == "String":
                sound, kind = isinstance(value, str), "a text"
            else:
                whole = variable.type in _WHOLE
                number = isinstance(value, int if whole else int | float) and not isinstance(value, bool)
                sound = number and isfinite(value)
                kind = (
                    "a whole number"
                    if whole
                    else f"a finite number of {_unit(variable)}".removesuffix(" of ")
                )
            if not sound:
                raise ValueError(f"is {value!r}; it must be {kind}")
        except ValueError as error:
            self._note(f"parameters.{name}", str(error))
            return False
        return True

    def _scalar_variable(self, name: str, causalities: Sequence[str]) -> Any:  # noqa: ANN401 - of FMPy
        """A variable of the FMU; ValueError where it is none of these causalities, or no scalar."""
        of_them = [v.name for v in self._variables.values() if v.causality in causalities]
        variable = self._variables.get(name)
        if variable is None and (found := _ELEMENT.fullmatch(name)) is not None:
            from fmus.host.child import shape_of  # loads FMPy, which most scenes need not

            array, places = found[1], [int(place) for place in found[2].split(",")]
            variable = self._variables.get(array)
            shape = shape_of(variable, self._table.parameters) if variable is not None else ()
            if shape and not (len(places) == len(shape) and all(map(le, places, shape))):
                raise ValueError(f"has no such element; {array} has {' x '.join(map(str, shape))}")
            of_them = [array] if shape else of_them
        elif variable is not None and variable.dimensions:
            first = ",".join("1" for _ in variable.dimensions)
            raise ValueError(f"is an array; its elements can be joined, such as {name}[{first}]")
        if variable is None or variable.causality not in causalities:
            raise ValueError(f"{unknown(name, of_them, causalities[0])} (of {Path(self._table.file).name})")
        return variable

    def _signal_variable(self, name: str, causality: str) -> Any:  # noqa: ANN401 - of FMPy
        variable = self._scalar_variable(name, (causality,))
        if variable.type not in (*_NUMBERS, *_WHOLE, "Boolean"):
            raise ValueError(f"is a {variable.type}; numbers and truth values can be joined")
        return variable

    def _input(self, name: str, source: str) -> Iterator[Signal]:
        key = f"inputs.{name}"
        try:
            variable = self._signal_variable(name, "input")
            part, rest = self._part(source)
            if part in self._readers:
                yield self._from_fmu(variable, part, rest)
                return
            sensor = self._lines[part].sensor if part in self._lines else part
            component = self._known(sensor).component()
            quantities = {
                q.name: q
                for layout in (component.output_layout, component.observation_layout)
                for q in layout.quantities
                if not q.name.endswith(LAGGED)
            }
            quantity, index = scalar(rest, quantities, self._parts[sensor].kind)
            factor, offset = self._conversion(variable, quantity.unit)
        except ValueError as error:
            self._note(key, str(error))
            return
        yield Signal(
            name, variable.type, sensor, quantity.name, index, 1.0 / factor, -offset / factor,
            _unit(variable) or quantity.unit, variable.description or "", says_unit=_says_unit(variable),
        )  # fmt: skip

    def _from_fmu(self, variable: Any, part: str, output: str) -> Signal:  # noqa: ANN401 - of FMPy
        """An input that is the output of an FMU; ValueError where there is none, or none of the same dimension."""
        other = self._readers[part]
        other.told(output)
        source = other._signal_variable(output, "output")
        theirs, ours, factor, offset = _unit(source), _unit(variable), 1.0, 0.0
        if theirs and ours and theirs != ours:
            common = next((unit for unit in (theirs, ours) if _is_known(unit)), None)
            if common is None:
                raise ValueError(f"is in {ours}, which cannot be converted to {theirs}")
            (f, f_offset), (g, g_offset) = (
                other._conversion(source, common), self._conversion(variable, common),
            )  # fmt: skip
            factor, offset = f / g, (f_offset - g_offset) / g
        return Signal(
            variable.name, variable.type, part, output, 0, factor, offset, ours or theirs or "1",
            variable.description or "", says_unit=_says_unit(variable) or not theirs,
        )  # fmt: skip

    def _output(self, name: str) -> Iterator[Signal]:
        """What an output sets. Commands are events, see `assembly_events`."""
        try:
            self.told(name)
            for target in self._table.targets(name):
                yield from self._set(name, target)
        except ValueError as error:
            self._note(f"outputs.{name}", str(error))

    def _set(self, name: str, target: str) -> Iterator[Signal]:
        variable = self._signal_variable(name, "output")
        name_of_part, rest = self._part(target)
        for part in self._lines[name_of_part].hinges if name_of_part in self._lines else (name_of_part,):
            component, kind = self._known(part).component(), self._parts[part].kind
            if rest in COMMANDS and rest in component.input_layout:
                continue
            known = {q.name: q for q in component.parameter_layout.quantities}
            tunable(rest.partition("[")[0], component, kind)
            quantity, index = scalar(rest, known, kind)
            impulse = self._is_impulse(variable, quantity.unit)
            unit = _IMPULSES[quantity.unit] if impulse else quantity.unit
            factor, offset = self._conversion(variable, unit)
            start = quantity.start_values()
            start[:] = self._parts[part].start.get(quantity.name, start)
            yield Signal(
                name, variable.type, part, quantity.name, index, factor, offset,
                _unit(variable) or quantity.unit, variable.description or "", tuple(start.tolist()), impulse,
                _says_unit(variable),
            )  # fmt: skip

    def told(self, name: str) -> Signal:
        """An output as recorded, which events and other FMUs may read; ValueError where there is none."""
        variable = self._signal_variable(name, "output")
        unit, text = _unit(variable) or "1", variable.description or ""
        return self._told.setdefault(
            name, Signal(name, variable.type, "", "", 0, unit=unit, description=text)
        )

    def all_told(self) -> tuple[Signal, ...]:
        """All of these so far."""
        return tuple(self._told.values())

    def _part(self, path: str) -> tuple[str, str]:
        """Component and variable of "component.variable[1]"."""
        part, _, rest = path.partition(".")
        if not rest:
            raise ValueError(
                f'is {path!r}; it must be "component.variable", with [1] for the first of several'
            )
        return part, rest

    def _known(self, name: str) -> Part:
        if name not in self._parts:
            raise ValueError(
                f"{name!r} {unknown(name, [*self._lines, *self._parts, *self._readers], 'component')}"
            )
        return self._parts[name]

    def _is_impulse(self, variable: Any, unit: str) -> bool:  # noqa: ANN401 - of FMPy
        """Whether a variable is the impulse of a load in this unit."""
        if unit not in _IMPULSES or not _unit(variable):
            return False
        try:
            self._conversion(variable, _IMPULSES[unit])
        except ValueError:
            return False
        return True

    def _conversion(self, variable: Any, unit: str) -> tuple[float, float]:  # noqa: ANN401 - of FMPy
        """Factor and offset that make a value of `unit` of the FMU's value; ValueError where there are none.

        A variable without a unit is taken to be in that of the scene's components.
        """
        said = _unit(variable)
        if not said:
            return 1.0, 0.0
        base = self._units.get(said)
        if said == unit:
            _refuse_redefined(unit, base)
            return 1.0, 0.0
        try:
            ours, our_factor = base_unit(unit)
            if base is not None:
                theirs = {name: getattr(base, name) for name in _BASE}
                factor, offset = float(base.factor), float(base.offset)
                if not (isfinite(factor) and factor and isfinite(offset)):
                    raise ValueError(
                        f"is in {said}, which the FMU defines by a factor of {factor:g} and an offset of {offset:g}; "
                        "it cannot be converted"
                    )
                theirs["rad"] = getattr(base, "rad", None)
            else:
                theirs, factor = base_unit(said)
                offset = 0.0
        except ComponentError:
            raise ValueError(f"is in {said!r}, a unit that the FMU does not define; use {unit}") from None
        if any((theirs.get(name) or 0) != ours.get(name, 0) for name in _BASE):
            raise ValueError(f"is in {said}, which cannot be converted to {unit}")
        if unit == "rad/s" and not (theirs.get("rad") or _ANGLE.search(said)):
            raise ValueError(
                f"is in {said}, which may count turns, and rad/s is 2 pi times as many; give it in rad/s, or its base "
                "unit an exponent of rad"
            )
        return factor / our_factor, 0.0 if variable.name in self._differences else offset / our_factor


def _is_known(unit: str) -> bool:
    """Whether it is a unit of components."""
    try:
        base_unit(unit)
    except ComponentError:
        return False
    return True


def _refuse_redefined(unit: str, base: Any) -> None:  # noqa: ANN401 - of FMPy
    """ValueError where an FMU defines a unit of our name as another; a definition without a number says nothing."""
    if base is None or has_root(unit):
        return
    ours, factor = base_unit(unit)
    theirs = {name: getattr(base, name) or 0 for name in _BASE}
    said = float(base.factor), float(base.offset)
    if said == (1.0, 0.0) and not any(theirs.values()):
        return
    alike = all(theirs[name] == ours.get(name, 0) for name in _BASE)
    if not (alike and isclose(said[0], factor, rel_tol=_FACTOR) and said[1] == 0.0):
        powers = ".".join(f"{name}{power}" for name, power in theirs.items() if power) or "1"
        raise ValueError(
            f"is in {unit}, which the FMU defines as {said[0]:g} {powers} with an offset of {said[1]:g}; correct the "
            "definition, or call the unit by another name"
        )


def _unit(variable: Any) -> str:  # noqa: ANN401 - of FMPy
    """Unit of a variable, its own or that of the type that it is declared to have; none as an empty text."""
    return variable.unit or getattr(variable.declaredType, "unit", None) or ""


def _says_unit(variable: Any) -> bool:  # noqa: ANN401 - of FMPy
    """Whether nothing is left to guess: whole numbers and truth values have no attribute for a unit."""
    return bool(_unit(variable)) or variable.type not in _NUMBERS


def _description(path: Path) -> Any:  # noqa: ANN401 - of FMPy
    """The model description; _NoFmuError where there is none, or where it is of another kind of FMU."""
    if problems := list(archive_problems(path)):
        raise _NoFmuError(f"cannot be read as an FMU: {problems[0]}")
    try:
        found = read_model_description(str(path), validate=False)
    except Exception as error:
        raise _NoFmuError(f"cannot be read as an FMU: {error}") from None
    if not found.fmiVersion.startswith(("2.", "3.")):
        raise _NoFmuError(f"is of FMI {found.fmiVersion}; 2.0 and 3.0 can take part")
    interface = found.coSimulation or found.modelExchange
    if interface is None:
        raise _NoFmuError("has neither co-simulation nor model exchange; export it for one of them")
    identifier = interface.modelIdentifier
    if re.search(r"[/\\]", identifier):
        raise _NoFmuError(
            f"has the model identifier {identifier!r}; it names functions of C, and has no slashes"
        )
    with zipfile.ZipFile(path) as archive:
        members = archive.namelist()
    if binary_member(found.fmiVersion, identifier) not in members:
        others = sorted({name.split("/")[1] for name in members if re.match(r"binaries/[^/]+/.", name)})
        has = f"only for {', '.join(others)}" if others else "nor for any other"
        raise _NoFmuError(f"has no binary for this platform, {folder_here(found.fmiVersion)}, {has}")
    return found


def _differences(path: Path, variables: Mapping[str, Any]) -> frozenset[str]:
    """Variables that are differences (relativeQuantity), whose units have no offset; FMPy reads that of types only."""
    try:
        with zipfile.ZipFile(path) as archive:
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    except Exception as error:  # encodings that the parser of the standard library does not know
        raise _NoFmuError(f"cannot be read as an FMU: {error}") from None
    said: dict[str | None, str | None] = {}
    for entry in root.iterfind("ModelVariables/*"):
        real = entry.find("Real")
        said[entry.get("name")] = (entry if real is None else real).get("relativeQuantity")
    typed = {name: getattr(v.declaredType, "relativeQuantity", False) for name, v in variables.items()}
    return frozenset(
        name for name in variables if (typed[name] if said.get(name) is None else said[name] in ("true", "1"))
    )
