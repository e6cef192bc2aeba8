"""What a beam is given: sentences for what no beam can be or do, curved beams without stress, ports on arms."""

import re

import numpy as np
import pytest

from components.beam import Beam
from components.contract.component import ComponentError
from tests.unit.components.beam.beam_cases import energy, observed, slender, straight, wrenches
from tests.unit.components.prepared import prepared


def test_a_curved_beam_turns_and_flies_without_strain():
    """Closed form: a rigid motion has no strain; the energy is that of the motion, potential none."""
    beam = Beam.example()
    c = prepared(beam, initial_velocity=(1.0, 2.0, -1.0), initial_orientation=(0.6, 0.0, 0.8, 0.0))
    x = beam.initial(c, wrenches(beam))
    for _ in range(5):
        x = beam.step(c, x, wrenches(beam), 0.05)
    mass = 15.0 * beam.length
    assert energy(beam, c, x) == pytest.approx(0.5 * mass * 6.0, rel=1e-12)
    assert np.abs(observed(beam, c, x, "section_force")).max() < 1e-10


def test_a_beam_falls_with_gravity():
    """Closed form: free fall, r = g t^2 / 2 at all steps; potential energy lost is kinetic energy won."""
    beam = Beam.example()
    c = prepared(beam, gravity=(0.0, 0.0, -9.81))
    x = first = beam.initial(c, wrenches(beam))
    for _ in range(4):
        x = beam.step(c, x, wrenches(beam), 0.1)
    fallen = (beam.outputs(c, x, wrenches(beam)) - beam.outputs(c, first, wrenches(beam)))[:3]
    assert fallen == pytest.approx((0.0, 0.0, -0.5 * 9.81 * 0.16), abs=1e-12)
    assert energy(beam, c, x) == pytest.approx(energy(beam, c, first), abs=1e-10)


@pytest.mark.parametrize(
    ("wrench", "h", "words"),
    [
        ((0, 0, 0, 0, 0, 40.0), 50.0, "90 deg"),
        ((0, 0, 0, 0, 0, 14.0), 0.05, "element 1 .*60 deg"),
        ((0, 0, 0, float("inf"), 0, 0), 0.01, "smaller steps"),
    ],
)
def test_a_step_beyond_its_range_is_refused_in_a_sentence(wrench, h, words):
    """Two elements under moments that would turn each by 4 and by 1.4 radians, and a load that is no number."""
    beam = straight((0, 0, 0), (1, 0, 0), 2, slender(5.0), {"root": 0, "tip": 2})
    c = prepared(beam)
    opposite = tuple(-value if np.isfinite(value) else 0.0 for value in wrench)
    u = wrenches(beam, root=opposite, tip=wrench)
    with pytest.raises(ComponentError, match=words):
        beam.step(c, beam.initial(c, u), u, h)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"axial": 0.0}, "axial .*0"),
        ({"inertia_y": float("nan")}, "inertia_y .*nan"),
        ({"bending": 1.0}, "unknown: bending"),
    ],
)
def test_sections_that_no_beam_has(change, words):
    nodes = [{"position": (0.0, 0.0, 0.0)}, {"position": (1.0, 0.0, 0.0)}]
    with pytest.raises(ComponentError, match=words):
        Beam(nodes, slender(1.0)._asdict() | change, [])


@pytest.mark.parametrize(
    ("places", "node", "words"),
    [
        ([(0, 0, 0)], 0, "two nodes"),
        ([(0, 0, 0), (1, 0, 0), (1, 0, 0)], 0, "nodes 1 and 2"),
        ([(0, 0, 0), (1, 0, 0)], 2, "tip: .*node 2"),
    ],
)
def test_nodes_that_make_no_beam(places, node, words):
    with pytest.raises(ComponentError, match=words):
        Beam([{"position": p} for p in places], slender(1.0)._asdict(), [{"name": "tip", "node": node}])


@pytest.mark.parametrize(
    ("nodes", "port", "words"),
    [
        ([{"position": (0, 0)}] * 3, {}, "node 0: position is (0, 0); give 3 numbers"),
        ([{}, {"position": (1, 0, 0)}], {}, "node 0: position"),
        (
            [{"position": (0, 0, 0), "orientation": (0, 0, 0, 0)}, {"position": (1, 0, 0)}],
            {},
            "orientation",
        ),
        (None, {"offset": (0, 0)}, "port tip: offset is (0, 0); give 3 numbers"),
        (None, {"orientation": (0, 0, 0, 0)}, "tip: orientation"),
        (None, {"node": True}, "node True"),
    ],
)
def test_nodes_and_ports_of_another_shape(nodes, port, words):
    """Bad input: a sentence each, nothing reshaped."""
    straight = [{"position": (0, 0, 0)}, {"position": (1, 0, 0)}]
    with pytest.raises(ComponentError, match=re.escape(words)):
        Beam(nodes or straight, slender(1.0)._asdict(), [{"name": "tip", "node": 0, **port}])
