"""A run as one self-contained HTML file: numbers, events, animation, figures, provenance."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from html import escape

from ...analysis.motion.deflection import quiet
from ...messages import is_note
from ...results.compare import by_component, cells, compare, end_note, labels
from ...results.differences import scene_note
from ...results.earlier import SETTINGS
from ...results.key_figures import Headline, headline, headline_rows
from ...results.parts import MESSAGES, json_of
from ...results.point_loads import event_loads
from ...results.result import Result
from ...validity.travel import messages

_FIDELITIES = {"flexible": "flexible bodies", "large_deformation": "bodies of large deformation"}
_SCENE = ("scene", "scene_tree", SETTINGS, MESSAGES, *_FIDELITIES)
_DIGEST = "fmu."


def report(result: Result, others: Sequence[Result] = (), frame_count: int = 6) -> str:
    """The page, as HTML text; others: results to set against the first; nothing that moves for no frames."""
    from .page import page  # matplotlib takes its time, which --help need not

    title = result.provenance.get("scene", _file(result))
    found = headline(result)
    opening, numbers = [*_opening(result, title, found)], [*_numbers(result, found)]
    figures = [*_figures(result)]
    for k, other in enumerate(others):
        figures += _comparison(result, other, f"compare_{k + 1}" if k else "compare")
    if others:
        figures += _together([result, *others])
    # What moves takes longest, so all that may be wrong with a result is told before.
    moving = _animation([result, *others[:1]], frame_count)
    return page(f"{title}: {_file(result)}", [*opening, *moving, *numbers, *figures, *_provenance(result)])


def _file(result: Result) -> str:
    """Name of its file, without the folder; of its scene where it has none."""
    return result.name if result.path is None else result.path.name


def _opening(result: Result, title: str, found: Headline) -> Iterator[str]:
    from .page import paragraph

    scene = _scene_tree(result).get("scene")
    description = scene.get("description") if isinstance(scene, dict) else None
    yield f"<h1>{escape(title)}</h1>"
    yield paragraph(
        f"{description}. Result {_file(result)}." if description else f"Result {_file(result)}.", "lead"
    )
    yield paragraph(found.verdict, "lead")


def _numbers(result: Result, found: Headline) -> Iterator[str]:
    from .page import heading, paragraph, table

    yield heading("Headline numbers")
    columns = ("quantity", "of", "value", "unit", "estimated error")
    yield table(columns, headline_rows(found), numeric=(2, 4))
    for sentence in messages(result, found):
        yield paragraph(f"{'Note' if is_note(sentence) else 'Warning'}: {sentence}", "warning")
    if waits := [one.sentence(float(result.time[-1])) for one in quiet(result)]:
        yield heading("After the prescribed motion")
        yield from (paragraph(f"{sentence}.") for sentence in waits)
    yield heading("Events")
    events = [(f"{time:.6f}", component, text) for time, component, text in result.events]
    yield table(("time, s", "component", "event"), events or [("", "", "none")], numeric=(0,))
    loads = [
        (f"{one.time:.6f}", one.joint, f"{one.before:.4g}", f"{one.after:.4g}", _ratio(one.ratio), one.unit)
        for one in event_loads(result)
    ]
    if loads:
        yield paragraph("Peak joint loads within 1 s before and after each event:")
        headings = ("time, s", "joint", "before", "after", "after / before", "unit")
        yield table(headings, loads, numeric=(0, 2, 3, 4))


def _ratio(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"


def _animation(results: Sequence[Result], count: int) -> Iterator[str]:
    """The structure in space and interactive plots; nothing for no pictures."""
    if not count:
        return
    from .animation import frames
    from .page import heading
    from .scene3d.content import content
    from .scene3d.fragment import plots, scripts, space

    labels = [f"{letter}, {_file(one)}" for letter, one in zip("AB", results, strict=False)]
    found = content(results, "AB"[: len(results)], labels)
    if found.has_bodies:
        yield heading("Deployment")
        yield space(frames(results[0], count), found)
    if found.has_curves:
        yield heading("Over time")
        yield plots()
    if found.has_bodies or found.has_curves:
        yield scripts(found)


def _figures(result: Result) -> Iterator[str]:
    from ..plots import draw_all
    from .page import heading, picture

    yield heading("Figures")
    for name, caption, figure in draw_all(result):
        yield picture(figure, name, caption)


def _together(results: Sequence[Result]) -> Iterator[str]:
    """What runs that follow a prescribed motion show over time, all over each other."""
    from ..motion.histories import overlays
    from .page import heading, picture

    names = {f"{chr(ord('A') + k)}, {_file(one)}": one for k, one in enumerate(results)}
    drawn = [picture(figure, f"together_{name}", caption) for name, caption, figure in overlays(names)]
    if drawn:
        yield heading("Prescribed motions, overlaid")
        yield from drawn


def _comparison(result: Result, other: Result, prefix: str) -> Iterator[str]:
    from ..comparison import draw_comparison
    from .page import heading, paragraph, picture, table

    found, names = compare(result, other), labels(result, other)
    yield heading(f"{names[0]} and {names[1]}")
    yield paragraph(f"A is {_file(result)}, B is {_file(other)}.")
    if not other.complete:
        yield paragraph(f"The run of B was interrupted at {other.time[-1]:.6g} s.", "warning")
    if note := scene_note(result, other):
        yield paragraph(f"Warning: {note}", "warning")
    if note := end_note(result, other, names):
        yield paragraph(note)
    rows = [(row.quantity, row.of, *cells(row)) for row in found.rows]
    headings = ("quantity", "of", "A", "B", "B / A", "at A, s", "at B, s", "shift, s", "unit")
    yield table(headings, rows, numeric=range(2, 8))
    for name, signals in zip(names, (found.only_a, found.only_b), strict=True):
        for component, variables in by_component(signals).items():
            yield paragraph(f"Only in {name}: {component}: {', '.join(variables)}.")
    for name, caption, figure in draw_comparison(result, other):
        yield picture(figure, f"{prefix}_{name}", caption)


def _provenance(result: Result) -> Iterator[str]:
    from .page import folded, heading, table

    known = dict(result.provenance)
    digests = {name: known.pop(name) for name in list(known) if name.startswith(_DIGEST)}
    yield heading("Provenance")
    bodies = [(words, _names(known.get(fidelity, "[]"))) for fidelity, words in _FIDELITIES.items()]
    versions = [(name, text) for name, text in known.items() if name not in _SCENE]
    statistics = [(name.replace("_", " "), f"{value}") for name, value in result.statistics.items()]
    yield table(("property", "value"), [*bodies, *versions, *statistics])
    tree = _scene_tree(result)
    yield folded("resolved scene file", _indented(tree) or known.get("scene", ""))
    if digests:
        text = "\n".join(f"{name.removeprefix(_DIGEST)}  {digest}" for name, digest in digests.items())
        yield folded("SHA-256 of the FMUs", text)


def _names(text: str) -> str:
    names = json_of(text)
    return (", ".join(map(str, names)) if isinstance(names, list) else "") or "none"


def _scene_tree(result: Result) -> dict[str, object]:
    tree = json_of(result.provenance.get("scene_tree", "{}"))
    return tree if isinstance(tree, dict) else {}


def _indented(tree: dict[str, object]) -> str:
    """JSON for people; empty where there is nothing, or it is nested too deeply to be anybody's."""
    try:
        return json.dumps(tree, indent=1) if tree else ""
    except RecursionError:
        return ""
