"""Booleans and integers of a wing as one FMU, as FMI 2.0 (2.2.7) and FMI 3.0 (2.4.7) have them."""

from __future__ import annotations

import fmpy
import pytest
from fmpy.fmi1 import FMICallException

import orchestrator as fanfold
from fmus import check_fmu, native_library
from tests.unit.run.as_one.host import Host, latching
from tests.unit.run.as_one.host3 import Host3

pytestmark = pytest.mark.skipif(native_library() is None, reason="a scene as one FMU is native")
TYPES = {"2.0": ("Real", "Integer"), "3.0": ("Float64", "Int32")}
"""Those of numbers."""


@pytest.fixture(scope="module", params=TYPES)
def fmi(request):
    return request.param


@pytest.fixture(scope="module")
def path(fmi, tmp_path_factory):
    (found,) = fanfold.export(
        latching(), tmp_path_factory.mktemp("types"), as_one=True, driven_base=True, fmi=fmi
    )
    return found


def started(fmi, path):
    return Host(path).start() if fmi == "2.0" else Host3(path)


def test_types_are_declared(fmi, path):
    """Of what is 0 or 1 and of counts; the descriptions are valid by the official schemas and by FMPy."""
    assert check_fmu(path) == []
    real, integer = TYPES[fmi]
    found = {v.name: v for v in fmpy.read_model_description(str(path)).modelVariables}
    kinds = {
        "HL.latched": "Boolean",
        "HL.latch_command": "Boolean",
        "HL.unlatch_command": "Boolean",
        "root.latch_automatic": "Boolean",
        "base_meets_rates": "Boolean",
        "steps": integer,
        "root.order": integer,
        "HL.latch_time": real,
        "root.angle": real,
    }
    assert {name: found[name].type for name in kinds} == kinds
    assert {v.variability for v in found.values() if v.type not in TYPES[fmi]} == {
        "discrete",
        "fixed",
        "tunable",
    }
    assert {v.unit for v in found.values() if v.type != real} == {None}
    assert (found["root.order"].min, found["root.order"].max) == ("4", "4")


def test_a_boolean_commands_and_reports_a_latch(fmi, path):
    """In FMI 3.0 at an event, where discrete inputs change; the count of steps is a whole number."""
    host = started(fmi, path)
    (host.to(0.3, 0.1) if fmi == "2.0" else host.step(0.3))
    assert host["HL.latched"] == 0
    if fmi == "2.0":
        host["HL.latch_command"] = True
        host.to(0.31, 0.01)
    else:
        host.event(**{"HL.latch_command": True})
    assert host["HL.latched"] in (1, True)
    assert host["HL.latch_time"] == pytest.approx(0.3, abs=1e-9)
    assert isinstance(host["steps"], int)
    assert host["steps"] > 3


def test_a_call_of_another_type_is_an_error(fmi, path):
    """It changes nothing, and what it says has the name and type of the variable."""
    host = started(fmi, path)
    real, integer = TYPES[fmi]
    references = {v.name: v.valueReference for v in fmpy.read_model_description(str(path)).modelVariables}
    wrong = {
        "HL.latch_command": (real, integer),
        "steps": (real, "Boolean"),
        "root.angle": ("Boolean", integer),
    }
    for name, types in wrong.items():
        for kind in types:
            with pytest.raises(FMICallException) as error:
                getattr(host.fmu, f"get{kind}")([references[name]])
            assert error.value.status == 3
    with pytest.raises(FMICallException):
        getattr(host.fmu, f"set{real}")([references["HL.latch_command"]], [1.0])
    if fmi == "2.0":
        assert "HL.latch_command is a Boolean; it has no value of type Real" in host.said[-1]
    assert host["HL.latch_command"] in (0, False)
