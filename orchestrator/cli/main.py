"""The `fanfold` command."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from errno import EDQUOT, EFBIG, ENOSPC
from importlib import import_module
from io import TextIOWrapper
from pkgutil import iter_modules
from typing import Any

import click

import orchestrator as fanfold

from ..run.progress import ended_like_ctrl_c
from . import analyse, cache, check, compare, docs, export, listing, plot, report, run, study, tune

_OF_CLICK = (click.ClickException, click.exceptions.Exit, click.Abort)


class _Group(click.Group):
    """Shows every foreseen problem as sentences on standard error, with exit code 1."""

    def invoke(self, ctx: click.Context) -> Any:  # noqa: ANN401 - click's own signature
        """Run a command."""
        try:
            with ended_like_ctrl_c(), _warnings_as_sentences():
                return super().invoke(ctx)
        except (
            BrokenPipeError,
            *_OF_CLICK,
        ):  # nobody reads on, which click ends quietly; or its own refusals
            raise
        except OSError as error:
            problem = _file_problem(error)
        except KeyboardInterrupt:  # outside of a run, which says itself how far it came
            problem = f"{ctx.invoked_subcommand}: interrupted"
        except Exception as error:
            if _was_interrupted(error):
                problem = f"{ctx.invoked_subcommand}: interrupted"
            elif isinstance(error, fanfold.FanfoldError):
                problem = str(error)
            else:
                raise
        for line in problem.splitlines():
            click.echo(f"fanfold: {line}", err=True)
        ctx.exit(1)


def _was_interrupted(error: BaseException | None) -> bool:
    """Whether an interruption caused an error: compiled libraries that are loading raise ImportError for it."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ if isinstance(error, ImportError) else None
    return error is not None


def _file_problem(error: OSError) -> str:
    """The file, or the likely folder, and the error of the operating system."""
    if error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    if error.errno in {ENOSPC, EDQUOT, EFBIG}:
        from tempfile import gettempdir  # takes its time, which no command needs that does not fail

        return f"{error.strerror}: where the command writes, or where files of a run are ({gettempdir()}; see TMPDIR)"
    return str(error)


@contextmanager
def _warnings_as_sentences() -> Iterator[None]:
    """Print warnings of runs as sentences on standard error, every time."""
    with warnings.catch_warnings():
        warnings.filterwarnings("always", category=UserWarning)
        usual = warnings.showwarning

        def tell(message: Warning | str, category: type[Warning], *args: Any, **keywords: Any) -> None:  # noqa: ANN401
            if issubclass(category, fanfold.FanfoldWarning):
                click.echo(f"fanfold: warning: {message}", err=True)
            else:
                usual(message, category, *args, **keywords)

        warnings.showwarning = tell
        yield


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="fanfold")
def main() -> None:
    """Deployable space structures as co-simulations of FMI components."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")  # tables have signs that not every terminal knows


class _Analyses(click.Group):
    """Every module of `orchestrator.cli.analyse` is one analysis; only the one asked for is imported."""

    def invoke(self, ctx: click.Context) -> Any:  # noqa: ANN401 - click's own signature
        """Run an analysis; a FanfoldError says which one was interrupted."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            raise fanfold.FanfoldError(f"analyse {ctx.invoked_subcommand}: interrupted") from None

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of the analyses."""
        found = (module.name for module in iter_modules(analyse.__path__))
        return sorted(name.replace("_", "-") for name in found if not name.startswith("_"))

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of an analysis."""
        if cmd_name not in self.list_commands(ctx):
            return None
        module = import_module(f"{analyse.__name__}.{cmd_name.replace('-', '_')}")
        command: click.Command = module.command
        return command


@main.group("analyse", cls=_Analyses)
def analyse_group() -> None:
    """Analyses of a scene or of a result."""


for _command in (cache, check, compare, docs, export, listing, plot, report, run, study, tune):
    main.add_command(_command.command)
main.add_command(run.resume_command)
main.add_command(report.live_command)
main.add_command(export.body_command)
main.add_command(export.view_command)
