"""The energy that loads will put through a scene without motors, from a coarse run before the one asked for.

Errors are judged beside the energy of a scene. What motors give is known before they move; what loads give follows from
how far they lead. A load that grows from nothing would have its first instants judged beside next to nothing: 171,000
steps for a beam that is bent slowly, where 1,600 give the same.
"""

from __future__ import annotations

from dataclasses import replace

from components.load import Load

from ..assembly import Assembly
from ..cosim.settings import Settings
from .errors import InterruptedRunError, RunError
from .progress import Progress, followed
from .run import Loader, MasterKind, run

_COARSE = 1e-2


def with_energy_of_loads(
    assembly: Assembly, settings: Settings, until: float, master: MasterKind, progress: Progress, load: Loader
) -> Assembly:
    """The assembly with its driving energy (J), where it has loads, no motors, and steps that follow the tolerance.

    As it is, where the coarse run does not reach the end (s).
    """
    chooses = settings.fixed_step is None and master == "implicit" and settings.tolerance < _COARSE
    if not chooses or assembly.driving_energy or all(part.kind != Load.kind for part in assembly.parts):
        return assembly
    coarse = replace(settings, tolerance=_COARSE, snapshot_every=None)
    try:
        with followed(progress, f"{assembly.name}: energy of loads", until) as watch:
            found = run(assembly, None, coarse, until, watch=watch, load=load)
    except InterruptedRunError:
        raise
    except RunError:
        return assembly
    return replace(assembly, driving_energy=found.headline.energy_exchanged)
