"""Options that several commands share."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import click
from click.core import ParameterSource

from fmus import Backend, native_library

from .scene import Scene, SceneError, find_scene, load_scene


def ordered_names(_: click.Context, __: click.Parameter, value: str) -> tuple[str, ...]:
    """Names with commas between, in their order."""
    return tuple(name.strip() for name in value.split(",") if name.strip())


def names(_: click.Context, __: click.Parameter, value: str) -> frozenset[str]:
    """Names with commas between, as a set."""
    return frozenset(name.strip() for name in value.split(",") if name.strip())


def scene_layers(command: Callable[..., None]) -> Callable[..., None]:
    """The options that lay variants and single settings over a scene."""
    command = click.option(
        "--set", "settings", multiple=True, metavar="KEY=VALUE",
        help="Lay one value over the scene, such as body.panel.fixed_interface_modes=5 or 'hinge_line.HL.start_angle="
        "90 deg'; plain numbers are SI, as in scene files; repeatable.",
    )(command)  # fmt: skip
    text = "Variants of the scene, with commas between, in order."
    return click.option(
        "--variant", "variants", default="", callback=ordered_names, metavar="NAMES", help=text
    )(command)


def scene_of_one_run(scene: str, variants: Sequence[str], settings: Sequence[str]) -> Scene:
    """A scene with its layers; SceneError where it runs in phases and none of them is chosen."""
    loaded = load_scene(find_scene(scene), variants, settings)
    phases = loaded.header.phases
    if phases and not set(phases) & set(variants):
        raise SceneError(
            [f"{loaded.file}: it runs in phases; choose one with --variant: {', '.join(phases)}"]
        )
    return loaded


def fidelity_options(command: Callable[..., None]) -> Callable[..., None]:
    """The two fidelity options, for every command that assembles a scene."""
    for option, other in (("--flexible", "modal"), ("--rigid", "rigid")):
        text = f"Bodies to be {other}, by name with commas between, or all."
        command = click.option(option, default="", callback=names, metavar="NAMES", help=text)(command)
    return command


def refuse_idle(option: str, needed: str) -> None:
    """UsageError where an option of the present command is given that acts only together with another."""
    context = click.get_current_context()
    flags = {flag: param.name for param in context.command.params for flag in param.opts}
    sources = {flag: context.get_parameter_source(str(flags[flag])) for flag in (option, needed)}
    if sources[option] is ParameterSource.COMMANDLINE and sources[needed] is not ParameterSource.COMMANDLINE:
        raise click.UsageError(f"{option} acts only together with {needed}; give both, or neither")


def backend_option(command: Callable[..., None]) -> Callable[..., None]:
    """The option that chooses the back end of the FMUs."""
    return click.option(
        "--backend",
        type=click.Choice(["native", "python"]),
        callback=_offered_backend,
        help="Native FMUs, or PythonFMUs; native by default where a C compiler built them at installation.",
    )(command)


def _offered_backend(_: click.Context, __: click.Parameter, value: Backend | None) -> Backend | None:
    if value == "native" and native_library() is None:
        raise click.BadParameter(
            "no native library was built; install Fanfold again where there is a C compiler"
        )
    return value
