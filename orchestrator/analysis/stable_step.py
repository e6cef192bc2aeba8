"""The largest communication step at which an assembly stays stable under a master that does not iterate.

Between two communication points bodies move exactly under wrenches that connections returned for the point before
the first, as where a master lets all FMUs step side by side and exchanges values afterwards (Jacobi); a master that
lets connections answer in between bears a little more. The linear model where a run begins decides, with lines
free and with lines latched, and with joints beyond their play; friction is no part of it. Growth is taken to be
monotone in the step.
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import replace

import numpy as np
import scipy

from components.contract.component import Vector
from components.contract.roles import LATCH_COMMAND
from components.hinge import Hinge
from components.hinge_parts.variables import CLEARANCES
from components.numerics.oscillators import propagator

from ..assembly import Assembly, Part
from ..assembly.statics.linear_model import LinearModel, linearise
from ..assembly.statics.mechanism import Mechanism

STEPS = tuple(m * 10.0**-k for k in range(2, 9) for m in (5.0, 2.0, 1.0))
"""Steps (s) among which it is sought, largest first."""


def largest_stable_step(assembly: Assembly) -> float | None:
    """The largest of `STEPS` (s) at which no motion grows by more than a factor e over the run; None for none.

    What grows by itself, as what motors drive, may. assembly: one whose connections answer with end-point wrenches.
    """
    mechanism = Mechanism(
        tuple(_at_its_walls(part) for part in assembly.parts), assembly.links, assembly.base
    )
    hinges = [hinge for line in assembly.hinge_lines if line.latches for hinge in line.hinges]
    models = [linearise(mechanism)]
    if hinges:
        mechanism.command(LATCH_COMMAND.name, 1.0, hinges)
        models.append(linearise(mechanism))
    allowed = [max(0.0, own_growth(model)) + 1.0 / assembly.until for model in models]

    def grows(h: float) -> bool:
        return any(growth(model, h) > limit for model, limit in zip(models, allowed, strict=True))

    steps = [h for h in STEPS if h <= assembly.largest_step]
    first = bisect_left(steps, True, key=lambda h: not grows(h))
    return steps[first] if first < len(steps) else None


def _at_its_walls(part: Part) -> Part:
    """A joint and its latch as they are beyond their play, where they are stiffest."""
    if part.kind != Hinge.kind:
        return part
    plays, curve = {name for name, _ in CLEARANCES}, ("latch_deflection", "latch_torque", "latch_straight")
    structure = part.structure
    if structure.get("latch_straight"):
        structure = {key: value for key, value in structure.items() if key not in curve} | {"latch": "spring"}
    start = {name: value for name, value in part.start.items() if name not in plays}
    return replace(part, structure=structure, start=start)


def own_growth(model: LinearModel) -> float:
    """Largest growth rate (1/s) of the motions of a linear model itself."""
    rows = model.free_rows
    inverse = np.linalg.inv(model.mass[np.ix_(rows, rows)])
    n = len(rows)
    system = np.zeros((2 * n, 2 * n))
    system[:n, n:] = np.eye(n)
    system[n:, :n] = -inverse @ model.stiffness[np.ix_(rows, rows)]
    system[n:, n:] = -inverse @ model.damping[np.ix_(rows, rows)]
    return float(np.linalg.eigvals(system).real.max())


def growth(model: LinearModel, h: float) -> float:
    """Growth rate (1/s) of the fastest growing motion under a master without iteration, of a step h (s).

    Coordinates, rates and the wrenches that bodies feel next follow from those before by a matrix, whose spectral
    radius tells.
    """
    rows = model.free_rows
    free, forced = _bodies_step(model, h)
    own_damping, own_stiffness = _of_bodies(model)
    answers = -np.hstack(
        [
            (model.stiffness - own_stiffness)[np.ix_(rows, rows)],
            (model.damping - own_damping)[np.ix_(rows, rows)],
        ]
    )
    step = np.block([[free, forced], [answers, np.zeros((len(rows), len(rows)))]])
    return float(np.log(np.abs(np.linalg.eigvals(step)).max()) / h)


def _of_bodies(model: LinearModel) -> tuple[Vector, Vector]:
    """Damping and stiffness (n, n) of the bodies' own modes."""
    own = [body.modal_matrices() for body in model.mechanism.bodies.values()]
    return scipy.linalg.block_diag(*(damping for damping, _ in own)), scipy.linalg.block_diag(
        *(stiffness for _, stiffness in own)
    )


def _bodies_step(model: LinearModel, h: float) -> tuple[Vector, Vector]:
    """Matrices (2k, 2k) and (2k, k) of a step of bodies alone: by coordinates and rates, by forces held over it."""
    rows = model.free_rows
    damping, stiffness = (matrix.diagonal()[rows] for matrix in _of_bodies(model))
    modal = stiffness > 0.0
    frequency = np.sqrt(stiffness[modal])
    p = propagator(frequency, 0.5 * damping[modal] / frequency, h)

    def diagonal(rigid: float, flexible: Vector) -> Vector:
        values = np.full(len(rows), rigid)
        values[modal] = flexible
        return np.diag(values)

    inverse = np.linalg.inv(model.mass[np.ix_(rows, rows)])
    free = np.block(
        [[diagonal(1.0, p.a11), diagonal(h, p.a12)], [diagonal(0.0, p.a21), diagonal(1.0, p.a22)]]
    )
    forced = np.vstack([diagonal(0.5 * h * h, p.b1) @ inverse, diagonal(h, p.b2) @ inverse])
    return free, forced
