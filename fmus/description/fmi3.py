"""From a component to the FMI 3.0 co-simulation model description.

A quantity of several scalars is one array; its value reference is that of its first scalar, so that the native
core finds all values of an array in a row. Time has the reference after all others.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import datetime

from lxml.etree import Element, SubElement, _Element

from components import Component

from .choices import TYPES
from .fmi2 import STEP_DERIVATIVE, WITHOUT_WORDS, About, Experiment, header
from .units import add_units
from .variables import Variable, follows_inputs, quantities, starts_from_inputs
from .xml import VENDOR, xml_bytes

_CAPABILITIES = {
    "canHandleVariableCommunicationStepSize": "true",
    "canGetAndSetFMUState": "true",
    "canSerializeFMUState": "true",
    "providesDirectionalDerivatives": "true",
}
_LOG_CATEGORIES = {
    "logStatusWarning": "Messages with the status fmi3Warning",
    "logStatusDiscard": "Messages with the status fmi3Discard: why a step cannot be made",
    "logStatusError": "Messages with the status fmi3Error",
    "logStatusFatal": "Messages with the status fmi3Fatal",
    "logAll": "All messages",
}


def model_description3(
    component: Component,
    name: str,
    starts: Sequence[float],
    token: str,
    generated: datetime,
    experiment: Experiment | None = None,
    about: About = WITHOUT_WORDS,
) -> bytes:
    """The complete modelDescription.xml of a component as the native FMU `name` of FMI 3.0.

    `starts` are the start values of parameters and inputs, as `start_values` gives them; `token` is the
    instantiation token.
    """
    variables = list(quantities(component))
    attributes = header(component, name, generated, "native", about)
    root = Element("fmiModelDescription", {"fmiVersion": "3.0", "instantiationToken": token, **attributes})
    events = _event_capabilities(component, variables)
    capabilities = {"modelIdentifier": name, **_CAPABILITIES, **events}
    SubElement(root, "CoSimulation", capabilities)
    add_units(root, [*(v.quantity.unit for v in variables), "s"])
    categories = SubElement(root, "LogCategories")
    for category, text in _LOG_CATEGORIES.items():
        SubElement(categories, "Category", {"name": category, "description": text})
    SubElement(root, "DefaultExperiment", (experiment or Experiment()).attributes())
    _add_variables(root, variables, starts)
    _add_structure(root, component, variables)
    annotation = SubElement(
        SubElement(root, "Annotations"), "Annotation", {"type": f"{VENDOR}.step-derivative"}
    )
    # some readers refuse bare text
    SubElement(annotation, "StepDerivative", {"description": STEP_DERIVATIVE})
    return xml_bytes(root)


def _event_capabilities(component: Component, variables: Iterable[Variable]) -> dict[str, str]:
    """Event mode is for discrete inputs and events inside; a wrench of an instant may foresee a latch."""
    foresees = component.feedthrough and "latch_automatic" in component.parameter_layout
    early = {"mightReturnEarlyFromDoStep": "true"} if foresees or component.returns_early else {}
    has_events = bool(early) or any(v.causality == "input" and v.variability == "discrete" for v in variables)
    return {"hasEventMode": "true", **early} if has_events else {}


def _add_variables(root: _Element, variables: Sequence[Variable], starts: Sequence[float]) -> None:
    parent = SubElement(root, "ModelVariables")
    end = 0
    for variable in variables:
        quantity, first = variable.quantity, variable.value_reference
        end = first + quantity.size
        attributes = {**variable.attributes(), **variable.unit_and_range()}
        if variable.causality == "output":
            attributes["initial"] = "calculated"
        else:
            attributes["start"] = variable.written(starts[first:end])
        element = SubElement(parent, TYPES["3.0"][quantity.kind], attributes)
        if quantity.size > 1:
            SubElement(element, "Dimension", {"start": str(quantity.size)})
    time = {"name": "time", "valueReference": str(end), "description": "Simulation time", "unit": "s"}
    SubElement(parent, "Float64", {**time, "causality": "independent", "variability": "continuous"})


def _add_structure(root: _Element, component: Component, variables: Sequence[Variable]) -> None:
    """In initialization mode an unknown without a list of dependencies depends on all that is known."""
    structure = SubElement(root, "ModelStructure")
    calculated = [v for v in variables if v.causality == "output"]
    inputs, parameters = (
        _references(v for v in variables if v.causality == causality) for causality in ("input", "parameter")
    )
    for variable in calculated:
        dependencies = inputs if follows_inputs(component, variable) else ""
        reference = str(variable.value_reference)
        SubElement(structure, "Output", {"valueReference": reference, "dependencies": dependencies})
    for variable in calculated:
        unknown = SubElement(structure, "InitialUnknown", {"valueReference": str(variable.value_reference)})
        if not starts_from_inputs(component, variable):
            unknown.set("dependencies", parameters)


def _references(variables: Iterable[Variable]) -> str:
    return " ".join(str(variable.value_reference) for variable in variables)
