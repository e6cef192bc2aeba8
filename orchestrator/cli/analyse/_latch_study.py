"""What the commands of studies have in common: options, pictures, what is told of latch-up in all their runs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import click
from rich.console import Console
from rich.table import Table

from ...analysis.studies import Case, as_dict, latch_rows, refuse_unlatched
from ...assembly import Assembly
from ...cosim.master import Settings
from ...run.run import run
from ...views.studies import draw_changes, draw_latch_torques
from ..options import Command
from ..progress import progress
from ..tables import plain_table
from ..types import Number

_NUMBER = 7


@dataclass(frozen=True, slots=True)
class LatchStudy:
    """Finished runs of a scene with one thing changed; RunError where no line latched in the last, the reference."""

    scene: str
    folder: Path
    cases: Sequence[Case]
    beside: Sequence[Case] = ()
    """runs without a value of what was changed, told of first"""

    def __post_init__(self) -> None:
        refuse_unlatched(self.reference)

    @property
    def reference(self) -> Case:
        """What all others are set against."""
        return self.cases[-1]

    @property
    def shown(self) -> list[Case]:
        """All runs, in the order in which they are told of."""
        return [*self.beside, *self.cases]

    def draw(self, title: str, against: str, changed: str, ringing: float) -> None:
        """Pictures of the latch torques, for a time (s) after latch-up, and of their changes over what was changed.

        against: what the reference is called. changed: label of the axis, with its unit.
        """
        draw_latch_torques(self.folder / "latch_torques.png", title, self.shown, ringing)
        path = self.folder / "changes.png"
        draw_changes(path, f"Against {against}", changed, self.cases, self.reference, log=True)

    def as_dict(self) -> list[dict[str, object]]:
        """For JSON."""
        return as_dict(self.shown, self.reference)

    def print(self, console: Console, against: str, further: Iterable[Table] = ()) -> None:
        """The table of latch-ups, further tables, and where everything is."""
        console.print(latch_table(f"{self.scene}: against {against}", self.shown, self.reference))
        for table in further:
            console.print(table)
        console.print(f"pictures and results in {self.folder}")


def study_options(study: str, runs: str) -> Callable[[Command], Command]:
    """The last options of a study; runs: those that take the tolerance."""

    def with_options(command: Command) -> Command:
        text = "One JSON object on standard output."
        command = click.option("--json", "as_json", is_flag=True, help=text)(command)
        command = click.option(
            "--output", type=click.Path(path_type=Path, file_okay=False),
            help=f"Folder for results and pictures; by default SCENE.{study}.",
        )(command)  # fmt: skip
        return click.option(
            "--tolerance", type=Number(min=1e-10, max=0.1),
            help=f"Relative accuracy of the {runs}; by default that of the scene.",
        )(command)  # fmt: skip

    return with_options


def run_case(
    label: str, value: float, assembly: Assembly, path: Path, settings: Settings, until: float
) -> Case:
    """Run an assembly with a progress bar; RunError where it does not finish."""
    with progress(f"{assembly.name}, {label}", until) as watch:
        return Case(label, value, run(assembly, path, settings, until, watch=watch))


def latch_table(title: str, cases: Sequence[Case], reference: Case) -> Table:
    """Latch times and latch torque peaks of every case, with their differences from the reference."""
    table = plain_table(title)
    table.add_column("case")
    for heading in (
        "line",
        "latch-up, s",
        "change, s",
        "peak, N.m",
        "change, %",
        "steps",
    ):
        table.add_column(heading, justify="right", min_width=_NUMBER)
    for case in cases:
        first = True
        for line, time, shift, peak, change in latch_rows(case, reference):
            steps = str(case.outcome.costs.steps) if first else ""
            name = case.label if first else ""
            table.add_row(name, line, f"{time:.6f}", f"{shift:+.2e}", f"{peak:.5g}", f"{change:+.3f}", steps)
            first = False
    return table
