"""Events of scene files: what they become, what is told of those that never happen, a sentence for every mistake."""

from pathlib import Path

import pytest

import orchestrator as fanfold
from orchestrator.assembly import Condition, Setting
from orchestrator.assembly.assemble import assemble
from orchestrator.scene import SceneError, load_scene

TWO_PANELS = Path(__file__).parents[2] / "scenes" / "two_panels.toml"
RELEASE = 'release = ["root"]'


def scene_with(folder, *events):
    """Two panels, and events of the names a, b, c."""
    named = [f'[[event]]\nname = "{name}"\n{event}\n' for name, event in zip("abc", events, strict=False)]
    path = folder / "wing.toml"
    path.write_text("\n".join([f"extends = '{TWO_PANELS}'", *named]), encoding="utf-8")
    return path


def test_lines_stand_for_their_hinges_and_sensors(tmp_path):
    """Definition: released and set are all hinges of a line, a condition is that of its sensor; values are in SI."""
    path = scene_with(
        tmp_path,
        "when = { component = 'middle_line', variable = 'angle', below = '30 deg' }\nrelease = ['middle_line']",
        "time = '20 ms'\nset = { middle_line = { friction_coefficient = '20 %' }, inner = { gravity = [0, 0, -1] } }",
    )
    first, second = assemble(load_scene(path)).events
    assert first.releases == ("middle_left", "middle_right")
    assert first.condition == Condition("middle_left", "angle", 0, pytest.approx(0.5235988), rising=False)
    assert second.time == 0.02
    assert second.settings == (
        Setting("middle_left", "friction_coefficient", 0.2, "1"),
        Setting("middle_right", "friction_coefficient", 0.2, "1"),
        Setting("inner", "gravity", (0.0, 0.0, -1.0), "m/s2"),
    )


@pytest.mark.filterwarnings("ignore:.*W-no-end")  # nothing stops it
def test_a_command_latches_a_line(tmp_path):
    """Definition: the latch command of one hinge latches its line, wherever it stands, and once."""
    latch = "[[hinge_line]]\nname = 'root_line'\nlatch = { stiffness = 2000, effective_inertia = 5 }"
    path = scene_with(tmp_path, f"time = 0.2\nset = {{ root = {{ latch_command = 1 }} }}\n{latch}")
    result = fanfold.simulate(path, until=0.5, rigid="all", estimate=False)
    assert result.latch_times == {"root_line": pytest.approx(0.2, abs=1e-12)}
    assert abs(result["root", "latch_torque"].at(0.4)) > 0.0


def test_what_never_happened_is_told(tmp_path):
    """Bad input: a time after the end, and a value that is not reached, with where the variable went."""
    path = scene_with(
        tmp_path,
        f"time = '30 s'\n{RELEASE}",
        f"when = {{ component = 'root', variable = 'angular_rate', above = '90 deg/s' }}\n{RELEASE}",
    )
    with pytest.warns(fanfold.FanfoldWarning) as told:
        fanfold.simulate(path, until=0.1, rigid="all", estimate=False)
    late, unreached = (str(one.message) for one in told if "W-event" in str(one.message))
    assert all(part in late for part in ("event.a.time", " 30 s", " 0.1 s"))
    assert all(part in unreached for part in ("event b ", "root.angular_rate", " 90 deg/s", " -0.0"))


def test_events_of_one_time_are_one(tmp_path):
    """Rule: they have no order. Regression: two that latched a line each locked one after the other."""
    path = scene_with(
        tmp_path, f"time = 2\n{RELEASE}", "time = '2000 ms'\nset = { middle_line = { motor_stiffness = 1 } }"
    )
    (event,) = assemble(load_scene(path)).events
    assert event.name == "a and b"
    assert event.releases == ("root",)
    assert {setting.part for setting in event.settings} == {"middle_left", "middle_right"}


LATE = {
    "latched before": (
        (
            "time = 0.2\nset = { root = { latch_command = 1 } }",
            "time = 0.3\nset = { root = { latch_command = 1 } }",
        ),
        "event b …root_line: …latched…0.2 s",
    ),
    "released before": (
        (f"time = 0.2\n{RELEASE}", "time = 0.3\nset = { root = { latch_command = 1 } }"),
        "event b …root_line: …released",
    ),
    "an angle that held it": (
        (
            "time = 0.2\nset = { root = { latch_command = 1 } }",
            "time = 0.3\nset = { root = { latch_angle = '1 deg' } }",
        ),
        "event b: …latch_angle…0.2 s",
    ),
    "an angle behind it": (
        ("time = 0.3\nset = { root = { latch_angle = '0.001 deg' } }",),
        "event a: …latch_angle… 0.00 deg",
    ),
}


@pytest.mark.filterwarnings("ignore:.*W-no-end")
@pytest.mark.parametrize("name", LATE)
def test_what_came_too_late_is_told(name, tmp_path):
    """Bad input. Regression: an event that did nothing was recorded as if it had."""
    events, expected = LATE[name]
    latch = "[[hinge_line]]\nname = 'root_line'\nlatch = { stiffness = 2000, effective_inertia = 5 }"
    path = scene_with(tmp_path, *events[:-1], f"{events[-1]}\n{latch}")
    with pytest.warns(fanfold.FanfoldWarning) as told:
        fanfold.simulate(path, until=0.4, rigid="all", estimate=False)
    assert any(all(part in str(one.message) for part in expected.split("…")) for one in told), [
        str(one.message) for one in told
    ]


BAD = {
    "no cause": (RELEASE, "event.a: …time…when"),
    "two causes": (
        f"time = 1\nwhen = {{ component = 'root', variable = 'angle', above = 0.1 }}\n{RELEASE}",
        "event.a: …time…when",
    ),
    "no effect": ("time = 1", "event.a: …release…set"),
    "before the start": (f"time = '-1 s'\n{RELEASE}", "event.a.time: "),
    "both sides": (
        f"when = {{ component = 'root', variable = 'angle', above = 0.1, below = 0.2 }}\n{RELEASE}",
        "event.a.when: ",
    ),
    "unknown component": (
        "time = 1\nrelease = ['rot']",
        "event.a.release: ",
    ),
    "unknown variable": (
        f"when = {{ component = 'root', variable = 'angel', above = 0.1 }}\n{RELEASE}",
        "event.a.when.variable: ",
    ),
    "a vector": (
        f"when = {{ component = 'inner', variable = 'frame_position', above = 0.1 }}\n{RELEASE}",
        "event.a.when.variable: ",
    ),
    "beyond a vector": (
        f"when = {{ component = 'inner', variable = 'frame_position[4]', above = 0.1 }}\n{RELEASE}",
        "event.a.when.variable: …'frame_position[4]'",
    ),
    "a wrong unit": (
        f"when = {{ component = 'root', variable = 'angle', above = '3 N' }}\n{RELEASE}",
        "event.a.when.above: ",
    ),
    "an angle without unit": (
        f"when = {{ component = 'root', variable = 'angle', above = 90 }}\n{RELEASE}",
        "event.a.when.above: ",
    ),
    "a body": ("time = 1\nrelease = ['inner']", "event.a.release: "),
    "no parameter": (
        "time = 1\nset = { root = { motor_stifness = 1 } }",
        "event.a.set.root.motor_stifness: ",
    ),
    "fixed": (
        "time = 1\nset = { inner = { initial_position = [0, 0, 0] } }",
        "event.a.set.inner.initial_position: ",
    ),
    "a motor that is a table": (
        "time = 1\nset = { root = { motor_stiffness = 0 } }\n[[hinge_line]]\nname = 'root_line'\n"
        "motor = { angle = ['0 deg', '90 deg'], torque = [1.6, 1.0] }",
        "event.a.set.root.motor_stiffness: ",
    ),
    "a motor that is none": (
        "time = 1\nset = { root = { motor_constant_torque = 0 } }",
        "event.a.set.root.motor_constant_torque: ",
    ),
    "a spring that is none": (
        "time = 1\nset = { root = { motor_wind_up = '5 rad' } }\n[[hinge_line]]\nname = 'root_line'\n"
        "motor = { stowed = 1.5, deployed = 1.5 }",
        "event.a.set.root.motor_wind_up: ",
    ),
    "a latch that is none": (
        "time = 1\nset = { root = { latch_stiffness = 5 } }",
        "event.a.set.root.latch_stiffness: ",
    ),
    "an input": (
        "time = 1\nset = { root = { hold = 1 } }",
        "event.a.set.root.hold: ",
    ),
    "a misspelt command": (
        "time = 1\nset = { root = { latch_comand = 1 } }",
        "event.a.set.root.latch_comand: …latch_command",
    ),
    "out of range": (
        "time = 1\nset = { root = { friction_coefficient = -1 } }",
        "event.a.set.root.friction_coefficient: …0",
    ),
    "no latch": (
        "time = 1\nset = { root = { latch_command = 1 } }",
        "event.a.set.root.latch_command: ",
    ),
    "let go and locked": (
        f"time = 1\n{RELEASE}\nset = {{ root = {{ latch_command = 1 }} }}\n[[hinge_line]]\nname = 'root_line'\n"
        "latch = { stiffness = 2000, effective_inertia = 5 }",
        "event.a: …root_line",
    ),
    "taken back": (
        "time = 1\nset = { root = { failure_command = 0 } }",
        "event.a.set.root.failure_command: ",
    ),
    "held": (
        "time = 1\nrelease = ['middle_line']\n[[hinge_line]]\nname = 'middle_line'\nheld = true",
        "event.a.release: ",
    ),
    "a name twice": (
        f"time = 1\n{RELEASE}\n[[event]]\nname = 'inner'\ntime = 2\n{RELEASE}",
        "components …'inner'",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_mistakes_are_sentences(name, tmp_path):
    """Bad input: file, key, what is wrong, and what to write."""
    text, expected = BAD[name]
    with pytest.raises(SceneError) as caught:
        assemble(load_scene(scene_with(tmp_path, text)), rigid={"all"})
    problems = caught.value.problems
    assert any(
        problem.startswith("wing.toml: ") and all(part in problem for part in expected.split("…"))
        for problem in problems
    ), problems
    assert len(set(problems)) == len(problems)
