"""Point masses on bodies of the catalogue, and the weld of two finite-element models."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import linalg, sparse
from scipy.sparse.linalg import splu

from components.catalogue.definition import rigid_with_masses, with_masses
from components.catalogue.frame import Frame, Path
from components.contract.component import ComponentError
from components.contract.frames import skew
from components.flexible.beam_frame import BeamSection, Member, beam_frame
from components.flexible.joined import joined
from components.flexible.modal import ModalData
from components.flexible.panel import panel_model
from components.flexible.plate import HingeArm, Panel, Plate
from components.flexible.reduction import fixed_interface_frequencies, free_frequencies
from tests.references import catalogue

BRACKET = (("center", 0.40),)
SECTION = BeamSection(1e7, 1000.0, 3000.0, 700.0, 1.3, 0.01)


@pytest.fixture(autouse=True, scope="module")
def _own_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FANFOLD_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


def meshed(name):
    """An entry with elements of 0.2 m, which is nothing to what is compared here on one mesh."""
    body = catalogue.entry(name)
    return replace(body, panel=replace(body.panel, element_size=0.2))


def clamped_frequencies(data, points):
    """Frequencies (rad/s) of modal data held at its first `points` points: rigid motions and modes constrained."""
    modes = data.frequency.size
    rows = []
    for k in range(points):
        arm = data.point_positions[k] - data.center_of_mass
        rows.append(np.hstack([np.eye(3), -skew(arm), data.translation[k]]))
        rows.append(np.hstack([np.zeros((3, 3)), np.eye(3), data.rotation[k]]))
    held = linalg.null_space(np.concatenate(rows))
    mass = linalg.block_diag(data.mass * np.eye(3), data.inertia, np.eye(modes))
    stiffness = np.diag(np.append(np.zeros(6), data.frequency**2))
    return np.sqrt(linalg.eigh(held.T @ stiffness @ held, held.T @ mass @ held, eigvals_only=True))


def test_first_frequency_with_a_bracket():
    """Independent formulation: the mass as a force, 1 = w² m a(w), a the receptance of the bare panel there.

    The reduced body must have the root to round-off (B12): it holds that mode as a fixed-interface mode. Below
    the bare panel's first frequency the receptance rises, so there is one root, where the sign changes.
    """
    body = meshed("workbench_panel")
    bare = body.finite_elements()
    held = np.concatenate([bare.attachment_dofs[name] for name in ("hl_left", "hl_right")])
    free = np.setdiff1d(np.arange(bare.stiffness.shape[0]), held)
    stiffness, mass = bare.stiffness[free][:, free], bare.mass_matrix[free][:, free]
    deflection = bare.point_motions["center"][[2]].toarray()[0, free]

    def equation(omega):
        receptance = deflection @ splu(sparse.csc_array(stiffness - omega**2 * mass)).solve(deflection)
        return omega**2 * 0.40 * receptance - 1.0

    first = clamped_frequencies(body.flexible(10, BRACKET), 2)[0]
    assert equation(first * (1 - 1e-7)) < 0.0 < equation(first * (1 + 1e-7))
    assert first < 0.99 * clamped_frequencies(body.flexible(10), 2)[0]


def test_coarse_panel_with_a_bracket():
    """Dense recomputation: a mass tied by stiff springs (1e9 N/m) to the plate is a separate body that follows it."""
    plate = Plate(1.0, 0.8, 3.0, (900.0, 900.0, 200.0, 60.0), (1e7, 1e7, 1e6, 1e6))
    panel = Panel(plate, (HingeArm("root", 0.0, point_mass=0.1),), {"center": (0.5, 0.1)}, 0.0, 0.35)
    model = panel_model(panel)
    tie = model.point_motions["center"][:3].toarray()
    n = model.stiffness.shape[0]
    springs = np.hstack([tie, -np.eye(3)])
    stiffness = linalg.block_diag(model.stiffness.toarray(), np.zeros((3, 3))) + 1e9 * springs.T @ springs
    mass = linalg.block_diag(model.mass_matrix.toarray(), 0.4 * np.eye(3))
    free = np.setdiff1d(np.arange(n + 3), model.attachment_dofs["root"])
    expected = linalg.eigh(stiffness[np.ix_(free, free)], mass[np.ix_(free, free)], eigvals_only=True)[:4]
    found = fixed_interface_frequencies(with_masses(model, BRACKET), ("root",), 4)
    np.testing.assert_allclose(found, np.sqrt(expected), rtol=1e-4)  # m w² / 1e9 of softness, w < 500 rad/s
    assert found[0] < 0.97 * fixed_interface_frequencies(model, ("root",), 1)[0]


@pytest.mark.parametrize("masses", [BRACKET, (("hl1_left", 0.7), ("hold_down", 0.2), ("hl1_left", 0.3))])
def test_rigid_and_flexible_bodies_agree(masses):
    """Two ways: sums over the finite elements' samples against parallel axes; also of the reduced body."""
    body = meshed("bepicolombo_inboard")
    model, rigid = body.finite_elements(masses), body.rigid(masses)
    assert rigid.mass == pytest.approx(model.mass, rel=1e-12)
    np.testing.assert_allclose(rigid.center_of_mass, model.center_of_mass, atol=1e-12)
    np.testing.assert_allclose(rigid.inertia, model.inertia, atol=1e-11)
    flexible = body.flexible(0, masses)
    np.testing.assert_allclose(flexible.inertia, rigid.inertia, atol=1e-11)


def test_two_point_masses_and_a_body():
    """Closed form: 2 kg at the origin and 2 kg at (0, 3, 0) have m d² = 1 * 9 kg m2 about x and z."""
    body = ModalData.rigid(2.0, (0.0, 0.0, 0.0), np.eye(3), {"p": (0.0, 3.0, 0.0)})
    heavier = rigid_with_masses(body, (("p", 1.5), ("p", 0.5)))
    assert heavier.mass == 4.0
    np.testing.assert_allclose(heavier.center_of_mass, [0.0, 1.5, 0.0])
    np.testing.assert_allclose(heavier.inertia, np.diag([10.0, 1.0, 10.0]))
    assert rigid_with_masses(body, ()) is body


def test_amos3_sheet_stays_with_masses():
    """Bookkeeping: masses come on top of the sheet's totals."""
    body = catalogue.entry("amos3_panel2").rigid(BRACKET)
    assert body.mass == pytest.approx(7.78 + 0.40)
    assert body.center_of_mass[0] == pytest.approx((7.78 * 0.7742 + 0.40 * 0.805) / 8.18)


def test_masses_are_part_of_the_cache(tmp_path, monkeypatch):
    """Bookkeeping: other masses are another body; the same ones are read bit for bit."""
    monkeypatch.setenv("FANFOLD_CACHE", str(tmp_path))
    bare, light, heavy = (
        catalogue.entry("amos3_yoke").flexible(2, m) for m in ((), (("guide", 0.1),), (("guide", 0.2),))
    )
    assert bare.mass + 0.2 == pytest.approx(light.mass + 0.1) == pytest.approx(heavy.mass)
    assert len(list(tmp_path.iterdir())) == 3
    np.testing.assert_array_equal(
        catalogue.entry("amos3_yoke").flexible(2, (("guide", 0.1),)).frequency, light.frequency
    )


@pytest.mark.parametrize(
    ("masses", "told"),
    [
        ((("middle", 0.4),), "'middle'.*hl1, hl2_left, hl2_right, guide"),
        ((("guide", -0.4),), "-0.4 kg"),
        ((("guide", 0.0),), r"\b0(\.0)? kg"),
        ((("guide", float("nan")),), "nan kg"),
    ],
)
def test_impossible_masses(masses, told):
    """Messages say what is wrong, of flexible and rigid bodies."""
    for entry in (
        lambda m: catalogue.entry("amos3_yoke").flexible(2, m),
        catalogue.entry("amos3_yoke").rigid,
    ):
        with pytest.raises(ComponentError, match=told):
            entry(masses)


def test_unknown_entry():
    """The message lists the entries."""
    with pytest.raises(ComponentError, match=r"'moon'.*amos3_yoke, amos3_panel2"):
        catalogue.entry("moon").finite_elements()


def test_weld_of_two_beams():
    """Two ways: halves of a bent frame welded at the knee are the frame."""
    joints = {"root": (0, 0, 0), "knee": (0.8, 0, 0), "tip": (0.8, 0.5, 0.2)}
    whole = beam_frame(joints, [Member("root", "knee", SECTION, 3), Member("knee", "tip", SECTION, 2)])
    first = beam_frame({k: joints[k] for k in ("root", "knee")}, [Member("root", "knee", SECTION, 3)])
    second = beam_frame({k: joints[k] for k in ("knee", "tip")}, [Member("knee", "tip", SECTION, 2)])
    model = joined(first, second)
    assert set(model.point_positions) == set(model.attachment_dofs) == {"root", "tip"}
    np.testing.assert_allclose(model.inertia, whole.inertia, atol=1e-12)
    np.testing.assert_allclose(free_frequencies(model, 6), free_frequencies(whole, 6), rtol=1e-9)
    found = fixed_interface_frequencies(model, ("root",), 6)
    np.testing.assert_allclose(found, fixed_interface_frequencies(whole, ("root",), 6), rtol=1e-9)
    faces = model.display_faces
    lengths = np.linalg.norm(np.diff(model.display_positions[faces[:, :2]], axis=1)[:, 0], axis=1)
    np.testing.assert_allclose(lengths, [0.8 / 3] * 3 + [0.5 * np.hypot(0.5, 0.2)] * 2)


def test_plate_on_two_legs():
    """Closed form: equal couples C at both seats turn them by C L / EI and lift them by C L² / 2 EI."""
    arm = {"length": 0.0, "patch": 0.05}
    seats = tuple(HingeArm(f"yoke_{side}", y, **arm) for side, y in (("left", 0.15), ("right", -0.15)))
    plate = Plate(0.6, 0.5, 3.0, (900.0, 900.0, 200.0, 60.0), (1e7, 1e7, 1e6, 1e6))
    panel = panel_model(Panel(plate, seats, {"center": (0.7, 0.0)}, 0.4, 0.2))
    tube = catalogue.entry("amos3_yoke").frame.members[0].section
    sides = (("left", 0.15), ("right", -0.15))
    ends = {f"{end}_{side}": (x, y, 0.0) for side, y in sides for end, x in (("hl1", 0.0), ("yoke", 0.4))}
    legs = tuple(Path(side, (f"hl1_{side}", f"yoke_{side}"), tube, 4, 0.3) for side, _ in sides)
    model = joined(panel, Frame(tuple(ends.items()), legs).model(tuple(ends)))
    assert set(model.attachment_dofs) == {"hl1_left", "hl1_right"}
    rigid = model.displacement @ model.rigid_motions
    arms = np.concatenate([np.hstack([np.eye(3), -skew(p)]) for p in model.positions])
    np.testing.assert_allclose(rigid, arms, atol=1e-12)
    held = np.concatenate([model.attachment_dofs[f"hl1_{side}"] for side in ("left", "right")])
    free = np.setdiff1d(np.arange(model.stiffness.shape[0]), held)
    load = np.zeros(model.stiffness.shape[0])
    for seat in seats:
        load[panel.attachment_dofs[seat.name][4]] = 2.0
    motion = np.zeros_like(load)
    motion[free] = splu(sparse.csc_array(model.stiffness)[free][:, free]).solve(load[free])
    turn, lift = 2.0 * 0.4 / tube.bending_y, -2.0 * 0.4**2 / (2 * tube.bending_y)
    center = model.point_motions["center"] @ motion
    np.testing.assert_allclose(center, [0, 0, lift - turn * 0.3, 0, turn, 0], atol=1e-9 * turn)
    assert model.plate is not None
    resultants = model.plate.resultants @ motion
    assert np.abs(resultants).max() < 1e-6  # nothing bends the plate


@pytest.mark.parametrize(
    ("names", "shift", "told"),
    [
        (("c", "d"), 0.0, "common"),
        (("b", "d"), 0.1, "'b' at places 0.1 m apart"),
    ],
)
def test_impossible_welds(names, shift, told):
    """Messages name the point."""
    first = beam_frame({"a": (0, 0, 0), "b": (1, 0, 0)}, [Member("a", "b", SECTION, 2)])
    second = beam_frame({names[0]: (1 + shift, 0, 0), names[1]: (2, 0, 0)}, [Member(*names, SECTION, 2)])
    with pytest.raises(ComponentError, match=told):
        joined(first, second)


def test_welds_keep_names_apart():
    """Two nodes of one name are refused; so is a plate as the second model."""
    plate = Plate(1.0, 1.0, 3.0, (900.0, 900.0, 200.0, 60.0), (1e7, 1e7, 1e6, 1e6))
    panels = [
        panel_model(Panel(plate, (HingeArm("hub", 0.0),), {node: (0.5, 0.0)}, element_size=0.5))
        for node in ("center", "center", "other")
    ]
    with pytest.raises(ComponentError, match="node 'center'"):
        joined(panels[0], panels[1])
    with pytest.raises(ComponentError, match="plate"):
        joined(panels[0], panels[2])
