"""Tables that people wrote, such as data sheets and scene files: values in SI units, problems as sentences.

How a value is written is the reader's business, not the table's: a data sheet states a unit and a source, a scene
file has texts such as "0.3 mm".
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from copy import deepcopy
from math import isfinite, nan
from re import fullmatch
from typing import Any, Literal

from ..contract.component import ComponentError
from ..contract.errors import unknown

Sign = Literal["any", "zero or positive", "positive"]
Convert = Callable[[object, str, Sign], float]
"""A value as it is written, its SI unit and sign -> the value; ValueError with a sentence if it is none."""
Tree = dict[str, Any]


class TableError(ComponentError):
    """Everything that is wrong with a table, one sentence a problem, each with its key."""

    def __init__(self, problems: Sequence[str]) -> None:
        super().__init__("\n".join(problems))
        self.problems = tuple(problems)


def stated(value: object, unit: str, sign: Sign) -> float:
    """A value of a data sheet, number and unit, whose unit must be the SI unit that is meant."""
    if not isinstance(value, tuple):
        raise ValueError(f'is {value!r}; state it as {{ value = ..., unit = "{unit}", source = "..." }}')
    number, given = value
    if given != unit:
        raise ValueError(f"is {number!r} {given}; the unit must be {unit}")
    if isinstance(number, bool) or not isinstance(number, int | float) or not isfinite(number):
        raise ValueError(f"is {number!r}; it must be a finite number")
    if (sign == "positive" and number <= 0.0) or (sign == "zero or positive" and number < 0.0):
        raise ValueError(f"is {number!r}; it must be {sign}")
    return float(number)


class Table:
    """A table and what it should hold: what is asked for is known, everything else is a problem.

    Where a value has a problem, NaN or nothing takes its place, so that all problems are found at once.
    """

    def __init__(self, raw: Mapping[str, Any], key: str, convert: Convert, problems: list[str]) -> None:
        self._raw, self._key, self._convert, self._problems = raw, key, convert, problems
        self._known: list[str] = []

    def __contains__(self, key: str) -> bool:
        self._known.append(key)
        return self._raw.get(key) is not None

    def note(self, key: str, sentence: str) -> None:
        """Add a problem of a key of this table."""
        self._problems.append(f"{self._key}{key}: {sentence}")

    def _given(self, key: str, required: bool = True) -> Any:  # noqa: ANN401 - whatever was written
        """What was written, None where nothing was."""
        if key not in self and required:
            self.note(key, "is missing")
        return self._raw.get(key)

    def number(self, key: str, unit: str, sign: Sign = "positive", default: float | None = None) -> float:
        """A value in an SI unit; without a default it must be there."""
        given = self._given(key, default is None)
        if given is None:
            return nan if default is None else default
        return self._converted(key, given, unit, sign)

    def numbers(self, key: str, unit: str, count: int, sign: Sign = "any") -> tuple[float, ...]:
        """As many values in an SI unit."""
        given = self._given(key)
        nothing = (nan,) * count
        if given is None:
            return nothing
        if not isinstance(given, list) or len(given) != count:
            self.note(key, f"is {given!r}; give a list of {count} values in {unit}")
            return nothing
        return tuple(self._converted(key, entry, unit, sign) for entry in given)

    def _converted(self, key: str, value: object, unit: str, sign: Sign) -> float:
        try:
            return self._convert(value, unit, sign)
        except ValueError as error:
            self.note(key, str(error))
            return nan

    def count(self, key: str, default: int) -> int:
        """A whole number from 1 on."""
        given = self._raw.get(key, default) if key in self else default
        if isinstance(given, bool) or not isinstance(given, int) or given < 1:
            self.note(key, f"is {given!r}; it must be a whole number from 1 on")
            return 1
        return given

    def flag(self, key: str, default: bool) -> bool:
        """True or false."""
        given = self._raw.get(key, default) if key in self else default
        if not isinstance(given, bool):
            self.note(key, f"is {given!r}; it must be true or false")
        return given is True

    def text(self, key: str, choices: Collection[str] = (), default: str | None = None) -> str:
        """A name, one of the choices where there are any."""
        given = self._given(key, default is None)
        if given is None or given == default:
            return default or ""
        if not isinstance(given, str) or not fullmatch(r"[A-Za-z]\w*", given):
            self.note(key, f"is {given!r}; a name starts with a letter and has only letters, digits and _")
            return ""
        if choices and given not in choices:
            self.note(key, f"is {given!r}; it must be one of {', '.join(choices)}")
        return given

    def texts(self, key: str, fewest: int, known: Collection[str]) -> tuple[str, ...]:
        """Some of the known names, none twice."""
        given = self._given(key, fewest > 0) or []
        if not isinstance(given, list) or not all(isinstance(entry, str) for entry in given):
            self.note(key, f"is {given!r}; it must be a list of names")
            return ()
        for name in given:
            if name not in known:
                self.note(key, f"there is no {name!r}; those are {', '.join(known) or 'none'}")
        if len(given) < fewest or len({*given}) < len(given):
            self.note(key, f"is {given!r}; give {fewest} names or more, none twice")
        return tuple(given)

    def table(self, key: str, required: bool = True) -> Table | None:
        """A table within this one, None where there is none."""
        given = self._given(key, required)
        if given is None:
            return None
        if not isinstance(given, Mapping):
            self.note(key, f"is {given!r}; it must be a table")
            return None
        return Table(given, f"{self._key}{key}.", self._convert, self._problems)

    def entries(self, key: str) -> Iterator[Table]:
        """The entries of an array of tables."""
        given = self._given(key, required=False) or []
        if not isinstance(given, list) or not all(isinstance(entry, Mapping) for entry in given):
            self.note(key, f"is {given!r}; it must be an array of tables, [{...}, {...}]")
            return
        for k, entry in enumerate(given):
            name = entry.get("name")
            place = f"{self._key}{key}.{name}." if isinstance(name, str) else f"{self._key}{key}[{k + 1}]."
            yield Table(entry, place, self._convert, self._problems)

    def places(self, key: str, count: int) -> dict[str, tuple[float, ...]]:
        """Positions (m) by name."""
        table = self.table(key, required=False)
        return (
            {} if table is None else {str(name): table.numbers(str(name), "m", count) for name in table._raw}
        )

    def distances(self, key: str) -> dict[str, float]:
        """Lengths (m), zero or positive, by name."""
        table = self.table(key, required=False)
        names = () if table is None else tuple(map(str, table._raw))
        return {} if table is None else {name: table.number(name, "m", "zero or positive") for name in names}

    def positions(self, key: str) -> list[tuple[float, ...]]:
        """A list of positions (3,), m."""
        given = self._given(key)
        if not isinstance(given, list) or not all(isinstance(one, list) and len(one) == 3 for one in given):
            self.note(key, f"is {given!r}; give a list of positions, three values in m each")
            return []
        return [tuple(self._converted(key, value, "m", "any") for value in one) for one in given]

    def line(self, key: str) -> str:
        """A text of any characters, empty where there is none."""
        given = self._given(key, required=False)
        if given is not None and not isinstance(given, str):
            self.note(key, f"is {given!r}; it must be a text")
            return ""
        return given or ""

    def whole_numbers(self, key: str) -> tuple[int, ...]:
        """Whole numbers from 1 on, none twice."""
        given = self._given(key)
        if not isinstance(given, list) or not given or not all(map(_is_number, given)):
            self.note(key, f"is {given!r}; it must be a list of whole numbers from 1 on")
            return ()
        if len({*given}) < len(given):
            self.note(key, f"is {given!r}; give none twice")
        return tuple(given)

    def numbers_of_names(self, key: str) -> dict[str, int]:
        """Whole numbers from 1 on by name."""
        table = self.table(key, required=False)
        found = {}
        for name, value in ({} if table is None else table._raw).items():
            if not _is_number(value):
                self.note(f"{key}.{name}", f"is {value!r}; it must be a whole number from 1 on")
            elif not fullmatch(r"[A-Za-z]\w*", name):
                self.note(f"{key}.{name}", "a name starts with a letter and has only letters, digits and _")
            else:
                found[str(name)] = int(value)
        return found

    def one_of(self, *keys: str) -> str:
        """Which of some keys is given; a problem where it is not exactly one."""
        given = [key for key in keys if key in self]
        if len(given) != 1:
            told = " and ".join(given) if given else "none"
            self._problems.append(
                f"{self._key.removesuffix('.')}: give one of {', '.join(keys)}; it has {told}"
            )
        return given[0] if given else ""

    def close(self) -> None:
        """Note every key that was not asked for, with those that were."""
        for key in self._raw:
            if key not in self._known:
                self.note(str(key), unknown(str(key), sorted({*self._known})))


def _is_number(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 1


def laid_over(below: Tree, above: Mapping[str, Any]) -> Tree:
    """A new tree of one table over another: tables merge key by key, arrays of named tables add those of new names.

    Everything else replaces what was there.
    """
    tree = deepcopy(below)
    for key, value in above.items():
        old = tree.get(key)
        if isinstance(old, dict) and isinstance(value, Mapping):
            tree[key] = laid_over(old, value)
        elif (named := _by_name(old)) and (over := _by_name(value)):
            merged = {name: laid_over(named.get(name, {}), entry) for name, entry in over.items()}
            tree[key] = list((named | merged).values())
        else:
            tree[key] = deepcopy(value)
    return tree


def _by_name(value: object) -> dict[str, Tree]:
    """The entries of an array of named tables; empty where it is none."""
    if not isinstance(value, list) or not all(isinstance(one, Mapping) and "name" in one for one in value):
        return {}
    return {entry["name"]: entry for entry in value}
