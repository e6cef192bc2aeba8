"""A result for users: signals with unit and time, latch times, figures, tables, files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from ..messages import is_note
from ..results import key_figures
from ..results.key_figures import Headline
from ..results.parts import Scalar
from ..results.result import Result as Record
from ..results.result import ResultError
from ..results.result_file import save
from ..results.signal import Instant, Side, Signal, instant
from ..run.progress import Progress
from ..run.run import RunError
from ..run.simulation import Simulation
from ..run.verify import Verified
from ..scene.builder import Names, listed
from ..validity.travel import messages
from .progress import chosen, in_notebook
from .quantities import Quantity, in_si
from .report_page import Page, page_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False, eq=False)
class Result(Record):
    """Result of a run, in memory or in a file; `simulate` returns one, `Result.open` reads one.

    ``result["hl1_hinge", "latch_torque"]`` is a signal: an array with `unit` and `time`.

    Attributes
    ----------
    time : array (N,)
        times of all rows, s; events have a row before and one after
    events : list
        time (s), component and text of every event
    components : tuple of str
        components with signals; `variables(component)` lists their signals
    statistics, provenance : mapping
        cost of the run; settings and versions
    complete : bool
        False if the run was interrupted
    """

    simulation: Simulation | None = field(default=None, kw_only=True)
    """what it takes to repeat the run; None where the result was read from a file"""

    @classmethod
    def of(cls, record: Record, simulation: Simulation | None = None) -> Self:
        """The same result with the methods of this class."""
        return cls(*(getattr(record, one.name) for one in fields(Record)), simulation=simulation)

    def __getitem__(self, key: tuple[str, str]) -> Signal:
        if not isinstance(key, tuple) or len(key) != 2:
            raise ResultError(f"{self.name}: {key!r} is no signal; give its component and its variable")
        component, variable = key
        values = self.signal(component, variable)
        unit, description = self.unit(component, variable), self.description(component, variable)
        return Signal(values, self.time, unit, f"{component}.{variable}", description, tuple(self.events))

    def latch_torque(self, line: str) -> Signal:
        """Latch torque (N.m) of a hinge line, summed over its hinges; ResultError if there is no such line."""
        lines = {one.name: one for one in self.hinge_lines}
        if line not in lines:
            raise ResultError(
                f"{self.name}: there is no hinge line {line!r}; lines are {', '.join(lines) or 'none'}"
            )
        torque = key_figures.line_latch_torque(self, lines[line])
        text = "Latch torque, sum over the hinges of the line"
        return Signal(torque, self.time, "N.m", f"{line}.latch_torque", text, tuple(self.events))

    def at(self, time: Quantity, side: Side = "after") -> Instant:
        """All signals at one time, such as ``result.at(7.5)["panel", "frame_position"]``.

        Values are interpolated linearly between rows; flags keep the value of the row before. ResultError outside the
        run.

        Parameters
        ----------
        time : float or str
            time, s
        side : {"after", "before"}
            side of an event: its rows have the same time, or times within 2e-7 s
        """
        return instant(self, in_si(time, "s", "the time"), side)

    @cached_property
    def headline(self) -> Headline:
        """Headline numbers: latch times, peaks, energies, with estimated errors."""
        return key_figures.headline(self) if self.simulation is None else self.simulation.outcome.headline

    @property
    def latch_times(self) -> dict[str, float]:
        """Latch time (s) of every hinge line that latched."""
        return key_figures.latch_times(self)

    @property
    def costs(self) -> dict[str, Scalar]:
        """Steps, iterations, wall time (s) and further costs of the run, by the names of `statistics`."""
        return dict(self.statistics)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Problems that an engineer should act on, each with its code, such as `[W-motor-short]`."""
        return tuple(one for one in self._messages if not is_note(one))

    @property
    def notes(self) -> tuple[str, ...]:
        """Facts of the run, such as a repetition, each with its code."""
        return tuple(one for one in self._messages if is_note(one))

    @property
    def _messages(self) -> tuple[str, ...]:
        return messages(self, self.headline)

    def verify(self, progress: bool | Progress | None = None) -> list[Verified]:
        """Repeat the run with steps halved and quartered: extrapolated value, error and order of every headline number.

        Only a result that `simulate` returned. If it has a file, the further results are written next to it, as
        NAME.halved.h5 and NAME.quartered.h5.
        """
        if self.simulation is None:
            raise RunError(f"{self.name}: only the result of a run of this session can be verified")
        return self.simulation.verify(chosen(progress))

    def save(self, path: str | Path) -> Result:
        """Write the result to a file (HDF5), replacing an earlier result, and return it as read from there."""
        return type(self).of(save(self, path), self.simulation)

    def plot(self, name: str) -> Figure:
        """Figure (Matplotlib) by name, such as "deployment_angles", "latch_torques", "shapes".

        A notebook shows it; ``figure.savefig("torques.png")`` writes it. ResultError lists the available names.
        """
        from ..views.plots import draw_one

        if in_notebook():
            import matplotlib.pyplot  # noqa: F401 - makes notebooks show figures
        return draw_one(self, name).figure

    def plot_all(
        self, folder: str | Path, format: str = "png", watch: Callable[[str], None] | None = None
    ) -> list[Path]:
        """Write all available figures into a folder; returns their paths.

        watch: called with the name of each figure before it is written.
        """
        from ..views.plots import plot_all

        return plot_all(self, folder, format, watch)

    def view(self, *, live: bool = False, slider: str | Sequence[str] = (), height: int = 900) -> Page:
        """The report as a notebook shows it.

        live, slider: see `report`. height: of the page in the notebook, pixels.
        """
        return Page(page_of(self, live=live, slider=slider), height)

    def to_dataframe(self, components: Names | None = None) -> Any:  # noqa: ANN401 - pandas may be absent
        """Signals as a table (pandas.DataFrame) over time: columns COMPONENT.VARIABLE, of vectors with [1], [2], ...

        components: one or several names; by default all. ResultError if pandas is not installed.
        """
        try:
            import pandas as pd
        except ImportError:
            raise ResultError(
                "a data frame needs pandas, which is not installed: pip install pandas"
            ) from None
        columns: dict[str, Any] = {}
        for component in self.components if components is None else listed(components):
            for variable in self.variables(component):
                values = self.signal(component, variable)
                name = f"{component}.{variable}"
                vector = {f"{name}[{k}]": column for k, column in enumerate(values.T, 1)}
                columns |= {name: values} if values.ndim == 1 else vector
        return pd.DataFrame(columns, index=pd.Index(self.time, name="time, s"))

    def __repr__(self) -> str:
        return f"<Result {self.name}: {self.headline.verdict}>"
