"""Units in FMI's syntax, such as "N.m.s/rad", and their definitions by FMI's base units."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from functools import cache

from lxml.etree import SubElement, _Element

from components import ComponentError

# Exponents of the FMI base units, with a factor where the unit is not coherent.
_BASE_NAMES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_SYMBOLS: dict[str, tuple[dict[str, int], float]] = {
    **{name: ({name: 1}, 1.0) for name in _BASE_NAMES},
    "1": ({}, 1.0),
    "Hz": ({"s": -1}, 1.0),
    "N": ({"kg": 1, "m": 1, "s": -2}, 1.0),
    "Pa": ({"kg": 1, "m": -1, "s": -2}, 1.0),
    "J": ({"kg": 1, "m": 2, "s": -2}, 1.0),
    "W": ({"kg": 1, "m": 2, "s": -3}, 1.0),
    "V": ({"kg": 1, "m": 2, "s": -3, "A": -1}, 1.0),
    "Wb": ({"kg": 1, "m": 2, "s": -2, "A": -1}, 1.0),
    "T": ({"kg": 1, "s": -2, "A": -1}, 1.0),
    "H": ({"kg": 1, "m": 2, "s": -2, "A": -2}, 1.0),
    "C": ({"A": 1, "s": 1}, 1.0),
    "Ohm": ({"kg": 1, "m": 2, "s": -3, "A": -2}, 1.0),
    "deg": ({"rad": 1}, math.pi / 180.0),
    "mm": ({"m": 1}, 1e-3),
    "min": ({"s": 1}, 60.0),
    "h": ({"s": 1}, 3600.0),
}
DISPLAYED = {"rad": "deg", "rad/s": "deg/s", "rad/s2": "deg/s2"}
"""Units that people read in others."""
_FACTOR = re.compile(r"([A-Za-z]+|1)(-?\d+)?")
_ROOT = re.compile(r"\(\d+/\d+\)(?=[./]|$)")


def add_units(root: _Element, units: Iterable[str]) -> None:
    """Add the definition of every unit."""
    definitions = SubElement(root, "UnitDefinitions")
    for unit in dict.fromkeys(units):
        element = SubElement(definitions, "Unit", {"name": unit})
        check_unit(unit)
        if has_root(unit):
            continue  # FMI has whole exponents only; a unit without base unit is not converted
        exponents, factor = base_unit(unit)
        attributes = {name: str(exponents[name]) for name in _BASE_NAMES if exponents.get(name)}
        if factor != 1.0:
            attributes["factor"] = repr(factor)
        SubElement(element, "BaseUnit", attributes)
        if unit in DISPLAYED:
            name, displayed = DISPLAYED[unit], 1.0 / base_unit("deg")[1]
            SubElement(element, "DisplayUnit", {"name": name, "factor": repr(displayed)})


def has_root(unit: str) -> bool:
    """Whether it has an exponent that is not whole, such as that of a modal coordinate, "kg(1/2).m"."""
    return _ROOT.search(unit) is not None


def check_unit(unit: str) -> None:
    """ComponentError where it is not made of what is known, whatever roots of it are taken."""
    base_unit(_ROOT.sub("", unit))


@cache
def base_unit(unit: str) -> tuple[dict[str, int], float]:
    """Exponents of the FMI base units and the factor of a unit such as "N.m.s/rad" or "J/(kg.K)"."""
    numerator, slash, denominator = unit.partition("/")
    if denominator.startswith("(") and denominator.endswith(")"):
        denominator = denominator[1:-1]
    elif "." in denominator:
        raise ComponentError(f"unit {unit!r}: put a denominator of several factors in parentheses")
    exponents: dict[str, int] = {}
    factor = 1.0
    for part, sign in ((numerator, 1), (denominator, -1)):
        for text in part.split(".") if part or sign == 1 or slash else ():
            match = _FACTOR.fullmatch(text)
            if match is None or match[1] not in _SYMBOLS:
                raise ComponentError(f"unit {unit!r}: {text!r} is not one of {', '.join(_SYMBOLS)}")
            power = sign * int(match[2] or 1)
            symbol_exponents, symbol_factor = _SYMBOLS[match[1]]
            factor *= symbol_factor**power
            for base, exponent in symbol_exponents.items():
                exponents[base] = exponents.get(base, 0) + power * exponent
    return exponents, factor
