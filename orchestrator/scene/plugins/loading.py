"""What scenes use that is kept outside of the package: files of components and of bodies, and installed plugins."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from functools import cache
from importlib.metadata import entry_points
from shlex import quote

from components.contract.errors import FanfoldError
from components.contract.plugins import PluginError, load_plugin

from .trust import is_absent, missing_programs, refused_data, refused_programs, trust_data

GROUP = "fanfold.plugins"
"""Entry points of installed packages; what they name is imported, which registers its components."""


def load(file: str) -> None:
    """One file: components in Python (.py), or bodies of the catalogue (.toml); FanfoldError where it is neither."""
    if file.endswith(".toml"):
        from ..data_sheets import add_sheet  # takes its time, which others need not

        add_sheet(file)
    elif file.endswith(".py"):
        load_plugin(file)
    else:
        raise PluginError(f"{file}: a plugin is a file of components (.py) or of bodies (.toml)")


def refusal(plugins: Collection[str], data: Iterable[str], accepted: Collection[str]) -> Iterator[str]:
    """Why a scene is not looked at: it names programs that nobody trusts.

    Of one that is, results may open its files of data from now on.
    """
    if refused := refused_programs(plugins, accepted):
        each = " ".join(f"--plugin {quote(file)}" for file in refused)
        yield (
            f"scene.plugins: {', '.join(refused)} would run as a program; type --trust if it may, until it changes, or "
            f"{each} for this time (in Python: trust=True, or load_plugin)"
        )
    else:
        trust_data(data)


def refusal_of_result(plugins: Collection[str], data: Iterable[str]) -> Iterator[str]:
    """Why the scene of a result is not looked at: it takes plugins or files that a result alone does not open."""
    if missing := missing_programs(plugins):
        each = " ".join(f"--plugin {quote(file)}" for file in missing)
        yield (
            f"scene.plugins: {', '.join(missing)} is not loaded, as results load no programs; type {each} "
            "(in Python: load_plugin)"
        )
    if refused := list(refused_data(data)):
        yield (
            f"it names {', '.join(refused)}, which no scene has opened on this computer; type --trust if it may be "
            "opened (in Python: trust)"
        )


def problems(files: Collection[str]) -> Iterator[str]:
    """Load what is installed and these files; a sentence for each that cannot be.

    A program that is not there is no problem where one of its name is loaded.
    """
    yield from _installed()
    for file in files:
        if is_absent(file) and not missing_programs([file]):
            continue
        try:
            load(file)
        except FanfoldError as error:
            yield f"scene.plugins: {error}"


@cache
def _installed() -> tuple[str, ...]:
    """Load the plugins of installed packages, once; a sentence for each that cannot be."""
    found = []
    for point in entry_points(group=GROUP):
        try:
            point.load()
        except Exception as error:  # of whoever wrote it
            found.append(
                f"the installed plugin {point.name} ({point.value}): {type(error).__name__}: {error}"
            )
    return tuple(found)
