"""Flexible and rigid bodies for tests: point masses on a grid with made-up modes, loads on them, what they show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from components.body import Body
from components.contract.component import Vector
from components.flexible.modal import ModalData
from tests.references import nodal_flexible_body as nodal
from tests.unit.components.prepared import prepared

GRID = np.array([(x, y, z + 0.1 * x * y) for x in (0.0, 0.5, 1.0) for y in (-0.4, 0.4) for z in (0.0, 0.15)])
MASSES = np.linspace(0.8, 1.2, len(GRID))
HERTZ = np.array([2.0, 5.0, 11.0, 30.0])
FORCES = ((30.0, -20.0, 10.0), (-25.0, 15.0, 12.0))
TORQUES = ((1.0, 2.0, -1.5), (-2.0, 1.0, 1.0))
OFFSETS = ((0.0, 0.0, 0.0), (0.1, 0.05, 0.02))
ENDS = (0, len(GRID) - 1)
PORTS = tuple(
    {"name": name, "point": str(node), "offset": offset}
    for name, node, offset in zip(("first", "second"), ENDS, OFFSETS, strict=True)
)
EVERY_NODE = tuple({"name": f"n{i}", "point": str(i)} for i in range(len(GRID)))
ETA = np.array([0.12, -0.08, 0.05, 0.01])
SPIN = np.array([3.0, -4.0, 3.0])
VELOCITY = np.array([0.3, 0.2, -0.1])


def modal_data(turn: float = 0.05, damping: float | Sequence[float] = (0.02, 0.05, 0.1, 0.3)) -> ModalData:
    """Made-up shapes of a grid of point masses, no two invariants alike; every mass is a point.

    turn: rotation (rad) of a node per unit of a modal coordinate, before the rigid part is taken out.
    """
    shapes = [
        [
            np.sin((k + 1) * p[0] + 2 * axis + p[2]) + (k - 1) * p[1] * p[0] * np.cos(axis + k)
            for axis in range(3)
        ]
        for k in range(4)
        for p in GRID
    ]
    rotations = turn * np.random.default_rng(1).standard_normal((len(GRID), 3, 4))
    points = {str(i): i for i in range(len(GRID))}
    stacked = np.array(shapes).reshape(4, -1).T
    data = ModalData.from_point_masses(MASSES, GRID, stacked, 2 * np.pi * HERTZ, points, rotations)
    return data.with_damping(damping)


def nodal_body(data: ModalData) -> nodal.NodalBody:
    """The same body for the independent formulation."""
    arms = data.point_positions - data.center_of_mass
    return nodal.NodalBody(MASSES, arms, data.translation, data.rotation, data.frequency, data.damping_ratio)


def flexible(
    data: ModalData | None = None,
    coupling: str = "full",
    ports: Sequence[Mapping[str, Any]] = PORTS,
    **start: Any,
) -> tuple[Body, Any]:
    """A flexible body and its constants, parameters by name."""
    data = modal_data() if data is None else data
    body = Body(modal=data.to_arrays(), ports=ports, inertia_coupling=coupling)  # type: ignore[arg-type]
    return body, prepared(body, **start)


def loads(torque: float = 1.0) -> list[nodal.PortLoad]:
    """Forces on both ends, and that share of the torques."""
    return [
        nodal.PortLoad(node, offset, force, tuple(torque * np.array(moment)))
        for node, offset, force, moment in zip(ENDS, OFFSETS, FORCES, TORQUES, strict=True)
    ]


def wrenches(torque: float = 1.0) -> Vector:
    """The same loads as inputs (24,) of the body, held over a step."""
    return np.concatenate([*((*load.force, *load.torque) for load in loads(torque)), np.zeros(12)])


def no_wrench(body: Body) -> Vector:
    """Inputs without loads."""
    return body.input_layout.start_values()


def moving_state(
    body: Body, c: Any, eta: Vector = ETA, spin: Vector = SPIN, rate: Vector | None = None
) -> tuple[Vector, nodal.Motion]:
    """A state of known eta, eta' and omega at the origin; its momenta from the nodes, not from invariants.

    Momenta are derivatives of the kinetic energy v^T M(q) v / 2, hence rows of M(q) v.
    """
    m = body.modes
    rate = np.zeros(m) if rate is None else rate
    motion = nodal.Motion(np.zeros(3), np.array([1.0, 0, 0, 0]), eta, VELOCITY, spin, rate)
    momenta = nodal.mass_matrix(nodal_body(body.data), motion) @ np.concatenate((VELOCITY, spin, rate))
    x = body.initial(c, no_wrench(body))
    x[0:3] = 0.0
    x[7:10], x[10:13] = momenta[:3], momenta[3:6]
    x[13:16] = spin
    for part, values in zip(modal(x, m), (eta, momenta[6:]), strict=True):
        part[:] = values
    return x, motion


def stepped(body: Body, c: Any, x: Vector, u: Vector, h: float, steps: int) -> Vector:
    """The state after steps under held wrenches."""
    for _ in range(steps):
        x = body.step(c, x, u, h)
    return x


def coordinates(x: Vector, modes: int = 4) -> Vector:
    """Position, orientation and modal coordinates of a state."""
    return np.concatenate((x[:7], modal(x, modes)[0]))


def modal(x: Vector, modes: int = 4) -> tuple[Vector, Vector]:
    """Modal coordinates and momenta (modes,) of a state, views of it."""
    return x[17 : 17 + modes], x[17 + modes : 17 + 2 * modes]


def moments(body: Body, c: Any, x: Vector) -> Vector:
    """First moments of velocity and angular velocity of every port over the last step (ports, 6)."""
    return body.outputs(c, x, no_wrench(body))[13 * len(body.ports) :].reshape(-1, 6)


def motions(body: Body, c: Any, x: Vector) -> Vector:
    """Position, orientation, velocity and angular velocity of every port (ports, 13)."""
    return body.outputs(c, x, no_wrench(body))[: 13 * len(body.ports)].reshape(-1, 13)


def observed(body: Body, c: Any, x: Vector, name: str) -> Any:
    """One observation, a float or an array."""
    z = body.observe(c, x, no_wrench(body))[body.observation_layout[name]]
    return z if len(z) > 1 else float(z[0])


def total_energy(body: Body, c: Any, x: Vector) -> float:
    """Kinetic, potential and dissipated energy (J)."""
    z, at = body.observe(c, x, no_wrench(body)), body.observation_layout
    return float(sum(z[at[name]][0] for name in ("kinetic_energy", "potential_energy", "dissipated_energy")))


def extrapolated(values: Sequence[Any]) -> tuple[Any, float]:
    """Richardson's value of results of second order at h, h/2 and h/4, and a bound of its error.

    What it leaves is of the fourth order: a fifteenth of its difference from the coarser extrapolation, bounded
    by an eighth.
    """
    coarse, fine = ((4 * b - a) / 3 for a, b in pairwise(values))
    return fine, float(np.abs(fine - coarse).max()) / 8
