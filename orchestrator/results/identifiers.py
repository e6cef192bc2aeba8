"""Fixed identifiers of headline numbers, such as `latch_time.HL1`: quantity, a dot, and the component."""

from __future__ import annotations

from components.contract.errors import unknown

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
    "unlatch time": "unlatch_time",
    "last latch time": "last_latch_time",
    "final angle, unlatched": "restowed_angle",
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
_UNITS = {
    "end_time": "s",
    "latch_time": "s",
    "unlatch_time": "s",
    "last_latch_time": "s",
    "latch_rate": "rad/s",
    "latch_energy": "J",
    "latch_impulse": "N.m.s",
    "attitude_rate_peak": "rad/s",
    "motor_energy": "J",
    "supplied_energy": "J",
    "energy_exchanged": "J",
    "numerical_loss": "J",
    "energy_residual": "1",
}
"""SI units of quantities whose identifier does not show it."""
OF_A_LATCH_UP = (
    "latch_time", "latch_rate", "latch_energy", "latch_impulse", "latch_torque_peak", "lock_torque_peak",
)  # fmt: skip
"""Quantities of a line that has latched."""
BY_OWNER = {
    "run": (
        "end_time", "motor_energy", "supplied_energy", "energy_exchanged", "numerical_loss", "energy_residual"
    ),
    "latch": (*OF_A_LATCH_UP, "unlatched_angle", "unlatch_time", "last_latch_time", "restowed_angle"),
    "line without latch": ("largest_angle", "end_angle"),
    "free base": ("attitude_peak", "end_attitude", "attitude_rate_peak"),
    "base": ("interface_force_peak", "interface_torque_peak"),
    "port": ("port_force_peak", "port_torque_peak"),
    "hinge": ("hinge_force_peak", "hinge_torque_peak"),
}  # fmt: skip
"""Quantities by what has them; further ones are extremes of the loads of components."""
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


def unit_of(quantity: str) -> str:
    """SI unit of a quantity by its identifier, with or without a component; ValueError if there is no such quantity."""
    name = quantity.partition(".")[0]
    if not _is_quantity(name):
        known = list(dict.fromkeys(_FIXED.values()))
        raise ValueError(f"{name} {unknown(name, known, 'headline number')}")
    if name in _UNITS:
        return _UNITS[name]
    return "N.m" if "torque" in name else "rad" if "angle" in name or "attitude" in name else "N"


def in_order(text: str) -> str:
    """The usual order, `latch_time.HL1`, of an identifier that may have the component first, `HL1.latch_time`."""
    first, _, last = text.rpartition(".")
    return f"{last}.{first}" if first and _is_quantity(last) and not _is_quantity(first) else text


def _is_quantity(text: str) -> bool:
    return text in _FIXED.values() or text.endswith(_ENDINGS)
