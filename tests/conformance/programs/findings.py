"""The checks of a program, and what they find."""

from __future__ import annotations


def checks_of(names):
    """Functions whose name begins with check_, by the rest of it."""
    return {
        name.removeprefix("check_"): function for name, function in names.items() if name.startswith("check_")
    }


def finding(function, *args):
    """The error that a check ends with, empty where all is well."""
    try:
        function(*args)
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return ""
