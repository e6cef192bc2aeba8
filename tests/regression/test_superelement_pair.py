"""Nastran's superelements as FMUs: the public pair of pyYeti, welded and pushed, against its matrices assembled."""

from __future__ import annotations

from importlib.resources import files
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy import linalg

import orchestrator as fanfold
from components.imported.body import ImportedBody
from components.numerics.motion_law import MotionLaw
from orchestrator.cli.main import main
from tests.references.native_fmus import needs_native

pytestmark = needs_native
PAIR = Path(str(files("pyyeti"))) / "tests" / "nas2cam_extseout"
POINTS = {"a": 3, "b": 11, "c": 19, "d": 27}
INCHES = {"length": "25.4 mm", "mass": "175.1268 kg"}
PUSH = [{"profile": "step5", "start": 0.0, "duration": 0.3, "change": 10.0}]
"""N, along z on point a: rigid motion and bending, small enough for linear theory to hold to 1e-6."""
END, TOLERANCE = 1.0, 1e-4


def scene():
    """Both free in space, 24 coordinates shared by welds of 1e10 N/m, which move frequencies by less than 1e-6."""
    pair = fanfold.Scene("pair", until=END, tolerance=TOLERANCE)
    pair.base(points={"origin": (0, 0, 0)})
    pair.joint(axial_stiffness="1e10 N/m", radial_stiffness="1e10 N/m", cross_stiffness="1e10 N.m/rad")
    place = {"body": "base", "point": "origin"}
    for name in ("inboard", "outboard"):
        table = {"file": str(PAIR / f"{name}.asm"), "units": INCHES, "attachment_points": POINTS}
        pair.body(name, fixed_interface_modes=22, place=place, damping_ratio=0.0, **{"import": table})
    for point in POINTS:
        ports = {"inboard": ("inboard", point), "outboard": ("outboard", point)}
        pair.connection(f"weld_{point}", "hinge", preset="fixed", ports=ports)
    pair.connection(
        "push", "load", structure={"direction": (0, 0, 1), "force": PUSH}, ports={"body": ("outboard", "a")}
    )
    return pair


def assembled():
    """Stiffness and mass of both superelements on their shared coordinates, 6 a point, which come first.

    Then, by body, what its stresses and forces are by these.
    """
    units, points = {"length": 0.0254, "mass": 175.1268}, tuple(POINTS.items())
    paths = {name: str(PAIR / f"{name}.asm") for name in ("inboard", "outboard")}
    parts = {
        name: ImportedBody((("file", path),), name, points, **units).data() for name, path in paths.items()
    }
    size = 24 + sum(part.amplitudes for part in parts.values())
    stiffness, mass, outputs, first = np.zeros((size, size)), np.zeros((size, size)), {}, 24
    for name, part in parts.items():
        own = np.empty(len(part.dofs), dtype=int)
        shared = [row for node in POINTS.values() for _, row in sorted(part.dofs_of(node).items())]
        own[shared] = range(24)
        inner = np.setdiff1d(np.arange(len(own)), shared)
        own[inner] = first + np.arange(len(inner))
        first += len(inner)
        stiffness[np.ix_(own, own)] += part.stiffness.toarray()
        mass[np.ix_(own, own)] += part.mass.toarray()
        outputs[name] = np.zeros((len(part.outputs.rows), size))
        outputs[name][:, own] = part.outputs.rows
    return stiffness, mass, outputs


def response(steps):
    """Times, work (J) of the push, and outputs by body, all of the assembled matrices.

    Modes by themselves, exact for a straight force.
    """
    stiffness, mass, outputs = assembled()
    eigenvalues, shapes = linalg.eigh(stiffness, mass)
    rates, shares = np.sqrt(np.maximum(eigenvalues[6:], 0.0)), shapes[2]
    law, times = MotionLaw(PUSH), np.linspace(0.0, END, steps + 1)
    force, h = np.array([law.value(time) for time in times]), END / steps
    swing, swing_rate = np.zeros(len(rates)), np.zeros(len(rates))
    rigid, rigid_rate = 0.0, 0.0
    rigid_share, share = shares[:6] @ shares[:6], shares[6:]
    places, swings = [0.0], [swing]
    for before, after in pairwise(force):
        slope = (after - before) / h
        still, drift = share * before / rates**2, share * slope / rates**2
        off, off_rate = swing - still, swing_rate - drift
        cosine, sine = np.cos(rates * h), np.sin(rates * h)
        swing = off * cosine + off_rate * sine / rates + still + drift * h
        swing_rate = off_rate * cosine - off * rates * sine + drift
        rigid += rigid_rate * h + rigid_share * h**2 * (before / 2.0 + slope * h / 6.0)
        rigid_rate += rigid_share * h * (before + after) / 2.0
        places.append(rigid + share @ swing)
        swings.append(swing)
    work = np.append(0.0, np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(places)))
    moved = np.array(swings) @ shapes[:, 6:].T
    return times, work, {name: moved @ rows.T for name, rows in outputs.items()}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return fanfold.simulate(scene(), estimate=False, save=tmp_path_factory.mktemp("pair") / "pair.h5")


@pytest.fixture(scope="module")
def exact():
    return response(2000)


def test_the_welded_pair_moves_as_its_matrices_say(run, exact):
    """Independent path: work of the push at every row, within the tolerance of the run."""
    times, work, _ = exact
    found, expected = run.signal("push", "supplied_energy"), np.interp(run.time, times, work)
    assert expected[-1] > 0.05
    np.testing.assert_allclose(found, expected, atol=TOLERANCE * expected[-1])


@pytest.mark.parametrize("name", ["inboard", "outboard"])
def test_recovered_stresses_and_forces_are_those_of_the_matrices(run, exact, name):
    """Independent path: rows of the superelement by its own coordinates; those of the run go by modes of its bodies."""
    found, times = fanfold.body_outputs(run, name), exact[0]
    expected = np.array([np.interp(run.time, times, row) for row in exact[2][name].T]).T
    kinds = np.array(
        [
            unit if unit == "Pa" else label[:10] + unit
            for label, unit in zip(found.labels, found.units, strict=True)
        ]
    )
    assert len(kinds) == {"inboard": 27 + 16, "outboard": 24}[name]
    for kind in np.unique(kinds):
        size = np.abs(expected[:, kinds == kind]).max()
        off = 2e-3 if kind == "Pa" else 0.05  # forces along bars swing at 1 kHz, which the steps leave out
        np.testing.assert_allclose(
            found.values[:, kinds == kind], expected[:, kinds == kind], atol=off * size
        )


def test_command_writes_histories_and_shows_extremes(run, tmp_path):
    """Interface: a table of all outputs, and a file with one column each; bodies without rows are told."""
    file = tmp_path / "inboard.csv"
    shown = CliRunner().invoke(
        main, ["analyse", "outputs", str(run.path), "--body", "inboard", "--output", str(file)]
    )
    assert shown.exit_code == 0, shown.output
    assert "element 11 axial" in shown.stdout
    found = fanfold.body_outputs(run, "inboard")
    table = np.loadtxt(file, delimiter=",", skiprows=1, usecols=(0, 5))
    np.testing.assert_allclose(table, np.column_stack([run.time, found.values[:, 4]]), rtol=1e-12)
    label, unit, low, _, high, time = found.extremes()[4]
    assert (label, unit, low, high) == (
        "element 11 axial",
        "Pa",
        found.values[:, 4].min(),
        found.values[:, 4].max(),
    )
    assert time == run.time[np.argmax(found.values[:, 4])]
    refused = CliRunner().invoke(main, ["analyse", "outputs", str(run.path), "--body", "base"])
    assert refused.exit_code == 1
    assert "'base'" in refused.stderr.replace("\n", " ")
