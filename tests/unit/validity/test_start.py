"""What a scene begins with that is hardly meant: blows of preloads, weight and loads, drives wound up."""

from orchestrator.scene.builder import Scene
from orchestrator.validity.before_run import scene_warnings


def test_a_preload_that_strikes_is_told():
    """Of scenes that do not say whether they start in its equilibrium; a scene that says false means the blow."""
    tree = Scene.load("amos3").tree
    for given, count in (({}, 1), ({"preload": False}, 0), ({"preload": True}, 0)):
        header = {key: value for key, value in tree["scene"].items() if key != "preload"} | given
        told = scene_warnings(Scene.of_tree("wing.toml", {**tree, "scene": header}).check())
        blows = [one for one in told if "W-start-blow" in one]
        assert len(blows) == count
        assert all("ccl.yoke_loop (" in one and "ccl.panel_loop (" in one for one in blows)


def test_weight_and_loads_that_strike_are_told():
    """Of scenes that do not say whether they start in equilibrium, and of loads that are there at the start.

    Regression: ringing of joints under a weight let go was told as a peak of the motion, with an error of nothing.
    """
    tree = Scene.load("workbench").tree
    (line,) = tree["hinge_line"]
    seat = {"body": line["outboard"], "point": "center"}

    def told(header, *terms):
        push = {"kind": "load", "name": "push", "ports": {"body": seat}}
        pushes = [push | {"structure": {"direction": [0, 0, 1], "force": list(terms)}}] if terms else []
        changed = {**tree, "scene": tree["scene"] | header, "connection": pushes}
        return [
            one
            for one in scene_warnings(Scene.of_tree("wing.toml", changed).check())
            if one.startswith("scene.preload:") and "W-start-blow" in one
        ]

    weight = {"gravity": [0, 0, "-9.81 m/s2"]}
    constant, later = (
        {"profile": "constant", "value": 1.0},
        {"profile": "ramp", "duration": 1.0, "change": 2.0},
    )
    assert told({}) == []
    (sentence,) = told(weight)
    assert sentence.startswith("scene.preload: gravity ")
    (sentence,) = told(weight, constant)
    assert sentence.startswith("scene.preload: gravity, push ")
    assert told({}, later) == []
    assert told(weight | {"preload": False}, constant) == told(weight | {"preload": True}, constant) == []


def test_hold_downs_that_strike_or_grip_on_the_way_are_told():
    """Bad input: a preload that nothing has settled, and a bolt where a run begins in mid-travel."""
    tree = Scene.load("workbench").tree
    (line,) = tree["hinge_line"]
    seats = {
        side: {"body": body, "point": next(iter(one["points"]))}
        for side, body, one in (
            ("inboard", line["inboard"], tree["base"]),
            ("outboard", line["outboard"], {"points": ["center"]}),
        )
    }
    bolt = {
        "name": "bolt", "kind": "hold_down", "structure": {"axis": [1, 0, 0]}, "ports": seats,
        "parameters": {"preload": "500 N", "release_time": "1 s"},
    }  # fmt: skip
    header = {key: value for key, value in tree["scene"].items() if key != "preload"}
    scene = {**tree, "scene": header, "connection": [bolt]}
    told = scene_warnings(Scene.of_tree("bench.toml", scene).check())
    assert any("connection.bolt (500 N)" in one and "W-start-blow" in one for one in told)
    assert not any("W-hold-down-start" in one for one in told)
    moved = {**scene, "hinge_line": [{**line, "start_angle": "45 deg"}]}
    told = scene_warnings(Scene.of_tree("bench.toml", moved).check())
    assert any(
        "connection.bolt" in one and line["name"] in one and "W-hold-down-start" in one for one in told
    )


def test_a_drive_that_starts_wound_up_is_told():
    """Closed form: a quarter turn of a gearbox of 800 N.m/rad, which is half k x^2.

    Regression: 987 J in a scene of less than one, of which the only word was that the line went too far.
    """
    scene = Scene("driven", until=1.0)
    scene.base("bus", points={"r": [0, 0, 0]})
    scene.body(
        "arm",
        rigid={
            "mass": 1.0,
            "center_of_mass": [0.5, 0, 0],
            "inertia": [0.1, 0.1, 0.1],
            "points": {"root": [0, 0, 0]},
        },
    )
    seats = {"inboard": {"body": "bus", "point": "r"}, "outboard": {"body": "arm", "point": "root"}}
    scene.hinge_line(
        "J", inboard="bus", outboard="arm", axis="-y", aligned_angle="90 deg",
        hinges=[{"name": "j", "inboard": "r", "outboard": "root"}],
    )  # fmt: skip
    for aligned, wound in (("90 deg", False), ("0 deg", True)):
        drive = {
            "end_angle": "90 deg",
            "duration": "5 s",
            "stiffness": "800 N.m/rad",
            "aligned_angle": aligned,
        }
        tree = scene.tree | {
            "connection": [
                {
                    "name": "motor",
                    "kind": "drive",
                    "structure": {"axis": [0, -1, 0]},
                    "ports": seats,
                    "parameters": drive,
                }
            ]
        }
        told = [one for one in scene_warnings(Scene.of_tree("driven.toml", tree).check()) if "gearbox" in one]
        assert len(told) == wound
        if wound:
            assert " -90 deg" in told[0]
            assert f"{800 * 1.5707963267949:.4g} N.m and {400 * 1.5707963267949**2:.4g} J" in told[0]
