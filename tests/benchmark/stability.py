"""Stability of the coupling over joint and latch stiffness, step size and modes, beside explicit masters.

One spring-driven panel of the workbench on two hinges, started at the latch angle with the rate it latches with. Every
cell has the relative error of the first peak of the line's latch torque against a run that resolves it, whether the
step resolves the latch (H w <= 0.5), and which explicit masters (J Jacobi, G Gauss-Seidel) diverge. The kinematic latch
is a plastic event between two free bodies. At order 4 the explicit masters, which know no slopes, stay away, and the
references are of order 4 at either.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from math import pi, sqrt
from types import SimpleNamespace
from typing import Literal, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from components import rotation_matrix
from components.flexible.modal import ModalData
from components.numerics.oscillators import propagator
from orchestrator.assembly import HingeLine, Link, Part
from orchestrator.cosim.coupling import StepError
from orchestrator.cosim.explicit import ExplicitMaster
from orchestrator.cosim.master import Master
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import ParticipantError, in_process
from orchestrator.cosim.ports import Order
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import as_fmus
from tests.references import catalogue
from tests.references.record import Record

Start = dict[str, float | tuple[float, ...]]
MasterName = Literal["implicit", "jacobi", "gauss-seidel"]
BASELINES: dict[str, MasterName] = {"J": "jacobi", "G": "gauss-seidel"}

LATCH_RATE = 1.370585
"""Hinge rate (rad/s) of the spring-driven panel at 180 degrees, in closed form."""
MOTOR_STIFFNESS, MOTOR_WIND_UP = 0.276930, 8.3198
JOINT_DAMPING = 2.0 * 0.05 / (2.0 * pi * 184.0)
"""Damping over stiffness of a joint (s): 5 % at the 184 Hz of the panel on its hinges."""
RESOLVED = 0.5
"""A latch counts as resolved while H times its angular frequency is below this; see `resolves`."""
STEPS = (1e-4, 1e-3, 5e-3, 2e-2)
_REFERENCE_STEPS = 600
_LONGEST_WINDOW = 800


class Run(NamedTuple):
    """A finished or failed run."""

    record: Record
    master: Master
    failure: str


def run(
    parts: Sequence[Part],
    links: Sequence[Link],
    lines: Sequence[HingeLine],
    until: float,
    settings: Settings,
    name: MasterName = "implicit",
    *,
    preload: bool = False,
    native: bool = False,
) -> Run:
    """Run a scene in process or as native FMUs with the chosen master and keep what it recorded."""
    scene = SimpleNamespace(name="scene", parts=parts)
    with as_fmus(scene, "native") if native else nullcontext(in_process(parts)) as participants:  # type: ignore[arg-type]
        network = Network(participants, links, (settings.order or 2) if name == "implicit" else 2)
        record = Record(network)
        if name == "implicit":
            master = Master(network, lines, record, settings)
        else:
            master = ExplicitMaster(network, lines, record, settings, name)
        try:
            master.initialize(preload=preload)
            master.run(until)
        except (StepError, ParticipantError) as error:
            return Run(record, master, str(error))
        return Run(record, master, "")


def panel_data(modes: int) -> ModalData:
    """The workbench panel with that many flexible modes; rigid for none."""
    flexible = catalogue.entry("workbench_panel").flexible(max(0, modes - 6))
    if modes:
        return flexible
    points = dict(zip(flexible.point_names, flexible.point_positions, strict=True))
    return ModalData.rigid(flexible.mass, flexible.center_of_mass, flexible.inertia, points)


def panel_scene(
    data: ModalData,
    joint: float,
    latch: float,
    damping: float = 1.0,
    mode: Literal["mean", "endpoint"] = "mean",
) -> tuple[list[Part], list[Link], list[HingeLine]]:
    """The panel at its latch angle with its latch rate; joint in N/m per hinge, latch in N.m/rad per line."""
    sides = {"left": 0.565, "right": -0.565}
    spin = np.array((0.0, -LATCH_RATE, 0.0))
    state: Start = {
        "damping_scale": damping,
        "initial_angular_velocity": tuple(spin),
        "initial_velocity": tuple(np.cross(spin, data.center_of_mass)),
    }
    base = [{"name": side, "position": (0.0, y, 0.0)} for side, y in sides.items()]
    ports = [{"name": side, "point": f"hl_{side}"} for side in sides]
    parts = [
        Part("base", "fixed_base", {"ports": base}, {}),
        Part("panel", "body", {"modal": data.to_arrays(), "ports": ports}, state),
    ]
    hinge = {"axis": (0.0, -1.0, 0.0), "latch": "spring", "wrench_mode": mode}
    start: Start = {
        "translational_damping": (0.0, JOINT_DAMPING * joint, JOINT_DAMPING * joint),
        "rotational_stiffness": (0.0, 1e-2 * joint, 1e-2 * joint),
        "rotational_damping": (0.0, 1e-2 * JOINT_DAMPING * joint, 1e-2 * JOINT_DAMPING * joint),
        "aligned_angle": pi,
        "stowed_angle": pi - 1e-9,
        "latch_angle": pi + 1e-7,
        "latch_automatic": 0.0,
        "motor_stiffness": 0.5 * MOTOR_STIFFNESS,
        "motor_wind_up": MOTOR_WIND_UP,
        "latch_stiffness": 0.5 * latch,
    }
    links = []
    for side in sides:
        axial = joint if side == "left" else 0.0
        parts.append(
            Part(f"{side}_hinge", "hinge", hinge, start | {"translational_stiffness": (axial, joint, joint)})
        )
        links.append(Link(("base", side), (f"{side}_hinge", "inboard")))
        links.append(Link(("panel", side), (f"{side}_hinge", "outboard")))
    hinges = tuple(f"{side}_hinge" for side in sides)
    return parts, links, [HingeLine("HL", hinges, hinges[0], latches=True, kinematic=False)]


class Verdict(NamedTuple):
    """How a run went: diverged or not, its peak latch torque (N.m), and its largest passing energy excess."""

    diverged: bool
    peak: float
    excess: float
    residual: float


def latch_torque(record: Record) -> np.ndarray:
    """Magnitude of the line's latch torque over time (N.m)."""
    return np.abs(sum(record.signal(f"{side}_hinge", "latch_torque") for side in ("left", "right")))


def peak(times: Sequence[float], values: np.ndarray) -> float:
    """Largest value of the cubic interpolant."""
    if len(times) < 4:
        return float(values.max())
    curve = CubicSpline(times, values)
    fine = np.linspace(times[0], times[-1], 20 * len(times))
    return float(curve(fine).max())


def judge(outcome: Run, window: float) -> Verdict:
    """Energies relative to the panel's kinetic energy at the start.

    An unresolved stiff coordinate may hold more than the scene has, for a few steps; a run diverges when it
    stops, or when the excess is not past its maximum in the last quarter, or when the balance is open.
    """
    record = outcome.record
    if outcome.failure or len(record.times) < 4:
        return Verdict(True, np.nan, np.inf, np.inf)
    kinetic = float(record.signal("panel", "kinetic_energy")[0])
    excess = record.scene("stored_energy") / kinetic
    excess -= excess[0]
    quarter = len(excess) // 4
    largest = kinetic * max(1.0, float(excess.max()))
    residual = float(np.abs(record.scene("energy_residual")).max()) / largest
    grows = float(excess[-quarter:].max()) > max(0.05, float(excess[:-quarter].max()))
    inside = max(4, int(np.searchsorted(record.times, window)) + 1)
    found = peak(record.times[:inside], latch_torque(record)[:inside])
    return Verdict(grows or residual > 1e-2, found, float(excess.max()), residual)


class Cell(NamedTuple):
    """One cell of the table; error is relative, NaN where the window ends before the peak."""

    error: float
    resolved: bool
    implicit: Verdict
    baselines: str


def latch_frequency(data: ModalData, latch: float) -> float:
    """Angular frequency of the rigid panel on its latch."""
    arm = data.center_of_mass
    return sqrt(latch / (data.inertia[1, 1] + data.mass * float(arm @ arm)))


def resolves(data: ModalData, latch: float, damping: float, h: float) -> bool:
    """Whether a step resolves the latch on the panel, and the latch is softer than the arm it turns in a step."""
    turns = data.rotation[[data.point_names.index(f"hl_{side}") for side in ("left", "right")], 1]
    held = propagator(data.frequency, damping * data.damping_ratio, h).b1
    arm = float((turns**2 @ held).max()) if data.frequency.size else 0.0
    return h * latch_frequency(data, latch) <= RESOLVED and 0.5 * latch * arm <= RESOLVED


def sweep_row(
    modes: int,
    damping: float,
    joint: float,
    latch: float,
    steps: Sequence[float],
    count: int,
    order: Order = 2,
    *,
    native: bool = False,
) -> list[Cell]:
    """One row of the table: all step sizes at one set of stiffnesses; explicit masters beside order 2 only."""
    data = panel_data(modes)
    frequency = latch_frequency(data, latch)
    window = pi / frequency
    scene = panel_scene(data, joint, latch, damping)
    endpoint = panel_scene(data, joint, latch, damping, "endpoint")
    tight = Settings(fixed_step=window / _REFERENCE_STEPS, order=4)
    reference = judge(run(*scene, window, tight, native=native), window).peak
    baselines = BASELINES if order == 2 else {}
    cells = []
    for h in steps:
        reaches = window / h <= _LONGEST_WINDOW
        until = max(count * h, window if reaches else 0.0)
        settings = Settings(fixed_step=h, order=order)
        implicit = judge(run(*scene, until, settings, native=native), window)
        explicit = {key: run(*endpoint, count * h, settings, name) for key, name in baselines.items()}
        failed = [key for key, outcome in explicit.items() if judge(outcome, window).diverged]
        error = abs(implicit.peak / reference - 1.0) if reaches else np.nan
        cells.append(Cell(error, resolves(data, latch, damping, h), implicit, "".join(failed)))
    return cells


class PlasticEvent(NamedTuple):
    """A kinematic latch between two free bodies: relative changes that should be zero.

    energy_drop: from the kinetic energy of the one body that both become with their momenta kept; `reduced`:
    from J_eff w² / 2 with the hinge rate alone; 1e-7 of the hinge's motion passes in the impulse itself.
    """

    linear_momentum: float
    angular_momentum: float
    energy_drop: float
    reduced: float
    rate_left: float


def free_pair(joint: float = 2e6) -> tuple[list[Part], list[Link], list[HingeLine]]:
    """Two free rigid panels on one hinge line, 0.5 rad before their kinematic latch."""
    points = {"left": (0.0, 0.5, 0.0), "right": (0.0, -0.5, 0.0)}
    angle, spins = 0.5, ((0.0, 0.3, 0.0), (0.0, -1.7, 0.0))
    bodies = (
        ModalData.rigid(8.0, (-0.8, 0.0, 0.0), np.diag((0.9, 1.8, 2.7)), points),
        ModalData.rigid(7.5, (0.77, 0.0, 0.0), np.diag((0.8, 1.6, 2.4)), points),
    )
    turns = ((1.0, 0.0, 0.0, 0.0), (float(np.cos(0.5 * angle)), 0.0, float(np.sin(0.5 * angle)), 0.0))
    parts = []
    for name, data, turn, spin in zip(("a", "b"), bodies, turns, spins, strict=True):
        arm = rotation_matrix(turn) @ data.center_of_mass
        motion: Start = {
            "initial_orientation": turn,
            "initial_angular_velocity": spin,
            "initial_velocity": tuple(np.cross(spin, arm)),
        }
        ports = [{"name": side, "point": side} for side in points]
        parts.append(Part(name, "body", {"modal": data.to_arrays(), "ports": ports}, motion))
    links = []
    for side in points:
        start: Start = {
            "translational_stiffness": (joint if side == "left" else 0.0, joint, joint),
            "translational_damping": (0.0, JOINT_DAMPING * joint, JOINT_DAMPING * joint),
            "rotational_stiffness": (0.0, 1e-2 * joint, 1e-2 * joint),
            "aligned_angle": pi,
            "stowed_angle": pi - angle,
            "latch_angle": pi,
        }
        parts.append(Part(side, "hinge", {"axis": (0.0, -1.0, 0.0), "latch": "kinematic"}, start))
        links += [Link(("a", side), (side, "inboard")), Link(("b", side), (side, "outboard"))]
    return parts, links, [HingeLine("HL", ("left", "right"), "left", latches=True, kinematic=True)]


def plastic_event(h: float, order: Order = 2, joint: float = 2e6, *, native: bool = False) -> PlasticEvent:
    """Latch two free panels and compare with momentum kept and the drop 1/2 J_eff w² of ideal joints."""
    record, _, failure = run(*free_pair(joint), 0.4, Settings(fixed_step=h, order=order), native=native)
    if failure or not record.events:
        raise RuntimeError(failure or "the panels never latched")
    before = int(np.argmin(np.abs(np.array(record.times) - record.events[0][0])))
    linear, angular = (
        record.signal("a", name) + record.signal("b", name)
        for name in ("linear_momentum", "angular_momentum")
    )
    energy = record.signal("a", "kinetic_energy") + record.signal("b", "kinetic_energy")
    rates = record.signal("left", "angular_rate")
    drop = float(energy[before] - energy[before + 1])
    return PlasticEvent(
        float(np.abs(linear - linear[0]).max() / np.abs(linear[0]).max()),
        float(np.abs(angular - angular[0]).max() / np.abs(angular[0]).max()),
        drop / (float(energy[before]) - joined_energy(record, before)) - 1.0,
        drop / (0.5 * effective_inertia() * float(rates[before]) ** 2) - 1.0,
        float(np.abs(rates[before + 1 :]).max() / abs(rates[before])),
    )


def joined_energy(record: Record, row: int) -> float:
    """Kinetic energy (J) of the free pair as one rigid body with the momenta of a row; planar motion."""
    masses, inertias, arms = (8.0, 7.5), (1.8, 1.6), ((-0.8, 0.0, 0.0), (0.77, 0.0, 0.0))
    centers = [
        record.signal(name, "frame_position")[row]
        + rotation_matrix(tuple(record.signal(name, "frame_orientation")[row])) @ arm
        for name, arm in zip(("a", "b"), arms, strict=True)
    ]
    total = sum(masses)
    center = (masses[0] * centers[0] + masses[1] * centers[1]) / total
    linear = record.signal("a", "linear_momentum")[row] + record.signal("b", "linear_momentum")[row]
    angular = record.signal("a", "angular_momentum")[row] + record.signal("b", "angular_momentum")[row]
    spin = float((angular - np.cross(center, linear))[1])
    inertia = sum(inertias) + masses[0] * masses[1] / total * float(np.sum((centers[1] - centers[0]) ** 2))
    return 0.5 * float(linear @ linear) / total + 0.5 * spin**2 / inertia


def effective_inertia() -> float:
    """Inertia J_eff of the hinge rate of the free pair in line: 1 / (b' M^-1 b) in two rotations."""
    reduced = 8.0 * 7.5 / 15.5
    m11, m12, m22 = 1.8 + reduced * 0.8**2, reduced * 0.8 * 0.77, 1.6 + reduced * 0.77**2
    return (m11 * m22 - m12 * m12) / (m11 + m22 + 2.0 * m12)
