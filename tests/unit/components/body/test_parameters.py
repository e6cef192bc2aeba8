"""What a body is given: where the start puts it and the damping scale in closed form, and data that no body has."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from components.body import Body
from components.contract.component import ComponentError
from components.flexible.modal import ModalData
from tests.unit.components.body.body_cases import (
    SPIN,
    VELOCITY,
    flexible,
    modal_data,
    motions,
    moving_state,
    no_wrench,
    observed,
    wrenches,
)
from tests.unit.components.prepared import prepared


def test_initial_parameters_place_and_move_the_construction_frame():
    """Closed form: ports of a rigid body at p + R s with velocity v + w x (R s), v that of the centre of mass."""
    turn = Rotation.from_rotvec((0.4, -1.1, 0.7))
    place, velocity, spin = np.array([1.0, 2.0, 3.0]), VELOCITY, SPIN
    center = np.array([0.2, -0.1, 0.3])
    data = ModalData.rigid(2.0, center, np.diag((1.0, 2.0, 2.5)), {"p": (0.5, 0.6, -0.7)})
    port_turn = Rotation.from_rotvec((0.2, 0.3, -0.9))
    ports = [
        {
            "name": "p",
            "point": "p",
            "offset": (0.1, 0.0, -0.2),
            "orientation": tuple(np.roll(port_turn.as_quat(), 1)),
        }
    ]
    body = Body(modal=data.to_arrays(), ports=ports)
    c = prepared(
        body,
        initial_position=place,
        initial_orientation=np.roll(turn.as_quat(), 1),
        initial_velocity=velocity,
        initial_angular_velocity=spin,
    )
    x = body.initial(c, no_wrench(body))
    port = motions(body, c, x)[0]
    arm = turn.apply(np.array([0.6, 0.6, -0.9]))
    attitude = Rotation.from_quat(np.roll(port[3:7], -1)).as_matrix()
    round_off = 1e-13
    assert port[:3] == pytest.approx(place + arm, abs=round_off)
    assert attitude == pytest.approx((turn * port_turn).as_matrix(), abs=round_off)
    assert port[7:10] == pytest.approx(velocity + np.cross(spin, arm - turn.apply(center)), abs=round_off)
    assert port[10:13] == pytest.approx(spin, abs=round_off)
    assert observed(body, c, x, "frame_position") == pytest.approx(place, abs=round_off)
    assert observed(body, c, x, "angular_momentum") == pytest.approx(
        np.cross(place + turn.apply(center), 2.0 * velocity)
        + turn.apply(data.inertia @ turn.inv().apply(spin)),
        abs=round_off,
    )


def test_damping_scale_multiplies_every_ratio():
    """Closed form: no damping without, and the published default of twice the ratio with 2."""
    body, _ = flexible(modal_data(damping=0.03))
    doubled, plain = prepared(body, damping_scale=2.0), flexible(modal_data(damping=0.06))
    x, _ = moving_state(body, doubled)
    assert body.step(doubled, x, wrenches(), 1e-3) == pytest.approx(
        plain[0].step(plain[1], x, wrenches(), 1e-3), rel=1e-14
    )
    undamped = prepared(body, damping_scale=0.0)
    assert body.step(undamped, x, wrenches(), 1e-3)[16] == 0.0


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"mass": 0.0}, "mass .*0 kg"),
        ({"inertia": np.diag((1.0, 1.0, 2.5))}, "triangle inequality"),
        ({"inertia": np.diag((1.0, 1.0, -0.5))}, "positive"),
        ({"frequency": np.array([0.0, 1.0, 2.0, 3.0])}, "positive frequency"),
    ],
)
def test_impossible_bodies_are_refused(change, words):
    """Laws of mechanics: masses, principal moments and frequencies that cannot be are named in a sentence."""
    with pytest.raises(ComponentError, match=words):
        flexible(replace(modal_data(), **change))
    with pytest.raises(ComponentError, match="'nowhere'"):
        flexible(ports=[{"name": "a", "point": "nowhere"}])
