"""FMI: any component as an FMU, and a list of everything wrong with an FMU."""

from .build import build_fmu, cache_directory
from .check import check_fmu
from .description import model_description, start_values, value_references

__all__ = [
    "build_fmu",
    "cache_directory",
    "check_fmu",
    "model_description",
    "start_values",
    "value_references",
]
