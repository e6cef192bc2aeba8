"""Names of a package that are imported at first use, as modules take their time to import."""

from __future__ import annotations

from ast import If, ImportFrom, parse
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple


class Home(NamedTuple):
    """Where a name of a package is defined, and what it is called there."""

    module: str
    name: str


def homes(package: str, file: str) -> dict[str, Home]:
    """Of each name of a package: what type checkers read in the first `if` of its file."""
    tree = parse(Path(file).read_text(encoding="utf-8"))
    block = next(node for node in tree.body if isinstance(node, If))
    return {
        one.asname or one.name: Home(f"{package}.{node.module}" if node.level else str(node.module), one.name)
        for node in block.body
        if isinstance(node, ImportFrom)
        for one in node.names
    }


def importer(package: str, known: Mapping[str, Home]) -> Callable[[str], Any]:
    """The `__getattr__` of a package with these names."""

    def find(name: str) -> Any:  # noqa: ANN401 - of whatever type it has where it is defined
        if name not in known:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(known[name].module), known[name].name)

    return find
