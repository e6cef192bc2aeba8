"""A beam pinned at its root and free at its tip, its root held by a law: coupled steps against the exact motion.

Eight modes, the first of which turns it as a whole, exact in time under a load that is linear over a step; the law
is one scalar coordinate, the rotation of the root. Exact motion under a linear law by the eigenvectors of the whole,
under any other by an explicit method of order eight.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from components.numerics.laws import Law
from components.numerics.oscillators import propagator
from components.numerics.stiff_coordinate import MeanLoad, Memory, StepMotion

Vector = np.ndarray[tuple[int], np.dtype[np.float64]]
Matrix = np.ndarray[tuple[int, int], np.dtype[np.float64]]
StepLaw = Callable[[StepMotion], MeanLoad]

LENGTH, LINE_MASS, BENDING = 1.5, 8.0, 3642.0
"""m, kg/m, N.m2: bending stiffness such that eight modes reach 783 Hz, as in the design's table; the first bends at
23.3 Hz."""
_ROOTS = np.array([3.926602, 7.068583, 10.210176, 13.351769, 16.493361, 19.634954, 22.776547])
"""tan x = tanh x."""
_BEYOND = 2.0 * np.pi * 1e3
_ITERATIONS, _AGREED = 20, 1e-12
_DIFFERENCE, _LEAST_DIFFERENCE = 1e-6, 1e-14


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
        """Modal velocities (8,) that give the modes of the held beam a content falling with frequency.

        None for the mode in which a joint stiffer than the beam swings on its own, beyond those of the beam.
        """
        w, vectors = self.held(stiffness)
        signs = np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0, -1.0, -1.0])
        return vectors @ np.where(w < _BEYOND, 0.3 * signs / (1.0 + (w / 200.0) ** 2), 0.0)


def exact_means(beam: Beam, stiffness: float, h: float, steps: int) -> Vector:
    """Step means of the torque on the root under a linear law, (steps,): by the eigenvectors of the held beam."""
    w, vectors = beam.held(stiffness)
    amplitude = (vectors.T @ beam.start(stiffness)) / w
    time = h * np.arange(steps + 1)
    integral = (1.0 - np.cos(w * time[:, None])) / w * amplitude * (beam.rotation @ vectors)
    means: Vector = -stiffness * np.diff(integral.sum(axis=1)) / h
    return means


def integrated_means(beam: Beam, velocity: Vector, law: Law, h: float, steps: int) -> Vector:
    """The same under any law: from the impulse of the torque, integrated with the motion (DOP853)."""
    count = len(beam.frequency)

    def rates(_: float, y: Vector) -> Vector:
        load = law.value(float(beam.rotation @ y[:count]))
        turned = beam.rotation * load - beam.frequency**2 * y[:count]
        return np.concatenate((y[count:-1], turned, (load,)))

    found = solve_ivp(
        rates,
        (0.0, h * steps),
        np.concatenate((np.zeros(count), velocity, (0.0,))),
        "DOP853",
        h * np.arange(steps + 1),
        rtol=1e-12,
        atol=1e-12,
    )
    means: Vector = np.diff(found.y[-1]) / h
    return means


def energy(beam: Beam, position: Vector, velocity: Vector) -> float:
    """Of the beam alone (J)."""
    return 0.5 * float(velocity @ velocity + (beam.frequency * position) @ (beam.frequency * position))


class _Steps:
    """Exact steps h of the modes under a load on the root that is u0 + u1 P1."""

    def __init__(self, beam: Beam, h: float) -> None:
        elastic = propagator(beam.frequency[1:], np.zeros(len(beam.frequency) - 1), h)
        free = {"a11": 1.0, "a12": h, "a21": 0.0, "a22": 1.0, "b1": 0.5 * h * h, "b2": h}
        free |= {"c1": -h * h / 6.0, "c2": 0.0, "d": 0.0}
        self.of = {name: np.concatenate(([value], getattr(elastic, name))) for name, value in free.items()}
        self.square, self.rotation = beam.frequency**2, beam.rotation
        self.compliance = [
            [float(beam.rotation**2 @ self.of[a]) for a in row] for row in (("b1", "c1"), ("c1", "d"))
        ]
        self.compliance[1][0] *= -1.0

    def unloaded(self, position: Vector, velocity: Vector) -> tuple[float, float]:
        """Rotation of the root at the end without a load, and the first moment of its rate."""
        of = self.of
        end = of["a11"] * position + of["a12"] * velocity
        moment = of["c1"] * self.square * position - of["c2"] * velocity
        return float(self.rotation @ end), float(self.rotation @ moment)

    def step(self, position: Vector, velocity: Vector, load: float, slope: float) -> tuple[Vector, Vector]:
        """Position and velocity at the end."""
        q, s, of = self.rotation * load, self.rotation * slope, self.of
        end = of["a11"] * position + of["a12"] * velocity + of["b1"] * q + of["c1"] * s
        rate = of["a21"] * position + of["a22"] * velocity + of["b2"] * q + of["c2"] * s
        return end, rate


@dataclass
class Path:
    """Step means of the torque (steps,), largest change of the energy of beam, law and heat (J), heat (J)."""

    means: Vector
    residual: float
    heat: float


def coupled(
    beam: Beam,
    velocity: Vector,
    law: StepLaw,
    remember: Callable[[StepMotion, float], Memory],
    potential: Callable[[float], float],
    h: float,
    steps: int,
) -> Path:
    """Coupled steps from the undeformed beam with modal velocities."""
    modes = _Steps(beam, h)
    position = np.zeros_like(beam.frequency)
    rate = float(beam.rotation @ velocity)
    memory = Memory(rate, rate)
    load = slope = angle = lost = residual = 0.0
    means, start = [], energy(beam, position, velocity)
    for _ in range(steps):
        motion, found = _solved(
            modes, law, angle, modes.unloaded(position, velocity), h, memory, (load, slope)
        )
        load, slope, angle = found.force, found.slope, motion.end
        position, velocity = modes.step(position, velocity, load, slope)
        memory = remember(motion, float(beam.rotation @ velocity))
        means.append(load)
        lost += found.heat + found.numerical
        now = energy(beam, position, velocity) + potential(angle) + lost
        residual = max(residual, abs(now - start))
    return Path(np.array(means), residual, lost)


def _solved(
    modes: _Steps,
    law: StepLaw,
    angle: float,
    unloaded: tuple[float, float],
    h: float,
    memory: Memory,
    guess: tuple[float, float],
) -> tuple[StepMotion, MeanLoad]:
    """Motion of the root over a step and its load: Newton on load and slope, with differences as derivatives."""
    (a, b), (c, d) = modes.compliance

    def tried(end: float, moment: float) -> tuple[StepMotion, MeanLoad]:
        motion = StepMotion(angle, end, h, memory, moment)
        return motion, law(motion)

    u, s = guess
    for _ in range(_ITERATIONS):
        end, moment = unloaded[0] + a * u + b * s, unloaded[1] + c * u + d * s
        motion, load = tried(end, moment)
        size = _DIFFERENCE * (abs(end) + abs(angle) + abs(moment)) + _LEAST_DIFFERENCE
        along, bent = tried(end + size, moment)[1], tried(end, moment + size)[1]
        turned, bend = (
            np.array([(near.force - load.force, near.slope - load.slope) for near in (along, bent)]) / size
        )
        jacobian = np.outer(turned, (a, b)) + np.outer(bend, (c, d)) - np.eye(2)
        change = np.linalg.solve(jacobian, (u - load.force, s - load.slope))
        if np.abs(change).max() <= _AGREED * (1.0 + abs(u) + abs(s)):
            break
        u, s = u + float(change[0]), s + float(change[1])
    return motion, load
