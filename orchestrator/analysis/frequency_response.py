"""Response of a scene to vibration of its base: accelerations of points and interface loads over frequency.

Direct complex solutions of (-w^2 M + i w C + K) q = 0 with the base prescribed, so damping need not be modal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from components.contract.component import Vector

from ..assembly.statics.configuration import Configuration
from ..assembly.statics.linear_model import LinearModel, modal_damping, normal_modes
from ..records import short_repr
from ..scene import SceneError
from .vibration import DIRECTIONS, INTERFACE

Complex = NDArray[np.complex128]
_AROUND = np.concatenate((-np.geomspace(0.1, 30.0, 12)[::-1], [0.0], np.geomspace(0.1, 30.0, 12)))
"""Frequencies around a resonance, in half-widths of its peak."""
_LEAST_DAMPING = 1e-5


class Response(NamedTuple):
    """Complex amplitude (F,) of one output for a base acceleration of 1."""

    name: str
    unit: str
    values: Complex


@short_repr
@dataclass(frozen=True)
class FrequencyResponse:
    """Responses of a scene to an acceleration of its base, of 1 m/s2 or 1 rad/s2; frequencies: Hz, shape (F,).

    The base moves as prescribed, whatever its mass: a free one (`base_is_free`) as well, which would not by itself.
    """

    scene: str
    configuration: Configuration
    base_is_free: bool
    excitation: str
    frequencies: Vector
    responses: tuple[Response, ...]

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        curves = [
            {
                "output": response.name,
                "unit": response.unit,
                "magnitude": np.abs(response.values).tolist(),
                "phase_deg": np.rad2deg(np.angle(response.values)).tolist(),
            }
            for response in self.responses
        ]
        return {
            "scene": self.scene,
            "configuration": self.configuration.as_dict(),
            "base_is_free": self.base_is_free,
            "excitation": self.excitation,
            "frequency_hz": self.frequencies.tolist(),
            "responses": curves,
        }


def base_response(model: LinearModel, excitation: int, frequencies: Vector) -> tuple[Complex, Complex]:
    """Accelerations (F, n) of all coordinates and loads (F, 6) on the base for a base acceleration of 1.

    excitation: 0 to 5 for translations (m/s2) and rotations (rad/s2) of the base about its reference point, of
    which the loads (N, N.m) are counted too. frequencies: Hz, positive.
    """
    base = model.base_rows
    others = model.other_rows
    rigid = model.mechanism.rigid_motion(model.origin)
    carried = rigid[:, excitation]
    mass = model.mass_on_base  # loads are those at the interface, on whatever base there is
    accelerations = np.zeros((len(frequencies), len(mass)), dtype=complex)
    loads = np.zeros((len(frequencies), 6), dtype=complex)
    for k, omega in enumerate(2.0 * np.pi * np.asarray(frequencies, dtype=float)):
        dynamic = -(omega**2) * mass + 1j * omega * model.damping + model.stiffness
        motion = carried.astype(complex) / -(omega**2)
        force = dynamic @ motion
        motion[others] -= np.linalg.solve(dynamic[np.ix_(others, others)], force[others])
        accelerations[k] = -(omega**2) * motion
        loads[k] = -(dynamic @ motion)[base]
    return accelerations, loads


def frequency_grid(model: LinearModel, low: float, high: float, points: int) -> Vector:
    """Frequencies (Hz) from low to high, evenly on a log scale and dense around resonances on a held base."""
    modes = normal_modes(model, model.base_constraints)
    damping = modal_damping(model, modes)
    grid = [np.geomspace(low, high, points)]
    for frequency, ratio in zip(modes.frequencies, damping, strict=True):
        if frequency > 0.0 and ratio < 1.0:
            grid.append(frequency * (1.0 + max(ratio, _LEAST_DAMPING) * _AROUND))
    found = np.unique(np.concatenate(grid))
    result: Vector = found[(found >= low) & (found <= high)]
    return result


def point_motion(model: LinearModel, name: str) -> Vector:
    """Motion (6, n) of a point named BODY.POINT; SceneError where there is none."""
    mechanism = model.mechanism
    known = []
    for body, placed in mechanism.bodies.items():
        for point in placed.body.data.point_names if placed.body is not None else ():
            known.append(point if "." in point else f"{body}.{point}")
            if known[-1] == name:
                return mechanism.point_jacobian(body, point)
    raise SceneError([f"there is no point {name!r}; points are {', '.join(known)}"])


def responses(
    model: LinearModel, excitation: str, along: str, points: Sequence[str], frequencies: Vector
) -> list[Response]:
    """Accelerations of points, or with `INTERFACE` the load on the base, along or about an axis."""
    row = DIRECTIONS.index(along)
    motions = {name: point_motion(model, name)[row] for name in points if name != INTERFACE}
    accelerations, loads = base_response(model, DIRECTIONS.index(excitation), frequencies)
    given = "(rad/s2)" if excitation.startswith("r") else "(m/s2)"
    found = []
    for name in points:
        if name == INTERFACE:
            unit = "N.m" if along.startswith("r") else "N"
            found.append(Response(f"{name} {along}", f"{unit}/{given}", loads[:, row]))
        else:
            unit = "(rad/s2)" if along.startswith("r") else "(m/s2)"
            found.append(Response(f"{name} {along}", f"{unit}/{given}", accelerations @ motions[name]))
    return found


def peaks(frequencies: Vector, values: Complex, count: int = 5) -> list[tuple[float, float]]:
    """Frequency and magnitude of the largest local maxima, falling."""
    size = np.abs(values)
    inner = np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:])) + 1
    order = inner[np.argsort(-size[inner])][:count]
    return [(float(frequencies[k]), float(size[k])) for k in order]
