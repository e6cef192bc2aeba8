"""Small scenes whose motors are 1 % above or below friction: one line, and lines that cable loops couple."""

from __future__ import annotations

from typing import NamedTuple

from orchestrator.scene.builder import Scene

_EQUAL, _GEARED = (60.0, 60.0), (60.0, 30.0)
"""Radii (mm) of the pulleys at a line and at the next, which turns as fast, or twice as fast."""


class Balance(NamedTuple):
    """A chain of lines, with the torques (N.m) of their motors and frictions, and whether it opens from rest.

    radii: of both pulleys (mm) of the loop from each line to the next.
    """

    name: str
    motors: tuple[float, ...]
    frictions: tuple[float, ...]
    radii: tuple[tuple[float, float], ...]
    opens: bool


def _balances(factor: float, opens: bool) -> list[Balance]:
    """Chains in which motors give so many times what frictions take, both at the rate of the first line."""
    m, k = factor, "above" if opens else "below"
    return [
        Balance(f"single_{k}", (0.5 * m,), (0.5,), (), opens),
        Balance(f"equal_first_drives_{k}", (0.5 * m, 0.0), (0.0, 0.5), (_EQUAL,), opens),
        Balance(f"equal_second_drives_{k}", (0.0, 0.5 * m), (0.5, 0.0), (_EQUAL,), opens),
        Balance(f"equal_both_drive_{k}", (0.2 * m, 0.8 * m), (0.5, 0.5), (_EQUAL,), opens),
        Balance(f"geared_first_drives_{k}", (1.0 * m, 0.0), (0.0, 0.5), (_GEARED,), opens),
        Balance(f"geared_second_drives_{k}", (0.0, 0.5 * m), (1.0, 0.0), (_GEARED,), opens),
        Balance(f"chain_last_drives_{k}", (0.0, 0.0, 0.5 * m), (0.5, 0.25, 0.0), (_GEARED, _EQUAL), opens),
    ]


BALANCES = (*_balances(1.01, True), *_balances(0.99, False))


def balance_scene(balance: Balance) -> Scene:
    """Its scene: panels of 2 kg and 1 m on a fixed base, lines about +y and -y in turn, each with a latch."""
    scene = Scene(balance.name, until="60 s", tolerance=1e-3, preload=True)
    bodies = [scene.base("base", points={"out": (0, 0, 0)})]
    rates = [1.0]
    for first, second in balance.radii:
        rates.append(rates[-1] * first / second)
    for k, (motor, friction, rate) in enumerate(zip(balance.motors, balance.frictions, rates, strict=True)):
        points = {"in": (0, 0, 0), "out": (1, 0, 0)}
        panel = {"mass": 2, "center_of_mass": (0.5, 0, 0), "inertia": (0.12, 0.18, 0.28), "points": points}
        bodies.append(scene.body(f"panel{k}", rigid=panel))
        scene.hinge_line(
            f"L{k}", bodies[k], bodies[k + 1], axis="-y" if k % 2 else "+y", aligned_angle=f"{90.0 * rate} deg",
            hinges={f"hinge{k}": ("out", "in")}, friction_preload=friction, latch={"stiffness": 3000},
            **({"motor": {"stowed": motor, "deployed": motor}} if motor else {}),
        )  # fmt: skip
    for k, (first, second) in enumerate(balance.radii):
        scene.ccl(
            f"loop{k}", preload=200, strand_stiffness=1e5, strand_damping=20,
            pulley_1={"body": bodies[k], "point": "out", "radius": f"{first} mm"},
            pulley_2={"body": bodies[k + 2], "point": "in", "radius": f"{second} mm"},
        )  # fmt: skip
    return scene
