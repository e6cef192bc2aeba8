"""Commands made of public functions: one option per parameter, with its type, range, default and help."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from inspect import getdoc
from pathlib import Path
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, get_args, get_origin

import click
from click.core import ParameterSource

import orchestrator as fanfold

from ..api.options import Place, Within
from .signatures import REQUIRED, Parameter, documented, parameters_of
from .types import Choice, Count, Number, OutputFile, Picture, Several, names_given, ordered_names, short

if TYPE_CHECKING:
    from ..scene.builder import Scene

Asked = Mapping[str, dict[str, Any]]
"""Arguments by function."""
_FLAGS = {
    "as_json": "--json",
    "folder": "-o --output",
    "output": "-o --output",
    "path": "-o --output",
    "save": "-o --output",
    "settings": "--set",
}
"""Options whose names are not those of the parameters."""
_HELP = {"as_json": "one JSON object on standard output", "every": "show every headline number"}
_LAYERS = {
    "scene": "",
    "variant": "variants of the scene, applied in order",
    "settings": (
        "change one value of the scene, such as body.panel.fixed_interface_modes=5 or "
        "'hinge_line.HL.start_angle=90 deg'; plain numbers are in SI units; repeatable"
    ),
    "trust": "let plugins of the scene run, now and until they change",
}
"""Help of what `load` does, for a terminal."""
_TRUST = "trust the files of bodies and FMUs that the result names, now and later"
_HIDDEN = ("scene", "choice", "result", "fmu", "asked", "progress", "watch")
"""Parameters that are no options."""
_NUMBERS = {int, float}
EXISTING = click.Path(path_type=Path, exists=True, dir_okay=False)
_PLACES = {
    "file": OutputFile(),
    "existing": EXISTING,
    "picture": Picture(),
    "folder": click.Path(path_type=Path, file_okay=False),
}
_UNITS = {"s": "SECONDS", "m": "METRES", "Hz": "HZ", "N.m/rad": "STIFFNESS"}


def _load_plugins(_: click.Context, __: click.Parameter, files: tuple[str, ...]) -> None:
    for file in files:
        fanfold.load_plugin(file)


PLUGIN: dict[str, Any] = {
    "multiple": True,
    "metavar": "FILE",
    "expose_value": False,
    "callback": _load_plugins,
    "help": "File with your components or figures (.py) or bodies (.toml); repeatable.",
}
"""The option that loads plugins, before anything else."""


@dataclass(frozen=True, slots=True)
class SceneChoice:
    """A scene on the command line: name or file, variants, settings."""

    scene: str
    variant: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    """in order, each such as body.panel.fixed_interface_modes=5"""
    trust: bool = False
    """whether its plugins may run"""

    def load(self) -> Scene:
        """The scene with its layers."""
        from ..api.simulate import as_scene  # takes its time, which --help need not

        return as_scene(self.scene, self.variant, self.settings, self.trust)


def made_of(
    *functions: str, name: str, epilog: str | None = None, **changes: dict[str, Any]
) -> Callable[[Callable[..., None]], click.Command]:
    """Decorator that makes a command of a handler and of the public functions that it calls.

    The handler takes a `scene` (loaded), the `choice` of one, or the file of a `result`; then the arguments of the
    functions, where there are any; then what it asks for itself, in place of parameters of the functions of that name.

    changes: by parameter, arguments of `click.Option` in place of what follows from the signature; flags: names of
    the option, in one text; needs: the option without which this one has no effect; help: in place of the docstring's.
    """

    def made(handler: Callable[..., None]) -> click.Command:
        return _Command(name, handler, functions, changes, epilog)

    return made


class _Command(click.Command):
    """A command whose parameters are made when they are first wanted."""

    def __init__(
        self,
        name: str,
        handler: Callable[..., None],
        functions: tuple[str, ...],
        changes: Mapping[str, dict[str, Any]],
        epilog: str | None,
    ) -> None:
        text, self._texts = documented(getdoc(handler) or "")
        super().__init__(name, callback=self._call, help=text, epilog=epilog)
        del self.params  # see below
        self._handler, self._functions, self._changes = handler, functions, changes
        self._further: list[click.Argument] = getattr(handler, "__click_params__", [])[::-1]

    @cached_property
    def params(self) -> list[click.Parameter]:  # type: ignore[override]
        """Arguments and options."""
        flags = {one.name: _flags(one, self._changes.get(one.name, {})) for one in self._options}
        options = [_option(one, flags, self._changes.get(one.name, {})) for one in self._options]
        plugins = [click.Option(["--plugin"], **PLUGIN)] if self._subject else []
        return [*self._arguments(), *plugins, *options]

    @cached_property
    def _own(self) -> dict[str, Parameter]:
        """Parameters of the handler."""
        return parameters_of(self._handler.__name__, self._handler.__module__)

    @cached_property
    def _subject(self) -> str:
        return next((one for one in self._own if one in ("scene", "choice", "result")), "")

    @cached_property
    def _asked(self) -> dict[str, list[str]]:
        """Names of arguments by function, but for those that lay out the scene and those of the handler."""
        other = {*_HIDDEN, *_LAYERS, *self._own}
        return {
            function: [name for name in parameters_of(function) if name not in other]
            for function in self._functions
        }

    @cached_property
    def _options(self) -> list[Parameter]:
        found: dict[str, Parameter] = {}
        if self._subject == "result":
            found["trust"] = Parameter("trust", bool, False, _TRUST)
        elif self._subject:
            found |= {name: replace(one, help=_LAYERS[name]) for name, one in parameters_of("load").items()}
        for function in self._functions:
            found = found | parameters_of(function) | found
        for name, one in self._own.items():
            found[name] = replace(one, help=one.help or (found[name].help if name in found else ""))
        return [
            replace(one, help=self._texts.get(name) or one.help or _HELP.get(name, ""))
            for name, one in found.items()
            if name not in {*_HIDDEN, *(argument.name for argument in self._further)}
        ]

    def _arguments(self) -> Iterator[click.Argument]:
        if self._subject == "result":
            yield click.Argument(["result"], **{"type": EXISTING, **self._changes.get("result", {})})
        elif self._subject:
            yield click.Argument(["scene"], **self._changes.get("scene", {}))
        yield from self._further

    def _call(self, **given: Any) -> None:  # noqa: ANN401
        self._refuse_idle()
        asked = {f: {name: given[name] for name in names} for f, names in self._asked.items()}
        own = {name: given[name] for name in self._own if name in given}
        if self._subject in ("scene", "choice"):
            choice = SceneChoice(given["scene"], given["variant"], given["settings"], given["trust"])
            own[self._subject] = choice if self._subject == "choice" else choice.load()
        elif self._subject and given["trust"]:
            for file in (given["result"], *given.get("other", ())):
                fanfold.trust(file)
        if "asked" in self._own:
            own["asked"] = asked
        self._handler(**own)

    def _refuse_idle(self) -> None:
        """UsageError where an option is given that acts only together with another."""
        context = click.get_current_context()
        flags = {str(one.name): one.opts[-1] for one in self.params}
        needs = {name: change["needs"] for name, change in self._changes.items() if "needs" in change}
        for name, needed in needs.items():
            sources = (context.get_parameter_source(one) for one in (name, needed))
            is_given, has_other = (source is ParameterSource.COMMANDLINE for source in sources)
            if is_given and not has_other:
                raise click.UsageError(
                    f"{flags[name]} acts only together with {flags[needed]}; give both, or neither"
                )


def usual_file(scene: Scene, asked: Mapping[str, Any], ending: str) -> Path:
    """File of what a command writes of a scene with these models of bodies, where none is named."""
    from ..run.simulation import fidelity_word, result_file  # takes its time, which --help need not

    models = {name: asked.get(name, ()) for name in ("rigid", "flexible", "large_deformation")}
    return result_file(scene.name, scene.chosen, fidelity_word(**models), ending)


def _flags(parameter: Parameter, changes: Mapping[str, Any]) -> list[str]:
    """Names of the option of a parameter."""
    plain = f"--{parameter.name.replace('_', '-')}"
    flags: str = changes.get("flags") or _FLAGS.get(parameter.name, plain)
    if parameter.default is True:
        flags = f"{flags}/--no-{flags[2:]}"
    return flags.split(" ")


def _option(parameter: Parameter, flags: Mapping[str, list[str]], changes: Mapping[str, Any]) -> click.Option:
    """The option of a parameter; flags: those of all parameters, which its help may name."""
    settings: dict[str, Any] = {
        "help": _sentence(parameter.help, flags),
        "show_default": parameter.default is not False and parameter.default not in (None, ()),
    }
    if parameter.default is REQUIRED:
        settings |= {"required": True, "show_default": False}
    else:
        settings["default"] = parameter.default
    settings |= _typed(parameter)
    settings |= {key: value for key, value in changes.items() if key not in ("flags", "needs")}
    return click.Option([*flags[parameter.name], parameter.name], **settings)


def _sentence(text: str, flags: Mapping[str, list[str]]) -> str:
    """A help text of the text of a docstring."""

    def shown(found: re.Match[str]) -> str:
        name = found[1]
        if name in flags:
            return flags[name][-1].partition("/")[0]
        return f"`fanfold {name.replace('_', '-')}`" if name in fanfold.HOMES else name

    text = re.sub(r"`(\w+)`", shown, text.replace("``", ""))
    if re.match(r"[a-z]+[ ;-]", text):
        text = text[0].upper() + text[1:]
    return text if not text or text.endswith(".") else f"{text}."


def _parts(annotation: Any) -> Iterator[Any]:  # noqa: ANN401 - an annotation
    """Types that an annotation allows, and what it says of them."""
    if get_origin(annotation) in (Union, UnionType):
        for one in get_args(annotation):
            yield from _parts(one)
    elif get_origin(annotation) is Annotated:
        kind, *said = get_args(annotation)
        yield from (*said, *_parts(kind))
    else:
        yield annotation


def _typed(parameter: Parameter) -> dict[str, Any]:
    """Arguments of `click.Option` that follow from the annotation."""
    parts, name = list(_parts(parameter.annotation)), parameter.name
    choices = [choice for one in parts if get_origin(one) is Literal for choice in get_args(one)]
    for one in parts:
        if isinstance(one, Place):
            return {"type": _PLACES[one.kind], "metavar": "FOLDER" if one.kind == "folder" else "FILE"}
    if bool in parts:
        return {"is_flag": True}
    if frozenset[str] in parts:
        read = ordered_names if parameter.default == () else names_given
        default = (parameter.default,) if isinstance(parameter.default, str) else parameter.default
        return {"multiple": True, "default": default, "callback": read, "metavar": "NAME,..."}
    if numbers := next((one for one in parts if _NUMBERS & {one, *get_args(one)}), None):
        range_ = next((one for one in parts if isinstance(one, Within)), Within())
        return _number(numbers, range_, choices, parameter.default)
    if choices:
        words = {str(one).replace("_", "-"): one for one in choices}
        usual = next((word for word, one in words.items() if one == parameter.default), None)
        return {"type": Choice(words), "default": usual}
    if any(get_origin(one) is not None for one in parts):
        return {"multiple": True, "metavar": "KEY=VALUE"}
    return {"type": str, "metavar": name.upper()}


def _number(kind: Any, range_: Within, words: Sequence[str], default: Any) -> dict[str, Any]:  # noqa: ANN401
    """Of a number, or of a list or a fixed count of numbers."""
    bounds: dict[str, Any] = {"min": range_.low, "max": range_.high, "min_open": range_.above}
    whole = int in (kind, *get_args(kind))
    one: click.ParamType[Any] = Count(**bounds) if whole else Number(range_.unit, words, **bounds)
    shown = "|".join((*words, _UNITS.get(range_.unit, "INTEGER" if whole else "NUMBER")))
    if get_origin(kind) is tuple:
        return {"type": one, "nargs": len(get_args(kind))}
    if get_origin(kind) is not None:
        usual = ",".join(map(short, default)) if isinstance(default, tuple) else None
        return {"type": Several(one), "metavar": f"{shown},...", "default": usual}
    return {"type": one, "metavar": shown}
