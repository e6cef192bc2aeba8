"""What commands say beside their results."""

from __future__ import annotations

import click

from fmus import Backend, native_library


def tell_of_python(backend: Backend | None) -> None:
    """Warn where nothing was said of a back end and there is no native one."""
    if backend is None and native_library() is None:
        warn("no native library was built at installation; PythonFMUs are used, which are slower")


def warn(sentence: str) -> None:
    """A warning on standard error."""
    click.echo(f"fanfold: warning: {sentence}", err=True)
