"""The page of the theory: equations and sources as the modules state them that compute with them."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from inspect import cleandoc
from pkgutil import walk_packages

import components
from components import REGISTRY

from .equations import EQUATIONS, SOURCES

_ROOMS = {
    "What bodies and hinges are made of": ("body_parts", "hinge_parts", "beam_parts"),
    "Flexible bodies": ("flexible", "imported"),
    "Kernels that components share": ("numerics",),
}
"""Packages of the components by heading."""
_LEFT_OUT = (
    "components.imported.matrices",
    "orchestrator.analysis.sampling.journal",
    "orchestrator.analysis.sampling.workers",
)
"""Modules that say much about files and processes."""
_COUPLING = (
    "orchestrator.cosim.implicit.solver",
    "orchestrator.cosim.implicit.interface_jacobian",
    "orchestrator.cosim.implicit.elimination",
    "orchestrator.cosim.implicit.local_error",
    "orchestrator.cosim.energy_guard",
    "orchestrator.cosim.latch_up",
    "orchestrator.cosim.static_search",
    "orchestrator.cosim.explicit",
    "orchestrator.run.error_estimate",
    "orchestrator.run.tolerance_refinement",
    "orchestrator.run.verify",
)


def theory_page() -> str:
    """Components by kind, what they are made of, coupling, analyses, and what all of it cites."""
    lines = ["# Theory", "", _HEAD, "", "## Components", ""]
    for kind, component in sorted(REGISTRY.items()):
        if not component.comes_from_outside():
            lines += [f"### `{kind}`", "", *_equations(kind), *_prose(component.__module__)]
            lines += [f"Its variables: [](#component-{kind.replace('_', '-')}).", ""]
    for title, rooms in _ROOMS.items():
        lines += [f"## {title}", ""]
        for room in rooms:
            lines += _section(f"{components.__name__}.{room}")
    lines += ["## Coupling", ""]
    for name in _COUPLING:
        lines += _entry(name)
    lines += ["## Analyses", "", *_section("orchestrator.analysis"), "## Sources", ""]
    lines += (f"* {source}." for source in sorted(SOURCES.values()))
    return "\n".join(lines) + "\n"


_HEAD = """What follows are the texts of the modules themselves, which state the equations that they compute and
where they are from. World axes, SI units, radians; quaternions are scalar first and rotate body into world
coordinates. Of components the Python module is the readable definition, a C kernel of the same equations in
`fmus/native/kernels` its fast twin."""


def _section(package: str) -> Iterator[str]:
    """The modules of a package that say more than what they are."""
    for module in walk_packages(import_module(package).__path__, f"{package}."):
        if module.name not in _LEFT_OUT and "\n\n" in (import_module(module.name).__doc__ or "").strip():
            yield from _entry(module.name)


def _entry(module: str) -> Iterator[str]:
    yield from (f"### `{module.replace('.', '/')}.py`", "", *_equations(module), *_prose(module))


def _equations(name: str) -> Iterator[str]:
    """Displayed equations and what their letters mean."""
    equations, words = EQUATIONS.get(name, ((), ""))
    for equation in equations:
        yield from ("```{math}", equation, "```", "")
    if words:
        yield from (words, "")


def _prose(module: str) -> Iterator[str]:
    """The docstring of a module as Markdown: paragraphs, and what is indented as it stands."""
    for part in cleandoc(import_module(module).__doc__ or "").split("\n\n"):
        lines = part.strip("\n").split("\n")
        if all(line.startswith("    ") for line in lines):
            yield from ("```text", *(line[4:] for line in lines), "```", "")
        else:
            yield from (" ".join(line.strip() for line in lines).replace("*", r"\*").replace("$", r"\$"), "")
