"""What happens at a latch-up? Signals read at the instants before and after it, and the torque that follows."""

import numpy as np

import orchestrator as fanfold

panel = fanfold.load("workbench", settings={"hinge_line.HL.start_angle": "150 deg", "scene.until": "3 s"})
result = fanfold.simulate(panel, rigid="all")

latch_up = result.latch_times["HL"]
before, after = result.at(latch_up, side="before"), result.at(latch_up)
rate = before["hinge_left", "angular_rate"]

torque = result.latch_torque("HL")
ringing = torque.time > latch_up
time, value = torque.time[ringing], np.asarray(torque[ringing])
zero = np.flatnonzero(np.diff(np.sign(value)))
crossings = time[zero] - value[zero] * np.diff(time)[zero] / np.diff(value)[zero]
frequency = 0.5 / np.mean(np.diff(crossings))

inertia = 4147.8 / (2.0 * np.pi * frequency) ** 2
print(
    f"at {latch_up:.4f} s and {np.rad2deg(rate):.2f} deg/s; then {frequency:.3f} Hz, so {inertia:.3f} kg.m2"
)
swing = inertia * rate * 2.0 * np.pi * frequency
print(f"largest torque {np.max(np.abs(torque)):.1f} {torque.unit}; without damping it would be {swing:.1f}")
