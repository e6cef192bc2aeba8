"""Fixed identifiers of headline numbers, such as `latch_time.HL1`: quantity, a dot, and what it is of."""

from __future__ import annotations

_FIXED = {
    "end time": "end_time",
    "latch time": "latch_time",
    "latch rate": "latch_rate",
    "latch energy": "latch_energy",
    "latch impulse": "latch_impulse",
    "latch torque peak": "latch_torque_peak",
    "lock torque peak": "lock_torque_peak",
    "angle, not latched": "unlatched_angle",
    "largest angle, no latch": "largest_angle",
    "angle at the end, no latch": "end_angle",
    "attitude peak": "attitude_peak",
    "attitude at the end": "end_attitude",
    "attitude rate peak": "attitude_rate_peak",
    "interface force peak": "interface_force_peak",
    "interface torque peak": "interface_torque_peak",
    "interface force magnitude peak": "interface_force_peak",
    "interface torque magnitude peak": "interface_torque_peak",
    "port force peak": "port_force_peak",
    "port torque peak": "port_torque_peak",
    "hinge force peak": "hinge_force_peak",
    "hinge torque peak": "hinge_torque_peak",
    "motor energy": "motor_energy",
    "energy put in": "supplied_energy",
    "energy exchanged": "energy_exchanged",
    "numerical dissipation": "numerical_loss",
    "energy residual": "energy_residual",
}
_OF_LOADS = {"peak": "peak", "lowest": "min", "highest": "max"}
"""What ends the quantity of a load, whose variable comes before it."""
_ENDINGS = tuple(f"_{ending}" for ending in _OF_LOADS.values())


def quantity_identifier(quantity: str) -> str:
    """Of a quantity, without what it is of: `tension_a_min` of "tension a lowest"."""
    if quantity in _FIXED:
        return _FIXED[quantity]
    variable, _, ending = quantity.rpartition(" ")
    return f"{variable.replace(' ', '_')}_{_OF_LOADS[ending]}"


def identifier(quantity: str, of: str) -> str:
    """Of a headline number."""
    return ".".join(filter(None, (quantity_identifier(quantity), of)))


def in_order(text: str) -> str:
    """An identifier that may have what it is of in front, `HL1.latch_time`, as it is written, `latch_time.HL1`."""
    first, _, last = text.rpartition(".")
    return f"{last}.{first}" if first and _is_quantity(last) and not _is_quantity(first) else text


def _is_quantity(text: str) -> bool:
    return text in _FIXED.values() or text.endswith(_ENDINGS)
