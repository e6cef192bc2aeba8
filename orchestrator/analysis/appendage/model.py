"""The linear appendage that a wing is to a spacecraft whose base moves as it is told to.

    W = -(D a + L' q''),   q'' + Z q' + w^2 q = -L a

a (6,) is the acceleration of the base at a point of it, W (6,) force and torque of the wing on the base about this
point, both in world axes; q are modal coordinates of the cantilever modes, which have unit modal mass. Z (k, k) is
2 zeta w on its diagonal; single dampers couple modes beside it. See Likins (1970), JPL TR 32-1329, and Imbert, Mamode
(1978) on effective masses.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from components.contract.component import Vector
from components.contract.roles import HOLD

from ...assembly.statics.configuration import Configuration, hinges_of, lines_named, loaded, placed
from ...assembly.statics.linear_model import LinearModel, NormalModes, damping_matrix, linearise, normal_modes
from ...records import short_repr
from ...scene import PlacedScene, SceneError
from ...scene.builder import Names


class StateSpace(NamedTuple):
    """x' = A x + B a, W = C x + D a, with x = (q, q') of k modes: A (2k, 2k), B (2k, 6), C (6, 2k), D (6, 6)."""

    a: Vector
    b: Vector
    c: Vector
    d: Vector


@short_repr
@dataclass(frozen=True)
class Appendage:
    """What a base carries in a configuration, about a point of the base, in world axes.

    unbalanced: largest force (N) and torque (N.m) on a body that nothing balances there. point: its name, at position
    (3,) m. frequency: (k,) Hz, 0 of free motions of the wing. damping: Z (k, k) over
    modal mass, rad/s. participation: L (k, 6), kg^1/2 and kg^1/2.m. rigid_mass: D (6, 6), kg, kg.m, kg.m2.
    """

    scene: str
    configuration: Configuration
    held: tuple[str, ...]
    unbalanced: tuple[float, float]
    point: str
    position: Vector
    frequency: Vector
    damping: Vector
    participation: Vector
    rigid_mass: Vector

    @property
    def angular_frequency(self) -> Vector:
        """(k,) rad/s."""
        result: Vector = 2.0 * np.pi * self.frequency
        return result

    @property
    def damping_ratio(self) -> Vector:
        """(k,) fractions of critical damping of single modes; 0 of free motions, which have none."""
        twice = 2.0 * self.angular_frequency
        return np.divide(self.damping.diagonal(), twice, out=np.zeros_like(twice), where=twice > 0.0)

    @property
    def effective_mass(self) -> Vector:
        """(k, 6) of every mode along and about the axes, kg and kg.m2."""
        return self.participation**2

    @cached_property
    def residual_mass(self) -> Vector:
        """D - L'L (6, 6): what the modes that are left out carry, and what moves with the base itself."""
        result: Vector = self.rigid_mass - self.participation.T @ self.participation
        return result

    @property
    def mass(self) -> float:
        """Kg."""
        return float(self.rigid_mass[0, 0])

    @property
    def center_of_mass(self) -> Vector:
        """(3,) m, from the point."""
        product = self.rigid_mass[3:, :3]
        return np.array([product[2, 1], product[0, 2], product[1, 0]]) / self.mass

    @property
    def state_space(self) -> StateSpace:
        """The same as matrices of a linear system."""
        modes = len(self.frequency)
        spring, damper = np.diag(self.angular_frequency**2), self.damping
        free, still = np.eye(modes), np.zeros((modes, modes))
        return StateSpace(
            np.block([[still, free], [-spring, -damper]]),
            np.vstack((np.zeros((modes, 6)), -self.participation)),
            self.participation.T @ np.hstack((spring, damper)),
            -self.residual_mass,
        )

    def arrays(self) -> dict[str, Vector]:
        """Every array by name, for files."""
        system = self.state_space
        return {
            "position": self.position,
            "frequency_hz": self.frequency,
            "damping_ratio": self.damping_ratio,
            "damping": self.damping,
            "participation": self.participation,
            "rigid_mass": self.rigid_mass,
            "effective_mass": self.effective_mass,
            "residual_mass": self.residual_mass,
            "A": system.a,
            "B": system.b,
            "C": system.c,
            "D": system.d,
        }

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return {
            "scene": self.scene,
            **self.configuration.as_dict(),
            "held": list(self.held),
            "unbalanced_force_n": self.unbalanced[0],
            "unbalanced_torque_nm": self.unbalanced[1],
            "point": self.point,
            **{name: values.tolist() for name, values in self.arrays().items()},
        }


def find_appendages(
    scene: PlacedScene,
    rigid: Collection[str],
    flexible: Collection[str],
    target: Configuration,
    as_posed: bool,
    hold: Names = "none",
    points: Sequence[str] = (),
    count: int = 15,
) -> list[Appendage]:
    """The appendage about each of the points of the base, of its first cantilever modes.

    hold: lines that are kept at their angles without being latched, by name, "all" or "none". points: of the base, by
    name; by default the one that the base turns about. SceneError where there is none, or nothing that could swing.
    """
    held = lines_named(scene, hold)
    mechanism = (placed if as_posed else loaded)(scene, rigid, flexible, target)
    mechanism.command(HOLD.name, 1.0, hinges_of(scene, held))
    model = linearise(mechanism)
    places = _places(scene, model, points)
    modes = normal_modes(model, model.base_constraints)
    _refuse_unstable(scene, modes)
    return [
        Appendage(
            scene.header.name,
            target,
            held,
            model.unbalanced,
            name,
            place,
            *_matrices(model, modes, count, place),
        )
        for name, place in places.items()
    ]


def _matrices(
    model: LinearModel, modes: NormalModes, count: int, position: Vector
) -> tuple[Vector, Vector, Vector, Vector]:
    """Frequency, damping, participation and rigid mass about a position (3,)."""
    shapes = modes.shapes[:, :count]
    rigid = model.mechanism.rigid_motion(position)
    return (
        np.where(modes.is_free, 0.0, modes.frequencies)[:count],
        damping_matrix(model, shapes),
        shapes.T @ model.mass @ rigid,
        rigid.T @ model.mass_on_base @ rigid,
    )


def _places(scene: PlacedScene, model: LinearModel, names: Sequence[str]) -> dict[str, Vector]:
    """Positions (3,) of points of the base by name."""
    base, given = scene.base.name, model.mechanism.bodies[scene.base.name]
    if not names:
        if model.is_grounded:
            return {f"reference point of {base}": model.origin}
        carries = " with what held lines join to it" if given.carried_mass().any() else ""
        return {f"centre of mass of {base}{carries}": model.origin}
    known = scene.base.points
    unknown = [name for name in names if name.removeprefix(f"{base}.") not in known]
    if unknown:
        raise SceneError(
            [f"{scene.file}: {base} has no point {unknown[0]!r}; its points are {', '.join(known)}"]
        )
    center = np.zeros(3) if given.body is None else given.body.data.center_of_mass
    origin = np.zeros(3) if given.body is None else model.origin
    return {
        name: origin + given.axes @ (np.array(known[name.removeprefix(f"{base}.")]) - center)
        for name in names
    }


def _refuse_unstable(scene: PlacedScene, modes: NormalModes) -> None:
    growing = modes.frequencies[~modes.is_free & (modes.eigenvalues < 0.0)]
    if growing.size:
        raise SceneError(
            [
                f"{scene.file}: the wing is unstable in this configuration, a motion grows by a factor e in "
                f"{1.0 / (2.0 * np.pi * -growing.min()):.3g} s, so it is no linear appendage; latch or hold its lines"
            ]
        )
