"""Places of exported files: refused before any work where nothing can be written, and never left half written."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any

from ...results.result import Result, ResultError, reason

ENDINGS = {"glb": ".glb", "vtu": ".pvd", "csv": ".csv", "mat": ".mat"}
"""Formats, and how their files end."""


def format_of(path: Path, asked: str | None) -> str:
    """The format that is asked for, or that the ending of a file means; ResultError where there is none."""
    known = ", ".join(f"{name} ({ending})" for name, ending in ENDINGS.items())
    if asked is not None and asked not in ENDINGS:
        raise ResultError(
            f"there is no format {asked!r}; formats, with the endings of their files, are {known}"
        )
    meant = next((name for name, ending in ENDINGS.items() if path.suffix.lower() == ending), None)
    if meant is None and asked is None:
        raise ResultError(
            f"{path}: its suffix is of no known format; formats with their suffixes are {known}"
        )
    if asked is not None and meant != asked:
        series = ", which opens the series of VTU files next to it" if asked == "vtu" else ""
        raise ResultError(f"{path}: a file of the format {asked} ends with {ENDINGS[asked]}{series}")
    return str(meant)


def refuse_to_lose(result: Result, path: Path, replace: bool) -> None:
    """ResultError where a file cannot be, or would be lost: the result itself, what is no file, any without leave."""
    try:
        if not path.exists():
            if not path.parent.is_dir():
                raise ResultError(f"{path}: there is no folder {path.parent}; make it, or name another")
            return
        if result.path is not None and result.path.exists() and path.samefile(result.path):
            raise ResultError(f"{path}: this is the result itself and would be lost; name another file")
        if not path.is_file():
            raise ResultError(f"{path}: this is not a file that can be written; name another")
    except OSError as error:
        raise ResultError(f"{path}: nothing can be written here ({reason(error)})") from None
    if not replace:
        raise ResultError(
            f"{path}: this file exists already; name another, or allow it with --replace (replace=True)"
        )


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """A place beside a file, which takes its name once all of it is written; ResultError where it cannot be."""
    part = path.with_name(f"{path.name}.part")
    try:
        yield part
        part.replace(path)
    except OSError as error:
        raise ResultError(f"{path}: the file cannot be written ({reason(error)})") from None
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def library(name: str, what: str) -> Any:  # noqa: ANN401 - optional libraries without types
    """A library of the extra `viewers`; ResultError where it is missing. what: is written with it."""
    try:
        return import_module(name)
    except ImportError:
        raise ResultError(
            f"{what} needs {name}; install fanfold with its extra: pip install 'fanfold[viewers]'"
        ) from None
