"""Scenes of one and two rigid panels on a fixed base that latch within five seconds, built in code."""

from __future__ import annotations

from pathlib import Path

from orchestrator.scene.builder import Scene

TWO_PANELS = Path(__file__).parents[1] / "scenes" / "two_panels.toml"
_EDGE = {"left": (0.0, 0.565, 0.0), "right": (0.0, -0.565, 0.0)}


def one_panel() -> Scene:
    """The workbench's panel as a rigid body on a fixed base; latch-up at 4.3 s."""
    scene = Scene("one_panel", until=4.6)
    base = scene.base(points=_EDGE)
    rigid = {"mass": 7.582, "center_of_mass": (0.805, 0, 0), "inertia": (1.0, 1.338, 2.2), "points": _EDGE}
    panel = scene.body("panel", rigid=rigid)
    scene.hinge_line(
        "line", base, panel, axis="-y", aligned_angle="180 deg",
        motor={"stowed": "2.304 N.m", "deployed": "1.434 N.m"}, latch=_latch(2216, 4000, 6.2514),
        hinges={"left": "left", "right": {"inboard": "right", "outboard": "right", "kind": "cylindrical"}},
    )  # fmt: skip
    return scene


def two_panels_with_latches() -> Scene:
    """Both lines latch within five seconds; the root line needs the stronger motor for it."""
    motor = {"stowed": "6 N.m", "deployed": "4 N.m"}
    root = {"name": "root_line", "motor": motor, "latch": _latch(2500, 5000, 20)}
    middle = {"name": "middle_line", "latch": _latch(1800, 4000, 2)}
    return Scene.load(TWO_PANELS, settings={"scene.until": 5.1, "hinge_line": [root, middle]})


def undamped(scene: Scene) -> Scene:
    """The scene without damping of joints, latches and modes, without friction and without damper torque."""
    lines = []
    for line in scene.tree["hinge_line"]:
        latch = {"latch": {"damping_ratio": 0.0}} if "latch" in line else {}
        lines.append({"name": line["name"], "friction_preload": 0.0, **latch})
    bodies = [{"name": b["name"], "damping_ratio": 0.0} for b in scene.tree["body"] if "catalogue" in b]
    dampers = [{"name": d["name"], "damping_coefficient": 0.0} for d in scene.tree.get("damper", [])]
    settings: dict[str, object] = {
        "joint.damping_ratio": 0.0,
        "friction.coefficient": 0.0,
        "hinge_line": lines,
    }
    settings |= {"body": bodies} if bodies else {}
    return scene.with_settings(settings | ({"damper": dampers} if dampers else {}))


def _latch(stiffness: float, outboard: float, inertia: float) -> dict[str, float]:
    return {
        "stiffness": stiffness,
        "outboard_stiffness": outboard,
        "effective_inertia": inertia,
        "damping_ratio": 0.01,
    }
