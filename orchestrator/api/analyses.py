"""Analyses of scenes and results: functions that return records, and their pictures and files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from ..assembly.assemble import assemble
from ..assembly.doubts.at_the_start import turned_from_the_world
from ..assembly.fidelities import bending
from ..assembly.spin import unstiffened_spins
from ..assembly.statics.steady_spin import spin_at_start
from ..messages import coded, message
from ..run.progress import Progress
from ..scene import CheckedScene, SceneError
from ..scene.builder import Names, listed
from .documents import ResultLike, opened
from .progress import chosen
from .quantities import Quantity, at_least, by_line, in_si
from .simulate import SceneLike, as_scene
from .warnings import warn

if TYPE_CHECKING:
    from ..analysis.appendage.model import Appendage
    from ..analysis.equilibrium import Equilibrium
    from ..analysis.frequency_response import FrequencyResponse
    from ..analysis.impact import Impact
    from ..analysis.latch_tuning import Kind, Tuning
    from ..analysis.latch_tuning_of_wing import WingTuning
    from ..analysis.mode_study import ModeStudy
    from ..analysis.modes import Modes
    from ..analysis.stress.hot_spots import PanelStress
    from ..analysis.stress.outputs import BodyOutputs
    from ..analysis.studies import LatchStudy
    from ..analysis.torque_margin.margins import TorqueMargin
    from ..analysis.torque_margin.restart import CaseRestart
    from ..analysis.torque_margin.standard import FactorKind
    from ..analysis.torque_margin.sweep import FrictionKind
    from ..assembly.statics.configuration import Configuration, Named
    from ..scene.hinge_line_tables import HingeLine
    from ..scene.loops.freedoms import Constraints

Angles = Mapping[str, Quantity]
"""Angles of hinge lines by name, rad or texts such as "45 deg"."""
Way = tuple[Quantity, Quantity]
"""Angles of a hinge line from which and to which it is turned."""


def constraints(scene: SceneLike) -> Constraints:
    """Constraints of a scene's joints where it starts: count, rank, redundant ones, what can move."""
    from ..scene.loops.freedoms import find_constraints

    return find_constraints(as_scene(scene).check_one_run())


def modes(
    scene: SceneLike,
    configuration: Named = "current",
    *,
    angles: Angles | None = None,
    latched: Names | None = None,
    rigid: Names = (),
    flexible: Names = (),
    as_posed: bool = False,
    base: Literal["as_built", "held"] = "as_built",
    count: int = 15,
) -> Modes:
    """Natural frequencies, damping and effective masses of a scene in a configuration.

    configuration: "stowed", "deployed", or "current", where a run begins; angles: of single lines in it. latched:
    names of lines, "all" or "none"; by default all if deployed, else none. as_posed: about the hinge angles
    themselves, not about the static equilibrium beside them. base: "held" keeps a free spacecraft where it is; as
    built, it swings with the wing, and six free motions come first; one that turns where its law begins has its wing in
    steady spin, whose modes are those in axes that turn along. count: modes beyond the free motions.
    """
    from ..analysis.modes import find_modes
    from ..analysis.unstated_joints import unstated_joint_sentences

    checked = _for_small_motion(scene, rigid, spinning=True)
    target = _configuration(checked, configuration, angles, latched)
    if base not in ("as_built", "held"):
        raise SceneError([f"base is {base!r}; it must be as_built or held"])
    if spin_at_start(checked):
        assembly = assemble(checked, listed(rigid), listed(flexible), large_deformation=None)
        for sentence in unstiffened_spins(checked, assembly, until=0.0):
            warn(message("W-spin", sentence))
    found = find_modes(
        checked,
        listed(rigid),
        listed(flexible),
        target,
        as_posed,
        at_least(count, 1, "count"),
        held=base == "held",
    )
    if as_posed:
        _tell_of_posing(checked, rigid, flexible, target, found.unbalanced)
    for sentence in unstated_joint_sentences(checked, found.model, found.shapes):
        warn(message("W-joint-stiffness", sentence))
    return found


def appendage(
    scene: SceneLike,
    configuration: Named = "current",
    *,
    angles: Angles | None = None,
    latched: Names | None = None,
    rigid: Names = (),
    flexible: Names = (),
    as_posed: bool = False,
    hold: Names = "none",
    points: Names = (),
    count: int = 15,
) -> list[Appendage]:
    """A scene in a configuration (see `modes`) as a linear appendage of its base, about each of some points.

    hold: names of lines kept at their angles without being latched, "all" or "none". points: of the base; by default
    one, about which it turns: a ground's reference point, a free base's centre of mass. count: cantilever modes kept.
    """
    from ..analysis.appendage.model import find_appendages

    checked = _for_small_motion(scene, rigid)
    target = _configuration(checked, configuration, angles, latched)
    found = find_appendages(
        checked,
        listed(rigid),
        listed(flexible),
        target,
        as_posed,
        hold,
        listed(points),
        at_least(count, 1, "count"),
    )
    if as_posed:
        _tell_of_posing(checked, rigid, flexible, target, found[0].unbalanced)
    return found


def frequency_response(
    scene: SceneLike,
    configuration: Named = "current",
    *,
    angles: Angles | None = None,
    latched: Names | None = None,
    rigid: Names = (),
    flexible: Names = (),
    as_posed: bool = False,
    excite: str = "z",
    along: str | None = None,
    points: Names = ("interface",),
    low: Quantity = 0.1,
    high: Quantity = 100.0,
    steps: int = 400,
) -> FrequencyResponse:
    """Response of a scene in a configuration (see `modes`) to vibration of its base.

    excite: x, y, z, rx, ry or rz, the acceleration of the base along or about an axis, prescribed whatever its mass is
    and whether it is free (a free one turns about its centre of mass); along: what is read, as
    excited by default. points: BODY.POINT, whose acceleration is wanted; "interface" is the load on the base. low,
    high: Hz. steps: frequencies, beside those around resonances.
    """
    from ..analysis.frequency_response import FrequencyResponse, frequency_grid, responses
    from ..analysis.vibration import DIRECTIONS, ZERO_FREQUENCY
    from ..assembly.statics.configuration import scene_model

    for name, direction in (("excite", excite), ("along", along or excite)):
        if direction not in DIRECTIONS:
            raise SceneError([f"{name} is {direction!r}; it must be one of {', '.join(DIRECTIONS)}"])
    first, last = in_si(low, "Hz", "low", "positive"), in_si(high, "Hz", "high", "positive")
    if not ZERO_FREQUENCY <= first < last < float("inf"):
        raise SceneError(
            [f"low is {first:g} and high {last:g} Hz; give low, {ZERO_FREQUENCY:g} Hz at least, below high"]
        )
    checked = _for_small_motion(scene, rigid)
    target = _configuration(checked, configuration, angles, latched)
    model = scene_model(checked, listed(rigid), listed(flexible), target, as_posed)
    if as_posed:
        _tell_of_posing(checked, rigid, flexible, target, model.unbalanced)
    frequencies = frequency_grid(model, first, last, at_least(steps, 2, "steps"))
    found = responses(model, excite, along or excite, listed(points), frequencies)
    free = not model.is_grounded
    return FrequencyResponse(checked.header.name, target, free, excite, frequencies, tuple(found))


def equilibrium(
    scene: SceneLike,
    configuration: Named = "current",
    *,
    angles: Angles | None = None,
    latched: Names | None = None,
    rigid: Names = (),
    flexible: Names = (),
    hold: Names | None = None,
    preload: bool = False,
) -> Equilibrium:
    """Static equilibrium of a scene in a configuration (see `modes`), and the loads of its connections.

    hold: held lines by name, "all" or "none"; by default all that are not latched. preload: cable loops have exactly
    their preload, as when a run begins.
    """
    from ..analysis.equilibrium import equilibrium as find
    from ..analysis.equilibrium import lines_held

    checked = _for_small_motion(scene, rigid)
    target = _configuration(checked, configuration, angles, latched)
    held = lines_held(checked, target, hold, ())
    return find(checked, listed(rigid), listed(flexible), target, held, preload)[1]


def quasi_static(
    scene: SceneLike,
    sweeps: Mapping[str, Way],
    configuration: Named = "current",
    *,
    angles: Angles | None = None,
    latched: Names | None = None,
    rigid: Names = (),
    flexible: Names = (),
    hold: Names | None = None,
    steps: int = 12,
) -> list[Equilibrium]:
    """Equilibria while lines turn together, such as {"HL1": (0, "90 deg")}; other lines follow, or are held."""
    from ..analysis.equilibrium import Sweep, lines_held
    from ..analysis.equilibrium import quasi_static as find

    example = '{"HL1": (0, "90 deg")}'
    ways = []
    for line, both in by_line(sweeps, "sweeps", example).items():
        if not isinstance(both, Sequence) or isinstance(both, str) or len(both) != 2:
            raise SceneError(
                [f"the sweep of {line} is {both!r}; give the angles of its ends, such as {example}"]
            )
        ways.append(Sweep(line, *(_angle(line, angle) for angle in both)))
    if not ways:
        raise SceneError([f"no line is swept; give one, such as {example}"])
    for way in ways:
        if way.start == way.end:
            raise SceneError([f"the sweep of {way.line} begins and ends at the same angle"])
    checked = _for_small_motion(scene, rigid)
    target = _configuration(checked, configuration, angles, latched)
    held = lines_held(checked, target, hold, ways)
    count = at_least(steps, 1, "steps")
    return find(checked, listed(rigid), listed(flexible), target, held, ways, count)


def torque_margin(
    scene: SceneLike,
    *,
    cases: Sequence[str] = (),
    factors: FactorKind = "theoretical",
    friction: FrictionKind = "sliding",
    torques: Mapping[str, Mapping[str, Quantity]] | None = None,
    positions: int = 19,
) -> TorqueMargin:
    """Torque margin of every driven hinge line over its travel, limit 2; bodies are rigid.

    Lines that cable loops couple have theirs together, at the rate of the first, from which their verdict follows.
    cases: variants to analyse beside each other, "base" for none; by default base, and cold if there is a cold one.
    factors: "theoretical" or "measured" uncertainty factors of ECSS table 4-2. friction: "constant" is the preload
    torque alone, "sliding" and "static" add that of the reactions. torques: further ones (N.m) by line and ECSS
    symbol, such as {"HL2": {"HY": 0.02}}. positions: of the travel, its ends included.
    """
    from ..analysis.torque_margin.margins import margin_cases
    from ..analysis.torque_margin.margins import torque_margin as find
    from ..analysis.torque_margin.standard import DEMANDS, FACTORS

    if factors not in FACTORS:
        raise SceneError([f"there are no factors {factors!r}; factors are {', '.join(FACTORS)}"])
    symbols = (*FACTORS["theoretical"], *DEMANDS)
    extra: dict[str, dict[str, float]] = {}
    example = '{"HL2": {"HY": 0.02}}'
    for line, given in by_line(torques or {}, "torques", example).items():
        for symbol, torque in by_line(given, f"the torques of {line}", example).items():
            if symbol not in symbols:
                raise SceneError(
                    [f"{line}: there is no torque {symbol!r}; symbols of ECSS are {', '.join(symbols)}"]
                )
            value = in_si(torque, "N.m", f"the torque {symbol} of {line}", "zero or positive")
            extra.setdefault(line, {})[symbol] = value or 0.0
    count = at_least(positions, 2, "positions")
    return find(margin_cases(as_scene(scene), listed(cases)), count, factors, friction, extra)


def restart(
    scene: SceneLike,
    positions: Sequence[str],
    *,
    cases: Sequence[str] = (),
    until: Quantity | None = None,
    folder: str | Path | None = None,
    progress: bool | Progress | None = None,
) -> list[CaseRestart]:
    """Run a scene from rest at positions of its travel, such as ("25%", "45 deg"): does every line open.

    An angle is that of the first line with a motor. cases: as for `torque_margin`. folder: where results go; None
    keeps none.
    """
    from ..analysis.torque_margin.margins import margin_cases
    from ..analysis.torque_margin.restart import restart_cases, restart_shares

    scenes = margin_cases(as_scene(scene), listed(cases))
    shares = {case: restart_shares(one, listed(positions)) for case, one in scenes.items()}
    end = in_si(until, "s", "until", "positive")
    return restart_cases(scenes, shares, _folder(folder), end, chosen(progress))


def latch_tuning(
    scene: SceneLike,
    line: str,
    *,
    frequency: Quantity | None = None,
    stiffness_of: Kind | None = None,
    hinge_stiffness: Quantity | None = None,
    rigid: Names = (),
    flexible: Names = (),
) -> Tuning:
    """The latch spring of a hinge line that gives the rigid pair of its bodies the frequency of the flexible one.

    frequency: to meet, Hz; by default that of the flexible pair. stiffness_of: "total" or "structure", what the
    frequency belongs to; by default the total with a frequency, else the structure. hinge_stiffness: measured, of the
    line's hinges together, N.m/rad.
    """
    from ..analysis.latch_tuning import find_line, tune

    checked = as_scene(scene).check_one_run()
    found = find_line(checked, line)
    _tell_of_locks(found)
    return tune(
        checked,
        found,
        bending(checked, listed(rigid), listed(flexible)),
        in_si(frequency, "Hz", "the frequency", "positive"),
        stiffness_of,
        in_si(hinge_stiffness, "N.m/rad", "the stiffness of the hinges", "positive"),
    )


def wing_latch_tuning(
    scene: SceneLike,
    line: str,
    *,
    frequency: Quantity | None = None,
    rigid: Names = (),
    flexible: Names = (),
) -> WingTuning:
    """The latch spring of a hinge line that gives the whole rigid wing, deployed, the frequency of the flexible one.

    frequency: to meet, Hz; by default that of the flexible wing's lowest mode in the direction of the rigid one's.
    """
    from ..analysis.latch_tuning import find_line
    from ..analysis.latch_tuning_of_wing import tune_wing

    wanted = in_si(frequency, "Hz", "the frequency", "positive")
    checked = as_scene(scene).check_one_run()
    _tell_of_locks(find_line(checked, line))
    return tune_wing(checked, line, listed(rigid), listed(flexible), wanted)


def _tell_of_locks(line: HingeLine) -> None:
    """FanfoldWarning where a latch has no use for a stiffness."""
    if line.latch is not None and line.latch.kind == "kinematic":
        warn(
            message(
                "W-latch-curve",
                f"hinge_line.{line.name}: its latch is kinematic, so a stiffness has no effect; set latch.kind to "
                "spring or by_fidelity to use the result",
            )
        )


def mode_study(
    scene: SceneLike,
    body: str | None = None,
    *,
    counts: Sequence[int] = (2, 3, 4, 5, 10, 20, 30),
    rigid: Names = (),
    flexible: Names = (),
    tolerance: float | None = None,
    folder: str | Path | None = None,
    progress: bool | Progress | None = None,
) -> ModeStudy:
    """Latch-up of a scene against the number of a body's fixed-interface modes; the largest is the reference.

    folder: where results go; None keeps them in memory.
    """
    from ..analysis.mode_study import mode_study as study

    loaded, bar = as_scene(scene), chosen(progress)
    return study(loaded, body, counts, listed(rigid), listed(flexible), tolerance, _folder(folder), bar)


def step_study(
    scene: SceneLike,
    *,
    steps: Sequence[float] = (2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5),
    rigid: Names = (),
    flexible: Names = (),
    tolerance: float | None = None,
    folder: str | Path | None = None,
    progress: bool | Progress | None = None,
) -> LatchStudy:
    """Latch-up of a scene against constant communication step sizes (s); the smallest is the reference.

    folder: where results go; None keeps them in memory.
    """
    from ..analysis.step_study import step_study as study

    assembly = assemble(as_scene(scene).check_one_run(), listed(rigid), listed(flexible))
    return study(assembly, steps, tolerance, _folder(folder), chosen(progress))


def stress(
    result: ResultLike,
    body: str,
    *,
    count: int = 10,
    radius: Quantity = 0.05,
    nodes: Sequence[int] | None = None,
    within: tuple[float, float, float, float] | None = None,
    around: tuple[float, float, float] | None = None,
    insert_margin: Quantity = 0.0,
) -> PanelStress:
    """Von Mises stresses of a flexible panel's face sheets in a result: hot spots, peak field.

    count: hot spots; radius: nodes this near to one (m) are no further one. Only nodes by number, within a rectangle
    x0, x1, y0, y1 (m) of the body's frame, around x, y with a radius (m), and no nearer than insert_margin (m) to
    rigid inserts, whose corners are singular.
    """
    from ..analysis.stress.hot_spots import Choice, panel_stress

    margin = in_si(insert_margin, "m", "insert_margin", "zero or positive") or 0.0
    choice = Choice(None if nodes is None else tuple(nodes), within, around, margin)
    near = in_si(radius, "m", "radius", "zero or positive") or 0.0
    return panel_stress(opened(result), body, choice, near, at_least(count, 1, "count"))


def body_outputs(result: ResultLike, body: str) -> BodyOutputs:
    """Stresses and forces of elements, over a result, that an imported body brought rows for."""
    from ..analysis.stress.outputs import body_outputs as find

    return find(opened(result), body)


def impacts(result: ResultLike) -> list[Impact]:
    """Every touch of every contact of a result in order of time: speed, force, impulse, energy."""
    from ..analysis.impact import impacts as find

    return find(opened(result))


def _for_small_motion(scene: SceneLike, rigid: Names, spinning: bool = False) -> CheckedScene:
    """The scene checked; a FanfoldWarning each for what the analysis leaves out and a base that starts turned.

    spinning: whether the analysis is about the steady spin of a base.
    """
    from ..analysis.small_motion import left_out

    checked = as_scene(scene).check_one_run()
    for sentence in coded("W-base-turned", turned_from_the_world(checked)):
        warn(sentence)
    for sentence in coded("W-modes-omitted", left_out(checked, listed(rigid), spinning)):
        warn(sentence)
    return checked


def _tell_of_posing(
    scene: CheckedScene, rigid: Names, flexible: Names, target: Configuration, unbalanced: tuple[float, float]
) -> None:
    """A FanfoldWarning where frequencies as posed, with so much out of balance, are not those in equilibrium."""
    from ..analysis.modes import posing_sentence

    if sentence := posing_sentence(scene, listed(rigid), listed(flexible), target, unbalanced):
        warn(message("W-modes-omitted", sentence))


def _configuration(
    scene: CheckedScene, named: Named, angles: Angles | None, latched: Names | None
) -> Configuration:
    from ..assembly.statics.configuration import configuration

    if named not in ("stowed", "deployed", "current"):
        raise SceneError(
            [f"there is no configuration {named!r}; configurations are stowed, deployed and current"]
        )
    given = by_line(angles or {}, "angles", '{"HL1": "45 deg"}')
    turned = {line: _angle(line, angle) for line, angle in given.items()}
    return configuration(scene, named, turned, latched)


def _angle(line: str, angle: Quantity) -> float:
    return in_si(angle, "rad", f"the angle of {line}") or 0.0


def _folder(folder: str | Path | None) -> Path | None:
    return None if folder is None else Path(folder)
