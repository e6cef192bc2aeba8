"""What a master and those who show results know a variable by: names and roles that any component may declare."""

from __future__ import annotations

from dataclasses import replace

from .quantity import Quantity


def _command(name: str, description: str) -> Quantity:
    return Quantity(name, "1", description, variability="discrete", kind="boolean")


IMPULSE = _command("impulse", "1: the next step is an impulse")
"""Input of whatever remembers motion or load from step to step: an impulse is neither."""
HOLD = _command("hold", "1: what moves by itself stands still")
"""Input: an angle is held, a clock stands, strands keep their preload, while a master seeks an equilibrium."""
LATCH_COMMAND = _command("latch_command", "1: the latch engages at the start of the next step")
UNLATCH_COMMAND = _command(
    "unlatch_command", "1: the latch lets go at the start of the next step, and stays open while this is 1"
)
RELEASE_COMMAND = _command("release_command", "1: released at the start of the next step")
"""Input of what is made to let go."""
FAILURE_COMMAND = _command(
    "failure_command", "1: fails at the start of the next step, and is free from then on"
)
"""Input of a joint that is made to hold."""

LATCH_DISTANCE = Quantity(
    "latch_distance", "rad", "Latch angle minus hinge angle; falls through zero at latch-up"
)
"""Output that a master watches for its zero: the event indicator of latch-up."""
LATCHED = Quantity(
    "latched", "1", "1 from latch-up on, until it is unlatched", variability="discrete", kind="boolean"
)
"""Output, beside the latch distance."""

TIME_TO_BREAK = Quantity("time_to_break", "s", "Time to the next instant where a motion law changes its form")
"""Output of what follows a motion law: a master ends a step there."""

CUT = Quantity("cut", "1", "1: it is cut, and carries nothing", 1, 0.0, 0.0, 1.0, "tunable", kind="boolean")
"""Parameter of a cable that an event releases."""
ORDER = Quantity(
    "order", "1", "Order of mean wrenches in time: 2, or 4, which needs first moments from the master",
    1, 2.0, 2.0, 4.0, "fixed", kind="integer",
)  # fmt: skip
"""Parameter of a connection that has a law of order 4."""
KINETIC_ENERGY = Quantity("kinetic_energy", "J", "Kinetic energy")
POTENTIAL_ENERGY = Quantity("potential_energy", "J", "Elastic energy")
DISSIPATED_ENERGY = Quantity("dissipated_energy", "J", "Energy dissipated since the start")
NUMERICAL_DISSIPATION = Quantity(
    "numerical_dissipation", "J", "Energy taken by the scheme since the start, not a physical loss"
)
SUPPLIED_ENERGY = Quantity(
    "supplied_energy", "J", "Work of what supplies energy from outside since the start"
)
"""Observations that the energy balance of a scene adds up; dissipation is never found by difference.

Kinetic, potential, dissipated energy and numerical dissipation change together by what is supplied from outside,
such as the work of a drive. Dissipated energy is the heat of dampers, friction and latches alone; numerical
dissipation is what the scheme takes away besides, and it may give back a part that it stored.
"""

LAGGED = "_lagged"
"""Ending of an observation that tells the one named before it once more, for the communication point one step earlier.

What a load was there is known better once both steps beside that point are. Such observations are declared last.
"""


def lagged(quantity: Quantity) -> Quantity:
    """The observation that tells a quantity for the communication point one step earlier."""
    text = f"{quantity.description}, one step earlier; of order 4, after two steps"
    return replace(quantity, name=quantity.name + LAGGED, description=text, role="")


LOAD = "load"
"""Role of an observation: a force or torque by whose peak runs are compared."""
INTERFACE_LOAD = "interface load"
"""Role of an observation: the same of the load on the spacecraft."""
PORT_LOAD = "interface load of a port"
"""Role of an observation: one port's share of the load on the spacecraft."""
HINGE_LOAD = "load at a hinge"
"""Role of an observation: what a hinge brings onto its outboard body, in the axes of the inboard one."""
ATTITUDE = "attitude"
"""Role of an observation: attitude (rad) or rate (rad/s) of a free spacecraft."""
PENETRATION = "penetration"
"""Role of an observation: how deep what only pushes is touched; it is struck where this rises through zero."""
DISSIPATION = "dissipation"
"""Role of an observation: one cause's share of the dissipated energy (J)."""
