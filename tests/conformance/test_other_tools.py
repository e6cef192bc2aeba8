"""Exported FMUs under the plain command line of another tool: FMPy's, as its users type it.

One native FMU of every kind, its connections with the end-point wrench as `fanfold export` writes them, moved by its
start values.
"""

from __future__ import annotations

import sys
from functools import cache

import fmpy.cli
import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException

from components import REGISTRY
from fmus import native_library
from tests.conformance.programs.driver import built, start_of
from tests.conformance.programs.exchange_pair import SUBJECTS

STOP = 0.5
SUBJECT_OF = {make().kind: make for make in reversed(SUBJECTS.values())}
CO_SIMULATION_ONLY = {"beam"}
"""Kinds without equations for another solver."""
INTERFACES = [("2.0", "ModelExchange"), ("2.0", "CoSimulation"), ("3.0", "CoSimulation")]
SOLVER_ERROR = 500 * 1e-5
"""Of the largest scalar of an output: FMPy's tolerance of a step, times the outputs; the body's rates are asked for 291
times, so there are fewer steps."""
PRINTED = 1e-15
"""Relative: the last of the 16 digits that FMPy writes."""
MOTION = {"velocity": (0.02, -0.01, 0.03), "angular_velocity": (0.1, 0.2, -0.1)}
FLIGHT = {
    "gravity": (0.0, 0.3, -1.6),
    "initial_velocity": (0.2, 0.0, 0.1),
    "initial_angular_velocity": (0.1, -0.2, 0.15),
}

pytestmark = pytest.mark.skipif(native_library() is None, reason="there is no native library here")


def start_values(component):
    """A body in free flight; the ports of a connection apart, each in another motion."""
    start = dict(FLIGHT if component.kind == "body" else start_of(component))
    for name, values in MOTION.items():
        moved = [q.name for q in component.input_layout.quantities if q.name.endswith("." + name)]
        start.update({port: np.multiply(k + 1.0, values) for k, port in enumerate(moved)})
    return start


def component_of(kind):
    return SUBJECT_OF.get(kind, REGISTRY[kind].example)()


@cache
def path_of(kind, fmi):
    component = component_of(kind)
    return str(built(component, kind, start=start_values(component), backend="native", fmi=fmi))


@pytest.mark.parametrize("kind", ["hinge", "eddy_current_damper", "ccl", "contact"])
def test_a_quaternion_of_zeros_is_named(kind):
    """Rule: tools that set all inputs to zero before anything is connected are told which one cannot be."""
    component = component_of(kind)
    name = next(q.name for q in component.input_layout.quantities if q.name.endswith(".orientation"))
    said: list[bytes] = []
    with pytest.raises(FMICallException):
        simulate_fmu(
            path_of(kind, "2.0"),
            stop_time=0.01,
            start_values={f"{name}[{k}]": 0.0 for k in range(1, 5)},
            logger=lambda environment, instance, status, category, message: said.append(message),
        )
    assert f"input {name} is zero; connect it" in b" ".join(said).decode()


@pytest.fixture
def simulated(tmp_path, monkeypatch, capfd):
    """Rows of FMPy's result file, time first, by kind, version and interface; nothing may be said."""

    def simulate(kind, fmi, interface):
        found = tmp_path / f"{interface}{fmi}.csv"
        plain = ["simulate", path_of(kind, fmi), "--interface-type", interface, "--stop-time", str(STOP)]
        monkeypatch.setattr(sys, "argv", ["fmpy", *plain, "--output-file", str(found)])
        fmpy.cli.main()
        assert tuple(capfd.readouterr()) == ("", "")
        text = found.read_text().replace("False", "0").replace("True", "1")
        lines = text.splitlines()[1:]
        return np.array(
            [line.replace(",", " ").split() for line in lines], dtype=float
        )  # arrays are one column

    return simulate


@pytest.mark.parametrize("kind", REGISTRY)
def test_runs_by_the_plain_command(kind, simulated):
    """To the stop time, and the solver's end is that of the component's own steps, but for moments over a step."""
    stepped = [simulated(kind, *interface) for interface in INTERFACES[1:]]
    exchanged = stepped[0] if kind in CO_SIMULATION_ONLY else simulated(kind, *INTERFACES[0])
    for rows in (exchanged, *stepped):
        assert (rows[0, 0], rows[-1, 0]) == (0.0, pytest.approx(STOP, abs=1e-9))
        assert np.all(np.diff(rows[:, 0]) >= 0.0)
        assert np.all(np.isfinite(rows))
    np.testing.assert_allclose(stepped[0], stepped[1], rtol=PRINTED, err_msg="FMI 3.0 is another component")
    layout = component_of(kind).output_layout
    found, expected = (rows[-1, 1 : 1 + layout.size] for rows in (exchanged, stepped[0]))
    for quantity in layout.quantities:
        place = layout[quantity.name]
        if quantity.name.endswith("_moment") and kind not in CO_SIMULATION_ONLY:
            assert not found[place].any(), f"{quantity.name} without steps"
            continue
        error, size = np.abs(found[place] - expected[place]).max(), np.abs(expected[place]).max()
        assert error <= SOLVER_ERROR * size, f"{quantity.name} by {error:g} of {size:g}"


def test_every_kind_offers_model_exchange():
    """Control: none is left out of the test above."""
    assert {
        kind for kind in REGISTRY if read_model_description(path_of(kind, "2.0")).modelExchange is None
    } == CO_SIMULATION_ONLY
