"""FMI: any component as an FMU, and a list of everything wrong with an FMU."""

from .build import build_fmu, native_backend
from .check.check import check_fmu
from .description.fmi2 import NATIVE_TOOL, Backend, Experiment, FmiVersion, model_description
from .description.fmi3 import model_description3
from .description.variables import start_values, value_references
from .native import CompileError
from .native import library as native_library
from .native.platforms import PLATFORMS, cross_compiled

__all__ = [
    "NATIVE_TOOL",
    "PLATFORMS",
    "Backend",
    "CompileError",
    "Experiment",
    "FmiVersion",
    "build_fmu",
    "check_fmu",
    "cross_compiled",
    "model_description",
    "model_description3",
    "native_backend",
    "native_library",
    "start_values",
    "value_references",
]
