"""Tables of a scene before its run: bodies, hinge lines and their travels, cable loops, connections."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from rich.table import Table

from ..analysis.scene_check import BodyOverview, LineOverview, LoopOverview, SceneCheck, StartMotion
from ..scene.units import degrees_text
from .tables import table_of


def scene_tables(found: SceneCheck) -> Iterator[Table]:
    """Tables of everything that the scene has."""
    yield _table(
        f"{found.scene}: bodies",
        ("body", "model", "points"),
        ("mass,\nkg", "size,\nm"),
        map(_body, found.bodies),
    )
    for name, agreement in found.agreements.items():
        yield _table(f"consistency of the files of {name}", ("", ""), (), agreement.items())
    if found.lines:
        yield from _line_tables(found)
    if found.loops:
        numbers = ("radii,\nmm", "travels,\ndeg", "mismatch,\nmm")
        yield _table("cable loops", ("loop", "from, to"), numbers, map(_loop, found.loops))
    if found.start_motion is not None:
        yield _table("motion at the start", ("", ""), (), _motion(found.start_motion))
    if found.connections:
        yield _table("connections", ("name", "kind"), (), found.connections.items())


def _line_tables(found: SceneCheck) -> Iterator[Table]:
    """Travels of hinge lines, their motors, latches and stops."""
    angles = ("start,\ndeg", "deployed,\ndeg", "travel,\ndeg", "friction,\nN.m")
    yield _table("hinge lines", ("line", "from, to"), angles, map(_line, found.lines))
    yield _table(
        "motors, latches and stops of hinge lines",
        ("line", "motor, N.m", "stop or latch"),
        ("motor\nenergy, J",),
        map(_ends, found.lines),
    )


def _table(title: str, texts: Sequence[str], numbers: Sequence[str], rows: Iterable[Sequence[str]]) -> Table:
    return table_of(title, (*texts, *numbers), rows, texts)


def _body(body: BodyOverview) -> tuple[str, ...]:
    size = " x ".join(f"{length:.3g}" for length in body.size)
    return (
        body.name,
        body.model,
        ", ".join(body.points),
        "" if body.mass is None else f"{body.mass:.5g}",
        size,
    )


def _line(line: LineOverview) -> tuple[str, ...]:
    angles = (degrees_text(angle, 1) for angle in (line.start, line.deployed, line.travel))
    return (
        line.name,
        f"{line.inboard}, {line.outboard}",
        *angles,
        f"{line.friction_preload:g}{', sticks' * line.sticks}",
    )


def _ends(line: LineOverview) -> tuple[str, ...]:
    motor = "none" if line.motor is None else f"{line.motor[0]:g} to {line.motor[1]:g}"
    return line.name, motor, _end(line), f"{line.motor_energy:.3g}" if line.motor else ""


def _end(line: LineOverview) -> str:
    """Latch and end stop of a line."""
    if line.held:
        return "held"
    stop = "" if line.end_stop is None else f"stop at {degrees_text(line.end_stop, 1)} deg"
    latch = "" if line.latch == "none" else f"{line.latch} latch on {line.effective_inertia:.4g} kg.m2"
    return "; ".join(filter(None, (latch, stop))) or "nothing"


def _loop(loop: LoopOverview) -> tuple[str, ...]:
    travels = (
        "" if loop.travels is None else " and ".join(degrees_text(abs(turn), 1) for turn in loop.travels)
    )
    radii = " and ".join(f"{1e3 * radius:g}" for radius in loop.radii)
    unshared = "" if loop.travels is None else f"{round(1e3 * loop.mismatch, 3) + 0.0:g}"
    return loop.name, ", ".join(loop.bodies), radii, travels, unshared


def _motion(start: StartMotion) -> Iterator[tuple[str, str]]:
    """Energy and momenta, world axes."""
    yield "kinetic energy, J", f"{start.kinetic_energy:.5g}"
    for name, values in (
        ("linear momentum, N.s", start.linear_momentum),
        ("angular momentum about the origin, N.m.s", start.angular_momentum),
    ):
        yield name, ", ".join(f"{round(value, 9) + 0.0:.5g}" for value in values)
