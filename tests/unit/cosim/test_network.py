"""Connections: everything wrong with them is told at once, a sentence each, and values reach the right ports."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from components import Layout, Quantity
from orchestrator.assembly import Link
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.network import Network, NetworkError
from orchestrator.cosim.participant import in_process
from orchestrator.scene import load_scene
from orchestrator.scene.builder import Scene

SCENES = Path(__file__).parents[2] / "scenes"
ASSEMBLY = assemble(load_scene(SCENES / "two_panels.toml"))
LEFT = "middle_left"


def without(*dropped):
    return [link for link in ASSEMBLY.links if link not in dropped]


def link_of(connection, side):
    return next(link for link in ASSEMBLY.links if link.connection == (connection, side))


def problems_of(links, change=lambda participants: None):
    participants = in_process(ASSEMBLY.parts)
    change(participants)
    with pytest.raises(NetworkError) as caught:
        Network(participants, links)
    assert str(caught.value).splitlines() == caught.value.problems
    return caught.value.problems


def keys(problems):
    """What each problem is of, the text before its colon, in order."""
    return sorted(problem.partition(":")[0] for problem in problems)


def redeclare(name, layout, variable, **changes):
    """A change that declares one variable of a participant differently, or not at all."""

    def change(participants):
        participant = next(p for p in participants if p.name == name)
        quantities = [
            Quantity(q.name, changes.get("unit", q.unit), q.description, changes.get("size", q.size))
            if q.name == variable
            else q
            for q in getattr(participant, layout).quantities
            if q.name != variable or changes
        ]
        setattr(participant, layout, Layout(quantities))

    return change


def test_sound_connections_have_no_problem():
    """Consistency: the scene's own links connect every port once, six rows a port."""
    network = Network(in_process(ASSEMBLY.parts), ASSEMBLY.links)
    assert network.size == 6 * len(ASSEMBLY.links)
    assert [b.name for b in network.bodies] == ["base", "inner", "outer"]


def test_disconnected_port():
    """Bad input: both sides of a missing link are named, nothing else."""
    assert keys(problems_of(without(link_of(LEFT, "outboard")))) == [
        "middle_left.outboard",
        "outer.middle_left",
    ]


def test_port_connected_twice():
    """Bad input: a port that two links name is told with their number; the port they forgot as well."""
    links = without(link_of(LEFT, "outboard"))
    links.append(Link(("outer", "middle_right"), (LEFT, "outboard")))
    problems = problems_of(links)
    assert keys(problems) == ["outer.middle_left", "outer.middle_right"]
    assert "2 times" in max(problems)


def test_two_fmus_with_one_name():
    """Bad input: the name is told once, although its ports appear twice."""

    def double(participants):
        participants.append(in_process([p for p in ASSEMBLY.parts if p.name == "outer"])[0])

    assert keys(problems_of(ASSEMBLY.links, double)) == ["outer"]


@pytest.mark.parametrize(
    ("body", "key"),
    [
        (("outest", "middle_left"), "outest.middle_left"),
        (
            ("outer", "top"),
            "outer.top",
        ),
        (
            ("root", "inboard"),
            "root.inboard",
        ),
    ],
    ids=["unknown FMU", "unknown port", "wrong side"],
)
def test_link_to_a_wrong_place(body, key):
    """Bad input: one sentence says what stands there instead; the port left over is told too."""
    links = [*without(link_of(LEFT, "outboard")), Link(body, (LEFT, "outboard"))]
    assert {key, "outer.middle_left"} <= set(keys(problems_of(links)))


def test_body_as_the_connection_side():
    """Bad input: two bodies cannot be joined without something between them."""
    links = [*without(link_of(LEFT, "outboard")), Link(("outer", LEFT), ("inner", LEFT))]
    assert "inner.middle_left" in keys(problems_of(links))


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (
            redeclare("outer", "output_layout", "middle_left.velocity", unit="mm/s"),
            "outer.middle_left.velocity: is in mm/s; a port needs m/s",
        ),
        (
            redeclare(LEFT, "output_layout", "inboard.torque", unit=""),
            "middle_left.inboard.torque: is in no unit; a port needs N.m",
        ),
        (
            redeclare(LEFT, "input_layout", "inboard.orientation", size=3),
            "middle_left.inboard.orientation: has 3 elements; a port needs 4",
        ),
        (
            redeclare("inner", "input_layout", "root.torque"),
            "inner.root.torque: the variable is missing or has the wrong causality",
        ),
    ],
    ids=["wrong unit", "no unit", "wrong size", "missing variable"],
)
def test_port_with_a_wrong_variable(change, sentence):
    """Bad input: the variable, what it is and what it must be, and no consequential problems."""
    assert problems_of(ASSEMBLY.links, change) == [sentence]


def test_all_problems_at_once():
    """Bad input: problems of every kind in one go are all told, one line each, no line twice."""

    def spoil(participants):
        redeclare("outer", "output_layout", "middle_right.position", unit="mm")(participants)
        participants.append(in_process([p for p in ASSEMBLY.parts if p.name == "base"])[0])

    links = [
        *without(link_of(LEFT, "outboard")),
        Link(("wing", "x"), (LEFT, "outboard")),
        Link(("inner", "root"), ("root", "nowhere")),
    ]
    problems = problems_of(links, spoil)
    assert len(problems) == len(set(problems)) == 6
    for part in (
        "base: two FMUs",
        "no FMU 'wing'",
        "root.nowhere: ",
        " mm",
        "inner.root: connected 2 times",
        "outer.middle_left: ",
    ):
        assert sum(part in problem for problem in problems) == 1


def test_values_reach_the_port_they_are_meant_for():
    """Independent path: what is carried equals a look-up of both variables by name, link by link."""
    network = Network(in_process(ASSEMBLY.parts), reversed(ASSEMBLY.links))
    rng = np.random.default_rng(1)
    for participant in network.by_name.values():
        participant.outputs[:] = rng.random(participant.outputs.size)
    network.carry_motion()
    wrenches = np.zeros(network.size)
    network.collect_wrenches(wrenches)
    network.set_wrenches(wrenches)
    for link in ASSEMBLY.links:
        (body, port), (connection, side) = link.body, link.connection
        b, c = network.by_name[body], network.by_name[connection]
        for variable in ("position", "orientation", "velocity", "angular_velocity"):
            np.testing.assert_array_equal(
                c.inputs[c.input_layout[f"{side}.{variable}"]],
                b.outputs[b.output_layout[f"{port}.{variable}"]],
            )
        for variable in ("force", "torque"):
            np.testing.assert_array_equal(
                b.inputs[b.input_layout[f"{port}.{variable}"]],
                c.outputs[c.output_layout[f"{side}.{variable}"]],
            )


def test_meetings_number_the_links():
    """Independent path: every meeting, by number, is one of the scene's links, by name, in the unknown's order."""
    network = Network(in_process(ASSEMBLY.parts), reversed(ASSEMBLY.links))
    found = [
        Link(
            (network.bodies[m.body].name, network.body_ports[m.body][m.body_port]),
            (
                network.connections[m.connection].name,
                network.connection_ports[m.connection][m.connection_port],
            ),
        )
        for m in network.meetings
    ]
    assert [link.body for link in found] == network.port_names
    assert set(found) == set(ASSEMBLY.links)


def test_row_of_the_unknown_has_a_name():
    """Message: a row of the unknown is told as connection and body port, both of one link."""
    network = Network(in_process(ASSEMBLY.parts), ASSEMBLY.links)
    row = 6 * network.port_names.index(("outer", "middle_right")) + 4
    assert network.port_of_row(row) == "middle_right.outboard on outer.middle_right"


@pytest.mark.parametrize(("fidelity", "order"), [("large_deformation", 2), ("flexible", 4)])
def test_slopes_that_no_joint_takes_are_not_carried(fidelity, order):
    """Definition. Regression: a beam of large deformation alone took five times the steps of order 2."""
    scene = Scene("strip", until="1 s")
    scene.base(points={"o": (0, 0, 0)})
    section = {"width": "20 mm", "height": "2 mm", "youngs_modulus": "70 GPa", "density": "2700 kg/m3"}
    beam = {"length": "1 m", "elements": 4, "rectangle": section | {"poisson_ratio": 0.3}}
    beam |= {"attachment_points": {"root": 0, "tip": "1 m"}}
    place = {"body": "base", "point": "o"}
    scene.body("strip", place=place, fidelity=fidelity, damping_ratio=0.01, beam=beam)
    ports = {"inboard": {"body": "base", "point": "o"}, "outboard": {"body": "strip", "point": "root"}}
    scene.connection("clamp", "hinge", ports=ports, preset="fixed")
    strip = assemble(scene.check())
    assert Network.ordered(in_process(strip.parts), strip.links, None).order == order
    assert Network.ordered(in_process(strip.parts), strip.links, 4).order == 4
