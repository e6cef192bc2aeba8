"""Fixed identifiers of headline numbers, such as `latch_time.HL1`: quantity, a dot, and the component."""

from __future__ import annotations

_FIXED = {
    "end time": "end_time",
    "latch time": "latch_time",
    "latch rate": "latch_rate",
    "latch energy": "latch_energy",
    "latch impulse": "latch_impulse",
    "latch torque peak": "latch_torque_peak",
    "lock torque peak": "lock_torque_peak",
    "final angle, not latched": "unlatched_angle",
    "largest angle, no latch": "largest_angle",
    "final angle, no latch": "end_angle",
    "attitude peak": "attitude_peak",
    "final attitude": "end_attitude",
    "attitude rate peak": "attitude_rate_peak",
    "interface force peak": "interface_force_peak",
    "interface torque peak": "interface_torque_peak",
    "interface force magnitude peak": "interface_force_peak",
    "interface torque magnitude peak": "interface_torque_peak",
    "attachment force peak": "port_force_peak",
    "attachment torque peak": "port_torque_peak",
    "hinge force peak": "hinge_force_peak",
    "hinge torque peak": "hinge_torque_peak",
    "motor work": "motor_energy",
    "external work": "supplied_energy",
    "energy exchanged": "energy_exchanged",
    "numerical energy loss": "numerical_loss",
    "energy residual": "energy_residual",
}
_ENDINGS = ("_peak", "_min", "_max")
"""Extremes of a load, after its variable."""
_STRAND, _TENSION = "strand", "tension"


def load_words(variable: str) -> str:
    """Words for the variable of a load: "strand A tension" for `tension_a`, "contact force" for `contact_force`."""
    kind, _, strand = variable.partition("_")
    if kind == _TENSION and strand:
        return f"{_STRAND} {strand.upper()} {_TENSION}"
    return variable.replace("_", " ")


def quantity_identifier(quantity: str) -> str:
    """Identifier of a quantity without its component: `tension_a_min` for "strand A tension min"."""
    if quantity in _FIXED:
        return _FIXED[quantity]
    words = quantity.split(" ")
    if words[0] == _STRAND:
        words = [_TENSION, words[1].lower(), *words[3:]]
    return "_".join(words)


def identifier(quantity: str, of: str) -> str:
    """Identifier of a headline number."""
    return ".".join(filter(None, (quantity_identifier(quantity), of)))


def in_order(text: str) -> str:
    """The usual order, `latch_time.HL1`, of an identifier that may have the component first, `HL1.latch_time`."""
    first, _, last = text.rpartition(".")
    return f"{last}.{first}" if first and _is_quantity(last) and not _is_quantity(first) else text


def _is_quantity(text: str) -> bool:
    return text in _FIXED.values() or text.endswith(_ENDINGS)
