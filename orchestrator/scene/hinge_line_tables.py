"""Tables of a scene file about hinge lines: their hinges, motorisation, harness, friction and latch."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import degrees
from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
from pydantic import Field, model_validator

from components.contract.frames import Vector3
from components.numerics.laws import Law, Linear
from components.numerics.laws import Table as TorqueTable

from .plausible import Plausible
from .table import Axis, Name, Table
from .units import (
    Angle,
    AngularClearance,
    AngularRate,
    Distance,
    FrictionTorque,
    MomentOfInertia,
    OpeningRate,
    PositiveAngle,
    PositiveFrequency,
    PositiveRatio,
    Radius,
    Ratio,
    Stiffness,
    Stiffnesses,
    Torque,
    TurningDamping,
    TurningStiffness,
    TurningStiffnesses,
    damping_time,
)

_ROUNDED = 1.001
"""Stiffnesses that are given to three or four digits may miss their series by this factor."""
_ANGLE_ROUND_OFF = 1e-9
_SAMPLES = 16
"""Of a law between two points of its table; a curve through them errs by 0.6 % of the step between both."""
_PER_CENT = "If per cent are meant, write %."
CLEARANCES = ("axial_clearance", "radial_clearance", "cross_clearance")
HingeKind = Literal["revolute", "cylindrical", "spherical", "bushing"]


class Joint(Table):
    """[joint]: stiffnesses of every hinge, and the mode of the panel on its hinges whose damping is given.

    Damping is proportional to stiffness, as structural damping is, which takes its place where the scene has that.
    """

    axial_stiffness: Stiffness = 2e6
    """Along the hinge line."""
    radial_stiffness: Stiffness = 5e6
    """Along the two axes across."""
    cross_stiffness: TurningStiffness = 2e4
    """About the two axes across."""
    axial_clearance: Distance = 0.0
    """Play either way along the hinge line; stiffness and damping act beyond it."""
    radial_clearance: Distance = 0.0
    """Play of the pin in its hole, in any direction across the line."""
    cross_clearance: AngularClearance = 0.0
    """Play in any direction about the two axes across."""
    damping_ratio: Annotated[Ratio, Field(le=1.0)] = 0.05
    """Damping ratio of the mode of a panel on its hinges."""
    damping_frequency: PositiveFrequency = 184.0
    """Frequency of that mode; damping is in proportion to stiffness."""

    @property
    def time(self) -> float:
        """Damping over stiffness, s."""
        return damping_time(self.damping_ratio, self.damping_frequency)


class Friction(Table):
    """[friction]: how friction acts at rest, and the pins of every hinge."""

    law: Literal["sticking", "smooth"] = "sticking"
    """At rest: it holds up to its full torque, or, smooth, it rises with the rate and lets a held line creep."""
    coefficient: Annotated[
        Ratio,
        Plausible("W-friction-data", most=2.0, reason="clean metals in vacuum have less", check=_PER_CENT),
    ] = 0.0
    """Coulomb friction of the hinge pins, sliding."""
    static_ratio: Annotated[PositiveRatio, Field(ge=1.0)] = 1.2
    """Static over sliding friction coefficient."""
    pin_radius: Radius = 0.006
    """Radius of the pins."""
    bending_arm: Distance = 0.0
    """Arm that turns bending moment into pin force; 0 for none."""
    stiction_velocity: AngularRate = 0.0167
    """Hinge rate from which smooth friction is full, and that of pins falls from its static to its sliding value."""
    flexible_stiction_factor: PositiveRatio = 10.0
    """Factor on this rate for friction that sticks, and for smooth friction next to a flexible body."""


class Hinge(Table):
    """One hinge of a line between points of its two bodies; stiffnesses along (about) the line come first."""

    name: Name
    """Name of the hinge."""
    inboard: str
    """Point of the line's inboard body."""
    outboard: str
    """Point of the line's outboard body."""
    kind: HingeKind = "revolute"
    """Kind of joint: a cylindrical hinge is free along the line, a spherical one about all axes."""
    translational_stiffness: Stiffnesses | None = None
    """Along the line and the two axes across, in place of those of [joint]."""
    rotational_stiffness: TurningStiffnesses | None = None
    """About the line and the two axes across, in place of those of [joint]."""
    axial_clearance: Distance | None = None
    """Play either way along the line, in place of that of [joint]."""
    radial_clearance: Distance | None = None
    """Play in any direction across the line, in place of that of [joint]."""
    cross_clearance: AngularClearance | None = None
    """Play in any direction about the two axes across, in place of that of [joint]."""
    harness: bool = False
    """Whether it carries the line's harness."""
    sensor: bool = False
    """Whether its angle latches the line; by default the first hinge."""

    @model_validator(mode="after")
    def _bushing_is_complete(self) -> Self:
        if self.kind == "bushing" and None in (self.translational_stiffness, self.rotational_stiffness):
            raise ValueError("a bushing needs translational_stiffness and rotational_stiffness")
        return self

    def stiffnesses(self, joint: Joint) -> tuple[Vector3, Vector3]:
        """Stiffness along (N/m) and about (N.m/rad) the line and the two axes across."""
        axial = 0.0 if self.kind == "cylindrical" else joint.axial_stiffness
        cross = 0.0 if self.kind == "spherical" else joint.cross_stiffness
        along = self.translational_stiffness or (axial, joint.radial_stiffness, joint.radial_stiffness)
        return along, self.rotational_stiffness or (0.0, cross, cross)

    def clearances(self, joint: Joint) -> dict[str, float]:
        """Clearances (m, rad) by name that are not 0; those of [joint] where the hinge has stiffness."""
        along, about = self.stiffnesses(joint)
        found = {}
        for name, held in zip(CLEARANCES, (along[:1], along[1:], about[1:]), strict=True):
            own = getattr(self, name)
            if size := own if own is not None else any(held) and getattr(joint, name):
                found[name] = size
        return found

    @model_validator(mode="after")
    def _plays_against_stiffness(self) -> Self:
        along, about = self.stiffnesses(Joint())
        for name, held in zip(CLEARANCES, (along[:1], along[1:], about[1:]), strict=True):
            if getattr(self, name) and not any(held):
                raise ValueError(f"{name} needs stiffness beyond it, and the hinge has none there")
        return self


class Motor(Table):
    """Motor of a line, positive opening: a spring by its torques at the stowed and at the latch angle, or a table.

    What a variant lays over it takes its place. A motor with hysteresis resists being wound up.
    """

    stowed: Torque | None = None
    """Torque of a spring at the stowed angle, positive opening."""
    deployed: Torque | None = None
    """Torque of a spring at the latch angle, positive opening."""
    angle: tuple[Angle, ...] = ()
    """Hinge angles of a table, increasing."""
    torque: tuple[Torque, ...] = ()
    """Torques over these angles while the line opens, positive opening; monotone cubics (PCHIP) lie between them."""
    closing_torque: tuple[Torque, ...] = ()
    """Torques over these angles while the line closes, where hysteresis makes them more."""

    @property
    def loop(self) -> TorqueLoop | None:
        """The table, None of a spring."""
        return TorqueLoop.of(self.angle, self.torque, self.closing_torque) if self.angle else None

    @model_validator(mode="after")
    def _spring_or_table(self) -> Self:
        if not self.angle and None in (self.stowed, self.deployed):
            raise ValueError("give its torques stowed and deployed, or a table of angle and torque")
        if self.angle and (self.stowed, self.deployed) != (None, None):
            raise ValueError("is a spring (stowed, deployed) and a table (angle, torque); give one of them")
        if self.stowed is not None and self.deployed is not None and not self.stowed >= self.deployed:
            raise ValueError(
                "the torque of a spring falls while it opens; stowed must not be below deployed; give a table of angle "
                "and torque where it rises"
            )
        _check_loop(self.angle, self.torque, self.closing_torque, more=True)
        return self


class Harness(Table):
    """Harness of a line: table of the torque that resists opening over the hinge angle."""

    angle: tuple[Angle, ...]
    """Hinge angles, increasing."""
    resisting_torque: tuple[Torque, ...]
    """Torque that resists opening over these angles; monotone cubics (PCHIP) lie between them."""
    closing_torque: tuple[Torque, ...] = ()
    """The same while the line closes, where hysteresis makes it less."""

    @property
    def opening_law(self) -> Law:
        """Its torque while the line opens, positive opening, and its potential, over the hinge angle."""
        return TorqueTable(self.angle, [-torque for torque in self.resisting_torque])

    @property
    def loop(self) -> TorqueLoop:
        """The table, positive opening."""
        opening, closing = (
            tuple(-torque for torque in torques) for torques in (self.resisting_torque, self.closing_torque)
        )
        return TorqueLoop.of(self.angle, opening, closing)

    @model_validator(mode="after")
    def _table(self) -> Self:
        if len(self.angle) < 2:
            raise ValueError("give at least two angles and as many torques")
        _check_loop(self.angle, self.resisting_torque, self.closing_torque, more=False)
        return self


class TorqueLoop(NamedTuple):
    """Torque (N.m, positive opening) over angles (rad): the mean of both ways, and half of their difference.

    Where both ways differ, each is its own table's law, sampled so densely that what opens by mean less half is it.
    """

    angle: tuple[float, ...]
    mean: tuple[float, ...]
    half: tuple[float, ...]

    @classmethod
    def of(cls, angle: Sequence[float], opening: Sequence[float], closing: Sequence[float]) -> Self:
        """From the torques of both ways, closing nowhere below opening; none for closing is the same.

        Beyond the table opening goes on by its law, and the difference stays.
        """
        if not closing or tuple(closing) == tuple(opening):
            return cls(tuple(angle), tuple(opening), (0.0,) * len(angle))
        laws = [TorqueTable(angle, torque) for torque in (opening, closing)]
        first, last = angle[0], angle[-1]
        beyond = (
            np.array((0.5, 1.0, 2.0)) / _SAMPLES**2 * (last - first)
        )  # on a line, which goes on beyond them
        inside = [np.linspace(a, b, _SAMPLES, endpoint=False) for a, b in pairwise(angle)]
        points = np.concatenate([first - beyond[::-1], *inside, [last], last + beyond]).tolist()
        clamped = np.clip(points, first, last).tolist()
        half = [max(0.0, 0.5 * (laws[1].value(s) - laws[0].value(s))) for s in clamped]
        return cls(
            tuple(points), tuple(laws[0].value(s) + h for s, h in zip(points, half, strict=True)), tuple(half)
        )

    def shared(self, count: int) -> Self:
        """The share of one of several hinges."""
        mean, half = (tuple(torque / count for torque in torques) for torques in (self.mean, self.half))
        return self._replace(mean=mean, half=half)


def _check_loop(
    angle: Sequence[float], opening: Sequence[float], closing: Sequence[float], *, more: bool
) -> None:
    """ValueError where a table of torques both ways is none; more: whether closing may take more, or less."""
    if angle and (len(angle) < 2 or len(angle) != len(opening)):
        raise ValueError("give at least two angles and as many torques")
    if any(b - a < _ANGLE_ROUND_OFF for a, b in pairwise(angle)):
        raise ValueError("the angles of the table must increase")
    if closing and len(closing) != len(angle):
        raise ValueError(f"closing_torque has {len(closing)} torques for {len(angle)} angles")
    differences = [b - a if more else a - b for a, b in zip(opening, closing, strict=False)]
    if any(difference < 0.0 for difference in differences):
        word = "below" if more else "above"
        raise ValueError(
            f"hysteresis only takes energy; closing_torque must nowhere be {word} the torque of opening"
        )


class MeasuredLatch(Table):
    """Measured torque of a latched line over its deflection, both increasing through zero.

    Points without torque make a play, within which the latch is loose.
    """

    deflection: tuple[Angle, ...]
    """Deflections of the latched line, increasing through zero."""
    torque: tuple[Torque, ...]
    """Torques at these deflections, increasing through zero; several may be 0."""

    @property
    def play(self) -> tuple[float, float]:
        """First and last deflection without torque; both 0 without any."""
        loose = [angle for angle, torque in zip(self.deflection, self.torque, strict=True) if torque == 0.0]
        return (loose[0], loose[-1]) if loose else (0.0, 0.0)

    @model_validator(mode="after")
    def _curve(self) -> Self:
        if len(self.deflection) < 2 or len(self.deflection) != len(self.torque):
            raise ValueError("give at least two deflections and as many torques")
        if any(b - a < _ANGLE_ROUND_OFF for a, b in pairwise(self.deflection)):
            raise ValueError("deflections must increase")
        if any(b - a < _ANGLE_ROUND_OFF and not a == b == 0.0 for a, b in pairwise(self.torque)):
            raise ValueError("torques must increase, except where they are 0, within the play of the latch")
        if not any(self.torque):
            raise ValueError("the curve has no torque; give points beyond the play of the latch")
        return self


class Latch(Table):
    """Latch of a line: its whole stiffness, and how much of the structure's compliance each side contributes.

    A side that is not given adds no compliance. What neither side models is the latch spring: where bodies hold
    all of it, the latch is kinematic.
    """

    kind: Literal["by_fidelity", "kinematic", "spring"] = "by_fidelity"
    """Whether the line is locked, or held by a spring: by_fidelity is a spring of the compliance that bodies lack."""
    stiffness: TurningStiffness
    """Stiffness of the latched line with both sides of the structure; a flexible side without its own softens it."""
    inboard_stiffness: TurningStiffness | None = None
    """Stiffness of the structure on the inboard side, in series; without it that side adds no compliance."""
    outboard_stiffness: TurningStiffness | None = None
    """The same on the outboard side."""
    effective_inertia: MomentOfInertia | None = None
    """Inertia that turns the damping ratio into N.m.s/rad; by default that of the bodies."""
    damping_ratio: Annotated[
        Ratio, Plausible("W-end-data", most=2.0, reason="twice critical", check=_PER_CENT)
    ] = 0.02
    """Damping ratio of the latched line; with structural damping of the scene it has that instead."""
    measured: MeasuredLatch | None = None
    """Measured torque of the hinges, in place of a spring where both sides are modelled with compliance."""
    play: Annotated[
        PositiveAngle | None, Plausible("W-end-data", "rad", most=0.1, reason="milliradians are usual")
    ] = None
    """Deflection either way within which the latch is loose; its stiffness and damping act beyond."""

    @property
    def loose(self) -> tuple[float, float]:
        """Deflections between which the latch is loose, by its play or its measured curve; equal without play."""
        if self.play is not None:
            return -self.play, self.play
        return (0.0, 0.0) if self.measured is None else self.measured.play

    @model_validator(mode="after")
    def _play_of_a_spring(self) -> Self:
        if self.kind == "kinematic" and self.loose[0] < self.loose[1]:
            raise ValueError("a kinematic latch has no play; give kind by_fidelity or spring")
        if self.play is not None and self.measured is not None:
            raise ValueError("the measured curve says what play there is; leave out play or measured")
        return self

    @model_validator(mode="after")
    def _sides_stiffer_than_line(self) -> Self:
        for side, stiffness in (("inboard", self.inboard_stiffness), ("outboard", self.outboard_stiffness)):
            if stiffness is not None and stiffness < self.stiffness:
                raise ValueError(
                    f"{side}_stiffness {stiffness:g} N.m/rad is less than the line's {self.stiffness:g}"
                )
        if self.inboard_stiffness is not None and self.outboard_stiffness is not None:
            both = 1.0 / (1.0 / self.inboard_stiffness + 1.0 / self.outboard_stiffness)
            if self.stiffness > _ROUNDED * both:
                raise ValueError(
                    f"inboard_stiffness and outboard_stiffness in series are {both:g} N.m/rad, less than the line's "
                    f"{self.stiffness:g}, which they are part of"
                )
        return self


class Presliding(Table):
    """Elastic deflection of a line before its friction breaks away.

    The damping ratio is that of Canudas de Wit, Olsson, Astrom and Lischinsky (1995).
    """

    stiffness: TurningStiffness | None = None
    """Stiffness of the line while friction sticks; by default it breaks away after 1e-4 of the line's travel."""
    damping_ratio: Ratio = 0.5
    """Damping ratio while it sticks."""
    effective_inertia: MomentOfInertia | None = None
    """Inertia that turns the damping ratio into N.m.s/rad; by default that of the bodies."""


class EndStop(Table):
    """End stop of a line, the total of its hinges: from an angle on, by default the deployed angle, it pushes back.

    A torque in parallel with each of its hinges, linear in the angle, with damping that never pulls. A line latches
    before it reaches a stop beyond its latch angle.
    """

    angle: Angle | None = None
    """Angle from which it pushes back; by default the deployed angle."""
    stiffness: TurningStiffness
    """Total of the line's hinges."""
    damping: TurningDamping = 0.0
    """Total of the line's hinges."""
    full_damping_penetration: PositiveAngle | None = None
    """Angle beyond the stop's from which damping is full; by default 1 mrad, up to which it rises from nothing."""


class HingeLine(Table):
    """[[hinge_line]]: one rotation between two bodies; torques are totals that its hinges share."""

    name: Name
    """Name of the line."""
    inboard: str
    """Body on the side of the spacecraft."""
    outboard: str
    """Body that it carries."""
    axis: Axis
    """Hinge line; a positive turn of the outboard body about it opens."""
    aligned_angle: Angle
    """Hinge angle at which the axes of both bodies coincide."""
    stowed_angle: Angle = 0.0
    """Hinge angle of the stowed configuration."""
    start_angle: Angle | None = None
    """Hinge angle at which a run begins; by default the stowed angle."""
    start_rate: OpeningRate | None = None
    """Hinge rate at which a run begins, positive opening; by default 0, or what loops and cable loops require."""
    latch_angle: Angle | None = None
    """Hinge angle at which it latches; by default the aligned angle."""
    held: bool = False
    """Whether the line is fixed: the bodies that it joins are one rigid group."""
    motor: Motor | None = None
    """Motor that opens the line, total of its hinges."""
    harness: Harness | None = None
    """Harness that resists opening, total of the hinges that carry it."""
    friction_preload: FrictionTorque = 0.0
    """Friction torque at any load, the total of its hinges, until latch-up."""
    presliding: Presliding | None = None
    """Elastic deflection before its friction breaks away."""
    latch: Latch | None = None
    """Latch that holds the line at the end of its travel."""
    end_stop: EndStop | None = None
    """End stop that limits the travel."""
    hinges: tuple[Hinge, ...]
    """Hinges between the two bodies."""

    @property
    def deployed_angle(self) -> float:
        """Latch angle, where the motor has its deployed torque; by default the aligned angle."""
        return self.aligned_angle if self.latch_angle is None else self.latch_angle

    @property
    def initial_angle(self) -> float:
        """Angle at which a run begins."""
        return self.stowed_angle if self.start_angle is None else self.start_angle

    @property
    def stop_angle(self) -> float | None:
        """Angle at which its end stop begins to push; None where it has none."""
        if self.end_stop is None:
            return None
        return self.deployed_angle if self.end_stop.angle is None else self.end_stop.angle

    @property
    def has_friction(self) -> bool:
        """Whether it has friction, or hysteresis, in addition to the friction of its pins."""
        loops = (table.loop for table in (self.motor, self.harness) if table is not None)
        return self.friction_preload > 0.0 or any(any(loop.half) for loop in loops if loop is not None)

    @property
    def is_pivot(self) -> bool:
        """Whether it opens to nowhere, as a joint within a linkage: without a motor and what ends its motion."""
        bare = (
            self.motor is None and self.latch is None and self.end_stop is None and self.latch_angle is None
        )
        return bare and self.deployed_angle <= self.stowed_angle

    @property
    def is_open_ended(self) -> bool:
        """Whether it opens to an angle where nothing keeps it."""
        return self.latch is None and self.end_stop is None and not self.is_pivot

    @property
    def motor_law(self) -> Law:
        """Torque of its motor while it opens, and its potential, over the hinge angle; no torque without one."""
        motor = self.motor
        if motor is None:
            return Linear(0.0)
        if motor.angle or motor.stowed is None or motor.deployed is None:
            return TorqueTable(motor.angle, motor.torque)
        rate = (motor.stowed - motor.deployed) / (self.deployed_angle - self.stowed_angle)
        return Linear(rate, self.stowed_angle, motor.stowed)

    @property
    def motor_energy(self) -> float:
        """Energy (J) that the motor gives from the initial to the deployed angle, 0 without one."""
        if self.initial_angle >= self.deployed_angle:
            return 0.0
        return max(
            0.0, self.motor_law.potential(self.initial_angle) - self.motor_law.potential(self.deployed_angle)
        )

    @property
    def sensor(self) -> str:
        """Name of the hinge whose angle latches the line: the marked one, else the first."""
        return next((hinge.name for hinge in self.hinges if hinge.sensor), self.hinges[0].name)

    @property
    def _starts_beyond_its_latch(self) -> bool:
        latches = self.latch is not None and not self.held
        return latches and self.initial_angle > self.deployed_angle + _ANGLE_ROUND_OFF

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if not self.hinges:
            raise ValueError("a line needs at least one hinge")
        if sum(hinge.sensor for hinge in self.hinges) > 1:
            raise ValueError("only one hinge of a line can carry the sensor")
        if (self.harness is not None) != any(hinge.harness for hinge in self.hinges):
            raise ValueError("give a table harness and mark the hinges that carry it, or neither")
        if not self.is_pivot and not self.deployed_angle > self.stowed_angle:
            ends, stowed = degrees(self.deployed_angle), degrees(self.stowed_angle)
            raise ValueError(
                f"latch_angle, by default aligned_angle, is {ends:g} deg and must exceed stowed_angle, {stowed:g} deg; "
                "a line without a latch needs it too, as the angle where its motor has its deployed torque"
            )
        if self.stop_angle is not None and self.stop_angle <= self.initial_angle:
            stop, start = degrees(self.stop_angle), degrees(self.initial_angle)
            raise ValueError(
                f"end_stop is at {stop:g} deg and the line starts at {start:g} deg; a stop must be beyond the start"
            )
        if self.held and self.start_rate:
            raise ValueError("a held line does not move; leave out start_rate or held")
        if self._starts_beyond_its_latch:
            start, latch = degrees(self.initial_angle), degrees(self.deployed_angle)
            raise ValueError(
                f"start_angle {start:g} deg is beyond the latch angle {latch:g} deg; the line would never latch"
            )
        return self
