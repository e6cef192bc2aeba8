"""Frames of straight beams as they are written down: paths from joint to joint, and mass that is not the beams'."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise
from math import isclose, sqrt

import numpy as np

from ..contract.component import ComponentError, Vector
from ..flexible.beam_frame import BeamSection, Member, beam_frame
from ..flexible.finite_elements import FiniteElementModel

Position = tuple[float, ...]
_ROUNDING = 1e-9  # m


@dataclass(frozen=True)
class Path:
    """A beam through joints, `elements` from each to the next; what of `mass` (kg) is not section is on its axis."""

    name: str
    joints: tuple[str, ...]
    section: BeamSection
    elements: int = 8
    mass: float | None = None

    def spread_section(self, length: float) -> BeamSection:
        """The section with the mass per length that the whole beam (m) has; on the axis it has no rotary inertia."""
        if self.mass is None:
            return self.section
        line_mass = self.mass / length
        if line_mass < self.section.line_mass:
            raise ComponentError(
                f"member {self.name!r} has {self.mass:g} kg, less than the"
                f" {self.section.line_mass * length:g} kg of its section"
            )
        radius = self.section.gyration_radius * sqrt(self.section.line_mass / line_mass)
        return replace(self.section, line_mass=line_mass, gyration_radius=radius)


@dataclass(frozen=True)
class SpreadMass:
    """Totals of a frame that mass without stiffness makes up for, spread evenly along a stretch of some beams.

    The beams run side by side, equal in length and from one x to one other.
    """

    members: tuple[str, ...]
    mass: float
    """of the whole frame, kg"""
    center_of_mass: float
    """x, m"""
    inertia: float
    """about y through the centre of mass, kg m2"""


@dataclass(frozen=True)
class Frame:
    """Joints (name, position in m) and the beams through them."""

    joints: tuple[tuple[str, Position], ...]
    members: tuple[Path, ...]
    spread: SpreadMass | None = None

    def problems(self, arms: Mapping[str, Position]) -> Iterator[str]:
        """What cannot be of members and joints, as sentences; arms: ends (m) of those of a panel, by name."""
        places = {name: np.array(position) for name, position in self.joints}
        for path in self.members:
            for a, b in pairwise(path.joints):
                if _at_one_place(places[a], places[b]):
                    yield f"members.{path.name}: its joints {a} and {b} are at one place; a beam has a length"
        met = dict.fromkeys(name for path in self.members for name in path.joints)
        for a, b in combinations(met, 2):
            joined = any({a, b} == {*ends} for path in self.members for ends in pairwise(path.joints))
            if not joined and _at_one_place(places[a], places[b]):
                yield (
                    f"joints {a} and {b} are at one place, and not joined; give the members that meet there one joint "
                    "(a ring takes two members), or set one of them apart"
                )
        for arm, end in arms.items():
            for name in met:
                if arm not in met and _at_one_place(places[name], np.array(end)):
                    yield f"joint {name} is where the panel's arm {arm} ends, and not joined to it; give it that name"
        yield from self._loose([name for name in arms if name in met])

    def _loose(self, welded: Sequence[str]) -> Iterator[str]:
        """Members that no way leads to from the first, over joints, and over a panel between those welded to it."""
        reached, left = set(self.members[0].joints), list(self.members[1:])
        while True:
            if reached & set(welded):
                reached |= set(welded)
            found = [path for path in left if reached & set(path.joints)]
            if not found:
                break
            reached |= {name for path in found for name in path.joints}
            left = [path for path in left if path not in found]
        if left:
            names = ", ".join(path.name for path in left)
            yield (
                f"members {names}: they are not joined to member {self.members[0].name}; beams meet in joints that "
                "both name, and those that cross elsewhere pass one another"
            )

    def model(self, points: Sequence[str]) -> FiniteElementModel:
        """Finite elements, with these joints as points."""
        places = {name: np.array(position) for name, position in self.joints}
        joints: dict[str, Vector] = {}
        members: list[Member] = []
        low, high, line_mass = _stretch(self.spread, self.members, places) if self.spread else (0.0, 0.0, 0.0)
        for path in self.members:
            section = path.spread_section(_length(path, places))
            loaded = self.spread is not None and path.name in self.spread.members
            stops = (
                _cut(path, places, (low, high)) if loaded else {name: places[name] for name in path.joints}
            )
            joints |= stops
            for start, end in pairwise(stops):
                middle = 0.5 * (stops[start] + stops[end])[0]
                extra = line_mass if loaded and low < middle < high else 0.0
                members.append(Member(start, end, section, path.elements, extra))
        return beam_frame({name: tuple(at) for name, at in joints.items()}, members, points=points)


def _at_one_place(one: Vector, other: Vector) -> bool:
    return float(np.linalg.norm(one - other)) <= _ROUNDING


def _length(path: Path, places: Mapping[str, Vector]) -> float:
    return float(sum(np.linalg.norm(places[b] - places[a]) for a, b in pairwise(path.joints)))


def _cut(path: Path, places: Mapping[str, Vector], cuts: Sequence[float]) -> dict[str, Vector]:
    """Joints of a straight path in order, with further ones where its x passes the cuts."""
    first, last = places[path.joints[0]], places[path.joints[-1]]
    run = last[0] - first[0]
    stops = {name: places[name] for name in path.joints}
    stops |= {f"{path.name} at x = {x:g} m": first + (last - first) * (x - first[0]) / run for x in cuts}
    return dict(sorted(stops.items(), key=lambda stop: (stop[1][0] - first[0]) / run))


def _stretch(
    spread: SpreadMass, paths: Sequence[Path], places: Mapping[str, Vector]
) -> tuple[float, float, float]:
    """Ends (x, m) of the stretch of the loaded beams, and the mass per m of beam on it.

    An even load of mean x and half-length h has the second moment m (x² + h²/3); mass, first and second moment of
    what the beams lack give m, x and h. A section of polar radius of gyration r adds, about y, r²/2 (1 + n²) per
    mass, n being the y component of the beam's direction; so does what rides on it.
    """
    mass, first = spread.mass, spread.mass * spread.center_of_mass
    second = spread.inertia + spread.mass * spread.center_of_mass**2
    for path in paths:
        for a, b in pairwise(places[name] for name in path.joints):
            own = path.section.line_mass * float(np.linalg.norm(b - a))
            across = (a + b)[0::2] / 2.0
            squares = (a @ a + a @ b + b @ b - (a[1] ** 2 + a[1] * b[1] + b[1] ** 2)) / 3.0
            mass -= own
            first -= own * across[0]
            second -= own * (squares + _around(path.section, a, b))
    loaded = [path for path in paths if path.name in spread.members]
    low_end, high_end, length = _common_run(loaded, places)
    a, b = places[loaded[0].joints[0]], places[loaded[0].joints[-1]]
    second -= mass * _around(loaded[0].section, a, b)
    if mass <= 0.0:
        raise ComponentError(
            f"the beams of the frame have {-mass:g} kg more than the {spread.mass:g} kg stated of it"
        )
    middle, variance = first / mass, second / mass - (first / mass) ** 2
    half = sqrt(3.0 * max(variance, 0.0))
    low, high = middle - half, middle + half
    if not (half > 0.0 and low_end <= low and high <= high_end):
        raise ComponentError(
            "the frame's beams leave no even spread with the centre of mass and inertia that are stated of it"
        )
    return low, high, mass * (high_end - low_end) / (len(loaded) * 2.0 * half * length)


def _common_run(loaded: Sequence[Path], places: Mapping[str, Vector]) -> tuple[float, float, float]:
    """The x where all loaded beams start and end, and their length (m)."""
    runs = []
    for path in loaded:
        first, last = places[path.joints[0]], places[path.joints[-1]]
        runs.append((*sorted((first[0], last[0])), _length(path, places), np.linalg.norm(last - first)))
    low, high, length, distance = runs[0]
    same = all(isclose(a, b, abs_tol=_ROUNDING) for run in runs for a, b in zip(run, runs[0], strict=True))
    if not (same and isclose(length, distance, abs_tol=_ROUNDING) and high - low > _ROUNDING):
        raise ComponentError(
            "the members that carry spread_mass must be straight, of one length, and run from one x to one other"
        )
    return float(low), float(high), float(length)


def _around(section: BeamSection, a: Vector, b: Vector) -> float:
    """Inertia per mass (m2) of a section about an axis along y through its centre."""
    along = (b - a) / np.linalg.norm(b - a)
    return float(0.5 * section.gyration_radius**2 * (1.0 + along[1] ** 2))
