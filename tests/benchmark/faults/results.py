"""Does every reader of results answer damage with a sentence? Results are tampered with by seed, and read.

    python -m tests.benchmark.faults.results [COUNT] [FIRST_SEED]

Half of them have flipped bits anywhere, half have a part replaced by something of another kind, shape or meaning. Each
goes through a command of the command line; whatever is no sentence is printed with its seed, and the exit code is 1.
"""

from __future__ import annotations

import random
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from time import process_time
from typing import Any

import h5py
import numpy as np
from click.testing import CliRunner

from orchestrator.cli.main import main as command_line
from tests.benchmark.faults.listing import Fault, main
from tests.references import synthetic_result

SLOWEST = 60.0
"""s of processor time; a reader that takes longer hangs."""
Dice = random.Random


def faults(count: int, first: int, folder: Path) -> Iterator[Fault]:
    """Faults of so many tampered results."""
    sound = synthetic_result.write(folder / "sound.h5")
    for seed in range(first, first + count):
        dice = random.Random(seed)
        tampered = folder / "tampered.h5"
        (flipped if dice.random() < 0.5 else altered)(dice, sound, tampered)
        command = dice.choice(_COMMANDS)(str(tampered), str(sound), str(folder / "out"))
        start = process_time()
        what = answer(command)
        if process_time() - start > SLOWEST:
            what = f"took {process_time() - start:.0f} s of processor time"
        if what:
            yield Fault(seed, f"{command[0]}: {what}")


def answer(command: list[str]) -> str:
    """What went wrong with the answer of a command: an exception, or a terminal escape; empty for a good one."""
    run = CliRunner().invoke(command_line, command)
    if run.exception is not None and not isinstance(run.exception, SystemExit):
        return "".join(traceback.format_exception(run.exception)[-2:])
    return "a terminal escape" if "\x1b" in run.output else ""


_COMMANDS: tuple[Callable[[str, str, str], list[str]], ...] = (
    lambda bad, good, out: ["plot", bad],
    lambda bad, good, out: ["report", bad, "--frames", "2"],
    lambda bad, good, out: ["compare", bad, good, "--output", out],
    lambda bad, good, out: ["compare", good, bad, "--output", out],
    lambda bad, good, out: ["analyse", "impact", bad],
    lambda bad, good, out: ["analyse", "stress", bad, "--body", "panel1", "--output", out],
)


def flipped(dice: Dice, sound: Path, path: Path) -> None:
    """One to five hundred flipped bits, half of them where HDF5 keeps its structure."""
    content = bytearray(sound.read_bytes())
    for _ in range(dice.choice((1, 1, 5, 50, 500))):
        reach = len(content) if dice.random() < 0.5 else min(len(content), 60_000)
        content[dice.randrange(reach)] ^= 1 << dice.randrange(8)
    path.write_bytes(bytes(content))


def altered(dice: Dice, sound: Path, path: Path) -> None:
    """A part of the file replaced by something else."""
    path.write_bytes(sound.read_bytes())
    with h5py.File(path, "r+") as file:
        for _ in range(dice.choice((1, 1, 3))):
            place = dice.choice(_places(file))
            _alter(dice, file, place)


def _places(file: Any) -> list[str]:
    found: list[str] = []
    file.visit(found.append)
    return found


def _alter(dice: Dice, file: Any, place: str) -> None:
    item = file.get(place)
    if item is None:
        return
    kind = dice.randrange(4)
    if kind == 0:
        del file[place]
    elif kind == 1:
        parent, _, name = place.rpartition("/")
        file.move(place, f"{parent}/{dice.choice(_NAMES)}{name}")
    elif kind == 2 and item.attrs:
        item.attrs[dice.choice(list(item.attrs))] = dice.choice(_VALUES)
    elif isinstance(item, h5py.Dataset) and item.dtype.kind == "f" and item.size and dice.random() < 0.5:
        values = item[...]
        values.flat[dice.randrange(values.size)] = dice.choice((np.nan, np.inf, -1e200, 1e9, -1e-300))
        item[...] = values
    else:
        del file[place]
        file[place] = dice.choice(_VALUES)


_NAMES = ("[/bold]", "\x1b[31m", "<b>", "$\\frac{", "{}", " ", "é", "x" * 300)
_VALUES: tuple[Any, ...] = (
    np.nan, np.inf, 0.0, -1, 1e308, "", "[/bold]", "\x1b[2J", "null", "[]", "{}", "[" * 5000, '[{"name": 1}]',
    np.bytes_(b"a\0b"), np.zeros(0), np.zeros((3, 3)), np.full(50, np.nan), np.full((2000, 4), 1e308),
    np.arange(10.0)[::-1], np.ones((5, 3, 2)), np.array([1 + 2j] * 9), np.array([b"a", b"b"]),
    np.array([[10**6] * 4]), np.array([True] * 4),
)  # fmt: skip


if __name__ == "__main__":
    main(faults, "tampered results", 300)
