"""FMI: any component as an FMU, and a list of everything wrong with an FMU. Names are imported at first use."""

from typing import TYPE_CHECKING

from .lazy_names import homes, importer

if TYPE_CHECKING:
    from .build import build_fmu as build_fmu
    from .check.check import check_fmu as check_fmu
    from .compiled import native_backend as native_backend
    from .description.choices import NATIVE_TOOL as NATIVE_TOOL
    from .description.choices import Backend as Backend
    from .description.choices import FmiVersion as FmiVersion
    from .description.fmi2 import About as About
    from .description.fmi2 import Experiment as Experiment
    from .description.fmi2 import model_description as model_description
    from .description.fmi3 import model_description3 as model_description3
    from .description.variables import start_values as start_values
    from .description.variables import value_references as value_references
    from .native import CompileError as CompileError
    from .native import native_library as native_library
    from .native.platforms import PLATFORMS as PLATFORMS
    from .native.platforms import cross_compiled as cross_compiled

HOMES = homes(__name__, __file__)
__all__ = sorted(HOMES)

if not TYPE_CHECKING:  # type checkers know the names above and no others
    __getattr__ = importer(__name__, HOMES)
