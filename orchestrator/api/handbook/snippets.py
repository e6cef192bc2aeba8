"""Pages whose code is run: what they show is what it does."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import chdir, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any, NamedTuple

from components import FanfoldError

from ..warnings import FanfoldWarning

_BLOCK = re.compile(r"^```(python|console|toml)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_FILE = re.compile(r"# (\w+\.toml)\n")
_PROMPT = "$ "
_WIDTH = 100
_MAIN = "from orchestrator.cli.main import main; main()"


class Snippet(NamedTuple):
    """A block of a page that is run: Python, commands after a `$`, or a file that begins with its name."""

    kind: str
    text: str
    start: int
    end: int


def snippets(page: str) -> Iterator[Snippet]:
    """The blocks of a page in order."""
    return (Snippet(found[1], found[2], *found.span()) for found in _BLOCK.finditer(page))


def command_output(arguments: str) -> str:
    """What a command of `fanfold` prints, of a process of its own; FanfoldError where it fails."""
    environment = {**os.environ, "COLUMNS": str(_WIDTH), "NO_COLOR": "1"}
    run = subprocess.run(
        [sys.executable, "-c", _MAIN, *shlex.split(arguments)],
        capture_output=True, text=True, encoding="utf-8", env=environment,
    )  # fmt: skip
    if run.returncode != 0:
        raise FanfoldError(f"fanfold {arguments}: {run.stderr or run.stdout}")
    return run.stdout


def run_page(page: str, folder: Path, name: str, command: Callable[[str], str] = command_output) -> str:
    """Run all blocks of a page in order in a folder; the page with the output of commands below them.

    command: runs `fanfold` with arguments and returns its output. Its exceptions, and those of Python blocks, pass on.
    """
    values: dict[str, Any] = {}
    parts, done = [], 0
    with chdir(folder):
        for snippet in snippets(page):
            shown = page[snippet.start : snippet.end]
            if snippet.kind == "python":
                shown += _printed(snippet.text, name, values)
            elif snippet.kind == "console":
                shown = f"```console\n{_told(snippet.text, command)}```"
            elif (file := _FILE.match(snippet.text)) is not None:
                Path(file[1]).write_text(snippet.text, encoding="utf-8")
            parts += [page[done : snippet.start], shown]
            done = snippet.end
    return "".join(parts) + page[done:]


def _printed(text: str, name: str, values: dict[str, Any]) -> str:
    """What Python prints, as a block below it; warnings about runs are not the page's."""
    told = StringIO()
    with redirect_stdout(told), warnings.catch_warnings():
        warnings.simplefilter("ignore", FanfoldWarning)
        exec(compile(text, name, "exec"), values)
    return f"\n\n```text\n{told.getvalue().rstrip()}\n```" if told.getvalue() else ""


def _told(commands: str, command: Callable[[str], str]) -> str:
    """Commands, each followed by what it printed; those of other programs are shown only."""
    lines = []
    for line in commands.splitlines():
        lines.append(line)
        if line.startswith(f"{_PROMPT}fanfold "):
            lines += [one.rstrip() for one in command(line.removeprefix(f"{_PROMPT}fanfold ")).splitlines()]
    return "\n".join(lines) + "\n"
