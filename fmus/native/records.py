"""Structures that Python and the coupling in C share, by name and type: the one declaration of both.

`python -m fmus.native` writes `coupling/records.h` from it, and `structure` makes the type for ctypes.
"""

from __future__ import annotations

from ctypes import Structure, c_double, c_int, c_size_t, c_ssize_t, c_void_p
from functools import cache
from pathlib import Path
from textwrap import fill
from typing import Any

RECORDS_HEADER = Path(__file__).parent / "coupling" / "records.h"
_TYPES = {"double": c_double, "int": c_int, "size_t": c_size_t, "ptrdiff_t": c_ssize_t}
_RECORDS = {
    "Participant": (
        "A participant: its functions, its arrays, the cell of its saved state, and its ports. derivative: NULL where "
        "it gives no derivatives of the step just made; port_stiffness: of a connection that has all columns at once, "
        "or NULL. inputs, outputs: how many are exchanged. slopes, moments: where slopes of wrenches and moments of "
        "rates begin beside the rest, 0 for none; links: of its ports. turned: a body's mobility (coordinates, "
        "wrenches), a connection's stiffness (wrenches, coordinates), of all ports; NULL for a body that never moves. "
        "rigid: of a rigid body, whose ports move as one, NULL for others: what a wrench at its first port moves "
        "(coordinates, wrench), then the negative of what all wrenches are there (wrenches, wrench). response: a "
        "connection's wrenches on bodies that are rigid or never move, by the unknowns of the bodies at its ports, the "
        "negative: for each port that moves and each such port (unknowns, wrench).",
        {
            "component": "void *",
            "set_real": "SetReal *",
            "get_real": "GetReal *",
            "do_step": "DoStep *",
            "get_state": "GetState *",
            "set_state": "SetState *",
            "free_state": "FreeState *",
            "derivative": "Derivative *",
            "port_stiffness": "PortStiffness *",
            "input_references": "const unsigned *",
            "output_references": "const unsigned *",
            "observation_references": "const unsigned *",
            "inputs": "size_t",
            "outputs": "size_t",
            "observations": "size_t",
            "overwrites_state": "size_t",
            "input": "double *",
            "output": "double *",
            "observation": "double *",
            "saved": "void **",
            "ports": "size_t",
            "slopes": "size_t",
            "moments": "size_t",
            "links": "const size_t *",
            "turned": "double *",
            "rigid": "double *",
            "response": "double *",
        },
    ),
    "Request": (
        "How far to go (s): to the end of a run, to the next event that has a time, and after which step to pause. "
        "fixed_step (s): 0 for none; plan (planned,): sizes to make, NULL where they are chosen.",
        {
            "until": "double",
            "event_time": "double",
            "pause_time": "double",
            "fixed_step": "double",
            "plan": "const double *",
            "planned": "size_t",
        },
    ),
    "Progress": (
        "What steps have come to. time (s) of the participants, size h (s) of the last attempt at a step, and as it "
        "was tried before anything crossed in it; made, rejected: steps of the last call; crossed: what ended the last "
        "step, as a number, negative for nothing; lets_go: whether a hold-down does at its end; solved: whether an "
        "instant could be solved; failure: why something could not be done, and then the participant, its call and its "
        "status, or the row of the wrench that changes most, by so many tolerances, after so many iterations.",
        {
            "time": "double",
            "h": "double",
            "tried": "double",
            "correction": "double",
            "crossed": "ptrdiff_t",
            "made": "size_t",
            "rejected": "size_t",
            "lets_go": "size_t",
            "solved": "size_t",
            "failure": "size_t",
            "participant": "size_t",
            "call": "size_t",
            "worst_row": "size_t",
            "iterations": "size_t",
            "status": "int",
        },
    ),
}


@cache
def structure(name: str) -> type[Structure]:
    """The type of a record for ctypes; pointers are addresses."""
    fields = [(field, _TYPES.get(kind, c_void_p)) for field, kind in _RECORDS[name][1].items()]
    namespace: dict[str, Any] = {"_fields_": fields, "__doc__": _RECORDS[name][0]}
    return type(name, (Structure,), namespace)


def records_header() -> str:
    """The records in C; the types of functions stand in participant.h."""
    texts = [_in_c(name, *record) for name, record in _RECORDS.items()]
    return (
        "/* Records that Python shares: fmus/native/records.py, written by python -m fmus.native. */\n\n"
        + "\n".join(texts)
    )


def _in_c(name: str, comment: str, fields: dict[str, str]) -> str:
    declared = "".join(
        f"    {kind}{'' if kind.endswith('*') else ' '}{field};\n" for field, kind in fields.items()
    )
    wrapped = fill(f"/* {comment} */", 120, subsequent_indent="   ")
    return f"{wrapped}\ntypedef struct {{\n{declared}}} {name};\n"
