"""A scene before its run as one HTML file: a view that opens it without any force, hinge lines, warnings."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime
from importlib.metadata import version
from math import degrees

from ...analysis.scene_check import LineOverview, SceneCheck
from .page import heading, page, paragraph, table, title_block
from .scene3d.content import content
from .scene3d.fragment import plots, scripts, space


def scene_page(found: SceneCheck) -> str:
    """The page of a scene without problems."""
    return page(f"{found.scene}: check", _parts(found))


def _parts(found: SceneCheck) -> Iterator[str]:
    description = found.placed.header.description if found.placed is not None else ""
    facts = {"checked": datetime.now(UTC).date().isoformat(), "Fanfold": version("fanfold")}
    yield title_block(found.scene, f"{description}." if description else "", facts)
    count = len(found.warnings)
    words = f"{count} warning{'s' if count > 1 else ''}" if count else "no warning"
    yield paragraph(f"No problem found, {words}.", "verdict bad" if count else "verdict")
    yield from (paragraph(f"Warning: {sentence}", "warning") for sentence in found.warnings)
    if found.opening is not None:
        shown = content([found.opening], "A", [found.scene], found.placed, "%")
        if shown.has_bodies:
            yield heading("From the start to the deployed configuration")
            yield space([], shown)
            yield paragraph(
                "The slider turns every line by the same share of its way; no force acts. Red, green and blue are the "
                "x, y and z axes of the base and of every body.",
                "lead",
            )
        if shown.has_curves:
            yield heading("Angles over the way")
            yield plots()
        yield scripts(shown)
    if found.lines:
        yield heading("Hinge lines")
        columns = ("line", "inboard", "outboard", "start, deg", "deployed, deg", "latch", "hinges")
        yield table(columns, map(_row, found.lines), numeric=(3, 4))


def _row(line: LineOverview) -> tuple[str, ...]:
    angles = (f"{degrees(line.start):.6g}", "held" if line.held else f"{degrees(line.deployed):.6g}")
    return (line.name, line.inboard, line.outboard, *angles, line.latch, ", ".join(line.hinges))
