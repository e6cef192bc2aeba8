"""Structured names: examples of the standard, what is none, and random ones as FMPy's grammar sees them."""

from types import SimpleNamespace

import numpy as np
import pytest
from fmpy.validation import _validate_variable_names

from fmus.check.names import name_problems

PIECES = ("a", "B_9", "der(", ")", "[", "]", "[12]", "[1,2]", "1", ",2", ".", "_", " ", "-", "é", "\n")
QUOTED = "'x y-[1].(a)'"


@pytest.mark.parametrize(
    "name",
    [
        "vehicle.engine.speed",
        "resistor12.u",
        "v_min",
        "robot.axis.'motor #234'",
        "der(pipe[3,4].T[14],2)",
        "pipe[3,4].T[14]",
        r"'\'quoted\' and \\ escaped'",
    ],
)
def test_names_of_the_standard(name):
    """Most are the examples of FMI 2.0, section 2.2.9."""
    assert list(name_problems([name])) == []


@pytest.mark.parametrize(
    "name",
    [
        "",
        "2a",
        "a.",
        ".a",
        "a..b",
        "a[]",
        "a[1",
        "a[1,]",
        "the hold",
        "der(a",
        "der(a,b)",
        "der(der(a))",
        "''",
        "é",
    ],
)
def test_what_is_no_name_is_told(name):
    (problem,) = name_problems([name])
    assert repr(name) in problem


def test_random_names_are_judged_as_by_fmpy():
    """An independent formulation; quotes in quotes, which FMPy lets through, are left out."""
    rng = np.random.default_rng(5)
    names = ["".join(rng.choice(PIECES[: rng.integers(1, 17)], size=rng.integers(1, 6))) for _ in range(150)]
    names += [name.replace("B_9", QUOTED, 1) for name in names if "B_9" in name][:30]
    variables = [SimpleNamespace(name=name, sourceline=i) for i, name in enumerate(names)]
    described = SimpleNamespace(variableNamingConvention="structured", modelVariables=variables)
    told = "".join(_validate_variable_names(described))
    refused = [name for i, name in enumerate(names) if f'"{name}" (line {i}) is not' in told]
    assert refused == [name for name in names if list(name_problems([name]))]
    assert 30 < len(refused) < len(names) - 30  # control: both happen
