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

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

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


def _homes() -> dict[str, str]:
    """Module of each name: what type checkers read above."""
    from ast import If, ImportFrom, parse

    tree = parse(Path(__file__).read_text(encoding="utf-8"))
    block = next(node for node in tree.body if isinstance(node, If))
    imports = [node for node in block.body if isinstance(node, ImportFrom)]
    return {
        one.names[0].name: f"{__name__}.{one.module}" if one.level else str(one.module) for one in imports
    }


HOMES = _homes()
__all__ = sorted(HOMES)


if not TYPE_CHECKING:  # type checkers know the names above and no others

    def __getattr__(name: str) -> Any:  # noqa: ANN401 - of whatever type it has where it is defined
        if name not in HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(import_module(HOMES[name]), name)


def __dir__() -> list[str]:
    return __all__
