"""What each part of the model, and each thing not computed, costs and gives; native FMUs.

    python -m tests.benchmark.ablation [--repeats N] [--plot FILE]

Three tables: AMOS-3 flexible, 12 s, every row one change of the first; bodies that are held, joined or not
(`ablations.pieces`); hinges that have latched, joined or not (`ablations.latched`). Errors are against tight runs of
the full models, so that those of a reduced model are its modelling error. Repeats are interleaved, medians count.

Fewer fixed-interface modes make steps cheaper but more: a kinematic latch is a lock of 1e8 N.m/rad, which no step
resolves, so after every change of step size its torque alternates from step to step, and only the damping of the
modes that carry that torque, the residual constraint modes, ends it. With 10 fixed-interface modes these lie above
1 kHz, where modal damping is critical by default, and it lasts some steps; with 2 those of the yoke lie at 100 to
750 Hz with 10 %, it lasts some hundred steps, and the step control stays at its smallest size. The rows with other
damping show it: critical above 200 Hz, 2 modes need fewer steps than 10; 10 % throughout, 10 modes need half as
many again.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from components.flexible.modal import ModalData
from orchestrator.assembly import Assembly, Part
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.fmu import FmuParticipant
from orchestrator.cosim.participant import Participant
from orchestrator.run.run import Outcome, as_fmus
from orchestrator.scene import find_scene, load_scene
from tests.benchmark.ablations import latched, pieces
from tests.benchmark.ablations.rows import Row, draw, measure_all, print_table

UNTIL, TOLERANCE, TIGHT = 12.0, 3e-3, 1e-5
BODIES = ("yoke", "panel1", "panel2")


@contextmanager
def without_derivatives(assembly: Assembly) -> Iterator[Sequence[Participant]]:
    """Native FMUs as if they gave no derivatives, so that the interface Jacobian is probed by steps."""
    with as_fmus(assembly, "native") as participants:
        for participant in participants:
            if isinstance(participant, FmuParticipant):
                participant.directional_derivatives = False
        yield participants


def wing(rigid: Sequence[str] = (), **body: object) -> Assembly:
    """AMOS-3 with values laid over every body."""
    settings = [f"body.{name}.{key}={value}" for name in BODIES for key, value in body.items()]
    return assemble(load_scene(find_scene("amos3"), (), settings), rigid)


def with_damping(assembly: Assembly, above: float, ratio: float) -> Assembly:
    """The assembly with another damping ratio of all modes above a frequency (Hz)."""

    def damped(part: Part) -> Part:
        if part.kind != "body":
            return part
        data = ModalData.from_arrays(part.structure["modal"])
        ratios = np.where(data.frequency > 2.0 * np.pi * above, ratio, data.damping_ratio)
        return replace(part, structure={**part.structure, "modal": data.with_damping(ratios).to_arrays()})

    return replace(assembly, parts=tuple(map(damped, assembly.parts)))


def rows() -> list[Row]:
    """All rows of the wing; the first is what the others change."""
    full, two = wing(), wing(fixed_interface_modes=2)
    return [
        Row("full model, 10 modes", full),
        *(Row(f"{n} fixed-interface modes", wing(fixed_interface_modes=n)) for n in (5, 2, 0)),
        Row("10 modes, critical above 200 Hz", with_damping(full, 200.0, 1.0)),
        Row("2 modes, critical above 200 Hz", with_damping(two, 200.0, 1.0)),
        Row("10 modes, 10 % above 100 Hz", with_damping(full, 100.0, 0.1)),
        Row("2 modes, 10 % above 100 Hz", with_damping(two, 100.0, 0.1)),
        *(
            Row(f"inertia coupling {level}", wing(inertia_coupling=level))
            for level in ("partial", "constant")
        ),
        Row("yoke rigid", wing(rigid=("yoke",))),
        Row("all bodies rigid", wing(rigid=("all",))),
        *(Row(f"fixed step {h:g} s", full, fixed_step=h) for h in (2e-3, 5e-4)),
        Row("Jacobian probed by steps", full, load=without_derivatives),
        Row("nothing recorded", full, recorded=False),
    ]


def lock_mobility(data: ModalData, points: Sequence[str]) -> Mapping[str, float]:
    """What carries the torque of a lock about the y axis of some points: shares of the mobility by mode damping.

    The mobility of a mode is the square of its rotation there (1/(kg m2)); the rest is that of the rigid body.
    """
    index = [data.point_names.index(point) for point in points]
    modal = (data.rotation[index, 1, :] ** 2).sum(axis=0)
    total = modal.sum() + len(index) * np.linalg.inv(data.inertia)[1, 1]
    critical = data.damping_ratio >= 1.0
    decay = float((modal @ (data.damping_ratio * data.frequency)) / modal.sum())
    mean = float((modal @ data.frequency) / modal.sum() / (2.0 * np.pi))
    return {
        "critical": float(modal[critical].sum() / total),
        "frequency": mean,
        "decay": 1.0 / decay,
    }


def print_mobilities() -> None:
    """Why fewer modes take more steps: where the modes lie that carry the locks of HL2."""
    print(
        "modes that carry the lock of HL2, by mobility: mean frequency, time of decay, share of critical damping"
    )
    for body in ("yoke", "panel1"):
        for n in (10, 5, 2):
            part = next(p for p in wing(fixed_interface_modes=n).parts if p.name == body)
            found = lock_mobility(ModalData.from_arrays(part.structure["modal"]), ("hl2_left", "hl2_right"))
            print(
                f"  {body:8} {n:2d} fixed-interface modes {found['frequency']:6.0f} Hz {1e3 * found['decay']:6.2f} ms "
                f"{found['critical']:6.0%}"
            )


def _reference(row: Row, folder: Path, until: float) -> Outcome:
    """A tight run of a row's assembly."""
    tight = Row("reference", row.assembly, TIGHT, load=row.load)
    tight.measure(folder, TIGHT, until)
    assert tight.outcome is not None
    return tight.outcome


def main() -> None:
    """Print the tables; with --plot also draw the first two."""
    parser = ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--plot", type=Path)
    chosen = parser.parse_args()
    modelled, held = rows(), pieces.rows()
    with TemporaryDirectory() as name:
        folder = Path(name)
        true = _reference(modelled[0], folder, UNTIL)
        measure_all(modelled, folder, TOLERANCE, UNTIL, chosen.repeats)
        print(f"amos3 flexible, {UNTIL:g} s, tolerance {TOLERANCE:g}; errors against tolerance {TIGHT:g}")
        print_table(modelled, true, modelled[0])
        print_mobilities()
        held_true = _reference(held[2], folder, pieces.UNTIL)
        measure_all(held, folder, TOLERANCE, pieces.UNTIL, chosen.repeats)
        print(f"\narabsat phase 1, {pieces.UNTIL:g} s; errors against locked hinges, rigid stack")
        print_table(held, held_true, held[1])
        pieces.print_ratio(held)
    print("\namos3 from the last but one latch-up on; errors against latched hinges")
    latched.print_table(TOLERANCE, TIGHT, chosen.repeats)
    if chosen.plot:
        draw({"AMOS-3 flexible": (modelled, true), "ARABSAT phase 1": (held, held_true)}, chosen.plot)


if __name__ == "__main__":
    main()
