"""A panel and a hinge on every platform that something here runs, against the library that was compiled here.

    python -m tests.benchmark.platforms

Needs the extra `platforms`; Wine for win64, qemu-user and libc6-arm64-cross for aarch64-linux, wasmtime for wasm32.
What is missing is told, and its platform left out. Differences are the largest of any output at any of 2,000 steps,
beside the largest magnitude of that output or, of a vector, of its components.
"""

from __future__ import annotations

import os
import shutil
import struct
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import numpy as np
from fmpy import extract, read_model_description

import orchestrator as fanfold
from components.contract.component import Vector
from fmus import PLATFORMS
from fmus.native.compile import ZIG, compile_files
from tests.benchmark.platforms import wasm
from tests.unit.run.as_one.host import latching

STEPS, STEP = 2000, 1e-3
"""Communication steps and their size (s)."""
FMUS = {"panel": "body", "hinge_left": "hinge", "latching": "scene"}
SYSROOT = Path("/usr/aarch64-linux-gnu")
HOST = Path(__file__).with_name("host.c")
HERE = "here"


class Case(NamedTuple):
    """An FMU that was extracted, and what it is to do: names of its outputs, inputs by step.

    alike: of each output, those that it is of one size with: its vector, or in a scene what has its unit.
    """

    folder: Path
    guid: str
    outputs: tuple[str, ...]
    alike: tuple[str, ...]
    task: bytes


def missing(platform: str) -> str:
    """Why a platform cannot be tried here; empty where it can."""
    if platform == "linux64":
        return "" if sys.platform == "linux" else "this is no Linux"
    if platform == "win64":
        return "" if shutil.which("wine") else "there is no Wine"
    if platform == "aarch64-linux":
        if not shutil.which("qemu-aarch64"):
            return "there is no qemu-aarch64 (qemu-user)"
        return "" if SYSROOT.exists() else f"there is no {SYSROOT} (libc6-arm64-cross)"
    if platform == "wasm32":
        return "" if find_spec("wasmtime") else "there is no wasmtime (pip install wasmtime)"
    return "nothing here runs it"


def inputs(kind: str, names: Sequence[str], start: Vector) -> Vector:
    """By step: loads that swing at the ports of a body, and bodies that turn about the hinge line."""
    time = STEP * np.arange(1, STEPS + 1)[:, None]
    rows = np.tile(start, (STEPS, 1))
    if kind == "scene":
        return rows
    if kind == "body":
        swinging = np.array(["slope" not in name for name in names])
        rows[:, swinging] += np.sin(time * (3.0 + np.arange(swinging.sum())))
        return rows
    place = {name: k for k, name in enumerate(names)}
    angle, rate = 0.5 * np.sin(2.0 * time[:, 0]), np.cos(2.0 * time[:, 0])
    turned = [place[f"outboard.orientation[{k}]"] for k in (1, 2, 3, 4)]
    w, x, y, z = start[turned]
    c, s = np.cos(0.5 * angle), np.sin(0.5 * angle)
    quaternion = np.column_stack((c * w - s * y, c * x + s * z, c * y + s * w, c * z - s * x))
    quaternion += 1e-4 * np.sin(time * (3.0, 4.0, 5.0, 6.0))  # so that its bushings carry loads
    rows[:, turned] = quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)
    rows[:, [place[f"outboard.position[{k}]"] for k in (1, 2, 3)]] += 1e-4 * np.sin(time * (7.0, 8.0, 9.0))
    rows[:, place["outboard.angular_velocity[2]"]] = rate
    return rows


def case(path: Path, kind: str) -> Case:
    """The task of an FMU."""
    description = read_model_description(str(path))
    read = [one for one in description.modelVariables if one.causality == "input"]
    written = [one for one in description.modelVariables if one.causality == "output"]
    start = np.array([float(one.start) for one in read])
    rows = inputs(kind, [one.name for one in read], start)
    sizes = struct.pack("<3i", len(read), len(written), STEPS)
    references = np.array([one.valueReference for one in [*read, *written]], dtype="<u4").tobytes()
    task = sizes + references + struct.pack("<d", STEP) + rows.astype("<f8").tobytes()
    names = tuple(one.name for one in written)
    alike = [one.unit or "" if kind == "scene" else one.name.partition("[")[0] for one in written]
    return Case(Path(extract(str(path))), description.guid, names, tuple(alike), task)


def command(platform: str, folder: Path) -> list[str]:
    """The host of a platform, compiled for it, with what runs it here."""
    host = folder / f"host-{platform}{'.exe' if platform == 'win64' else ''}"
    target = PLATFORMS["linux64" if platform == HERE else platform].target
    compiler = [*ZIG, "-target", target]
    compile_files([HOST], host, ["-O2"], compiler, ["-s"])
    runner = {"win64": ["wine"], "aarch64-linux": ["qemu-aarch64", "-L", str(SYSROOT)]}
    return [*runner.get(platform, []), str(host)]


def stepped(platform: str, one: Case, folder: Path, host: Sequence[str]) -> Vector:
    """Outputs (steps, outputs)."""
    resources = one.folder / "resources"
    chosen = PLATFORMS["linux64" if platform == HERE else platform]
    (library,) = (one.folder / "binaries" / chosen.folder2).glob(f"*{chosen.suffix}")
    if platform == "wasm32":
        result = wasm.stepped(library, resources, one.guid, one.task)
    else:
        task, written = folder / "task", folder / "result"
        task.write_bytes(one.task)
        drive = "/Z:" if platform == "win64" else ""
        uri = f"file://{drive}{resources}"
        quiet = {**os.environ, "WINEDEBUG": "-all"}
        words = [*host, str(library), uri, one.guid, str(task), str(written)]
        run = subprocess.run(words, env=quiet, capture_output=True, text=True, check=False)
        if run.returncode:
            sys.exit(f"{platform}: {run.stderr}")
        result = written.read_bytes()
    return np.frombuffer(result, dtype="<f8").reshape(STEPS, len(one.outputs))


def sizes(one: Case, values: Vector) -> Vector:
    """Largest magnitude of each output (outputs,) and of those alike."""
    largest: dict[str, float] = {}
    for group, size in zip(one.alike, np.abs(values).max(axis=0), strict=True):
        largest[group] = max(largest.get(group, 1e-300), size)
    return np.array([largest[group] for group in one.alike])


def main() -> None:
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        fanfold.export("workbench", folder / HERE)
        fanfold.export(latching(), folder / HERE, as_one=True)
        fanfold.export(
            "workbench", folder / "all", platforms="all", watch=lambda name: print(f"library: {name}")
        )
        fanfold.export(latching(), folder / "all", as_one=True, platforms="all")
        here = {name: case(folder / HERE / f"{name}.fmu", kind) for name, kind in FMUS.items()}
        reference = {name: stepped(HERE, one, folder, command(HERE, folder)) for name, one in here.items()}
        print(f"{'platform':16}{'FMU':12}{'largest difference':>20}  in")
        for platform in PLATFORMS:
            if reason := missing(platform):
                print(f"{platform:16}left out: {reason}")
                continue
            host = [] if platform == "wasm32" else command(platform, folder)
            for name, kind in FMUS.items():
                one = case(folder / "all" / f"{name}.fmu", kind)
                found = stepped(platform, one, folder, host)
                differences = np.abs(found - reference[name]).max(axis=0) / sizes(one, reference[name])
                worst = int(np.argmax(differences))
                told = f"{differences[worst]:.1e}" if differences[worst] else "equal in every bit"
                print(f"{platform:16}{name:12}{told:>20}  {one.outputs[worst] if differences[worst] else ''}")


main()
