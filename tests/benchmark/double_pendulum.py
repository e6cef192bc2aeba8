"""Tight tolerances and stiff joints: a double pendulum of two bars of 1 kg and 1 m, let go from the horizontal.

    python -m tests.benchmark.double_pendulum

First over 0.05 s, joints of 1e5 to 1e9 N/m (a hundredth of that in N.m/rad) by tolerances of 1e-5 to 1e-9: steps and
the largest error of an angle at the end (rad), or how the run fails. Then over 3 s, joints of 1e6 N/m: does the error
follow the tolerance, and do steps grow as it falls? Errors are against the plane motion of the same two bars and
springs in one system of equations.
"""

from __future__ import annotations

from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.results.result import Result
from orchestrator.run.run import RunError, run
from orchestrator.scene.reader import read_scene

STIFFNESSES = (1e5, 1e6, 1e7, 1e8, 1e9)
TOLERANCES = (1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
SHORT, LONG = 0.05, 3.0
LONG_STIFFNESS, LONG_TOLERANCES = 1e6, (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
MASS, LENGTH, GRAVITY = 1.0, 1.0, 9.81
INERTIA = MASS * LENGTH**2 / 12.0
DAMPING_RATIO, DAMPING_FREQUENCY = 0.05, 184.0
_DAMPING_TIME = 2.0 * DAMPING_RATIO / (2.0 * pi * DAMPING_FREQUENCY)
_RELATIVE, _ABSOLUTE = 1e-10, 1e-12


class Cell(NamedTuple):
    """A run: steps, largest error of its two angles at the end (rad), how it failed (else empty)."""

    steps: int
    error: float
    failure: str


def scene(stiffness: float, until: float) -> dict[str, Any]:
    """The tree of the double pendulum: two hinges about y under gravity along -z."""
    ends = {"inner": [0.0, 0.0, 0.0], "outer": [LENGTH, 0.0, 0.0]}
    bar = {
        "mass": MASS,
        "center_of_mass": [0.5 * LENGTH, 0.0, 0.0],
        "inertia": [1e-3, INERTIA, INERTIA],
        "points": ends,
    }
    pairs = (("base", "hook", "bar1"), ("bar1", "outer", "bar2"))
    return {
        "scene": {"name": "double_pendulum", "until": until, "gravity": [0.0, 0.0, -GRAVITY]},
        "base": {"points": {"hook": [0.0, 0.0, 0.0]}},
        "joint": {
            "axial_stiffness": stiffness,
            "radial_stiffness": stiffness,
            "cross_stiffness": 0.01 * stiffness,
            "damping_ratio": DAMPING_RATIO,
            "damping_frequency": DAMPING_FREQUENCY,
        },
        "body": [{"name": name, "rigid": bar} for _, _, name in pairs],
        "hinge_line": [
            {
                "name": f"line{k}", "inboard": inboard, "outboard": outboard, "axis": "+y",
                "aligned_angle": 0.0, "stowed_angle": 0.0, "latch_angle": pi,
                "hinges": [{"name": f"hinge{k}", "inboard": point, "outboard": "inner"}],
            }
            for k, (inboard, point, outboard) in enumerate(pairs)
        ],
    }  # fmt: skip


def measured(stiffness: float, tolerance: float, until: float, true: np.ndarray) -> Cell:
    """One run against the angles of the hinges at its end."""
    assembly = assemble(read_scene("double_pendulum.toml", scene(stiffness, until)))
    with TemporaryDirectory(prefix="fanfold_pendulum_") as folder:
        path = Path(folder) / "run.h5"
        try:
            outcome = run(assembly, path, Settings(tolerance, assembly.largest_step))
        except RunError as error:
            return Cell(0, np.nan, str(error).removeprefix("double_pendulum: ").partition(": ")[0])
        result = Result.open(path)
        angles = np.array([result.signal(f"hinge{k}", "angle")[-1] for k in range(2)])
    return Cell(outcome.costs.steps, float(np.abs(angles - true).max()), "")


def true_angles(stiffness: float, until: float) -> np.ndarray:
    """Hinge angles at the end, of both bars in the plane x, z on springs and dampers between their ends."""
    rates_of = _Plane(stiffness)
    found = solve_ivp(rates_of, (0.0, until), rates_of.start, "LSODA", rtol=_RELATIVE, atol=_ABSOLUTE)
    first, second = found.y[2, -1], found.y[5, -1]
    return np.array((first, second - first))


class _Plane:
    """x, z of the centre of mass and turn about y of both bars, then their rates."""

    def __init__(self, stiffness: float) -> None:
        self.stiffness = stiffness
        self.start = np.array((0.5 * LENGTH, 0.0, 0.0, 1.5 * LENGTH, 0.0, 0.0, *np.zeros(6)))

    def __call__(self, time: float, state: np.ndarray) -> np.ndarray:
        """Rates of the state."""
        places, rates = state[:6].reshape(2, 3), state[6:].reshape(2, 3)
        inner, outer = (self._ends(places, rates, side) for side in (-0.5 * LENGTH, 0.5 * LENGTH))
        forces = np.zeros((2, 3))
        forces[:, 1] = -MASS * GRAVITY
        at_hook = self._pull(inner[0], np.zeros((2, 2)))
        between = self._pull(inner[1], outer[0])
        for bar, force, end in ((0, at_hook, inner[0]), (1, between, inner[1]), (0, -between, outer[0])):
            arm = end[0] - places[bar, :2]
            forces[bar] += (*force, arm[1] * force[0] - arm[0] * force[1])
        return np.concatenate((state[6:], (forces / (MASS, MASS, INERTIA)).ravel()))

    def _ends(self, places: np.ndarray, rates: np.ndarray, side: float) -> np.ndarray:
        """Place and velocity (2, 2) of an end of both bars; a turn about y takes x towards -z."""
        turn, spin = places[:, 2], rates[:, 2]
        arm = side * np.stack((np.cos(turn), -np.sin(turn)), axis=1)
        swing = side * spin[:, None] * np.stack((-np.sin(turn), -np.cos(turn)), axis=1)
        return np.stack((places[:, :2] + arm, rates[:, :2] + swing), axis=1)

    def _pull(self, end: np.ndarray, other: np.ndarray) -> np.ndarray:
        """Force on an end that a spring and a damper hold at another."""
        stretch, rate = end - other
        force: np.ndarray = -self.stiffness * (stretch + _DAMPING_TIME * rate)
        return force


def print_grid() -> None:
    """Stiffness by tolerance over the short time."""
    print(f"{SHORT:g} s: steps and error (rad)")
    print(f"{'N/m':>6} " + " ".join(f"{tolerance:>16.0e}" for tolerance in TOLERANCES))
    failures = []
    for stiffness in STIFFNESSES:
        true = true_angles(stiffness, SHORT)
        cells = [measured(stiffness, tolerance, SHORT, true) for tolerance in TOLERANCES]
        texts = ["fails" if cell.failure else f"{cell.steps} {cell.error:.1e}" for cell in cells]
        print(f"{stiffness:6.0e} " + " ".join(f"{text:>16}" for text in texts), flush=True)
        failures += [
            f"{stiffness:.0e} N/m at {tolerance:.0e}: {cell.failure}"
            for tolerance, cell in zip(TOLERANCES, cells, strict=True)
            if cell.failure
        ]
    print("\n".join(failures))


def print_long() -> None:
    """Error against tolerance over the long time."""
    print(f"\n{LONG:g} s, {LONG_STIFFNESS:.0e} N/m")
    print(f"{'tolerance':>9} {'steps':>8} {'error, rad':>10} {'error / tolerance':>18}")
    true = true_angles(LONG_STIFFNESS, LONG)
    for tolerance in LONG_TOLERANCES:
        cell = measured(LONG_STIFFNESS, tolerance, LONG, true)
        over = cell.error / tolerance
        print(f"{tolerance:9.0e} {cell.steps:8d} {cell.error:10.1e} {over:18.2g}  {cell.failure}", flush=True)


def main() -> None:
    """Print both tables."""
    print_grid()
    print_long()


if __name__ == "__main__":
    main()
