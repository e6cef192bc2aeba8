"""What joints leave free: count of constraints, their rank where a scene starts, what is redundant, what can move.

Joints are those with a preset, hinges of lines by their kinds, and motions apart; bushings, contacts and cables hold
nothing. Displacements are scaled by 1 m, and a singular value counts from 1e-5 of the largest on: loops are closed to
1e-12 m, which in a singular position leaves angles of the root of that.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from components.contract.frames import rotate, subtract

from ..messages import message
from ..records import short_repr
from .bodies import StartPose
from .loops.constraints import Constraint, Matrix, hinge_constraints
from .loops.initial_assembly import Weight, close, displaced, jacobian
from .placed_scene import PlacedScene

_RANK = 1e-5
_AWAY = 0.01
"""rad (m); how far away a rank is compared."""
_NO_LINE = 1e-6


@short_repr
@dataclass(frozen=True, slots=True)
class Constraints:
    """Bodies that can move, and the constraints of joints on them.

    moving: their names. count: of constraints. rank: of their derivatives where the scene starts; nearby: the same a
    hundredth of a radian away, None where nothing can move. redundant: names of constraints that others imply. spins:
    bodies that turn freely about the line of their joints. driven: freedoms that motions take. smallest_kept,
    largest_dropped: singular values beside the rank, None where there is none.
    """

    moving: tuple[str, ...]
    count: int
    rank: int
    nearby: int | None
    redundant: tuple[str, ...]
    spins: tuple[str, ...]
    driven: int
    smallest_kept: float | None
    largest_dropped: float | None

    @property
    def grubler(self) -> int:
        """Degrees of freedom by count (Gruebler, Kutzbach): six a body less the constraints."""
        return 6 * len(self.moving) - self.count

    @property
    def freedoms(self) -> int:
        """Degrees of freedom where the scene starts, motions aside."""
        return 6 * len(self.moving) - self.rank

    @property
    def is_singular(self) -> bool:
        """Whether the rank differs from the one nearby."""
        return self.nearby is not None and self.nearby != self.rank

    @property
    def warnings(self) -> list[str]:
        """Messages on what makes forces depend on the stiffness of joints."""
        sentences = [*self.singular_start()]
        if self.redundant:
            sentences.append(
                message(
                    "W-redundant",
                    f"{len(self.redundant)} constraints are redundant. How loads are shared among them depends on the "
                    "stiffness of the joints.",
                )
            )
        return sentences

    def singular_start(self) -> Iterator[str]:
        """A message where the scene starts in a singular position."""
        if self.is_singular:
            yield message(
                "W-singular-start",
                f"The scene starts in a singular position: {self.rank} of {self.count} constraints are independent, "
                f"and {self.nearby} at a rotation of 0.01 rad from there. Forces at the start depend on the stiffness "
                "of the joints.",
            )


def singular_start_warnings(scene: PlacedScene) -> Iterator[str]:
    """A message where joints close loops and the scene starts in a singular position."""
    if any(connection.preset is not None for connection in scene.connections):
        yield from find_constraints(scene).singular_start()


def find_constraints(scene: PlacedScene) -> Constraints:
    """Constraints of a scene where it starts."""
    poses = scene.poses
    found = [*scene.constraints, *hinge_constraints(scene.hinge_lines, scene.points)]
    fixed = {*scene.motions, *(() if scene.base.free is not None else (scene.base.name,))}
    moving = tuple(name for name in poses if name not in fixed)
    held = [c for c in found if not c.driven]
    slopes = _slopes(held, poses, moving)
    _, values, directions = np.linalg.svd(slopes)
    rank = _counted(values)
    names = [name for c in held for name in c.names()]
    order: list[int] = scipy.linalg.qr(slopes.T, mode="r", pivoting=True)[1].tolist() if names else []
    return Constraints(
        moving=moving,
        count=len(names),
        rank=rank,
        nearby=_nearby(held, poses, moving, directions[rank:]),
        redundant=tuple(sorted(names[i] for i in order[rank:])),
        spins=tuple(name for name in moving if _spins(name, held, poses, moving, slopes)),
        driven=_rank(_slopes(found, poses, moving)) - rank,
        smallest_kept=float(values[rank - 1]) if rank else None,
        largest_dropped=float(values[rank]) if rank < values.size else None,
    )


def _slopes(held: Sequence[Constraint], poses: Mapping[str, StartPose], moving: Sequence[str]) -> Matrix:
    """Derivatives (rows, 6 a body) of all constraints."""
    return jacobian(held, poses, moving)[1] if held else np.zeros((0, 6 * len(moving)))


def _rank(slopes: Matrix) -> int:
    return _counted(np.linalg.svd(slopes, compute_uv=False))


def _counted(values: NDArray[np.floating[Any]]) -> int:
    """Singular values (K,) that are more than round-off."""
    return int(np.sum(values > _RANK * values[0])) if values.size and values[0] > 0.0 else 0


def _nearby(
    held: Sequence[Constraint], poses: Mapping[str, StartPose], moving: Sequence[str], free: Matrix
) -> int | None:
    """The rank after a small motion that the constraints allow, of all that can move at once.

    free: directions (K, 6 a body) of such motions.
    """
    if not held or not len(free):
        return None
    step = np.random.default_rng(0).standard_normal(len(free)) @ free
    away = displaced(poses, moving, _AWAY / np.abs(step).max() * step)
    return _rank(_slopes(held, close(held, away, dict.fromkeys(moving, Weight())), moving))


def _spins(
    name: str,
    held: Sequence[Constraint],
    poses: Mapping[str, StartPose],
    moving: Sequence[str],
    slopes: Matrix,
) -> bool:
    """Whether a body turns about the line of two of its joints without moving anything."""
    pose = poses[name]
    arms = [
        rotate(pose.orientation, seat.arm)
        for c in held
        for seat in (c.inboard, c.outboard)
        if seat.body == name
    ]
    for one, other in pairwise(arms):
        line = np.array(subtract(other, one))
        length = float(np.linalg.norm(line))
        if length < _NO_LINE:
            continue
        spin = line / length
        motion = np.zeros(slopes.shape[1])
        place = 6 * moving.index(name)
        motion[place : place + 6] = (*-np.cross(spin, one), *spin)
        if np.abs(slopes @ motion).max() < _RANK:
            return True
    return False
