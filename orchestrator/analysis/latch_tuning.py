"""Tuning of a latch spring: the line stiffness that gives a rigid pair the frequency of the flexible one.

Bagnoli 2007, section 2.2.8 and appendix A: the two bodies of a hinge line, latched and deployed, the hinges'
translations fixed. Of the flexible pair the mode counts that is most like the turning of the rigid one. The
frequency belongs to the total stiffness where the bodies include flexible hinges, to that of the structure alone
where the hinges are rigid; equation 2.7 adds or removes the hinges' measured stiffness.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import pi, sqrt
from typing import Literal, NamedTuple

import numpy as np

from components.contract.component import Vector
from components.contract.frames import rotate
from components.contract.roles import LATCH_COMMAND

from ..assembly import Link, Part
from ..assembly.hinges import LatchSetting, hinge_parts
from ..assembly.statics.configuration import configuration
from ..assembly.statics.linear_model import LinearModel, linearise, normal_modes
from ..assembly.statics.mechanism import Mechanism
from ..records import short_repr
from ..scene import PlacedScene, SceneError
from ..scene.bodies import StartPose, body_model
from ..scene.hinge_line_tables import HingeLine

Kind = Literal["total", "structure"]


class Pair(NamedTuple):
    """Two bodies latched to each other, and their turning about the line as one coordinate."""

    model: LinearModel
    constraints: Vector
    """(r, n) rows of the hinges' translations"""
    inertias: tuple[float, float]
    """about the line, kg.m2; infinite where the inboard body is ground"""
    turning: Vector
    """(n,) opposite rotations about the line with unit modal mass"""

    @property
    def inertia(self) -> float:
        """J1 J2 / (J1 + J2), kg.m2."""
        first, second = self.inertias
        return 1.0 / (1.0 / first + 1.0 / second)

    def mode(self) -> tuple[float, float]:
        """Frequency (Hz) of the mode most like the turning, and how much of the turning it has (1: all)."""
        modes = normal_modes(self.model, self.constraints)
        overlap = (self.turning @ self.model.mass @ modes.shapes) ** 2
        overlap[modes.is_free] = 0.0
        k = int(np.argmax(overlap))
        return float(modes.frequencies[k]), float(overlap[k])


def pair(scene: PlacedScene, line: HingeLine, flexible: Mapping[str, bool], stiffness: float | None) -> Pair:
    """The pair of a line, its latch a spring of the given total stiffness (N.m/rad), or locked where that is None."""
    poses = scene.with_angles(configuration(scene, "deployed").angles).poses
    bodies = {
        name: _body_part(scene, name, line, side, flexible.get(name, False), poses[name])
        for name, side in ((line.inboard, "inboard"), (line.outboard, "outboard"))
    }
    bare = line.model_copy(
        update={
            "motor": None,
            "harness": None,
            "start_angle": line.deployed_angle,
            "hinges": tuple(hinge.model_copy(update={"harness": False}) for hinge in line.hinges),
        }
    )
    latch = (
        LatchSetting("kinematic", 0.0, 0.0) if stiffness is None else LatchSetting("spring", stiffness, 0.0)
    )
    hinges = hinge_parts(scene, bare, latch, flexible, "mean")
    links = [
        Link((body, hinge.name), (hinge.name, side))
        for hinge in line.hinges
        for body, side in ((line.inboard, "inboard"), (line.outboard, "outboard"))
    ]
    ground = bodies[line.inboard].kind == "fixed_base"
    mechanism = Mechanism([*bodies.values(), *hinges], links, line.inboard if ground else "")
    mechanism.command(LATCH_COMMAND.name, 1.0, mechanism.connections)
    return _pair(mechanism, line)


def _body_part(
    scene: PlacedScene, name: str, line: HingeLine, side: str, flexible: bool, pose: StartPose
) -> Part:
    """A body of the pair with a port at every hinge of the line."""
    seats = {hinge.name: getattr(hinge, side) for hinge in line.hinges}
    bodies = {body.name: body for body in scene.bodies}
    data = body_model(bodies[name], flexible) if name in bodies else scene.rigid_models.get(name)
    if data is None:
        ports = [{"name": hinge, "position": scene.base.points[point]} for hinge, point in seats.items()]
        return Part(name, "fixed_base", {"ports": ports}, {})
    structure = {
        "modal": data.to_arrays(),
        "ports": [{"name": hinge, "point": point} for hinge, point in seats.items()],
    }
    return Part(
        name, "body", structure, {"initial_position": pose.position, "initial_orientation": pose.orientation}
    )


def _pair(mechanism: Mechanism, line: HingeLine) -> Pair:
    model = linearise(mechanism)
    motion = mechanism.connections[line.hinges[0].name].motions[0]
    w, x, y, z = motion[3:7].tolist()
    axis = np.array(rotate((w, x, y, z), line.axis))
    inertias, turns = [], []
    for name in (line.inboard, line.outboard):
        turn = np.zeros(len(model.mass))
        start, body = mechanism.rows[name].start, mechanism.bodies[name]
        turn[start : start + 3] = np.cross(axis, body.position - motion[:3])
        turn[start + 3 : start + 6] = axis
        turns.append(turn)
        inertias.append(float(turn @ model.mass @ turn) if body.body is not None else float("inf"))
    share = 1.0 / (1.0 + inertias[1] / inertias[0])  # of the outboard body in the opening of the line
    turning = share * turns[1] - (1.0 - share) * turns[0]
    turning /= sqrt(turning @ model.mass @ turning)
    rows = [mechanism.jacobian(hinge.name, port)[:3] for hinge in line.hinges for port in (0, 1)]
    return Pair(model, np.concatenate(rows), (inertias[0], inertias[1]), turning)


def series(*stiffnesses: float) -> float:
    """Stiffness of springs in series (equation 2.7)."""
    return 1.0 / sum(1.0 / stiffness for stiffness in stiffnesses)


def without(total: float, part: float) -> float:
    """What is in series with a part (N.m/rad) in a total; SceneError where the part is not stiffer than the total."""
    if part <= total:
        raise SceneError(
            [
                f"the stiffness of the hinges, {part:.6g} N.m/rad, must be above the total {total:.6g} N.m/rad that "
                "they are part of; if the frequency is that of the structure alone, ask for that of the structure"
            ]
        )
    return 1.0 / (1.0 / total - 1.0 / part)


def augmented_rotation(
    deflection: Sequence[float], torque: Sequence[float], structure: float
) -> tuple[float, ...]:
    """Deflections (rad) of a line at the torques (N.m) of its hinges' measured curve, the structure's added.

    Bagnoli 2007, figure 2.2.8-2: a hinge law in series with the structure's stiffness (N.m/rad).
    """
    return tuple(angle + load / structure for angle, load in zip(deflection, torque, strict=True))


@short_repr
@dataclass(frozen=True, slots=True)
class Tuning:
    """Stiffnesses (N.m/rad) of a line; those that need the hinges' are None without it."""

    line: str
    bodies: tuple[str, str]
    """inboard and outboard"""
    at_base: bool
    """whether the inboard body is the base"""
    inertias: tuple[float, float]
    inertia: float
    frequency: float
    """Hz, that is to be met"""
    overlap: float | None
    """share of the turning in the flexible pair's mode"""
    total: float | None
    structure: float | None
    hinges: float | None
    springs: int
    """that share a stiffness, one a hinge"""
    check: float
    """Hz of the rigid pair with the tuned stiffness, from its linear model"""
    law: tuple[tuple[float, float], ...] = ()
    """deflections (rad) and torques (N.m) of the line's measured curve, the structure's rotation added"""

    @property
    def scope(self) -> str:
        """What the stiffness is tuned for, in a sentence."""
        inboard, outboard = self.bodies
        if self.at_base:
            return f"tuned for {inboard} and {outboard} alone; the rest of the wing is not part of the pair"
        return (
            f"tuned for {inboard} and {outboard} alone, turning about the hinge line between them, whose place is "
            "held; the rest of the wing is not part of the pair"
        )

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        first = self.inertias[0]
        angles, torques = zip(*self.law, strict=True) if self.law else ((), ())
        law = {"latch_law": {"deflection_rad": angles, "torque_nm": torques}} if self.law else {}
        return {
            "line": self.line,
            "inboard_inertia_kgm2": first if np.isfinite(first) else None,
            "outboard_inertia_kgm2": self.inertias[1],
            "effective_inertia_kgm2": self.inertia,
            "frequency_hz": self.frequency,
            "turning_share": self.overlap,
            "total_stiffness_nm_per_rad": self.total,
            "structure_stiffness_nm_per_rad": self.structure,
            "hinge_stiffness_nm_per_rad": self.hinges,
            "springs": self.springs,
            "check_frequency_hz": self.check,
            **law,
        }


def tune(
    scene: PlacedScene,
    line: HingeLine,
    flexible: Mapping[str, bool],
    frequency: float | None = None,
    kind: Kind | None = None,
    hinges: float | None = None,
) -> Tuning:
    """Tune the latch spring of a line to a frequency (Hz), by default that of the flexible pair.

    kind: what the frequency belongs to, by default "total" if it is given and "structure" if it is that of the
    flexible pair, whose hinges are locked. hinges: measured stiffness of the line's hinges together, N.m/rad.
    SceneError where a body of the pair is part of a held piece.
    """
    _refuse_held(scene, line)
    kind = kind or ("structure" if frequency is None else "total")
    overlap = None
    if frequency is None:
        if not any(flexible.get(name, False) for name in (line.inboard, line.outboard)):
            raise SceneError(
                [
                    f"{scene.file}: hinge_line.{line.name}: {line.inboard} and {line.outboard} are rigid, so there is "
                    "no frequency to tune to; give a frequency, or make one of them flexible"
                ]
            )
        frequency, overlap = pair(scene, line, flexible, None).mode()
    rigid = pair(scene, line, {}, 1.0)
    tuned = (2.0 * pi * frequency) ** 2 * rigid.inertia
    check = pair(scene, line, {}, tuned).mode()[0]
    total, structure = (tuned, None) if kind == "total" else (None, tuned)
    if hinges is not None:
        structure = without(tuned, hinges) if kind == "total" else tuned
        total = tuned if kind == "total" else series(tuned, hinges)
    found = Tuning(
        line.name, (line.inboard, line.outboard), line.inboard == scene.base.name, rigid.inertias, rigid.inertia,
        frequency, overlap, total, structure, hinges, len(line.hinges), check,
    )  # fmt: skip
    return replace(found, law=tuple(latch_law(line, found)))


def _refuse_held(scene: PlacedScene, line: HingeLine) -> None:
    """A held piece turns as a whole; single bodies would give its inertia wrongly."""
    held = scene.locked_bodies
    problems = [
        f"{scene.file}: hinge_line.{line.name}: {body} is part of a piece that held hinge lines join, and latch-tuning "
        "takes single bodies; leave these lines free for it (held = false)"
        for body in (line.inboard, line.outboard)
        if body in held
    ]
    if problems:
        raise SceneError(problems)


def find_line(scene: PlacedScene, name: str) -> HingeLine:
    """The line of a name; SceneError where there is none."""
    lines = {line.name: line for line in scene.hinge_lines}
    if name not in lines:
        raise SceneError([f"{scene.file}: there is no hinge line {name!r}; lines are {', '.join(lines)}"])
    return lines[name]


def latch_law(line: HingeLine, tuning: Tuning) -> list[tuple[float, float]]:
    """Deflections (rad) and torques (N.m) of the line's measured curve with the structure's rotation added."""
    curve = line.latch.measured if line.latch is not None else None
    if curve is None or tuning.structure is None:
        return []
    angles = augmented_rotation(curve.deflection, curve.torque, tuning.structure)
    return list(zip(angles, curve.torque, strict=True))
