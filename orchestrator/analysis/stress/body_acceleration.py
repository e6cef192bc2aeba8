"""Accelerations of a body's frame from its recorded momenta, as the load that its inertia is under."""

from __future__ import annotations

import numpy as np
import scipy

from components.contract.component import Vector
from components.contract.frames import Vector3, skew
from components.flexible.modal import ModalData

from ...results.result import Result


def acceleration_field(result: Result, body: str, data: ModalData, gravity: Vector3) -> Vector:
    """Coefficients (N, 12) of a(s) - g = a + G s at the communication points, body axes, s from the centre of mass.

    Columns: a (m/s2), then the entries of G = skew(alpha) + skew(omega)² (1/s2) column by column, as
    `inertia_relief` of `components.flexible.reduction` wants them. Rates of change are those of the momenta over the
    steps on both sides of a communication point; an impulse (step of no length) is left out. The angular velocity is
    that of the undeformed body, an error of second order in the deformation.
    """
    time = result.time
    attitude = scipy.spatial.transform.Rotation.from_quat(
        result.signal(body, "frame_orientation"), scalar_first=True
    )
    momentum = result.signal(body, "linear_momentum")
    center = result.signal(body, "frame_position") + attitude.apply(data.center_of_mass)
    spin = result.signal(body, "angular_momentum") - np.cross(center, momentum)
    omega = attitude.apply(spin, inverse=True) @ np.linalg.inv(data.inertia).T
    felt = _rate(time, momentum) / data.mass - np.asarray(gravity, dtype=float)
    turning = skew(omega)
    gradient = skew(_rate(time, omega)) + turning @ turning
    columns = gradient.transpose(0, 2, 1).reshape(len(time), 9)
    return np.hstack([attitude.apply(felt, inverse=True), columns])


def _rate(time: Vector, values: Vector) -> Vector:
    """Rate of change (N, k) of values (N, k): mean of the two steps that meet, or of the one there is."""
    h = np.diff(time)
    moves = h > 0.0
    slopes = np.diff(values, axis=0) / np.where(moves, h, 1.0)[:, None]
    slopes[~moves] = 0.0
    count = np.zeros(time.size)
    total = np.zeros_like(values)
    for side in (slice(None, -1), slice(1, None)):
        total[side] += slopes
        count[side] += moves
    rate: Vector = total / np.maximum(count, 1.0)[:, None]
    return rate
