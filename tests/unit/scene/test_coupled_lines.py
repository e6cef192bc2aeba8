"""Lines that cable loops and gears couple, and the ratios of their rates, against radii of pulleys and ratios."""

from __future__ import annotations

import pytest

from orchestrator.scene import find_scene, load_scene
from tests.references.edits import edited
from tests.unit.scene.scene_cases import CCL, TWO_PANELS, load_text

CONNECTION = """
[[connection]]
name = "loop"
kind = "ccl"
ports.pulley_1 = { body = "base", point = "root", offset = [0.0, 0.6, 0.0] }
ports.pulley_2 = { body = "outer", point = "left", offset = [0.0, 0.1, 0.0] }
parameters = { radius_1 = "60 mm", radius_2 = "30 mm", cut = CUT }
"""

GEAR = """
[[connection]]
name = "gear"
kind = "gear"
ports.carrier = { body = "inner", point = "root" }
ports.first = { body = "base", point = "root" }
ports.second = { body = "outer", point = "left" }
parameters = { ratio = 0.5 }
"""


def scene(name, *variants, settings=()):
    return load_scene(find_scene(name), variants, settings)


def test_wings_that_come_with_fanfold():
    """Data sheets: HL2 and HL3 at twice the rate of HL1; ARABSAT's outermost at that of HL1, led by the SADM."""
    (amos3,) = scene("amos3").coupled_lines
    assert amos3 == ({"HL1": 1.0, "HL2": 2.0, "HL3": 2.0}, ("yoke_loop", "panel_loop"), ())
    (arabsat,) = scene("arabsat", "phase2").coupled_lines
    assert arabsat.rates == {"HL1": 1.0, "HL2": 2.0, "HL3": 2.0, "HL4": 2.0, "HL5": 2.0, "HL6": 1.0}
    assert arabsat.drives == ("sadm",)
    assert scene("arabsat", "phase1").coupled_lines == ()
    assert scene("bepicolombo").coupled_lines == ()


@pytest.mark.parametrize("held", ["HL1", "HL2", "HL3"])
def test_a_loop_at_a_held_line_holds_the_others(held):
    """Closed form: 60 mm w1 = 30 mm w2 and w2 = w3, of which one is 0."""
    assert scene("amos3", settings=[f"hinge_line.{held}.held=true"]).coupled_lines == ()


GEARED = edited(CCL, ('radius = "30 mm" }\npulley_2', 'radius = "60 mm" }\npulley_2'))
TWIN = edited(CCL, ('name = "loop"', 'name = "twin"'))
OTHER = edited(GEARED, ('name = "loop"', 'name = "other"'))
GUIDED = CCL + 'guide = { body = "inner", point = "root" }\n'
TO_INNER = edited(CCL, ('body = "outer", point = "left"', 'body = "inner", point = "tip_left"'))


@pytest.mark.parametrize(
    ("text", "rates"),
    [
        (TWO_PANELS + CCL, [(1.0, 1.0)]),
        (TWO_PANELS + GEARED, [(1.0, 2.0)]),
        (edited(TWO_PANELS, ('axis = "-y"', 'axis = "+y"')) + CCL, [(1.0, -1.0)]),
        (TWO_PANELS + GUIDED, [(1.0, 1.0)]),
        (TWO_PANELS + CCL + TWIN, [(1.0, 1.0)]),
        (TWO_PANELS + CCL + OTHER, []),  # of another ratio, so that nothing can move
        (TWO_PANELS + TO_INNER, []),  # with no body between
        (TWO_PANELS + CONNECTION.replace("CUT", "0.0"), [(1.0, 2.0)]),
        (TWO_PANELS + CONNECTION.replace("CUT", "1.0"), []),
        (TWO_PANELS + GEAR, [(1.0, 2.0)]),
        (TWO_PANELS + GEAR.replace("0.5", "-0.5"), [(1.0, -2.0)]),
        (TWO_PANELS + CCL + GEAR, []),
        (TWO_PANELS + GEAR + 'structure = { second_motion = "translation" }', []),
    ],
)
def test_rates_follow_from_radii_and_axes(tmp_path, text, rates):
    """Closed form: r1 times the rate of the first line is r2 times that of the second; about +y twice, one closes.

    A gear: the base turns by its ratio times the outer panel, both against the inner one.
    """
    found = load_text(tmp_path, text).coupled_lines
    assert [tuple(group.rates.values()) for group in found] == rates
