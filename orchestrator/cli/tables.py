"""Tables for the terminal: plain ones, and wide ones in as many parts as it takes."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import NamedTuple

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from ..results.key_figures import Headline, headline_rows
from ..results.short_table import (
    LINE_HEADINGS,
    REQUIREMENT_HEADINGS,
    line_rows,
    requirement_rows,
    short_rows,
)


def terminal() -> Console:
    """Where tables and sentences go; names are shown as they are, whatever a terminal or rich would take them for."""
    return Console(markup=False, emoji=False)


class Column(NamedTuple):
    """Heading, of several lines perhaps, and cells of a right-aligned column."""

    heading: str
    cells: Sequence[str]

    @property
    def width(self) -> int:
        """Characters of its longest line."""
        return max(map(len, (*self.heading.split("\n"), *self.cells)))


def table_of(
    title: str | None,
    headings: Sequence[str],
    rows: Iterable[Sequence[str]],
    left: Collection[str] = (),
    whole: Collection[str] = (),
) -> Table:
    """A table without vertical lines, which leaves the most room for numbers.

    Numbers are right-aligned and never cut off; texts, below the headings in `left`, are folded, but for those in
    `whole`.
    """
    table = Table(title=title, box=SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    cells = [*rows]
    for k, heading in enumerate(headings):
        if heading in left:
            table.add_column(heading, overflow="fold", no_wrap=heading in whole)
        else:
            longest = max(map(len, (*heading.split(), *(row[k] for row in cells))), default=0)
            table.add_column(heading, justify="right", min_width=longest)
    for row in cells:
        table.add_row(*row)
    return table


def tables_that_fit(
    title: str, fixed: Sequence[Column], columns: Sequence[Column], width: int
) -> Iterator[Table]:
    """Tables of at most so many characters, each with the fixed columns in front and at least one more."""
    part: list[Column] = []
    for column in columns:
        if part and 1 + sum(2 + one.width for one in (*fixed, *part, column)) > width:
            yield _of_columns(title, [*fixed, *part])
            part = []
        part.append(column)
    yield _of_columns(title, [*fixed, *part])


def _of_columns(title: str, columns: Sequence[Column]) -> Table:
    rows = zip(*(column.cells for column in columns), strict=True)
    return table_of(title, [column.heading for column in columns], rows)


def headline_tables(found: Headline, *, every: bool) -> Iterator[Table]:
    """The headline numbers as tables for a terminal: every one, or a row for each line and those read first."""
    title = None if found.complete else "The run was interrupted; numbers up to there"
    if rows := requirement_rows(found):
        yield table_of(None, REQUIREMENT_HEADINGS, rows, ("requirement", "state"))
    if every:
        yield _whole_table(title, found)
        return
    if lines := line_rows(found):
        columns = zip(LINE_HEADINGS, *lines, strict=True)
        # a column for impulses only where there are locks
        shown = [column for column in columns if not {*column[1:]} <= {"-"} or column[0] == "line"]
        yield table_of(
            title,
            [heading for heading, *_ in shown],
            zip(*(cells for _, *cells in shown), strict=True),
            ("line",),
        )
        title = None
    table = table_of(
        title, ("quantity", "value", "unit", "of"), short_rows(found), ("quantity", "value", "unit", "of")
    )
    table.show_header = False
    yield table


def _whole_table(title: str | None, found: Headline) -> Table:
    headings = ["quantity", "of", "value", "unit", *["estimated error"] * bool(found.estimated_errors)]
    rows = []
    previous = ""
    for quantity, *cells in headline_rows(found):
        rows.append(["" if quantity == previous else quantity, *cells[: len(headings) - 1]])
        previous = quantity
    return table_of(title, headings, rows, ("quantity", "of", "unit"))
