"""Beams as they are written down: the same mass at any fidelity, points where they are said to be, sentences."""

import numpy as np
import pytest

from components.beam import Beam
from components.catalogue import TableError, read_body
from components.catalogue.tables import Sign
from components.flexible.reduction import craig_bampton
from tests.unit.components.beam.beam_cases import positions, wrenches
from tests.unit.components.prepared import prepared

TUBE = {"diameter": 0.03, "wall": 1e-3, "youngs_modulus": 70e9, "poisson_ratio": 0.3, "density": 2700.0}
BOOM = {
    "length": 2.5,
    "radius": 2.0,
    "tube": TUBE,
    "attachment_points": {"root": 0.0, "hook": 0.7, "tip": 2.5},
}


def plain(value: object, unit: str, sign: Sign) -> float:
    """A value that is a number already."""
    assert isinstance(value, int | float)
    return float(value)


def body(**changes):
    """The boom with other keys; None leaves one out."""
    table = {key: value for key, value in {**BOOM, **changes}.items() if value is not None}
    return read_body({"beam": table}, plain)


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


PROBLEMS = {
    "no length": ({"length": None, "radius": None}, "beam: .*length, axis.*none"),
    "two axes": ({"axis": [[0, 0, 0], [1, 0, 0]], "radius": None}, "length, axis.*and axis"),
    "a radius of an axis": ({"length": None, "axis": [[0, 0, 0], [1, 0, 0]]}, "beam.radius: belongs to a length"),
    "one point": ({"length": None, "radius": None, "axis": [[0, 0, 0]]}, "beam.axis: .*two"),
    "no positions": ({"length": None, "radius": None, "axis": [1, 2]}, "beam.axis: .*list"),
    "no section": ({"tube": None}, "rectangle, tube, circle, section.*none"),
    "thick wall": ({"tube": {**TUBE, "wall": 0.02}}, "beam.tube.wall: is 0.02 m; a tube of 0.03 m"),
    "no points": ({"attachment_points": None}, "beam.attachment_points: is missing"),
    "beyond the end": ({"attachment_points": {"a": 3.0}}, "attachment_points.a: .*3 m"),
    "one place": ({"attachment_points": {"a": 1.0, "b": 1.0}}, "beam.attachment_points: a and b"),
    "few elements": ({"elements": 1}, "beam.elements: is 1; .* into 2 stretches"),
    "too much a turn": ({"radius": 0.5, "elements": 2, "attachment_points": {"a": 0}}, " 60 deg"),
    "along the axis": ({"section_z": [1, 0, 0]}, "section_z.*axis"),
    "unknown": ({"lenght": 1.0}, "beam.lenght: .*length"),
    "both moduli": ({"tube": {**TUBE, "shear_modulus": 1e9}}, "shear_modulus, poisson_ratio"),
}  # fmt: skip


@pytest.mark.parametrize("case", PROBLEMS)
def test_problems_are_sentences(case):
    changes, sentence = PROBLEMS[case]
    with pytest.raises(TableError, match=sentence) as caught:
        body(**changes)
    assert len(caught.value.problems) == 1


def test_a_beam_stands_alone():
    with pytest.raises(TableError, match="beam"):
        read_body({"beam": BOOM, "frame": {"joints": {"a": [0, 0, 0]}}}, plain)
