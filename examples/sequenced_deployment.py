"""How a sequencer of another tool deploys a wing: the outer panel first, then, when that stands, the inner one."""

from pathlib import Path

from pythonfmu.builder import FmuBuilder

import orchestrator as fanfold

SEQUENCER = Path(__file__).parent / "controllers" / "deployment_sequencer.py"
fmu = FmuBuilder.build_FMU(str(SEQUENCER), dest=".")

wing = fanfold.Scene("sequenced", until="12 s")
wing.base("spacecraft", points={"root": (0, 0, 0), "seat": (0.9, 0, 0)})
panel = {"mass": "2 kg", "center_of_mass": (0.5, 0, 0), "inertia": (0.12, 0.18, 0.28)}
places = {"inner": (0, 0, 0), "outer": (1, 0, 0), "bolt": (0.9, 0, 0), "back": (0.1, 0, 0)}
for name in ("panel1", "panel2"):
    wing.body(name, rigid=panel | {"points": places})
common = {"axis": "+y", "motor": {"stowed": "0.2 N.m", "deployed": "0.2 N.m"}}
wing.hinge_line(
    "HL1", "spacecraft", "panel1", aligned_angle="90 deg", latch={"stiffness": 3000.0},
    hinges={"h1": ("root", "inner")}, **common,
)  # fmt: skip
wing.hinge_line(
    "HL2", "panel1", "panel2", aligned_angle="180 deg", latch={"stiffness": 3000.0},
    hinges={"h2": ("outer", "inner")}, **common,
)  # fmt: skip
for bolt, body, point, other in (
    ("bolt1", "spacecraft", "seat", "panel1"),
    ("bolt2", "panel1", "back", "panel2"),
):
    ports = {"inboard": {"body": body, "point": point}, "outboard": {"body": other, "point": "bolt"}}
    wing.connection(bolt, "hold_down", ports=ports)
wing.fmu(
    "sequencer", fmu, step="50 ms", inputs={"angle": "HL2.angle"},
    outputs={"fire_outer": "bolt2.release_command", "fire_inner": "bolt1.release_command"},
)  # fmt: skip
run = fanfold.simulate(wing, estimate=False)
for time, name, what in run.events:
    print(f"{time:.3f} s  {name}: {what}")
