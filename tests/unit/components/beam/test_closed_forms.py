"""Beams at rest and in small vibration against closed forms.

Beams are free, so what holds them is symmetry: a cantilever is half of a beam twice as long that is bent by a force in
its middle and half of it at each end. Steps of static solutions are long against the slowest vibration, and not so long
that round-off moves what is free.
"""

from math import atan2, pi

import numpy as np
import pytest

from tests.unit.components.beam.beam_cases import STEEL_LINK, at_rest, positions, slender, straight, wrenches
from tests.unit.components.prepared import prepared


@pytest.mark.parametrize("elements", [10, 20])
def test_a_tip_moment_rolls_it_up_to_a_circle(elements):
    """Closed form: M = 2 pi EI / L gives a circle of radius L / 2 pi, to 1e-10 L with any number of elements."""
    bending, length = 7.0, 2.0
    beam = straight((0, 0, 0), (length, 0, 0), elements, slender(bending), {"root": 0, "tip": elements})
    moment = 2.0 * pi * bending / length
    loads = [
        wrenches(beam, root=(0, 0, 0, 0, 0, -part * moment), tip=(0, 0, 0, 0, 0, part * moment))
        for part in np.linspace(0.0, 1.0, 9)[1:]
    ]
    nodes = positions(beam, at_rest(beam, loads, 2.0, relaxing=5))
    assert np.linalg.norm(nodes[-1] - nodes[0]) < 1e-10 * length
    # nodes are the corners of a regular polygon on the circle
    assert np.linalg.norm(nodes[elements // 2] - nodes[0]) == pytest.approx(length / pi, rel=1e-10)


ELASTICA = {
    1.0: (0.0564332, 0.3017208, 0.4613519),
    10.0: (0.5549956, 0.8106090, 1.4302855),
}
"""P L^2 / EI: shortening and deflection of the tip, of L, and its slope, by elliptic integrals."""


def elastica_errors(load: float, elements: int) -> np.ndarray:
    """Errors of shortening, deflection and slope of a cantilever of EI = L = 1."""
    ports = {"left": 0, "middle": elements, "right": 2 * elements}
    beam = straight((-1, 0, 0), (1, 0, 0), 2 * elements, slender(1.0), ports)
    loads = [
        wrenches(beam, left=(0, p, 0, 0, 0, 0), middle=(0, -2 * p, 0, 0, 0, 0), right=(0, p, 0, 0, 0, 0))
        for p in np.linspace(0.0, load, 5)[1:]
    ]
    x = at_rest(beam, loads, 2.0)
    tip = positions(beam, x)[-1] - positions(beam, x)[elements]
    q = x[beam.state_layout["orientation"]].reshape(-1, 4)[-1]
    found = (1.0 - tip[0], tip[1], 2.0 * atan2(q[3], q[0]))
    return np.array(found) / ELASTICA[load] - 1.0


@pytest.mark.parametrize("load", ELASTICA)
def test_elastica_under_a_tip_load(load):
    """Closed form: the elastica, 20 elements to 0.1 % and of second order in their length."""
    coarse, fine = elastica_errors(load, 10), elastica_errors(load, 20)
    assert np.abs(fine).max() < 1e-3
    assert coarse / fine == pytest.approx(4.0, rel=0.05)


def test_small_vibration_of_a_free_beam():
    """Closed form: the first bending of a free Timoshenko beam, 292.6 Hz for the link of 600 mm, to 0.5 %.

    Steps of a hundredth of a period: the scheme's error of the period is (w h)^2 / 12, 3e-4.
    """
    elements, length = 20, 0.6
    beam = straight((0, 0, 0), (length, 0, 0), elements, STEEL_LINK, {"tip": elements})
    c, free = prepared(beam), wrenches(beam)
    x = beam.initial(c, free)
    # the shape of Euler and Bernoulli has next to nothing of the other modes
    s, k = np.linspace(0.0, 1.0, elements + 1), 4.730041
    a = (np.cosh(k) - np.cos(k)) / (np.sinh(k) - np.sin(k))
    shape = np.cosh(k * s) + np.cos(k * s) - a * (np.sinh(k * s) + np.sin(k * s))
    slope = k / length * (np.sinh(k * s) - np.sin(k * s) - a * (np.cosh(k * s) + np.cos(k * s)))
    x[beam.state_layout["velocity"]].reshape(-1, 3)[:, 2] = 1e-3 * shape
    x[beam.state_layout["angular_velocity"]].reshape(-1, 3)[:, 1] = -1e-3 * slope
    h, crossings, before = 1.0 / 292.6 / 100.0, [], 0.0
    for step in range(160):
        x = beam.step(c, x, free, h)
        z = positions(beam, x)[:, 2]
        bend = z[elements // 2] - 0.5 * (z[0] + z[-1])
        if before * bend < 0.0:
            crossings.append((step + before / (before - bend)) * h)
        before = bend
    periods = 2.0 * np.diff(crossings)
    assert 1.0 / periods.mean() == pytest.approx(292.6, rel=5e-3)
