"""From a component to the FMI 2.0 co-simulation model description; what all versions of FMI share is here too."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from datetime import datetime
from typing import NamedTuple

from lxml.etree import Element, SubElement, _Element
from pythonfmu.fmi2slave import Fmi2Slave

from components import Component, ComponentError

from .choices import NATIVE_TOOL, TYPES, Backend
from .model_exchange import add_model_exchange, state_units
from .units import add_units
from .variables import Variable, follows_inputs, scalars, starts_from_inputs
from .xml import xml_bytes

_TOOLS: dict[Backend, str] = {"native": NATIVE_TOOL, "python": "Fanfold with PythonFMU"}
_STATE_CAPABILITIES = {
    "canHandleVariableCommunicationStepSize": "true",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
}
_CAPABILITIES: dict[Backend, dict[str, str]] = {
    "native": {**_STATE_CAPABILITIES, "providesDirectionalDerivative": "true"},
    # an embedded Python with NumPy and SciPy
    "python": {"needsExecutionTool": "true", **_STATE_CAPABILITIES},
}
DATE_FORMAT = "%Y-%m-%dT%H:%M:%SZ"


class Experiment(NamedTuple):
    """What a tool runs by default: end time and communication step size (s), None for none that is advised.

    tolerance: relative, of what steps by one inside.
    """

    stop_time: float = 1.0
    step_size: float | None = 1e-3
    tolerance: float | None = None

    def attributes(self) -> dict[str, str]:
        """Attributes of DefaultExperiment."""
        given = {"stopTime": self.stop_time, "tolerance": self.tolerance, "stepSize": self.step_size}
        return {"startTime": "0", **{name: f"{v:.17g}" for name, v in given.items() if v is not None}}


class About(NamedTuple):
    """What people read of a model: a sentence, who made it, its version and licence, and a picture (PNG)."""

    description: str = ""
    author: str = ""
    version: str = ""
    license: str = ""
    picture: bytes = b""

    def attributes(self) -> dict[str, str]:
        """Attributes of the root element of a model description."""
        return {name: text for name, text in self._asdict().items() if isinstance(text, str) and text}


WITHOUT_WORDS = About()
STEP_DERIVATIVE = (
    "Right after a communication step the derivative is that of the outputs at the end of the step with respect "
    "to the inputs held or reached in it, d y(t + h) / d u. Otherwise, and in the model structure's dependencies, "
    "it is that of the outputs at the communication point, as the standard means it."
)
ACCEPT_NUMBERS = "fanfoldAcceptNumbers"
"""Function of a native FMU after which variables of all types are read and written as numbers, as Real ones are."""
ZERO_MOBILITY = "no wrench changes the motion"
CONSTANT_MOBILITY = (
    "The derivative of the ports' motion with respect to the wrenches held in a communication step depends on the "
    "step's size alone, in axes that turn with the first port, but for terms of the order of the angle turned in it."
)


def header(
    component: Component, name: str, generated: datetime, backend: Backend, about: About
) -> dict[str, str]:
    """Attributes that the root element has in every version of FMI; ComponentError where the name is none."""
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name):
        raise ComponentError(f"the FMU name {name!r} must be an identifier: letters, digits and _")
    documentation = (type(component).__doc__ or "").strip().partition("\n")[0]
    return {
        "modelName": name,
        "description": documentation or component.kind,
        "generationTool": _TOOLS[backend],
        "generationDateAndTime": generated.strftime(DATE_FORMAT),
        "variableNamingConvention": "structured",
        **about.attributes(),
    }


def model_description(
    component: Component,
    name: str,
    starts: Sequence[float],
    guid: str,
    generated: datetime,
    backend: Backend = "python",
    source_files: Sequence[str] = (),
    experiment: Experiment | None = None,
    about: About = WITHOUT_WORDS,
) -> bytes:
    """The complete modelDescription.xml of a component as the FMU `name`.

    `starts` are the start values of parameters and inputs, as `start_values` gives them; `source_files` the
    names of C files that the FMU carries.
    """
    variables = list(scalars(component))
    root = Element(
        "fmiModelDescription",
        {"fmiVersion": "2.0", "guid": guid, **header(component, name, generated, backend, about)},
    )
    capabilities = {"modelIdentifier": name, **_CAPABILITIES[backend]}
    if backend == "native" and any(port.side == "body" and port.order == 4 for port in component.ports):
        capabilities["canInterpolateInputs"] = "true"
    SubElement(root, "CoSimulation", capabilities)
    units = [v.quantity.unit for v in variables]
    add_units(root, [*units, *state_units(component)] if backend == "native" else units)
    _add_log_categories(root)
    SubElement(root, "DefaultExperiment", (experiment or Experiment()).attributes())
    _add_annotations(root, component, backend)
    _add_variables(root, variables, starts)
    _add_structure(root, component, variables)
    if backend == "native":
        add_model_exchange(root, component, name)
    for interface in (root.find("CoSimulation"), root.find("ModelExchange")):
        if interface is not None and source_files:
            listed = SubElement(interface, "SourceFiles")
            for source in source_files:
                SubElement(listed, "File", {"name": source})
    return xml_bytes(root)


def _add_log_categories(root: _Element) -> None:
    categories = SubElement(root, "LogCategories")
    for category, text in Fmi2Slave.log_categories.items():
        SubElement(categories, "Category", {"name": category, "description": text})


def _add_annotations(root: _Element, component: Component, backend: Backend) -> None:
    """What a master may rely on, in words that the standard has no attribute for."""
    said = []
    if backend == "native":
        said.append(("DirectionalDerivative", {"afterStep": STEP_DERIVATIVE}))
    said.append(("Numbers", {"after": ACCEPT_NUMBERS if backend == "native" else ""}))
    if component.constant_mobility:
        zero = {"zero": ZERO_MOBILITY} if component.prescribed_motion else {}
        said.append(("Mobility", {"constant": CONSTANT_MOBILITY, **zero}))
    if component.noun:
        said.append(("Component", {"noun": component.noun}))
    roles = [q for q in component.observation_layout.quantities if q.role]
    said += [("Observation", {"name": q.name, "role": q.role}) for q in roles]
    if said:
        tool = SubElement(SubElement(root, "VendorAnnotations"), "Tool", {"name": "Fanfold"})
        coupling = SubElement(tool, "Coupling")  # the schema allows a tool one element
        for element, attributes in said:
            SubElement(coupling, element, attributes)


def _add_variables(root: _Element, variables: Sequence[Variable], starts: Sequence[float]) -> None:
    parent = SubElement(root, "ModelVariables")
    for variable in variables:
        attributes, said = variable.attributes(), variable.unit_and_range()
        if variable.causality == "output":
            attributes["initial"] = "calculated"
        else:
            said["start"] = variable.written([starts[variable.value_reference]])
        SubElement(
            SubElement(parent, "ScalarVariable", attributes), TYPES["2.0"][variable.quantity.kind], said
        )


def _add_structure(root: _Element, component: Component, variables: Sequence[Variable]) -> None:
    """In initialization mode an unknown without a list of dependencies depends on all that is known."""
    structure = SubElement(root, "ModelStructure")
    calculated = [v for v in variables if v.causality == "output"]
    inputs, parameters = (
        _index_list(v for v in variables if v.causality == causality) for causality in ("input", "parameter")
    )
    if calculated:
        outputs = SubElement(structure, "Outputs")
        for variable in calculated:
            dependencies = inputs if follows_inputs(component, variable) else ""
            index = _index_list([variable])
            SubElement(outputs, "Unknown", {"index": index, "dependencies": dependencies})
        unknowns = SubElement(structure, "InitialUnknowns")
        for variable in calculated:
            unknown = SubElement(unknowns, "Unknown", {"index": _index_list([variable])})
            if not starts_from_inputs(component, variable):
                unknown.set("dependencies", parameters)


def _index_list(variables: Iterable[Variable]) -> str:
    return " ".join(str(variable.value_reference + 1) for variable in variables)
