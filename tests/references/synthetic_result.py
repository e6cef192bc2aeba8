"""A made-up deployment in closed form: a yoke and two panels, three hinge lines that latch one after another.

Every signal is a formula of time, so the true peaks between the samples are known.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from components.contract import roles
from orchestrator.assembly import Geometry, HingeLine
from orchestrator.results.recorder import SignalGroup
from orchestrator.results.result_file import ResultWriter

Vector = NDArray[np.float64]
LATCH_DAMPING = 2.0
DAMPER_COEFFICIENT = 3.0
MOTOR_TORQUE = 1.2
PRELOAD, CABLE_SWING, CABLE_RATE = 50.0, 20.0, 0.9
RESIDUAL = 2e-5
NUMERICAL = 3e-3
END = 14.0
LARGEST_STEP = 0.011


class Signal(NamedTuple):
    """A recorded signal: values are (N,) or (N, size)."""

    unit: str
    values: Vector


@dataclass(frozen=True)
class Line:
    """A hinge line that turns with constant acceleration to its latch angle and then rings."""

    name: str
    latch_angle: float
    latch_time: float
    stiffness: float
    frequency: float
    decay: float

    @property
    def latch_rate(self) -> float:
        """Rate of arrival (rad/s)."""
        return 2.0 * self.latch_angle / self.latch_time

    @property
    def _phase(self) -> float:
        viscous = LATCH_DAMPING * self.frequency
        return float(np.arctan2(viscous, self.stiffness - LATCH_DAMPING * self.decay))

    @property
    def _amplitude(self) -> float:
        """Of the latch torque (N.m)."""
        viscous = LATCH_DAMPING * self.frequency
        factor = np.hypot(viscous, self.stiffness - LATCH_DAMPING * self.decay)
        return float(factor * self.latch_rate / self.frequency)

    def angle(self, time: Vector, latched: NDArray[np.bool_]) -> Vector:
        """Hinge angle (rad)."""
        after = time - self.latch_time
        ringing = np.exp(-self.decay * after) * np.sin(self.frequency * after) / self.frequency
        free = self.latch_angle * (time / self.latch_time) ** 2
        return np.where(latched, self.latch_angle + self.latch_rate * ringing, free)

    def rate(self, time: Vector, latched: NDArray[np.bool_]) -> Vector:
        """Hinge rate (rad/s)."""
        after = time - self.latch_time
        turn = np.cos(self.frequency * after) - self.decay / self.frequency * np.sin(self.frequency * after)
        free = self.latch_rate * time / self.latch_time
        return np.where(latched, self.latch_rate * np.exp(-self.decay * after) * turn, free)

    def torque(self, time: Vector, latched: NDArray[np.bool_]) -> Vector:
        """Latch torque: spring and viscous damping on the overshoot (N.m)."""
        after = time - self.latch_time
        ringing = np.exp(-self.decay * after) * np.sin(self.frequency * after + self._phase)
        return np.where(latched, -self._amplitude * ringing, 0.0)

    @property
    def torque_peak(self) -> float:
        """The true peak of the magnitude of the latch torque (N.m)."""
        steepest = np.arctan(self.frequency / self.decay)
        after = (steepest - self._phase) / self.frequency
        return float(self._amplitude * np.exp(-self.decay * after) * np.sin(steepest))


LINES = (
    Line("hl1", np.pi / 2, 6.0, 900.0, 11.0, 0.9),
    Line("hl2", np.pi, 8.2, 700.0, 8.0, 0.7),
    Line("hl3", np.pi, 9.7, 500.0, 14.0, 1.1),
)
SHARES = {"left": 0.6, "right": 0.4}
HINGE_LINES = tuple(
    HingeLine(line.name, tuple(f"{line.name}_{side}" for side in SHARES), f"{line.name}_left", True, False)
    for line in LINES
)
GAP = 0.06
LOADS = ("tension_a", "tension_b", "axial_force", "lateral_force", "damper_torque")
ROLES = {
    **dict.fromkeys(LOADS, roles.LOAD),
    **dict.fromkeys(("interface_force", "interface_torque"), roles.INTERFACE_LOAD),
    **dict.fromkeys(("friction_energy", "latch_energy", "damping_energy"), roles.DISSIPATION),
}
NOUNS = {"ccl": "closed cable loop", "base": "interface", "hl": "hinge", "yoke": "body", "panel": "body"}

LENGTHS = {"yoke": 1.0, "panel1": 2.0, "panel2": 2.0}
WIDTHS = {"yoke": 0.4, "panel1": 1.5, "panel2": 1.5}


def sample_times() -> tuple[Vector, NDArray[np.bool_]]:
    """Times with steps that start small after an event, and per line whether it is latched; events twice."""
    times, counts = [0.0], [0]
    for index, event in enumerate([*(line.latch_time for line in LINES), END]):
        step = 1e-4
        while times[-1] + step < event - 1e-3:
            times.append(times[-1] + step)
            counts.append(index)
            step = min(1.15 * step, LARGEST_STEP)
        times.append(event)
        counts.append(index)
        if event < END:
            times.append(event)
            counts.append(index + 1)
    return np.array(times), np.array(counts)[:, None] > np.arange(len(LINES))


def _hinge(line: Line, share: float, time: Vector, latched: NDArray[np.bool_]) -> dict[str, Signal]:
    angle, rate = line.angle(time, latched), line.rate(time, latched)
    travel = np.maximum.accumulate(angle)
    latch = np.where(latched, 1.0 - np.exp(-2.0 * line.decay * (time - line.latch_time)), 0.0)
    heat = (0.10 * MOTOR_TORQUE * travel, 0.3 * line.latch_rate * latch, 0.02 * MOTOR_TORQUE * travel)
    return {
        "angle": Signal("rad", angle),
        "angular_rate": Signal("rad/s", rate),
        "latch_torque": Signal("N.m", share * line.torque(time, latched)),
        "motor_energy": Signal("J", MOTOR_TORQUE * angle),
        "friction_energy": Signal("J", heat[0]),
        "latch_energy": Signal("J", heat[1]),
        "damping_energy": Signal("J", heat[2]),
        "dissipated_energy": Signal("J", heat[0] + heat[1] + heat[2]),
    }


def _bodies(angles: Mapping[str, Vector], time: Vector) -> dict[str, dict[str, Signal]]:
    """Yoke and panels as a chain in the x-z plane; the panels bend after the first latch-up."""
    found = {}
    zero = np.zeros_like(time)
    position = np.zeros((time.size, 3))
    direction = zero
    turns = (np.pi / 2 - angles["hl1"], np.pi - angles["hl2"], -(np.pi - angles["hl3"]))
    for body, turn, side in zip(LENGTHS, turns, (1.0, -1.0, 0.0), strict=True):
        direction = direction + turn
        quaternion = np.column_stack([np.cos(direction / 2), zero, -np.sin(direction / 2), zero])
        found[body] = {
            "frame_position": Signal("m", position),
            "frame_orientation": Signal("1", quaternion),
            "dissipated_energy": Signal("J", 0.02 * (1.0 - np.exp(-time / 5.0))),
        }
        if body != "yoke":
            late = np.maximum(time - LINES[0].latch_time, 0.0)
            bending = 0.15 * np.exp(-0.4 * late) * np.sin(5.0 * late)
            found[body]["modal_coordinate"] = Signal("kg(1/2).m", np.column_stack([bending, 0.3 * bending]))
        axis = np.column_stack([np.cos(direction), zero, np.sin(direction)])
        normal = np.column_stack([-np.sin(direction), zero, np.cos(direction)])
        position = position + LENGTHS[body] * axis + side * GAP * normal
    return found


def signals() -> tuple[Vector, dict[str, dict[str, Signal]]]:
    """Sample times, and every signal by component and variable."""
    time, latched = sample_times()
    found: dict[str, dict[str, Signal]] = {}
    for k, line in enumerate(LINES):
        for side, share in SHARES.items():
            found[f"{line.name}_{side}"] = _hinge(line, share, time, latched[:, k])
    swing = CABLE_SWING * np.sin(CABLE_RATE * time)
    found["ccl"] = {
        "tension_a": Signal("N", PRELOAD + swing),
        "tension_b": Signal("N", PRELOAD - swing),
        "torque_1": Signal("N.m", 0.03 * swing),
        "axial_force": Signal("N", np.full_like(time, 2.0 * PRELOAD)),
        "lateral_force": Signal("N", 0.1 * swing),
        "dissipated_energy": Signal("J", 0.004 * time),
    }
    rate = LINES[0].rate(time, latched[:, 0])
    heat = DAMPER_COEFFICIENT * np.concatenate(([0.0], np.cumsum(rate[1:] ** 2 * np.diff(time))))
    found["damper"] = {
        "damper_torque": Signal("N.m", -DAMPER_COEFFICIENT * rate),
        "dissipated_energy": Signal("J", heat),
    }
    torque = sum(line.torque(time, latched[:, k]) for k, line in enumerate(LINES))
    zero = np.zeros_like(time)
    found["base"] = {
        "interface_force": Signal("N", np.column_stack([0.8 * torque, zero, 3.0 * np.sin(2.0 * time)])),
        "interface_torque": Signal("N.m", np.column_stack([zero, -torque, zero])),
    }
    angles = {line.name: line.angle(time, latched[:, k]) for k, line in enumerate(LINES)}
    found |= _bodies(angles, time)
    found["scene"] = _scene(time, found)
    return time, found


def _scene(time: Vector, found: Mapping[str, Mapping[str, Signal]]) -> dict[str, Signal]:
    heat = sum(s["dissipated_energy"].values for s in found.values() if "dissipated_energy" in s)
    residual = RESIDUAL * np.sin(0.5 * np.pi * time / END)
    numerical = NUMERICAL * time / END
    return {
        "step_size": Signal("s", np.diff(time, prepend=0.0)),
        "iterations": Signal("1", 2.0 + (np.arange(time.size) % 7 == 0)),
        "stored_energy": Signal("J", 25.0 - heat - numerical + residual),
        "dissipated_energy": Signal("J", heat),
        "numerical_dissipation": Signal("J", numerical),
        "energy_residual": Signal("J", residual),
    }


def geometry() -> dict[str, Geometry]:
    """A frame of beams and two plates of 8 x 4 faces that bend and twist, hinged at x = 0."""
    found = {}
    for body, length in LENGTHS.items():
        x, y = np.meshgrid(np.linspace(0.0, 1.0, 9), np.linspace(-0.5, 0.5, 5), indexing="ij")
        index = np.arange(45).reshape(9, 5)
        faces = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1)
        positions = np.stack([length * x, WIDTHS[body] * y, 0.0 * x], axis=-1).reshape(-1, 3)
        shapes = np.zeros((45, 3, 0 if body == "yoke" else 2))
        if body != "yoke":
            shapes[:, 2, 0] = (x**2).ravel()
            shapes[:, 2, 1] = (x * y).ravel()
        if body == "yoke":
            legs = np.stack([index[:-1, [0, 4]], index[1:, [0, 4]]], axis=-1).reshape(-1, 2)
            faces = np.concatenate([legs, [[40, 44]]])[:, [0, 1, 1, 0]]
        found[body] = Geometry(positions, shapes, faces.reshape(-1, 4))
    return found


def write(path: Path, *, leave_out: tuple[str, ...] = ()) -> Path:
    """Write the deployment as a result, without the components left out."""
    time, found = signals()
    found = {name: variables for name, variables in found.items() if name not in leave_out}
    groups = [
        SignalGroup(
            name,
            tuple(variables),
            tuple(s.unit for s in variables.values()),
            tuple(s.values[0].size for s in variables.values()),
            tuple(variable.replace("_", " ") for variable in variables),
            tuple(ROLES.get(variable, "") for variable in variables),
            NOUNS.get(name.partition("_")[0].rstrip("123"), name),
        )
        for name, variables in found.items()
    ]
    rows = [np.column_stack([s.values for s in variables.values()]) for variables in found.values()]
    provenance = {"scene": "name = 'synthetic'", "numpy": np.__version__}
    shown = {name: body for name, body in geometry().items() if name not in leave_out}
    with ResultWriter(path, groups, provenance, shown, HINGE_LINES) as writer:
        for k in range(time.size):
            writer.append(time[k], [values[k] for values in rows])
        for line in LINES:
            writer.event(line.latch_time, f"{line.name}_left", f"{line.name} latch-up")
        writer.statistics({"steps": time.size, "seconds": 1.5})
    return path
