"""Random valid wings by seed, which nothing was tuned to: accordions of two to six bodies on a fixed or free base.

Masses from 0.1 to 100 kg, joints from 1e3 to 1e9 N/m, all kinds of latches, friction up to 0.5, rigid bodies and
those of the catalogue with flexible modes. No wing is left out for being difficult; motors are chosen so that
something moves: each alone would open what hangs on its line in about the same time.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import exp, log, pi, sqrt
from typing import Any, NamedTuple

import numpy as np

from components._frames import Vector3
from orchestrator.scene import Scene, read_scene
from orchestrator.scene_bodies import body_model, body_points
from orchestrator.scene_body_tables import Body

Table = dict[str, Any]

BODIES = (2, 6)
MASS = (0.1, 100.0)
STIFFNESS = (1e3, 1e9)
LATCH_STIFFNESS = (1e2, 1e7)
TOLERANCE = (1e-6, 1e-2)
DEPLOYMENT_TIME = (1.5, 6.0)
_UNTIL = 1.1
"""End of a run over the deployment time: most lines have latched by then, and rung."""
_SMALLEST_SHARE = 0.2
"""Least torque of a motor, as a share of what opens its line alone in time."""
_LARGEST_BESIDE_FLEXIBLE = 6.0
"""N.m; some times the motors of the wings whose panels the catalogue has."""
_DIGITS = 6


class Entry(NamedTuple):
    """A flexible body of the catalogue: points of its inboard and its outboard hinge line, middle or left and right."""

    name: str
    inboard: tuple[str, ...]
    outboard: tuple[str, ...]


def _sides(line: str) -> tuple[str, str]:
    return f"{line}_left", f"{line}_right"


ENTRIES = (
    Entry("amos3_yoke", ("hl1",), _sides("hl2")),
    Entry("amos3_panel1", _sides("hl2"), _sides("hl3")),
    Entry("amos3_panel2", _sides("hl3"), ()),
    Entry("workbench_panel", _sides("hl"), ()),
    Entry("bepicolombo_inboard", _sides("hl1"), _sides("hl2")),
    Entry("bepicolombo_outboard", _sides("hl2"), ()),
    Entry("arabsat_yoke", ("hl1",), _sides("hl2")),
    Entry("arabsat_panel", _sides("inboard"), _sides("outboard")),
    Entry("arabsat_panel_tip", _sides("inboard"), ()),
)


@dataclass(frozen=True)
class Piece:
    """A body of a wing: its table, the points that hinges use, what the choice of motors needs to know.

    inboard, outboard: points of the hinge lines. widths: half the distance of these points (m), 0 for one in the
    middle. length: from line to line (m). center: of mass, from the inboard line (m). inertia: about it (kg.m2).
    """

    table: Table
    inboard: tuple[str, ...]
    outboard: tuple[str, ...]
    widths: tuple[float, float]
    length: float
    mass: float
    center: float
    inertia: float

    @property
    def name(self) -> str:
        """Name of the body."""
        return str(self.table["name"])

    @property
    def flexible(self) -> bool:
        """Whether it is an entry of the catalogue."""
        return "catalogue" in self.table


class Dice:
    """What is drawn from the generator of a seed, to six digits so that a file of it can be read."""

    def __init__(self, seed: int) -> None:
        self._generator = np.random.default_rng(seed)

    def chance(self, probability: float) -> bool:
        """Whether something of a probability happens."""
        return bool(self._generator.random() < probability)

    def uniform(self, low: float, high: float) -> float:
        """Evenly between two values."""
        return rounded(float(self._generator.uniform(low, high)))

    def decades(self, low: float, high: float) -> float:
        """Evenly in the logarithm."""
        return rounded(exp(self._generator.uniform(log(low), log(high))))

    def count(self, low: int, high: int) -> int:
        """An integer from low to high."""
        return int(self._generator.integers(low, high + 1))

    def pick(self, *choices: Any) -> Any:
        """One of the choices."""
        return choices[int(self._generator.integers(len(choices)))]

    def direction(self) -> list[float]:
        """A unit vector."""
        vector = self._generator.normal(size=3)
        return [rounded(float(x)) for x in vector / np.linalg.norm(vector)]


def rounded(value: float) -> float:
    """To six significant digits."""
    return float(f"{value:.{_DIGITS}g}")


def random_wing(seed: int, bodies: tuple[int, int] = BODIES) -> Table:
    """The tree of a valid scene with so few to so many bodies, always the same for a seed; SI units."""
    dice = Dice(seed)
    pieces = _pieces(dice, bodies)
    lines = [_line(dice, pieces, k) for k in range(len(pieces))]
    time = _motorise(dice, pieces, lines)
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
    return {name: value for name, value in tree.items() if value}


def load_wing(seed: int, bodies: tuple[int, int] = BODIES) -> Scene:
    """The wing of a seed as a checked scene."""
    return read_scene(f"random_wing_{seed}.toml", random_wing(seed, bodies))


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


def _pieces(dice: Dice, bodies: tuple[int, int]) -> list[Piece]:
    """The bodies, from the base outwards; what a flexible one does not leave open, its neighbours follow."""
    count, share = dice.count(*bodies), dice.pick(0.0, 0.0, 0.5, 1.0)
    chosen: list[Entry | None] = []
    for k in range(count):
        entry = _entry(dice, last=k == count - 1) if dice.chance(share) else None
        before = chosen[-1] if chosen else None
        fits = before is None or entry is None or _widths(before)[1] == _widths(entry)[0]
        chosen.append(entry if fits else None)
    widths = [_width(dice, *pair) for pair in zip([None, *chosen], [*chosen, None], strict=True)]
    return [
        _rigid(dice, f"b{k}", (widths[k], widths[k + 1]))
        if entry is None
        else _catalogue(dice, f"b{k}", entry)
        for k, entry in enumerate(chosen)
    ]


def _entry(dice: Dice, *, last: bool) -> Entry:
    """Any entry; inside the wing only one that something can hang on."""
    return dice.pick(*(entry for entry in ENTRIES if last or entry.outboard))


def _width(dice: Dice, before: Entry | None, after: Entry | None) -> float:
    """Half the distance (m) of the two hinges of a line, 0 for a single one."""
    if after is not None:
        return _widths(after)[0]
    if before is not None:
        return _widths(before)[1]
    return dice.pick(0.0, dice.uniform(0.05, 0.6))


def _widths(entry: Entry) -> tuple[float, float]:
    """Half the distances (m) of the hinges of both lines of an entry; 0 where there is no outboard one."""
    points = body_points(Body(name="body", catalogue=entry.name))
    return _half(points, entry.inboard), _half(points, entry.outboard)


def _half(points: Mapping[str, Vector3], names: Sequence[str]) -> float:
    return abs(points[names[0]][1]) if names else 0.0


def _rigid(dice: Dice, name: str, widths: tuple[float, float]) -> Piece:
    """A plate with its centre of mass and its thickness somewhere."""
    mass, length = dice.decades(*MASS), dice.decades(0.3, 2.5)
    side = max(*widths, dice.uniform(0.1, 0.6))
    thickness = dice.uniform(0.02, 0.2) * length
    squares = [length**2, (2.0 * side) ** 2, thickness**2]
    inertia = [rounded(mass * (sum(squares) - own) / 12.0) for own in squares]
    center = rounded(dice.uniform(0.3, 0.7) * length)
    points = {"root": [0.0, 0.0, 0.0], "tip": [length, 0.0, 0.0]}
    for line, x, width in (("root", 0.0, widths[0]), ("tip", length, widths[1])):
        points |= {f"{line}_left": [x, width, 0.0], f"{line}_right": [x, -width, 0.0]} if width else {}
    table = {
        "name": name,
        "rigid": {
            "mass": mass,
            "center_of_mass": [center, rounded(dice.uniform(-0.2, 0.2) * side), 0.0],
            "inertia": inertia,
            "points": points,
        },
    }
    inboard, outboard = (
        _sides(line) if width else (line,) for line, width in zip(("root", "tip"), widths, strict=True)
    )
    return Piece(table, inboard, outboard, widths, length, mass, center, inertia[1])


def _catalogue(dice: Dice, name: str, entry: Entry) -> Piece:
    """A flexible body, sometimes with other damping and with a mass at its end."""
    table: Table = {"name": name, "catalogue": entry.name, "fixed_interface_modes": dice.pick(2, 5, 10)}
    if dice.chance(0.5):
        table["damping_ratio"] = dice.decades(1e-3, 0.1)
    if dice.chance(0.3):
        point = (entry.outboard or entry.inboard)[-1]
        table["attached_masses"] = [{"point": point, "mass": dice.decades(0.1, 10.0)}]
    body = Body.model_validate(table)
    model, points = body_model(body, flexible=False), body_points(body)
    root = points[entry.inboard[0]][0]
    length = points[entry.outboard[0]][0] - root if entry.outboard else 0.0
    return Piece(
        table, entry.inboard, entry.outboard, _widths(entry), length,
        float(model.mass), float(model.center_of_mass[0]) - root, float(model.inertia[1][1]),
    )  # fmt: skip


def _base(dice: Dice, first: Piece) -> Table:
    width = first.widths[0]
    names = _sides("root") if width else ("root",)
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
    seats = inner.outboard if inner else (_sides("root") if width else ("root",))
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
