"""Stability of the coupling over joint and latch stiffness, step size and modes, beside explicit masters.

    python -m tests.benchmark.stability [--quick]

One spring-driven panel of the workbench on two hinges, started at the latch angle with the rate it latches
with. Every cell gives the relative error of the first peak of the line's latch torque against a run that
resolves it; `~` marks cells whose step does not resolve the latch (H w > 0.5), `.` a window too short for
the peak, J and G the cells where the explicit Jacobi and Gauss-Seidel masters diverge, and DIVERGED the ones
where the implicit master does. The kinematic latch follows as a plastic event between two free bodies.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import product
from math import pi, sqrt
from typing import Literal, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from components import catalogue
from components.modal import ModalData
from orchestrator.assembly import HingeLine, Link, Part
from orchestrator.explicit import ExplicitMaster
from orchestrator.master import Master, Settings
from orchestrator.network import Network
from orchestrator.participant import in_process
from orchestrator.stepping import StepError

MasterName = Literal["implicit", "jacobi", "gauss-seidel"]

LATCH_RATE = 1.370585
"""Hinge rate (rad/s) of the spring-driven panel at 180 degrees, in closed form."""
MOTOR_STIFFNESS, MOTOR_WIND_UP = 0.276930, 8.3198
PERIOD_SHARE = 0.5
"""A latch counts as resolved while H times its angular frequency is below this."""
JOINTS = (1e3, 1e5, 2e6, 1e8, 1e10)
LATCHES = (1e2, 2e3, 1e5, 1e7, 1e9)
STEPS = (1e-4, 1e-3, 5e-3, 2e-2)
MODES = (0, 6, 16, 36)
"""Flexible modes of the panel: 0 for the rigid one, else 6 and the fixed-interface modes of the reduction."""


@dataclass
class Record:
    """A recorder that keeps everything in memory: times, observations by participant, events."""

    network: Network
    times: list[float] = field(default_factory=list)
    rows: list[list[np.ndarray]] = field(default_factory=list)
    events: list[tuple[float, str, str]] = field(default_factory=list)

    def append(self, time: float, values: Sequence[np.ndarray]) -> None:
        """Keep a copy."""
        self.times.append(time)
        self.rows.append([value.copy() for value in values])

    def event(self, time: float, component: str, text: str) -> None:
        """Keep it."""
        self.events.append((time, component, text))

    def signal(self, participant: str, name: str) -> np.ndarray:
        """One observation over time, (N, size), or (N,) for a scalar."""
        parts = [*self.network.bodies, *self.network.connections]
        i = [p.name for p in parts].index(participant)
        where = parts[i].observation_layout[name]
        values = np.array([row[i][where] for row in self.rows])
        return values[:, 0] if values.shape[1] == 1 else values

    def scene(self, column: int) -> np.ndarray:
        """One of the scene channels, (N,)."""
        return np.array([row[-1][column] for row in self.rows])


class Run(NamedTuple):
    """A finished or failed run."""

    record: Record
    master: Master
    failure: str


def run(
    parts: Sequence[Part],
    links: Sequence[Link],
    lines: Sequence[HingeLine],
    until: float,
    settings: Settings,
    name: MasterName = "implicit",
    *,
    preload: bool = False,
) -> Run:
    """Run a scene in process with the chosen master and keep what it recorded."""
    network = Network(in_process(parts), links)
    record = Record(network)
    if name == "implicit":
        master = Master(network, lines, record, settings)
    else:
        master = ExplicitMaster(network, lines, record, settings, name)
    try:
        master.initialize(preload=preload)
        master.run(until)
    except StepError as error:
        return Run(record, master, str(error))
    return Run(record, master, "")


def panel_data(modes: int) -> ModalData:
    """The workbench panel with that many flexible modes; rigid for none."""
    flexible = catalogue.workbench_panel(max(0, modes - 6))
    if modes:
        return flexible
    points = dict(zip(flexible.point_names, flexible.point_positions, strict=True))
    return ModalData.rigid(flexible.mass, flexible.center_of_mass, flexible.inertia, points)


def panel_scene(
    data: ModalData, joint: float, latch: float, mode: Literal["mean", "endpoint"] = "mean"
) -> tuple[list[Part], list[Link], list[HingeLine]]:
    """The panel at its latch angle with its latch rate; joint in N/m per hinge, latch in N.m/rad per line."""
    sides = {"left": 0.565, "right": -0.565}
    orientation = (1.0, 0.0, 0.0, 0.0)
    spin = np.array((0.0, -LATCH_RATE, 0.0))
    state = {
        "initial_orientation": orientation,
        "initial_angular_velocity": tuple(spin),
        "initial_velocity": tuple(np.cross(spin, data.center_of_mass)),
    }
    base = [{"name": side, "position": (0.0, y, 0.0)} for side, y in sides.items()]
    ports = [{"name": side, "point": f"hl_{side}"} for side in sides]
    parts = [
        Part("base", "fixed_base", {"ports": base}, {}),
        Part("panel", "body", {"modal": data.to_arrays(), "ports": ports}, state),
    ]
    hinge = {"axis": (0.0, -1.0, 0.0), "latch": "spring", "wrench_mode": mode}
    time = 2.0 * 0.05 / (2.0 * pi * 184.0)
    start = {
        "translational_damping": (0.0, time * joint, time * joint),
        "rotational_stiffness": (0.0, 1e-2 * joint, 1e-2 * joint),
        "rotational_damping": (0.0, 1e-2 * time * joint, 1e-2 * time * joint),
        "aligned_angle": pi,
        "stowed_angle": pi - 1e-9,
        "latch_angle": pi + 1e-7,
        "latch_automatic": 0.0,
        "motor_stiffness": 0.5 * MOTOR_STIFFNESS,
        "motor_wind_up": MOTOR_WIND_UP,
        "latch_stiffness": 0.5 * latch,
    }
    links = []
    for side in sides:
        axial = joint if side == "left" else 0.0
        parts.append(Part(f"{side}_hinge", "hinge", hinge, start | {"translational_stiffness": (axial, joint, joint)}))
        links.append(Link(("base", side), (f"{side}_hinge", "inboard")))
        links.append(Link(("panel", side), (f"{side}_hinge", "outboard")))
    hinges = tuple(f"{side}_hinge" for side in sides)
    return parts, links, [HingeLine("HL", hinges, hinges[0], latches=True, kinematic=False)]
