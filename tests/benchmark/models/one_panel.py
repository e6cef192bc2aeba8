"""The subject of the comparisons: one workbench panel that opens, latches at about 4.3 s, and rings for 1 s.

Fixed base, two hinges as six-axis bushings, motor springs, latch at 180 degrees; nothing else. All masters and
Exudyn get the numbers of this file, and the modal data of the same reduction.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from math import pi, sqrt
from time import perf_counter
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from components.contract.frames import exponential
from components.flexible.modal import ModalData
from orchestrator.assembly import Assembly, HingeLine, Link, Part
from orchestrator.assembly.start_values import with_port_starts
from orchestrator.cosim.coupling import StepError
from orchestrator.cosim.explicit import ExplicitMaster
from orchestrator.cosim.master import Master
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import Participant, ParticipantError
from orchestrator.cosim.settings import Settings
from orchestrator.scene.component_connections import WrenchMode
from tests.benchmark.stability import (
    JOINT_DAMPING,
    MOTOR_STIFFNESS,
    MOTOR_WIND_UP,
    MasterName,
    Record,
    Start,
    panel_data,
)

UNTIL = 5.3
SIDES = {"left": 0.565, "right": -0.565}
"""Hinges and their places on the hinge line (m); the left one carries the axial force."""
RADIAL, AXIAL, CROSS = 5e6, 2e6, 2e4
"""Stiffnesses of a hinge (N/m, N/m, N.m/rad), of the data sheet; their damping is `JOINT_DAMPING` times them."""
HINGE_LATCH, STRUCTURE = 2939.0, 4147.8
"""Stiffness of the latched line's hinges and of the panel behind them (N.m/rad)."""
LATCH_DAMPING_RATIO, HINGE_INERTIA = 0.02, 6.2514
LOCK = 2e7
"""A line that is locked (N.m/rad): a Fanfold latch by impulse, then this stiffness."""


@dataclass(frozen=True)
class Subject:
    """One panel; `stiffness` (N.m/rad) and `damping` (N.m.s/rad) are totals of its latched line."""

    name: str
    data: ModalData
    stiffness: float
    damping: float
    locks: bool = False

    def assembly(self, mode: WrenchMode = "mean") -> Assembly:
        """The panel with its hinges, ready to become FMUs."""
        base = [{"name": side, "position": (0.0, y, 0.0)} for side, y in SIDES.items()]
        ports = [{"name": side, "point": f"hl_{side}"} for side in SIDES]
        turned = {"initial_orientation": exponential((0.0, pi, 0.0))}
        parts = [
            Part("base", "fixed_base", {"ports": base}, {}),
            Part("panel", "body", {"modal": self.data.to_arrays(), "ports": ports}, turned),
            *(self._hinge(side, mode) for side in SIDES),
        ]
        links = [
            Link((body, side), (f"{side}_hinge", port))
            for side in SIDES
            for body, port in (("base", "inboard"), ("panel", "outboard"))
        ]
        hinges = tuple(f"{side}_hinge" for side in SIDES)
        line = HingeLine("HL", hinges, hinges[0], latches=True, kinematic=self.locks)
        joined = with_port_starts(parts, links)
        return Assembly(
            name=self.name,
            scene_tree={},
            flexible=("panel",) if self.data.frequency.size else (),
            parts=joined,
            links=tuple(links),
            hinge_lines=(line,),
            base="base",
            until=UNTIL,
            tolerance=1e-4,
            largest_step=0.02,
            preload=False,
        )

    def _hinge(self, side: str, mode: WrenchMode) -> Part:
        start = hinge_start(side) | {
            "latch_angle": pi,
            "latch_automatic": float(mode == "endpoint"),
            "latch_stiffness": 0.5 * self.stiffness,
            "latch_damping": 0.5 * self.damping,
            "lock_stiffness": 0.5 * LOCK,
        }
        kind = "kinematic" if self.locks else "spring"
        structure = {"axis": (0.0, -1.0, 0.0), "latch": kind, "wrench_mode": mode}
        return Part(f"{side}_hinge", "hinge", structure, start)


def hinge_start(side: str) -> Start:
    """Bushing and motor of one of a line's two hinges, from 0 to 180 degrees; the left one carries the axial force."""
    translational = (AXIAL if side == "left" else 0.0, RADIAL, RADIAL)
    return {
        "translational_stiffness": translational,
        "translational_damping": tuple(JOINT_DAMPING * k for k in translational),
        "rotational_stiffness": (0.0, CROSS, CROSS),
        "rotational_damping": (0.0, JOINT_DAMPING * CROSS, JOINT_DAMPING * CROSS),
        "aligned_angle": pi,
        "stowed_angle": 0.0,
        "motor_stiffness": 0.5 * MOTOR_STIFFNESS,
        "motor_wind_up": MOTOR_WIND_UP,
    }


def subjects() -> dict[str, Subject]:
    """The rigid panel, the flexible one with 10 fixed-interface modes, and that one with a lock."""
    flexible = panel_data(16)
    series = 1.0 / (1.0 / HINGE_LATCH + 1.0 / STRUCTURE)
    return {
        "rigid": Subject("rigid panel, spring latch", panel_data(0), series, _damping(series)),
        "flexible": Subject("flexible panel, spring latch", flexible, HINGE_LATCH, _damping(HINGE_LATCH)),
        "lock": Subject("flexible panel, locked by the latch", flexible, LOCK, 0.0, locks=True),
    }


def _damping(stiffness: float) -> float:
    return 2.0 * LATCH_DAMPING_RATIO * sqrt(stiffness * HINGE_INERTIA)


class Trial(NamedTuple):
    """One run: latch time (s), peak of the line's latch torque (N.m), wall time (s); NaN where not reached."""

    latch: float
    peak: float
    wall: float
    steps: int


def crest(times: Sequence[float] | np.ndarray, values: np.ndarray) -> float:
    """Largest value of the cubic interpolant around the largest sample."""
    top = int(values.argmax())
    near = slice(max(top - 3, 0), top + 4)
    window, inside = np.unique(np.asarray(times)[near], return_index=True)
    if len(window) < 4:
        return float(values[top])
    fine = np.linspace(window[0], window[-1], 2000)
    return float(CubicSpline(window, values[near][inside])(fine).max())


def couple(
    loaded: AbstractContextManager[Sequence[Participant]],
    assembly: Assembly,
    settings: Settings,
    master: MasterName = "implicit",
    until: float = UNTIL,
) -> tuple[Record, Trial]:
    """Run loaded participants under one of our masters, results in memory; loading is not timed."""
    with loaded as participants:
        network = Network(participants, assembly.links, (settings.order or 4) if master == "implicit" else 2)
        record = Record(network)
        if master == "implicit":
            runner = Master(network, assembly.hinge_lines, record, settings)
        else:
            runner = ExplicitMaster(network, assembly.hinge_lines, record, settings, master)
        start = perf_counter()
        try:
            runner.initialize(preload=assembly.preload)
            runner.run(until)
        except (StepError, ParticipantError):
            return record, Trial(np.nan, np.nan, perf_counter() - start, runner.statistics.steps)
        wall = perf_counter() - start
    latch = record.events[0][0] if record.events else np.nan
    peak = crest(record.times, line_torque(record, assembly)) if record.events else np.nan
    return record, Trial(latch, peak, wall, runner.statistics.steps)


def line_torque(record: Record, assembly: Assembly, line: int = 0) -> np.ndarray:
    """Magnitude of a line's latch torque over time (N.m)."""
    hinges = assembly.hinge_lines[line].hinges
    return np.abs(sum(record.signal(hinge, "latch_torque") for hinge in hinges))
