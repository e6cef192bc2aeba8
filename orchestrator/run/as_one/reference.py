"""The reference result of a scene as one FMU: a run of its default experiment, for importers to check themselves."""

from __future__ import annotations

import numpy as np

from fmus import Experiment
from fmus.compiled import component_data, run_through
from fmus.description.reference_results import reference_files

from .component import ERRORS, AssembledScene

_ROUNDING = 1e-9
"""Of a number of steps."""


def reference(scene: AssembledScene, name: str, experiment: Experiment) -> dict[str, bytes]:
    """Files by their path in the FMU; ComponentError where the run fails.

    Inputs stay at their start values. Counts of steps and errors of the scheme are none of the results.
    """
    step = experiment.step_size or experiment.stop_time
    count = int(np.floor(experiment.stop_time / step + _ROUNDING))
    times = (step * np.arange(count + 1)).tolist()
    first = scene.parameter_layout.size + scene.input_layout.size
    names = scene.output_layout.scalar_names()
    start = scene.start()
    found = run_through(component_data(scene, start), times, range(first, first + len(names)))
    kept = [place for place, variable in enumerate(names) if variable not in ERRORS]
    words = (
        "The result is that of the default experiment with all inputs at their start values, computed by Fanfold. "
        f"The tolerance of the experiment is {start['tolerance'][0]:g}: other platforms and communication steps may "
        "differ by as much, relative to the largest value of a column."
    )
    return reference_files(name, [names[place] for place in kept], times, found[:, kept], words)
