"""What a panel is: an orthotropic plate with fittings that carry its attachment points; stiffness of sandwiches.

Frame: x outboard along the wing, y along the hinge lines with its origin in the middle, z normal to the plate, whose
mid-plane is z = 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import combinations, pairwise, product
from math import sqrt
from typing import Literal

from .beam_frame import BeamSection
from .finite_elements import Rectangle

Geometry = Literal["linear", "von_karman"]
"""Whether bending stretches the mid-plane of a plate, which matters where it bends by more than its thickness."""

_ROUNDING = 1e-9  # m
_NARROWEST = 1e-4
"""Of the longer side; cubics over narrower elements lose all their digits."""
_MOST_ELEMENTS = 20_000  # half a minute, and modes far beyond those that a deployment needs


def sandwich_stiffness(
    skin: float, core: float, youngs_modulus: float, poisson_ratio: float, shear_modulus: float
) -> tuple[tuple[float, float, float, float], tuple[float, float, float, float]]:
    """Bending (N m) and membrane (N/m) stiffness of two equal skins on a core that only spaces them.

    skin, core: thickness (m) of one skin and of the core; moduli (Pa) of the skin, equal along x and y.
    Skins (Allen 1969): A = 2 E t / (1 - nu²), D = A (d² / 4 + t² / 12) with d = core + skin.
    """
    plane = 2.0 * skin * youngs_modulus / (1.0 - poisson_ratio**2)
    membrane = (plane, plane, poisson_ratio * plane, 2.0 * skin * shear_modulus)
    lever = (core + skin) ** 2 / 4.0 + skin**2 / 12.0
    a11, a22, a12, a66 = membrane
    return (a11 * lever, a22 * lever, a12 * lever, a66 * lever), membrane


@dataclass(frozen=True)
class Plate:
    """Rectangular orthotropic plate, its energy ½[D11 w,xx² + D22 w,yy² + 2 D12 w,xx w,yy + 4 D66 w,xy²]."""

    length: float
    """along x, m"""
    width: float
    """along y, m"""
    areal_mass: float
    """kg/m2"""
    bending: tuple[float, float, float, float]
    """D11, D22, D12, D66, N m"""
    membrane: tuple[float, float, float, float]
    """A11, A22, A12, A66, N/m"""
    prestress: float = 0.0
    """tension in every direction of the plane, which adds T/2 (w,x² + w,y²) to the energy, N/m"""
    geometry: Geometry = "linear"

    @property
    def equivalent_thickness(self) -> float:
        """Thickness (m) of a homogeneous plate of its stiffnesses."""
        return sqrt(12.0 * self.bending[0] / self.membrane[0])


@dataclass(frozen=True)
class HingeArm:
    """Fitting that carries an attachment point: a rigid insert patch at the plate's edge, then a massless arm.

    Without a `section` the arm is a rigid link. An insert inside the plate has its own x instead of an edge and an
    arm; its attachment point is there, in the middle of its patch or wherever its rectangles are.
    """

    name: str
    y: float
    """m"""
    edge: Literal["inboard", "outboard"] = "inboard"
    length: float = 0.055
    """from the plate's edge to the attachment point, m"""
    section: BeamSection | None = None
    point_mass: float = 0.0
    """at the attachment point, kg"""
    patch: float = 0.030
    """side of the square patch, m"""
    x: float | None = None
    """of the middle of an insert inside the plate, m"""
    z: float = 0.0
    """of arm and attachment point, off the plate's mid-plane by a rigid bracket on the patch, m"""
    rectangles: tuple[Rectangle, ...] = ()
    """of an insert that is no patch: ranges of x and y that are rigid together, m"""


@dataclass(frozen=True)
class Panel:
    """Plate with hinge arms; `nodes` are further points (name -> x, y) a scene may load."""

    plate: Plate
    arms: tuple[HingeArm, ...] = ()
    nodes: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    plate_start: float = 0.055
    """x of the plate's inboard edge, m"""
    element_size: float = 0.05
    """largest side of an element, m"""

    def ends(self, arm: HingeArm) -> tuple[float, float]:
        """X of an arm's root on the plate and of its attachment point, m."""
        if arm.x is not None:
            return arm.x, arm.x
        if arm.edge == "inboard":
            return self.plate_start, self.plate_start - arm.length
        end = self.plate_start + self.plate.length
        return end, end + arm.length

    def patches(self, arm: HingeArm) -> tuple[Rectangle, ...]:
        """Ranges of x and y of an arm's rigid insert, m; more than one where it is a union of rectangles."""
        return arm.rectangles or (self._patch(arm),)

    def _patch(self, arm: HingeArm) -> Rectangle:
        root, half = self.ends(arm)[0], 0.5 * arm.patch
        y = (arm.y - half, arm.y + half)
        if arm.x is not None:
            return (root - half, root + half), y
        return ((root, root + arm.patch) if arm.edge == "inboard" else (root - arm.patch, root)), y

    def mesh_lines(self) -> tuple[list[float], list[float]]:
        """Where lines of the mesh have to lie along x and along y (m): edges of plate and inserts, and the middle."""
        rigid = [patch for arm in self.arms for patch in self.patches(arm)]
        end, half = self.plate_start + self.plate.length, 0.5 * self.plate.width
        return (
            [self.plate_start, end, *(x for patch in rigid for x in patch[0])],
            [-half, 0.0, half, *(y for patch in rigid for y in patch[1])],
        )

    def problems(self) -> Iterator[str]:
        """What cannot be of inserts and nodes, as sentences."""
        inside = (
            (self.plate_start, self.plate_start + self.plate.length),
            (-0.5 * self.plate.width, 0.5 * self.plate.width),
        )
        elements = self.plate.length * self.plate.width / self.element_size**2
        if elements > _MOST_ELEMENTS:
            yield (
                f"elements of {self.element_size:g} m make {elements:.3g} of them, more than {_MOST_ELEMENTS};"
                " check length and width, or give a larger element_size"
            )
        for arm in self.arms:
            if arm.section is not None and arm.length <= 0.0:
                yield f"hinge arm {arm.name!r} has a stiffness and no length; give its length, or leave stiffness out"
            if not all(_within(patch, inside) for patch in self.patches(arm)):
                yield f"the insert patch of hinge arm {arm.name!r} reaches beyond the plate"
        for one, other in combinations(self.arms, 2):
            if any(_meet(*pair) for pair in product(self.patches(one), self.patches(other))):
                yield (
                    f"the insert patches of {one.name!r} and {other.name!r} overlap or touch, and what is rigid there "
                    "would be one piece; make one insert of them, or leave a gap between them"
                )
        yield from self._narrow_elements()
        for name, (x, y) in self.nodes.items():
            if not _within(((x, x), (y, y)), inside):
                (x0, x1), (y0, y1) = inside
                yield (
                    f"node {name!r} at x = {x:g} m, y = {y:g} m is outside the plate, which reaches"
                    f" from x = {x0:g} to {x1:g} m and from y = {y0:g} to {y1:g} m"
                )

    def _narrow_elements(self) -> Iterator[str]:
        least = _NARROWEST * max(self.plate.length, self.plate.width)
        for axis, lines in zip("xy", self.mesh_lines(), strict=True):
            for low, high in pairwise(sorted(lines)):
                if _ROUNDING < high - low < least:
                    yield (
                        f"edges of inserts, or patches of hinge arms, lie {high - low:.3g} m apart at {axis} = "
                        f"{low:g} m; on a plate of {self.plate.length:g} x {self.plate.width:g} m make them and what "
                        f"is between them {least:.2g} m wide, or let their edges be one; or is the plate in another "
                        "unit?"
                    )


def _within(inner: Rectangle, outer: Rectangle) -> bool:
    return all(
        low - _ROUNDING <= a and b <= high + _ROUNDING
        for (a, b), (low, high) in zip(inner, outer, strict=True)
    )


def _meet(one: Rectangle, other: Rectangle) -> bool:
    return all(
        a <= high + _ROUNDING and low <= b + _ROUNDING for (a, b), (low, high) in zip(one, other, strict=True)
    )
