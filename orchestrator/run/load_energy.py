"""Energy that loads put through a scene without motors, from a coarse run before the requested one.

Errors are relative to the energy of a scene. The energy of motors is known before the run; that of loads follows from
the motion. If a load grows from zero, its first instants would be relative to almost nothing: 171,000 steps for a
slowly bent beam, instead of 5,200 with the same result.
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
_SHARE = 1e-2
"""Of what is exchanged: what rings without much of it, such as what a push stirs up, is still followed."""


def with_energy_of_loads(
    assembly: Assembly, settings: Settings, until: float, master: MasterKind, progress: Progress, load: Loader
) -> Assembly:
    """The assembly with its driving energy (J), where loads follow laws, nothing else drives, and steps the tolerance.

    As it is, where the coarse run does not reach the end (s).
    """
    chooses = settings.fixed_step is None and master == "implicit" and settings.tolerance < _COARSE
    by_laws = not assembly.signal_fmus and any(part.kind == Load.kind for part in assembly.parts)
    if not chooses or assembly.driving.energy or not by_laws:
        return assembly
    coarse = replace(settings, tolerance=_COARSE, snapshot_every=None)
    try:
        with followed(progress, f"{assembly.name}: energy of loads", until) as watch:
            found = run(assembly, None, coarse, until, watch=watch, load=load)
    except InterruptedRunError:
        raise
    except RunError:
        return assembly
    energy = _SHARE * found.headline.energy_exchanged
    return replace(assembly, driving=replace(assembly.driving, energy=energy))
