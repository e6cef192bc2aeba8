"""The agreement check of an imported model: whether its numbers fit each other, what is stated, and SI units.

Limits follow from what they guard: rigid motions may cost as much energy as shifts the first elastic frequency by
half of `_GROUNDED`, and so on.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf, isnan, nan, pi

import numpy as np
import scipy

from ..contract.component import ComponentError, Vector
from ..flexible.finite_elements import FiniteElementModel, SparseMatrix
from ..flexible.modal import ModalData, rigid_motion
from ..flexible.reduction import fixed_interface_frequencies, free_frequencies
from .data import FiniteElementData

_SYMMETRIC = 1e-6
"""Of the geometric mean of the diagonal entries: numbers with seven digits, as text files have them."""
_GROUNDED = 1e-4
"""Square of the ratio of the highest rigid to the lowest elastic frequency; shifts the latter by half of it."""
_UNEQUAL = 1e-3
"""Of the mass, between the three directions: text files are right to far less, forgotten nodes are not."""
_STATED = 0.01
"""Of mass, size or inertia, between what is stated and what is found."""
_FREE = 1e-10
"""Of the largest stiffness of its kind: what is left of zero in numbers with ten digits."""
_STRESSED = 1e-3
"""Of the largest entry of a row, in rigid motions: files have seven digits."""
_SIZES = (1e-2, 300.0)
"""m; deployable structures are longer than a hinge and shorter than a station."""
_FREQUENCIES = (1e-3, 1e5)
"""Hz, of the first elastic mode."""
_NOTHING = 1e-4
"""Hz, below which a mode is one of no stiffness."""
_DENSITIES = (1e-6, 3e4)
"""kg/m3 of the box around the nodes: osmium has 22,600, and a solar sail a thousandth."""
_SLENDER = 0.05
"""Least thickness of that box over its size, or flat and straight bodies would have no density."""
_LOOSE = (
    "a part of the model is not joined to the rest: with all attachment points held, it still moves freely"
)
_INDEFINITE = (
    "some motions have negative energy by the stiffness matrix; it is cut off, or not the stiffness of a free body at "
    "rest"
)
_DENSE = 600
"""Degrees of freedom up to which all modes at once are the soonest."""


@dataclass(frozen=True)
class Stated:
    """What is said of a model elsewhere, in SI units, about the centre of mass."""

    mass: float | None = None
    center_of_mass: tuple[float, ...] | None = None
    inertia: tuple[float, ...] | None = None
    """three diagonal entries"""


NOTHING_STATED = Stated()


@dataclass(frozen=True)
class Finding:
    """One line of the check; `problem` is empty where it is kept."""

    name: str
    found: str
    problem: str = ""


def check_symmetry(data: FiniteElementData) -> tuple[Finding, ...]:
    """Of both matrices, with positive masses; ComponentError where they are not symmetric."""
    rows = [_symmetry("stiffness", data.stiffness), _symmetry("mass", data.mass)]
    lost = int(np.sum(data.mass.diagonal() < 0.0))
    if lost:
        rows.append(
            Finding("diagonal of mass", "", f"{lost} entries of the mass matrix are negative; none can be")
        )
    return tuple(rows)


def _symmetry(name: str, matrix: SparseMatrix) -> Finding:
    size = np.sqrt(np.abs(matrix.diagonal()))
    scale = scipy.sparse.diags_array(
        1.0 / np.maximum(size, np.sqrt(_FREE) * size.max() + np.finfo(float).tiny)
    )
    difference = float(abs(scale @ (matrix - matrix.T) @ scale).max())
    problem = ""
    if difference > _SYMMETRIC:
        problem = (
            f"the {name} matrix is not symmetric: entries differ by {difference:.3g} of the diagonal; give the whole "
            "matrix, not one triangle or a part of it, and none of follower loads"
        )
    return Finding(f"symmetry of {name}", f"{difference:.2g}", problem)


def symmetric(matrix: SparseMatrix) -> SparseMatrix:
    """The symmetric part."""
    return scipy.sparse.csr_array(0.5 * (matrix + matrix.T))


def check_model(data: FiniteElementData, model: FiniteElementModel, stated: Stated) -> tuple[Finding, ...]:
    """Rigid motions, mass, units, stiffness at the points."""
    if unmet := _unmet(model):
        return (
            Finding(
                "stiffness of points", "", f"moves without stiffness: {unmet}; join the point to more nodes"
            ),
        )
    rigid = model.rigid_motions
    mass = rigid.T @ np.asarray(model.mass_matrix @ rigid)
    if not np.linalg.eigvalsh(mass)[0] > 0.0:
        return (Finding("mass", "", "the mass of rigid motions is not positive; is this the mass matrix?"),)
    if not _moves_with_energy(model):
        return (Finding("mass", "", "some motions have negative kinetic energy by the mass matrix"),)
    first = first_frequency(model)
    if isnan(first):
        return (Finding("stiffness", "", _INDEFINITE),)
    found = [*_rigid(model, mass, first), *_mass(model, mass, stated), *_units(data, model, first)]
    return (*found, *_soft_points(model), *_outputs(model), *_samples(data, mass), *_recovered(data))


def _unmet(model: FiniteElementModel) -> str:
    """Degrees of freedom of attachment points that nothing meets, such as the rotation about a flat shell's normal."""
    stiff = np.asarray(abs(model.stiffness).sum(axis=1)) > 0.0
    return ", ".join(
        f"{name} {('along', 'about')[k // 3]} {'xyz'[k % 3]}"
        for name, rows in model.attachment_dofs.items()
        for k, row in enumerate(rows)
        if not stiff[row]
    )


def _moves_with_energy(model: FiniteElementModel) -> bool:
    """Whether no motion has negative kinetic energy, of models whose modes are all looked at."""
    if model.stiffness.shape[0] > _DENSE:
        return True
    energies = scipy.linalg.eigvalsh(model.mass_matrix.toarray())
    return bool(energies[0] > -_FREE * energies[-1])


def first_frequency(model: FiniteElementModel) -> float:
    """First elastic frequency of the free body, Hz; infinite where nothing can bend, NaN where there is none."""
    try:
        hertz = free_hertz(model, 1)
    except (
        scipy.linalg.LinAlgError,
        RuntimeError,
    ):  # no factors, or no convergence: eigenvalues far below zero
        return nan
    return float(hertz[0]) if hertz.size else inf


def free_hertz(model: FiniteElementModel, count: int) -> Vector:
    """Lowest elastic frequencies of the free body, Hz, as many as there are."""
    size = model.stiffness.shape[0]
    if size > _DENSE:
        return free_frequencies(model, count) / (2.0 * pi)
    stiffness, mass = model.stiffness.toarray(), model.mass_matrix.toarray()
    shift = _regular(model)
    values = scipy.linalg.eigh(mass, stiffness + shift * mass, eigvals_only=True)[::-1]
    elastic = 1.0 / values[values > _FREE * values[0]][6 : 6 + count] - shift
    hertz: Vector = np.sqrt(np.maximum(elastic, 0.0)) / (2.0 * pi)
    return hertz


def _regular(model: FiniteElementModel) -> float:
    """A shift (rad2/s2) that makes K + shift M regular and spoils no frequency: small beside a mean eigenvalue."""
    return float(model.stiffness.diagonal().sum() / model.mass_matrix.diagonal().sum()) * 1e-4


def _rigid(model: FiniteElementModel, mass: Vector, first: float) -> Iterator[Finding]:
    """Energy of rigid motions, as the frequencies that they would have."""
    rigid = model.rigid_motions
    energy = rigid.T @ np.asarray(model.stiffness @ rigid)
    values = scipy.linalg.eigvalsh(energy, mass)
    highest = float(np.sqrt(max(np.abs(values)))) / (2.0 * pi)
    # where a part moves without stiffness both are nothing, which is told as such
    share = 0.0 if first == inf or max(first, highest) < _NOTHING else (highest / max(first, _NOTHING)) ** 2
    problem = ""
    if share > _GROUNDED:
        problem = (
            f"rigid motions cost energy: they have {highest:.3g} Hz, and the first elastic mode has "
            f"{first:.3g} Hz; the model is constrained, a part moves freely, a node has wrong coordinates, a unit is "
            "wrong, or its numbers have too few digits (seven, or single precision; write eleven)"
        )
    yield Finding("rigid motions", f"up to {highest:.2g} Hz", problem)
    yield Finding("first elastic mode, free", f"{first:.6g} Hz" if first < inf else "none")


def _mass(model: FiniteElementModel, mass: Vector, stated: Stated) -> Iterator[Finding]:
    moved = np.diag(mass)[:3]
    spread = float(np.ptp(moved) / moved.mean())
    problem = (
        f"the mass is {', '.join(f'{m:.6g}' for m in moved)} kg along x, y, z; it must be one: a node is missing, or "
        "turned" if spread > _UNEQUAL else ""
    )  # fmt: skip
    yield Finding(
        "mass", f"{model.mass:.6g} kg", problem or _differs(model.mass, stated.mass, model.mass, "kg")
    )
    size = _size(model)
    yield Finding(
        "centre of mass",
        f"{_told(model.center_of_mass)} m",
        _differs(model.center_of_mass, stated.center_of_mass, size, "m"),
    )
    diagonal = np.diag(model.inertia)
    yield Finding(
        "inertia", f"{_told(diagonal)} kg.m2", _differs(diagonal, stated.inertia, diagonal.max(), "kg.m2")
    )
    parts = np.sort(np.linalg.eigvalsh(model.inertia))
    if parts[0] + parts[1] < (1.0 - _UNEQUAL) * parts[2]:
        yield Finding(
            "principal moments",
            f"{_told(parts)} kg.m2",
            f"principal moments {_told(parts)} kg.m2 violate the triangle inequality; coordinates and mass do not fit",
        )


def _told(values: Vector) -> str:
    return ", ".join(f"{value:.6g}" for value in np.asarray(values).tolist())


def _differs(found: Vector | float, stated: object, scale: float, unit: str) -> str:
    """A sentence where what is found is not what is stated."""
    if stated is None:
        return ""
    values, meant = np.atleast_1d(found), np.atleast_1d(np.asarray(stated, dtype=float))
    if np.abs(values - meant).max() <= _STATED * scale:
        return ""
    return f"is {_told(values)} {unit}, and {_told(meant)} {unit} is stated; check the file and its units"


def _size(model: FiniteElementModel) -> float:
    places = [*model.point_positions.values(), *model.display_positions]
    return float(np.linalg.norm(np.ptp(np.array(places), axis=0)))


def _units(data: FiniteElementData, model: FiniteElementModel, first: float) -> Iterator[Finding]:
    """Whether size, density and frequency are those of a structure in SI units."""
    size = _size(model)
    sides = np.maximum(
        np.ptp(np.vstack([data.coordinates, *model.point_positions.values()]), axis=0), _SLENDER * size
    )
    density = model.mass / float(np.prod(sides)) if size else 0.0
    doubts = []
    if not _SIZES[0] <= size <= _SIZES[1]:
        doubts.append(f"it would be {size:.4g} m long")
    if _NOTHING <= first < inf and not _FREQUENCIES[0] <= first <= _FREQUENCIES[1]:
        doubts.append(f"its first mode would be at {first:.3g} Hz")
    if size and not _DENSITIES[0] <= density <= _DENSITIES[1]:
        doubts.append(f"it would have {density:.3g} kg/m3")
    problem = ""
    if doubts:
        guess = 'units = { length = "1 mm", mass = "1 t" }, or inches with { length = "25.4 mm", mass = "175.1268 kg" }'
        problem = (
            f"by the units stated (m and kg where none are) {' and '.join(doubts)}; the file is hardly in them: try "
            f"{guess}, or none"
        )
    yield Finding("size", f"{size:.4g} m, {density:.3g} kg/m3 of its box", problem)


def _soft_points(model: FiniteElementModel) -> Iterator[Finding]:
    """Attachment points that move without stiffness where all others are held."""
    if len(model.attachment_dofs) < 2:
        return
    names = list(model.attachment_dofs)
    boundary = np.concatenate([model.attachment_dofs[name] for name in names])
    interior = np.setdiff1d(np.arange(model.stiffness.shape[0]), boundary)
    held = model.stiffness[boundary][:, boundary].toarray()
    if interior.size:
        coupling = model.stiffness[interior][:, boundary].toarray()
        try:
            solved = scipy.sparse.linalg.splu(
                scipy.sparse.csc_array(model.stiffness[interior][:, interior])
            ).solve(coupling)
        except RuntimeError:
            yield Finding("held at its points", "", _LOOSE)
            return
        held = held - coupling.T @ solved
    diagonal = np.diag(held).reshape(-1, 2, 3)
    largest = diagonal.max(axis=(0, 2))[None, :, None]
    soft = np.argwhere(diagonal <= _FREE * largest)
    words = [f"{names[p]} {('along', 'about')[kind]} {'xyz'[axis]}" for p, kind, axis in soft]
    problem = f"moves without stiffness: {', '.join(words)}; join the point to more nodes" if words else ""
    yield Finding("stiffness of points", "each held by the others" if not words else "", problem)


def _outputs(model: FiniteElementModel) -> Iterator[Finding]:
    """Rows of stresses and forces: rigid motions give none."""
    if model.outputs is None:
        return
    rows, rigid = model.outputs.rows, model.rigid_motions
    size = np.abs(rows).max(axis=1, initial=np.finfo(float).tiny)[:, None] * np.abs(rigid).max(axis=0)
    share = (np.abs(rows @ rigid) / size).max(axis=1)
    worst, most = model.outputs.labels[int(np.argmax(share))], float(share.max())
    problem = ""
    if most > _STRESSED:
        problem = (
            f"{worst} is not zero in rigid motions, by {most:.2g} of its largest entry; its row does not belong to "
            "these degrees of freedom"
        )
    yield Finding("stresses and forces", f"{len(rows)} rows, {most:.1e} of them in rigid motions", problem)


def _samples(data: FiniteElementData, mass: Vector) -> Iterator[Finding]:
    """Mass samples: they have the model's mass (6, 6) and its centre, where they are and as they move rigidly.

    Not its inertia: point masses lack that of elements about themselves, which may be most of it.
    """
    if data.samples is None:
        return
    weights = np.repeat(data.samples.masses, 3)[:, None]
    placed = np.vstack([rigid_motion(at)[:3] for at in data.samples.positions])
    moved = np.asarray(data.samples.displacement @ data.rigid_motions())
    off = [_apart(motion.T @ (weights * motion), mass, data) for motion in (placed, moved)]
    problem = ""
    if max(map(max, off)) > _STATED:
        (lighter, here), (_, there) = off
        problem = (
            f"their mass differs from that of the mass matrix by {lighter:.2g} of it, and their centre by {here:.2g} "
            f"of the model's size where they are and by {there:.2g} as they move; sample_masses, sample_positions or "
            "sample_displacement do not belong to it"
        )
    yield Finding("mass samples", f"{len(data.samples.masses)}, off by {max(map(max, off)):.1e}", problem)


def _apart(one: Vector, other: Vector, data: FiniteElementData) -> tuple[float, float]:
    """How far the masses (6, 6) of rigid motions are from each other, and their centres over the model's size."""
    size = max(float(np.linalg.norm(np.ptp(data.coordinates, axis=0))), np.finfo(float).tiny)
    masses = [np.diag(matrix)[:3] for matrix in (one, other)]
    centres = [matrix[:3, 3:] / matrix[0, 0] for matrix in (one, other)]
    lighter = float(np.abs(masses[0] / masses[1] - 1.0).max())
    return lighter, float(np.abs(centres[0] - centres[1]).max()) / size


def _recovered(data: FiniteElementData) -> Iterator[Finding]:
    """Recovered nodes that move: with rigid motions they do as their places say; some have no rotations."""
    if data.recovery is None or not len(data.recovery.nodes):
        return
    moved = np.asarray(data.recovery.motion @ data.rigid_motions()).reshape(-1, 6, 6)[:, :3]
    expected = np.array([rigid_motion(at)[:3] for at in data.recovery.coordinates])
    reach = np.vstack([data.coordinates, data.recovery.coordinates])
    size = max(float(np.linalg.norm(np.ptp(reach, axis=0))), np.finfo(float).tiny)
    off = np.abs(moved - expected) / np.where(np.arange(6) < 3, 1.0, size)
    off = np.where(np.abs(moved).max(axis=(1, 2)) > 0.0, off.max(axis=(1, 2)), 0.0)  # others are held
    worst = int(np.argmax(off))
    problem = ""
    if off[worst] > _STRESSED:
        problem = (
            f"node {data.recovery.nodes[worst]} does not move with rigid motions as its place says, by "
            f"{off[worst]:.2g} of them; its coordinates or its rows are those of another"
        )
    yield Finding("recovered nodes", f"{len(off)}, off by {off.max():.1e}", problem)


def compare_frequencies(
    model: FiniteElementModel, attachment_points: tuple[str, ...], reduced: ModalData, count: int = 4
) -> tuple[Finding, ...]:
    """Free frequencies of the reduced body beside those of the full model, and the fixed-interface ones."""
    full, own = free_hertz(model, count), reduced.frequency[:count] / (2.0 * pi)
    shared = min(len(full), len(own))
    off = float(np.max(np.abs(own[:shared] / full[:shared] - 1.0), initial=0.0))
    rows = [
        Finding("free, full", f"{_told(full)} Hz"),
        Finding("free, reduced", f"{_told(own)} Hz, off by {off:.1e}"),
    ]
    interior = model.stiffness.shape[0] - 6 * len(attachment_points)
    if interior > 0:
        hertz = fixed_interface_frequencies(model, attachment_points, min(count, interior)) / (2.0 * pi)
        rows.append(Finding("fixed at its points", f"{_told(hertz)} Hz"))
    return tuple(rows)


def refuse(findings: tuple[Finding, ...]) -> None:
    """ComponentError with every problem."""
    problems = [f"{finding.name}: {finding.problem}" for finding in findings if finding.problem]
    if problems:
        raise ComponentError("; ".join(problems))
