"""Options that several commands share: what is given reaches a command as one choice of a scene."""

from __future__ import annotations

import click
import pytest
from click.testing import CliRunner

from orchestrator.assembly.assemble import assemble
from orchestrator.cli.analyse._configuration import ConfigurationChoice, configuration_choice
from orchestrator.cli.main import main
from orchestrator.cli.options import SceneChoice, layered_scene, scene_choice
from orchestrator.scene import SceneError

LAYERS = ("amos3", "--variant", "cold, spring_latch", "--set", "scene.until=2", "--set", "scene.until=3")
FIDELITIES = ("--rigid", "yoke,panel1", "--flexible", "panel2")


def given(decorated, *arguments):
    """What a decorated command is called with."""
    found = []
    command = click.command()(decorated(lambda *args, **kwargs: found.append((args, kwargs))))
    result = CliRunner().invoke(command, arguments)
    assert result.exit_code == 0, result.output
    return found[0]


def test_one_choice_holds_the_scene_its_layers_and_its_fidelities():
    """Interface: variants and settings in their order, fidelities as sets."""
    layers = ("amos3", ("cold", "spring_latch"), ("scene.until=2", "scene.until=3"))
    fidelities = (frozenset({"yoke", "panel1"}), frozenset({"panel2"}))
    assert given(scene_choice, *LAYERS, *FIDELITIES) == ((SceneChoice(*layers, *fidelities),), {})
    assert given(layered_scene, *LAYERS) == ((SceneChoice(*layers),), {})
    assert given(scene_choice, "amos3") == ((SceneChoice("amos3"),), {})


def test_a_choice_without_fidelities_offers_none():
    command = click.command()(layered_scene(lambda choice: None))
    result = CliRunner().invoke(command, ("amos3", "--rigid", "all"))
    assert result.exit_code == 2
    assert "'--rigid'" in result.output


def test_a_configuration_comes_after_the_scene_and_other_options_by_name():
    def decorated(command):
        return scene_choice(configuration_choice(click.option("--count", type=int)(command)))

    arguments = ("--configuration", "deployed", "--angle", "HL1=0.5rad", "--latched", "HL2", "--count", "3")
    wanted = ConfigurationChoice("deployed", {"HL1": 0.5}, ("HL2",))
    assert given(decorated, "amos3", *arguments) == ((SceneChoice("amos3"), wanted), {"count": 3})
    assert wanted.posed == {"configuration": "deployed", "angles": {"HL1": "0.5 rad"}, "latched": ("HL2",)}
    assert given(decorated, "amos3")[0][1] == ConfigurationChoice("current", {}, None)


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


def test_options_given_twice_add_up(tmp_path):
    """Regression: the last one won without a word, which was another scene."""
    chosen = []

    @click.command()
    @scene_choice
    def command(choice):
        chosen.append(choice)

    arguments = ["amos3", "--variant", "a", "--variant", "b,c", "--rigid", "x", "--rigid", "y"]
    assert CliRunner().invoke(command, arguments, catch_exceptions=False).exit_code == 0
    assert chosen[0].variants == ("a", "b", "c")
    assert chosen[0].rigid == {"x", "y"}


def test_one_run_of_a_scene_in_phases_is_one_of_them():
    with pytest.raises(SceneError, match="phase1, phase2"):
        SceneChoice("arabsat").load().check_one_run()
    assert SceneChoice("arabsat", ("phase1",)).load().check_one_run().header.until == 14.0


def test_a_choice_assembles_at_its_fidelities():
    """Of ARABSAT's bodies the two outer panels, 4 and 5, are flexible by default; further settings count too."""
    choice = SceneChoice("arabsat", rigid=frozenset({"panel5"}), flexible=frozenset({"panel1"}))
    modes = [f"body.{name}.fixed_interface_modes={count}" for name, count in (("panel1", 2), ("panel4", 3))]
    few, more = (
        assemble(choice.load().with_settings(settings).check(), **choice.fidelities)
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
