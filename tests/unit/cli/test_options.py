"""Commands made of functions: their options, and what is given as arguments of the functions."""

from __future__ import annotations

from inspect import Parameter, isfunction, signature
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from orchestrator.assembly.assemble import assemble
from orchestrator.cli.command import Asked, SceneChoice, made_of
from orchestrator.cli.main import main
from orchestrator.cli.signatures import REQUIRED, parameters_of
from orchestrator.scene import SceneError

LAYERS = ("amos3", "--variant", "cold, spring_latch", "--set", "scene.until=2", "--set", "scene.until=3")


def given(changes, handler, functions, *arguments):
    """What the handler of a command of these functions is called with."""
    found = []
    command = made_of(*functions, name="command", **changes)(handler)
    command._handler = lambda **keywords: found.append(keywords)
    command._own = parameters_of(handler.__name__, __name__)
    result = CliRunner().invoke(command, arguments)
    assert result.exit_code == 0, result.output
    return found[0]


def of_choice(choice: SceneChoice, asked: Asked) -> None:
    """A handler of an unloaded scene."""


def of_result(result: Path, asked: Asked, plot: bool = False) -> None:
    """A handler of a result."""


def test_one_choice_holds_the_scene_and_its_layers():
    """Interface: variants and settings in their order; arguments of the function by its name."""
    found = given(
        {}, of_choice, ["simulate"], *LAYERS, "--rigid", "yoke,panel1", "--until", "20 ms", "--no-refine"
    )
    layers = ("amos3", ("cold", "spring_latch"), ("scene.until=2", "scene.until=3"))
    assert found["choice"] == SceneChoice(*layers)
    asked = found["asked"]["simulate"]
    assert asked["rigid"] == ("yoke", "panel1")
    assert asked["until"] == pytest.approx(0.02)
    assert asked["refine"] is False
    hidden = {"scene", "progress"}
    usual = {
        name: one.default
        for name, one in signature(fanfold.simulate).parameters.items()
        if name not in hidden
    }
    assert {*asked} == {*usual}
    assert all(asked[name] == usual[name] for name in usual if name not in ("rigid", "until", "refine"))


def test_a_function_without_fidelities_has_none():
    command = made_of("constraints", name="command")(of_choice)
    result = CliRunner().invoke(command, ("amos3", "--rigid", "all"))
    assert result.exit_code == 2
    assert "'--rigid'" in result.output


def test_help_default_and_range_follow_from_the_function():
    """Interface: the docstring is the help, with options for names of parameters; the annotation is the range."""
    command = made_of("tune", name="command")(of_choice)
    options = {one.name: one for one in command.params if isinstance(one, click.Option)}
    assert options["accuracy"].default == 1e-4
    assert (options["accuracy"].type.min, options["accuracy"].type.max) == (1e-9, 0.1)
    assert options["curve"].help.startswith("CSV file")
    of_simulate = {one.name: one for one in made_of("simulate", name="command")(of_choice).params}
    assert options["rigid"].help == of_simulate["rigid"].help
    assert "--accuracy" in options["tolerance"].help
    assert "watch" not in options


def test_an_option_that_acts_only_with_another_is_refused(tmp_path):
    (tmp_path / "a").write_text("x", encoding="utf-8")
    command = made_of("stress", name="command", count={"needs": "plot"})(of_result)
    result = CliRunner().invoke(command, (str(tmp_path / "a"), "--body", "panel", "--count", "2"))
    assert result.exit_code == 2
    assert "--count acts only together with --plot" in result.output


@pytest.mark.parametrize("name", [name for name in fanfold.__all__ if isfunction(getattr(fanfold, name))])
def test_signatures_read_from_the_source_are_those_of_the_functions(name):
    """Independent path: Python's own reading of the module, which imports it."""
    found = parameters_of(name)
    real = signature(getattr(fanfold, name)).parameters
    assert [*found] == [*real]
    for one in real.values():
        if not callable(one.default) or one.default is Parameter.empty:
            assert found[one.name].default == (REQUIRED if one.default is Parameter.empty else one.default)
        assert found[one.name].help


def test_layers_are_laid_in_their_order():
    """The last one wins: later variants over earlier ones, settings over variants, further settings over these."""
    scene = SceneChoice("arabsat", ("phase1",), ("scene.largest_step=0.25",)).load()
    assert scene.check().header.until == 14.0
    settings = ("scene.until=3", "scene.until=4")
    assert scene.with_settings(settings).check().header.until == 4.0
    both = scene.with_variants("phase2")
    assert both.check().header.description.endswith("phase 2: motor driven")
    assert both.check().header.largest_step == 0.25  # not the 0.5 s of phase 2
    assert both.with_settings({"scene.largest_step": 0.125}).check().header.largest_step == 0.125


def test_options_given_twice_add_up():
    """Regression: the last one won without a word, which was another scene."""
    arguments = ["amos3", "--variant", "a", "--variant", "b,c", "--rigid", "x", "--rigid", "y"]
    found = given({}, of_choice, ["simulate"], *arguments)
    assert found["choice"].variant == ("a", "b", "c")
    assert found["asked"]["simulate"]["rigid"] == ("x", "y")


def test_one_run_of_a_scene_in_phases_is_one_of_them():
    with pytest.raises(SceneError, match="phase1, phase2"):
        SceneChoice("arabsat").load().check_one_run()
    assert SceneChoice("arabsat", ("phase1",)).load().check_one_run().header.until == 14.0


@pytest.mark.thorough
def test_a_choice_assembles_at_its_fidelities():
    """Of ARABSAT's bodies the two outer panels, 4 and 5, are flexible by default; further settings count too."""
    choice = SceneChoice("arabsat")
    modes = [f"body.{name}.fixed_interface_modes={count}" for name, count in (("panel1", 2), ("panel4", 3))]
    few, more = (
        assemble(choice.load().with_settings(settings).check(), rigid=("panel5",), flexible=("panel1",))
        for settings in (modes, [*modes, modes[0][:-1] + "5"])
    )
    assert few.flexible == more.flexible == ("panel1", "panel4")
    kept = [{part.name: part.structure for part in one.parts if part.kind == "body"} for one in (few, more)]
    counts = [
        {name: len(one[name]["modal"]["frequency"]) for name in ("panel1", "panel4", "panel5")}
        for one in kept
    ]
    assert counts[1]["panel1"] - counts[0]["panel1"] == 3
    assert counts[1]["panel4"] == counts[0]["panel4"] > 3
    assert counts[0]["panel5"] == 0


def test_every_command_that_writes_has_the_short_option():
    """Interface: -o is the short form of the option that names what a command writes."""

    def commands(group):
        for name in group.list_commands(context):
            command = group.get_command(context, name)
            yield from commands(command) if isinstance(command, click.Group) else [command]

    context = click.Context(main)
    targets = {"--output", "--out", "--save"}
    short = {command.name for command in commands(main) for param in command.params if "-o" in param.opts}
    writing = {
        command.name for command in commands(main) for param in command.params if targets & {*param.opts}
    }
    assert writing <= short
    assert {
        "run",
        "report",
        "plot",
        "check",
        "study",
        "compare",
        "docs",
        "modes",
        "frequency-response",
    } <= short
