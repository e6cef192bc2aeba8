"""An assembly whose bodies start in the static equilibrium of its preload, for hosts that have no search for it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..assembly import Assembly, Part
from ..assembly.start_values import led_to
from ..cosim.settings import Settings
from ..results.result import Result
from .run import run

_STARTED = {
    "initial_position": "frame_position",
    "initial_orientation": "frame_orientation",
    "initial_modal_coordinate": "modal_coordinate",
}
"""Parameters of bodies that say where they start, by what is recorded of them."""
_INSTANT = 1e-5


def started_at_rest(assembly: Assembly, coupled: Assembly) -> Assembly:
    """The assembly with the start values of bodies and ports that equilibrium gives; unchanged without preload.

    coupled: the same scene at the same fidelity with mean wrenches, which the search needs. RunError where there is
    no equilibrium.
    """
    if not assembly.preload:
        return assembly
    settings = Settings(assembly.tolerance, assembly.largest_step)
    found = run(coupled, None, settings, _INSTANT).result
    placed = [replace(part, start={**part.start, **dict(_starts(part, found))}) for part in assembly.parts]
    return replace(assembly, parts=led_to(assembly.parts, placed, assembly.links), preload=False)


def _starts(part: Part, found: Result) -> Iterator[tuple[str, tuple[float, ...]]]:
    for parameter, recorded in _STARTED.items():
        if found.has(part.name, recorded):
            yield parameter, tuple(found.signal(part.name, recorded)[0].tolist())
