"""A beam pinned at its root and free at its tip, its root held by a law: coupled steps against the exact motion.

Eight modes, the first of which turns it as a whole, exact in time under a load that is linear over a step; the law
is one scalar coordinate, the rotation of the root. Exact motion under a linear law by the eigenvectors of the whole.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from components.numerics.oscillators import propagator
from components.numerics.stiff_coordinate import MeanLoad, Memory, StepMotion

Vector = np.ndarray[tuple[int], np.dtype[np.float64]]
Matrix = np.ndarray[tuple[int, int], np.dtype[np.float64]]
Law = Callable[[StepMotion], MeanLoad]

LENGTH, LINE_MASS, BENDING = 1.5, 8.0, 6.2e3
"""m, kg/m, N.m2: elastic modes from 30 to 783 Hz."""
_ROOTS = np.array([3.926602, 7.068583, 10.210176, 13.351769, 16.493361, 19.634954, 22.776547])
"""tan x = tanh x."""


@dataclass(frozen=True)
class Beam:
    """Angular frequencies (8,) and rotations of the root (8,) of its modes, of unit modal mass."""

    frequency: Vector
    rotation: Vector

    @classmethod
    def pinned_free(cls) -> Beam:
        """Closed form: sin x + (sin L / sinh L) sinh x; rigid rotation first."""
        wave = _ROOTS / LENGTH
        ratio = np.sin(_ROOTS) / np.sinh(_ROOTS)
        x = np.linspace(0.0, LENGTH, 20_001)
        shape = np.sin(wave[:, None] * x) + ratio[:, None] * np.sinh(wave[:, None] * x)
        mass = LINE_MASS * np.trapezoid(shape**2, x, axis=1)
        slope = wave * (1.0 + ratio) / np.sqrt(mass)
        rigid = 1.0 / np.sqrt(LINE_MASS * LENGTH**3 / 3.0)
        return cls(
            np.concatenate(([0.0], wave**2 * np.sqrt(BENDING / LINE_MASS))), np.concatenate(([rigid], slope))
        )

    def held(self, stiffness: float) -> tuple[Vector, Matrix]:
        """Angular frequencies (8,) and modes (8, 8) of the beam held by a linear law."""
        matrix = np.diag(self.frequency**2) + stiffness * np.outer(self.rotation, self.rotation)
        square, vectors = np.linalg.eigh(matrix)
        return np.sqrt(square), vectors

    def start(self, stiffness: float) -> Vector:
        """Modal velocities (8,) that give the modes of the held beam a content falling with frequency."""
        w, vectors = self.held(stiffness)
        signs = np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0, -1.0, -1.0])
        return vectors @ (0.3 * signs / (1.0 + (w / 200.0) ** 2))


def exact_means(beam: Beam, stiffness: float, h: float, steps: int) -> Vector:
    """Step means of the torque on the root under a linear law, (steps,): by the eigenvectors of the held beam."""
    w, vectors = beam.held(stiffness)
    amplitude = (vectors.T @ beam.start(stiffness)) / w
    time = h * np.arange(steps + 1)
    integral = (1.0 - np.cos(w * time[:, None])) / w * amplitude * (beam.rotation @ vectors)
    return -stiffness * np.diff(integral.sum(axis=1)) / h


def energy(beam: Beam, position: Vector, velocity: Vector) -> float:
    """Of the beam alone (J)."""
    return 0.5 * float(velocity @ velocity + (beam.frequency * position) @ (beam.frequency * position))


class _Steps:
    """Exact steps h of the modes under a load on the root that is u0 + u1 P1."""

    def __init__(self, beam: Beam, h: float) -> None:
        self.rotation = beam.rotation
        elastic = propagator(beam.frequency[1:], np.zeros(len(beam.frequency) - 1), h)
        free = {"a11": 1.0, "a12": h, "a21": 0.0, "a22": 1.0, "b1": 0.5 * h * h, "b2": h}
        free |= {"c1": -h * h / 6.0, "c2": 0.0, "d": 0.0}
        self.of = {name: np.concatenate(([value], getattr(elastic, name))) for name, value in free.items()}
        self.square = beam.frequency**2

    def step(
        self, position: Vector, velocity: Vector, load: float, slope: float
    ) -> tuple[Vector, Vector, float]:
        """Position and velocity at the end, and the first moment of the root's angular velocity."""
        q, s, of = self.rotation * load, self.rotation * slope, self.of
        end = of["a11"] * position + of["a12"] * velocity + of["b1"] * q + of["c1"] * s
        rate = of["a21"] * position + of["a22"] * velocity + of["b2"] * q + of["c2"] * s
        moment = of["c1"] * (self.square * position - q) - of["c2"] * velocity + of["d"] * s
        return end, rate, float(self.rotation @ moment)


@dataclass
class Path:
    """Step means of the torque (steps,), and how far the energy of beam, law and heat strays from its start (J)."""

    means: Vector
    residual: float


def coupled(
    beam: Beam,
    velocity: Vector,
    law: Law,
    remember: Callable[[StepMotion, float], Memory],
    potential: Callable[[float], float],
    h: float,
    steps: int,
) -> Path:
    """Coupled steps: Newton on mean load and slope, with differences as derivatives."""
    modes = _Steps(beam, h)
    position = np.zeros_like(beam.frequency)
    memory = Memory(*(float(beam.rotation @ velocity),) * 2)
    wrench, means, lost, residual = np.zeros(2), [], 0.0, 0.0
    start = energy(beam, position, velocity)
    for _ in range(steps):

        def mismatch(u: Vector) -> Vector:
            found = law(_motion(beam, modes, position, velocity, memory, u, h))  # noqa: B023
            return np.array((found.force - u[0], found.slope - u[1]))

        wrench = _solved(mismatch, wrench)
        motion = _motion(beam, modes, position, velocity, memory, wrench, h)
        found = law(motion)
        position, velocity, _ = modes.step(position, velocity, wrench[0], wrench[1])
        memory = remember(motion, float(beam.rotation @ velocity))
        means.append(float(wrench[0]))
        lost += found.heat + found.numerical
        now = energy(beam, position, velocity) + potential(float(beam.rotation @ position)) + lost
        residual = max(residual, abs(now - start))
    return Path(np.array(means), residual)


def _motion(
    beam: Beam, modes: _Steps, position: Vector, velocity: Vector, memory: Memory, u: Vector, h: float
) -> StepMotion:
    end, _, moment = modes.step(position, velocity, u[0], u[1])
    return StepMotion(float(beam.rotation @ position), float(beam.rotation @ end), h, memory, moment)


def _solved(mismatch: Callable[[Vector], Vector], u: Vector) -> Vector:
    for _ in range(30):
        left = mismatch(u)
        size = 1e-3 * (1.0 + np.abs(u).max())
        slopes = [
            (mismatch(u + size * unit) - mismatch(u - size * unit)) / (2.0 * size) for unit in np.eye(2)
        ]
        change = np.linalg.solve(np.array(slopes).T, -left)
        u = u + change
        if np.abs(change).max() <= 1e-11 * (1.0 + np.abs(u).max()):
            break
    return u
