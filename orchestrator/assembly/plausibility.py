"""What a consistent scene says that is hardly meant: sentences to be told before it is run."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from math import degrees, pi, remainder
from typing import NamedTuple

import numpy as np

from components.contract.frames import Vector3, cross, dot, norm, subtract
from components.end_stop import EndStop
from components.flexible.plate import Panel
from components.hold_down import HoldDown

from ..scene.bodies import body_definition, body_model, scene_points
from ..scene.body_tables import Body, Inertial
from ..scene.component_connections import first_number
from ..scene.connection_tables import Ccl
from ..scene.loops.closing import closed, left_open, start_poses
from ..scene.loops.rates import start_rates
from ..scene.schema import CheckedScene
from . import Assembly
from .hinges import contradicted_curves, unfollowed_curves
from .signal_doubts import signal_sentences
from .start_doubts import start_doubts

_ANGLES = 181
"""Places on a line's way that are looked at."""
_NOTHING = 1e-9
"""Of a motor's largest torque: rounding where it gives none."""
_ASKEW = 1e-3
"""Sine of the angle between a loop's axis and a line's, from which on the loop does not lead the line."""
_CLOSED = 1e-6
"""m or rad, by which a joint of a loop may start open: 10 N where it has 1e7 N/m."""
_UNLIKE = 0.1
"""Of its mass that a rigid twin may differ by: hardware that finite elements leave out."""
_TURNED = 0.2
"""rad; places are written to a few degrees, and loops close from there; tables may end as early."""
_THICK = 0.2
"""Thickness of a plate over its shorter side, from which on plate theory does not hold by far."""
_FLAT = 1e-3
"""rad; how far from half a turn two panels are still folded onto each other."""
_STUBBY = 0.5
"""Thickness of a beam over its length, from which on it is none."""
_SLACK = 0.01
"""Hz, of a free beam's first bending: ropes, hoses and cloths bend so slowly, no boom or panel does."""
_FIRST_BENDING = 22.3733
"""Square of the first wave number of a free beam times its length, 4.730^2."""
_DENSEST = 22_600.0
"""kg/m3, of osmium: nothing is denser."""
_NO_RATE = 1e-9
"""m/s and rad/s, that laws leave which begin at rest, such as a cosine."""
_FAR_CENTER = 100.0
"""Of the radius of gyration, that no centre of mass is from all points of its body."""
_OVERDAMPED = 2.0
"""Damping ratio beyond which no latch is meant to brake."""
_GIVES_WAY = pi / 6.0
"""rad, further into which a motor does not press what is to stop it."""
_ROUGHEST = 2.0
"""Coefficient of friction, of clean metals in vacuum."""
_SMALL = 0.01
"""m, of the radius of gyration of what may stand for a point mass."""
_BEYOND_POINTS = 5.0
"""A body's radius of gyration over the distance of its farthest point, where the points still span the body."""


def doubts(scene: CheckedScene) -> list[str]:
    """Everything about a scene that is hardly meant, as sentences with their keys."""
    return [
        *_unstopped(scene),
        *_unlikely_friction(scene),
        *_without_load(scene),
        *_never_stepped(scene),
        *_released_too_late(scene),
        *_held_by_friction(scene),
        *_beyond_tables(scene),
        *_through_one_another(scene),
        *_stopped_before_latch(scene),
        *_unlikely_ends(scene),
        *contradicted_curves(scene),
        *_unlike_travels(scene),
        *_open_at_the_start(scene),
        *_turned_to_close(scene),
        *_free_along_the_line(scene),
        *_askew_loops(scene),
        *_moving_from_rest(scene),
        *_turned_from_the_world(scene),
        *start_doubts(scene),
        *_large_inertias(scene),
        *_unlikely_panels(scene),
        *_unlikely_beams(scene),
    ]


def assembled_doubts(scene: CheckedScene, assembly: Assembly, bending: Collection[str]) -> Iterator[str]:
    """The same, and what is hardly meant of it as assembled with these bodies flexible."""
    yield from doubts(scene)
    yield from signal_sentences(assembly, scene)
    yield from unfollowed_curves(scene, bending)
    yield from _unlike_twins(scene, bending)


def _unlike_twins(scene: CheckedScene, bending: Collection[str]) -> Iterator[str]:
    """Flexible bodies whose rigid twin, by which lines are sized and damped, has another mass."""
    for body in scene.bodies:
        if body.name in bending and body.rigid_twin:
            twin, own = (body_model(body, flexible).mass for flexible in (False, True))
            if abs(twin - own) > _UNLIKE * own:
                yield (
                    f"body.{body.name}: its rigid twin has {twin:.4g} kg, and the flexible body {own:.4g} kg; "
                    "effective inertias, and the damping of latches by them, are those of the twin"
                )


def _unstopped(scene: CheckedScene) -> Iterator[str]:
    """Lines that a motor opens and nothing ends, nor a stop that is a connection between their bodies."""
    stopped = [
        {seat.body for seat in one.ports.values()} for one in scene.connections if one.kind == EndStop.kind
    ]
    for line in scene.hinge_lines:
        ends = line.latch is not None or line.end_stop is not None or line.held
        if line.motor is not None and not ends and {line.inboard, line.outboard} not in stopped:
            yield (
                f"hinge_line.{line.name}: a motor opens it, and it has neither a latch nor an end_stop, so nothing "
                f"keeps it at {degrees(line.deployed_angle):g} deg"
            )


def _stopped_before_latch(scene: CheckedScene) -> Iterator[str]:
    """Lines whose end stop lies before their latch, which they do not reach then."""
    for line in scene.hinge_lines:
        if line.latch is not None and line.stop_angle is not None and line.stop_angle < line.deployed_angle:
            yield (
                f"hinge_line.{line.name}: its end stop is at {degrees(line.stop_angle):g} deg, before its latch at "
                f"{degrees(line.deployed_angle):g} deg, which it reaches only as far as it presses the stop in"
            )


def _unlikely_ends(scene: CheckedScene) -> Iterator[str]:
    """Latches that brake like tar, and end stops that a line's own motor presses in."""
    for line in scene.hinge_lines:
        if line.latch is not None and line.latch.damping_ratio > _OVERDAMPED:
            ratio = line.latch.damping_ratio
            yield (
                f"hinge_line.{line.name}.latch.damping_ratio: is {ratio:g}, {ratio:g} times what is critical; "
                f"'{ratio:g} %' is a hundredth of it"
            )
        if line.end_stop is not None and line.motor_energy > 0.5 * line.end_stop.stiffness * _GIVES_WAY**2:
            yield (
                f"hinge_line.{line.name}.end_stop.stiffness: is {line.end_stop.stiffness:g} N.m/rad, so soft that the "
                f"{line.motor_energy:.3g} J of the line's motor press it in by more than {degrees(_GIVES_WAY):.0f} deg"
            )


def _released_too_late(scene: CheckedScene) -> Iterator[str]:
    """Hold-downs that would let go after the run has ended."""
    for bolt in (one for one in scene.connections if one.kind == HoldDown.kind):
        release = first_number(bolt, "release_time")
        if release > scene.header.until:
            yield (
                f"connection.{bolt.name}: its release_time of {release:g} s comes after the run has ended, at "
                f"{scene.header.until:g} s"
            )


def _without_load(scene: CheckedScene) -> Iterator[str]:
    """Loads that have no law, and that nothing sets in mid-run."""
    outputs = [target for fmu in scene.fmus for name in fmu.outputs for target in fmu.targets(name)]
    driven = {target.partition(".")[0] for target in outputs}.union(*(event.set for event in scene.events))
    for one in scene.connections:
        is_empty = not any((one.structure.get("force"), one.structure.get("torque"), one.parameters))
        if one.kind == "load" and is_empty and one.name not in driven:
            yield (
                f"connection.{one.name}: it has neither a force nor a torque, and no event or FMU sets added_force or "
                "added_torque, so it does nothing"
            )


def _never_stepped(scene: CheckedScene) -> Iterator[str]:
    """FMUs with signals whose first step would end after the run does."""
    for one in scene.fmus:
        if one.step is not None and one.step > scene.header.until:
            yield (
                f"fmu.{one.name}: its step of {one.step:g} s is longer than the run of {scene.header.until:g} s, so it "
                "never makes one"
            )


def _unlikely_friction(scene: CheckedScene) -> Iterator[str]:
    """A coefficient that no pin has, and lines whose friction is to stick and that have none."""
    if scene.friction.coefficient > _ROUGHEST:
        yield (
            f"friction.coefficient: is {scene.friction.coefficient:g}, and pins have {_ROUGHEST:g} at the most; "
            f"'{scene.friction.coefficient:g} %' is a hundredth of it"
        )
    for line in scene.hinge_lines:
        if line.presliding is not None and not line.has_friction and not scene.friction.coefficient:
            yield (
                f"hinge_line.{line.name}.presliding: there is no friction that could stick; give the line "
                "friction_preload, or friction.coefficient"
            )


def _held_by_friction(scene: CheckedScene) -> Iterator[str]:
    """Lines whose friction and harness take more than their motor gives, somewhere on the way."""
    for line in scene.hinge_lines:
        if line.motor is None or line.held:
            continue
        angles = np.linspace(line.initial_angle, line.deployed_angle, _ANGLES)
        given = np.array([line.motor_law.value(angle) for angle in angles.tolist()])
        taken = np.full(_ANGLES, line.friction_preload)
        if line.harness is not None:
            opening = line.harness.opening_law
            taken -= np.array([opening.value(angle) for angle in angles.tolist()])
        short = np.flatnonzero(given < taken - _NOTHING * np.abs(given).max())
        if short.size:
            k = int(short[0])
            yield (
                f"hinge_line.{line.name}: at {degrees(angles[k]):.4g} deg its motor gives {given[k]:.4g} N.m, and its "
                f"friction and harness take {taken[k]:.4g} N.m; unless its speed carries it on or something else "
                "drives it, it stops there"
            )


def _beyond_tables(scene: CheckedScene) -> Iterator[str]:
    """Lines that go beyond what tables of their motor or harness tell."""
    for line in scene.hinge_lines:
        low, high = sorted((line.initial_angle, line.deployed_angle))
        for name, table in (("motor", line.motor), ("harness", line.harness)):
            if table is None or not table.angle:
                continue
            for end, beyond in (
                (table.angle[0], low - table.angle[0]),
                (table.angle[-1], table.angle[-1] - high),
            ):
                if beyond < -_TURNED:
                    yield (
                        f"hinge_line.{line.name}.{name}: its table ends at {degrees(end):.4g} deg, and the line goes "
                        f"from {degrees(low):.4g} to {degrees(high):.4g} deg; beyond, the torque goes on by the slope "
                        "at the end"
                    )


def _open_at_the_start(scene: CheckedScene) -> Iterator[str]:
    """Joints between what lines carry, where start angles do not bring their points together."""
    for name, size in left_open(scene, scene_points(scene)).items():
        if size > _CLOSED:
            yield (
                f"connection.{name}: hinge lines carry its bodies, and their start angles leave it open by "
                f"{1e3 * size:.4g} mm (or mrad), which its stiffness turns into load; check the stowed_angle of each "
                "line of the loop and its digits, or place a body of the loop instead"
            )


def _turned_to_close(scene: CheckedScene) -> Iterator[str]:
    """Placed bodies that joints turn far out of the attitude that they are written with."""
    bare = [one for one in scene.connections if one.preset is not None and one.axes is None]
    for name, angle in closed(scene, scene_points(scene)).turned.items() if bare else ():
        if angle > _TURNED:
            joints = ", ".join(one.name for one in bare if name in {seat.body for seat in one.ports.values()})
            advice = f"give {joints} axes (in the world), or " if joints else ""
            yield (
                f"body.{name}: joints turn it by {degrees(angle):.3g} deg from where its place says, as their ports "
                f"have the axes of their bodies; {advice}place it as they hold it"
            )


def _free_along_the_line(scene: CheckedScene) -> Iterator[str]:
    """Lines whose hinges all let their body slide, where nothing else could hold it."""
    if scene.loops or scene.connections:
        return
    for line in scene.hinge_lines:
        if not line.held and {hinge.kind for hinge in line.hinges} == {"cylindrical"}:
            yield (
                f"hinge_line.{line.name}: all its hinges are cylindrical, so {line.outboard} slides along the line "
                "freely; make one of them revolute"
            )


def _askew_loops(scene: CheckedScene) -> Iterator[str]:
    """Cable loops whose pulleys turn about another axis than the lines between them."""
    for loop in scene.loops:
        ways = [list(scene.lines_inward(pulley.body)) for pulley in (loop.pulley_1, loop.pulley_2)]
        between = [line for way, other in (ways, ways[::-1]) for line in way if line not in other]
        askew = [line for line in between if norm(cross(loop.axis, line.axis)) > _ASKEW]
        if askew:
            yield (
                f"ccl.{loop.name}.axis: its pulleys turn about {_plain(loop.axis)}, and {askew[0].name} opens about "
                f"{_plain(askew[0].axis)}; a loop leads what its lines do where its axis is theirs"
            )


def _plain(axis: Vector3) -> str:
    """As people write it."""
    return "(" + ", ".join(f"{x:.4g}" for x in axis) + ")"


def _moving_from_rest(scene: CheckedScene) -> Iterator[str]:
    """Motions that have a rate where all else starts from a static equilibrium."""
    if not scene.header.preload:
        return
    points = scene_points(scene)
    rates = start_rates(scene, points, start_poses(scene, points))
    if names := ", ".join(name for name, rate in rates.items() if np.abs(rate).max() > _NO_RATE):
        yield (
            f"scene.preload: all starts at rest, in static equilibrium, and motions lead {names} at a rate from t = 0 "
            "on: that is a blow; begin motions at rest, or leave preload out"
        )


def _turned_from_the_world(scene: CheckedScene) -> Iterator[str]:
    """Bases that a motion turns at the start, beside bodies whose places are those of the world."""
    placed = [body.name for body in scene.bodies if body.place is not None]
    if scene.base.motion is None or not placed:
        return
    turn = scene.base.motion.laws[1].value(0.0)
    if abs(remainder(turn, 2.0 * pi)) > _FLAT:
        yield (
            f"base.motion: it begins with the base turned by {degrees(turn):.4g} deg, and places of "
            f"{', '.join(placed)} and axes of connections are those of the world, which do not turn along; write "
            "these as they are then, or let the law begin at a whole turn"
        )


def _through_one_another(scene: CheckedScene) -> Iterator[str]:
    """Panels folded onto each other by a line on those faces of theirs that are not the ones that part as it opens."""
    points, panels = scene_points(scene), {body.name for body in scene.bodies if _panel(body) is not None}
    for line in scene.hinge_lines:
        folded = abs(line.aligned_angle - line.initial_angle - pi) < _FLAT
        if line.held or not folded or not {line.inboard, line.outboard} <= panels:
            continue
        first = line.hinges[0]
        apart = points[line.inboard][first.inboard][2] + points[line.outboard][first.outboard][2]
        if apart * line.axis[1] < 0.0:
            side = "above" if apart > 0.0 else "below"
            yield (
                f"hinge_line.{line.name}: {line.outboard} lies {1e3 * abs(apart):.4g} mm {side} {line.inboard} (along "
                "its z) and opens to the other side, through it; change the sign of panel.hinge_line_offsets there, or "
                "of axis"
            )


def _panel(body: Body) -> Panel | None:
    return None if body.rigid is not None else body_definition(body).panel


class Travels(NamedTuple):
    """Turns (rad) of both pulleys of a loop against the body between them, from the start until all is deployed."""

    first: float
    second: float

    def mismatch(self, loop: Ccl) -> float:
        """Cable (m) that one pulley takes up and the other does not give."""
        return abs(loop.pulley_1.radius * self.first - loop.pulley_2.radius * self.second)


def loop_travels(scene: CheckedScene, loop: Ccl) -> Travels | None:
    """The travels that a loop joins; None where no single body is between its pulleys."""
    bodies = loop.pulley_1.body, loop.pulley_2.body
    carrier = loop.guide.body if loop.guide is not None else _between(scene, *bodies)
    if carrier is None:
        return None
    first, second, middle = (_turn(scene, body, loop.axis) for body in (*bodies, carrier))
    return Travels(first - middle, second - middle)


def _between(scene: CheckedScene, a: str, b: str) -> str | None:
    """The body that two hinge lines join to two others; None where there is none."""
    inboard = {line.outboard: line.inboard for line in scene.hinge_lines}
    for outer, inner in ((a, b), (b, a)):
        middle = inboard.get(outer)
        if (
            middle is not None
            and middle != inner
            and inner in (inboard.get(middle), *_outboard(scene, middle))
        ):
            return middle
    return None


def _outboard(scene: CheckedScene, body: str) -> list[str]:
    return [line.outboard for line in scene.hinge_lines if line.inboard == body]


def _turn(scene: CheckedScene, body: str, axis: Vector3) -> float:
    """Turn (rad) of a body about an axis from the start until all lines are deployed."""
    lines = [line for line in scene.lines_inward(body) if not line.held]
    return sum((dot(line.axis, axis) * (line.deployed_angle - line.initial_angle) for line in lines), 0.0)


def _unlike_travels(scene: CheckedScene) -> Iterator[str]:
    """Loops whose radii do not fit the travels they join, so that a strand goes slack on the way."""
    for loop in scene.loops:
        travels = loop_travels(scene, loop)
        if travels is None or travels.mismatch(loop) * loop.strand_stiffness <= loop.preload:
            continue
        first, second = (abs(degrees(turn)) for turn in travels)
        r1, r2, left = 1e3 * loop.pulley_1.radius, 1e3 * loop.pulley_2.radius, travels.mismatch(loop)
        fit = f"; the radii would fit as {second:g} to {first:g}" if first and second else ""
        if travels.first * travels.second < 0.0:
            fit = "; they turn in opposite senses against the body between them: check the axes of the lines"
        yield (
            f"ccl.{loop.name}: its pulleys do not fit the travels that they join: {r1:g} mm by {first:g} deg against "
            f"{r2:g} mm by {second:g} deg, which stretches a strand by up to {1e3 * left:.3g} mm, "
            f"{left * loop.strand_stiffness:.3g} N beside its preload of {loop.preload:g} N{fit}"
        )


def _large_inertias(scene: CheckedScene) -> Iterator[str]:
    """Rigid bodies whose inertia is that of something far larger than their points; the spacecraft among them."""
    for body in scene.bodies:
        if body.rigid is not None:
            yield from _large_inertia(f"body.{body.name}.rigid", body.rigid, list(body.rigid.points.values()))
    if scene.base.free is not None:
        yield from _large_inertia("base.free", scene.base.free, list(scene.base.points.values()))


def _large_inertia(key: str, inertial: Inertial, points: list[Vector3]) -> Iterator[str]:
    gyration = float(np.sqrt(np.linalg.eigvalsh(np.array(inertial.inertia))[-1] / inertial.mass))
    reach = max((norm(subtract(point, inertial.center_of_mass)) for point in points), default=0.0)
    if reach and gyration > _BEYOND_POINTS * reach:
        yield (
            f"{key}: its radius of gyration is {gyration:.3g} m, and no point of it is farther than {reach:.3g} m from "
            "its centre of mass; check the units of mass, inertia and points"
        )
    nearest = min((norm(subtract(point, inertial.center_of_mass)) for point in points), default=0.0)
    if nearest > _FAR_CENTER * max(gyration, _SMALL):
        yield (
            f"{key}: its centre of mass is {nearest:.3g} m from all of its points, and its radius of gyration is "
            f"{gyration:.3g} m; check the units of center_of_mass and points"
        )


def _unlikely_panels(scene: CheckedScene) -> Iterator[str]:
    """Panels that are no plates, denser than any material, or slack, by what their stiffnesses tell."""
    for body in scene.bodies:
        panel = _panel(body)
        if panel is None:
            continue
        plate, key = panel.plate, f"body.{body.name}"
        thickness = float(np.sqrt(12.0 * plate.bending[0] / plate.membrane[0]))
        side = min(plate.length, plate.width)
        density = plate.areal_mass / thickness
        like = f"its stiffness is that of a plate of {1e3 * thickness:.3g} mm"
        if thickness > _THICK * side:
            yield (
                f"{key}: {like}, and it is {side:.3g} m wide: plate theory does not hold for it; check the "
                "units of its thickness or stiffness"
            )
        if density > _DENSEST:
            yield (
                f"{key}: {like}, whose {plate.areal_mass:g} kg/m2 would be {density:.3g} kg/m3, denser than any "
                "material; check the units of areal_mass and of thickness"
            )
        first = _first_bending(min(plate.bending[:2]), plate.areal_mass, max(plate.length, plate.width))
        if first < _SLACK and plate.prestress == 0.0:
            yield (
                f"{key}: free, it would bend at {first:.2g} Hz, as a cloth does; check the units of "
                "youngs_modulus, or of bending"
            )


def _first_bending(bending: float, mass: float, length: float) -> float:
    """Hz, of a free beam or strip of a bending stiffness (N.m2, or N.m over its width) and a mass a length."""
    return float(_FIRST_BENDING / (2.0 * np.pi) * np.sqrt(bending / (mass * length**4)))


def _unlikely_beams(scene: CheckedScene) -> Iterator[str]:
    """Beams that are as thick as long, or bend like a rope, by what their stiffnesses tell."""
    for body in scene.bodies:
        beam = None if body.beam is None else body_definition(body).beam
        if beam is None:
            continue
        section, length, key = beam.section, beam.axis.length, f"body.{body.name}.beam"
        thickness = float(np.sqrt(12.0 * max(section.bending_y, section.bending_z) / section.axial))
        if thickness > _STUBBY * length:
            yield (
                f"{key}: its stiffness is that of a bar of {thickness:.3g} m, and it is {length:.3g} m long: beam "
                "theory does not hold for it; check the units of its section"
            )
        bending = min(section.bending_y, section.bending_z)
        first = _first_bending(bending, section.line_mass, length)
        if first < _SLACK:
            yield (
                f"{key}: free, it would bend at {first:.2g} Hz, as a rope does; check the units of its section and of "
                "youngs_modulus"
            )
