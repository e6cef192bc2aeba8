"""Torques of the hinges of a scene over the travel, from the components themselves in static equilibrium.

At every position the lines with a motor, and those that cable loops or gears couple to them, stand at the same share
of their travel, and the scene is brought to static equilibrium with all hinges held: cables at their preload, gravity
if there is any. Each hinge is then asked for its torques while it opens slowly from there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Literal

import numpy as np

from components.contract.frames import Vector3, rotate
from components.hinge import Hinge

from ...assembly import Assembly, Part
from ...assembly.assemble import assemble
from ...assembly.locked_at_start import bolts_across, without_bolts
from ...assembly.statics.start import static_start
from ...cosim.coupling import StepError
from ...cosim.master import Master
from ...cosim.network import Network, NetworkError
from ...cosim.participant import InProcess, Participant, ParticipantError, Vector
from ...cosim.settings import Settings
from ...results.recorder import NoRecorder
from ...run.run import Loader, RunError, kept_fmus
from ...scene import PlacedScene
from ...scene.hinge_line_tables import HingeLine
from ...scene.table import SceneError
from ...scene.units import degrees_text
from .rules import GroupTorques, LineTorques
from .undriven import MOTOR_TORQUE, margin_groups, motors, with_motor

FrictionKind = Literal["constant", "sliding", "static"]
_SLIDING = 2.0
"""Rate, in stiction velocities, of sliding friction; the static value is at 1 (components.numerics.laws)."""
_TORN = 1e-3
"""m or rad, that a joint of a loop may be open by on the way."""
_OBSERVED = ("motor_torque", "harness_torque", "friction_torque")


def driven_lines(scene: PlacedScene) -> list[HingeLine]:
    """Lines that move and have a motor; SceneError if there are none."""
    lines = with_motor(scene)
    if not lines:
        raise SceneError(
            [
                f"{scene.file}: no hinge line that moves has a motor, so there is no torque margin; give a line a "
                "motor, or set held = false"
            ]
        )
    return lines


def opened_lines(scene: PlacedScene) -> list[HingeLine]:
    """Lines with a motor, and those that cable loops or gears couple to them; SceneError if there are none."""
    names = {line.name for line in driven_lines(scene)}.union(*(g.rates for g in margin_groups(scene)))
    return [line for line in scene.hinge_lines if line.name in names]


def grouped(scene: PlacedScene, torques: Mapping[str, LineTorques]) -> list[GroupTorques]:
    """Torques of coupled lines together, from those of every line that opens."""
    return [
        GroupTorques(tuple(torques[name] for name in group.rates), group.rates)
        for group in margin_groups(scene)
    ]


def travel(scene: PlacedScene, line: HingeLine) -> float:
    """Way of a line (rad) from its start to its deployed angle; SceneError where none is left."""
    way = line.deployed_angle - line.initial_angle
    if way <= 0.0:
        raise SceneError(
            [
                f"{scene.file}: hinge_line.{line.name}: starts at or beyond its deployed angle; no travel is left"
            ]
        )
    return way


def at_share(scene: PlacedScene, share: float) -> PlacedScene:
    """The scene with every line that opens at a share (0 to 1) of its way from its start to its deployed angle.

    Hold-downs across lines on their way have let go.
    """
    opened = {line.name for line in opened_lines(scene)}
    lines = [
        line.model_copy(update={"start_angle": _angle(line, share)}) if line.name in opened else line
        for line in scene.hinge_lines
    ]
    moved = replace(scene, hinge_lines=tuple(lines))
    return without_bolts(moved, bolts_across(scene, opened)) if share > 0.0 else moved


def _angle(line: HingeLine, share: float) -> float:
    """Angle (rad) at a share of the way; a line without a way left stays where it is."""
    return line.initial_angle + share * max(0.0, line.deployed_angle - line.initial_angle)


def sweep(
    scene: PlacedScene,
    shares: Sequence[float],
    friction: FrictionKind,
    extra: Mapping[str, Mapping[str, float]],
) -> list[LineTorques]:
    """Torques of every line that opens at shares of the travel; extra: further torques (N.m) by line and symbol.

    friction: "constant" is the preload torque alone; "sliding" and "static" add the friction of the reactions,
    mu r_p F_r (Bagnoli 2007, equation 2.2), with the sliding or the static coefficient.
    """
    for line in driven_lines(scene):
        travel(scene, line)  # refuses one that has none left
    for share in shares:
        _refuse_torn(scene, share)
    with kept_fmus() as load:
        found = [_torques(at_share(scene, share), friction, load) for share in shares]
    result = []
    for line in opened_lines(scene):
        angle = np.array([_angle(line, share) for share in shares])
        motor, harness, resisting = np.array([torques[line.name] for torques in found]).T
        result.append(LineTorques(line.name, angle, motor, harness, resisting, extra.get(line.name, {})))
    return result


def _refuse_torn(scene: PlacedScene, share: float) -> None:
    """SceneError where a loop of lines does not close with those that open at a share of their travel."""
    there = at_share(scene, share)
    found = {**there.left_open, **there.closed.open_by}
    name, size = max(found.items(), key=lambda item: item[1], default=("", 0.0))
    if size > _TORN:
        sweeps = " ".join(
            f"--sweep {line.name}={degrees_text(line.initial_angle, 2)}deg:{degrees_text(line.deployed_angle, 2)}deg"
            for line in opened_lines(scene)
        )
        raise SceneError(
            [
                f"{scene.file}: connection.{name}: with the driven lines at {share:.0%} of their travel it is open by "
                f"{1e3 * size:.3g} mm (or mrad): lines without a motor close a loop with them, and how these follow "
                "is no part of a torque margin; the torque that each position leaves or asks for is the holding "
                f"torque of `analyse equilibrium {sweeps}`"
            ]
        )


def _torques(scene: PlacedScene, friction: FrictionKind, load: Loader) -> dict[str, Vector]:
    """Motor, harness and friction torque (3,) of every line that opens where it stands, sums over its hinges."""
    assembly = assemble(scene, rigid={"all"})
    parts = {part.name: part for part in assembly.parts}
    with _equilibrium(assembly, load) as settled:
        found = {
            line.name: sum(
                (
                    _opening_torques(parts[hinge.name], line.axis, settled[hinge.name], friction)
                    for hinge in line.hinges
                ),
                start=np.zeros(len(_OBSERVED)),
            )
            for line in opened_lines(scene)
        }
        for motor, names in motors(scene).items():
            place = settled[motor].observation_layout[MOTOR_TORQUE]
            for name in names:
                found[name][0] += float(settled[motor].observe()[place][0])
    return found


@contextmanager
def _equilibrium(assembly: Assembly, load: Loader) -> Iterator[dict[str, Participant]]:
    """Every FMU by name, in static equilibrium with all hinges held; RunError where there is none."""
    # wherever lines are on their way, nothing else keeps them there
    lines = tuple(replace(line, bolted=False) for line in assembly.hinge_lines)
    try:
        start = static_start(replace(assembly, hinge_lines=lines, preload=True)).assembly
    except SceneError as error:
        raise RunError(f"{assembly.name}: no static equilibrium with the hinges held: {error}") from None
    with load(start) as participants:
        try:
            network = Network(participants, start.links)
            Master(network, lines, NoRecorder(), Settings()).initialize(preload=True)
        except (ParticipantError, NetworkError, StepError) as error:
            raise RunError(f"{assembly.name}: {error}") from None
        yield {participant.name: participant for participant in participants}


def _opening_torques(part: Part, axis: Vector3, settled: Participant, friction: FrictionKind) -> Vector:
    """Motor, harness and friction torque (3,) of a hinge in its pose in equilibrium, opening slowly.

    The end-point form of the component gives the torques of an instant; no torque depends on the rate but the
    friction, whose law says at which rate it slides.
    """
    hinge = Hinge(**{**part.structure, "wrench_mode": "endpoint"})
    coefficient = {"friction_coefficient": 0.0} if friction == "constant" else {}
    sliding = {"presliding_stiffness": 0.0}
    slow = InProcess(part.name, hinge, {**part.start, **coefficient, **sliding})
    layout, known = hinge.input_layout, settled.input_layout
    for quantity in layout.quantities:  # of an instant there are fewer than of a step
        slow.inputs[layout[quantity.name]] = settled.inputs[known[quantity.name]]
    for port in ("inboard", "outboard"):
        slow.inputs[layout[f"{port}.velocity"]] = 0.0
        slow.inputs[layout[f"{port}.angular_velocity"]] = 0.0
    w, x, y, z = (float(v) for v in slow.inputs[layout["inboard.orientation"]])
    transition = float(np.ravel(part.start["stiction_velocity"])[0])
    rate = transition * (1.0 if friction == "static" else _SLIDING)
    slow.inputs[layout["outboard.angular_velocity"]] = rate * np.array(rotate((w, x, y, z), axis))
    slow.initialize(0.0)
    seen = slow.observe()
    return np.concatenate([seen[hinge.observation_layout[name]] for name in _OBSERVED])
