"""The description of an unpacked FMU: its variables by their role for a master, and Fanfold's annotation."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

from fmpy import read_model_description

from components import Layout, Quantity
from components.contract.roles import LATCH_DISTANCE, LATCHED, TIME_TO_BREAK
from fmus.archive import undated

from .ports import MOMENTS, MOTION, SLOPES, WRENCH
from .typed_functions import TYPES

_INDEX = re.compile(r"\[(\d+)\]$")
EVENT_OUTPUTS = (LATCH_DISTANCE.name, LATCHED.name, TIME_TO_BREAK.name)
"""Outputs that the master reads in addition to the ports: of latches, and times to breaks of motion laws."""
_ANNOTATION = "VendorAnnotations/Tool[@name='Fanfold']"
_MOST_DESCRIPTIONS = 64
_descriptions: dict[bytes, Described] = {}


class Described(NamedTuple):
    """The model description of an FMU, Fanfold's annotation in it, and its variables that are exchanged as numbers.

    Those are the real ones, Booleans and integers.
    """

    description: Any
    annotation: ElementTree.Element | None
    parameters: tuple[Layout, list[int]]
    inputs: tuple[Layout, list[int]]
    outputs: tuple[Layout, list[int]]
    observations: tuple[Layout, list[int]]

    @classmethod
    def of(cls, description: Any, annotation: ElementTree.Element | None) -> Described:  # noqa: ANN401
        """With variables by their role for a master: outputs are those that it exchanges, observations all others."""
        numbers = [v for v in description.modelVariables if v.type in TYPES]
        outputs = [v for v in numbers if v.causality == "output"]
        layout, observed = _group(v for v in outputs if not _is_coupled(v.name))
        return cls(
            description,
            annotation,
            _group(v for v in numbers if v.causality == "parameter"),
            _group(v for v in numbers if v.causality == "input"),
            _group(v for v in outputs if _is_coupled(v.name)),
            (_with_roles(layout, annotation), observed),
        )


def described_in(folder: Path) -> Described:
    """The description of an unpacked FMU; equal descriptions are read once."""
    file = folder / "modelDescription.xml"
    key = undated(file.read_bytes())
    if key not in _descriptions:
        if len(_descriptions) >= _MOST_DESCRIPTIONS:
            _descriptions.clear()
        _descriptions[key] = Described.of(
            read_model_description(str(folder), validate=False), ElementTree.parse(file).find(_ANNOTATION)
        )
    return _descriptions[key]


def _with_roles(layout: Layout, annotation: ElementTree.Element | None) -> Layout:
    """The observations with their roles from the annotation."""
    said = [] if annotation is None else annotation.findall(".//Observation")
    roles = {one.get("name", ""): one.get("role", "") for one in said}
    return Layout(replace(q, role=roles.get(q.name, "")) for q in layout.quantities)


def said_of(annotation: ElementTree.Element | None, element: str) -> ElementTree.Element | None:
    """An element of the annotation."""
    return None if annotation is None else annotation.find(f".//{element}")


def says(annotation: ElementTree.Element | None, element: str, attribute: str) -> bool:
    """Whether the annotation of Fanfold's own FMUs is there and makes a statement that the standard cannot."""
    return annotation is not None and annotation.find(f".//{element}[@{attribute}]") is not None


def _is_coupled(name: str) -> bool:
    base = _INDEX.sub("", name)
    return base in EVENT_OUTPUTS or (
        base.rpartition(".")[2] in (*MOTION, *WRENCH, *SLOPES, *MOMENTS) and "." in base
    )


def _start(variable: Any) -> float:  # noqa: ANN401 - of FMPy
    text = variable.start
    return float(text == "true" if text in ("true", "false") else text or 0.0)


def _group(variables: Iterable[Any]) -> tuple[Layout, list[int]]:
    """Scalars `name[1]`, `name[2]`, ... as one quantity each, and all value references in order."""
    quantities, references = [], []
    for name, members in groupby(variables, key=lambda v: _INDEX.sub("", v.name)):
        found = list(members)
        references += [v.valueReference for v in found]
        starts = tuple(_start(v) for v in found)
        first = found[0]
        quantities.append(
            Quantity(
                name,
                first.unit or "1",
                first.description or "",
                len(found),
                starts,
                kind=TYPES[first.type],
            )
        )
    return Layout(quantities), references
