"""The static equilibrium that a scene with preload starts from, as the native master of one FMU reads it."""

from __future__ import annotations

import struct
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from components.contract.quantity import Vector

from ...assembly import Assembly
from ...assembly.statics.start import static_start
from ...cosim.master import Master
from ...cosim.network import Network
from ...cosim.ports import Order
from ...cosim.settings import Settings
from ...results.recorder import NoRecorder
from ..run import as_fmus

REST = ("rest_states", "rest_inputs", "rest_wrenches")
_HEADER = struct.Struct("<16s8dQ")
"""Of a serialised state, fmus/native/core/saved_state.c: owner, numbers, check sum."""
_KNOWN, _STATES = 4, 5
"""Where it tells how many parameters and inputs, and how many states follow."""


def rest(assembly: Assembly, settings: Settings, order: Order) -> Mapping[str, ArrayLike]:
    """States and inputs of all participants, bodies first, and the wrenches at all ports; nothing without preload.

    SceneError where there is no equilibrium.
    """
    if not assembly.preload:
        return {}
    assembly = static_start(assembly).assembly
    with as_fmus(assembly, "native", files=False) as participants:
        network = Network(participants, assembly.links, order)
        master = Master(network, assembly.hinge_lines, NoRecorder(), settings, assembly.events)
        master.initialize(preload=True)
        wrenches = master.coupling.accepted.copy()
        found = master.snapshot()
    names = [participant.name for participant in network.participants]
    states = np.concatenate([_states(found.states[name]) for name in names])
    inputs = np.concatenate([found.arrays[f"inputs {name}"] for name in names])
    return dict(zip(REST, (states, inputs, wrenches), strict=True))


def _states(serialised: bytes) -> Vector:
    header = _HEADER.unpack_from(serialised)
    numbers = np.frombuffer(serialised, "<f8", offset=_HEADER.size)
    return numbers[int(header[_KNOWN]) :][: int(header[_STATES])]
