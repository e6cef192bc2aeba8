"""One folder for the temporary files of a process; what a killed process left is removed by the next one."""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path

from .disk import users_folder
from .locks import AVAILABLE, hold, is_held

_PREFIX = "process-"


def process_folder() -> Path:
    """The folder of this process, made when first asked for and gone when the process ends."""
    return _folder_of(os.getpid())


@cache
def _folder_of(process: int) -> Path:
    parent = users_folder() or Path(tempfile.gettempdir())
    with suppress(OSError):  # without locks nobody knows what is abandoned
        guard = hold(parent)  # nobody looks between the making of a folder and its lock
        try:
            _remove_abandoned(parent)
            return _made(parent, process, locked=True)
        finally:
            os.close(guard)
    return _made(parent, process, locked=False)


def _made(parent: Path, process: int, *, locked: bool) -> Path:
    folder = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=parent))
    if locked:
        hold(folder)  # as long as the process lives
    atexit.register(_remove, folder, process)
    return folder


def _remove_abandoned(parent: Path) -> None:
    """Remove folders whose process has ended without doing so."""
    for folder in parent.glob(f"{_PREFIX}*"):
        with suppress(OSError):
            if AVAILABLE and not is_held(folder):
                shutil.rmtree(folder, ignore_errors=True)


def _remove(folder: Path, process: int) -> None:
    """Remove the folder of a process, but not from a fork of it."""
    if os.getpid() == process:
        shutil.rmtree(folder, ignore_errors=True)
