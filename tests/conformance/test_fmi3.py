"""Every kind with a native kernel as an FMU of FMI 3.0: valid, equal to the component, with events where it has any.

FMUs are loaded in subprocesses, because a fault in a binary would end pytest.
"""

from __future__ import annotations

import zipfile
from functools import cache
from xml.etree import ElementTree

import pytest
from fmpy.validation import validate_fmu

from components import ComponentError
from fmus import check_fmu, native_backend, native_library
from fmus.description.choices import TYPES
from tests.conformance.programs import apart
from tests.conformance.programs.driver import KINDS, built, start_of
from tests.conformance.programs.latching import CHECKS as LATCHING
from tests.conformance.programs.latching import START, hinge
from tests.conformance.programs.toy import Toy
from tests.conformance.test_check import spoiled
from tests.conformance.test_fmus import rows_alone

NATIVE = [kind for kind, component in KINDS.items() if native_backend(component.example())]
CHECKS = (
    "equal", "serialization", "reset", "instances", "order", "values", "parameter", "access", "derivative",
    "event_mode",
)  # fmt: skip

pytestmark = pytest.mark.skipif(native_library() is None, reason="there is no native library here")


@cache
def path_of(kind):
    component = KINDS[kind].example()
    return str(built(component, kind, start=start_of(component), fmi="3.0"))


@cache
def latching_path():
    return str(built(hinge(), "latching", start=START, fmi="3.0"))


findings = cache(apart.findings)


def description(path):
    with zipfile.ZipFile(path) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


@pytest.mark.parametrize("kind", NATIVE)
def test_has_no_problems(kind):
    assert validate_fmu(path_of(kind)) == []
    assert check_fmu(path_of(kind)) == []


def test_all_run_without_fanfold(tmp_path):
    paths = [path_of(kind) for kind in NATIVE]
    assert rows_alone(paths, tmp_path) == dict.fromkeys(paths, 11)


@pytest.mark.parametrize("check", CHECKS)
@pytest.mark.parametrize("kind", NATIVE)
def test_behaves(kind, check):
    assert findings("trial3.py", "native", f"{kind}={path_of(kind)}")[check] == ""


def test_all_kinds_share_one_process():
    assert findings("trial3.py", "native", *(f"{kind}={path_of(kind)}" for kind in NATIVE)) == {
        "together": ""
    }


@pytest.mark.parametrize("check", LATCHING)
def test_latch_up(check):
    assert findings("latching.py", latching_path())[check] == ""


@pytest.mark.parametrize("kind", NATIVE)
def test_variables_are_the_declared_quantities(kind):
    component = KINDS[kind].example()
    found = description(path_of(kind)).findall("ModelVariables/*")
    time = found.pop()
    assert (time.get("name"), time.get("causality")) == ("time", "independent")
    declared = [q for layout in component.layouts for q in layout.quantities]
    position = 0
    for variable, quantity in zip(found, declared, strict=True):
        dimensions = [int(d.get("start")) for d in variable.findall("Dimension")]
        assert variable.get("name") == quantity.name
        assert variable.tag == TYPES["3.0"][quantity.kind]
        assert (variable.get("unit") is None) == (quantity.kind != "real")
        assert int(variable.get("valueReference")) == position
        assert dimensions == ([quantity.size] if quantity.size > 1 else [])
        assert len((variable.get("start") or "").split()) in (0, quantity.size)
        position += quantity.size
    assert int(time.get("valueReference")) == position


@pytest.mark.parametrize("kind", NATIVE)
def test_every_port_is_a_terminal(kind):
    component = KINDS[kind].example()
    with zipfile.ZipFile(path_of(kind)) as archive:
        root = ElementTree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
    terminals = root.findall("Terminals/Terminal")
    assert [t.get("name") for t in terminals] == [port.name for port in component.ports]
    for terminal, port in zip(terminals, component.ports, strict=True):
        members = {m.get("memberName"): m for m in terminal.findall("TerminalMemberVariable")}
        assert list(members) == ["position", "orientation", "velocity", "angular_velocity", "force", "torque"]
        assert all(m.get("variableName") == f"{port.name}.{name}" for name, m in members.items())
        assert members["force"].get("variableKind") == ("inflow" if port.side == "body" else "outflow")


def test_only_a_latch_of_an_instant_returns_early():
    found = {
        path: description(path).find("CoSimulation").get("mightReturnEarlyFromDoStep")
        for path in (latching_path(), *map(path_of, NATIVE))
    }
    assert found.pop(latching_path()) == "true"
    assert set(found.values()) == {None}


def test_a_python_fmu_of_fmi_3_is_refused():
    with pytest.raises(ComponentError, match="native"):
        built(KINDS["hinge"].example(), "hinge", backend="python", fmi="3.0")
    with pytest.raises(ComponentError, match="kernel"):
        built(Toy.example(), "toy", fmi="3.0")


TERMINALS = "terminalsAndIcons/terminalsAndIcons.xml"
DESCRIPTION = "modelDescription.xml"


@pytest.mark.parametrize(
    ("member", "pattern", "replacement", "sentence"),
    [
        (DESCRIPTION, b'fmiVersion="3.0"', b'fmiVersion="3.1"', " 3.0"),
        (
            DESCRIPTION,
            b'<InitialUnknown valueReference="[0-9]*"[^>]*>',
            b"",
            "ModelStructure/Init",
        ),
        (DESCRIPTION, b'(<Output [^>]*dependencies=")', rb"\g<1>9999 ", "9999"),
        (DESCRIPTION, b'(generationDateAndTime="[^"]*)Z"', rb'\1+00:00"', " 2026"),
        (DESCRIPTION, b'name="hold"', b'name="the hold"', "the hold"),
        (DESCRIPTION, b'unit="N" ?', b"", "unit"),
        (DESCRIPTION, b'canGetAndSetFMUState="true"', b"", "canGetAndSetFMUState"),
        (DESCRIPTION, b'instantiationToken="{.', b'instantiationToken="{x', "belong together"),
        (
            TERMINALS,
            b'variableName="inboard.force"',
            b'variableName="inboard.push"',
            "inboard.push",
        ),
        (TERMINALS, b'matchingRule="plug"', b"", "matchingRule"),
        (TERMINALS, b"</Terminals>", b"", "not well-formed"),
        (
            DESCRIPTION,
            b'valueReference="3" description',
            b'valueReference="0" description',
            "reference 0: ",
        ),
        ("binaries/.*", b"", None, "binary"),
        ("resources/component.bin", b"FANFOLD", b"fanfold", "instantiated"),
    ],
)
def test_check_names_each_problem(tmp_path, member, pattern, replacement, sentence):
    path = spoiled(path_of("hinge"), tmp_path, member, pattern, replacement)
    problems = check_fmu(path)
    assert any(sentence in problem for problem in problems), problems
