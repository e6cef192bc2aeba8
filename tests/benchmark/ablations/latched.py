"""What hinges that have latched still cost: AMOS-3 from the last but one latch-up on, when only HL1 still turns.

The run goes on as it is, or yoke and panels become one rigid piece on the spot: in the pose and with the angular
momentum about HL1 that they have, beside the FMU of the yoke loop as it is, whose strands remember their start. So
with rigid bodies (HL2 and HL3 with kinematic latches, HL1 with its spring) and for the flexible wing, whose HL1
then meets a rigid one and latches by the spring that the scene has for that.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from statistics import median
from time import perf_counter
from typing import Literal, NamedTuple, get_args

import numpy as np

from components import rotation_matrix
from components.flexible.modal import ModalData
from orchestrator.assembly import Assembly, Part
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.master import Master
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import Participant
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import as_fmus
from orchestrator.scene import find_scene, load_scene
from orchestrator.scene.bodies import StartPose
from orchestrator.scene.locked_groups import joined_model, rigid_groups
from tests.benchmark.models.one_panel import crest, line_torque
from tests.references.record import Record

Fidelity = Literal["rigid", "flexible"]
UNTIL = 14.0
LATCHED, LEFT = ("HL2", "HL3"), "HL1"
PIECE = "yoke"
_SETTLED = 1e-3
"""Time after a latch-up (s) at which what follows is taken over, at the latest."""
_IMPULSE = 2e-7
"""A kinematic latch is a step of 1e-7 s, whose samples are no peak."""


class Leg(NamedTuple):
    """A run from the takeover on; wall times (s) up to HL1's latch-up and after it, its time (s), torque peak (N.m)."""

    fmus: int
    before: float
    after: float
    steps: int
    iterations: int
    latch: float
    peak: float

    @property
    def wall(self) -> float:
        """Wall time (s)."""
        return self.before + self.after


class Started(NamedTuple):
    """A run in progress: its assembly, record, master, and when (wall clock, s) every step was done, by its end."""

    assembly: Assembly
    record: Record
    master: Master
    clock: list[tuple[float, float]]


def wing(fidelity: Fidelity) -> Assembly:
    """AMOS-3; with rigid bodies the lines that latch first get kinematic latches."""
    if fidelity == "flexible":
        return assemble(load_scene(find_scene("amos3")), flexible={"all"})
    latches = [f"hinge_line.{line}.latch.kind=kinematic" for line in LATCHED]
    return assemble(load_scene(find_scene("amos3"), (), latches), rigid={"all"})


def started(assembly: Assembly, participants: Sequence[Participant], tolerance: float) -> Started:
    """A master on participants, before its initialisation."""
    clock: list[tuple[float, float]] = []
    settings = Settings(
        tolerance=tolerance,
        largest_step=assembly.largest_step,
        progress=lambda time, h: clock.append((time, perf_counter())),
    )
    network = Network(participants, assembly.links, 4)
    record = Record(network)
    return Started(assembly, record, Master(network, assembly.hinge_lines, record, settings), clock)


def _finished(run: Started) -> Leg:
    """Go on to the end and sum up."""
    done = run.master.statistics
    steps, sweeps = done.steps, done.sweeps
    run.clock.clear()
    start = perf_counter()
    run.master.run(UNTIL)
    latch = next(time for time, _, text in run.record.events if text.startswith(LEFT))
    middle = next(wall for time, wall in run.clock if time >= latch)
    times = np.array(run.record.times)
    after = times > latch + _IMPULSE
    line = [line.name for line in run.assembly.hinge_lines].index(LEFT)
    peak = crest(times[after], line_torque(run.record, run.assembly, line)[after])
    walls = middle - start, run.clock[-1][1] - middle
    return Leg(len(run.assembly.parts), *walls, done.steps - steps, done.sweeps - sweeps, latch, peak)


@contextmanager
def _taken_over(fidelity: Fidelity, tolerance: float) -> Iterator[Started]:
    """The wing just after its last but one latch-up."""
    assembly = wing(fidelity)
    with as_fmus(assembly, "native") as participants:
        run = started(assembly, participants, tolerance)
        run.master.initialize(preload=assembly.preload)
        while len(run.record.events) < len(LATCHED):
            run.master.run(run.master.time + _SETTLED)
        yield run


def as_hinges(fidelity: Fidelity, tolerance: float) -> Leg:
    """Go on with all bodies and hinges."""
    with _taken_over(fidelity, tolerance) as run:
        return _finished(run)


def as_piece(fidelity: Fidelity, tolerance: float) -> Leg:
    """Go on with one rigid piece."""
    with _taken_over(fidelity, tolerance) as run:
        bodies = [part.name for part in run.assembly.parts if part.kind == "body"]
        momentum = np.sum([run.record.signal(body, "angular_momentum")[-1] for body in bodies], axis=0)
        merged = _merged(run, momentum)
        new = replace(merged, parts=tuple(part for part in merged.parts if part.kind != "ccl"))
        kept = [run.master.network.by_name[part.name] for part in merged.parts if part.kind == "ccl"]
        for participant in kept:
            _keep_state(participant)
        with as_fmus(new, "native") as others:
            going_on = started(merged, [*others, *kept], tolerance)
            going_on.master.time = run.master.time
            going_on.master.initialize(preload=False)
            return _finished(going_on)


def _keep_state(participant: Participant) -> None:
    """Make initialisation leave a participant that is already running as it is."""
    participant.initialize = lambda time: None  # type: ignore[method-assign]


def _merged(run: Started, momentum: np.ndarray) -> Assembly:
    """The wing with its latched lines held, in the pose that it has now; friction of HL1 stays that of the run."""
    scene = load_scene(find_scene("amos3"), (), [f"hinge_line.{line}.held=true" for line in LATCHED])
    left = next(line.hinges[0].name for line in scene.hinge_lines if line.name == LEFT)
    friction = next(p.start["stiction_velocity"] for p in run.assembly.parts if p.name == left)
    update = {"stiction_velocity": friction, "flexible_stiction_factor": 1.0}
    found = assemble(replace(scene, friction=scene.friction.model_copy(update=update)))
    models = scene.rigid_models
    poses = {scene.base.name: StartPose((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))}
    for line in scene.hinge_lines:
        hinge = line.hinges[0]
        points = dict(
            zip(models[line.outboard].point_names, models[line.outboard].point_positions, strict=True)
        )
        poses[line.outboard] = _pose(
            run.master.network.by_name[line.outboard], hinge.name, points[hinge.outboard]
        )
    piece = rigid_groups(scene, scene.attachments, poses)[PIECE]
    model = joined_model(piece, models)
    sites = [
        {"name": s.name, "point": s.point, "offset": s.offset, "orientation": s.orientation}
        for s in piece.sites
    ]
    structure = {"modal": model.to_arrays(), "ports": sites}
    part = Part(PIECE, "body", structure, _turning(model, poses[PIECE], momentum))
    return replace(found, parts=tuple(part if p.name == PIECE else p for p in found.parts))


def _pose(body: Participant, port: str, point: np.ndarray) -> StartPose:
    """Pose of a rigid body's construction frame whose port at `point` (3,) is where that of another body is."""
    position, orientation = (
        body.outputs[body.output_layout[f"{port}.{what}"]] for what in ("position", "orientation")
    )
    w, x, y, z = orientation.tolist()
    a, b, c = (position - rotation_matrix((w, x, y, z)) @ point).tolist()
    return StartPose((a, b, c), (w, x, y, z))


def _turning(data: ModalData, pose: StartPose, momentum: np.ndarray) -> dict[str, tuple[float, ...]]:
    """Start of a rigid body that turns about HL1, the y axis through the origin, with an angular momentum (N.m.s)."""
    turn = rotation_matrix(pose.orientation)
    center = np.array(pose.position) + turn @ data.center_of_mass
    about_line = (turn @ data.inertia @ turn.T)[1, 1] + data.mass * (center[0] ** 2 + center[2] ** 2)
    spin = np.array((0.0, momentum[1] / about_line, 0.0))
    return {
        "initial_position": pose.position,
        "initial_orientation": pose.orientation,
        "initial_angular_velocity": tuple(spin.tolist()),
        "initial_velocity": tuple(np.cross(spin, center).tolist()),
    }


def print_table(tolerance: float, tight: float, repeats: int) -> None:
    """Both ways for both wings; errors against the run with all bodies and hinges at a tight tolerance."""
    print(
        f"{'':36} {'FMUs':>4} {'wall s':>7} {'ratio':>6} {'steps':>7} {'iterations':>11} {'HL1, ms':>9} {'peak':>8}"
        f" {'after HL1':>10}"
    )
    for fidelity in get_args(Fidelity):
        true = as_hinges(fidelity, tight)
        found = [(as_hinges(fidelity, tolerance), as_piece(fidelity, tolerance)) for _ in range(repeats)]
        base = median(legs[0].wall for legs in found)
        for name, legs in zip(("latched hinges", "one rigid piece"), zip(*found, strict=True), strict=True):
            leg, wall = legs[-1], median(leg.wall for leg in legs)
            after = median(leg.after / leg.wall for leg in legs)
            print(
                f"{f'{fidelity}, {name}':36} {leg.fmus:4d} {wall:7.3f} {wall / base:6.2f} {leg.steps:7d} "
                f"{leg.iterations:11d} {1e3 * abs(leg.latch - true.latch):9.3f} {abs(leg.peak / true.peak - 1):8.1e} "
                f"{after:10.0%}"
            )
