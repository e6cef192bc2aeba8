"""A finite-element model as other programs give it: matrices, nodes, and which degree of freedom is whose."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from ..contract.component import ComponentError, Vector
from ..flexible.finite_elements import OutputRows, SparseMatrix
from ..flexible.modal import rigid_motion

Integers = NDArray[np.int64]
AMPLITUDE = 0
"""In place of a component from 1 to 6: the degree of freedom is the amplitude of a mode."""
INTERNAL = -1
"""In place of a component: an amplitude inside of an element, which has no share in rigid motions."""
OUTPUT_UNITS = {"Pa": -1, "N": 1, "N.m": 2, "N/m": 0}
"""Units of outputs, with the power of length in each; all have one of mass and -2 of time."""


@dataclass(frozen=True)
class MassSamples:
    """Point masses whose motion stands for that of all mass, from which inertia follows the deformation."""

    masses: Vector
    """(Q,)"""
    positions: Vector
    """(Q, 3)"""
    displacement: SparseMatrix
    """(3 Q, n) row 3 q + axis"""


@dataclass(frozen=True)
class Recovery:
    """Motion of nodes that are no degrees of freedom of a reduced model."""

    nodes: Integers
    """(R,) numbers"""
    coordinates: Vector
    """(R, 3)"""
    motion: SparseMatrix
    """(6 R, n) translations and rotations, basic axes"""


@dataclass(frozen=True)
class NodeTable:
    """Nodes with their places and the axes of their displacements."""

    nodes: Integers
    """(N,) numbers"""
    coordinates: Vector
    """(N, 3) basic axes"""
    axes: Vector
    """(N, 3, 3), or empty, as in `FiniteElementData`"""

    def of(self, used: Integers) -> NodeTable:
        """Those of some numbers that there are."""
        kept = np.isin(self.nodes, used)
        return NodeTable(
            self.nodes[kept], self.coordinates[kept], self.axes[kept] if len(self.axes) else self.axes
        )


@dataclass(frozen=True)
class FiniteElementData:
    """Matrices of n degrees of freedom and their nodes, in consistent units; basic axes unless `axes` says other."""

    stiffness: SparseMatrix
    """(n, n)"""
    mass: SparseMatrix
    """(n, n)"""
    nodes: Integers
    """(N,) numbers"""
    coordinates: Vector
    """(N, 3)"""
    dofs: Integers
    """(n, 2) node and component 1 to 6, or any number and 0 for the amplitude of a mode or `INTERNAL`"""
    samples: MassSamples | None = None
    recovery: Recovery | None = None
    outputs: OutputRows | None = None
    axes: Vector = field(default_factory=lambda: np.zeros((0, 3, 3)))
    """(N, 3, 3) displacement axes of the nodes as rows; empty where all are the basic ones"""
    members: Mapping[int, tuple[int, ...]] = field(default_factory=dict)
    """nodes that stand for one of another number, whose place is their mean"""

    @property
    def ready(self) -> bool:
        """Whether it is reduced: some degrees of freedom are amplitudes of modes."""
        return bool(np.any(self.dofs[:, 1] == AMPLITUDE))

    @property
    def amplitudes(self) -> int:
        """How many degrees of freedom are amplitudes of modes."""
        return int(np.sum(self.dofs[:, 1] == AMPLITUDE))

    def place(self, node: int) -> int:
        """Where a node is among the nodes; ComponentError where there is none."""
        found = np.flatnonzero(self.nodes == node)
        if found.size == 0:
            raise ComponentError(f"there is no node {node}; {told_nodes(self.nodes)}")
        return int(found[0])

    def parts(self, node: int) -> tuple[int, ...]:
        """The nodes that stand for a node: itself, or its members."""
        return self.members.get(node, (node,))

    def position(self, node: int) -> Vector:
        """(3,) the mean of its parts; ComponentError where there is none."""
        mean: Vector = self.coordinates[[self.place(part) for part in self.parts(node)]].mean(axis=0)
        return mean

    def dofs_of(self, node: int) -> dict[int, int]:
        """Degree of freedom by component of a node."""
        rows = np.flatnonzero((self.dofs[:, 0] == node) & (self.dofs[:, 1] > AMPLITUDE))
        return {int(self.dofs[row, 1]): int(row) for row in rows}

    def rigid_motions(self) -> Vector:
        """Values (n, 6) of the degrees of freedom under unit translations and rotations about the origin."""
        moving = np.flatnonzero(self.dofs[:, 1] > AMPLITUDE)
        motions = np.zeros((len(self.dofs), 6))
        index = {int(node): k for k, node in enumerate(self.nodes)}
        for row in moving:
            node, component = self.dofs[row]
            motions[row] = rigid_motion(self.coordinates[index[int(node)]])[component - 1]
        return motions


def told_nodes(nodes: Integers) -> str:
    """Which nodes there are, in few words."""
    if len(nodes) <= 12:
        return f"nodes are {', '.join(map(str, nodes))}"
    return f"there are {len(nodes)} nodes from {nodes.min()} to {nodes.max()}"


def checked(data: FiniteElementData) -> FiniteElementData:
    """The data in basic axes with symmetric matrices; ComponentError where its parts do not fit each other."""
    count = data.stiffness.shape[0]
    for name, matrix in (("stiffness", data.stiffness), ("mass", data.mass)):
        if matrix.shape != (count, count):
            raise ComponentError(f"the {name} matrix is {_size(matrix.shape)}; it must be {count} x {count}")
        _finite(name, matrix.data)
    if data.dofs.shape != (count, 2):
        raise ComponentError(
            f"{len(data.dofs)} degrees of freedom are listed, and the matrices have {count} rows; give node and "
            "component of every row"
        )
    if data.coordinates.shape != (len(data.nodes), 3):
        raise ComponentError(f"{len(data.nodes)} nodes have coordinates of {_size(data.coordinates.shape)}")
    _finite("coordinates", data.coordinates)
    _once(data)
    _parts_fit(data, count)
    return replace(_in_basic_axes(data), axes=np.zeros((0, 3, 3)))


def _size(shape: Sequence[int]) -> str:
    return " x ".join(map(str, shape))


def _finite(name: str, values: Vector) -> None:
    with np.errstate(over="ignore"):
        wrong = int(np.sum(~np.isfinite(np.square(values))))
    if wrong:
        raise ComponentError(
            f"{name}: {wrong} values are not finite, or too large to compute with; the file is damaged, or its "
            "program failed"
        )


def _once(data: FiniteElementData) -> None:
    """Every node is there, and neither a node nor a degree of freedom twice."""
    if len(np.unique(data.nodes)) < len(data.nodes):
        raise ComponentError("a node has coordinates twice; give every node once")
    moving = data.dofs[~np.isin(data.dofs[:, 1], (AMPLITUDE, INTERNAL))]
    lost = np.setdiff1d(moving[:, 0], data.nodes)
    if lost.size:
        raise ComponentError(
            f"{lost.size} nodes of the matrices have no coordinates, the first is {lost[0]}; {told_nodes(data.nodes)}"
        )
    if moving.size and (moving[:, 1].min() < 1 or moving[:, 1].max() > 6):
        raise ComponentError("a component is not from 1 to 6 (0 for amplitudes of modes)")
    if len(np.unique(moving, axis=0)) < len(moving):
        raise ComponentError("a degree of freedom is listed twice; every row of the matrices has its own")


def _parts_fit(data: FiniteElementData, count: int) -> None:
    """What comes along has the columns of the matrices."""
    if (samples := data.samples) is not None:
        number = len(samples.masses)
        if samples.positions.shape != (number, 3) or samples.displacement.shape != (3 * number, count):
            raise ComponentError(
                f"{number} mass samples need positions of {number} x 3 and displacements of {3 * number} x {count}; "
                f"there are {_size(samples.positions.shape)} and {_size(samples.displacement.shape)}"
            )
        _finite("mass samples", np.concatenate([samples.masses, samples.positions.ravel()]))
        _finite("displacements of mass samples", samples.displacement.data)
    if (recovery := data.recovery) is not None:
        number = len(recovery.nodes)
        if recovery.coordinates.shape != (number, 3) or recovery.motion.shape != (6 * number, count):
            raise ComponentError(
                f"{number} recovered nodes need rows of {6 * number} x {count}; "
                f"there are {_size(recovery.motion.shape)}"
            )
        _finite("recovered motion", recovery.motion.data)
    if (outputs := data.outputs) is not None:
        number = len(outputs.labels)
        if outputs.rows.shape != (number, count):
            raise ComponentError(
                f"{number} stresses and forces need rows of {number} x {count}; there are {_size(outputs.rows.shape)}"
            )
        _finite("rows of stresses and forces", outputs.rows)


def without_empty(data: FiniteElementData, points: Collection[int]) -> FiniteElementData:
    """The data without degrees of freedom that have neither stiffness nor mass, but for those of points (nodes).

    Amplitudes that no mode was found for, rotations about the normal of flat shells, nodes that nothing meets.
    """
    size: Vector = abs(data.stiffness).sum(axis=1) + abs(data.mass).sum(axis=1)
    of_point = np.isin(data.dofs[:, 0], list(points)) & (data.dofs[:, 1] > AMPLITUDE)
    kept = np.flatnonzero((size > 0.0) | of_point)
    if len(kept) == len(data.dofs):
        return data
    return transformed(data, scipy.sparse.eye_array(len(data.dofs), format="csr")[:, kept], data.dofs[kept])


def _in_basic_axes(data: FiniteElementData) -> FiniteElementData:
    """The same with all displacements in basic axes."""
    if not len(data.axes):
        return data
    turn = scipy.sparse.lil_array((len(data.dofs), len(data.dofs)))
    turn.setdiag(1.0)
    for node, axes in zip(data.nodes, data.axes, strict=True):
        if np.array_equal(axes, np.eye(3)):
            continue
        own = data.dofs_of(int(node))
        for first in (1, 4):
            rows = np.array([own[first + k] for k in range(3) if first + k in own], dtype=np.int64)
            if rows.size in (1, 2):
                raise ComponentError(
                    f"node {node} has axes of its own and not all its components; keep all six"
                )
            turn[rows[:, None], rows] = axes[: rows.size]  # local = axes @ basic
    return transformed(data, scipy.sparse.csr_array(turn), data.dofs)


def transformed(data: FiniteElementData, change: SparseMatrix, dofs: Integers) -> FiniteElementData:
    """The data on other degrees of freedom (n', 2), old ones being `change` (n, n') times the new ones."""
    samples, recovery, outputs = data.samples, data.recovery, data.outputs
    return replace(
        data,
        stiffness=scipy.sparse.csr_array(change.T @ data.stiffness @ change),
        mass=scipy.sparse.csr_array(change.T @ data.mass @ change),
        dofs=dofs,
        samples=samples
        and replace(samples, displacement=scipy.sparse.csr_array(samples.displacement @ change)),
        recovery=recovery and replace(recovery, motion=scipy.sparse.csr_array(recovery.motion @ change)),
        outputs=outputs and replace(outputs, rows=np.asarray(outputs.rows @ change)),
    )


def in_si(data: FiniteElementData, length: float, mass: float) -> FiniteElementData:
    """The data with its unit of length (m) and of mass (kg) taken out; seconds stay, amplitudes turn like lengths."""
    if length == mass == 1.0:
        return data
    turning = data.dofs[:, 1] >= 4
    change = scipy.sparse.csr_array(scipy.sparse.diags_array(np.where(turning, 1.0, 1.0 / length)))
    found = transformed(data, change, data.dofs)
    energy = mass * length**2
    samples, recovery = found.samples, found.recovery
    return replace(
        found,
        stiffness=energy * found.stiffness,
        mass=energy * found.mass,
        coordinates=length * found.coordinates,
        samples=samples
        and MassSamples(mass * samples.masses, length * samples.positions, length * samples.displacement),
        recovery=recovery
        and replace(
            recovery,
            coordinates=length * recovery.coordinates,
            motion=scipy.sparse.csr_array(
                scipy.sparse.diags_array(np.tile([length] * 3 + [1.0] * 3, len(recovery.nodes)))
                @ recovery.motion
            ),
        ),
        outputs=found.outputs and _outputs_in_si(found.outputs, length, mass),
    )


def _outputs_in_si(outputs: OutputRows, length: float, mass: float) -> OutputRows:
    factors = mass * np.array([length ** OUTPUT_UNITS[unit] for unit in outputs.units])
    return replace(outputs, rows=factors[:, None] * outputs.rows)
