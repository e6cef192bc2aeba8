"""How many fixed-interface modes a body needs: latch-up against their number, and frequencies of the reduced body.

The study of Bagnoli (2007), section 3.2.2: the same scene with more and more modes, compared with the most; and
Tables 3-2 and 3-3, the free frequencies of the reduced body against those of the full finite-element model.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from components.contract.component import Vector
from components.flexible.reduction import fixed_interface_frequencies, free_frequencies

from ..assembly.assemble import assemble
from ..cosim.settings import Settings
from ..records import short_repr
from ..run.progress import Progress, silent
from ..run.run import RunError
from ..scene import PlacedScene
from ..scene.bodies import body_definition, body_model
from ..scene.body_tables import Body
from ..scene.builder import Scene
from .studies import LatchStudy, refuse_without_latches, run_case

_LISTED = 8


class Frequencies(NamedTuple):
    """Frequencies (Hz) of one body: clamped and free of the full model, free of the reduced body by modes kept."""

    fixed: Vector
    free: Vector
    reduced: dict[int, Vector]


@short_repr
@dataclass(frozen=True)
class ModeStudy:
    """Latch-up of a scene against the modes of a body, and the body's frequencies."""

    body: str
    latch_up: LatchStudy
    frequencies: Frequencies

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        found = self.frequencies
        return {
            "body": self.body,
            "cases": self.latch_up.as_dicts(),
            "fixed_interface_hz": found.fixed.tolist(),
            "free_hz": found.free.tolist(),
            "reduced_free_hz": {str(k): v.tolist() for k, v in found.reduced.items()},
        }


def mode_label(count: int) -> str:
    """How a number of modes is called in tables."""
    return f"{count} mode{'s' * (count != 1)}"


def mode_study(
    scene: Scene,
    body: str | None,
    counts: Sequence[int],
    rigid: Collection[str] = (),
    flexible: Collection[str] = (),
    tolerance: float | None = None,
    folder: Path | None = None,
    progress: Progress = silent,
) -> ModeStudy:
    """Runs with each number of fixed-interface modes of a body, the largest being the reference.

    body: by name; without one the only one that `rigid` leaves. Results stand in the folder, if there is one.
    """
    counts = tuple(sorted(set(counts)))
    if len(counts) < 2 or counts[0] < 0:
        raise RunError("give at least two different numbers of modes, none negative")
    checked = scene.check_one_run()
    studied = studied_body(checked, body, rigid)
    key = f"body.{studied.name}.fixed_interface_modes"
    assemblies = {
        count: assemble(scene.with_settings({key: count}).check(), rigid, {*flexible, studied.name})
        for count in counts
    }
    refuse_without_latches(assemblies[counts[0]])
    cases = []
    for count, assembly in assemblies.items():
        settings = Settings(tolerance or assembly.tolerance, assembly.largest_step)
        path = None if folder is None else folder / f"{count}_modes.h5"
        cases.append(run_case(mode_label(count), count, assembly, path, settings, progress))
    title = f"Latch-up with modes of {studied.name}"
    against = f"{mode_label(counts[-1])} of {studied.name}"
    latch_up = LatchStudy(checked.header.name, title, against, "fixed-interface modes", cases)
    return ModeStudy(studied.name, latch_up, frequencies(studied, counts))


def studied_body(scene: PlacedScene, name: str | None, rigid: Collection[str]) -> Body:
    """The named body, or the only one that is not rigid; held lines leave a body no modes."""
    held = scene.locked_bodies
    bodies = {body.name: body for body in scene.bodies if body.can_bend and body.name not in held}
    left = [body for body in bodies if not {body, "all"} & set(rigid)]
    if name is None and len(left) == 1:
        return bodies[left[0]]
    if not bodies or (name is None and left) or (name is not None and name not in bodies):
        known = ", ".join(left or bodies) or "none"
        raise RunError(f"{scene.file}: name the body to study; bodies that can have modes are {known}")
    studied = name or next(iter(bodies))
    if studied not in left:
        others = ",".join(body for body in bodies if body != studied)
        advice = (
            f"make only others rigid, body: {studied}, rigid: {others}" if others else "make no body rigid"
        )
        whose = f"{name} has no modes" if name else "no body has modes"
        raise RunError(f"{scene.file}: with these bodies rigid {whose} to count; {advice}")
    return bodies[studied]


def frequencies(body: Body, counts: Sequence[int], listed: int = _LISTED) -> Frequencies:
    """The first frequencies of a body in full and reduced to each number of fixed-interface modes."""
    definition = body_definition(body)
    model = definition.finite_elements(body.masses)
    reduced = {}
    for count in counts:
        data = body_model(body.model_copy(update={"fixed_interface_modes": count}), flexible=True)
        reduced[count] = data.frequency[:listed] / (2.0 * np.pi)
    fixed = fixed_interface_frequencies(model, definition.attachment_points, listed)
    return Frequencies(fixed / (2.0 * np.pi), free_frequencies(model, listed) / (2.0 * np.pi), reduced)
