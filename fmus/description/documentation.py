"""What people see of an FMU in an importer: a page with ports and variables, a picture, an icon."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from html import escape
from pathlib import Path

from components import Component

from .choices import FmiVersion
from .fmi2 import About, Experiment
from .terminals import terminals_of
from .variables import Variable, quantities

_HERE = Path(__file__).parent
_PICTURE = "picture.png"
_HEADINGS = {"input": "Inputs", "output": "Outputs", "parameter": "Parameters"}
_TYPES = {"real": "real", "boolean": "Boolean", "integer": "integer"}
_EXPERIMENT = ("stop time, s", "communication step, s", "tolerance")
_STYLE = (
    "body{font:14px/1.45 sans-serif;margin:2em;max-width:72em;color:#222}"
    "table{border-collapse:collapse;margin:.5em 0 1.5em}"
    "th,td{border-bottom:1px solid #ccc;padding:.2em .8em .2em 0;text-align:left;vertical-align:top}"
    "img{max-width:100%}"
)


def documentation(
    component: Component,
    name: str,
    starts: Sequence[float],
    about: About,
    fmi: FmiVersion,
    experiment: Experiment | None = None,
) -> dict[str, bytes]:
    """Files by their path in an FMU: `documentation/index.html`, its picture, and icons."""
    page = "\n".join(_page(component, name, starts, about, experiment))
    files = {"documentation/index.html": page.encode()}
    if about.picture:
        files[f"documentation/{_PICTURE}"] = about.picture
    icon = (_HERE / "icon.png").read_bytes()
    if fmi == "2.0":
        return {**files, "model.png": icon}
    drawing = (_HERE / "icon.svg").read_bytes()
    return {**files, "terminalsAndIcons/icon.png": icon, "terminalsAndIcons/icon.svg": drawing}


def _page(
    component: Component, name: str, starts: Sequence[float], about: About, experiment: Experiment | None
) -> Iterator[str]:
    yield f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(name)}</title>'
    yield f"<style>{_STYLE}</style></head><body>"
    yield f"<h1>{escape(name)}</h1>"
    yield f"<p>{escape(about.description or component.noun)}</p>"
    if about.picture:
        yield f'<p><img src="{_PICTURE}" alt="{escape(name)} at the start and deployed"></p>'
    facts = {"author": about.author, "version": about.version, "licence": about.license}
    if experiment is not None:
        values = (experiment.stop_time, experiment.step_size, experiment.tolerance)
        facts |= {title: "" if v is None else f"{v:g}" for title, v in zip(_EXPERIMENT, values, strict=True)}
    yield from _table(("", ""), [(title, text) for title, text in facts.items() if text])
    for terminal in terminals_of(component):
        yield f"<h2>Port {escape(terminal.name)}</h2><p>{escape(terminal.description)}</p>"
        yield from _table(("member", "variable", "kind"), terminal.members)
    for causality, heading in _HEADINGS.items():
        found = [variable for variable in quantities(component) if variable.causality == causality]
        yield f"<h2>{heading}</h2>"
        titles = ("name", "type", "size", "unit", "variability", "start", "range", "meaning")
        yield from _table(titles, (_row(variable, starts) for variable in found))
    yield "</body></html>"


def _row(variable: Variable, starts: Sequence[float]) -> tuple[str, ...]:
    quantity, first = variable.quantity, variable.value_reference
    given = starts[first : first + quantity.size] if variable.causality != "output" else ()
    start = f"{given[0]:g}" if len(set(given)) == 1 else ", ".join(f"{value:g}" for value in given)
    low, high = ("" if bound is None else f"{bound:g}" for bound in (quantity.minimum, quantity.maximum))
    bounds = f"{low} to {high}" if low or high else ""
    size, kind = str(quantity.size), quantity.kind
    unit = quantity.unit if kind == "real" else ""
    return variable.name, _TYPES[kind], size, unit, variable.variability, start, bounds, quantity.description


def _table(titles: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    yield "<table>"
    if any(titles):
        yield f"<tr>{''.join(f'<th>{title}</th>' for title in titles)}</tr>"
    for row in rows:
        yield f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>"
    yield "</table>"
