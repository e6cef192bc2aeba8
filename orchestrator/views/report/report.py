"""A run as one self-contained HTML file: verdict, requirements, view in space, plots, main numbers; the rest folded."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from subprocess import SubprocessError, run

import tomli_w

from ...analysis.live.model import LiveModel
from ...analysis.motion.deflection import quiet
from ...messages import is_note
from ...results.compare import by_component, cells, compare, end_note, labels
from ...results.differences import scene_note
from ...results.earlier import SETTINGS
from ...results.key_figures import Headline, headline, headline_rows
from ...results.parts import MESSAGES, Scalar, json_of
from ...results.point_loads import event_loads
from ...results.requirements import checked_limits
from ...results.result import Result
from ...results.short_table import (
    LINE_HEADINGS,
    REQUIREMENT_HEADINGS,
    line_rows,
    requirement_rows,
    short_rows,
)
from ...validity.travel import messages

_FIDELITIES = {"flexible": "flexible", "large_deformation": "large deformation"}
_SCENE = ("scene", "scene_tree", SETTINGS, MESSAGES, *_FIDELITIES)
_DIGEST = "fmu."


def report(
    result: Result,
    others: Sequence[Result] = (),
    frame_count: int = 6,
    limits: Sequence[str] = (),
    author: str = "",
    live: LiveModel | None = None,
) -> str:
    """The page, as HTML text: what a reader asks first on top, all else folded.

    others: results to set against the first; nothing that moves for no frames. limits: requirements in addition to
    those of the result. author: by default the user of git. live: the wing as it runs in the page, in the view and the
    plots in place of the others.
    """
    from .page import folded, page  # matplotlib takes its time, which --help need not

    title = result.provenance.get("scene", _file(result))
    found = [_judged(one, limits) for one in (result, *others[:1])]
    opening, judged = _title_block(result, title, author), [*_judgement(result, found)]
    numbers = [*_numbers(found)]
    every, events = [*_every_number(result, found[0])], [*_events(result)]
    figures = [*_figures(result)] if live is None else []  # the plots of the page show every run
    compared = [
        part
        for k, other in enumerate(others)
        for part in _comparison(result, other, f"compare_{k + 1}" if k else "compare")
    ]
    if others:
        compared += _together([result, *others])
    # What moves takes longest, so all that may be wrong with a result is told before.
    moving = (
        _animation([result, *others[:1]], frame_count)
        if live is None
        else _live(result, found[0], live, frame_count)
    )
    sections = {
        "Every headline number": every,
        "Events": events,
        "Figures": figures,
        "Comparison": compared,
        "Provenance": [*_provenance(result)],
    }
    rest = [folded(heading, "\n".join(parts)) for heading, parts in sections.items() if parts]
    if live is None:
        shown = [*judged, *moving, *numbers, *rest]
    else:
        stored = folded(f"Stored result, {_file(result)}", "\n".join([*judged, *numbers, *rest]))
        shown = [*moving, stored]
    return page(f"{title}: {_file(result)}", [opening, *shown])


def _judged(result: Result, limits: Sequence[str]) -> Headline:
    found = headline(result)
    return replace(found, limits=tuple(dict.fromkeys((*found.limits, *checked_limits(limits)))))


def _file(result: Result) -> str:
    """Name of its file, without the folder; of its scene where it has none."""
    return result.name if result.path is None else result.path.name


def _title_block(result: Result, title: str, author: str) -> str:
    from .page import title_block

    scene = _scene_tree(result).get("scene")
    description = scene.get("description") if isinstance(scene, dict) else None
    known = result.provenance
    facts = {
        "date": known.get("date", "")[:10],
        "author": author or _git_user(),
        "result": _file(result),
        "bodies": _models(result),
        "tolerance": known.get("tolerance", ""),
        "Fanfold": known.get("fanfold", ""),
    }
    return title_block(title, f"{description}." if description else "", facts)


def _judgement(result: Result, found: Sequence[Headline]) -> Iterator[str]:
    """Verdict of each result, requirements, warnings."""
    from .page import heading, paragraph, table

    for letter, one in zip(_letters(found), found, strict=True):
        told = f"{letter}: {one.verdict}" if letter else one.verdict
        yield paragraph(told, "verdict" if _is_good(one) else "verdict bad")
    by_text = [{row.requirement: row for row in requirement_rows(one)} for one in found]
    if texts := list(dict.fromkeys(text for one in by_text for text in one)):
        first, *others = REQUIREMENT_HEADINGS
        heads = [first, *others] if len(found) == 1 else [first, *("A", *others[1:]), *("B", *others[1:])]
        rows = [
            (text, *(cell for one in by_text for cell in one.get(text, ("", *["-"] * len(others)))[1:]))
            for text in texts
        ]
        numeric = [k for k in range(1, len(heads)) if k % len(others)]
        yield heading("Requirements")
        yield table(heads, rows, numeric=numeric, marked={"not met", "no such number"})
    for sentence in messages(result, found[0]):
        if not is_note(sentence):
            yield paragraph(f"Warning: {sentence}", "warning")


def _letters(found: Sequence[Headline]) -> Sequence[str]:
    """Of results that are compared; empty for one alone."""
    return "AB" if len(found) > 1 else ("",)


def _is_good(found: Headline) -> bool:
    return found.complete and not found.not_opened and all(one.met for one in found.requirements)


def _models(result: Result) -> str:
    """How bodies are modelled, such as "rigid" or "flexible: panel1, panel2"."""
    told = [
        f"{word}: {names}"
        for kind, word in _FIDELITIES.items()
        if (names := _names(result.provenance.get(kind, "[]"))) != "none"
    ]
    return "; ".join(told) or "rigid"


def _git_user() -> str:
    """Name of the user of git; empty where there is none."""
    try:
        asked = run(["git", "config", "user.name"], capture_output=True, text=True, timeout=2.0, check=False)
    except (OSError, SubprocessError):
        return ""
    return asked.stdout.strip()


def _numbers(found: Sequence[Headline]) -> Iterator[str]:
    """Main numbers, rounded to their estimated errors: of hinge lines, and of the rest."""
    from .page import heading, table

    yield heading("Main numbers")
    both = len(found) > 1
    lines = [(letter, row) for letter, one in zip("AB", found, strict=False) for row in line_rows(one)]
    if lines:
        lines.sort(key=lambda pair: pair[1].line)
        used = [
            k for k in range(len(LINE_HEADINGS)) if k == 0 or any(row[k] not in ("-", "") for _, row in lines)
        ]
        rows = [(*([letter] * both), *(row[k] for k in used)) for letter, row in lines]
        heads = [*["result"] * both, *(LINE_HEADINGS[k] for k in used)]
        yield table(heads, rows, numeric=range(1 + both, len(heads)))
    every = [
        {(row.quantity, row.note if row.quantity == "slack" else ""): row for row in short_rows(one)}
        for one in found
    ]
    keys = list(dict.fromkeys(key for one in every for key in one))
    rows = []
    for key in keys:
        of = [one.get(key) for one in every]
        first = next(row for row in of if row)
        notes = [row.note if row else "" for row in of]
        note = (
            notes[0]
            if len({*notes}) == 1
            else "; ".join(f"{x}: {y}" for x, y in zip("AB", notes, strict=False) if y)
        )
        rows.append((first.quantity, *(row.value if row else "-" for row in of), first.unit, note))
    heads = ["quantity", *("AB" if both else ["value"]), "unit", "of"]
    yield table(heads, rows, numeric=range(1, 1 + len(found)))


def _every_number(result: Result, found: Headline) -> Iterator[str]:
    from .page import heading, paragraph, table

    columns = ("quantity", "of", "value", "unit", "estimated error")
    yield table(columns, headline_rows(found), numeric=(2, 4))
    yield from (paragraph(f"Note: {one}") for one in messages(result, found) if is_note(one))
    if waits := [one.sentence(float(result.time[-1])) for one in quiet(result)]:
        yield heading("After the prescribed motion")
        yield from (paragraph(f"{sentence}.") for sentence in waits)


def _events(result: Result) -> Iterator[str]:
    from .page import paragraph, table

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


def _live(result: Result, found: Headline, model: LiveModel, count: int) -> Iterator[str]:
    """Sliders and verdict of a run in the page, then what shows it, and its numbers."""
    from .animation import frames
    from .live import part
    from .page import heading
    from .scene3d.content import content
    from .scene3d.fragment import plots, scripts, space

    page_content = content([result], "A", [_file(result)], stresses=False)
    data = part.data(result, found, model, page_content.data)
    yield heading("Run in this page")
    yield part.elements(model)
    if page_content.has_bodies:
        yield heading("Deployment")
        yield space(frames(result, count), page_content)
    yield heading("Main numbers")
    yield part.numbers()
    yield heading("Over time")
    yield plots()
    yield data
    yield scripts(page_content, part.script())


def _figures(result: Result) -> Iterator[str]:
    from ..plots import draw_all
    from .page import picture

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
    from .page import folded, table, text_block

    known = dict(result.provenance)
    digests = {name: known.pop(name) for name in list(known) if name.startswith(_DIGEST)}
    bodies = [(words, _names(known.get(fidelity, "[]"))) for fidelity, words in _FIDELITIES.items()]
    versions = [
        (name, text)
        for name, text in known.items()
        if name not in _SCENE and not isinstance(json_of(text), list | dict)
    ]
    statistics = [(name.replace("_", " "), _short(value)) for name, value in result.statistics.items()]
    yield table(("property", "value"), [*bodies, *versions, *statistics])
    yield folded(
        "Scene with all layers merged", text_block(_toml(_scene_tree(result)) or known.get("scene", ""))
    )
    if digests:
        text = "\n".join(f"{name.removeprefix(_DIGEST)}  {digest}" for name, digest in digests.items())
        yield folded("SHA-256 of the FMUs", text_block(text))


def _short(value: Scalar) -> str:
    return f"{value:.6g}" if isinstance(value, float) else f"{value}"


def _names(text: str) -> str:
    names = json_of(text)
    return (", ".join(map(str, names)) if isinstance(names, list) else "") or "none"


def _scene_tree(result: Result) -> dict[str, object]:
    tree = json_of(result.provenance.get("scene_tree", "{}"))
    return tree if isinstance(tree, dict) else {}


def _toml(tree: dict[str, object]) -> str:
    """The scene as a file would have it; empty where there is none, or it is nothing that a file could hold."""
    try:
        return tomli_w.dumps(tree) if tree else ""
    except (RecursionError, TypeError, ValueError):
        return ""
