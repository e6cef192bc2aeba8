"""Quantities in scene files: a plain number in SI units, or a string with a unit such as "90 deg".

A plain angle that is a whole number, or beyond a turn, is refused: it was meant in degrees, and as radians it would
turn a line many times.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import partial
from math import degrees, isfinite, pi
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from components.contract.frames import Vector3

QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+|nan|inf)(?:[eE][-+]?\d+)?)\s*(.*?)\s*")
"""A number as it is written in programs, and what follows it."""
_TURN = 2.0 * pi
LARGEST_TURN = 10.0 * _TURN
"""rad; ten turns, beyond what any hinge of an array, wound or not, is turned."""
LARGEST_RADIUS = 1.0
"""m; pins and pulleys are centimetres, so a larger one was meant in millimetres."""
LARGEST = 1e30
"""Of any quantity in its SI unit; none of an array is, and products of several stay numbers."""
Sign = Literal["any", "zero or positive", "positive"]

_TURNING = {"rad": 1.0, "deg": pi / 180.0, "mrad": 1e-3}
UNITS: Mapping[str, Mapping[str, float]] = {
    "1": {"1": 1.0, "%": 0.01},
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3},
    "rad": _TURNING,
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0},
    "Hz": {"Hz": 1.0, "kHz": 1e3},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3},
    "m/s2": {"m/s2": 1.0, "mm/s2": 1e-3},
    "rad/s": {f"{unit}/s": factor for unit, factor in _TURNING.items()} | {"rpm": pi / 30.0},
    "kg": {"kg": 1.0, "g": 1e-3, "t": 1e3},
    "kg.m2": {"kg.m2": 1.0},
    "kg.m": {"kg.m": 1.0},
    "kg/m": {"kg/m": 1.0, "g/m": 1e-3},
    "kg/m2": {"kg/m2": 1.0, "g/m2": 1e-3},
    "kg/m3": {"kg/m3": 1.0},
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9},
    "N.m2": {"N.m2": 1.0},
    "N": {"N": 1.0, "kN": 1e3},
    "N.m": {"N.m": 1.0, "N.mm": 1e-3, "kN.m": 1e3},
    "J": {"J": 1.0, "mJ": 1e-3, "kJ": 1e3},
    "N.m.s": {"N.m.s": 1.0, "N.mm.s": 1e-3},
    "N/m": {"N/m": 1.0, "N/mm": 1e3, "kN/m": 1e3},
    "N.s/m": {"N.s/m": 1.0, "N.s/mm": 1e3},
    "N.m/rad": {f"N.m/{unit}": 1.0 / factor for unit, factor in _TURNING.items()},
    "N.m.s/rad": {f"N.m.s/{unit}": 1.0 / factor for unit, factor in _TURNING.items()},
}
"""Factors to the SI unit by SI unit, in the unit syntax of `components.Quantity`."""


_ABOVE_ZERO: Mapping[str, float] = {"K": 0.0, "C": 273.15, "degC": 273.15}
"""K; zero of each scale of temperature."""


def to_si(value: object, unit: str, sign: Sign = "any", largest: float = LARGEST) -> float:
    """The value in the given SI unit; ValueError with a sentence if it is none, or has the wrong sign or size."""
    number, given = _parts(value, unit)
    try:
        if isinstance(value, bool):
            raise ValueError
        result = float(number) * (UNITS[unit][given] if given else 1.0)
    except ValueError:
        raise ValueError(f"is {value!r}; it must be a number of {unit} or a text like '1 {unit}'") from None
    if not isfinite(result):
        raise ValueError(f"is {value!r}; it must be finite")
    if (sign == "positive" and result <= 0.0) or (sign == "zero or positive" and result < 0.0):
        raise ValueError(f"is {value!r}; it must be {sign}")
    if abs(result) > largest:
        raise ValueError(f"is {value!r}; it must be at most {largest:.3g} {unit}, so check the unit")
    return result


def _parts(value: object, unit: str) -> tuple[str, str]:
    """Number and unit of a quantity; the unit is empty where none is needed and none is given."""
    if not isinstance(value, str):
        return str(value), ""
    found = QUANTITY.fullmatch(value)
    number, given = found.groups() if found else ("", value)
    if given not in UNITS[unit] and (given or unit != "1"):
        known = " or ".join(UNITS[unit])
        for meant in UNITS[unit]:
            if found and given == meant.replace(".", ""):
                raise ValueError(f"is {value!r}; write '{number} {meant}'")
        raise ValueError(f"is {value!r}; give a number, a space and the unit {known}")
    return number, given


def written(value: object, unit: str, sign: Sign = "any", largest: float = LARGEST) -> float:
    """The same of a value in a scene, where a plain angle that reads like degrees needs its unit."""
    if (
        unit == "rad"
        and isinstance(value, int | float)
        and not isinstance(value, bool)
        and _like_degrees(value)
    ):
        raise ValueError(f"is {value!r}; an angle needs its unit: '{value} deg' or '{value} rad'")
    return to_si(value, unit, sign, largest)


def _like_degrees(angle: float) -> bool:
    return angle != 0.0 and (float(angle).is_integer() or abs(angle) > _TURN)


def _vector(value: object, unit: str, sign: Sign, count: int) -> tuple[float, ...]:
    if not isinstance(value, list | tuple) or len(value) != count:
        raise ValueError(f"is {value!r}; it must be a list of {count} values in {unit}")
    return tuple(written(entry, unit, sign) for entry in value)


def schema_of(unit: str, sign: Sign = "any") -> dict[str, Any]:
    """JSON schema of a value as it is written, with its `unit` and `sign`."""
    return {"type": ["number", "string"], "unit": unit, "sign": sign}


def written_as(schema: dict[str, Any]) -> Any:  # noqa: ANN401 - a type made at run time
    """Type of what is written where a validator reads it, for JSON schemas alone."""
    return Annotated[Any, Field(json_schema_extra=schema)]


def kelvin(value: object) -> float:
    """A temperature in K, a plain number or a text such as "-30 C"; ValueError with a sentence if it is none."""
    found = None if isinstance(value, bool) else QUANTITY.fullmatch(str(value))
    if found is None or found[2] not in (_ABOVE_ZERO if isinstance(value, str) else ("",)):
        raise ValueError(f"is {value!r}; it must be a number of K or a text like '-30 C' or '243 K'")
    result = float(found[1]) + _ABOVE_ZERO.get(found[2], 0.0)
    if not 0.0 <= result <= LARGEST:
        raise ValueError(f"is {value!r}; it must be finite and not below absolute zero")
    return result


def quantity(unit: str, sign: Sign = "any", largest: float = LARGEST) -> BeforeValidator:
    """Annotation of a float field that is read as a quantity."""
    read = partial(written, unit=unit, sign=sign, largest=largest)
    return BeforeValidator(read, json_schema_input_type=written_as(schema_of(unit, sign)))


def vector(unit: str, sign: Sign = "any", count: int = 3) -> BeforeValidator:
    """Annotation of a field of so many floats, each read as a quantity."""
    schema = {"type": "array", "items": schema_of(unit, sign), "minItems": count, "maxItems": count}
    read = partial(_vector, unit=unit, sign=sign, count=count)
    return BeforeValidator(read, json_schema_input_type=written_as(schema))


def in_unit(value: object, unit: str) -> float:
    """A number, plain or with its unit, in a unit that may have no others; ValueError with a sentence otherwise."""
    text = str(value).strip()
    if unit in UNITS:
        found = QUANTITY.fullmatch(text)
        return to_si(f"{found[1]} {found[2] or unit}" if found else text, unit)
    try:
        number = float(text.removesuffix(unit))
    except ValueError:
        raise ValueError(f"is {value!r}; it must be a number in {unit}") from None
    if not isfinite(number):
        raise ValueError(f"is {value!r}; it must be finite")
    return number


def damping_time(ratio: float, frequency: float) -> float:
    """Damping over stiffness (s) that gives a mode of this frequency (Hz) this fraction of critical damping.

    c / k = 2 zeta / w for a mode on one spring, and for every mode where C is proportional to K.
    """
    return 2.0 * ratio / (2.0 * pi * frequency)


Ratio = Annotated[float, quantity("1", "zero or positive")]
PositiveRatio = Annotated[float, quantity("1", "positive")]
AnyRatio = Annotated[float, quantity("1")]
PoissonRatio = Annotated[AnyRatio, Field(gt=-1.0, lt=1.0)]
Radius = Annotated[float, quantity("m", "positive", LARGEST_RADIUS)]
Length = Annotated[float, quantity("m", "positive")]
Distance = Annotated[float, quantity("m", "zero or positive")]
Coordinate = Annotated[float, quantity("m")]
Interval = Annotated[tuple[float, float], vector("m", count=2)]
PlanePosition = Annotated[tuple[float, float], vector("m", count=2)]
Position = Annotated[Vector3, vector("m")]
Velocity = Annotated[Vector3, vector("m/s")]
AngularVelocity = Annotated[Vector3, vector("rad/s")]
Size = Annotated[Vector3, vector("m", "positive")]
Acceleration = Annotated[Vector3, vector("m/s2")]
Angle = Annotated[float, quantity("rad", largest=LARGEST_TURN)]
PositiveAngle = Annotated[float, quantity("rad", "positive", LARGEST_TURN)]
AngularClearance = Annotated[float, quantity("rad", "zero or positive", LARGEST_TURN)]
AngularRate = Annotated[float, quantity("rad/s", "positive")]
OpeningRate = Annotated[float, quantity("rad/s")]
PeakRate = Annotated[float, quantity("rad/s", "zero or positive")]
Duration = Annotated[float, quantity("s", "positive")]
Temperature = Annotated[
    float, BeforeValidator(kelvin, json_schema_input_type=written_as(schema_of("K", "zero or positive")))
]
Frequency = Annotated[float, quantity("Hz", "zero or positive")]
PositiveFrequency = Annotated[float, quantity("Hz", "positive")]
Mass = Annotated[float, quantity("kg", "positive")]
PointMass = Annotated[float, quantity("kg", "zero or positive")]
MomentOfInertia = Annotated[float, quantity("kg.m2", "positive")]
MomentsOfInertia = Annotated[Vector3, vector("kg.m2")]
LineMass = Annotated[float, quantity("kg/m", "positive")]
LineInertia = Annotated[float, quantity("kg.m", "positive")]
ArealMass = Annotated[float, quantity("kg/m2", "positive")]
Density = Annotated[float, quantity("kg/m3", "positive")]
Modulus = Annotated[float, quantity("Pa", "positive")]
Force = Annotated[float, quantity("N", "zero or positive")]
Torque = Annotated[float, quantity("N.m")]
FrictionTorque = Annotated[float, quantity("N.m", "zero or positive")]
AxialStiffness = Annotated[float, quantity("N", "positive")]
BendingStiffness = Annotated[float, quantity("N.m2", "positive")]
FourStiffnesses = tuple[float, float, float, float]
PlateStiffnesses = Annotated[FourStiffnesses, vector("N.m", count=4)]
MembraneStiffnesses = Annotated[FourStiffnesses, vector("N/m", count=4)]
PlateTension = Annotated[float, quantity("N/m", "zero or positive")]
Stiffness = Annotated[float, quantity("N/m", "positive")]
Stiffnesses = Annotated[Vector3, vector("N/m", "zero or positive")]
TurningStiffness = Annotated[float, quantity("N.m/rad", "positive")]
TurningStiffnesses = Annotated[Vector3, vector("N.m/rad", "zero or positive")]
Damping = Annotated[float, quantity("N.s/m", "zero or positive")]
TurningDamping = Annotated[float, quantity("N.m.s/rad", "zero or positive")]


def degrees_text(angle: float, decimals: int) -> str:
    """An angle (rad) in degrees, never as -0."""
    return f"{round(float(degrees(angle)), decimals) + 0.0:.{decimals}f}"
