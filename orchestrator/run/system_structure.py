"""An assembly as one SSP file (System Structure and Parameterization): FMUs, connections, ports and parameters.

FMUs of FMI 2.0 are in SSP 1.0, those of FMI 3.0 in SSP 2.0, the first version with its types. Types, units, sizes and
values come from the model descriptions of the FMUs. The end time is that of the scene. SSP has no step size:
OMSimulator reads it from the annotation, for other tools it is printed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from fmpy import read_model_description
from fmpy.model_description import ModelDescription, ModelVariable
from lxml.etree import Element, SubElement, _Element

from components import FanfoldError
from components.contract.roles import (
    FAILURE_COMMAND,
    INTERFACE_LOAD,
    LATCH_COMMAND,
    LATCHED,
    RELEASE_COMMAND,
    UNLATCH_COMMAND,
)
from fmus import Experiment
from fmus.archive import zip_bytes
from fmus.description.choices import NATIVE_TOOL
from fmus.description.units import base_unit, has_root
from fmus.description.xml import xml_bytes

from ..assembly import Assembly, HingeLine, Link
from ..cosim.ports import MOTION, WRENCH
from ..scene.body_tables import Fidelity
from ..scene.system_structure import MEMBER, carried

_STANDARD = "http://ssp-standard.org/SSP1/SystemStructure"
_NAMESPACES = {
    "ssd": f"{_STANDARD}Description",
    "ssc": f"{_STANDARD}Common",
    "ssv": f"{_STANDARD}ParameterValues",
}
_SSP_OF_FMI = {"2.0": "1.0", "3.0": "2.0"}
_SYSTEM, _ELEMENTS, _PARAMETERS = "SystemStructure.ssd", "elements.ssd", "resources/parameters.ssv"
_REALS = ("Real", "Float64")
_OMSIMULATOR = "org.openmodelica"
_OMS = "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"


class SystemStructureError(FanfoldError):
    """A sentence for the user: why no SSP file can be written."""


class _Place(NamedTuple):
    """A variable of an element."""

    element: str
    variable: str


class _Port(NamedTuple):
    """A connector of the system, and the variables of elements that it stands for."""

    name: str
    places: tuple[_Place, ...]


Elements = Mapping[str, Mapping[str, ModelVariable]]
"""Variables by name of every element by name."""


def check_ssp(path: Path) -> None:
    """SystemStructureError for a name that does not end in .ssp."""
    if path.suffix != ".ssp":
        raise SystemStructureError(f"{path}: an SSP file is meant; let its name end in .ssp")


def write_ssp(path: Path, assembly: Assembly, fmus: Sequence[Path], experiment: Experiment) -> Path:
    """Write the SSP file of an assembly from its FMUs, made with end-point wrenches, and return its path.

    Or from the one FMU that it is. Errors of `check_ssp`.
    """
    check_ssp(path)
    described = {fmu.stem: read_model_description(str(fmu), validate=False) for fmu in fmus}
    elements = {name: {v.name: v for v in of.modelVariables} for name, of in described.items()}
    about = next(iter(described.values()))
    if len(fmus) > 1:
        inner = list(_linked(elements, assembly.links))
        ports = list(_ports(elements, assembly))
    else:
        inner, ports = [], list(_ports_of_one(elements, assembly))
    structure = _Structure(_identifier(assembly.name), about, elements, inner, ports)
    annotation = () if experiment.step_size is None else (experiment.step_size, assembly.tolerance)
    members = {
        _SYSTEM: structure.description(experiment.stop_time, annotation),
        _ELEMENTS: structure.without_ports().description(experiment.stop_time, annotation),
        _PARAMETERS: structure.parameters(),
        **{_source(fmu.stem): fmu.read_bytes() for fmu in fmus},
    }
    members[MEMBER] = carried(assembly.scene_tree, _fidelities(assembly), members).encode()
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(zip_bytes(members))
    return path


def _fidelities(assembly: Assembly) -> dict[str, Fidelity]:
    """Of every body that is a part; one that is held belongs to another and stays what its scene says."""
    found: dict[str, Fidelity] = {part.name: "rigid" for part in assembly.parts}
    found |= dict.fromkeys(assembly.flexible, "flexible")
    return found | dict.fromkeys(assembly.large_deformation, "large_deformation")


def _linked(elements: Elements, links: Iterable[Link]) -> Iterator[tuple[_Place, _Place]]:
    """From where to where: motions from the body to the connection, wrenches back."""
    for link in links:
        for source, target, names in (
            (link.body, link.connection, MOTION),
            (link.connection, link.body, WRENCH),
        ):
            for name in names:
                given, taken = (_places(elements, of, f"{port}.{name}") for of, port in (source, target))
                yield from zip(given, taken, strict=True)


def _places(elements: Elements, element: str, quantity: str) -> list[_Place]:
    """Variables of a quantity: one, or one for each of its numbers in FMI 2.0; none where an element lacks it."""
    names = [name for name in elements[element] if name == quantity or name.startswith(f"{quantity}[")]
    return [_Place(element, name) for name in names]


def _ports(elements: Elements, assembly: Assembly) -> Iterator[_Port]:
    """Commands, angles and latches of lines, releases of joints, and loads on the spacecraft."""
    for line in assembly.hinge_lines:
        for quantity, of in _of_line(line):
            places = tuple(place for name in of for place in _places(elements, name, quantity))
            if places:
                yield _Port(_identifier(f"{line.name}.{quantity}"), places)
    for part in assembly.parts:
        component = part.component()
        commands = [RELEASE_COMMAND.name, FAILURE_COMMAND.name]
        loads = [q.name for q in component.observation_layout.quantities if q.role == INTERFACE_LOAD]
        for quantity in (*commands, *loads):
            for place in _places(elements, part.name, quantity):
                yield _Port(_identifier(f"{part.name}.{place.variable}"), (place,))


def _of_line(line: HingeLine) -> Iterator[tuple[str, Sequence[str]]]:
    """Quantities of a line, and the hinges that have them."""
    if line.latches:
        yield LATCH_COMMAND.name, line.hinges
        yield UNLATCH_COMMAND.name, line.hinges
        yield LATCHED.name, (line.sensor,)
    yield "angle", (line.sensor,)


def _ports_of_one(elements: Elements, assembly: Assembly) -> Iterator[_Port]:
    """Inputs of the one FMU, and its outputs of lines, of loads on the spacecraft and of masses that this carries."""
    lines = [f"{line.name}." for line in assembly.hinge_lines]
    carried = [f"{part.name}.{of}_" for part in assembly.parts for of in ("interface", "appendage")]
    for element, variables in elements.items():
        for variable in variables.values():
            is_shown = variable.causality == "output" and variable.name.startswith((*lines, *carried))
            if is_shown or variable.causality == "input":
                yield _Port(_identifier(variable.name), (_Place(element, variable.name),))


def _identifier(name: str) -> str:
    """A name without points and brackets: OMSimulator reads a point as an element, and Modelica has none in names."""
    return re.sub(r"\W+", "_", name).strip("_")


class _Structure(NamedTuple):
    """A system: elements, connections between them, and ports.

    about: the model description that has author, licence and version of FMI. has_ports: whether they are written.
    """

    name: str
    about: ModelDescription
    elements: Elements
    inner: Sequence[tuple[_Place, _Place]]
    ports: Sequence[_Port]
    has_ports: bool = True

    def without_ports(self) -> _Structure:
        """The system for tools that reject connections to its own connectors, such as libcosim and Ecos."""
        return self._replace(name=f"{self.name}_{Path(_ELEMENTS).stem}", has_ports=False)

    def description(self, stop_time: float, annotation: tuple[float, float] | tuple[()]) -> bytes:
        """The system structure description; annotation: step (s) and tolerance of a master."""
        root = self._root("ssd:SystemStructureDescription", "ssd")
        system = _add(root, "ssd:System", {"name": self.name})
        if self.has_ports and self.ports:
            connectors = _add(system, "ssd:Connectors")
            for port in self.ports:
                variable = self._variable(port.places[0])
                _add_connector(connectors, port.name, variable, _text(variable))
        bindings = _add(system, "ssd:ParameterBindings")
        _add(bindings, "ssd:ParameterBinding", {"source": _PARAMETERS})
        self._add_elements(system)
        self._add_connections(system)
        if annotation:
            _add_step(system, *annotation)
        _add_units(root, "ssd:Units", (v for _, v in self._variables("input", "output")))
        _add(root, "ssd:DefaultExperiment", {"startTime": "0", "stopTime": repr(float(stop_time))})
        return xml_bytes(root)

    def parameters(self) -> bytes:
        """The parameter set: every parameter of every FMU with its start value."""
        root = self._root("ssv:ParameterSet", "ssv")
        parent = _add(root, "ssv:Parameters")
        for element, variable in self._variables("parameter"):
            found = _add(parent, "ssv:Parameter", {"name": f"{element}.{variable.name}", **_text(variable)})
            _add(found, f"ssv:{variable.type}", {"value": variable.start, **_unit(variable)})
            _add_dimensions(found, variable)
        _add_units(root, "ssv:Units", (v for _, v in self._variables("parameter")))
        return xml_bytes(root)

    def _root(self, tag: str, prefix: str) -> _Element:
        about = {
            "author": self.about.author,
            "fileversion": self.about.version,
            "license": self.about.license,
            "generationTool": NATIVE_TOOL,
        }
        version = _SSP_OF_FMI[self.about.fmiVersion]
        attributes = {"version": version, "name": self.name, **{k: v for k, v in about.items() if v}}
        return Element(_tag(tag), attributes, nsmap={p: _NAMESPACES[p] for p in (prefix, "ssc")})

    def _variable(self, place: _Place) -> ModelVariable:
        return self.elements[place.element][place.variable]

    def _variables(self, *causalities: str) -> Iterator[tuple[str, ModelVariable]]:
        """Variables of all elements, with the names of these."""
        for element, variables in self.elements.items():
            yield from ((element, v) for v in variables.values() if v.causality in causalities)

    def _add_elements(self, system: _Element) -> None:
        """Elements with all their outputs, and the inputs that something is connected to."""
        connected = {target for _, target in self.inner} | {p for port in self.ports for p in port.places}
        parent = _add(system, "ssd:Elements")
        for name, variables in self.elements.items():
            attributes = {"type": "application/x-fmu-sharedlibrary", "source": _source(name)}
            element = _add(
                parent, "ssd:Component", {"name": name, **attributes, "implementation": "CoSimulation"}
            )
            connectors = _add(element, "ssd:Connectors")
            for variable in variables.values():
                is_input = variable.causality == "input" and _Place(name, variable.name) in connected
                if is_input or variable.causality == "output":
                    _add_connector(connectors, variable.name, variable)

    def _add_connections(self, system: _Element) -> None:
        found = [(_ends("start", *source), _ends("end", *target)) for source, target in self.inner]
        for port in self.ports if self.has_ports else ():
            for place in port.places:
                if self._variable(place).causality == "input":
                    found.append((_ends("start", "", port.name), _ends("end", *place)))
                else:
                    found.append((_ends("start", *place), _ends("end", "", port.name)))
        if found:
            parent = _add(system, "ssd:Connections")
            for start, end in found:
                _add(parent, "ssd:Connection", {**start, **end})


def _source(element: str) -> str:
    return f"resources/{element}.fmu"


def _ends(which: str, element: str, connector: str) -> dict[str, str]:
    """Attributes of an end of a connection; a connector of the system has no element."""
    return {**({f"{which}Element": element} if element else {}), f"{which}Connector": connector}


def _tag(name: str) -> str:
    prefix, _, local = name.partition(":")
    return f"{{{_NAMESPACES[prefix]}}}{local}"


def _add(parent: _Element, name: str, attributes: Mapping[str, str] | None = None) -> _Element:
    return SubElement(parent, _tag(name), dict(attributes or {}))


def _add_connector(
    parent: _Element, name: str, variable: ModelVariable, text: Mapping[str, str] | None = None
) -> None:
    attributes = {"name": name, "kind": variable.causality, **(text or {})}
    connector = _add(parent, "ssd:Connector", attributes)
    _add(connector, f"ssc:{variable.type}", _unit(variable))
    _add_dimensions(connector, variable)


def _add_dimensions(parent: _Element, variable: ModelVariable) -> None:
    for dimension in variable.dimensions or ():
        _add(parent, "ssc:Dimension", {"size": str(dimension.start)})


def _text(variable: ModelVariable) -> dict[str, str]:
    return {"description": variable.description} if variable.description else {}


def _unit(variable: ModelVariable) -> dict[str, str]:
    """The attribute of a real variable's unit, unless SSP has no words for it."""
    unit = variable.unit if variable.type in _REALS else None
    return {} if unit is None or has_root(unit) else {"unit": unit}


def _add_units(root: _Element, tag: str, variables: Iterable[ModelVariable]) -> None:
    """Definitions of the units of variables."""
    names = dict.fromkeys(unit for variable in variables for unit in _unit(variable).values())
    if names:
        parent = _add(root, tag)
        for name in names:
            exponents, factor = base_unit(name)
            scale = {"factor": repr(factor)} if factor != 1.0 else {}
            unit = _add(parent, "ssc:Unit", {"name": name})
            _add(unit, "ssc:BaseUnit", {**{k: str(v) for k, v in exponents.items() if v}, **scale})


def _add_step(system: _Element, step: float, tolerance: float) -> None:
    """The fixed step of a master and its tolerances, which are 0 where they are left out, in OMSimulator's words."""
    annotations = _add(system, "ssd:Annotations")
    annotation = _add(annotations, "ssc:Annotation", {"type": _OMSIMULATOR})
    found = SubElement(annotation, f"{{{_OMS}}}Annotations", nsmap={"oms": _OMS})
    information = SubElement(found, f"{{{_OMS}}}SimulationInformation")
    numbers = {"stepSize": step, "absoluteTolerance": tolerance, "relativeTolerance": tolerance}
    attributes = {name: f"{number:g}" for name, number in numbers.items()}
    SubElement(information, f"{{{_OMS}}}FixedStepMaster", {"description": "oms-ma", **attributes})
