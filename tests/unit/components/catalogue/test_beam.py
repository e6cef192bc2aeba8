"""Beams as they are written down: the same mass at any fidelity, points where they are said to be, sentences."""

import numpy as np
import pytest

from components.beam import Beam
from components.flexible.reduction import craig_bampton
from tests.references.catalogue import built
from tests.unit.components.beam.beam_cases import positions, wrenches
from tests.unit.components.prepared import prepared
from tests.unit.scene.body_cases import BOOM


def body(**changes):
    """The boom with other keys; None leaves one out."""
    table = {key: value for key, value in {**BOOM, **changes}.items() if value is not None}
    return built({"beam": table})


def component(beam) -> Beam:
    """At large deformation, with a port at every point."""
    ports = [{"name": name, "node": node} for name, node in beam.point_nodes.items()]
    return Beam(beam.nodes(), beam.section._asdict(), ports)


def test_points_are_where_they_are_said_to_be():
    """Closed form: places on the circle, of the nodes at large deformation and of the others' points."""
    found = body()
    rigid, beam = found.rigid(), component(found.beam)
    at = positions(beam, beam.initial(prepared(beam), wrenches(beam)))
    for name, distance in BOOM["attachment_points"].items():
        turn = distance / 2.0
        place = (2.0 * np.sin(turn), 0.0, 2.0 * (1.0 - np.cos(turn)))
        assert rigid.point_positions[rigid.point_names.index(name)] == pytest.approx(place, abs=1e-12)
        assert at[found.beam.point_nodes[name]] == pytest.approx(place, abs=1e-12)
    assert len(at) == 21  # the default of 20 elements


def test_mass_and_inertia_are_those_of_the_curved_tube():
    """Closed form: mass, centre and inertia about y of an arc; 120 elements miss them by (2.5/2/120)^2 / 12, 1e-5."""
    found = body()
    line, turn, radius = found.beam.section.line_mass, 1.25, 2.0
    rigid = found.rigid()
    assert rigid.mass == pytest.approx(2.5 * line, rel=1e-12)
    center = radius * (1.0 - np.cos(turn)) / turn, 0.0, radius - radius * np.sin(turn) / turn
    assert rigid.center_of_mass == pytest.approx(center, rel=3e-5, abs=1e-15)
    off = radius**2 - (center[0] ** 2 + (center[2] - radius) ** 2)
    about_y = 2.5 * (line * off + found.beam.section.inertia_y)
    assert rigid.inertia[1, 1] == pytest.approx(about_y, rel=6e-5)


def test_modes_are_those_of_the_finite_elements():
    """Reduction: free frequencies of the Craig-Bampton body with ten modes, to 1e-3 in the first three."""
    found = body()
    model = found.finite_elements()
    reduced = craig_bampton(model, found.attachment_points, 10).frequency[:3]
    rich = craig_bampton(model, found.attachment_points, 30).frequency[:3]
    assert reduced == pytest.approx(rich, rel=1e-3)
    assert found.flexible(10).frequency[:3] == pytest.approx(reduced, rel=1e-9)


@pytest.mark.parametrize(("count", "nodes"), [(2, [0, 1, 2]), (3, [0, 1, 3]), (9, [0, 3, 9])])
def test_elements_are_shared_out_by_length(count, nodes):
    """Bookkeeping: each stretch has one at the least, longer ones more."""
    beam = body(elements=count).beam
    assert list(beam.point_nodes.values()) == nodes
    assert len(beam.nodes()) == count + 1


def test_a_beam_of_one_element():
    """Bookkeeping: with points at both ends one is enough, and its modes still have theirs."""
    found = body(radius=None, elements=1, attachment_points={"a": 0, "b": 2.5})
    assert len(found.beam.nodes()) == 2
    assert found.flexible(4).frequency.size == 10
