"""Analyses of scenes and results: functions that return records, and their pictures and files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

from ..assembly.assemble import assemble
from ..assembly.fidelities import bending
from ..assembly.statics.steady_spin import spin_at_start
from ..messages import coded, message
from ..run.progress import Progress
from ..scene import PlacedScene, SceneError
from ..scene.builder import Names, listed
from ..validity.centrifugal_stiffening import unstiffened_spins
from ..validity.start import turned_from_the_world
from .documents import ResultLike, opened
from .options import Folder, Positive, Within
from .progress import chosen
from .quantities import Duration, Frequency, Length, Quantity, Tolerance, at_least, by_line, in_si
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
    from ..analysis.torque_margin.standard import FactorKind, GevsPhase
    from ..analysis.torque_margin.sweep import FrictionKind
    from ..analysis.vibration import Direction
    from ..assembly.statics.configuration import Configuration, Named
    from ..scene.freedoms import Constraints
    from ..scene.hinge_line_tables import HingeLine

Angles = Mapping[str, Quantity]
"""Angles of hinge lines by name, rad or texts such as "45 deg"."""
Way = tuple[Quantity, Quantity]
"""Angles of a hinge line from which and to which it is turned."""


def constraints(scene: SceneLike) -> Constraints:
    """Constraints of the joints of a scene at its start.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file

    Returns
    -------
    Constraints
        number of constraints, rank, redundant constraints, free motions
    """
    from ..scene.freedoms import find_constraints

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
    count: Positive = 15,
) -> Modes:
    """Natural frequencies, damping ratios and effective masses of a scene in a configuration.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    configuration : {"current", "stowed", "deployed"}
        angles of all hinge lines; "current" is the start of a run
    angles : mapping, optional
        angles of single lines in this configuration, rad or texts such as "45 deg"
    latched : str or sequence of str, optional
        latched lines, "all" or "none"; by default all if deployed, else none
    rigid, flexible
        see `simulate`
    as_posed : bool
        linearise at the hinge angles themselves; by default at the static equilibrium near them
    base : {"as_built", "held"}
        "held" fixes a free spacecraft; as built, it moves with the wing and six rigid-body modes come first; if the
        motion law of the base starts with a rate, modes are those of the steady spin, in rotating axes
    count : int
        number of modes in addition to the rigid-body modes

    Returns
    -------
    Modes
        frequencies (Hz), damping ratios, effective masses (kg, kg.m2), dominant bodies

    Raises
    ------
    SceneError
        if the scene or the configuration is invalid

    Examples
    --------
    >>> found = fanfold.modes("amos3", "deployed", count=6)
    >>> found.frequencies
    """
    from ..analysis.modes import find_modes
    from ..validity.default_joints import default_joint_warnings

    posed = _posed(scene, rigid, flexible, configuration, angles, latched, spinning=True)
    checked = posed.scene
    if base not in ("as_built", "held"):
        raise SceneError([f"base is {base!r}; it must be as_built or held"])
    if spin_at_start(checked):
        assembly = assemble(checked, posed.rigid, posed.flexible, large_deformation=None)
        for sentence in unstiffened_spins(checked, assembly, until=0.0):
            warn(message("W-spin", sentence))
    found = find_modes(*posed, as_posed, at_least(count, 1, "count"), held=base == "held")
    if as_posed:
        _tell_of_posing(posed, found.unbalanced)
    for sentence in default_joint_warnings(checked, found.model, found.shapes):
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
    count: Positive = 15,
) -> list[Appendage]:
    """Linear appendage model of a scene: cantilever modes and participation about points of the base.

    Parameters
    ----------
    scene, configuration, angles, latched, rigid, flexible, as_posed
        see `modes`
    hold : str or sequence of str
        lines fixed at their angles without being latched, "all" or "none"
    points : str or sequence of str
        points of the base; by default the reference point of a fixed base, the centre of mass of a free one
    count : int
        number of cantilever modes

    Returns
    -------
    list of Appendage
        one model per point: frequencies (Hz), participation, rigid and residual mass (kg, kg.m, kg.m2)
    """
    from ..analysis.appendage.model import find_appendages

    posed = _posed(scene, rigid, flexible, configuration, angles, latched)
    found = find_appendages(*posed, as_posed, hold, listed(points), at_least(count, 1, "count"))
    if as_posed:
        _tell_of_posing(posed, found[0].unbalanced)
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
    excite: Direction = "z",
    along: Direction | None = None,
    points: Names = ("interface",),
    low: Frequency = 0.1,
    high: Frequency = 100.0,
    steps: Annotated[int, Within(low=2, high=100_000)] = 400,
) -> FrequencyResponse:
    """Frequency response of a scene in a configuration to vibration of its base.

    Parameters
    ----------
    scene, configuration, angles, latched, rigid, flexible, as_posed
        see `modes`
    excite : {"x", "y", "z", "rx", "ry", "rz"}
        prescribed acceleration of the base along or about an axis; a free base rotates about its centre of mass
    along : str, optional
        direction of the response; by default that of the excitation
    points : str or sequence of str
        points BODY.POINT whose acceleration is computed; "interface" is the load on the base
    low, high : float or str
        frequency range, in Hz
    steps : int
        number of frequencies, in addition to those near resonances

    Returns
    -------
    FrequencyResponse
        frequencies (Hz) and complex responses of all points

    Raises
    ------
    SceneError
        if a direction, a point or the frequency range is invalid
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
    posed = _posed(scene, rigid, flexible, configuration, angles, latched)
    model = scene_model(*posed, as_posed)
    if as_posed:
        _tell_of_posing(posed, model.unbalanced)
    frequencies = frequency_grid(model, first, last, at_least(steps, 2, "steps"))
    found = responses(model, excite, along or excite, listed(points), frequencies)
    free = not model.is_grounded
    name = posed.scene.header.name
    return FrequencyResponse(name, posed.configuration, free, excite, frequencies, tuple(found))


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
    """Static equilibrium of a scene in a configuration, and the loads of its connections.

    Parameters
    ----------
    scene, configuration, angles, latched, rigid, flexible
        see `modes`
    hold : str or sequence of str, optional
        held lines, "all" or "none"; by default all lines that are not latched
    preload : bool
        cable loops have exactly their preload, as at the start of a run

    Returns
    -------
    Equilibrium
        angles (rad), holding torques (N.m), loads of connections and base (N, N.m)
    """
    from ..analysis.equilibrium import equilibrium as find
    from ..analysis.equilibrium import lines_held

    posed = _posed(scene, rigid, flexible, configuration, angles, latched)
    return find(*posed, lines_held(posed.scene, posed.configuration, hold, ()), preload)[1]


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
    steps: Annotated[int, Within(low=1, high=10_000)] = 12,
) -> list[Equilibrium]:
    """Static equilibria over a sweep of hinge angles; other lines follow, or are held.

    Parameters
    ----------
    scene, configuration, angles, latched, rigid, flexible
        see `modes`
    sweeps : mapping
        first and last angle of every swept line, rad or texts, such as ``{"HL1": (0, "90 deg")}``
    hold : str or sequence of str, optional
        held lines, "all" or "none"; by default none
    steps : int
        number of steps of the sweep

    Returns
    -------
    list of Equilibrium
        one per step, see `equilibrium`
    """
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
    posed = _posed(scene, rigid, flexible, configuration, angles, latched)
    held = lines_held(posed.scene, posed.configuration, hold, ways)
    return find(*posed, held, ways, at_least(steps, 1, "steps"))


def torque_margin(
    scene: SceneLike,
    *,
    cases: Names = (),
    factors: FactorKind = "theoretical",
    gevs: GevsPhase | None = None,
    friction: FrictionKind = "sliding",
    torques: Mapping[str, Mapping[str, Quantity]] | None = None,
    positions: Annotated[int, Within(low=2, high=10_000)] = 19,
) -> TorqueMargin:
    """Torque margin of every driven hinge line over its travel; bodies are rigid.

    Lines that cable loops or gears couple have one margin, at the rate of the first line.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    cases : sequence of str
        variants to analyse, "base" for none; by default base, and cold if the scene has it
    factors : {"theoretical", "measured"}
        uncertainty factors of ECSS-E-ST-33-01C, table 4-2
    gevs : {"preliminary", "critical", "test"}, optional
        adds the rule of GSFC-STD-7000 (GEVS), section 2.4.5.3, with its factors on known and variable torques:
        preliminary or critical design review, or acceptance and qualification test
    friction : {"constant", "sliding", "static"}
        friction torques: "constant" is the preload torque alone; "sliding" and "static" add friction due to joint
        reactions
    torques : mapping, optional
        additional torques, N.m, by line and ECSS symbol, such as ``{"HL2": {"HY": 0.02}}``
    positions : int
        number of positions over the travel, including its ends

    Returns
    -------
    TorqueMargin
        margins, driving and resisting torques (N.m) by line and case; `passes` for the verdict

    Raises
    ------
    SceneError
        if factors, symbols or cases are invalid

    Examples
    --------
    >>> margin = fanfold.torque_margin("bepicolombo")
    >>> margin.passes
    """
    from ..analysis.torque_margin.margins import margin_cases
    from ..analysis.torque_margin.margins import torque_margin as find
    from ..analysis.torque_margin.standard import DEMANDS, FACTORS, GEVS_FACTORS

    if factors not in FACTORS:
        raise SceneError([f"there are no factors {factors!r}; factors are {', '.join(FACTORS)}"])
    if gevs is not None and gevs not in GEVS_FACTORS:
        raise SceneError([f"there is no phase {gevs!r} of GEVS; phases are {', '.join(GEVS_FACTORS)}"])
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
    return find(margin_cases(as_scene(scene), listed(cases)), count, factors, friction, extra, gevs)


def restart(
    scene: SceneLike,
    positions: Names,
    *,
    cases: Names = (),
    until: Duration | None = None,
    folder: Folder | None = None,
    progress: bool | Progress | None = None,
) -> list[CaseRestart]:
    """Simulate a scene from rest at positions of its travel, and report whether every line opens.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    positions : sequence of str
        shares of the travel or angles of the first line with a motor, such as ``("25%", "45 deg")``
    cases : sequence of str
        see `torque_margin`
    folder : str or Path, optional
        folder of the results; by default they are not kept
    until, progress
        see `simulate`

    Returns
    -------
    list of CaseRestart
        one per case and position, with a record of every line
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
    frequency: Annotated[Quantity, Within("Hz", 0.0, above=True)] | None = None,
    stiffness_of: Kind | None = None,
    hinge_stiffness: Annotated[Quantity, Within("N.m/rad", 0.0, above=True)] | None = None,
    rigid: Names = (),
    flexible: Names = (),
) -> Tuning:
    """Latch spring stiffness that gives a rigid pair of bodies the natural frequency of the flexible pair.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    line : str
        hinge line between the bodies
    frequency : float or str, optional
        target frequency, in Hz; by default that of the flexible pair
    stiffness_of : {"total", "structure"}, optional
        stiffness that the frequency belongs to; by default "total" if `frequency` is set, else "structure"
    hinge_stiffness : float or str, optional
        measured stiffness of all hinges of the line together, N.m/rad or a text such as "51.3 N.m/deg"
    rigid, flexible : str or sequence of str
        see `modes`

    Returns
    -------
    Tuning
        stiffnesses (N.m/rad), inertias (kg.m2), frequencies (Hz)
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
    frequency: Annotated[Quantity, Within("Hz", 0.0, above=True)] | None = None,
    rigid: Names = (),
    flexible: Names = (),
) -> WingTuning:
    """Latch spring stiffness that gives the whole rigid wing, deployed, the natural frequency of the flexible wing.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    line : str
        hinge line with the latch
    frequency : float or str, optional
        target frequency, in Hz; by default the lowest mode of the flexible wing in the direction of the rigid mode
    rigid, flexible : str or sequence of str
        see `modes`

    Returns
    -------
    WingTuning
        stiffness (N.m/rad) and frequencies (Hz)
    """
    from ..analysis.latch_tuning import find_line
    from ..analysis.latch_tuning_of_wing import tune_wing

    wanted = in_si(frequency, "Hz", "the frequency", "positive")
    checked = as_scene(scene).check_one_run()
    _tell_of_locks(find_line(checked, line))
    return tune_wing(checked, line, listed(rigid), listed(flexible), wanted)


def _tell_of_locks(line: HingeLine) -> None:
    """Warn if the latch is kinematic and so has no stiffness."""
    if line.latch is not None and line.latch.kind == "kinematic":
        warn(
            message(
                "W-latch-curve",
                f"hinge_line.{line.name}: its latch is kinematic, so a stiffness has no effect. Set latch.kind to "
                "spring or by_fidelity to use the result.",
            )
        )


def mode_study(
    scene: SceneLike,
    body: str | None = None,
    *,
    counts: Annotated[Sequence[int], Within(low=0)] = (2, 3, 4, 5, 10, 20, 30),
    rigid: Names = (),
    flexible: Names = (),
    tolerance: Tolerance | None = None,
    folder: Folder | None = None,
    progress: bool | Progress | None = None,
) -> ModeStudy:
    """Convergence of the latch-up with the number of fixed-interface modes of a body.

    The largest number is the reference.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    body : str, optional
        body whose number of modes varies; required if several bodies are flexible
    counts : sequence of int
        numbers of fixed-interface modes; the largest is the reference
    rigid, flexible, tolerance, progress
        see `simulate`
    folder : str or Path, optional
        folder of the results; by default they stay in memory

    Returns
    -------
    ModeStudy
        frequencies (Hz) and latch-up numbers by number of modes
    """
    from ..analysis.mode_study import mode_study as study

    loaded, bar = as_scene(scene), chosen(progress)
    return study(loaded, body, counts, listed(rigid), listed(flexible), tolerance, _folder(folder), bar)


def step_study(
    scene: SceneLike,
    *,
    steps: Annotated[Sequence[float], Within("s")] = (2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5),
    rigid: Names = (),
    flexible: Names = (),
    tolerance: Tolerance | None = None,
    folder: Folder | None = None,
    progress: bool | Progress | None = None,
) -> LatchStudy:
    """Convergence of the latch-up with the constant communication step size; the smallest step is the reference.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    steps : sequence of float
        constant communication step sizes, in seconds; the smallest is the reference
    rigid, flexible, tolerance, progress
        see `simulate`
    folder : str or Path, optional
        folder of the results; by default they stay in memory

    Returns
    -------
    LatchStudy
        latch-up numbers by step size
    """
    from ..analysis.step_study import step_study as study

    assembly = assemble(as_scene(scene).check_one_run(), listed(rigid), listed(flexible))
    return study(assembly, steps, tolerance, _folder(folder), chosen(progress))


def stress(
    result: ResultLike,
    body: str,
    *,
    count: Positive = 10,
    radius: Length = 0.05,
    nodes: Sequence[int] | None = None,
    within: tuple[float, float, float, float] | None = None,
    around: tuple[float, float, float] | None = None,
    insert_margin: Length = 0.0,
) -> PanelStress:
    """Von Mises stresses in the face sheets of a flexible panel: hot spots and peak field.

    Parameters
    ----------
    result : Result, str or Path
        result, or its file
    body : str
        panel
    count : int
        number of hot spots
    radius : float or str
        smallest distance between two hot spots, in m
    nodes : sequence of int, optional
        only these nodes of the mesh
    within : tuple of float, optional
        only nodes in the rectangle x0, x1, y0, y1 of the body frame, in m
    around : tuple of float, optional
        only nodes in the circle x, y, radius of the body frame, in m
    insert_margin : float or str
        smallest distance of nodes to rigid inserts, in m, whose corners are singular

    Returns
    -------
    PanelStress
        hot spots and peak stress (Pa) of all nodes

    Raises
    ------
    ResultError
        if the result has no such flexible panel
    """
    from ..analysis.stress.hot_spots import Choice, panel_stress

    margin = in_si(insert_margin, "m", "insert_margin", "zero or positive") or 0.0
    choice = Choice(None if nodes is None else tuple(nodes), within, around, margin)
    near = in_si(radius, "m", "radius", "zero or positive") or 0.0
    return panel_stress(opened(result), body, choice, near, at_least(count, 1, "count"))


def body_outputs(result: ResultLike, body: str) -> BodyOutputs:
    """Element stresses and forces of an imported body over a result, from the output rows of its file.

    Parameters
    ----------
    result : Result, str or Path
        result, or its file
    body : str
        imported body with output rows

    Returns
    -------
    BodyOutputs
        names, units and values over time
    """
    from ..analysis.stress.outputs import body_outputs as find

    return find(opened(result), body)


def impacts(result: ResultLike) -> list[Impact]:
    """Impacts of all contacts of a result, in order of time.

    Parameters
    ----------
    result : Result, str or Path
        result, or its file

    Returns
    -------
    list of Impact
        time and duration (s), speed (m/s), peak force (N), impulse (N.s), energy (J)
    """
    from ..analysis.impact import impacts as find

    return find(opened(result))


class _Posed(NamedTuple):
    """A checked scene, its models of bodies and its configuration: what analyses of small motion begin with."""

    scene: PlacedScene
    rigid: tuple[str, ...]
    flexible: tuple[str, ...]
    configuration: Configuration


def _posed(
    scene: SceneLike,
    rigid: Names,
    flexible: Names,
    named: Named,
    angles: Angles | None,
    latched: Names | None,
    *,
    spinning: bool = False,
) -> _Posed:
    """A scene in a configuration; a FanfoldWarning for each omission of the analysis, and for a base rotated at start.

    spinning: the analysis linearises about the steady spin of a base.
    """
    from ..assembly.statics.configuration import configuration
    from ..validity.small_motion import left_out

    if named not in ("stowed", "deployed", "current"):
        raise SceneError(
            [f"there is no configuration {named!r}; configurations are stowed, deployed and current"]
        )
    checked = as_scene(scene).check_one_run()
    for sentence in coded("W-base-turned", turned_from_the_world(checked)):
        warn(sentence)
    for sentence in coded("W-modes-omitted", left_out(checked, listed(rigid), spinning)):
        warn(sentence)
    given = by_line(angles or {}, "angles", '{"HL1": "45 deg"}')
    turned = {line: _angle(line, angle) for line, angle in given.items()}
    return _Posed(checked, listed(rigid), listed(flexible), configuration(checked, named, turned, latched))


def _tell_of_posing(posed: _Posed, unbalanced: tuple[float, float]) -> None:
    """Warn if frequencies as posed, with this unbalanced load, differ from those in equilibrium."""
    from ..analysis.modes import posing_sentence

    if sentence := posing_sentence(*posed, unbalanced):
        warn(message("W-modes-omitted", sentence))


def _angle(line: str, angle: Quantity) -> float:
    return in_si(angle, "rad", f"the angle of {line}") or 0.0


def _folder(folder: str | Path | None) -> Path | None:
    return None if folder is None else Path(folder)
