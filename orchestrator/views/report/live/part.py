"""The live part of a page: elements, and the data with which its script runs the wing and shows the run."""

from __future__ import annotations

import zlib
from base64 import b64encode
from collections.abc import Iterator, Mapping
from html import escape
from pathlib import Path

import numpy as np

from components.contract.component import Vector
from components.contract.roles import INTERFACE_LOAD
from fmus import CompileError, cross_compiled
from fmus.compiled import NO_GUID

from ....analysis.live.model import LiveModel
from ....analysis.live.sliders import LiveError
from ....cosim.rows import SCENE_CHANNELS, recorded_layout
from ....results.identifiers import unit_of
from ....results.key_figures import Headline, max_of, peak_of, quantity_text, shown
from ....results.point_loads import port_loads
from ....results.recorder import MemoryRecorder, SignalGroup
from ....results.requirements import Judged
from ....results.result import Result
from ....results.short_table import requirement_rows
from ....scene.requirement_tables import limit
from ....scene.units import UNITS, in_unit
from ..scene3d.curves import panels
from ..scene3d.numbers import double, safe_json, whole

_FOLDER = Path(__file__).parent
_POINTS = 2000
"""Rows of a run in the page, which is as many as a screen has columns; peaks come from all steps."""
MARK = '<script type="application/json" id="live-data">'
"""What the data of a page with a live part begin with."""
_PLATFORM = "wasm32"
_MAIN = "latch", "interface"
"""What the names of main numbers begin with; those of cables and dampers are folded."""


def library() -> bytes:
    """The library of all components in WebAssembly, the same for all scenes; LiveError where it cannot be compiled."""
    try:
        return cross_compiled(_PLATFORM)
    except CompileError as error:
        raise LiveError(f"a live page has the components in WebAssembly: {error}") from None


def style() -> str:
    """Style sheet of the part."""
    return _text("live.css")


def script() -> str:
    """What runs the wing, for within the page's script."""
    return f"const WORKER = {safe_json(_text('worker.js'))};\n{_text('live.js')}"


def elements(model: LiveModel) -> str:
    """Sliders, verdicts and requirements, which the script fills, and which usual keys do not slide."""
    rows = "".join(f"<li>{escape(sentence)}</li>" for sentence in model.dropped)
    return _text("live.html") + (
        f"<details><summary>Keys that do not slide</summary><ul>{rows}</ul></details>" if rows else ""
    )


def numbers() -> str:
    """Tables of numbers, which the script fills."""
    return _text("numbers.html")


def data(result: Result, headline: Headline, model: LiveModel, content: Mapping[str, object]) -> str:
    """The wing and what is shown of its runs, as an element of the page; content: what the page has of the result."""
    if result.recording("node_position"):
        raise LiveError(
            f"{result.name}: beams of large deformation are not shown live; run them as modal bodies"
        )
    columns = Columns(model, result)
    of_result: dict[str, object] = content["results"][0]  # type: ignore[index]
    found = {
        "library": _compressed(library()),
        "data": _compressed(model.data),
        "token": NO_GUID,
        "first": model.first_output,
        "width": columns.width,
        "until": model.end,
        "points": _POINTS,
        "sliders": [
            {
                **{name: getattr(one, name) for name in ("name", "title", "low", "high", "start")},
                "unit": one.shown_unit,
                "offsets": whole(model.offsets[moved.places]),
                "values": double(moved.values),
            }
            for one, moved in zip(model.sliders, model.moved, strict=True)
        ],
        "products": model.offsets[sorted(model.products)].tolist(),
        "lines": list(_lines(result, columns)),
        "base": list(_base(columns)),
        "numbers": list(_numbers(headline, columns)),
        "requirements": [
            {**_requirement(one), "stored": row.value}
            for one, row in zip(headline.requirements, requirement_rows(headline), strict=True)
        ],
        "verdict": headline.verdict,
        "bodies": [_motion(body, columns) for body in of_result["bodies"]],  # type: ignore[attr-defined]
        "loads": list(_loads(of_result, columns)),
        "curves": list(_curves(result, columns)),
    }
    return f"{MARK}{safe_json(found)}</script>"


class Columns:
    """What the page reads of the FMU: outputs, then observations; and a result whose rows say what depends on which.

    units: after a row of zeros, one row a column, in which that column alone is 1. What is linear in signals has there
    the factors of the columns.
    """

    def __init__(self, model: LiveModel, result: Result) -> None:
        _, _, outputs, observations = model.scene.layouts
        self.outputs = {name: k for k, name in enumerate(outputs.scalar_names())}
        self.observed = {q.name: outputs.size + observations[q.name].start for q in observations.quantities}
        self.width = outputs.size + observations.size
        groups = [
            SignalGroup.of(name, recorded_layout(component.observation_layout), component.noun)
            for name, component in model.scene.components()
        ]
        names, units, texts = zip(*SCENE_CHANNELS, strict=True)
        groups.append(SignalGroup("scene", names, units, (1,) * len(names), texts))
        scene = np.zeros((self.width + 1, len(names)))
        for k, name in enumerate(names):
            if name in self.outputs:
                scene[1 + self.outputs[name], k] = 1.0
        rows = np.eye(self.width + 1, observations.size, -1 - outputs.size)
        self.first = np.zeros(self.width)
        """their values at the start of the result, zero where it did not record them"""
        for name, component in model.scene.components():
            for q in recorded_layout(component.observation_layout).quantities:
                if result.has(name, q.name):
                    place = self.observed[f"{name}.{q.name}"]
                    self.first[place : place + q.size] = result.signal(name, q.name)[0]
        recorder = MemoryRecorder(groups, {}, {}, result.hinge_lines)
        recorder.extend(np.arange(self.width + 1.0), np.hstack([rows, scene]))
        self.units = recorder.result()

    def terms(self, factors: Vector) -> list[tuple[int, float]]:
        """Columns and factors of what is linear in signals, from its values in `units`."""
        used = np.flatnonzero(factors[1:])
        return list(zip(used.tolist(), factors[1:][used].tolist(), strict=True))


def _compressed(content: bytes) -> str:
    return b64encode(zlib.compress(content, 9)).decode()


def _lines(result: Result, columns: Columns) -> Iterator[dict[str, object]]:
    for line in result.hinge_lines:
        if f"{line.name}.latch_time" in columns.outputs:
            yield {
                "name": line.name,
                "event": line.latch_event,
                "time": columns.outputs[f"{line.name}.latch_time"],
                "torque": columns.outputs[f"{line.name}.latch_torque_peak"],
                "angle": columns.observed[f"{line.sensor}.angle"],
            }


def _base(columns: Columns) -> Iterator[dict[str, object]]:
    """Peaks of force and torque on the spacecraft."""
    for name, variable in columns.units.in_role(INTERFACE_LOAD):
        yield {
            "unit": columns.units.unit(name, variable),
            "column": columns.outputs[f"{name}.{variable}_peak"],
        }


def _numbers(headline: Headline, columns: Columns) -> Iterator[dict[str, object]]:
    """Headline numbers that the FMU computes as well."""
    of_outputs = _outputs_of(headline, columns)
    for number in headline.numbers():
        if (output := of_outputs.get(number.key)) is not None:
            unit, factor = shown(number.unit)
            yield {
                "id": number.id,
                "quantity": quantity_text(number.quantity).replace("interface", "spacecraft"),
                "of": number.of,
                "value": number.value,
                "error": number.error,
                "unit": unit,
                "factor": factor,
                "is_time": number.quantity == "latch time",
                "column": output,
                "is_main": number.quantity.startswith(_MAIN),
            }


def _requirement(one: Judged) -> dict[str, object]:
    """A requirement on a number, and what turns this into the unit of the limit."""
    found = limit(one.text)
    unit = unit_of(found.number)
    return {
        "text": one.text,
        "id": found.number,
        "sign": found.sign,
        "limit": in_unit(found.value, unit),
        "unit": "" if one.unit == "1" else one.unit,
        "factor": 1.0 / UNITS.get(unit, {}).get(one.unit, 1.0),
    }


def _outputs_of(headline: Headline, columns: Columns) -> dict[tuple[str, str], int]:
    """Columns of outputs by the headline number that has the same definition."""
    outputs = columns.outputs
    found = {
        (f"{what} {kind}", line): outputs[f"{line}.{what}_{kind.replace(' ', '_')}"]
        for line in headline.latch_times
        for what, kind in (("latch", "time"), ("latch", "rate"), ("latch", "torque peak"))
    }
    for name, variable in columns.units.in_role(INTERFACE_LOAD):
        load = "force" if columns.units.unit(name, variable) == "N" else "torque"
        found[f"interface {load} magnitude peak", ""] = outputs[f"{name}.{variable}_peak"]
    for name, torques in headline.torque_peaks.items():
        for variable in torques:
            found[peak_of(variable), name] = outputs.get(f"{name}.{variable}_peak", -1)
    for name, forces in headline.force_extremes.items():
        for variable, (low, high) in forces.items():
            if 0.0 <= low < high:  # of such a force the largest magnitude is the maximum
                found[max_of(variable), name] = outputs.get(f"{name}.{variable}_peak", -1)
    return {key: column for key, column in found.items() if column >= 0}


def _motion(body: Mapping[str, object], columns: Columns) -> dict[str, object]:
    """Columns of the pose of a body, none of one that stands still, and of its amplitudes."""
    name = body["name"]
    first = columns.observed.get(f"{name}.modal_coordinate", 0)
    modes: list[int] = body["modes"]  # type: ignore[assignment]
    scales: list[float] = body["mode_scales"]  # type: ignore[assignment]
    return {
        "position": columns.observed.get(f"{name}.frame_position"),
        "orientation": columns.observed.get(f"{name}.frame_orientation"),
        "amplitudes": [(first + mode, 1.0 / scale) for mode, scale in zip(modes, scales, strict=True)],
    }


def _loads(of_result: Mapping[str, object], columns: Columns) -> Iterator[list[list[tuple[int, float]]]]:
    """Columns of the loads that the view marks, by component."""
    marks: Mapping[str, list[Mapping[str, str]]] = of_result["marks"]  # type: ignore[assignment]
    for load in marks.get("loads", ()):
        name, unit = load["name"], load["unit"]
        at_ports = port_loads(columns.units, unit)
        values = at_ports.get(name)
        if values is None:
            (variable,) = [
                v for n, v in columns.units.in_role(INTERFACE_LOAD) if columns.units.unit(n, v) == unit
            ]
            values = columns.units.signal(name, variable)
        yield [columns.terms(values[:, axis]) for axis in range(3)]


def _curves(result: Result, columns: Columns) -> Iterator[dict[str, object]]:
    """Curves of the plots, as sums of columns; from_start: less their value at the start."""
    factors = {
        (panel.title, label): values for panel in panels(columns.units) for label, values in panel.curves
    }
    for panel in panels(result):
        for label, values in panel.curves:
            own = factors.get((panel.title, label))
            if own is not None:
                terms = columns.terms(own)
                yield {
                    "title": panel.title,
                    "label": label,
                    "terms": terms,
                    "from_start": _is_from_start(own, values, columns),
                }


def _is_from_start(factors: Vector, values: Vector, columns: Columns) -> bool:
    """Whether a curve counts from the start of the run, where what it is a sum of is not zero."""
    whole_sum = float(factors[1:] @ columns.first)
    return bool(values[0] == 0.0 and whole_sum != 0.0)


def _text(name: str) -> str:
    return (_FOLDER / name).read_text(encoding="utf-8")
