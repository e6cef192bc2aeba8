"""Tables for the terminal: plain ones, and wide ones in as many parts as it takes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from ...results.key_figures import Headline, headline_rows


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


def headline_table(found: Headline) -> Table:
    """The headline numbers as a table for a terminal."""
    table = plain_table(None if found.complete else "The run was interrupted; numbers up to there")
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
    if found.warnings:
        table.caption = "\n".join(f"Warning: {sentence}" for sentence in found.warnings)
    return table
