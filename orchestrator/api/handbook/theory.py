"""The page of the theory: equations and sources as the modules state them that compute with them."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from inspect import getdoc
from pkgutil import iter_modules
from textwrap import dedent

import components
from components import REGISTRY
from components import numerics as kernels

from .words import EQUATIONS


def theory_page() -> str:
    """Components by kind, then the kernels that they share."""
    lines = ["# Theory", "", _HEAD, ""]
    for kind, component in sorted(REGISTRY.items()):
        if component.__module__.partition(".")[0] == components.__name__:
            lines += [
                f"## `{kind}`",
                "",
                *EQUATIONS.get(kind, ()),
                *_prose(import_module(component.__module__).__doc__),
            ]
            lines += [f"Its variables: [](#component-{kind.replace('_', '-')}).", ""]
    lines += ["## Kernels that components share", ""]
    for module in iter_modules(kernels.__path__):
        whole = import_module(f"{kernels.__name__}.{module.name}")
        lines += [f"### `components/numerics/{module.name}.py`", "", *_prose(whole.__doc__)]
    return "\n".join(lines) + "\n"


_HEAD = """What follows are the texts of the modules themselves, which state the equations that they compute and
where they are from. World axes, SI units, radians; quaternions are scalar first and rotate body into world
coordinates. The Python module is the readable definition, a C kernel of the same equations in `fmus/native/kernels`
its fast twin."""


def _prose(text: str | None) -> Iterator[str]:
    """A docstring as Markdown: paragraphs, and what is indented as it stands."""
    for part in dedent(f"    {text or ''}").strip("\n").split("\n\n"):
        lines = part.strip("\n").split("\n")
        if all(line.startswith("    ") for line in lines):
            yield from ("```text", *(line[4:] for line in lines), "```", "")
        else:
            yield from (" ".join(line.strip() for line in lines), "")


def prose(thing: object) -> list[str]:
    """The docstring of anything as lines of Markdown."""
    return list(_prose(getdoc(thing)))
