"""FMUs of another tool that have signals, and a spacecraft that one of them controls."""

from __future__ import annotations

from pathlib import Path

from pythonfmu.builder import FmuBuilder

import orchestrator as fanfold

STEP = 0.05
INERTIA = 20.0
_SLAVE = """
import os, time
from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real, String
from pythonfmu.enums import Fmi2Status


class {name}(Fmi2Slave):
    def __init__(self, **keys):
        super().__init__(**keys)
        self.angle = self.rate = self.torque = 0.0
        self.gain, self.damping, self.mode, self.label, self.on = 10.0, 40.0, 1, "nadir", True
        self.count, self.is_large = 0, False
        for name in ("angle", "rate"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        tuned = {{"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.tunable}}
        kinds = {{"gain": Real, "damping": Real, "mode": Integer, "label": String, "on": Boolean}}
        for name, kind in kinds.items():
            self.register_variable(kind(name, **tuned))
        self.register_variable(Real("torque", causality=Fmi2Causality.output))
        self.register_variable(Integer("count", causality=Fmi2Causality.output))
        self.register_variable(Boolean("is_large", causality=Fmi2Causality.output))
        self.register_variable(String("said", causality=Fmi2Causality.output, getter=lambda: "text"))

    def do_step(self, current_time, step_size):
        self.count += 1
        self.is_large = abs(self.angle) > 0.01
        self.torque = -(self.gain * self.angle + self.damping * self.rate) if self.on else 0.0
        {fault}
        return True
"""


def slave(folder: Path, name: str = "Controller", fault: str = "pass", **options: bool) -> Path:
    """A proportional and derivative controller as a PythonFMU; fault: what it does late in its steps.

    options: what it can do, by the names of its model description.
    """
    source = folder / f"{name.lower()}.py"
    source.write_text(_SLAVE.format(name=name, fault=fault), encoding="utf-8")
    return Path(FmuBuilder.build_FMU(str(source), dest=str(folder), **options))


def spacecraft(until: float = 1.0, **keys: object) -> fanfold.Scene:
    """A free spacecraft that is pushed about y, with a wheel that only an FMU drives."""
    scene = fanfold.Scene("craft", until=until, **keys)
    base = scene.base(
        "craft",
        points={"wheel": (0, 0, 0), "thruster": (1, 0, 0)},
        free={"mass": 100.0, "center_of_mass": (0, 0, 0), "inertia": (50.0, INERTIA, 50.0)},
    )
    push = [{"profile": "step5", "duration": 0.5, "change": 1.0}]
    for name, law in (("wheel", {}), ("thruster", {"torque": push})):
        scene.connection(
            name, "load", ports={"body": {"body": base, "point": name}},
            structure={"direction": (0, 1, 0), "frame": "body", **law},
        )  # fmt: skip
    return scene


def controlled(file: Path, until: float = 1.0, **keys: object) -> fanfold.Scene:
    """The same with a controller."""
    scene = spacecraft(until)
    joined = {
        "inputs": {"angle": "craft.attitude[2]", "rate": "craft.attitude_rate[2]"},
        "outputs": {"torque": "wheel.added_torque"},
    }
    scene.fmu("controller", file, **{"step": STEP, **joined, **keys})
    return scene
