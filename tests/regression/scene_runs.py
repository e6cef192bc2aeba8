"""Whole runs of scenes as FMUs, each once per test session."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.results.result import Result
from orchestrator.run.run import Outcome, run
from orchestrator.scene import find_scene, load_scene


@dataclass(frozen=True)
class Runs:
    """Runs kept by what they are of."""

    folder: Path
    done: dict[tuple[object, ...], Outcome]
    always: tuple[str, ...] = ()
    """Settings of every run."""

    def __call__(
        self,
        scene: str,
        *variants: str,
        rigid: tuple[str, ...] = (),
        settings: tuple[str, ...] = (),
        tolerance: float | None = None,
        step: float | None = None,
        until: float | None = None,
    ) -> Outcome:
        """The outcome of a scene with its layers, at its own tolerance unless one is given."""
        settings = (*self.always, *settings)
        key = (scene, variants, rigid, settings, tolerance, step, until)
        if key not in self.done:
            assembly = assemble(load_scene(find_scene(scene), variants, settings), rigid)
            numbers = Settings(tolerance or assembly.tolerance, assembly.largest_step, fixed_step=step)
            self.done[key] = run(assembly, self.folder / f"{len(self.done)}.h5", numbers, until)
        return self.done[key]

    def result(self, *scene: str, **options: object) -> Result:
        """The result of the same."""
        return Result.open(self(*scene, **options).path)  # type: ignore[arg-type]


_FOLDER = TemporaryDirectory(prefix="fanfold_runs_")  # goes with the session
RUNS = Runs(Path(_FOLDER.name), {})
THESIS = Runs(Path(_FOLDER.name) / "thesis", {}, ("friction.law=smooth",))
"""With the friction of the theses, for comparisons with them."""
THESIS.folder.mkdir()
