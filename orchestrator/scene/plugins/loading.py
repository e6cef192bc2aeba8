"""What scenes use that is kept outside of the package: files of components and of bodies, and installed plugins."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from functools import cache
from importlib.metadata import entry_points

from components.contract.errors import FanfoldError
from components.contract.plugins import PluginError, load_plugin

from ..bodies import forget_models

GROUP = "fanfold.plugins"
"""Entry points of installed packages; what they name is imported, which registers its components."""


def load(file: str) -> None:
    """One file: components in Python (.py), or bodies of the catalogue (.toml); FanfoldError where it is neither."""
    if file.endswith(".toml"):
        from components.catalogue.data_sheets import add_sheet  # takes its time, which others need not

        if add_sheet(file):
            forget_models()
    elif file.endswith(".py"):
        load_plugin(file)
    else:
        raise PluginError(f"{file}: a plugin is a file of components (.py) or of bodies (.toml)")


def problems(files: Collection[str]) -> Iterator[str]:
    """Load what is installed and these files; a sentence for each that cannot be."""
    yield from _installed()
    for file in files:
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
