"""What a run with a prescribed motion shows over time: the law, accelerations, joint loads, modes, deflections.

Accelerations are differences of recorded momenta and attitudes, so exact means over the steps, at their middles. Of
bodies and joints that an array repeats, by a number at the end of their names, the first stands for all.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from components import FanfoldError
from components.contract.roles import HINGE_LOAD
from components.flexible.modal import ModalData

from ...results.result import Result
from ...results.signal import EVENT_WIDTH
from ...scene.bodies import body_model
from ..stress.model import scene_of
from .deflection import deflections, moving

Vector = NDArray[np.float64]
Curves = dict[str, tuple[Vector, Vector]]
"""Times (s) and values by name."""

_UNSEEN = 1e-3
"""Of the largest value of all axes: less is not seen beside it."""
_BESIDE = 0.1
"""Of the largest curve in a panel: smaller ones have a panel of their own."""
_NOTHING = 1e-5
_FEW = 8
_MODES = 3


class Panel(NamedTuple):
    """Curves of one quantity; label: with its unit."""

    label: str
    curves: Curves


class History(NamedTuple):
    """A figure's worth of panels over time."""

    name: str
    caption: str
    panels: tuple[Panel, ...]


def histories(result: Result) -> Iterator[History]:
    """Every history that the result allows; none of a run that follows no prescribed motion."""
    if not moving(result):
        return
    for name, caption, panels_of in _HISTORIES:
        panels = tuple(panel for panel in panels_of(result) if panel.curves)
        if panels:
            yield History(name, caption, panels)


def first_of_arrays(names: Iterable[str]) -> list[str]:
    """The first of the names that differ by a number at their ends only, in order."""
    found: dict[str, str] = {}
    for name in names:
        found.setdefault(re.sub(r"_\d+$", "", name), name)
    return list(found.values())


def _laws(result: Result) -> Iterator[Panel]:
    distances: Curves = {}
    rates: Curves = {}
    accelerations: Curves = {}
    told = (
        ("commanded_distance", "{}, law", distances),
        ("distance", "{}", distances),
        ("commanded_rate", "{}", rates),
        ("commanded_acceleration", "{}", accelerations),
    )
    for name in result.recording("commanded_distance"):
        for variable, label, curves in told:
            if result.has(name, variable):
                curves[label.format(name)] = result.time, result.signal(name, variable)
    for name in result.recording("shift"):
        shift = result.signal(name, "shift")
        if np.ptp(shift) > 0.0:
            distances[name] = result.time, shift
            rates[name] = rate = _rate(result.time, shift)
            accelerations[name] = _rate(*rate)
    yield Panel("distance, m", distances)
    yield Panel("rate of the law, m/s", rates)
    yield Panel("acceleration of the law, m/s2", accelerations)


def _motions(result: Result) -> Iterator[Panel]:
    yield from _laws(result)
    yield from _turning_laws(result)


def _turning_laws(result: Result) -> Iterator[Panel]:
    turns = {name: result.signal(name, "turn") for name in result.recording("turn")}
    turning = {name: turn for name, turn in turns.items() if np.ptp(turn) > 0.0}
    yield Panel("turn, deg", {name: (result.time, np.rad2deg(turn)) for name, turn in turning.items()})
    rates = {name: _rate(result.time, turn) for name, turn in turning.items()}
    yield Panel("rate of turn, rad/s", rates)


def _accelerations(result: Result) -> Iterator[Panel]:
    names = first_of_arrays(result.recording("linear_momentum"))
    curves = {}
    for name, model in _models(result, names).items():
        time, force = _rate(result.time, result.signal(name, "linear_momentum"))
        curves[name] = time, force / model.mass
    yield from by_axis("m/s2", curves)


def _angular_accelerations(result: Result) -> Iterator[Panel]:
    curves = {}
    for name in first_of_arrays(_moving_bodies(result)):
        time, rate = _angular_rate(result.time, result.signal(name, "frame_orientation"))
        curves[name] = _rate(time, rate)
    yield from by_axis("rad/s2", curves)


def _moving_bodies(result: Result) -> list[str]:
    turning = result.recording("frame_orientation")
    return [name for name in result.recording("linear_momentum") if name in turning]


def _joint_accelerations(result: Result) -> Iterator[Panel]:
    joints = [name for name in free_joints(result) if result.has(name, "angular_rate")]
    curves = {name: _rate(result.time, result.signal(name, "angular_rate")) for name in chosen(joints)}
    for group in _of_a_size(curves):
        yield Panel("about own axes, rad/s2", group)


def _loads(unit: str) -> Callable[[Result], Iterator[Panel]]:
    def panels(result: Result) -> Iterator[Panel]:
        names = chosen(free_joints(result))
        loads = {
            name: (result.time, result.signal(name, variable))
            for name, variable in result.in_role(HINGE_LOAD)
            if name in names and result.unit(name, variable) == unit
        }
        for group in _of_a_size(loads):
            yield from by_axis(unit, group)

    return panels


def chosen(joints: Sequence[str]) -> list[str]:
    """All of a few joints, else the first of every array."""
    return list(joints) if len(joints) <= _FEW else first_of_arrays(joints)


def _of_a_size(curves: Curves) -> Iterator[Curves]:
    """Curves that are seen beside each other, the largest first; those that are nothing beside these are left out."""
    sizes = {name: float(np.abs(values).max(initial=0.0)) for name, (_, values) in curves.items()}
    largest = max(sizes.values(), default=0.0)
    left = {name for name, size in sizes.items() if size > _NOTHING * largest}
    while left:
        limit = _BESIDE * max(sizes[name] for name in left)
        group = {name: curve for name, curve in curves.items() if name in left and sizes[name] >= limit}
        left -= set(group)
        yield group


def free_joints(result: Result) -> list[str]:
    """Joints that belong to no hinge line."""
    of_lines = {hinge for line in result.hinge_lines for hinge in line.hinges}
    joints = dict.fromkeys(name for name, _ in result.in_role(HINGE_LOAD))
    return [name for name in joints if name not in of_lines]


def _modes(result: Result) -> Iterator[Panel]:
    """Of the modes of every body that accelerate most."""
    for name, model in _models(result, first_of_arrays(result.recording("modal_coordinate"))).items():
        frequency = model.frequency / (2.0 * np.pi)
        eta = result.signal(name, "modal_coordinate").reshape(result.time.size, -1)
        rate = _rate(result.time, eta)
        time, acceleration = _rate(*rate)
        strongest = np.sort(np.argsort(-np.abs(acceleration).max(axis=0, initial=0.0))[:_MODES])
        labels = {int(k): f"{name} {frequency[k]:.4g} Hz" for k in strongest if k < frequency.size}
        for of, unit, (at, values) in (("velocity", "s", rate), ("acceleration", "s2", (time, acceleration))):
            curves = {label: (at, values[:, k]) for k, label in labels.items()}
            yield Panel(f"{of}, kg(1/2).m/{unit}", curves)


def _deflections(result: Result) -> Iterator[Panel]:
    found = deflections(result, first_of_arrays(result.recording("modal_coordinate")))
    curves = {f"{name}, largest": (result.time, 1e3 * one.size) for name, one in found.items()}
    yield Panel("deformation, mm", curves)


def by_axis(unit: str, curves: Curves) -> Iterator[Panel]:
    """A panel for every axis along which any of the vectors (N, 3) has something to be seen."""
    sizes = np.array([np.abs(values).max(axis=0, initial=0.0) for _, values in curves.values()])
    largest = sizes.reshape(-1, 3).max(axis=0, initial=0.0)
    for k in np.flatnonzero(largest > _UNSEEN * largest.max()).tolist():
        yield Panel(f"{'xyz'[k]}, {unit}", {name: (t, values[:, k]) for name, (t, values) in curves.items()})


def _models(result: Result, names: Iterable[str]) -> dict[str, ModalData]:
    """Of bodies by name; those that can no longer be built from the scene of the result are left out."""
    found: dict[str, ModalData] = {}
    bendable = result.provenance.get("flexible", "") + result.provenance.get("large_deformation", "")
    try:
        tables = {table.name: table for table in scene_of(result).bodies}
        for name in names:
            if name in tables:
                found[name] = body_model(tables[name], flexible=f'"{name}"' in bendable)
    except FanfoldError:
        return found
    return found


def _rate(time: Vector, values: Vector) -> tuple[Vector, Vector]:
    """Middles of the steps and mean rates over them; steps of no length are left out."""
    h = np.diff(time)
    steps = h > EVENT_WIDTH
    rates = np.diff(values, axis=0)[steps] / h[steps].reshape(-1, *[1] * (values.ndim - 1))
    return time[:-1][steps] + 0.5 * h[steps], rates


def _angular_rate(time: Vector, quaternions: Vector) -> tuple[Vector, Vector]:
    """Middles of the steps and mean angular velocities (N - 1, 3), world axes; quaternions with the scalar first."""
    h = np.diff(time)
    steps = h > EVENT_WIDTH
    attitude = scipy.spatial.transform.Rotation.from_quat(quaternions, scalar_first=True)
    turns = (attitude[1:] * attitude[:-1].inv()).as_rotvec()[steps]
    return time[:-1][steps] + 0.5 * h[steps], turns / h[steps, None]


_HISTORIES: Sequence[tuple[str, str, Callable[[Result], Iterable[Panel]]]] = (
    ("prescribed_motion", "Prescribed motion: the law, and what followed it.", _motions),
    ("accelerations", "Accelerations of centres of mass, world axes.", _accelerations),
    ("angular_accelerations", "Angular accelerations of bodies, world axes.", _angular_accelerations),
    ("joint_accelerations", "Angular accelerations at joints about their own axes.", _joint_accelerations),
    ("joint_forces", "Forces at joints on outboard bodies, in the axes of inboard ones.", _loads("N")),
    ("joint_torques", "Torques at joints on outboard bodies, in the axes of inboard ones.", _loads("N.m")),
    ("modal_accelerations", "Modes that accelerate most.", _modes),
    ("deformations", "Largest deformation of bodies against their own frames.", _deflections),
)
