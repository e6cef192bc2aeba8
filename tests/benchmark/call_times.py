"""Time of every native FMU of a scene call by call, measured inside C with the portable flags of the build.

python -m tests.benchmark.call_times [SCENE]
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import NamedTuple

from fmpy import read_model_description

from components import REGISTRY
from fmus import build_fmu
from fmus.native import FLAGS, compiler, sources
from orchestrator.assembly import Part
from orchestrator.assembly.assemble import assemble
from orchestrator.scene import find_scene, load_scene

PROGRAM = Path(__file__).with_name("call_times.c")
ROUNDS, CALLS = 20, 2000


class Times(NamedTuple):
    """Nanoseconds a call."""

    step: float
    outputs: float
    set: float
    restore: float
    derivative: float


def build(folder: Path) -> Path:
    """The timing program with all native sources, compiled like the library."""
    for name, text in {**sources(), PROGRAM.name: PROGRAM.read_text(encoding="utf-8")}.items():
        (folder / name).write_text(text, encoding="utf-8")
    program = folder / "program"
    subprocess.run(
        [*(compiler() or ()), *FLAGS, *map(str, folder.glob("*.c")), "-o", str(program), "-lm"], check=True
    )
    return program


def measure(program: Path, part: Part, folder: Path) -> Times:
    """Times of one part of a scene."""
    component = REGISTRY[part.kind](**part.structure)
    path = build_fmu(component, part.name, folder, part.start, "native")
    unpacked = folder / part.name
    with zipfile.ZipFile(path) as archive:
        archive.extractall(unpacked)
    sizes = [str(layout.size) for layout in component.layouts[:3]]
    token = read_model_description(str(path), validate=False).guid
    command = [str(program), str(ROUNDS), str(CALLS), *sizes, token, (unpacked / "resources").as_uri()]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    return Times(*map(float, run.stdout.split()))


def describe(part: Part) -> str:
    """Kind, modes and ports."""
    component = REGISTRY[part.kind](**part.structure)
    modes = getattr(component, "modes", None)
    return f"{part.kind}, {len(component.ports)} ports" + ("" if modes is None else f", {modes} modes")


def main(arguments: list[str]) -> None:
    """Print the table."""
    scene = load_scene(find_scene(arguments[0] if arguments else "amos3"))
    print("microseconds a call, best of rounds, inside C")
    print(f"{'FMU':<12} {'what':<36} " + " ".join(f"{name:>10}" for name in Times._fields))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        program = build(folder)
        for part in assemble(scene).parts:
            times = measure(program, part, folder)
            print(f"{part.name:<12} {describe(part):<36} " + " ".join(f"{1e-3 * t:10.3f}" for t in times))


if __name__ == "__main__":
    main(sys.argv[1:])
