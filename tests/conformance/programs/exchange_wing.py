"""Run in a process of its own: a spacecraft, a flexible panel and a latching hinge as one system of equations.

    python exchange_wing.py FOLDER

SciPy integrates their FMUs monolithically in model exchange; Fanfold's master couples the same components with
mean wrenches. Prints one JSON object: latch times, and the largest differences relative to the largest value.
"""

from __future__ import annotations

import json
import sys
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp

from components import REGISTRY
from components.body import Body
from fmus import build_fmu
from orchestrator.assembly import HingeLine, Part
from orchestrator.cosim.settings import Settings
from tests.conformance.programs.driver import OK
from tests.conformance.programs.exchange import Model
from tests.references.coupled import between, completed, rigid, turned

END, AHEAD = 0.8, 0.1
ROOT = np.array((0.9, 0.0, 0.3))
JOINT = {
    "translational_stiffness": (2e5, 2e5, 2e5),
    "translational_damping": (100.0, 100.0, 100.0),
    "rotational_stiffness": (0.0, 2e4, 2e4),
    "rotational_damping": (0.0, 5.0, 5.0),
    "aligned_angle": np.pi,
    "latch_angle": np.pi,
    "stowed_angle": np.pi - AHEAD,
    "motor_stiffness": 0.5,
    "motor_wind_up": 8.3,
    "latch_stiffness": 1000.0,
    "latch_damping": 1.0,
    "friction_coefficient": 0.1,
    "friction_preload": 0.02,
}
COMPARED = {
    "panel": (
        "frame_position",
        "angular_momentum",
        "kinetic_energy",
        "dissipated_energy",
        "modal_coordinate",
    ),
    "hinge": ("angle", "angular_rate", "latch_torque", "bending_moment", "dissipated_energy"),
}


def parts(wrench_mode):
    modal = Body.example().structure["modal"]
    panel = {"modal": modal, "ports": [{"name": "root", "point": "left"}]}
    start = {
        "initial_position": tuple(ROOT + (0.0, 0.4, 0.0)),  # noqa: RUF005 - an addition
        "initial_orientation": turned((0, 1, 0), AHEAD),
    }
    return [
        rigid("spacecraft", 300.0, (100.0, 120.0, 90.0), {"root": tuple(ROOT)}),
        Part("panel", "body", panel, start),
        Part("hinge", "hinge", {"axis": (0, -1, 0), "latch": "spring", "wrench_mode": wrench_mode}, JOINT),
    ]


class Monolith:
    """The FMUs of two bodies and a hinge as one function of one state."""

    def __init__(self, folder):
        self.components, self.fmus = [], []
        for part in parts("endpoint"):
            component = REGISTRY[part.kind](**part.structure)
            path = str(build_fmu(component, part.name, folder, start=part.start, backend="native"))
            self.components.append(component)
            self.fmus.append(Model(path, component, part.name))
        self.exchange()
        for fmu in self.fmus:
            assert fmu.start() == OK, fmu.log
        self.update()
        self.places = [slice(a, b) for a, b in pairwise(np.cumsum([0, *(fmu.nx for fmu in self.fmus)]))]

    def first(self, i, group):
        return sum(layout.size for layout in self.components[i].layouts[:group])

    def exchange(self):
        """Motions of the bodies to the hinge, and its wrenches to them."""
        hinge = self.fmus[2]
        motions = [self.fmus[i].get(self.first(i, 2), 13) for i in (0, 1)]
        assert hinge.set(self.first(2, 1), np.concatenate(motions)) == OK
        wrenches = hinge.get(self.first(2, 2), 12)
        for i in (0, 1):
            assert self.fmus[i].set(self.first(i, 1), wrenches[6 * i : 6 * i + 6]) == OK

    def update(self):
        """The event that is due now in all of them."""
        for fmu in self.fmus:
            assert fmu.call("newDiscreteStates") == OK, fmu.log
            assert fmu.call("enterContinuousTimeMode") == OK, fmu.log
        self.exchange()

    def put(self, time, states):
        for fmu, place in zip(self.fmus, self.places, strict=True):
            assert fmu.call("setTime", time) == OK
            assert fmu.move(states[place]) == OK
        self.exchange()

    def rates(self, time, states):
        self.put(time, states)
        return np.concatenate([fmu.rates() for fmu in self.fmus])

    def distance(self, time, states):
        self.put(time, states)
        return self.fmus[2].indicators()[0]

    def observed(self, time, states):
        self.put(time, states)
        return [
            fmu.get(self.first(i, 3), self.components[i].layouts[3].size) for i, fmu in enumerate(self.fmus)
        ]

    def run(self, times):
        """Observations at the times, and the times of events."""
        now, states, events, rows = times[0], np.concatenate([fmu.states() for fmu in self.fmus]), [], []
        crossing = lambda t, s: self.distance(t, s)  # noqa: E731
        crossing.terminal = True
        while now < times[-1]:
            tolerances = {"method": "DOP853", "rtol": 1e-8, "atol": 1e-10}
            found = solve_ivp(
                self.rates, (now, times[-1]), states, events=crossing, dense_output=True, **tolerances
            )
            rows += [self.observed(t, found.sol(t)) for t in times if now <= t <= found.t[-1]]
            now, states = found.t[-1], found.y[:, -1]
            self.put(now, states)
            if found.status == 1:
                events.append(now)
                for fmu in self.fmus:
                    assert fmu.call("completedIntegratorStep") == OK, fmu.log
                    assert fmu.call("enterEventMode") == OK, fmu.log
                self.update()
        return rows, events


def differences(folder):
    line = HingeLine("line", ("hinge",), "hinge", latches=True, kinematic=False)
    links = between("hinge", "spacecraft.root", "panel.root")
    settings = Settings(tolerance=1e-8, fixed_step=2.5e-4)
    run = completed(END, parts("mean"), links, [line], settings=settings, native=True)
    monolith = Monolith(folder)
    instants = [time for time, _, _ in run.events]
    # a torque that jumps at latch-up has two values then
    after = [i for i, t in enumerate(run.times) if all(abs(t - instant) > 5e-4 for instant in instants)][::4]
    rows, events = monolith.run([run.times[i] for i in after])
    assert len(rows) == len(after), (len(rows), len(after))
    found = {"latch_times": [events, instants]}
    for i, name in enumerate(("spacecraft", "panel", "hinge")):
        layout = monolith.components[i].layouts[3]
        for quantity in COMPARED.get(name, ()):
            mine = np.array([row[i][layout[quantity]] for row in rows])
            theirs = run.signal(name, quantity).reshape(len(run.times), -1)[after]
            found[f"{name}.{quantity}"] = float(np.abs(mine - theirs).max() / np.abs(theirs).max())
    return found


if __name__ == "__main__":
    print("\n" + json.dumps(differences(sys.argv[1])))
