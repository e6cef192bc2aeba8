"""Options that several commands share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import TYPE_CHECKING, Any, Concatenate, ParamSpec, TypedDict, TypeVar

import click
from click.core import ParameterSource

import orchestrator as fanfold

if TYPE_CHECKING:
    from fmus import Backend

    from ..scene.builder import Scene

Command = TypeVar("Command", bound=Callable[..., None])
Others = ParamSpec("Others")
"""What else a command is given."""


class Fidelities(TypedDict):
    """Names of bodies to be rigid and to be flexible, by what functions call them."""

    rigid: frozenset[str]
    flexible: frozenset[str]


@dataclass(frozen=True, slots=True)
class SceneChoice:
    """A scene on the command line: name or file, variants, settings, models of bodies."""

    scene: str
    variants: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    """in order, each such as body.panel.fixed_interface_modes=5"""
    rigid: frozenset[str] = frozenset()
    flexible: frozenset[str] = frozenset()
    trust: bool = False
    """whether its plugins may run"""

    @property
    def fidelities(self) -> Fidelities:
        """Bodies to be rigid and to be flexible."""
        return {"rigid": self.rigid, "flexible": self.flexible}

    def load(self) -> Scene:
        """The scene with its layers."""
        from ..api.simulate import as_scene  # takes its time, which --help need not

        return as_scene(self.scene, self.variants, self.settings, self.trust)


def ordered_names(_: click.Context, __: click.Parameter, values: tuple[str, ...]) -> tuple[str, ...]:
    """Names with commas between, in their order, of an option that may be given several times."""
    return tuple(name.strip() for value in values for name in value.split(",") if name.strip())


def names(context: click.Context, param: click.Parameter, values: tuple[str, ...]) -> frozenset[str]:
    """The same as a set."""
    return frozenset(ordered_names(context, param, values))


def layered_scene(command: Callable[Concatenate[SceneChoice, Others], None]) -> Callable[..., None]:
    """SCENE and the options that lay variants and settings over it, for a command that takes a choice first."""

    @wraps(command)
    def with_choice(
        scene: str,
        variants: tuple[str, ...],
        settings: tuple[str, ...],
        rigid: frozenset[str] = frozenset(),
        flexible: frozenset[str] = frozenset(),
        trust: bool = False,
        *args: Others.args,
        **kwargs: Others.kwargs,
    ) -> None:
        command(SceneChoice(scene, variants, settings, rigid, flexible, trust), *args, **kwargs)

    return click.argument("scene")(_layer_options(with_choice))


def scene_choice(command: Callable[Concatenate[SceneChoice, Others], None]) -> Callable[..., None]:
    """The same with the two fidelity options, for every command that assembles a scene."""
    return layered_scene(_fidelity_options(command))


def scene_options(command: Command) -> Command:
    """The options alone, for a command whose argument is not always a scene."""
    return _layer_options(_fidelity_options(command))


def _layer_options(command: Command) -> Command:
    command = click.option(
        "--set", "settings", multiple=True, metavar="KEY=VALUE",
        help=(
            "Change one value of the scene, such as body.panel.fixed_interface_modes=5 or "
            "'hinge_line.HL.start_angle=90 deg'; plain numbers are in SI units; repeatable."
        ),
    )(command)  # fmt: skip
    command = plugin_option(
        click.option(
            "--trust", is_flag=True, help="Let plugins of the scene run, now and until they change."
        )(command)
    )
    text = "Variants of the scene, separated by commas, applied in order."
    return click.option(
        "--variant", "variants", multiple=True, callback=ordered_names, metavar="NAMES", help=text
    )(command)


def _fidelity_options(command: Command) -> Command:
    for option, other in (("--flexible", "modal"), ("--rigid", "rigid")):
        text = f"Names of bodies to model as {other}, separated by commas, or all."
        command = click.option(option, multiple=True, callback=names, metavar="NAMES", help=text)(command)
    return command


def large_deformation_option(command: Command) -> Command:
    """The third fidelity, for commands that are no linear analyses."""
    return click.option(
        "--large-deformation", multiple=True, callback=names, metavar="NAMES",
        help="Names of bodies to model as geometrically exact beams, separated by commas, or all.",
    )(command)  # fmt: skip


def result_options(command: Callable[..., None]) -> Callable[..., None]:
    """What a command may do with files that its `result`, and `others`, name."""

    @wraps(command)
    def trusting(trust: bool, **kwargs: Any) -> None:  # noqa: ANN401
        for result in (kwargs["result"], *kwargs.get("others", ())) if trust else ():
            fanfold.trust(result)
        command(**kwargs)

    text = "Trust the files of bodies and FMUs that the result names, now and later."
    return plugin_option(click.option("--trust", is_flag=True, help=text)(trusting))


def replace_option(command: Command) -> Command:
    """The option of commands whose file is kept from one of other settings."""
    return click.option(
        "--replace", is_flag=True, help="Replace an existing file, even if it was made with other settings."
    )(command)


def plugin_option(command: Command) -> Command:
    """The option that loads plugins, before anything else."""

    def load_each(_: click.Context, __: click.Parameter, files: tuple[str, ...]) -> tuple[str, ...]:
        for file in files:
            fanfold.load_plugin(file)
        return files

    return click.option(
        "--plugin", multiple=True, metavar="FILE", expose_value=False, callback=load_each,
        help="File with your components or figures (.py) or bodies (.toml); repeatable.",
    )(command)  # fmt: skip


def refuse_idle(option: str, needed: str) -> None:
    """UsageError where an option of the present command is given that acts only together with another."""
    context = click.get_current_context()
    flags = {flag: param.name for param in context.command.params for flag in param.opts}
    sources = {flag: context.get_parameter_source(str(flags[flag])) for flag in (option, needed)}
    if sources[option] is ParameterSource.COMMANDLINE and sources[needed] is not ParameterSource.COMMANDLINE:
        raise click.UsageError(f"{option} acts only together with {needed}; give both, or neither")


def backend_option(command: Command) -> Command:
    """The option that chooses the back end of the FMUs."""
    return click.option(
        "--backend",
        type=click.Choice(["native", "python"]),
        callback=_offered_backend,
        help="Native FMUs or PythonFMUs; by default native, if a C compiler built them at installation.",
    )(command)


def _offered_backend(_: click.Context, __: click.Parameter, value: Backend | None) -> Backend | None:
    from fmus import native_library

    if value == "native" and native_library() is None:
        raise click.BadParameter(
            "no native library was built; install Fanfold again where there is a C compiler"
        )
    return value
