"""Tables for the terminal: plain ones, and wide ones in as many parts as it takes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from ..results.key_figures import Headline, headline_rows
from ..results.short_table import LINE_HEADINGS, line_rows, short_rows


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


def plain_table(title: str | None) -> Table:
    """A table without vertical lines, which leaves the most room for numbers."""
    return Table(title=title, box=SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)


def tables_that_fit(
    title: str, fixed: Sequence[Column], columns: Sequence[Column], width: int
) -> Iterator[Table]:
    """Tables of at most so many characters, each with the fixed columns in front and at least one more."""
    part: list[Column] = []
    for column in columns:
        if part and 1 + sum(2 + one.width for one in (*fixed, *part, column)) > width:
            yield _table(title, [*fixed, *part])
            part = []
        part.append(column)
    yield _table(title, [*fixed, *part])


def _table(title: str, columns: Sequence[Column]) -> Table:
    table = plain_table(title)
    for column in columns:
        table.add_column(column.heading, justify="right", no_wrap=True)
    for row in zip(*(column.cells for column in columns), strict=True):
        table.add_row(*row)
    return table


def headline_tables(found: Headline, *, every: bool) -> Iterator[Table]:
    """The headline numbers as tables for a terminal: every one, or a row for each line and those read first."""
    title = None if found.complete else "The run was interrupted; numbers up to there"
    if every:
        yield _whole_table(title, found)
        return
    if lines := line_rows(found):
        columns = zip(LINE_HEADINGS, *lines, strict=True)
        # a column for impulses only where there are locks
        named, *others = (column for column in columns if not {*column[1:]} <= {"-"} or column[0] == "line")
        table = plain_table(title)
        table.add_column(named[0], no_wrap=True)
        for heading, *_ in others:
            table.add_column(heading, justify="right")
        for row in zip(named[1:], *(cells for _, *cells in others), strict=True):
            table.add_row(*row)
        yield table
        title = None
    table = plain_table(title)
    table.show_header = False
    for heading in ("quantity", "value", "unit", "of"):
        table.add_column(heading, no_wrap=heading != "of")
    for row in short_rows(found):
        table.add_row(*row)
    yield table


def _whole_table(title: str | None, found: Headline) -> Table:
    table = plain_table(title)
    table.add_column("quantity")
    table.add_column("of")
    table.add_column("value", justify="right", min_width=7)
    table.add_column("unit")
    if found.estimated_errors:
        table.add_column("estimated error", justify="right")
    previous = ""
    for quantity, *cells in headline_rows(found):
        table.add_row("" if quantity == previous else quantity, *cells[: len(table.columns) - 1])
        previous = quantity
    return table
