r"""Beam for large deformation: geometrically exact, energy and momenta exact at any step.

$$ U = \frac{L}{2}\, \mathbf e^T \mathbf C\, \mathbf e,\qquad \mathbf e = (\boldsymbol\gamma -
\boldsymbol\gamma_0,\; \boldsymbol\kappa - \boldsymbol\kappa_0),\qquad \boldsymbol\gamma = \mathbf R^T
\mathbf x',\quad \boldsymbol\kappa = \operatorname{axial}\left(\mathbf R^T \mathbf R'\right) $$

of an element of the length $L$ with stretch and shear $\boldsymbol\gamma$, twist and bending $\boldsymbol\kappa$, and
the stiffness $\mathbf C$ of its section.

Two-node elements of a Simo-Reissner beam with rigid sections at the nodes (`beam_parts/elements.py`), one after the
other. A step takes each section on by a Cayley rotation, its displacement and rotation vector Th being the unknowns:

    v1 = 2 dx/h - v0     M (v1 - v0) = h f            M: consistent, rho A L/6 [2 1; 1 2] an element
    W1 = 2 Th/h - W0     R1 J W1 - R0 J W0 = h t      J: rotary inertia of the section times half the lengths

The second line is exact for a section free of torque (Simo and Wong 1991). Loads of elements are discrete gradients and
port wrenches act on the mean of the arms at both ends of a step, so that energy and both momenta are kept to the
tolerance of the iteration and to round-off. The scheme is of second order, and so are the ports: wrenches are held.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .beam_parts.banded import Factors
from .beam_parts.elements import Elements, Poses, Strains
from .beam_parts.variables import Section, observations, parameters, states
from .contract.component import Component, ComponentError, Port, Vector
from .contract.frames import (
    Quaternion,
    exponential,
    multiply,
    normalized,
    rotation_matrix,
    skew,
    sum_of_moments,
)
from .contract.mass import RigidMass
from .contract.ports import WRENCH_SIZE

_MOST_ITERATIONS = 25
_TOLERANCE = 1e-14
"""Of displacements, of the beam's length, and of rotations (rad): what the next correction would be."""
_ROUNDING, _STANDSTILL = 1e-8, 0.5
"""Corrections below it that shrink no more are round-off, which slender beams magnify."""
_FAR = 1e-2
"""Corrections above it take factors where they lead, as those of their start may lead astray."""
_CHEAPER = 14
"""Corrections like the last that must not be enough for factors to be renewed: these cost as much as five, and
corrections shrink by turns much and little, so that more are seldom needed."""
_LARGEST_TURN = 2.0
"""Rotation vector of Cayley of a turn by 90 degrees, the most a section may turn in a step."""
_IDENTITY = np.eye(3)
_UNTURNED = (1.0, 0.0, 0.0, 0.0)


@dataclass(slots=True)
class _Constants:
    gravity: Vector
    stiffness_damping: float
    start: tuple[Vector, Vector, Vector, Vector]
    bent: tuple[Vector, Vector]


class _Nodes(NamedTuple):
    """State of the n nodes: positions, quaternions, directors (n, 3, 3), velocities, rates of turn in these."""

    position: Vector
    quaternion: Vector
    directors: Vector
    velocity: Vector
    rate: Vector

    @property
    def poses(self) -> Poses:
        return Poses(self.directors, np.diff(self.position, axis=0))


class _Step(NamedTuple):
    """What a step starts from."""

    nodes: _Nodes
    strains: Strains
    wrench: Vector
    h: float
    damping: float


class _Trial(NamedTuple):
    """Where an iteration stands: travel (m) and Cayley rotation vectors of the nodes, world axes, and what follows.

    growth: of the strains, (m, 6). stress: mean over the step of what does work on these. loads: on the nodes, (n, 6).
    """

    travel: Vector
    turn: Vector
    quaternion: Vector
    poses: Poses
    strains: Strains
    growth: Vector
    stress: Vector
    loads: Vector


class Beam(Component):
    """Geometrically exact beam through nodes, straight or curved; at most 60 deg of bending per element.

    nodes: one mapping per node, from end to end, with `position` (3, m) and `orientation` (quaternion of the section,
    x along the beam), construction frame. section: the fields of `beam_parts.variables.Section`. ports: one mapping per
    port with `name`, `node` (from 0), optional `offset` (3, m, construction frame) and `orientation` (quaternion of the
    port there).
    """

    kind = "beam"
    ports_vary = True
    starts_from_inputs = False

    def __init__(
        self,
        nodes: Sequence[Mapping[str, Any]],
        section: Mapping[str, float],
        ports: Sequence[Mapping[str, Any]],
    ) -> None:
        self._section = Section.of(section)
        self._positions, self._orientations = _placed(nodes)
        count = len(self._positions)
        self._declare(
            {"nodes": [dict(n) for n in nodes], "section": dict(section), "ports": [dict(p) for p in ports]},
            ports=[Port(p["name"], "body", 2) for p in ports],
            parameters=parameters(count),
            observations=observations(count),
            states=states(count),
        )
        directors = _directors(self._orientations)
        self.elements = Elements(Poses(directors, np.diff(self._positions, axis=0)), self._section.stiffness)
        self.length = float(self.elements.lengths.sum())
        self._masses = _consistent(self._section.line_mass * self.elements.lengths)
        self._inverse_masses = np.linalg.inv(self._masses)
        self._weights = self._masses.sum(1)
        halves = 0.5 * self.elements.lengths
        self._inertia = (
            np.add(np.append(halves, 0.0), np.append(0.0, halves))[:, None] * self._section.line_inertia
        )
        self._place(ports, directors)

    def _place(self, ports: Sequence[Mapping[str, Any]], directors: Vector) -> None:
        count = len(self._positions)
        self._at = np.zeros(len(ports), dtype=np.int64)
        self._arms, self._turns = np.zeros((len(ports), 3)), np.zeros((len(ports), 4))
        for k, port in enumerate(ports):
            node, whose = port.get("node"), f"port {port.get('name')}"
            if isinstance(node, bool) or not (isinstance(node, int) and 0 <= node < count):
                raise ComponentError(f"{whose}: there is no node {node!r}; nodes are 0 to {count - 1}")
            w, x, y, z = self._orientations[node].tolist()
            self._at[k] = node
            self._arms[k] = _numbers(port, whose, "offset", 3, (0.0, 0.0, 0.0)) @ directors[node]
            self._turns[k] = normalized(multiply((w, -x, -y, -z), _quaternion(port, whose)))

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        self.check_ranges(p)
        at = self.parameter_layout
        orientation = p[at["initial_orientation"]]
        if abs(np.linalg.norm(orientation) - 1.0) > 1e-6:
            raise ComponentError(
                f"initial_orientation has length {np.linalg.norm(orientation):g}; a quaternion must have length 1"
            )
        starts = ("initial_position", "initial_orientation", "initial_velocity", "initial_angular_velocity")
        position, turn, velocity, rate = (p[at[name]].copy() for name in starts)
        return _Constants(
            gravity=p[at["gravity"]].copy(),
            stiffness_damping=float(p[at["stiffness_damping"]][0]),
            start=(position, turn, velocity, rate),
            bent=(p[at["initial_displacement"]].reshape(-1, 3), p[at["initial_rotation"]].reshape(-1, 3)),
        )

    def initial(self, c: _Constants, u: Vector) -> Vector:
        """Placed, bent and moving like a rigid body as the initial parameters say."""
        position, orientation, velocity, rate = c.start
        displacements, rotations = c.bent
        q = normalized(tuple(orientation.tolist()))
        positions = position + (self._positions + displacements) @ rotation_matrix(q).T
        turned = [
            multiply(exponential(tuple(turn)), tuple(own))
            for turn, own in zip(rotations.tolist(), self._orientations.tolist(), strict=True)
        ]
        quaternions = np.array([normalized(multiply(q, own)) for own in turned])
        center = self._weights @ positions / self._weights.sum()
        velocities = velocity + (positions - center) @ skew(rate).T
        rates = np.einsum("nji,j->ni", _directors(quaternions), rate)
        return self._state(0.0, positions, quaternions, velocities, rates)

    @staticmethod
    def _state(heat: float, *nodes: Vector) -> Vector:
        return np.concatenate(((heat,), *(values.ravel() for values in nodes)))

    def _nodes(self, x: Vector) -> _Nodes:
        n, at = len(self._positions), self.state_layout
        quaternion = x[at["orientation"]].reshape(n, 4)
        position, velocity, rate = (
            x[at[name]].reshape(n, 3) for name in ("position", "velocity", "angular_velocity")
        )
        return _Nodes(position, quaternion, _directors(quaternion), velocity, rate)

    def step(self, c: _Constants, x: Vector, u: Vector, h: float) -> Vector:
        """One step under held wrenches in world axes."""
        # the absurd wrenches an iteration may try end as a refusal, without a warning
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            n = self._nodes(x)
            damping = c.stiffness_damping / h
            start = _Step(n, self.elements.strains(n.poses), u.reshape(-1, WRENCH_SIZE), h, damping)
            trial = self._iterated(c, start)
        position = n.position + trial.travel
        velocity = n.velocity + h * (self._inverse_masses @ trial.loads[:, :3])
        spin = np.einsum("nij,nj->ni", n.directors, self._inertia * n.rate) + h * trial.loads[:, 3:]
        rate = np.einsum("nji,nj->ni", trial.poses.directors, spin) / self._inertia
        squares = (self.elements.stiffness * trial.growth**2).sum(1)
        heat = x[0] + damping * float(self.elements.lengths @ squares)
        return self._state(heat, position, trial.quaternion, velocity, rate)

    def _iterated(self, c: _Constants, start: _Step) -> _Trial:
        """Newton's iteration from uniform motion, with factors kept while they serve."""
        nodes = start.nodes
        travel = start.h * nodes.velocity
        turn = start.h * np.einsum("nij,nj->ni", nodes.directors, nodes.rate)
        factors, before, done = None, np.inf, False
        for iteration in range(_MOST_ITERATIONS):
            trial = self._trial(c, start, travel, turn)
            if done:
                return trial
            if factors is None:
                # the first follow from the start and the step's size alone, so that the kernel can keep them
                factors = self._factors(start, trial, with_ports=iteration > 0)
            correction = factors.solve(-self._residual(start, trial))
            travel = travel + correction[:, :3]
            turn = turn + np.einsum("nij,nj->ni", _cayley_rates(turn), correction[:, 3:])
            change = max(
                float(abs(correction[:, :3]).max()) / self.length, float(abs(correction[:, 3:]).max())
            )
            shrinks = change / before if before < np.inf else 1.0
            done = change * min(shrinks, 1.0) <= _TOLERANCE or (
                change <= _ROUNDING and shrinks > _STANDSTILL and before < np.inf
            )
            if change > _FAR or (change * shrinks**_CHEAPER > _TOLERANCE and before < np.inf):
                factors = None
            before = change
        raise ComponentError(
            f"a step of {start.h:g} s finds no end in {_MOST_ITERATIONS} iterations; take smaller steps or loads"
        )

    def _trial(self, c: _Constants, start: _Step, travel: Vector, turn: Vector) -> _Trial:
        """Poses and loads after a travel and a turn of the nodes."""
        # written so that what is not a number is refused as well
        if not np.max((turn * turn).sum(1)) <= _LARGEST_TURN**2:
            raise ComponentError("a section turns by more than 90 deg in one step; take smaller steps")
        nodes = start.nodes
        quaternion = _turned(nodes.quaternion, turn)
        spans = np.diff(nodes.position, axis=0) + np.diff(travel, axis=0)
        poses = Poses(_directors(quaternion), spans)
        strains = self.elements.strains(poses)
        old, before = nodes.poses, start.strains
        mean = old.mean(poses)
        growth = self.elements.grown(before, strains, self.elements.changes(mean, travel, turn))
        stress = self.elements.stresses(before, strains, start.damping * growth)
        arms = self._world_arms(0.5 * (old.directors + poses.directors))
        loads = self._on_nodes(c, self.elements.loads(mean, stress), arms, start.wrench)
        return _Trial(travel, turn, quaternion, poses, strains, growth, stress, loads)

    def _on_nodes(self, c: _Constants, pairs: Vector, arms: Vector, wrenches: Vector) -> Vector:
        """Loads (n, 6) of elements (m, 12), weight, and wrenches (ports, 6) at arms (ports, 3)."""
        loads = np.zeros((len(pairs) + 1, 6))
        loads[:-1] += pairs[:, :6]
        loads[1:] += pairs[:, 6:]
        loads[:, :3] += self._weights[:, None] * c.gravity
        force = wrenches[:, :3]
        np.add.at(loads, self._at, np.hstack((force, _cross(arms, force) + wrenches[:, 3:])))
        return loads

    def _world_arms(self, directors: Vector) -> Vector:
        """Arms (ports, 3) of the ports, world axes."""
        found: Vector = np.einsum("kij,kj->ki", directors[self._at], self._arms)
        return found

    def _residual(self, start: _Step, trial: _Trial) -> Vector:
        """What loads are missing of the changes of momenta over the step, (n, 6)."""
        n, h = start.nodes, start.h
        gain = np.empty_like(trial.loads)
        turn = np.einsum("nji,nj->ni", n.directors, trial.turn)
        gain[:, :3] = self._masses @ (2.0 * trial.travel / h - 2.0 * n.velocity) / h
        spin = np.einsum("nij,nj->ni", trial.poses.directors, self._inertia * (2.0 * turn / h - n.rate))
        gain[:, 3:] = (spin - np.einsum("nij,nj->ni", n.directors, self._inertia * n.rate)) / h
        result: Vector = gain - trial.loads
        return result

    def _factors(self, start: _Step, trial: _Trial, with_ports: bool) -> Factors:
        """Factors of the derivative of the residual by displacements and rotation vectors at the end of the step.

        with_ports: whether the arms of the ports' forces turn as well.
        """
        viscous = start.damping * trial.growth
        stiffness = self.elements.stiffnesses(start.strains, trial.strains, start.damping, viscous)
        pairs = -self.elements.tangent(start.nodes.poses, trial.poses, trial.stress, stiffness)
        nodes = np.zeros((len(trial.turn), 6, 6))
        self._add_inertia(nodes, pairs, start, trial)
        if not with_ports:
            return Factors(nodes, pairs)
        np.add.at(
            nodes[:, 3:, 3:], self._at, -0.5 * self._turning(trial.poses.directors, start.wrench[:, :3])
        )
        return Factors(nodes, pairs)

    def _turning(self, directors: Vector, force: Vector) -> Vector:
        """Derivatives (ports, 3, 3) of moments of the ports' forces (ports, 3) by rotations of their nodes."""
        arms = self._world_arms(directors)
        found: Vector = (
            arms[:, :, None] * force[:, None, :] - (arms * force).sum(1)[:, None, None] * _IDENTITY
        )
        return found

    def _add_inertia(self, nodes: Vector, pairs: Vector, start: _Step, trial: _Trial) -> None:
        h = start.h
        share = 2.0 / h**2
        element = share * self._section.line_mass * self.elements.lengths / 6.0
        for row in (0, 6):
            for column in (0, 6):
                weight = element * (2.0 if row == column else 1.0)
                pairs[:, row : row + 3, column : column + 3] += weight[:, None, None] * _IDENTITY
        end = trial.poses.directors
        inertia = (end * self._inertia[:, None, :]) @ start.nodes.directors.swapaxes(1, 2)
        nodes[:, 3:, 3:] = share * inertia @ _cayley_rates(trial.turn)
        turn = np.einsum("nji,nj->ni", start.nodes.directors, trial.turn)
        rate = 2.0 * turn / h - start.nodes.rate
        nodes[:, 3:, 3:] -= skew(np.einsum("nij,nj->ni", end, self._inertia * rate)) / h

    def loads_at_rest(self, c: _Constants, x: Vector, wrenches: Vector) -> Vector:
        """Forces and moments (n, 6) on the nodes of elements, weight and wrenches (ports, 6), world axes."""
        poses = self._nodes(x).poses
        strains = self.elements.strains(poses)
        pairs = self.elements.loads(
            poses, self.elements.stresses(strains, strains, 0.0 * self.elements.excess(strains))
        )
        return self._on_nodes(c, pairs, self._world_arms(poses.directors), wrenches)

    def stiffness_at_rest(self, x: Vector, wrenches: Vector) -> Vector:
        """Minus their derivatives (6 n, 6 n) by displacements and rotation vectors of the nodes, world axes."""
        poses = self._nodes(x).poses
        strains = self.elements.strains(poses)
        none = 0.0 * self.elements.excess(strains)
        stress = self.elements.stresses(strains, strains, none)
        stiffness = self.elements.stiffnesses(strains, strains, 0.0, none)
        # poses are those of the end and of the start, so that they count twice
        pairs = -2.0 * self.elements.tangent(poses, poses, stress, stiffness)
        count = len(self._positions)
        found = np.zeros((count, 6, count, 6))
        for m, pair in enumerate(pairs.reshape(-1, 2, 6, 2, 6)):
            found[m : m + 2, :, m : m + 2] += pair
        for node, turned in zip(self._at, self._turning(poses.directors, wrenches[:, :3]), strict=True):
            found[node, 3:, node, 3:] -= turned
        return found.reshape(6 * count, 6 * count)

    def mass_at_rest(self, x: Vector) -> Vector:
        """Mass matrix (6 n, 6 n) by the same."""
        directors, count = self._nodes(x).directors, len(self._positions)
        found = np.zeros((count, 6, count, 6))
        found[:, :3, :, :3] = np.einsum("mn,ij->minj", self._masses, _IDENTITY)
        turning = (directors * self._inertia[:, None, :]) @ directors.swapaxes(1, 2)
        for node in range(count):
            found[node, 3:, node, 3:] = turning[node]
        return found.reshape(6 * count, 6 * count)

    def motion_of_port(self, x: Vector, port: int) -> Vector:
        """Motion (6, 6 n) of a port by the same."""
        found = np.zeros((6, 6 * len(self._positions)))
        own = found[:, 6 * self._at[port] :][:, :6]
        own[:] = np.eye(6)
        own[:3, 3:] = -skew(self._world_arms(self._nodes(x).directors)[port])
        return found

    def outputs(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Pose and velocity of every port, world axes."""
        nodes, at = self._nodes(x), self._at
        y = np.empty((len(at), 13))
        arms = self._world_arms(nodes.directors)
        rates = np.einsum("nij,nj->ni", nodes.directors, nodes.rate)[at]
        y[:, 0:3] = nodes.position[at] + arms
        for k, node in enumerate(at.tolist()):
            y[k, 3:7] = multiply(tuple(nodes.quaternion[node].tolist()), tuple(self._turns[k].tolist()))
        y[:, 7:10] = nodes.velocity[at] + _cross(rates, arms)
        y[:, 10:13] = rates
        return y.ravel()

    def observe(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Momenta, energies, positions of the nodes, resultants and orientations of the sections."""
        nodes = self._nodes(x)
        strains = self.elements.strains(nodes.poses)
        momentum = self._masses @ nodes.velocity
        spin = np.einsum("nij,nj->i", nodes.directors, self._inertia * nodes.rate)
        kinetic = 0.5 * float((momentum * nodes.velocity).sum() + (self._inertia * nodes.rate**2).sum())
        potential = self.elements.energy(strains) - float(self._weights @ nodes.position @ c.gravity)
        resultants = self.elements.resultants(strains)
        return np.concatenate(
            (
                momentum.sum(0),
                spin + sum_of_moments(nodes.position, momentum),
                (kinetic, potential, x[0]),
                nodes.position.ravel(),
                resultants[:, :3].ravel(),
                resultants[:, 3:].ravel(),
                nodes.quaternion.ravel(),
            )
        )

    def masses(self) -> list[RigidMass]:
        """Sections at the nodes, and the consistent mass of elements: by Simpson's rule 1/6, 4/6 and 1/6 along each."""
        position, orientation = (
            self.observation_layout[f"node_{name}"].start for name in ("position", "orientation")
        )
        sixth = self._section.line_mass * self.elements.lengths / 6.0
        ends = np.append(sixth, 0.0) + np.append(0.0, sixth)
        center, none = np.zeros(3), np.zeros((3, 3))
        found = []
        for k, (mass, inertia) in enumerate(zip(ends.tolist(), self._inertia, strict=True)):
            at, turned = position + 3 * k, orientation + 4 * k
            found.append(RigidMass(mass, center, np.diag(inertia), (at, at), turned))
            if k < len(sixth):
                found.append(RigidMass(4.0 * float(sixth[k]), center, none, (at, at + 3), turned))
        return found

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Arrays that `fmus/native/kernels/beam.c` reads."""
        return {
            "lengths": self.elements.lengths,
            "rest": self.elements.rest,
            "stiffness": self.elements.stiffness,
            "line_mass": self._section.line_mass,
            "inertia": self._inertia,
            "positions": self._positions,
            "orientations": self._orientations,
            "port_nodes": self._at,
            "port_arms": self._arms,
            "port_turns": self._turns,
        }

    @classmethod
    def example(cls) -> Beam:
        """A curved beam of four elements with ports at both ends and, on an arm, in the middle."""
        angles = np.linspace(0.0, 0.4, 5)
        nodes = [
            {
                "position": (float(np.sin(a)), float(1.0 - np.cos(a)), 0.0),
                "orientation": (float(np.cos(0.5 * a)), 0.0, 0.0, float(np.sin(0.5 * a))),
            }
            for a in angles
        ]
        section = Section(4e3, 2e3, 2.4e3, 40.0, 60.0, 90.0, 15.0, 0.1, 0.05, 0.06)
        ports = [
            {"name": "first", "node": 0},
            {"name": "middle", "node": 2, "offset": (0.0, 0.05, 0.02), "orientation": (0.8, 0.0, 0.6, 0.0)},
            {"name": "last", "node": 4},
        ]
        return cls(nodes, section._asdict(), ports)


def _placed(nodes: Sequence[Mapping[str, Any]]) -> tuple[Vector, Vector]:
    """Positions (n, 3) and unit quaternions (n, 4) of the nodes; ComponentError where they make no beam."""
    if len(nodes) < 2:
        raise ComponentError(f"a beam needs two nodes or more, not {len(nodes)}")
    positions = np.array([_numbers(node, f"node {k}", "position", 3) for k, node in enumerate(nodes)])
    turns = [_quaternion(node, f"node {k}") for k, node in enumerate(nodes)]
    spans = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    # written so that what is not a number is found as well
    if not spans.min() > 0.0:
        raise ComponentError(
            f"nodes {int(np.argmin(spans))} and {int(np.argmin(spans)) + 1} lie at one place"
        )
    return positions, np.array(turns)


def _numbers(
    table: Mapping[str, Any], whose: str, key: str, count: int, default: Sequence[float] | None = None
) -> Vector:
    """So many numbers of a table; ComponentError where they are not."""
    given = table.get(key, default)
    try:
        found = np.asarray(given, dtype=float) if given is not None else np.zeros(0)
    except (TypeError, ValueError):
        found = np.zeros(0)
    if found.shape != (count,) or not np.isfinite(found).all():
        raise ComponentError(f"{whose}: {key} is {given!r}; give {count} numbers")
    return found


def _quaternion(table: Mapping[str, Any], whose: str) -> Quaternion:
    """The unit quaternion of a table's orientation."""
    w, x, y, z = _numbers(table, whose, "orientation", 4, _UNTURNED).tolist()
    if not any((w, x, y, z)):
        raise ComponentError(f"{whose}: orientation is zero; a quaternion has length 1")
    return normalized((w, x, y, z))


def _consistent(masses: Vector) -> Vector:
    """Mass matrix (n, n) of elements in a row."""
    n = len(masses) + 1
    found = np.zeros((n, n))
    first = np.arange(n - 1)
    for row in (0, 1):
        for column in (0, 1):
            found[first + row, first + column] += masses / (3.0 if row == column else 6.0)
    return found


def _directors(quaternions: Vector) -> Vector:
    """Rotation matrices (n, 3, 3) of unit quaternions (n, 4)."""
    scalar, cross = quaternions[:, 0, None, None], skew(quaternions[:, 1:])
    found: Vector = _IDENTITY + 2.0 * (scalar * cross + cross @ cross)
    return found


def _turned(quaternions: Vector, turn: Vector) -> Vector:
    """Unit quaternions (n, 4) turned by Cayley's rotation vectors (n, 3), world axes."""
    scale = 1.0 / np.sqrt(1.0 + 0.25 * (turn * turn).sum(1))
    w, vector, half = quaternions[:, 0], quaternions[:, 1:], 0.5 * turn
    found = np.empty_like(quaternions)
    found[:, 0] = scale * (w - (half * vector).sum(1))
    found[:, 1:] = scale[:, None] * (vector + w[:, None] * half + _cross(half, vector))
    found /= np.sqrt((found * found).sum(1))[:, None]
    return found


def _cross(a: Vector, b: Vector) -> Vector:
    """Vector products (n, 3) row by row."""
    found: Vector = (skew(a) @ b[:, :, None])[:, :, 0]
    return found


def _cayley_rates(turn: Vector) -> Vector:
    """Derivatives (n, 3, 3) of Cayley's rotation vectors by rotation vectors of the end, world axes."""
    found: Vector = _IDENTITY - 0.5 * skew(turn) + 0.25 * turn[:, :, None] * turn[:, None, :]
    return found
