"""What model exchange adds to an FMI 2.0 model description: continuous states, their rates, and the structure.

States and rates are local variables behind all others, so no value reference moves. Every state starts from
what the parameters and inputs of initialization mode make of it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from lxml.etree import Element, SubElement, _Element

from components import Component, ContinuousStates

from .variables import scalars

_CAPABILITIES = {
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "providesDirectionalDerivative": "true",
}


def state_units(component: Component) -> Iterator[str]:
    """Units of states and rates."""
    if component.continuous is not None:
        yield from (quantity.unit for quantity in component.continuous.quantities)
        yield from component.continuous.rate_units


def add_model_exchange(root: _Element, component: Component, name: str) -> None:
    """Make a complete description for co-simulation one for model exchange too, where the component has that."""
    states = component.continuous
    if states is None:
        return
    attributes = {"modelIdentifier": name, **_CAPABILITIES}
    if type(component).update is Component.update:
        attributes["completedIntegratorStepNotNeeded"] = "true"
    root.insert(0, Element("ModelExchange", attributes))
    root.set("numberOfEventIndicators", str(states.indicators))
    first = sum(1 for _ in scalars(component)) + 1
    (variables,), (structure,) = root.iter("ModelVariables"), root.iter("ModelStructure")
    _add_variables(variables, states, first)
    _add_structure(structure, component, states, first)


def _add_variables(parent: _Element, states: ContinuousStates, first: int) -> None:
    """States, then rates, as local variables from the index `first` on."""
    declared = [
        (quantity, unit, name)
        for quantity, unit in zip(states.quantities, states.rate_units, strict=True)
        for name in quantity.scalar_names()
    ]
    nominals = states.nominals().tolist()
    for i, (quantity, _, name) in enumerate(declared):
        text = f"State: {quantity.description[0].lower()}{quantity.description[1:]}"
        real = {"unit": quantity.unit, "nominal": repr(nominals[i])}
        _add_local(parent, name, first + i, text, real)
    for i, (_, unit, name) in enumerate(declared):
        real = {"unit": unit, "derivative": str(first + i)}
        _add_local(parent, f"der({name})", first + len(declared) + i, f"Rate of {name}", real)


def _add_local(parent: _Element, name: str, index: int, description: str, real: dict[str, str]) -> None:
    attributes = {
        "name": name,
        "valueReference": str(index - 1),
        "description": description,
        "causality": "local",
        "variability": "continuous",
        "initial": "calculated",
    }
    SubElement(SubElement(parent, "ScalarVariable", attributes), "Real", real)


def _add_structure(structure: _Element, component: Component, states: ContinuousStates, first: int) -> None:
    """Rates and ports depend on all states but the quadratures; observations may depend on any."""
    parameters, inputs, outputs, _ = (layout.size for layout in component.layouts)
    n = len(states.places)
    names = [q.name for q in states.quantities for _ in range(q.size)]
    acting = [first + i for i, name in enumerate(names) if name not in states.quadratures]
    observed = parameters + inputs + outputs
    for unknown in structure.iterfind("Outputs/Unknown"):
        extra = range(first, first + n) if int(unknown.get("index", "0")) > observed else acting
        unknown.set("dependencies", f"{unknown.get('dependencies', '')} {_joined(extra)}".strip())
    if not n:
        return
    rates = Element("Derivatives")
    dependencies = _joined([*range(parameters + 1, parameters + inputs + 1), *acting])
    for index in range(first + n, first + 2 * n):
        SubElement(rates, "Unknown", {"index": str(index), "dependencies": dependencies})
    structure.insert(len(structure.findall("Outputs")), rates)
    unknowns = structure.find("InitialUnknowns")
    if unknowns is None:
        unknowns = SubElement(structure, "InitialUnknowns")
    for index in range(first, first + 2 * n):
        unknown = SubElement(unknowns, "Unknown", {"index": str(index)})
        if index < first + n and not component.starts_from_inputs:
            unknown.set("dependencies", _joined(range(1, parameters + 1)))


def _joined(indices: Iterable[int]) -> str:
    return " ".join(map(str, indices))
