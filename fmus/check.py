"""Every problem of an FMU as a sentence: of its file, its model description, and a short run of it."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from fmpy import platform, sharedLibraryExtension
from fmpy.validation import validate_fmu

_DATE = re.compile(r"-?\d{4,}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?Z")
_STATE_FLAGS = ("canGetAndSetFMUstate", "canSerializeFMUstate")
_TRIAL_SECONDS = 120

_TRIAL = """
import json, sys
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave, calloc, free, fmi2CallbackAllocateMemoryTYPE as Allocate
from fmpy.fmi2 import fmi2CallbackFreeMemoryTYPE as Free, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

path, folder = sys.argv[1:]
log = []
def logger(environment, instance, status, category, message):
    if status:
        log.append((message or b"").decode(errors="replace"))
callbacks = fmi2CallbackFunctions()
callbacks.logger = fmi2CallbackLoggerTYPE(logger)
callbacks.allocateMemory = Allocate(calloc)
callbacks.freeMemory = Free(free)
description = read_model_description(path, validate=False)
interface = description.coSimulation
doing = "instantiated"
try:
    extract(path, folder)
    fmu = FMU2Slave(guid=description.guid, unzipDirectory=folder, instanceName="trial",
                    modelIdentifier=interface.modelIdentifier)
    fmu.instantiate(callbacks=callbacks, loggingOn=True)
    doing = "initialized with its default start values"
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    experiment = description.defaultExperiment
    h = float(experiment.stepSize or 1e-3) if experiment is not None else 1e-3
    doing = f"stepped by {h:g} s with its default start values"
    fmu.doStep(currentCommunicationPoint=0.0, communicationStepSize=h)
    if interface.canGetAndSetFMUstate:
        doing = "saved and restored"
        state = fmu.getFMUstate()
        if interface.canSerializeFMUstate:
            copy = fmu.deSerializeFMUstate(fmu.serializeFMUstate(state))
            fmu.setFMUstate(copy)
            fmu.freeFMUstate(copy)
        fmu.setFMUstate(state)
        fmu.freeFMUstate(state)
    doing = "stepped a second time"
    fmu.doStep(currentCommunicationPoint=h, communicationStepSize=h)
    doing = "read"
    outputs = [v for v in description.modelVariables if v.causality == "output" and v.type == "Real"]
    values = fmu.getReal([v.valueReference for v in outputs]) if outputs else []
    bad = [f"{v.name} is {y}" for v, y in zip(outputs, values) if not abs(y) < float("inf")]
    if bad:
        log.append(f"after two steps output {bad[0]}")
        raise ValueError
    doing = "ended"
    fmu.terminate()
    fmu.freeInstance()
except Exception as error:
    reason = log[0] if log else str(error)
    print("\\n" + json.dumps(f"it cannot be {doing}: {' '.join(reason.split())}"))
else:
    print("\\n" + json.dumps(""))
"""


def check_fmu(path: str | Path) -> list[str]:
    """Every problem found in an FMU 2.0 for co-simulation, as sentences; an empty list means it is fine."""
    path = Path(path)
    if not path.is_file():
        return [f"there is no file {path}"]
    if not zipfile.is_zipfile(path):
        return [f"{path.name} is not a zip archive"]
    with zipfile.ZipFile(path) as archive:
        members = set(archive.namelist())
        if "modelDescription.xml" not in members:
            return [f"{path.name} has no modelDescription.xml"]
        text = archive.read("modelDescription.xml")
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        return [f"modelDescription.xml is not well-formed: {error}"]
    if root.get("fmiVersion") != "2.0" or root.find("CoSimulation") is None:
        return [f"{path.name} is not an FMU 2.0 for co-simulation"]
    problems = [*_validated(path), *_description_problems(root), *_missing_binary(root, members)]
    if not problems:
        problems.extend(_trial_problems(path))
    return list(dict.fromkeys(problems))


def _validated(path: Path) -> list[str]:
    """FMPy's findings, one line each."""
    return [" ".join(str(problem).split()) for problem in validate_fmu(str(path))]


def _description_problems(root: Element) -> Iterator[str]:
    date = root.get("generationDateAndTime")
    if date is not None and not _DATE.fullmatch(date):
        yield f"generationDateAndTime is {date!r}; it must look like 2026-11-21T02:00:00Z"
    if root.get("variableNamingConvention") != "structured":
        yield "variableNamingConvention is not structured"
    for flag in _STATE_FLAGS:
        if root.find(f"CoSimulation[@{flag}='true']") is None:
            yield f"{flag} is not true, so no step can be repeated"
    variables = root.findall("ModelVariables/ScalarVariable")
    for variable in variables:
        real = variable.find("Real")
        if real is not None and not real.get("unit") and not real.get("declaredType"):
            yield f"Real variable {variable.get('name')} has no unit"
    yield from _structure_problems(root, variables)


def _structure_problems(root: Element, variables: list[Element]) -> Iterator[str]:
    """Completeness of Outputs and InitialUnknowns, and that every index is the index of a variable."""
    outputs = {i for i, v in enumerate(variables, 1) if v.get("causality") == "output"}
    initial = {
        i
        for i, v in enumerate(variables, 1)
        if v.get("causality") == "calculatedParameter"
        or (i in outputs and v.get("initial", "calculated") != "exact")
    }
    for group, expected in (("Outputs", outputs), ("InitialUnknowns", initial)):
        listed: set[int] = set()
        for unknown in root.findall(f"ModelStructure/{group}/Unknown"):
            index = int(unknown.get("index", "0"))
            listed.add(index)
            known = [int(i) for i in (unknown.get("dependencies") or "").split()]
            for bad in (i for i in (index, *known) if not 1 <= i <= len(variables)):
                yield f"{group} refers to variable {bad}; there are {len(variables)}"
        for index in sorted(expected - listed):
            yield f"{variables[index - 1].get('name')} is missing in ModelStructure/{group}"


def _missing_binary(root: Element, members: set[str]) -> Iterator[str]:
    identifier = root.find("CoSimulation").get("modelIdentifier")  # type: ignore[union-attr] # checked
    binary = f"binaries/{platform}/{identifier}{sharedLibraryExtension}"
    if binary not in members:
        yield f"there is no binary for this platform, {binary}"


def _trial_problems(path: Path) -> Iterator[str]:
    """What goes wrong in a short run, in a process of its own because a bad binary ends it."""
    with tempfile.TemporaryDirectory(prefix="fanfold_check_") as folder:
        command = [sys.executable, "-P", "-c", _TRIAL, str(path.resolve()), folder]
        try:
            run = subprocess.run(command, capture_output=True, text=True, timeout=_TRIAL_SECONDS)
        except subprocess.TimeoutExpired:
            yield f"two steps are not done after {_TRIAL_SECONDS} s"
            return
    if run.returncode < 0:
        yield f"the process that ran it ended with {signal.Signals(-run.returncode).name}"
    elif run.returncode > 0 or not run.stdout.strip():
        yield f"it cannot be run: {(run.stderr.strip().splitlines() or ['no message'])[-1]}"
    elif problem := json.loads(run.stdout.splitlines()[-1]):
        yield problem
