"""Every problem of an FMU as a sentence: of its file, its model description, and a short run of it."""

from __future__ import annotations

import re
import tempfile
import zipfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Literal, Self
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import fmpy
from fmpy import extract
from fmpy.model_description import ValidationError, read_model_description
from lxml import etree

from components.cache.temporary import process_folder

from ..archive import archive_problems
from ..description.binaries import binary_member
from ..host.process import FmuProcess, HostError
from .names import name_problems

_DATE = re.compile(r"-?\d{4,}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?Z")
_STATE_FLAGS = {
    "2.0": ("canGetAndSetFMUstate", "canSerializeFMUstate"),
    "3.0": ("canGetAndSetFMUState", "canSerializeFMUState"),
}
_TERMINALS = "terminalsAndIcons/terminalsAndIcons.xml"
_STEPPED = ("CoSimulation", "ModelExchange")
"""Interface types that Fanfold steps, in this order; the third is scheduled execution."""
_SCHEMAS = Path(fmpy.__file__).parent / "schema"
_TRIAL_SECONDS = 120.0
_STEP = 1e-3
"""Of an FMU that says none (s)."""
_LARGEST_DESCRIPTION = 50_000_000
"""Bytes, of a quarter of a million variables; a schema takes minutes for more."""
Kind = Literal["breaks the standard", "Fanfold needs", "advice"]


class Problem(str):
    """A problem of an FMU as a sentence, and of which kind it is."""

    kind: Kind

    def __new__(cls, text: str, kind: Kind = "breaks the standard") -> Self:
        """A sentence of a kind."""
        problem = super().__new__(cls, text)
        problem.kind = kind
        return problem


def check_fmu(path: str | Path, run: bool = True) -> list[Problem]:
    """Every problem found in an FMU 2.0 or 3.0; an empty list means it is fine.

    run: whether to make two steps, in a process of its own, of an FMU that breaks the standard nowhere.
    """
    found = dict.fromkeys(_problems(Path(path), run))
    return [one if isinstance(one, Problem) else Problem(one) for one in found]


def _problems(path: Path, run: bool) -> list[str]:
    if path.is_dir():
        return [f"{path} is a folder; an FMU is one file, a zip archive of such a folder's content"]
    if not path.is_file():
        return [f"there is no file {path}"]
    if not zipfile.is_zipfile(path):
        return [f"{path.name} is not a zip archive"]
    if damaged := list(archive_problems(path)):
        return damaged
    with zipfile.ZipFile(path) as archive:
        members = {member.filename: member.file_size for member in archive.infolist()}
        crooked = [member.orig_filename for member in archive.infolist() if "\\" in member.orig_filename]
        if "modelDescription.xml" not in members:
            return [f"{path.name} has no modelDescription.xml"]
        if members["modelDescription.xml"] > _LARGEST_DESCRIPTION:
            return [
                f"modelDescription.xml has more than {_LARGEST_DESCRIPTION / 1e6:.0f} MB, too much to check"
            ]
        text = archive.read("modelDescription.xml")
        terminals = archive.read(_TERMINALS) if _TERMINALS in members else None
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError, LookupError) as error:  # of encodings as well
        return [f"modelDescription.xml is not well-formed: {error}"]
    if unfit := _unfit(root):
        return [unfit]
    missing = list(_missing_binary(root, set(members)))
    problems = [f"the path of its member {name!r} has a backslash; FMI has slashes" for name in crooked]
    problems += [*_validated(path, root), *_common_problems(root), *missing, *_structured(root, terminals)]
    if run and not missing and all(isinstance(problem, Problem) for problem in problems):
        problems += _trial_problems(path)
    return problems


def _unfit(root: Element) -> str:
    """Why an FMU has nothing to check here; empty where it has: another version of FMI, another interface type."""
    if root.get("fmiVersion", "") not in ("2.0", "3.0"):
        return "it is not an FMU 2.0 or 3.0"
    if _interface(root) is not None:
        return ""
    if root.find("ScheduledExecution") is None:
        return "it has no interface type, neither co-simulation nor another"
    return Problem("co-simulation or model exchange; this FMU has scheduled execution only", "Fanfold needs")


def _interface(root: Element) -> Element | None:
    """The interface type that Fanfold steps, if there is one."""
    return next((found for tag in _STEPPED if (found := root.find(tag)) is not None), None)


def _structured(root: Element, terminals: bytes | None) -> list[str]:
    """What each version of FMI has in variables, structure and terminals."""
    try:
        if root.get("fmiVersion") == "2.0":
            return list(_problems_of_2(root))
        return [*_problems_of_3(root), *_terminal_problems(root, terminals)]
    except ValueError:
        return ["ModelStructure has indices or references that are no numbers"]


def _validated(path: Path, root: Element) -> Iterator[str]:
    """FMPy's findings, one line each; structured names apart, of which its parser reads a hundred a second."""
    structured = root.get("variableNamingConvention") == "structured"
    if structured:
        yield from name_problems(v.get("name", "") for v in root.iterfind("ModelVariables/*"))
    try:
        read_model_description(
            str(path), validate_variable_names=not structured, validate_model_structure=True
        )
    except ValidationError as error:
        yield from (" ".join(str(problem).split()) for problem in error.problems)
    except Exception as error:  # of a description that FMPy has no sentence for
        yield f"modelDescription.xml cannot be read: {type(error).__name__}: {' '.join(str(error).split())}"


def _common_problems(root: Element) -> Iterator[str]:
    """What every version of FMI has in the root element and as capabilities."""
    date = root.get("generationDateAndTime")
    if date is not None and not _DATE.fullmatch(date):
        yield Problem(f"generationDateAndTime is {date!r}; it must look like 2026-11-21T02:00:00Z", "advice")
    if root.get("variableNamingConvention") != "structured":
        yield Problem("variableNamingConvention is not structured", "advice")
    if root.find("CoSimulation") is None:
        yield Problem(
            "co-simulation for a component of a scene; with model exchange only it can be an [[fmu]] with signals",
            "Fanfold needs",
        )
        return
    for flag in _STATE_FLAGS[root.get("fmiVersion", "")]:
        if root.find(f"CoSimulation[@{flag}='true']") is None:
            yield Problem(
                f"{flag} is not true, so it can be no component of a scene; an [[fmu]] with signals can do without",
                "Fanfold needs",
            )


def _problems_of_2(root: Element) -> Iterator[str]:
    variables = root.findall("ModelVariables/ScalarVariable")
    yield from _unlike_aliases(variables)
    for variable in variables:
        real = variable.find("Real")
        if real is not None and not real.get("unit") and not real.get("declaredType"):
            yield Problem(f"Real variable {variable.get('name')} has no unit", "advice")
    by_index = dict(enumerate(variables, 1))
    for group in ("Outputs", "InitialUnknowns"):
        listed = _listed(root.findall(f"ModelStructure/{group}/Unknown"), "index")
        yield from _structure_problems(group, "variable", by_index, listed)


def _unlike_aliases(variables: Iterable[Element]) -> Iterator[str]:
    """Variables of FMI 2.0 that share a value reference must have one type and unit and be one value, 2.2.7."""
    by_place: dict[tuple[str, str], tuple[Element, Element]] = {}
    for variable in variables:
        value = variable[0] if len(variable) else variable
        place = (value.tag, variable.get("valueReference", ""))
        first, its_value = by_place.setdefault(place, (variable, value))
        if first is variable:
            continue
        both = f"{first.get('name')} and {variable.get('name')} have the same value reference {place[1]}"
        settable = [one for one in (first, variable) if one.get("causality") in ("input", "parameter")]
        if len(settable) == 2:
            yield f"{both}, and both may be set"
        elif its_value.get("unit") != value.get("unit"):
            yield f"{both}, and units {its_value.get('unit')} and {value.get('unit')}"


def _problems_of_3(root: Element) -> Iterator[str]:
    variables = root.findall("ModelVariables/*")
    references = Counter(variable.get("valueReference") for variable in variables)
    for reference, count in references.items():
        if count > 1:
            names = ", ".join(str(v.get("name")) for v in variables if v.get("valueReference") == reference)
            yield f"these have the same value reference {reference}: {names}; it belongs to one variable"
    for variable in variables:
        if variable.tag == "Float64" and not variable.get("unit") and not variable.get("declaredType"):
            yield Problem(f"Float64 variable {variable.get('name')} has no unit", "advice")
    by_reference = {int(v.get("valueReference", "0")): v for v in variables}
    for group in ("Output", "InitialUnknown"):
        listed = _listed(root.findall(f"ModelStructure/{group}"), "valueReference")
        yield from _structure_problems(group, "value reference", by_reference, listed)


def _listed(unknowns: Iterable[Element], key: str) -> dict[int, list[int]]:
    """Dependencies of the unknowns of the model structure."""
    return {int(u.get(key, "0")): [int(i) for i in (u.get("dependencies") or "").split()] for u in unknowns}


def _structure_problems(
    group: str, what: str, variables: Mapping[int, Element], listed: Mapping[int, list[int]]
) -> Iterator[str]:
    """Completeness of outputs or initial unknowns, and that whatever they refer to is a variable."""
    for unknown, known in listed.items():
        for bad in (i for i in (unknown, *known) if i not in variables):
            yield f"{group} refers to {what} {bad}; there is none"
    for key, variable in variables.items():
        output = variable.get("causality") == "output"
        calculated = output and variable.get("initial", "calculated") != "exact"
        if group.startswith("Initial"):
            output = calculated or variable.get("causality") == "calculatedParameter"
        if output and key not in listed:
            yield f"{variable.get('name')} is missing in ModelStructure/{group}"


def _terminal_problems(root: Element, text: bytes | None) -> Iterator[str]:
    """Terminals must fit FMI's schema and name variables that there are."""
    if text is None:
        return
    try:
        document = etree.fromstring(text)
    except etree.XMLSyntaxError as error:
        yield f"{_TERMINALS} is not well-formed: {error}"
        return
    schema = etree.XMLSchema(file=str(_SCHEMAS / "fmi3" / "fmi3TerminalsAndIcons.xsd"))
    if not schema.validate(document):
        yield from (f"{_TERMINALS}, line {error.line}: {error.message}" for error in schema.error_log)
    names = {variable.get("name") for variable in root.iterfind("ModelVariables/*")}
    for member in document.iter("TerminalMemberVariable"):
        if member.get("variableName") not in names:
            yield f"{_TERMINALS} names the variable {member.get('variableName')}; there is none"


def _missing_binary(root: Element, members: set[str]) -> Iterator[str]:
    identifier = _interface(root).get("modelIdentifier")  # type: ignore[union-attr] # checked
    binary = binary_member(root.get("fmiVersion", ""), identifier or "")
    if binary not in members:
        yield Problem(f"there is no binary for this platform, {binary}", "Fanfold needs")


def _trial_problems(path: Path) -> Iterator[str]:
    """What goes wrong in two steps with the default start values, in a process of its own."""
    description = read_model_description(str(path), validate=False)
    interface = description.coSimulation or description.modelExchange
    experiment = description.defaultExperiment
    h = float(experiment.stepSize or _STEP) if experiment is not None else _STEP
    restored = ("save_and_restore", [bool(interface.canSerializeFMUstate)])
    with tempfile.TemporaryDirectory(dir=process_folder()) as folder:
        requests: dict[str, tuple[str, Sequence[object]]] = {
            "instantiated": ("instantiate", [folder, "trial"]),
            "initialized with its default start values": ("initialize", [{}, {}, None]),
            f"stepped by {h:g} s with its default start values": ("step", [0.0, h]),
            **({"saved and restored": restored} if interface.canGetAndSetFMUstate else {}),
            "stepped a second time": ("step", [h, h]),
            "read": ("not_finite", []),
            "ended": ("close", []),
        }
        try:
            extract(str(path), folder)
        except Exception as error:
            yield f"it cannot be unpacked: {' '.join(str(error).split())}"
            return
        with FmuProcess(_TRIAL_SECONDS, quiet=True) as process:
            for doing, (name, arguments) in requests.items():
                try:
                    found = process.request(name, *arguments)
                except HostError as error:
                    yield f"it cannot be {doing}: {error}"
                    return
                if name == "instantiate":
                    yield from (f"its binary has no function {function}" for function in found)
                elif name == "not_finite" and found:
                    yield f"it cannot be read: after two steps {found[0]}"
