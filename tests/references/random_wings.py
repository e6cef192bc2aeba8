"""Random valid wings by seed, which nothing was tuned to: accordions of two to six bodies on a fixed or free base.

Masses from 0.1 to 100 kg, joints from 1e3 to 1e9 N/m, all kinds of latches, friction up to 0.5, rigid bodies and
those of the catalogue with flexible modes. No wing is left out for being difficult; motors are chosen so that all
lines of the folded wing would open in about the same time.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from math import pi, sqrt
from typing import Any

import numpy as np

from orchestrator.scene import PlacedScene, read_scene
from tests.references.random_bodies import Dice, Piece, Table, random_pieces, rounded, sides

BODIES = (2, 6)
STIFFNESS = (1e3, 1e9)
LATCH_STIFFNESS = (1e2, 1e7)
STOP_STIFFNESS = (1e2, 1e6)
TOLERANCE = (1e-6, 1e-2)
DEPLOYMENT_TIME = (1.5, 6.0)
_UNTIL = 1.1
"""End of a run over the deployment time: most lines have latched by then, and rung."""
_SMALLEST_SHARE = 0.2
"""Least torque of a motor, as a share of what opens its line alone in time."""
_LARGEST_BESIDE_FLEXIBLE = 6.0
"""N.m; some times the motors of the wings whose panels the catalogue has."""


def random_wing(seed: int, bodies: tuple[int, int] = BODIES, *, stops: bool = False) -> Table:
    """The tree of a valid scene with so few to so many bodies, always the same for a seed; SI units.

    stops: with end stops in place of most latches, damped or not, and otherwise the same.
    """
    dice = Dice(seed)
    pieces = random_pieces(dice, bodies)
    lines = [_line(dice, pieces, k) for k in range(len(pieces))]
    time = _motorise(dice, pieces, lines)
    if stops:
        _stop(Dice(seed), lines, np.diag(_inertias(pieces)).tolist())
    tree = {
        "scene": _header(dice, seed, time),
        "base": _base(dice, pieces[0]),
        "joint": _joint(dice),
        "friction": _friction(dice),
        "body": [piece.table for piece in pieces],
        "hinge_line": lines,
        "ccl": list(_loops(dice, pieces, lines)),
        "damper": list(_dampers(dice, lines, time)),
    }
    _write_units(lines)
    return {name: value for name, value in tree.items() if value}


def _write_units(lines: Sequence[Table]) -> None:
    """Angles as texts, which scene files need."""
    for line in lines:
        line["aligned_angle"] = _radians(line["aligned_angle"])
        if "harness" in line:
            line["harness"]["angle"] = list(map(_radians, line["harness"]["angle"]))
        if "measured" in line.get("latch", {}):
            line["latch"]["measured"]["deflection"] = list(
                map(_radians, line["latch"]["measured"]["deflection"])
            )


def _radians(angle: float) -> str:
    return f"{angle!r} rad"


def load_wing(seed: int, bodies: tuple[int, int] = BODIES, *, stops: bool = False) -> PlacedScene:
    """The wing of a seed as a checked scene, with latches or with end stops in place of most."""
    return read_scene(f"random_wing_{seed}.toml", random_wing(seed, bodies, stops=stops))


def toml_text(tree: Mapping[str, Any]) -> str:
    """The tree as the text of a scene file."""
    blocks = []
    for name, value in tree.items():
        tables, head = (value, f"[[{name}]]") if isinstance(value, list) else ([value], f"[{name}]")
        for table in tables:
            blocks.append("\n".join([head, *(f"{key} = {_inline(entry)}" for key, entry in table.items())]))
    return "\n\n".join(blocks) + "\n"


def _inline(value: object) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_inline(entry)}" for key, entry in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_inline, value)) + "]"
    return json.dumps(value)


def _header(dice: Dice, seed: int, time: float) -> Table:
    header: Table = {
        "name": f"random_wing_{seed}",
        "until": rounded(_UNTIL * time),
        "tolerance": dice.decades(*TOLERANCE),
        "preload": dice.chance(0.3),
    }
    if dice.chance(0.1):
        size = dice.decades(1e-4, 0.1)
        header["gravity"] = [rounded(size * x) for x in dice.direction()]
    return header


def _joint(dice: Dice) -> Table:
    axial, radial, lever = dice.decades(*STIFFNESS), dice.decades(*STIFFNESS), dice.decades(0.03, 0.3)
    return {
        "axial_stiffness": axial,
        "radial_stiffness": radial,
        "cross_stiffness": rounded(radial * lever**2),
        "damping_ratio": dice.pick(0.0, dice.uniform(0.0, 0.1)),
        "damping_frequency": dice.decades(10.0, 300.0),
    }


def _friction(dice: Dice) -> Table:
    return {
        "coefficient": dice.pick(0.0, dice.uniform(0.0, 0.5)),
        "static_ratio": dice.uniform(1.0, 1.5),
        "pin_radius": dice.decades(3e-3, 2e-2),
    }


def _base(dice: Dice, first: Piece) -> Table:
    width = first.widths[0]
    names = sides("root") if width else ("root",)
    points = dict(zip(names, ([0.0, width, 0.0], [0.0, -width, 0.0]), strict=False))
    if not dice.chance(0.4):
        return {"points": points}
    mass, radius = dice.decades(30.0, 3000.0), dice.uniform(0.3, 1.5)
    inertia = [rounded(dice.uniform(0.3, 0.5) * mass * radius**2) for _ in range(3)]
    center = [rounded(-radius), 0.0, rounded(dice.uniform(-0.5, 0.5) * radius)]
    return {"points": points, "free": {"mass": mass, "center_of_mass": center, "inertia": inertia}}


def _line(dice: Dice, pieces: Sequence[Piece], k: int) -> Table:
    """The line inboard of a body, without its motor: axes alternate, so that the wing is folded like an accordion."""
    outer, inner = pieces[k], pieces[k - 1] if k else None
    width = outer.widths[0]
    seats = inner.outboard if inner else (sides("root") if width else ("root",))
    kinds = ("revolute", dice.pick("cylindrical", "cylindrical", "spherical"))
    hinges = [
        {"name": f"h{k}_{i}", "inboard": seat, "outboard": point, "kind": kind}
        for i, (seat, point, kind) in enumerate(zip(seats, outer.inboard, kinds, strict=False))
    ]
    angle = pi if k else dice.pick(0.5 * pi, 0.5 * pi, dice.uniform(0.25 * pi, pi))
    return {
        "name": f"L{k}",
        "inboard": inner.name if inner else "base",
        "outboard": outer.name,
        "axis": "-y" if k % 2 else "+y",
        "aligned_angle": rounded(angle),
        "hinges": hinges,
    }


def _motorise(dice: Dice, pieces: Sequence[Piece], lines: Sequence[Table]) -> float:
    """Motors, harnesses, friction and latches; all lines of the folded stack would open in about the returned time (s).

    Where that takes a torque that closes, because other lines already open this one, a small one opens. Wings with
    flexible bodies open so slowly that their linear modes hold.
    """
    inertias, time = _inertias(pieces), dice.decades(*DEPLOYMENT_TIME)
    wanted = [2.0 * line["aligned_angle"] / (dice.uniform(0.7, 1.3) * time) ** 2 for line in lines]
    torques = np.maximum(inertias @ wanted, _SMALLEST_SHARE * np.diag(inertias) * wanted)
    if any(piece.flexible for piece in pieces):
        slower = max(1.0, float(torques.max()) / _LARGEST_BESIDE_FLEXIBLE)
        torques, time = torques / slower, time * sqrt(slower)
    for line, torque, inertia in zip(lines, torques.tolist(), np.diag(inertias).tolist(), strict=True):
        fall = dice.uniform(0.05, 0.4)
        low = rounded((1.0 - fall) * torque)
        line["motor"] = {"stowed": rounded((1.0 + fall) * torque), "deployed": low}
        if dice.chance(0.5):
            line["friction_preload"] = rounded(dice.uniform(0.0, 0.3) * low)
        if dice.chance(0.3):
            line["harness"] = _harness(dice, low, line["aligned_angle"])
            line["hinges"][0]["harness"] = True
        latch = _latch(dice, inertia)
        if latch:
            line["latch"] = latch
    return time


def _stop(dice: Dice, lines: Sequence[Table], inertias: Sequence[float]) -> None:
    """End stops in place of most latches, of the first at least; their damping is a part of critical of its line."""
    for line, inertia in zip(lines, inertias, strict=True):
        if line is not lines[0] and dice.chance(0.4):
            continue
        line.pop("latch", None)
        stiffness = dice.decades(*STOP_STIFFNESS)
        damping = dice.pick(0.0, dice.decades(0.02, 1.0)) * 2.0 * sqrt(stiffness * inertia)
        line["end_stop"] = {"stiffness": stiffness, "damping": rounded(damping)}


def _harness(dice: Dice, torque: float, angle: float) -> Table:
    """A harness that resists first and helps in the end, by parts of the motor's torque."""
    resisting = rounded(dice.uniform(0.02, 0.2) * torque)
    return {
        "angle": [0.0, rounded(0.6 * angle), rounded(1.1 * angle)],
        "resisting_torque": [resisting, 0.0, rounded(-0.5 * resisting)],
    }


def _inertias(pieces: Sequence[Piece]) -> np.ndarray:
    """Mass matrix of the hinge angles of the folded stack on a fixed base, in its plane (kg.m2)."""
    count = len(pieces)
    sides = (-1.0) ** np.arange(count)  # bodies lie to and fro, and their lines open in turns to both sides
    turns = np.tril(np.ones((count, count))) * sides
    arms = np.zeros((count, count))  # of the centre of mass of a body (row), by the rate of another (column)
    for k, piece in enumerate(pieces):
        arms[k, k] = sides[k] * piece.center
        arms[k + 1 :, k] = sides[k] * piece.length
    masses, inertias = (np.array([getattr(p, name) for p in pieces]) for name in ("mass", "inertia"))
    by_rates: np.ndarray = arms.T @ (masses[:, None] * arms) + np.diag(inertias)
    return turns.T @ by_rates @ turns


def _latch(dice: Dice, inertia: float) -> Table:
    """A latch of any kind or none; between rigid bodies, which lack compliance, a measured one becomes a spring."""
    kind = dice.pick("none", "spring", "spring", "kinematic", "table")
    if kind == "none":
        return {}
    stiffness = dice.decades(*LATCH_STIFFNESS)
    latch: Table = {
        "kind": "by_fidelity" if kind == "table" else kind,
        "stiffness": stiffness,
        "effective_inertia": rounded(inertia),
        "damping_ratio": dice.pick(0.0, 0.02, dice.uniform(0.0, 0.1)),
    }
    if kind == "table":
        latch["outboard_stiffness"] = rounded(2.0 * stiffness)
        latch["measured"] = _measured(dice, stiffness)
    return latch


def _measured(dice: Dice, stiffness: float) -> Table:
    """Torque of latched hinges over their deflection: soft in the middle, then twice the stiffness of the line."""
    toe, soft = dice.decades(1e-4, 1e-2), dice.uniform(0.1, 0.9)
    beyond = 0.1
    knee = soft * 2.0 * stiffness * toe
    end = knee + 2.0 * stiffness * beyond
    return {
        "deflection": [-toe - beyond, -toe, 0.0, toe, toe + beyond],
        "torque": [-rounded(end), -rounded(knee), 0.0, rounded(knee), rounded(end)],
    }


def _loops(dice: Dice, pieces: Sequence[Piece], lines: Sequence[Table]) -> Iterator[Table]:
    """Sometimes a cable loop across a body, with radii that let the lines beside it open together."""
    if len(pieces) < 2 or not dice.chance(0.25):
        return
    k = dice.count(0, len(pieces) - 2)
    inner, outer = lines[k], lines[k + 1]
    radius = dice.uniform(0.02, 0.05)
    yield {
        "name": "loop",
        "preload": dice.decades(5.0, 100.0),
        "strand_stiffness": dice.decades(1e3, 1e5),
        "pulley_1": _pulley(inner, "inboard", radius * outer["aligned_angle"] / inner["aligned_angle"]),
        "pulley_2": _pulley(outer, "outboard", radius),
    }


def _pulley(line: Table, side: str, radius: float) -> Table:
    """A pulley on the first hinge of a line, on its inboard or its outboard body."""
    return {"body": line[side], "point": line["hinges"][0][side], "radius": rounded(radius)}


def _dampers(dice: Dice, lines: Sequence[Table], time: float) -> Iterator[Table]:
    """Sometimes an eddy-current damper, whose torque at the mean rate is a part of the motor's."""
    if not dice.chance(0.25):
        return
    line = dice.pick(*lines)
    rate = line["aligned_angle"] / time
    yield {
        "name": "damper",
        "hinge": line["hinges"][0]["name"],
        "damping_coefficient": rounded(dice.uniform(0.05, 0.5) * line["motor"]["deployed"] / rate),
        "peak_rate": dice.pick(0.0, rounded(2.0 * rate)),
    }
