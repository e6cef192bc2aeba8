"""Connections of a scene as parts: hinges share line totals, latches suit their neighbours' fidelity."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from math import sqrt
from typing import Literal, NamedTuple

import numpy as np

from components.contract.frames import Vector3, rotate
from components.tape_hinge import TapeHinge

from ..scene.component_connections import WrenchMode
from ..scene.connection_tables import Ccl, Damper
from ..scene.hinge_line_tables import Friction, Hinge, HingeLine, Joint, MeasuredLatch, TorqueLoop
from ..scene.loops.coupled_lines import rates_with
from ..scene.placed_scene import PlacedScene
from . import HingeLine as AssemblyHingeLine
from . import Part
from .locked_at_start import bolted_lines
from .sticking import sticking

_NEGLIGIBLE = 1e-3
"""Share of a line's compliance below which the bodies are taken to hold all of it."""
_FAR_OFF = 3.0
"""Times what a measured curve of hinges has at the most, or below it at the least, that is told."""


class LatchSetting(NamedTuple):
    """How a line latches: kind, totals of a spring's stiffness (N.m/rad) and damping (N.m.s/rad), measured curve.

    inertia: effective one of the line (kg.m2), where it has a latch. straight: whether the curve is that of a spring
    with play.
    """

    kind: Literal["none", "spring", "table", "kinematic"]
    stiffness: float
    damping: float
    measured: MeasuredLatch | None = None
    inertia: float | None = None
    straight: bool = False


def line_latch(
    scene: PlacedScene, line: HingeLine, flexible: Mapping[str, bool], mode: WrenchMode
) -> LatchSetting:
    """The latch of a line (Bagnoli 2007, sections 3.3.5 and 3.4.3.3).

    The spring has the compliance that the bodies' models lack, by equation 2.7; where they lack none the latch is
    kinematic, and where they lack just that of the hinges it follows their measured torque, if there is one.
    The spacecraft, rigid at every fidelity, lacks no compliance but what is stated of it. Explicit hosts cannot lock:
    there a kinematic latch is a spring of the whole line, and so is everywhere a latch with play that would lock.
    Structural damping takes the place of the latch's own; that of a measured curve is constant, by the stiffness that
    the bodies' models lack.
    """
    latch = line.latch
    if latch is None:
        return LatchSetting("none", 0.0, 0.0)
    inertia = latch.effective_inertia or scene.effective_inertia(line)
    sides = [
        (stiffness, flexible[body] if body != scene.base.name else stiffness is None)
        for body, stiffness in (
            (line.inboard, latch.inboard_stiffness),
            (line.outboard, latch.outboard_stiffness),
        )
    ]
    modelled = sum(1.0 / stiffness for stiffness, has_it in sides if has_it and stiffness is not None)
    missing = 1.0 / latch.stiffness - modelled
    locks = latch.kind == "kinematic" or (
        latch.kind == "by_fidelity" and missing * latch.stiffness < _NEGLIGIBLE
    )
    low, high = latch.loose
    if locks and mode == "mean" and low == high:
        return LatchSetting("kinematic", 0.0, 0.0, inertia=inertia)
    stiffness = latch.stiffness if locks or latch.kind == "spring" else 1.0 / missing
    structural = scene.structural_damping
    own = 2.0 * latch.damping_ratio * sqrt(stiffness * inertia)
    damping = own if structural is None else structural.time * stiffness
    only_hinges = latch.kind == "by_fidelity" and all(has_it for _, has_it in sides)
    if latch.measured is not None and only_hinges:
        return LatchSetting("table", stiffness, damping, latch.measured, inertia)
    if low == high:
        return LatchSetting("spring", stiffness, damping, inertia=inertia)
    curve = MeasuredLatch.model_construct(  # of numbers in rad, not of what a person writes
        deflection=(low - 1.0, low, high, high + 1.0), torque=(-stiffness, 0.0, 0.0, stiffness)
    )
    return LatchSetting("table", stiffness, damping, curve, inertia, straight=True)


def unfollowed_curves(scene: PlacedScene, flexible: Collection[str]) -> Iterator[str]:
    """Sentences on measured latches whose torque a run with these bodies flexible does not follow."""
    bodies = {body.name: body.name in flexible for body in scene.bodies}
    for line in scene.hinge_lines:
        if line.latch is None or line.latch.measured is None:
            continue
        setting = line_latch(scene, line, bodies, "mean")
        if setting.kind != "table" or setting.straight:
            place = (
                "it locks"
                if setting.kind == "kinematic"
                else f"a spring of {setting.stiffness:.4g} N.m/rad acts{' beyond the play' * setting.straight}"
            )
            yield (
                f"hinge_line.{line.name}.latch.measured: the curve is not used, because {line.inboard} or "
                f"{line.outboard} is rigid or latch.kind is another one; {place} instead. Set the fidelity of both "
                "bodies, or latch.kind."
            )


def contradicted_curves(scene: PlacedScene) -> Iterator[str]:
    """Sentences on measured latches far from what the stiffnesses leave for the hinges, by which they are damped."""
    for line in scene.hinge_lines:
        latch = line.latch
        if latch is None or latch.measured is None:
            continue
        sides = [side for side in (latch.inboard_stiffness, latch.outboard_stiffness) if side is not None]
        missing = 1.0 / latch.stiffness - sum(1.0 / side for side in sides)
        slopes = np.diff(latch.measured.torque) / np.diff(latch.measured.deflection)
        slopes = slopes[slopes > 0.0]
        if missing * latch.stiffness < _NEGLIGIBLE:
            continue
        if not slopes.min() / _FAR_OFF < 1.0 / missing < _FAR_OFF * slopes.max():
            yield (
                f"hinge_line.{line.name}.latch: its stiffnesses leave {1.0 / missing:.4g} N.m/rad for the hinges, "
                f"but the measured curve has {slopes.min():.4g} to {slopes.max():.4g} N.m/rad. Use values of the "
                "same hinges."
            )


def assembly_lines(
    scene: PlacedScene, flexible: Mapping[str, bool], mode: WrenchMode
) -> tuple[AssemblyHingeLine, ...]:
    """What the master and the key figures need to know of the lines that move."""
    bolted, groups = bolted_lines(scene), scene.group_roots
    found = []
    for line in (line for line in scene.hinge_lines if not line.held):
        latch = line_latch(scene, line, flexible, mode)
        found.append(
            AssemblyHingeLine(
                line.name,
                tuple(hinge.name for hinge in line.hinges),
                line.sensor,
                latches=latch.kind != "none",
                kinematic=latch.kind == "kinematic",
                rigid=not any(flexible.get(body, False) for body in (line.inboard, line.outboard)),
                deployed_angle=line.deployed_angle if line.is_open_ended else None,
                tapes=_tapes(scene, line),
                parts=(groups[line.inboard], groups[line.outboard]),
                axis=rotate(scene.poses[line.inboard].orientation, line.axis),
                bolted=line.name in bolted,
                known=_known(line),
                coupled=rates_with(scene.coupled_lines, line.name),
                inertia=latch.inertia,
            )
        )
    return tuple(found)


def _tapes(scene: PlacedScene, line: HingeLine) -> tuple[str, ...]:
    """Tape springs between the bodies of a line."""
    tapes = (one for one in scene.connections if one.kind == TapeHinge.kind)
    ends = {line.inboard, line.outboard}
    return tuple(one.name for one in tapes if {seat.body for seat in one.ports.values()} == ends)


def _known(line: HingeLine) -> tuple[float, ...]:
    """The range (rad) of a line's way and of what all tables of its motor and harness tell; empty without any."""
    tables = [one.angle for one in (line.motor, line.harness) if one is not None and one.angle]
    if not tables:
        return ()
    low, high = max(table[0] for table in tables), min(table[-1] for table in tables)
    return min(low, line.initial_angle, line.deployed_angle), max(
        high, line.initial_angle, line.deployed_angle
    )


def hinge_parts(
    scene: PlacedScene, line: HingeLine, latch: LatchSetting, flexible: Mapping[str, bool], mode: WrenchMode
) -> tuple[Part, ...]:
    """Hinges of a line, each with its share of the line's totals."""
    share, sticks = 1.0 / len(line.hinges), sticking(scene, line)
    next_to_flexible = flexible.get(line.inboard, False) or flexible.get(line.outboard, False)
    start: dict[str, float | Vector3] = {
        "aligned_angle": line.aligned_angle,
        "stowed_angle": line.initial_angle,
        "latch_angle": line.deployed_angle,
        "latch_stiffness": share * latch.stiffness,
        "latch_damping": share * latch.damping,
        "latch_automatic": float(mode == "endpoint"),
        "friction_preload": share * line.friction_preload,
        "presliding_stiffness": share * sticks.stiffness,
        "presliding_damping": share * sticks.damping,
        **_motor(line, share),
        **_friction(scene.friction, bool(sticks.stiffness) or next_to_flexible),
    }
    damping = (scene.structural_damping or scene.joint).time
    structure = {"axis": line.axis, "latch": latch.kind, "wrench_mode": mode, **_measured(latch, share)}
    return tuple(
        Part(
            hinge.name,
            "hinge",
            structure | _tables(line, hinge),
            start | _bushing(scene.joint, hinge, damping),
        )
        for hinge in line.hinges
    )


def _measured(latch: LatchSetting, share: float) -> dict[str, tuple[float, ...] | bool]:
    if latch.measured is None:
        return {}
    torque = tuple(share * value for value in latch.measured.torque)
    found = {"latch_deflection": latch.measured.deflection, "latch_torque": torque}
    return found | ({"latch_straight": True} if latch.straight else {})


def _motor(line: HingeLine, share: float) -> dict[str, float]:
    """The share of a spring, or of a constant torque."""
    if line.motor is None or line.motor.angle or line.motor.stowed is None or line.motor.deployed is None:
        return {}
    rate = (line.motor.stowed - line.motor.deployed) / (line.deployed_angle - line.stowed_angle)
    if rate == 0.0:
        return {"motor_constant_torque": share * line.motor.stowed}
    return {"motor_stiffness": share * rate, "motor_wind_up": line.stowed_angle + line.motor.stowed / rate}


def _friction(friction: Friction, is_widened: bool) -> dict[str, float]:
    factor = friction.flexible_stiction_factor if is_widened else 1.0
    return {
        "friction_coefficient": friction.coefficient,
        "static_friction_ratio": friction.static_ratio,
        "pin_radius": friction.pin_radius,
        "friction_bending_arm": friction.bending_arm,
        "stiction_velocity": factor * friction.stiction_velocity,
    }


def _tables(line: HingeLine, hinge: Hinge) -> dict[str, tuple[float, ...]]:
    """Tables of motor and harness at a hinge, opening torques, and of their hysteresis; only some carry the harness."""
    loops = {}
    if line.motor is not None and line.motor.loop is not None:
        loops["motor"] = line.motor.loop.shared(len(line.hinges))
    if line.harness is not None and hinge.harness:
        loops["harness"] = line.harness.loop.shared(sum(other.harness for other in line.hinges))
    found: dict[str, tuple[float, ...]] = {}
    for name, loop in loops.items():
        found |= {f"{name}_angle": loop.angle, f"{name}_torque": loop.mean}
    return found | _hysteresis([loop for loop in loops.values() if any(loop.half)])


def _hysteresis(loops: Sequence[TorqueLoop]) -> dict[str, tuple[float, ...]]:
    """Their sum over the angles of both, straight between each one's own."""
    if not loops:
        return {}
    angle = np.unique(np.concatenate([loop.angle for loop in loops]))
    half = np.sum([np.interp(angle, loop.angle, loop.half) for loop in loops], axis=0)
    return {"hysteresis_angle": tuple(angle.tolist()), "hysteresis_torque": tuple(half.tolist())}


def _bushing(joint: Joint, hinge: Hinge, time: float) -> dict[str, float | Vector3]:
    """Stiffness, damping in proportion to it by a time (s), and clearances."""
    translational, rotational = hinge.stiffnesses(joint)
    return {
        "translational_stiffness": translational,
        "translational_damping": _scaled(time, translational),
        "rotational_stiffness": rotational,
        "rotational_damping": _scaled(time, rotational),
        **hinge.clearances(joint),
    }


def _scaled(factor: float, v: Vector3) -> Vector3:
    return (factor * v[0], factor * v[1], factor * v[2])


def loop_part(loop: Ccl, mode: WrenchMode) -> Part:
    """A cable loop; preload and stiffness are those of one strand."""
    return Part(
        loop.name,
        "ccl",
        {"axis": loop.axis, "guided": loop.guide is not None, "wrench_mode": mode},
        {
            "radius_1": loop.pulley_1.radius,
            "radius_2": loop.pulley_2.radius,
            "preload": loop.preload,
            "strand_stiffness": loop.strand_stiffness,
            "strand_damping": loop.strand_damping,
        },
    )


def damper_part(scene: PlacedScene, damper: Damper, mode: WrenchMode) -> Part:
    """A damper about the line of its hinge."""
    axis = next(line.axis for line in scene.hinge_lines if damper.hinge in {h.name for h in line.hinges})
    return Part(
        damper.name,
        "eddy_current_damper",
        {"axis": axis, "wrench_mode": mode},
        {"damping_coefficient": damper.damping_coefficient, "peak_rate": damper.peak_rate},
    )
