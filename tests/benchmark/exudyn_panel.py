"""The panel of `one_panel` as a monolithic Exudyn model: modal floating frame, six-axis bushings, same latch.

    python -m tests.benchmark.exudyn_panel

prints how its latch time and latch torque peak converge to Fanfold's. The model and its solver are those of
`exudyn_model`, with sensors after latch-up only, and a step size before the latch and one after it. The run stops
a step before the latch angle, a secant iteration finds the instant, and the solver starts again with the latch
in the bushings.
"""

from __future__ import annotations

from math import pi
from time import perf_counter
from typing import Any

import numpy as np

from orchestrator.cosim.settings import Settings
from orchestrator.run.run import as_fmus
from tests.benchmark.models.exudyn_model import (
    JOINT,
    WORLD,
    Steps,
    add_body,
    add_hinge,
    add_place,
    exudyn,
    item,
    quiet_settings,
)
from tests.benchmark.models.one_panel import SIDES, UNTIL, Subject, Trial, couple, crest, subjects
from tests.benchmark.stability import MOTOR_STIFFNESS, MOTOR_WIND_UP

POINTS = tuple(f"hl_{side}" for side in SIDES)
ANGLE, RATE = exudyn.OutputVariableType.Rotation, exudyn.OutputVariableType.AngularVelocityLocal


class Panel:
    """The model, assembled, stowed and at rest."""

    def __init__(self, subject: Subject) -> None:
        self.subject = subject
        self.container = exudyn.SystemContainer()
        self.system = self.container.AddSystem()
        ground = self.system.AddObject(item.ObjectGround())
        turn = WORLD @ np.diag([-1.0, 1.0, -1.0])
        body = add_body(self.system, subject.data, turn, np.zeros(3), POINTS)
        self.bushings = [
            add_hinge(
                self.system, add_place(self.system, ground, np.array((0.0, y, 0.0)), JOINT), body, point, side
            )
            for point, (side, y) in zip(POINTS, SIDES.items(), strict=True)
        ]
        self.sensors = [[self._sensor(bushing, kind) for kind in (ANGLE, RATE)] for bushing in self.bushings]
        self.system.Assemble()

    def _sensor(self, bushing: Any, kind: Any) -> Any:
        return self.system.AddSensor(
            item.SensorObject(
                objectNumber=bushing, storeInternal=True, writeToFile=False, outputVariableType=kind
            )
        )

    def gap(self) -> float:
        """Angle still to go to the latch, at the sensor hinge (rad)."""
        return 0.5 * pi - float(self.system.GetObjectOutput(self.bushings[0], ANGLE)[2])

    def latch(self) -> None:
        """Put the latch into the bushings, beside the motor."""
        motor, latch = 0.5 * MOTOR_STIFFNESS, 0.5 * self.subject.stiffness
        free = (motor * (MOTOR_WIND_UP - 0.5 * pi) + latch * 0.5 * pi) / (motor + latch)
        for bushing in self.bushings:
            stiffness = np.array(self.system.GetObjectParameter(bushing, "stiffness"))
            damping = np.array(self.system.GetObjectParameter(bushing, "damping"))
            stiffness[5, 5] = motor + latch
            damping[5, 5] = 0.5 * self.subject.damping
            self.system.SetObjectParameter(bushing, "stiffness", stiffness)
            self.system.SetObjectParameter(bushing, "damping", damping)
            self.system.SetObjectParameter(bushing, "offset", [0.0] * 5 + [free])

    def latch_torque(self) -> tuple[np.ndarray, np.ndarray]:
        """Times and magnitudes of the line's latch torque, from latch-up on."""
        torque: Any = 0.0
        for angle, rate in self.sensors:
            turned, turning = (self.system.GetSensorStoredData(sensor) for sensor in (angle, rate))
            torque = torque + 0.5 * self.subject.stiffness * (turned[:, 3] - 0.5 * pi)
            torque = torque + 0.5 * self.subject.damping * turning[:, 3]
        return turned[:, 0], np.abs(torque)


def deploy(subject: Subject, steps: Steps, until: float = UNTIL) -> Trial:
    """One run; building and assembling the model is not timed."""
    panel = Panel(subject)
    settings = quiet_settings(steps)
    start = perf_counter()
    try:
        latch = _reach_latch(panel, settings, steps.free)
        panel.latch()
        settings.solution.sensors.active = True
        _solve(panel, settings, latch, until, steps.latched)
    except exudyn.SolverError:
        return Trial(np.nan, np.nan, perf_counter() - start, 0)
    wall = perf_counter() - start
    count = round(latch / steps.free) + round((until - latch) / steps.latched)
    return Trial(latch, crest(*panel.latch_torque()), wall, count)


def _solve(panel: Panel, settings: Any, start: float, end: float, h: float, *, keep: bool = True) -> None:
    integration = settings.timeIntegration
    integration.startTime, integration.endTime = start, end
    integration.numberOfSteps = max(1, int(np.ceil((end - start) / h - 1e-9)))
    panel.system.SolveDynamic(settings, updateInitialValues=keep)


def _reach_latch(panel: Panel, settings: Any, h: float) -> float:
    """Step freely until the next step would pass the latch angle, then end a step on it; returns the time."""
    gaps = [panel.gap(), panel.gap()]

    def goes_on(system: Any, time: float) -> bool:
        """Called before every step; a step refused here is still made, so it looks one further ahead."""
        gaps[:] = gaps[1], panel.gap()
        return gaps[1] + 2.1 * (gaps[1] - gaps[0]) > 0.0

    panel.system.SetPreStepUserFunction(goes_on)
    _solve(panel, settings, 0.0, h * np.ceil(2.0 * UNTIL / h), h)
    panel.system.SetPreStepUserFunction(0)
    start, before = panel.system.systemData.GetTime(), panel.gap()
    tried, found, trial = 0.0, before, before * h / (gaps[1] - before)
    for _ in range(8):
        _solve(panel, settings, start, start + trial, trial, keep=False)
        gap = panel.gap()
        if abs(gap) < 1e-12 or gap == found:
            break
        tried, found, trial = trial, gap, trial - gap * (trial - tried) / (gap - found)
        if abs(trial - tried) < 1e-9 * h:
            break
    _solve(panel, settings, start, start + trial, trial)
    return float(start + trial)


def main() -> None:
    """Print the convergence of every subject."""
    for subject in subjects().values():
        assembly = subject.assembly()
        _, tight = couple(as_fmus(assembly), assembly, Settings(tolerance=1e-6))
        print(f"\n{subject.name}; Fanfold at 1e-6: latch {tight.latch:.7f} s, peak {tight.peak:.4f} N.m")
        print(
            f"{'free step':>10}{'latched':>10}{'latch, s':>12}{'error':>10}{'peak':>11}{'error':>10}{'wall, s':>9}"
        )
        for steps in (Steps(1e-2, 3e-3), Steps(5e-3, 2e-3), Steps(2e-3, 1e-3), *tight_steps()):
            found = deploy(subject, steps)
            print(
                f"{steps.free:>10g}{steps.latched:>10g}{found.latch:>12.7f}{found.latch / tight.latch - 1.0:>10.1e}"
                f"{found.peak:>11.4f}{found.peak / tight.peak - 1.0:>10.1e}{found.wall:>9.3f}"
            )


def tight_steps() -> tuple[Steps, Steps]:
    """Two runs whose difference shows that the second has converged."""
    return Steps(1e-3, 5e-4, 1e-6), Steps(5e-4, 2.5e-4, 1e-6)


if __name__ == "__main__":
    main()
