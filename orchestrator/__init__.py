"""Fanfold: simulate deployable space structures as coupled FMI components.

A run::

    import orchestrator as fanfold

    scene = fanfold.load("amos3")                       # built-in scene, or the path of a scene file
    print(fanfold.check_scene(scene).warnings)          # probable mistakes
    result = fanfold.simulate(scene, rigid="all")       # deploy the wing
    print(result.latch_times, result.warnings)          # s, and problems to act on
    fanfold.report(result, "amos3.html")

`load` and `simulate` are all that a first run needs; `help(fanfold.simulate)` lists the options. `Scene` builds scenes
in code, `Result` has signals, headline numbers and figures. `study`, `tune` and `gradients` vary parameters; `modes`,
`equilibrium`, `torque_margin` and further functions analyse a scene, `stress` and `impacts` a result. `export` writes
FMUs. Errors are `FanfoldError`, warnings `FanfoldWarning`. Names are imported at first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fmus.lazy_names import homes, importer

if TYPE_CHECKING:
    from components import FanfoldError as FanfoldError

    from .api.analyses import appendage as appendage
    from .api.analyses import body_outputs as body_outputs
    from .api.analyses import constraints as constraints
    from .api.analyses import equilibrium as equilibrium
    from .api.analyses import frequency_response as frequency_response
    from .api.analyses import impacts as impacts
    from .api.analyses import latch_tuning as latch_tuning
    from .api.analyses import mode_study as mode_study
    from .api.analyses import modes as modes
    from .api.analyses import quasi_static as quasi_static
    from .api.analyses import restart as restart
    from .api.analyses import step_study as step_study
    from .api.analyses import stress as stress
    from .api.analyses import torque_margin as torque_margin
    from .api.analyses import wing_latch_tuning as wing_latch_tuning
    from .api.cache import cache as cache
    from .api.documents import compare as compare
    from .api.documents import live as live
    from .api.documents import plot_comparison as plot_comparison
    from .api.documents import report as report
    from .api.export import export as export
    from .api.export import export_body as export_body
    from .api.gradients import gradients as gradients
    from .api.handbook.python_face import docs as docs
    from .api.handbook.python_face import json_schema as json_schema
    from .api.pictures import plot as plot
    from .api.plugins import figure as figure
    from .api.plugins import load_plugin as load_plugin
    from .api.plugins import trust as trust
    from .api.result import Result as Result
    from .api.simulate import check as check
    from .api.simulate import check_scene as check_scene
    from .api.simulate import load as load
    from .api.simulate import resume as resume
    from .api.simulate import scenes as scenes
    from .api.simulate import simulate as simulate
    from .api.study import Study as Study
    from .api.study import resume_study as resume_study
    from .api.study import study as study
    from .api.tune import tune as tune
    from .api.viewers import export_view as export_view
    from .api.warnings import FanfoldWarning as FanfoldWarning
    from .scene.builder import Scene as Scene


HOMES = homes(__name__, __file__)
__all__ = sorted(HOMES)


if not TYPE_CHECKING:  # type checkers know the names above and no others
    __getattr__ = importer(__name__, HOMES)


def __dir__() -> list[str]:
    return __all__
