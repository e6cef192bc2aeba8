"""From a component to the FMI 2.0 co-simulation model description.

Every fact about a variable comes from its `Quantity`. Variables stand in the order parameters, inputs,
outputs, observations; the value reference of a variable is its position in that order, so each group, each
port and each quantity is one contiguous range.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import cache
from typing import Literal
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np
from pythonfmu.fmi2slave import Fmi2Slave

from components import Component, ComponentError, Quantity

Backend = Literal["native", "python"]
StartValue = float | Sequence[float]
Causality = Literal["parameter", "input", "output"]

_CAUSALITIES: tuple[Causality, ...] = ("parameter", "input", "output", "output")
_DEFAULT_EXPERIMENT = {"startTime": "0", "stopTime": "1", "stepSize": "0.001"}
_TOOLS: dict[Backend, str] = {"native": "Fanfold", "python": "Fanfold with PythonFMU"}
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
_STEP_DERIVATIVE = (
    "Right after fmi2DoStep the derivative is that of the outputs at the end of the step with respect to the "
    "inputs held or reached in it, d y(t + h) / d u. Otherwise, and in the model structure's dependencies, it is "
    "that of the outputs at the communication point, as the standard means it."
)

# Exponents of the FMI base units, with a factor where the unit is not coherent.
_BASE_NAMES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_SYMBOLS: dict[str, tuple[dict[str, int], float]] = {
    **{name: ({name: 1}, 1.0) for name in _BASE_NAMES},
    "1": ({}, 1.0),
    "Hz": ({"s": -1}, 1.0),
    "N": ({"kg": 1, "m": 1, "s": -2}, 1.0),
    "Pa": ({"kg": 1, "m": -1, "s": -2}, 1.0),
    "J": ({"kg": 1, "m": 2, "s": -2}, 1.0),
    "W": ({"kg": 1, "m": 2, "s": -3}, 1.0),
    "V": ({"kg": 1, "m": 2, "s": -3, "A": -1}, 1.0),
    "Wb": ({"kg": 1, "m": 2, "s": -2, "A": -1}, 1.0),
    "T": ({"kg": 1, "s": -2, "A": -1}, 1.0),
    "H": ({"kg": 1, "m": 2, "s": -2, "A": -2}, 1.0),
    "C": ({"A": 1, "s": 1}, 1.0),
    "Ohm": ({"kg": 1, "m": 2, "s": -3, "A": -2}, 1.0),
    "deg": ({"rad": 1}, math.pi / 180.0),
    "mm": ({"m": 1}, 1e-3),
    "min": ({"s": 1}, 60.0),
    "h": ({"s": 1}, 3600.0),
}
_FACTOR = re.compile(r"([A-Za-z]+|1)(-?\d+)?")
_ROOT = re.compile(r"\(\d+/\d+\)(?=[./]|$)")


@dataclass(frozen=True, slots=True)
class Scalar:
    """One FMI variable: a scalar of a quantity and its place in the model description."""

    name: str
    value_reference: int
    causality: Causality
    start: float
    quantity: Quantity

    @property
    def variability(self) -> str:
        """FMI variability; what a quantity leaves at the default is fixed for a parameter."""
        declared = self.quantity.variability
        if self.causality == "parameter":
            return "tunable" if declared == "tunable" else "fixed"
        return "discrete" if declared == "discrete" else "continuous"


def scalars(component: Component) -> Iterator[Scalar]:
    """All FMI variables of a component in order, with their declared start values."""
    reference = 0
    for layout, causality in zip(component.layouts, _CAUSALITIES, strict=True):
        for quantity in layout.quantities:
            for name, start in zip(quantity.scalar_names(), quantity.start_values(), strict=True):
                yield Scalar(name, reference, causality, float(start), quantity)
                reference += 1


def value_references(component: Component) -> dict[str, int]:
    """Value reference of every scalar variable by name."""
    return {scalar.name: scalar.value_reference for scalar in scalars(component)}


def start_values(component: Component, start: Mapping[str, StartValue]) -> tuple[float, ...]:
    """Start values of parameters and inputs in order: the declared ones with those of `start` put in.

    A key is the name of a quantity (one number for all its scalars, or one each) or of one scalar.
    """
    settable = (*component.parameter_layout.quantities, *component.input_layout.quantities)
    values = {s.name: s.start for s in scalars(component) if s.causality != "output"}
    by_name = {quantity.name: quantity for quantity in settable}
    for key, value in start.items():
        if key not in by_name and key not in values:
            near = difflib.get_close_matches(key, [*by_name, *values], n=1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise ComponentError(f"{component.kind} has no parameter or input {key!r}{hint}")
        names = by_name[key].scalar_names() if key in by_name else (key,)
        given = np.asarray(value, dtype=float).ravel()
        if given.size not in (1, len(names)):
            raise ComponentError(f"{key} has {len(names)} scalars; {given.size} start values were given")
        values.update(zip(names, np.broadcast_to(given, (len(names),)).tolist(), strict=True))
    _check_inputs(component, values)
    return tuple(values.values())


def _check_inputs(component: Component, values: Mapping[str, float]) -> None:
    """Inputs start inside their range; `prepare` says the same of parameters, with more to check."""
    for quantity in component.input_layout.quantities:
        low = -math.inf if quantity.minimum is None else quantity.minimum
        high = math.inf if quantity.maximum is None else quantity.maximum
        for name in quantity.scalar_names():
            if not low <= values[name] <= high or math.isinf(values[name]):
                raise ComponentError(
                    f"input {name} starts at {values[name]:g} {quantity.unit}; "
                    f"it must be finite and between {low:g} and {high:g}"
                )


def model_description(
    component: Component,
    name: str,
    starts: Sequence[float],
    guid: str,
    generated: datetime,
    backend: Backend = "python",
) -> bytes:
    """The complete modelDescription.xml of a component as the FMU `name`.

    `starts` are the start values of parameters and inputs, as `start_values` gives them.
    """
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name):
        raise ComponentError(f"the FMU name {name!r} must be an identifier: letters, digits and _")
    variables = list(scalars(component))
    documentation = (type(component).__doc__ or "").strip().partition("\n")[0]
    root = Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": name,
            "guid": guid,
            "description": documentation or component.kind,
            "generationTool": _TOOLS[backend],
            "generationDateAndTime": generated.strftime("%Y-%m-%dT%H:%M:%SZ"),
            "variableNamingConvention": "structured",
        },
    )
    SubElement(root, "CoSimulation", {"modelIdentifier": name, **_CAPABILITIES[backend]})
    _add_units(root, (v.quantity.unit for v in variables))
    _add_log_categories(root)
    SubElement(root, "DefaultExperiment", _DEFAULT_EXPERIMENT)
    if backend == "native":
        annotations = SubElement(SubElement(root, "VendorAnnotations"), "Tool", {"name": "Fanfold"})
        SubElement(annotations, "DirectionalDerivative", {"afterStep": _STEP_DERIVATIVE})
    _add_variables(root, variables, starts)
    _add_structure(root, component, variables)
    indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, "unicode").encode() + b"\n"


def _add_log_categories(root: Element) -> None:
    categories = SubElement(root, "LogCategories")
    for category, text in Fmi2Slave.log_categories.items():
        SubElement(categories, "Category", {"name": category, "description": text})


def _add_units(root: Element, units: Iterable[str]) -> None:
    definitions = SubElement(root, "UnitDefinitions")
    for unit in dict.fromkeys(units):
        element = SubElement(definitions, "Unit", {"name": unit})
        if _ROOT.search(unit):
            base_unit(_ROOT.sub("", unit))
            continue  # FMI has whole exponents only; a unit without base unit is not converted
        exponents, factor = base_unit(unit)
        attributes = {name: str(exponents[name]) for name in _BASE_NAMES if exponents.get(name)}
        if factor != 1.0:
            attributes["factor"] = repr(factor)
        SubElement(element, "BaseUnit", attributes)


@cache
def base_unit(unit: str) -> tuple[dict[str, int], float]:
    """Exponents of the FMI base units and the factor of a unit such as "N.m.s/rad" or "J/(kg.K)"."""
    numerator, slash, denominator = unit.partition("/")
    if denominator.startswith("(") and denominator.endswith(")"):
        denominator = denominator[1:-1]
    elif "." in denominator:
        raise ComponentError(f"unit {unit!r}: put a denominator of several factors in parentheses")
    exponents: dict[str, int] = {}
    factor = 1.0
    for part, sign in ((numerator, 1), (denominator, -1)):
        for text in part.split(".") if part or sign == 1 or slash else ():
            match = _FACTOR.fullmatch(text)
            if match is None or match[1] not in _SYMBOLS:
                raise ComponentError(f"unit {unit!r}: {text!r} is not one of {', '.join(_SYMBOLS)}")
            power = sign * int(match[2] or 1)
            symbol_exponents, symbol_factor = _SYMBOLS[match[1]]
            factor *= symbol_factor**power
            for base, exponent in symbol_exponents.items():
                exponents[base] = exponents.get(base, 0) + power * exponent
    return exponents, factor


def _add_variables(root: Element, variables: Sequence[Scalar], starts: Sequence[float]) -> None:
    parent = SubElement(root, "ModelVariables")
    for variable in variables:
        quantity = variable.quantity
        attributes = {
            "name": variable.name,
            "valueReference": str(variable.value_reference),
            "description": quantity.description,
            "causality": variable.causality,
            "variability": variable.variability,
        }
        real = {"unit": quantity.unit}
        if quantity.minimum is not None:
            real["min"] = repr(float(quantity.minimum))
        if quantity.maximum is not None:
            real["max"] = repr(float(quantity.maximum))
        if variable.causality == "output":
            attributes["initial"] = "calculated"
        else:
            real["start"] = repr(float(starts[variable.value_reference]))
        SubElement(SubElement(parent, "ScalarVariable", attributes), "Real", real)


def _add_structure(root: Element, component: Component, variables: Sequence[Scalar]) -> None:
    """Outputs depend on inputs only with feedthrough; observations, made for people, may always do so.

    In initialization mode everything calculated depends on all parameters and inputs through `initial`.
    """
    structure = SubElement(root, "ModelStructure")
    n_outputs = component.output_layout.size
    calculated = [v.value_reference + 1 for v in variables if v.causality == "output"]
    inputs = _index_list(v for v in variables if v.causality == "input")
    known = _index_list(v for v in variables if v.causality != "output")
    if calculated:
        outputs = SubElement(structure, "Outputs")
        for position, index in enumerate(calculated):
            free = position < n_outputs and not component.feedthrough
            SubElement(outputs, "Unknown", {"index": str(index), "dependencies": "" if free else inputs})
        unknowns = SubElement(structure, "InitialUnknowns")
        for index in calculated:
            SubElement(unknowns, "Unknown", {"index": str(index), "dependencies": known})


def _index_list(variables: Iterable[Scalar]) -> str:
    return " ".join(str(variable.value_reference + 1) for variable in variables)
