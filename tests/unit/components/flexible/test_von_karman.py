"""Plates whose bending stretches them: a reduced body against another method and published deflections."""

from dataclasses import replace

import numpy as np
import pytest

from components import FanfoldError
from components.contract.component import ComponentError
from components.flexible.modal import ModalData, rigid_motion
from components.flexible.reduction import orthonormal_modes
from components.flexible.von_karman import tension_fields
from tests.references import catalogue
from tests.unit.components.clamped_membrane import (
    AREAL_MASS,
    MODULUS,
    RATIO,
    SIDE,
    THICKNESS,
    clamped_membrane,
    membrane_model,
)
from tests.unit.components.flexible.clamped_plate import ClampedPlate

TABLE = {5.0: 0.482e-3, 20.0: 0.949e-3, 56.27: 1.417e-3, 200.0: 2.226e-3}
"""Pa and m: middle of the membrane under uniform pressure, by another basis."""
LEVY = {17.79: 0.237, 95.0: 0.912, 402.0: 1.902}
"""p a^4 / (E h^4) and w / h of a clamped square of Poisson's ratio 0.316 (Levy 1942), up to 2.5 % above others."""
MODES = 30


def held_deflection(data: ModalData, pressure: float, points: tuple[str, ...]) -> float:
    """Of the point `center` (m) under a pressure (Pa), of a body that is held at points."""
    z, middle = held(data, pressure, points), data.point_names.index("center")
    return float(z[2] + data.translation[middle, 2] @ z[6:])


def held(data: ModalData, pressure: float, points: tuple[str, ...]) -> np.ndarray:
    """Coordinates of a body that hangs on points and is accelerated as if by a pressure (Pa).

    They are six rigid motions and the modes: the least energy where the points do not move to second order.
    """
    low, forms = data.second_order_modes, data.tension_forms
    index = [data.point_names.index(name) for name in points]
    rigid = np.array([rigid_motion(data.point_positions[i] - data.center_of_mass) for i in index])
    shapes = np.concatenate((data.translation[index], data.rotation[index]), axis=1)
    size, pairs = 6 + data.frequency.size, slice(6, 6 + low)
    z, reaction = np.zeros(size), np.zeros(6 * len(index))
    for _ in range(40):
        eta, stretching = z[6:], z[pairs]
        slope = forms @ stretching
        tension = 0.5 * slope @ stretching
        second = data.second_order_points[index] @ stretching
        moved = rigid @ z[:6] + shapes @ eta + 0.5 * second @ stretching
        motion = np.concatenate((rigid, shapes), axis=2)
        motion[:, :, pairs] += second
        motion = motion.reshape(6 * len(index), size)
        force = np.concatenate((np.zeros(6), data.frequency**2 * eta))
        force[2] -= pressure / AREAL_MASS * data.mass
        force[pairs] += tension @ slope
        stiffness = np.diag(np.concatenate((np.zeros(6), data.frequency**2)))
        stiffness[pairs, pairs] += slope.T @ slope + np.tensordot(tension, forms, 1)
        stiffness[pairs, pairs] += np.tensordot(
            reaction.reshape(-1, 6), data.second_order_points[index], axes=2
        )
        matrix = np.block([[stiffness, motion.T], [motion, np.zeros((reaction.size, reaction.size))]])
        step = np.linalg.solve(matrix, -np.concatenate((force + motion.T @ reaction, moved.ravel())))
        z, reaction = z + step[:size], reaction + step[size:]
        if np.abs(step[:size]).max() <= 1e-12 * np.abs(z).max():
            return z
    raise AssertionError("no equilibrium")


@pytest.fixture(scope="module")
def membrane():
    """The foil in one rigid border."""
    return clamped_membrane(MODES)


def galerkin(modes: int) -> ClampedPlate:
    """The same by a method that shares nothing; so many modes are symmetric about both middle lines."""
    rigidity = MODULUS * THICKNESS / (1.0 - RATIO**2)
    return ClampedPlate(SIDE, rigidity * THICKNESS**2 / 12.0, rigidity, RATIO, AREAL_MASS, modes)


def test_deflection_under_pressure(membrane):
    """Table of another basis to 1 %; and with as many modes a method that shares nothing, to what the mesh leaves."""
    found = {pressure: held_deflection(membrane, pressure, ("border",)) for pressure in TABLE}
    assert found == pytest.approx(TABLE, rel=0.01)
    plate = galerkin(10)  # of the 30 lowest modes of a square
    assert found == pytest.approx({pressure: plate.deflection(pressure) for pressure in TABLE}, rel=1e-3)


def test_tension_in_the_middle():
    """The same method, at a point, where elements of 50 mm leave 2 % in the plane."""
    model, data = membrane_model(element_size=0.05), clamped_membrane(20, element_size=0.05)
    frequency, modes = orthonormal_modes(model, ["border"], 20)
    assert frequency == pytest.approx(data.frequency, rel=1e-9)
    fields = tension_fields(model, model.plate, modes, frequency, data.tension_forms)
    middle = int(np.argmin(np.linalg.norm(model.plate.positions - data.point_positions[1], axis=1)))
    plate = galerkin(6)
    for pressure in (20.0, 56.27):
        eta = held(data, pressure, ("border",))[6:]
        tensions = 0.5 * np.einsum("j,pjk,k->p", eta, data.tension_forms, eta)
        along_x, along_y, shear = fields[3 * middle : 3 * middle + 3] @ tensions
        assert along_x == pytest.approx(plate.tension(pressure), rel=0.02)
        assert along_y == pytest.approx(along_x, rel=1e-6)
        assert abs(shear) < 1e-6 * along_x


def test_levys_square_plate():
    """Published deflections of a clamped square, within the 2.5 % that these lie above those of other methods."""
    data = clamped_membrane(MODES, ratio=0.316)
    scale = MODULUS * THICKNESS**4 / SIDE**4
    found = {load: held_deflection(data, load * scale, ("border",)) / THICKNESS for load in LEVY}
    assert found == pytest.approx(LEVY, rel=0.025)


def test_a_border_of_eight_segments_pulls_by_its_ports():
    """Same plate: what the segments pull in is held at the eight points, by their displacements of second order."""
    body = catalogue.entry("antenna_membrane")
    plate = replace(body.panel.plate, geometry="von_karman")
    body = replace(body, panel=replace(body.panel, element_size=0.1, plate=plate))
    data = body.flexible(20, second_order_modes=29)
    whole = clamped_membrane(20)
    for pressure in (20.0, 56.27):
        parts = held_deflection(data, pressure, body.attachment_points)
        assert parts == pytest.approx(held_deflection(whole, pressure, ("border",)), rel=3e-3)


def test_all_modes_that_bend_a_plate_stretch_it():
    """Default: those of second order are the ones across the plate, and more are refused as of any body."""
    body = catalogue.entry("antenna_membrane")
    plate = replace(body.panel.plate, geometry="von_karman")
    body = replace(body, panel=replace(body.panel, element_size=0.25, plate=plate))
    data = body.flexible(0)
    assert data.second_order_modes == 3 * 8 - 3
    with pytest.raises(ComponentError, match=r"80.*second_order_modes"):
        body.flexible(80)
    kept = data.keep_modes([0, 2, 30])
    assert np.array_equal(kept.tension_forms[:, 0, 1], data.tension_forms[:, 0, 2])
    again = ModalData.from_arrays({name: np.asarray(v).tolist() for name, v in data.to_arrays().items()})
    assert np.array_equal(again.tension_forms, data.tension_forms)
    with pytest.raises(ComponentError, match="tension_forms has shape"):
        ModalData.from_arrays({**data.to_arrays(), "tension_forms": np.zeros(7)})


def test_a_geometry_is_linear_or_von_karmans():
    """Bad input: a sentence with the key."""
    table = catalogue.entry_table("antenna_membrane")
    assert catalogue.built(table).panel.plate.geometry == "linear"
    table["panel"]["geometry"] = "von_karman"
    assert catalogue.built(table).panel.plate.geometry == "von_karman"
    table["panel"]["geometry"] = "karman"
    with pytest.raises(FanfoldError, match=r"geometry: .*'karman'.*von_karman"):
        catalogue.built(table)
