"""Requirements against headline numbers: margins by hand, units, certainty, exit codes, columns of studies."""

from __future__ import annotations

import json
from math import radians

import pytest

import orchestrator as fanfold
from orchestrator.api.simulate import with_requirements
from orchestrator.results.identifiers import unit_of
from orchestrator.results.key_figures import headline
from orchestrator.results.number import Number
from orchestrator.results.requirements import judged
from orchestrator.scene.table import SceneError
from tests.references import synthetic_result as reference
from tests.unit.cli.test_commands import fanfold as command

RATE = Number("latch rate", "HL1", radians(10.0), "rad/s", radians(0.5))


@pytest.mark.parametrize(
    ("limit", "margin", "state"),
    [
        ("latch_rate.HL1 < 15 deg/s", 5.0, "met"),
        ("HL1.latch_rate>8deg/s", 2.0, "met"),
        ("latch_rate < 10.4 deg/s", 0.4, "within the error"),
        ("latch_rate < 9 deg/s", -1.0, "not met"),
    ],
)
def test_margins_by_hand(limit, margin, state):
    """In the unit of the limit; a margin below the estimated error leaves it open."""
    (one,) = judged([limit], [RATE], [])
    assert (one.value, one.error, one.margin) == pytest.approx((10.0, 0.5, margin))
    assert (one.unit, one.state, one.met) == ("deg/s", state, state == "met")


def test_energies_have_prefixes():
    """Definition: 1.5 J are 1500 mJ, with their error in the unit of the limit."""
    (one,) = judged(["latch_energy.HL1 < 2000 mJ"], [Number("latch energy", "HL1", 1.5, "J", 0.01)], [])
    assert (one.value, one.error, one.margin, one.unit) == pytest.approx((1500.0, 10.0, 500.0, "mJ"))


def test_a_line_that_has_not_latched_fails():
    """A number without its line is every line's, and one that is missing is not met."""
    states = {one.text: one.state for one in judged(["latch_rate < 15 deg/s"], [RATE], ["HL2"])}
    assert states == {"latch_rate.HL1 < 15 deg/s": "met", "latch_rate.HL2 < 15 deg/s": "no such number"}


def test_units_are_those_of_the_numbers(tmp_path):
    """What a requirement is checked with before a run is what the run has."""
    numbers = list(headline(fanfold.Result.open(reference.write(tmp_path / "run.h5"))).numbers())
    assert {number.id: unit_of(number.id) for number in numbers} == {n.id: n.unit for n in numbers}


def test_a_run_is_judged(tmp_path):
    """By the scene's limits and by those of the command line; the result keeps both."""
    scene = fanfold.load("workbench").copy()
    scene.requirements("latch_rate.HL < 1000 deg/s")
    toml, run = scene.save(tmp_path / "judged.toml"), tmp_path / "run.h5"
    options = ("run", toml, "--rigid", "all", "--no-estimate", "--tolerance", 1e-3, "-o", run)
    assert command(*options).exit_code == 0
    failed = command(*options, "--require", "latch_time < 0.01 s", "--json")
    assert failed.exit_code == 4
    found = json.loads(failed.stdout)["requirements"]
    assert [one["state"] for one in found] == ["met", "not met"]
    kept = fanfold.Result.open(run)
    assert [one.met for one in kept.headline.requirements] == [True, False]
    assert "1 of 2 requirements is not met" in kept.headline.verdict


@pytest.mark.parametrize(
    ("limit", "word"),
    [
        ("latch_rate.HL < 15 N", "deg/s"),
        ("latch_rte.HL < 15 deg/s", "latch_rate"),
        ("latch_rate.HL9 < 15 deg/s", "HL"),
        ("latch_rate.HL 15 deg/s", "NUMBER < VALUE"),
        ("attitude_peak.x < 1 deg", "the number attitude_peak"),
        ("tension_a_max < 90 N", "the number tension_a_max"),
        ("largest_angle < 181 deg", "the number largest_angle"),
    ],
)
def test_refused_before_the_run(limit, word):
    """Bad input: unit, number, line, form; a fixed base, no cable loop, a line that has a latch."""
    with pytest.raises(SceneError, match=word):
        fanfold.simulate("workbench", require=[limit])


def led():
    """A leaf with a stop, and a block that follows a law and pulls it by a spring and a hold-down."""
    scene = fanfold.Scene("led", until=0.01, preload=False)
    scene.base(points={"a": (0, 0, 0)})
    rigid = {"mass": 1, "center_of_mass": (0, 0, 0), "inertia": (1, 1, 1), "points": {"b": (0, 0, 0)}}
    law = [{"profile": "step", "duration": 1.0, "change": 0.1}]
    motion = {"translation_axis": (1, 0, 0), "translation": law}
    scene.body("block", rigid=rigid, place={"body": "base", "point": "a", "offset": (1, 0, 0)}, motion=motion)
    scene.body("leaf", rigid=rigid)
    scene.hinge_line(
        "HL", "base", "leaf", axis="+y", aligned_angle="90 deg", start_angle="80 deg", end_stop={"stiffness": 1e3},
        hinges={"hinge": ("a", "b")},
    )  # fmt: skip
    ports = {"inboard": ("block", "b"), "outboard": ("leaf", "b")}
    scene.connection("spring", "spring", ports=ports, parameters={"stiffness": 10.0})
    scene.connection("bolt", "hold_down", ports=ports)
    return scene


def free():
    """AMOS-3 with cable loops and a damper on a free spacecraft."""
    return fanfold.load("amos3", variant="free")


@pytest.mark.filterwarnings("ignore::orchestrator.FanfoldWarning")
@pytest.mark.parametrize(("make", "until"), [(led, 0.01), (free, 12.0)])
def test_every_number_of_a_run_may_have_a_limit(make, until):
    """Definition: what a run has is what requirements on its scene may be on."""
    scene = make()
    run = fanfold.simulate(scene, rigid="all", until=until, tolerance=1e-2, estimate=False)
    limits = [f"{number.id} < 1e9 {number.unit}" for number in run.headline.numbers()]
    assert len(limits) > 15
    with_requirements(scene, limits)


def test_held_lines_and_hinges_on_the_base_have_no_such_numbers():
    """Definition: a held line does not take part; loads of hinges on the base are those of its ports."""
    held = fanfold.load("amos3", settings={"hinge_line.HL3.held": True})
    good = ("latch_rate.HL1 < 1 deg/s", "hinge_force_peak.hl2_left < 1 N", "port_force_peak.hl1_hinge < 1 N")
    assert fanfold.check_scene(held.with_requirements(good)).problems == ()
    for bad in (
        "latch_rate.HL3 < 1 deg/s",
        "hinge_force_peak.hl3_left < 1 N",
        "hinge_force_peak.hl1_hinge < 1 N",
        "port_force_peak.hl2_left < 1 N",
    ):
        (problem,) = fanfold.check_scene(held.with_requirements([bad])).problems
        assert bad in problem


def test_a_study_counts_them():
    """The margin is a number of every sample: limit less the number itself, in degrees a second."""
    found = fanfold.study(
        "workbench",
        {"hinge_line.HL.friction_preload": "values(0.01 N.m, 0.2 N.m)"},
        method="grid",
        levels=2,
        rigid="all",
        tolerance=1e-3,
        require=["latch_rate.HL < 60 deg/s"],
    )
    (name,) = [one for one in found.numbers if one.startswith("margin of")]
    rates = [60.0 - radians(1.0) ** -1 * rate for rate in found.numbers["latch_rate.HL"]]
    assert found.numbers[name] == pytest.approx(rates)
    share = found.requirements_met()["latch_rate.HL < 60 deg/s"]
    assert (share.samples, share.among) == (sum(rate < 0.0 for rate in rates), 2)
