"""Bodies of the AMOS-3, BepiColombo and ARABSAT wings against their data sheets and closed forms."""

from math import hypot

import numpy as np
import pytest

from components.contract.component import ComponentError
from components.flexible.reduction import fixed_interface_frequencies
from tests.references import catalogue

WINGS = {
    "amos3_yoke": (10, 22, ("hl1", "hl2_left", "hl2_right", "guide")),
    "amos3_panel1": (10, 28, ("hl2_left", "hl2_right", "hl3_left", "hl3_right", "center")),
    "amos3_panel2": (10, 16, ("hl3_left", "hl3_right", "center")),
    "bepicolombo_inboard": (
        5,
        23,
        ("hl1_left", "hl1_right", "hl2_left", "hl2_right", "center", "hold_down"),
    ),
    "bepicolombo_outboard": (5, 11, ("hl2_left", "hl2_right", "center")),
    "arabsat_yoke": (10, 22, ("hl1", "hl2_left", "hl2_right", "guide")),
    "arabsat_panel": (
        10,
        28,
        ("inboard_left", "inboard_right", "outboard_left", "outboard_right", "center"),
    ),
    "arabsat_panel_tip": (10, 16, ("inboard_left", "inboard_right", "center")),
}


@pytest.fixture(autouse=True, scope="module")
def _own_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FANFOLD_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


def about(body, x):
    """Inertia of a body about the hinge-parallel line at x."""
    return body.inertia[1, 1] + body.mass * (x - body.center_of_mass[0]) ** 2


def place(body, name):
    return body.point_positions[body.point_names.index(name)]


@pytest.mark.parametrize("name", WINGS)
def test_flexible_body_and_rigid_twin(name):
    """B17, B18 (thesis, 3.4.1.4, 3.4.2.4): mode counts. Twins have the same points and, to 1e-3, the same mass."""
    modes, flexible_modes, points = WINGS[name]
    flexible, rigid = catalogue.entry(name).flexible(modes), catalogue.entry(name).rigid()
    assert flexible.frequency.size == flexible_modes
    assert np.all(flexible.frequency > 2 * np.pi)
    assert rigid.frequency.size == 0
    assert flexible.point_names == rigid.point_names == points
    np.testing.assert_array_equal(flexible.point_positions, rigid.point_positions)
    assert flexible.mass == pytest.approx(rigid.mass, rel=1e-3)
    assert flexible.center_of_mass[0] == pytest.approx(rigid.center_of_mass[0], rel=1e-3)
    np.testing.assert_allclose(flexible.inertia, rigid.inertia, rtol=1e-3, atol=1e-12)
    assert np.all(rigid.center_of_mass[1:] == 0.0)


def test_catalogue_is_complete():
    """Bookkeeping: these are the bodies; what they are like is none by itself."""
    membranes = {"antenna_membrane", "antenna_membrane_isolated"}
    assert set(catalogue.entries()) == {*WINGS, "workbench_panel", *membranes}
    for name, (_, _, points) in WINGS.items():
        assert catalogue.entry(name).points == points
    for template in ("honeycomb_panel", "tube_frame"):
        with pytest.raises(ComponentError, match=f"{template}"):
            catalogue.entry(template)


def test_amos3_yoke_sheet():
    """Data sheet: 1.80 kg, centre of mass 0.475 m, 0.1354 kg m2 about it, flexible and rigid."""
    for body in (catalogue.entry("amos3_yoke").finite_elements(), catalogue.entry("amos3_yoke").rigid()):
        assert body.mass == pytest.approx(1.80)
        np.testing.assert_allclose(body.center_of_mass, [0.475, 0.0, 0.0], atol=1e-12)
        assert body.inertia[1, 1] == pytest.approx(0.1354)
    np.testing.assert_allclose(place(catalogue.entry("amos3_yoke").rigid(), "hl2_left"), [0.95, 0.565, 0.0])


def test_amos3_panel_sheets():
    """Data sheet: 8.08 kg, 0.805 m, 1.790 kg m2 and 7.78 kg, 0.7742 m, 1.589 kg m2."""
    for name, sheet in (("panel1", (8.08, 0.805, 1.790)), ("panel2", (7.78, 0.7742, 1.589))):
        body = catalogue.entry(f"amos3_{name}").rigid()
        assert (body.mass, body.center_of_mass[0], body.inertia[1, 1]) == sheet


def test_bepicolombo_inboard_sheet():
    """Data sheet, to its digits: 7.5558 kg, 1.0318 m from HL1, 9.6208 and 6.6971 kg m2 about HL1 and HL2.

    The last is to half a digit of the yoke's mass, 5e-5 kg times 1.655² m² and what is around its own centre.
    """
    body = catalogue.entry("bepicolombo_inboard").rigid()
    assert body.mass == pytest.approx(7.5558, abs=5e-5)
    assert body.center_of_mass[0] == pytest.approx(1.0318, abs=5e-5)
    assert about(body, 0.0) == pytest.approx(9.6208, abs=5e-5)
    assert about(body, 1.855) == pytest.approx(6.6971, abs=1.4e-4)
    for name, position in {
        "hl1_left": (0.0, 0.15, 0.0),
        "hl1_right": (0.0, -0.15, 0.0),
        "hl2_left": (1.855, 0.565, 0.0),
        "hl2_right": (1.855, -0.565, 0.0),
        "center": (1.10, 0.0, 0.0),
        "hold_down": (1.20, 0.0, 0.0),
    }.items():
        np.testing.assert_allclose(place(body, name), position, atol=1e-12)


def test_bepicolombo_inboard_parts():
    """Closed form: a rectangle of 6.9832 kg at 1.10 m and two rods of 0.2863 kg, all in one plane."""
    body = catalogue.entry("bepicolombo_inboard").rigid()
    plate, rods = 1.400 * 1.160 * 4.30, 0.5726
    across = plate * 1.160**2 / 12 + rods * 0.15**2
    along = plate * (1.400**2 / 12 + 1.10**2) + rods * (0.400**2 / 12 + 0.20**2)
    tube = 0.5 * (0.015**2 + 0.0135**2) * 0.8 * 1600 * np.pi * (0.015**2 - 0.0135**2)  # about its axis
    assert body.inertia[0, 0] == pytest.approx(across + tube, rel=1e-9)
    assert about(body, 0.0) == pytest.approx(along + 0.5 * tube, rel=1e-9)


def test_bepicolombo_latch_frequency():
    """B28 (thesis, A.2.3): J1 J2 / (J1 + J2) = 3.23333 kg m2, 4.1672 Hz on two springs of 19.344 N.m/deg.

    The sheet gives the yoke's mass to 1e-4 kg, which moves the first by 6e-5 kg m2.
    """
    inboard, outboard = (
        catalogue.entry("bepicolombo_inboard").rigid(),
        catalogue.entry("bepicolombo_outboard").rigid(),
    )
    one, two = about(inboard, 1.855), about(outboard, 0.0)
    joint = one * two / (one + two)
    assert joint == pytest.approx(3.23333, abs=6e-5)
    stiffness = 2 * 19.344 * 180 / np.pi
    assert np.sqrt(stiffness / joint) / (2 * np.pi) == pytest.approx(4.167200, rel=1e-5)


def test_bepicolombo_outboard_sheet():
    """Data sheet, to its digits: 7.582 kg, 0.7944 m from HL2, 6.2514 kg m2 about HL2."""
    body = catalogue.entry("bepicolombo_outboard").rigid()
    assert body.mass == pytest.approx(7.582, abs=5e-4)
    assert body.center_of_mass[0] == pytest.approx(0.7944, abs=5e-5)
    assert about(body, 0.0) == pytest.approx(6.2514, abs=5e-5)


def test_arabsat_panel_sheets():
    """Data sheet: 17.10 kg, 38.03 kg m2 about the inboard line, hinge lines 2.61 m apart; 0.30 kg more on each."""
    inner, tip = catalogue.entry("arabsat_panel").rigid(), catalogue.entry("arabsat_panel_tip").rigid()
    assert tip.mass == pytest.approx(17.10 + 0.30)
    assert about(tip, 0.0) == pytest.approx(38.03, abs=5e-3)
    assert inner.mass == pytest.approx(17.10 + 0.60)
    assert about(inner, 0.0) == pytest.approx(about(tip, 0.0) + 0.30 * 2.61**2)
    np.testing.assert_allclose(inner.center_of_mass[0], 0.5 * 2.61)
    np.testing.assert_allclose(place(inner, "outboard_right"), [2.61, -0.90, 0.0])
    np.testing.assert_allclose(place(tip, "center"), [1.305, 0.0, 0.0])


def test_arabsat_wing_sheet():
    """Data sheet: the wing is 14.89 m long and has 93 kg, the spacecraft's half of HL1 and 1 % included."""
    yoke, inner, tip = (catalogue.entry(f"arabsat_{name}").rigid() for name in ("yoke", "panel", "panel_tip"))
    reach = place(yoke, "hl2_left")[0] + 4 * place(inner, "outboard_left")[0]
    assert reach + 0.055 + 2.50 == pytest.approx(14.89, abs=0.01)
    assert yoke.mass + 4 * inner.mass + tip.mass + 0.30 == pytest.approx(93.0, rel=0.01)


def test_arabsat_yoke_sheet():
    """Data sheet: 4.0 kg, 1.90 m; the AMOS-3 yoke's shares of mass: in the middle, m L² / 12 about it."""
    for body in (catalogue.entry("arabsat_yoke").finite_elements(), catalogue.entry("arabsat_yoke").rigid()):
        assert body.mass == pytest.approx(4.0)
        np.testing.assert_allclose(body.center_of_mass, [0.95, 0.0, 0.0], atol=1e-12)
        assert body.inertia[1, 1] == pytest.approx(4.0 * 1.90**2 / 12, rel=1e-4)
    np.testing.assert_allclose(
        place(catalogue.entry("arabsat_yoke").rigid(), "hl2_right"), [1.90, -0.90, 0.0]
    )
    np.testing.assert_allclose(place(catalogue.entry("arabsat_yoke").rigid(), "guide"), [0.95, 0.45, 0.0])


@pytest.mark.parametrize(("system", "load"), [("amos3", 0.78), ("arabsat", 0.90)])
def test_yoke_legs_between_clamped_ends(system, load):
    """Closed form: a leg without its load is a clamped beam, an upper bound; all loaded, a lower one."""
    entry = catalogue.entry(f"{system}_yoke")
    tube = entry.frame.members[0].section
    leg = hypot(*dict(entry.frame.joints)["hl2_left"])
    model = entry.finite_elements()
    first = fixed_interface_frequencies(model, ["hl1", "hl2_left", "hl2_right"], 1)[0]
    bounds = [22.3733 * np.sqrt(tube.bending_y / m) / leg**2 for m in (tube.line_mass + load, tube.line_mass)]
    assert bounds[0] < first < bounds[1]
