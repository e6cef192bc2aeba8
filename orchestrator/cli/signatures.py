"""Parameters of public functions, read from their source: type, default, help.

Help must come at once, and importing what runs a scene takes a second; so nothing is imported but the types of
annotations.
"""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import import_module
from pathlib import Path
from typing import Any

import orchestrator as fanfold

REQUIRED = object()
"""Default of a parameter that has none."""
_ROOT = Path(__file__).parents[2]
_OURS = ("components", "fmus", "orchestrator")
_LIGHT = "orchestrator.api.options"
"""The only module of ours that is imported."""
_SECTION = re.compile(r"^(\w[\w ]*)\n-{3,}\n", re.MULTILINE)
_ENTRY = re.compile(r"^(\w[\w, ]*?)(?: : .*)?\n((?:[ ]+.*\n?|\n)+)", re.MULTILINE)
_REFERENCE = re.compile(r"see `(\w+)`$")


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a function."""

    name: str
    annotation: Any
    default: Any
    help: str


def parameters_of(function: str, module: str | None = None) -> dict[str, Parameter]:
    """Parameters of a function by name; of a public one if no module is named."""
    source = _Source.of(module or fanfold.HOMES[function].module)
    node = source.functions[function]
    _, texts = documented(ast.get_docstring(node) or "")
    return {
        name: Parameter(name, source.value(annotation), default, _resolved(name, texts.get(name, "")))
        for name, annotation, default in source.arguments(node)
    }


def documented(docstring: str) -> tuple[str, dict[str, str]]:
    """What a NumPy docstring says before its sections, and of each parameter of a function or option of a command."""
    text, *sections = _SECTION.split(docstring)
    found = dict(zip(sections[::2], sections[1::2], strict=True))
    entries = _ENTRY.findall(f"{found.get('Parameters') or found.get('Options', '')}\n")
    return text.strip(), {
        name.strip(): " ".join(help.split()) for names, help in entries for name in names.split(",")
    }


def _resolved(name: str, text: str) -> str:
    """The text; that of another function if it refers to one, as in "see `simulate`"."""
    reference = _REFERENCE.match(text)
    return parameters_of(reference[1])[name].help if reference else text


class _Source(dict[str, Any]):
    """Names of a module as its source defines them; classes and values that are no types are Any."""

    def __init__(self, path: Path, package: str) -> None:
        super().__init__()
        self._tree = ast.parse(path.read_text(encoding="utf-8"))
        self._package = package

    @staticmethod
    @cache
    def of(module: str) -> _Source:
        """The source of a module of ours."""
        path = _ROOT.joinpath(*module.split("."))
        if path.is_dir():
            return _Source(path / "__init__.py", module)
        return _Source(path.with_suffix(".py"), module.rpartition(".")[0])

    @cached_property
    def functions(self) -> dict[str, ast.FunctionDef]:
        """Functions by name."""
        return {node.name: node for node in self._tree.body if isinstance(node, ast.FunctionDef)}

    @cached_property
    def _assigned(self) -> dict[str, ast.expr]:
        return {
            target.id: node.value
            for node in self._tree.body
            if isinstance(node, ast.Assign)
            for target in node.targets
            if isinstance(target, ast.Name)
        }

    @cached_property
    def _imported(self) -> dict[str, tuple[str, str]]:
        """Module and name there by name here."""
        return {
            alias.asname or alias.name: (self._absolute(node), alias.name)
            for node in ast.walk(self._tree)
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
        }

    def _absolute(self, node: ast.ImportFrom) -> str:
        if not node.level:
            return node.module or ""
        parts = self._package.split(".")
        return ".".join((*parts[: len(parts) - node.level + 1], *filter(None, (node.module,))))

    def __missing__(self, name: str) -> Any:  # noqa: ANN401 - types and values
        if name in self._assigned:
            return self.value(self._assigned[name])
        if hasattr(builtins, name):
            raise KeyError(name)
        module, original = self._imported.get(name, ("", ""))
        if module == _LIGHT or (module and module.partition(".")[0] not in _OURS):
            return getattr(import_module(module), original)
        return _Source.of(module)[original] if module else Any

    def value(self, node: ast.expr) -> Any:  # noqa: ANN401
        """Value of an expression."""
        return eval(compile(ast.Expression(node), "", "eval"), {}, self)

    def arguments(self, node: ast.FunctionDef) -> Iterator[tuple[str, ast.expr, Any]]:
        """Name, annotation and default of each parameter."""
        named, missing = node.args.args, len(node.args.args) - len(node.args.defaults)
        defaults = [*([None] * missing), *node.args.defaults, *node.args.kw_defaults]
        for argument, default in zip((*named, *node.args.kwonlyargs), defaults, strict=True):
            assert argument.annotation is not None
            value = REQUIRED if default is None else self.value(default)
            yield argument.arg, argument.annotation, value
