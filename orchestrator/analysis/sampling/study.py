"""What a study found: drawn values, headline numbers of every sample, chosen signals, and what follows from them."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import ceil, log, log1p
from pathlib import Path
from typing import Any, NamedTuple, Self

import h5py
import numpy as np
import scipy

from components.cache.disk import replace_file
from components.contract.component import Vector

from ...results.estimated_errors import PROMISED
from ...results.identifiers import quantity_identifier
from ...results.requirements import requirement_of
from ...results.result import HDF5_ERRORS, reason
from .distributions import StudyError
from .journal import Asked
from .plan import Plan, names
from .sample import Sample
from .varied import varied

_FORMAT = "fanfold study"
_CONFIDENCE = 0.95


class Share(NamedTuple):
    """Failures among samples, and what they say of the failure probability at 95 % confidence (Clopper and Pearson).

    low, high: the two-sided interval; below: the one-sided upper bound.
    """

    share: float
    low: float
    high: float
    below: float
    samples: int
    among: int

    @classmethod
    def of(cls, samples: int, among: int) -> Self:
        """From failures among so many samples, at least one, drawn at random."""
        both = scipy.stats.binomtest(samples, among).proportion_ci(_CONFIDENCE)
        upper = scipy.stats.binomtest(samples, among, alternative="less").proportion_ci(_CONFIDENCE)
        return cls(samples / among, float(both.low), float(both.high), float(upper.high), samples, among)


def runs_for(bound: float) -> int:
    """Fewest runs that without a failure show a failure probability below a bound at 95 % confidence.

    Exact for the binomial distribution: (1 - bound)^runs <= 5 %.
    """
    return ceil(log(1.0 - _CONFIDENCE) / log1p(-bound))


@dataclass(frozen=True)
class Study:
    """Finished samples in rows; a sample that failed, or has no such number, has NaN.

    asked: what the study was asked for. finished: of every sample, whether its run came to its end; messages: why not,
    empty where it did or where it has not run. parameters (samples,): drawn values by name. numbers, errors (samples,):
    headline numbers and their estimated errors, units, by identifier such as `latch_time.HL1`. opened (samples,): 1, 0
    or NaN of every line with a latch or an end stop. signals (samples, T) at times (T,), s.
    """

    asked: Asked
    finished: Vector
    messages: tuple[str, ...]
    parameters: Mapping[str, Vector]
    numbers: Mapping[str, Vector]
    errors: Mapping[str, Vector]
    units: Mapping[str, str]
    opened: Mapping[str, Vector]
    times: Vector
    signals: Mapping[str, Vector] = field(default_factory=dict)
    path: Path | None = None

    @classmethod
    def of(cls, asked: Asked, samples: Iterable[Sample]) -> Self:
        """From what samples left."""
        plan = plan_of(asked)
        drawn = plan.samples()
        count, found = len(drawn), list(samples)
        finished, messages = np.zeros(count, dtype=bool), [""] * count
        numbers, errors, kept, signals = _Columns(count), _Columns(count), _Columns(count), _Columns(count)
        units: dict[str, str] = {
            one.name: one.distribution.unit or ("1" if one.factor else "") for one in plan.varied
        }
        times = np.linspace(0.0, asked["until"], asked["points"])
        for one in found:
            finished[one.index], messages[one.index] = not one.message, one.message
            for name, (value, unit, error) in one.numbers.items():
                numbers.put(name, one.index, value)
                units[name] = unit
                if error is not None:
                    errors.put(name, one.index, error)
            for name, opened in one.opened.items():
                kept.put(name, one.index, opened)
            for name, (values, unit) in one.signals.items():
                signals.put(name, one.index, values)
                units[name] = unit
        parameters = dict(zip(names(plan.varied), drawn.T, strict=True))
        tables = (parameters, numbers, errors, units, kept)
        return cls(asked, finished, tuple(messages), *tables, times, signals)

    @property
    def scene(self) -> str:
        """Name of the scene."""
        return str(self.asked["tree"]["scene"]["name"])

    @property
    def plan(self) -> Plan:
        """How its values were chosen."""
        return plan_of(self.asked)

    @property
    def complete(self) -> bool:
        """Whether every sample has run, to its end or not."""
        return all(done or message for done, message in zip(self.finished, self.messages, strict=True))

    @property
    def failed(self) -> dict[int, str]:
        """Samples whose runs failed, counted from 0, and why."""
        return {k: message for k, message in enumerate(self.messages) if message}

    def quantiles(self, number: str, probabilities: Sequence[float] = (0.05, 0.5, 0.95)) -> Vector:
        """Quantiles of a headline number over the samples that have it; StudyError where there is no such number."""
        values = self.numbers.get(number)
        if values is None:
            raise StudyError(f"there is no number {number!r}; numbers are {', '.join(self.numbers)}")
        return np.quantile(values[np.isfinite(values)], probabilities)

    def extremes(self, number: str) -> tuple[int, int]:
        """The samples, counted from 0, with the lowest and the highest value of a headline number that some have."""
        values = self.numbers[number]
        return int(np.nanargmin(values)), int(np.nanargmax(values))

    @property
    def main_numbers(self) -> list[str]:
        """The main headline numbers: those with promised accuracy, rates at latch-up, margins of requirements."""
        main = {quantity_identifier(quantity) for quantity in (*PROMISED, "latch rate")}
        return [name for name in self.numbers if requirement_of(name) or name.partition(".")[0] in main]

    def requirements_met(self) -> dict[str, Share]:
        """By requirement, in how many finished samples it is not met; see `not_opening` for the bounds."""
        finished = self.finished[: self.plan.independent] > 0
        margins = {
            requirement: values
            for name, values in self.numbers.items()
            if (requirement := requirement_of(name))
        }
        return {
            name: Share.of(
                int((~(values[: self.plan.independent][finished] > 0.0)).sum()), int(finished.sum())
            )
            for name, values in margins.items()
        }

    def not_opening(self) -> dict[str, Share]:
        """By line with a latch or an end stop, in how many samples it has not latched or come to its stop.

        Bounds hold for samples drawn at random; of "sobol-indices" the first 2 N are, and all others repeat their
        values.
        """
        columns = {line: values[: self.plan.independent] for line, values in self.opened.items()}
        known = {line: values[np.isfinite(values)] for line, values in columns.items()}
        return {
            line: Share.of(int((values == 0.0).sum()), len(values))
            for line, values in known.items()
            if values.size
        }

    def wing_not_opening(self) -> Share | None:
        """In how many finished samples a line has not opened, whichever; None where no line has a latch or a stop."""
        lines = np.array([values[: self.plan.independent] for values in self.opened.values()])
        lines = lines[:, np.isfinite(lines).any(axis=0)] if lines.size else lines
        return Share.of(int((lines == 0.0).any(axis=0).sum()), lines.shape[1]) if lines.size else None

    def to_dataframe(self) -> Any:  # noqa: ANN401 - pandas may be absent
        """Samples as a table (pandas.DataFrame): drawn values, numbers, opened lines, messages."""
        try:
            import pandas as pd
        except ImportError:
            raise StudyError(
                "a data frame needs pandas, which is not installed: pip install pandas"
            ) from None
        opened = {f"{line} opened": values for line, values in self.opened.items()}
        columns = {**self.parameters, **self.numbers, **opened, "message": list(self.messages)}
        return pd.DataFrame(columns, index=pd.RangeIndex(len(self.messages), name="sample"))

    def save_csv(self, path: str | Path) -> Path:
        """Write drawn values and numbers into a table of text, one sample a row; the path."""
        path = Path(path)
        columns = {**self.parameters, **self.numbers}
        heads = [f"{name}, {unit}" if (unit := self.units.get(name)) else name for name in columns]
        with path.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(["sample", *heads, *(f"{line} opened" for line in self.opened), "message"])
            for k, message in enumerate(self.messages):
                values = [_cell(column[k]) for column in columns.values()]
                opened = [_cell(column[k]) for column in self.opened.values()]
                writer.writerow([k, *values, *opened, message])
        return path

    def save(self, path: str | Path) -> Path:
        """Write everything into an HDF5 file, which takes its name when it is whole; the path."""
        path = Path(path)
        with h5py.File(path.name, "w", driver="core", backing_store=False) as file:
            file.attrs.update(format=_FORMAT, asked=json.dumps(self.asked))
            file["finished"], file["times"] = self.finished, self.times
            file.create_dataset("messages", data=list(self.messages), dtype=h5py.string_dtype("utf-8"))
            for table in _TABLES:
                group = file.create_group(table, track_order=True)
                for name, values in getattr(self, table).items():
                    # a slash would be a folder of the file
                    column = group.create_dataset(name.replace("/", "\\"), data=values)
                    column.attrs["unit"] = self.units.get(name, "")
            file.flush()
            replace_file(path, file.id.get_file_image())
        return path

    @classmethod
    def open(cls, path: str | Path) -> Self:
        """Read from its HDF5 file; StudyError where that is none."""
        path = Path(path)
        units: dict[str, str] = {}
        try:
            with h5py.File(path) as file:
                if file.attrs.get("format") != _FORMAT:
                    raise StudyError(f"{path}: this is not the file of a study")
                tables: dict[str, dict[str, Vector]] = {table: {} for table in _TABLES}
                for table, group in ((table, file[table]) for table in _TABLES):
                    for entry, column in group.items():
                        name = entry.replace("\\", "/")
                        tables[table][name] = column[()]
                        units[name] = str(column.attrs["unit"])
                messages = tuple(text.decode() for text in file["messages"][()])
                asked = json.loads(file.attrs["asked"])
                finished, times = file["finished"][()], file["times"][()]
        except HDF5_ERRORS as error:
            raise StudyError(f"{path}: this study cannot be read ({reason(error)})") from None
        parameters, numbers, errors, opened, signals = tables.values()
        return cls(
            asked, finished, messages, parameters, numbers, errors, units, opened, times, signals, path
        )

    def __repr__(self) -> str:
        runs = f"{int(self.finished.sum())} of {len(self.finished)} runs"
        return f"<Study of {self.scene}: {runs}, {', '.join(self.parameters)}>"


class _Columns(dict[str, Vector]):
    """Columns of so many rows by name, NaN where nothing was put."""

    def __init__(self, count: int) -> None:
        super().__init__()
        self._count = count

    def put(self, name: str, row: int, value: float | Sequence[float]) -> None:
        """Into a row of a column, which is made where there is none."""
        if name not in self:
            self[name] = np.full((self._count, *np.shape(value)), np.nan)
        self[name][row] = value


_TABLES = ("parameters", "numbers", "errors", "opened", "signals")


def plan_of(asked: Asked) -> Plan:
    """The plan that a study was asked for."""
    chosen = tuple(varied(text) for text in asked["varied"])
    return Plan(chosen, asked["method"], asked["runs"], asked["levels"], asked["seed"])


def _cell(value: float) -> str:
    """Of a table: as many digits as it takes, empty for NaN."""
    return "" if np.isnan(value) else repr(float(value))
