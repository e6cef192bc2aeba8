"""Ports of a body: velocities against differences of poses, and mobility in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from components.numerics.oscillators import propagator
from tests.references.nodal_flexible_body import cross_matrix
from tests.unit.components.body.body_cases import (
    ENDS,
    ETA,
    OFFSETS,
    PORTS,
    flexible,
    modal_data,
    motions,
    moving_state,
    no_wrench,
    wrenches,
)


def test_port_velocities_are_derivatives_of_port_poses():
    """Finite differences across two steps about their middle: second order in h, extrapolated to the fourth.

    The port's orientation is q exp(Psi eta); its angular velocity has the left Jacobian, series to second
    order, hence the bound theta^3 / 24 of the local twist.
    """
    data = modal_data()
    data = replace(data, rotation=0.2 * data.rotation)
    turned = dict(PORTS[1], orientation=(np.cos(0.3), 0.0, np.sin(0.3), 0.0))
    body, c = flexible(data, ports=(PORTS[0], turned))
    rate = np.array([0.9, -1.2, 0.5, 0.3])
    start, _ = moving_state(body, c, rate=rate)

    def differences(h):
        """Port rates by difference minus port rates given, in the middle."""
        x = body.step(c, start, wrenches(), h)
        behind, now, ahead = (motions(body, c, s) for s in (start, x, body.step(c, x, wrenches(), h)))
        spin = [
            (Rotation.from_quat(np.roll(a, -1)) * Rotation.from_quat(np.roll(b, -1)).inv()).as_rotvec()
            for a, b in zip(ahead[:, 3:7], behind[:, 3:7], strict=True)
        ]
        return np.hstack(((ahead - behind)[:, :3], spin)) / (2 * h) - now[:, 7:]

    coarse, middle, fine = (differences(h) for h in (2e-4, 1e-4, 5e-5))
    extrapolated = (4 * fine - middle) / 3
    # the middle moves with h, so odd powers stay: the next term shrinks by 8 per halving
    rest = np.abs(extrapolated - (4 * middle - coarse) / 3) / 4
    bound, turning_bound = rest[:, :3].max(), rest[:, 3:].max()
    theta = max(np.linalg.norm(data.rotation[i] @ ETA) for i in ENDS)
    twist = max(np.linalg.norm(data.rotation[i] @ rate) for i in ENDS)
    assert max(bound, turning_bound) < 1e-6
    assert np.abs(extrapolated[:, :3]).max() < bound
    assert np.abs(extrapolated[:, 3:]).max() < turning_bound + twist * theta**3 / 24


def test_port_mobility_at_rest():
    """Closed form: rigid part plus X diag(b(h)) X^T, for poses and for rates; central differences.

    Round-off of places and turns of order one, 2e-16 over 2e-4 N, is 1e-8 of a mobility of 1e-4.
    """
    data = modal_data()
    body, c = flexible(data)
    x = body.initial(c, no_wrench(body))
    h, amplitude = 0.02, 1e-4
    columns = []
    for k in range(12):
        u = np.zeros(24)
        u[k] = amplitude
        up, down = (motions(body, c, body.step(c, x, s * u, h)) for s in (1, -1))
        difference = (up - down) / (2 * amplitude)
        # a small turn is twice the vector part of its quaternion; the first port's axes are the body's
        columns.append(np.hstack((difference[:, :3], 2 * difference[:, 4:7], difference[:, 7:])).ravel())
    found = np.array(columns).T.reshape(2, 12, 12)

    motion = []
    for node, offset in zip(ENDS, OFFSETS, strict=True):
        arm = data.point_positions[node] - data.center_of_mass + np.array(offset)
        elastic = data.translation[node] - cross_matrix(np.array(offset)) @ data.rotation[node]
        rigid_part = np.block([[np.eye(3), -cross_matrix(arm)], [np.zeros((3, 3)), np.eye(3)]])
        motion.append((rigid_part, np.vstack((elastic, data.rotation[node]))))
    rigid_rows, shapes = (np.vstack(part) for part in zip(*motion, strict=True))
    inverse = np.zeros((6, 6))
    inverse[:3, :3] = np.eye(3) / data.mass
    inverse[3:, 3:] = np.linalg.inv(data.inertia)
    modal = propagator(data.frequency, data.damping_ratio, h)
    pose = 0.5 * h * h * rigid_rows @ inverse @ rigid_rows.T + shapes @ np.diag(modal.b1) @ shapes.T
    rate = h * rigid_rows @ inverse @ rigid_rows.T + shapes @ np.diag(modal.b2) @ shapes.T
    for port in range(2):
        rows = slice(6 * port, 6 * port + 6)
        for part, expected in ((found[port, :6], pose), (found[port, 6:], rate)):
            size = np.abs(expected).max()
            assert part == pytest.approx(expected[rows], rel=0, abs=1e-7 * size)
