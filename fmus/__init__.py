"""FMI: any component as an FMU, and a list of everything wrong with an FMU."""

from .build import build_fmu, cache_directory, native_backend
from .check import check_fmu
from .description import Backend, model_description, start_values, value_references
from .native import library as native_library

__all__ = [
    "Backend",
    "build_fmu",
    "cache_directory",
    "check_fmu",
    "model_description",
    "native_backend",
    "native_library",
    "start_values",
    "value_references",
]
