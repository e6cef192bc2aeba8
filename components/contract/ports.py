"""Ports, where mechanical power flows, and the variables that make one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

from .frames import Quaternion, Vector3
from .quantity import Quantity

MOTION_SIZE, WRENCH_SIZE = 13, 6


@dataclass(frozen=True, slots=True)
class Port:
    """A place where mechanical power flows.

    side "body": gives `position, orientation, velocity, angular_velocity`, takes `force, torque`.
    side "connection": the other way round. All in world axes, torque about the port's origin.
    order: 2 where wrenches are held over a step, 4 where they are linear in time, see `slope_layout`.
    """

    name: str
    side: Literal["body", "connection"]
    order: Literal[2, 4] = 2


class TerminalMember(NamedTuple):
    """A variable of a terminal: its name there, its name in the component, and whether it flows ("inflow")."""

    name: str
    variable: str
    kind: Literal["signal", "inflow", "outflow"] = "signal"


class Terminal(NamedTuple):
    """Variables that belong together, for tools that connect them at once.

    rule: "plug" where all members are to be connected, "bus" where any may be.
    """

    name: str
    kind: str
    description: str
    members: tuple[TerminalMember, ...]
    rule: Literal["plug", "bus"] = "plug"


class PortMotion(NamedTuple):
    """Motion of a port, world axes: m, unit quaternion, m/s, rad/s."""

    position: Vector3
    orientation: Quaternion
    velocity: Vector3
    angular_velocity: Vector3

    @classmethod
    def read(cls, v: Sequence[float]) -> PortMotion:
        """From 13 numbers in declared order."""
        x, y, z, qw, qx, qy, qz, vx, vy, vz, wx, wy, wz = v
        return cls((x, y, z), (qw, qx, qy, qz), (vx, vy, vz), (wx, wy, wz))


class PortMoments(NamedTuple):
    """First moments over the last step of a port's velocity (m) and angular velocity (rad), world axes."""

    velocity: Vector3
    angular_velocity: Vector3

    @classmethod
    def read(cls, v: Sequence[float]) -> PortMoments:
        """From 6 numbers in declared order."""
        vx, vy, vz, wx, wy, wz = v
        return cls((vx, vy, vz), (wx, wy, wz))


def port_layout(port: Port) -> tuple[tuple[Quantity, ...], tuple[Quantity, ...]]:
    """Inputs and outputs of a port, each in the order they take in flat arrays (13 and 6 scalars)."""
    n = port.name
    motion = (
        Quantity(f"{n}.position", "m", f"Position of port {n}, world axes", 3),
        Quantity(f"{n}.orientation", "1", f"Quaternion of port {n}, scalar first", 4, (1.0, 0.0, 0.0, 0.0)),
        Quantity(f"{n}.velocity", "m/s", f"Velocity of port {n}, world axes", 3),
        Quantity(f"{n}.angular_velocity", "rad/s", f"Angular velocity of port {n}, world axes", 3),
    )
    wrench = (
        Quantity(f"{n}.force", "N", f"Force on the body at port {n}, world axes", 3),
        Quantity(f"{n}.torque", "N.m", f"Torque on the body about the origin of port {n}, world axes", 3),
    )
    return (wrench, motion) if port.side == "body" else (motion, wrench)


def slope_layout(port: Port) -> tuple[tuple[Quantity, ...], tuple[Quantity, ...]]:
    """Inputs and outputs that make a port of order 4, each in the order they take in flat arrays (6 scalars each).

    Over a step of size h a wrench is u + u_slope P1(t), P1 = 2 t / h - 1, with `force` and `torque` its mean u. The
    moment of a velocity is the integral of P1 v dt, so that slope times moment is work. Empty for a port of order 2.
    """
    if port.order == 2:
        return ((), ())
    n = port.name
    moments = (
        Quantity(
            f"{n}.velocity_moment", "m", f"First moment of the velocity of port {n} over the last step", 3
        ),
        Quantity(
            f"{n}.angular_velocity_moment",
            "rad",
            f"First moment of the angular velocity of port {n} over the last step",
            3,
        ),
    )
    slopes = (
        Quantity(f"{n}.force_slope", "N", f"Half the change of the force at port {n} over the step", 3),
        Quantity(f"{n}.torque_slope", "N.m", f"Half the change of the torque at port {n} over the step", 3),
    )
    return (slopes, moments) if port.side == "body" else (moments, slopes)
