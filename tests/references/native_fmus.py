"""A small scene as native FMUs, against the same scene in process."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace

import numpy as np
import pytest

from components.contract.roles import LAGGED
from orchestrator.assembly import Link, Part
from orchestrator.cosim.network import Network
from orchestrator.cosim.settings import Order, Settings
from orchestrator.run.run import as_fmus
from tests.references.coupled import HAS_NATIVE, Tolerance, completed, mastered
from tests.references.coupling_parts import matrix_of

needs_native = pytest.mark.skipif(not HAS_NATIVE, reason="no C compiler built the native FMUs")
_TIGHT = Tolerance(1e-9, 1e-5, 1e-5)


def native_errors(
    name: str, until: float, parts: Sequence[Part], links: Sequence[Link], h: float, order: Order = 2
) -> tuple[float, float]:
    """How far a connection's native FMU is off, at steps of size h; what is below 1e-3 counts as that.

    The largest difference of an observation over its largest value, in the same run as in process;
    and that of the derivatives it gives of the step after `until` from differences of such steps.
    """
    settings = Settings(fixed_step=h, order=order)
    reference = completed(until, parts, links, native=False, settings=settings, iteration=_TIGHT)
    with as_fmus(SimpleNamespace(name="scene", parts=parts), "native") as participants:  # type: ignore[arg-type]
        network = Network(participants, links, order)
        run = mastered(network, settings, iteration=_TIGHT)
        master = run.master
        master.initialize(preload=False)
        master.run(until)
        connection = network.by_name[name]
        errors = [0.0]
        for quantity in connection.observation_layout.quantities:
            if quantity.name.endswith(LAGGED):
                continue  # no row of its own
            found, expected = run.signal(name, quantity.name), reference.signal(name, quantity.name)
            errors.append(np.abs(found - expected).max() / max(np.abs(expected).max(), 1e-3))
        number = network.participants.index(connection)
        exact, expected = (
            matrix_of(master.coupling, number, h, differences=differences) for differences in (False, True)
        )
        size = max(float(np.abs(expected).max()), 1e-3)
        return float(max(errors)), float(np.abs(exact - expected).max()) / size
