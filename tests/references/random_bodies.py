"""The bodies of random wings: plates of any mass, and flexible bodies of the catalogue where their hinges meet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp, log
from typing import Any, NamedTuple

import numpy as np

from components.contract.frames import Vector3
from orchestrator.scene.bodies import body_model, body_points
from tests.references import catalogue

Table = dict[str, Any]

MASS = (0.1, 100.0)
_DIGITS = 6


class Entry(NamedTuple):
    """A flexible body of the catalogue: points of its inboard and its outboard hinge line, middle or left and right."""

    name: str
    inboard: tuple[str, ...]
    outboard: tuple[str, ...]


def sides(line: str) -> tuple[str, str]:
    return f"{line}_left", f"{line}_right"


ENTRIES = (
    Entry("amos3_yoke", ("hl1",), sides("hl2")),
    Entry("amos3_panel1", sides("hl2"), sides("hl3")),
    Entry("amos3_panel2", sides("hl3"), ()),
    Entry("workbench_panel", sides("hl"), ()),
    Entry("bepicolombo_inboard", sides("hl1"), sides("hl2")),
    Entry("bepicolombo_outboard", sides("hl2"), ()),
    Entry("arabsat_yoke", ("hl1",), sides("hl2")),
    Entry("arabsat_panel", sides("inboard"), sides("outboard")),
    Entry("arabsat_panel_tip", sides("inboard"), ()),
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


def random_pieces(dice: Dice, bodies: tuple[int, int]) -> list[Piece]:
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
    points = body_points(catalogue.body({"catalogue": entry.name}))
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
        sides(line) if width else (line,) for line, width in zip(("root", "tip"), widths, strict=True)
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
    body = catalogue.body(table)
    model, points = body_model(body, flexible=False), body_points(body)
    root = points[entry.inboard[0]][0]
    length = points[entry.outboard[0]][0] - root if entry.outboard else 0.0
    return Piece(
        table, entry.inboard, entry.outboard, _widths(entry), length,
        float(model.mass), float(model.center_of_mass[0]) - root, float(model.inertia[1][1]),
    )  # fmt: skip
