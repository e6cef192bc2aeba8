"""Tables of a scene file, each checked on its own; `scene_check` checks what they say about each other."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from components import ComponentError
from components._frames import Vector3
from components.body import Body as BodyComponent
from components.body import CouplingLevel
from components.modal import ModalData

from .units import (
    Angle,
    AngularRate,
    Arm,
    Damping,
    Duration,
    Force,
    Frequency,
    FrictionTorque,
    Length,
    Mass,
    MomentOfInertia,
    PeakRate,
    Position,
    PositiveFrequency,
    PositiveRatio,
    Ratio,
    Stiffness,
    Stiffnesses,
    Torque,
    TurningDamping,
    TurningStiffness,
    TurningStiffnesses,
    to_si,
)

Fidelity = Literal["rigid", "flexible"]
HingeKind = Literal["revolute", "cylindrical", "spherical", "bushing"]
Tensor = tuple[Vector3, Vector3, Vector3]

_AXES = {
    f"{sign}{letter}": tuple(factor if i == j else 0.0 for j in range(3))
    for sign, factor in (("+", 1.0), ("-", -1.0))
    for i, letter in enumerate("xyz")
}


class SceneError(Exception):
    """Everything that is wrong with a scene, one sentence a problem."""

    def __init__(self, problems: list[str]) -> None:
        super().__init__("\n".join(problems))
        self.problems = problems


def _identifier(value: str) -> str:
    if not re.fullmatch(r"[A-Za-z]\w*", value):
        raise ValueError(f"is {value!r}; a name starts with a letter and has only letters, digits and _")
    return value


def _axis(value: object) -> object:
    if not isinstance(value, str) or value not in _AXES:
        raise ValueError(f"is {value!r}; it must be one of +x, -x, +y, -y, +z, -z")
    return _AXES[value]


def _tensor(value: object) -> object:
    """Principal moments (3) or xx, yy, zz, xy, xz, yz (6) of the tensor as a symmetric matrix."""
    if not isinstance(value, list | tuple) or len(value) not in (3, 6):
        raise ValueError(
            f"is {value!r}; give three principal moments, or the six entries xx, yy, zz, xy, xz, yz"
        )
    entries = [to_si(entry, "kg.m2") for entry in value]
    a, b, c, d, e, f = entries if len(entries) == 6 else (*entries, 0.0, 0.0, 0.0)
    return ((a, d, e), (d, b, f), (e, f, c))


def _physical(value: Tensor) -> Tensor:
    """The body component itself says what it accepts."""
    try:
        BodyComponent(modal=ModalData.rigid(1.0, (0.0,) * 3, value, {}).to_arrays(), ports=[])
    except ComponentError as error:
        raise ValueError(str(error)) from None
    return value


Name = Annotated[str, AfterValidator(_identifier)]
Axis = Annotated[Vector3, BeforeValidator(_axis)]
Inertia = Annotated[Tensor, BeforeValidator(_tensor), AfterValidator(_physical)]
Y_AXIS: Vector3 = (0.0, 1.0, 0.0)
ORIGIN: Vector3 = (0.0, 0.0, 0.0)


class Table(BaseModel):
    """A table of the file: frozen, no unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Header(Table):
    """[scene]: what to run."""

    name: Name
    description: str = ""
    until: Duration
    tolerance: PositiveRatio = 1e-4
    largest_step: Duration = 0.02
    preload: bool = False


class Inertial(Table):
    """Mass properties; the inertia is about the centre of mass."""

    mass: Mass
    center_of_mass: Position = ORIGIN
    inertia: Inertia


class RigidBody(Inertial):
    """A rigid body written into the scene, with the points that connections use."""

    points: dict[Name, Position]


class Base(Table):
    """[base]: the spacecraft, fixed unless `free` gives its mass properties."""

    name: Name = "base"
    points: dict[Name, Position]
    free: Inertial | None = None


class Joint(Table):
    """[joint]: stiffnesses of every hinge, and the mode of the panel on its hinges whose damping is given."""

    axial_stiffness: Stiffness = 2e6
    radial_stiffness: Stiffness = 5e6
    cross_stiffness: TurningStiffness = 2e4
    damping_ratio: Ratio = 0.05
    damping_frequency: PositiveFrequency = 184.0


class Friction(Table):
    """[friction]: pins of every hinge; the transition velocity is raised beside a flexible body."""

    coefficient: Ratio = 0.0
    static_ratio: Annotated[PositiveRatio, Field(ge=1.0)] = 1.2
    pin_radius: Length = 0.006
    bending_arm: Arm = 0.0
    stiction_velocity: AngularRate = 0.0167
    flexible_stiction_factor: PositiveRatio = 10.0


class Body(Table):
    """[[body]]: an entry of the catalogue, or a rigid body; options of its flexible model."""

    name: Name
    catalogue: str | None = None
    rigid: RigidBody | None = None
    fidelity: Fidelity | None = None
    fixed_interface_modes: Annotated[int, Field(ge=0)] = 10
    inertia_coupling: CouplingLevel = "full"
    damping_ratio: Ratio | None = None
    damping_scale: Ratio = 1.0
    modes_off: tuple[Annotated[int, Field(ge=0)], ...] = ()
    frequencies_off: tuple[tuple[Frequency, Frequency], ...] = ()

    @property
    def flexible(self) -> bool:
        """Whether the body is flexible unless the run says otherwise."""
        return self.catalogue is not None and self.fidelity != "rigid"

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.catalogue is None) == (self.rigid is None):
            raise ValueError("give either a catalogue entry or a table rigid")
        if self.rigid is not None and self.fidelity == "flexible":
            raise ValueError("only a body of the catalogue can be flexible")
        return self


class Hinge(Table):
    """One hinge of a line between points of its two bodies; stiffnesses along (about) the line come first."""

    name: Name
    inboard: str
    outboard: str
    kind: HingeKind = "revolute"
    translational_stiffness: Stiffnesses | None = None
    rotational_stiffness: TurningStiffnesses | None = None
    harness: bool = False
    sensor: bool = False

    @model_validator(mode="after")
    def _bushing_is_complete(self) -> Self:
        if self.kind == "bushing" and None in (self.translational_stiffness, self.rotational_stiffness):
            raise ValueError("a bushing needs translational_stiffness and rotational_stiffness")
        return self


class Motor(Table):
    """Motorisation spring of a line: torques at the stowed and at the latch angle, positive opening."""

    stowed: Torque
    deployed: Torque

    @model_validator(mode="after")
    def _falling(self) -> Self:
        if not self.stowed > self.deployed:
            raise ValueError("the torque of a spring falls while it opens; stowed must exceed deployed")
        return self


class Harness(Table):
    """Harness of a line: table of the torque that resists opening over the hinge angle."""

    angle: tuple[Angle, ...]
    resisting_torque: tuple[Torque, ...]

    @model_validator(mode="after")
    def _table(self) -> Self:
        if len(self.angle) < 2 or len(self.angle) != len(self.resisting_torque):
            raise ValueError("give at least two angles and as many torques")
        if any(b <= a for a, b in zip(self.angle, self.angle[1:], strict=False)):
            raise ValueError("the angles of the table must increase")
        return self


class Latch(Table):
    """Latch of a line: stiffness of the structure at the line, and how much of it each side contributes.

    A side that is not given adds no compliance. The effective inertia turns the damping ratio into N.m.s/rad.
    """

    stiffness: TurningStiffness
    inboard_stiffness: TurningStiffness | None = None
    outboard_stiffness: TurningStiffness | None = None
    effective_inertia: MomentOfInertia
    damping_ratio: Ratio = 0.02

    @model_validator(mode="after")
    def _sides_stiffer_than_line(self) -> Self:
        for side, stiffness in (("inboard", self.inboard_stiffness), ("outboard", self.outboard_stiffness)):
            if stiffness is not None and stiffness < self.stiffness:
                raise ValueError(
                    f"{side}_stiffness {stiffness:g} N.m/rad is less than the line's {self.stiffness:g}"
                )
        return self


class HingeLine(Table):
    """[[hinge_line]]: one rotation between two bodies; torques are totals that its hinges share."""

    name: Name
    inboard: str
    outboard: str
    axis: Axis
    aligned_angle: Angle
    stowed_angle: Angle = 0.0
    latch_angle: Angle | None = None
    motor: Motor | None = None
    harness: Harness | None = None
    friction_preload: FrictionTorque = 0.0
    latch: Latch | None = None
    hinges: tuple[Hinge, ...]

    @property
    def deployed_angle(self) -> float:
        """Latch angle, where the motor has its deployed torque; by default the aligned angle."""
        return self.aligned_angle if self.latch_angle is None else self.latch_angle

    @property
    def sensor(self) -> str:
        """Name of the hinge whose angle latches the line: the marked one, else the first."""
        return next((hinge.name for hinge in self.hinges if hinge.sensor), self.hinges[0].name)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if not self.hinges:
            raise ValueError("a line needs at least one hinge")
        if sum(hinge.sensor for hinge in self.hinges) > 1:
            raise ValueError("only one hinge of a line can carry the sensor")
        if (self.harness is not None) != any(hinge.harness for hinge in self.hinges):
            raise ValueError("give a table harness and mark the hinges that carry it, or neither")
        if not self.deployed_angle > self.stowed_angle:
            raise ValueError("latch_angle, by default aligned_angle, must exceed stowed_angle")
        return self


class Seat(Table):
    """Where something sits on a body: a point and a rigid arm from it."""

    body: str
    point: str
    offset: Position = ORIGIN


class Pulley(Seat):
    """A pulley fixed to a body."""

    radius: Length


class Ccl(Table):
    """[[ccl]]: closed cable loop; values of one strand. With a guide the cables are led along that body."""

    name: Name
    axis: Axis = Y_AXIS
    preload: Force
    strand_stiffness: Stiffness
    strand_damping: Damping = 0.0
    pulley_1: Pulley
    pulley_2: Pulley
    guide: Seat | None = None


class Damper(Table):
    """[[damper]]: eddy-current damper that sits at a hinge; a peak rate of 0 is a linear damper."""

    name: Name
    hinge: str
    damping_coefficient: TurningDamping
    peak_rate: PeakRate = 0.0


@dataclass(frozen=True, slots=True)
class Scene:
    """A scene file that was read and found consistent."""

    file: str
    text: str
    header: Header
    base: Base
    joint: Joint
    friction: Friction
    bodies: tuple[Body, ...]
    hinge_lines: tuple[HingeLine, ...]
    loops: tuple[Ccl, ...]
    dampers: tuple[Damper, ...]
