"""Quantities of scene files: factors to SI units by definition, and that every component's units are known."""

from math import pi

import pytest
from pydantic import TypeAdapter, ValidationError

from components import REGISTRY
from orchestrator.scene.table import Inertia
from orchestrator.scene.units import UNITS, to_si, written


@pytest.mark.parametrize(
    ("value", "unit", "expected"),
    [
        (2, "m", 2.0),
        ("30 mm", "m", 0.03),
        ("90 deg", "rad", pi / 2),
        ("-90 deg", "rad", -pi / 2),
        ("10 N.m/deg", "N.m/rad", 1800 / pi),
        ("28.76 N.m.s/rad", "N.m.s/rad", 28.76),
        ("2e6 N/m", "N/m", 2e6),
        ("5 %", "1", 0.05),
        ("0.1", "1", 0.1),
        ("90deg", "rad", pi / 2),
        ("1.5 min", "s", 90.0),
        ("1.2 t", "kg", 1200.0),
        (0, "rad", 0.0),
    ],
)
def test_quantities_are_converted_to_si(value, unit, expected):
    """Definitions of the units, to round-off."""
    assert to_si(value, unit) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize("unit", UNITS)
def test_every_unit_accepts_itself_and_refuses_others(unit):
    assert to_si(f"3 {unit}", unit) == 3.0
    with pytest.raises(ValueError, match="'3 furlong'"):
        to_si("3 furlong", unit)


@pytest.mark.parametrize(
    ("text", "unit", "meant"), [("0.15 Nm", "N.m", "0.15 N.m"), ("5 Nms/rad", "N.m.s/rad", "5 N.m.s/rad")]
)
def test_a_unit_without_its_dots_is_shown_with_them(text, unit, meant):
    with pytest.raises(ValueError, match=f"write '{meant}'"):
        to_si(text, unit)


def test_units_are_those_of_the_components():
    """Completeness: a scene can give every parameter with its unit, but for modal coordinates, which exports find."""
    every = (q for kind in REGISTRY.values() for q in kind.example().parameter_layout.quantities)
    used = {q.unit for q in every if q.name != "initial_modal_coordinate"}
    assert used <= set(UNITS)


@pytest.mark.parametrize("value", [180, 5, 90.0, -7.5])
def test_an_angle_that_reads_like_degrees_needs_its_unit(value):
    """A plain 180 was taken for 180 rad; 0 is the same in every unit."""
    with pytest.raises(ValueError, match=f"'{value} deg' or '{value} rad'"):
        written(value, "rad")
    assert to_si(value, "rad") == value


@pytest.mark.parametrize("value", [1.57079632679, -0.1, 3.14159265359, 0])
def test_other_plain_angles_are_radians(value):
    """As programs write them: SI, as all plain numbers of a scene."""
    assert written(value, "rad") == value


@pytest.mark.parametrize("value", ["1e31 m", -1e200, 1e308])
def test_sizes_beyond_all_bounds_are_refused(value):
    """Found by the benchmark of mutated scenes: products of such lengths and masses overflowed."""
    with pytest.raises(ValueError, match=r" 1e\+30 m"):
        to_si(value, "m")


def test_rows_of_a_tensor():
    """Definition: rows of an inertia are its entries, as its six numbers are; one that is not symmetric is refused."""
    tensor = TypeAdapter(Inertia)
    rows = [["5 kg.m2", 0.1, 0.2], [0.1, 6.0, 0.3], [0.2, 0.3, 7.0]]
    assert tensor.validate_python(rows) == tensor.validate_python([5.0, 6.0, 7.0, 0.1, 0.2, 0.3])
    with pytest.raises(ValidationError, match="symmetric"):
        tensor.validate_python([[5.0, 0.1, 0.2], [-0.1, 6.0, 0.3], [0.2, 0.3, 7.0]])
    with pytest.raises(ValidationError, match="three rows"):
        tensor.validate_python([[5.0, 0.1], [0.1, 6.0], [0.2, 0.3]])
