"""A scene as one FMU under random calls of FMI 2.0: an answer or a refusal to each, and the same state after it.

    python -m tests.benchmark.faults.random_calls [--calls N] [--seed N] [--library FILE]

Steps of any size, values set and read, commands, states saved, restored and serialised, senseless parameters. A call
that is refused must leave all outputs as they were; a state that is restored must give them back in every bit.
Prints how many calls of each kind there were and how many were refused. `--library`: another build of the library, such
as one with sanitizers, which is then preloaded.
"""

from __future__ import annotations

import shutil
from argparse import ArgumentParser
from collections import Counter
from ctypes import c_void_p
from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy
import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, calloc, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE, free
from fmpy.fmi2 import fmi2CallbackAllocateMemoryTYPE as Allocate
from fmpy.fmi2 import fmi2CallbackFreeMemoryTYPE as Free

import orchestrator as fanfold
from tests.unit.run.as_one.host import latching

STEPS = (1e-4, 1e-3, 1e-2, 0.1, 0.0, -1e-3, np.nan, np.inf)
VALUES = (0.0, 1.0, -1.0, 1e-3, 8.0, 1e6, -1e300, np.nan, np.inf)
MOST_STATES = 4
LONGEST = 3.0
"""Time (s) after which an instance starts anew."""


class Caller:
    """An instance under random calls."""

    def __init__(self, path: Path, library: Path | None, seed: int) -> None:
        self.random = np.random.default_rng(seed)
        self.description = fmpy.read_model_description(str(path))
        folder = Path(str(fmpy.extract(str(path))))
        identifier = self.description.coSimulation.modelIdentifier
        if library is not None:
            shutil.copyfile(library, folder / "binaries" / "linux64" / f"{identifier}.so")
        self.fmu = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=identifier,
            instanceName="wing",
        )
        self.callbacks = fmi2CallbackFunctions(
            fmi2CallbackLoggerTYPE(lambda *said: None), Allocate(calloc), Free(free)
        )
        self.fmu.instantiate(callbacks=self.callbacks)
        self.fmu.dll.fanfoldAcceptNumbers(c_void_p(self.fmu.component))
        variables = self.description.modelVariables
        self.outputs = [v.valueReference for v in variables if v.causality == "output"]
        self.settable = [v.valueReference for v in variables if v.causality != "output"]
        self.states: list[tuple[object, float, np.ndarray]] = []
        self.made: Counter[str] = Counter()
        self.refused: Counter[str] = Counter()
        self.begin()

    def begin(self) -> None:
        """From a reset instance to its start."""
        self.time = 0.0
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def read(self) -> np.ndarray:
        return np.array(self.fmu.getReal(self.outputs))

    def call(self) -> None:
        """One at random."""
        kind = str(
            self.random.choice(["step", "set", "get", "save", "restore", "serialise", "reset"], p=CHANCES)
        )
        self.made[kind] += 1
        before = self.read() if kind in ("step", "set") and self.random.random() < 0.1 else None
        try:
            getattr(self, f"_{kind}")()
        except FMICallException:
            self.refused[kind] += 1
            if before is not None:
                np.testing.assert_array_equal(self.read(), before, err_msg=f"after a refused {kind}")

    def _step(self) -> None:
        h = float(self.random.choice(STEPS))
        self.fmu.doStep(self.time, h)
        self.time += h
        if self.time > LONGEST:
            self._reset()

    def _set(self) -> None:
        reference = int(self.random.choice(self.settable))
        kept = self.fmu.getReal([reference])
        self.fmu.setReal([reference], [float(self.random.choice(VALUES))])
        try:
            self.read()
        except FMICallException:
            self.fmu.setReal([reference], kept)
            raise

    def _get(self) -> None:
        self.read()

    def _save(self) -> None:
        if len(self.states) == MOST_STATES:
            self.fmu.freeFMUstate(self.states.pop(0)[0])
        self.states.append((self.fmu.getFMUstate(), self.time, self.read()))

    def _restore(self) -> None:
        if self.states:
            state, self.time, outputs = self.states[self.random.integers(len(self.states))]
            self.fmu.setFMUstate(state)
            np.testing.assert_array_equal(self.read(), outputs, err_msg="after a state was restored")

    def _serialise(self) -> None:
        if not self.states:
            return
        state, time, outputs = self.states[self.random.integers(len(self.states))]
        data = bytearray(self.fmu.serializeFMUstate(state))
        damaged = self.random.random() < 0.5
        if damaged:
            data[self.random.integers(len(data))] ^= 1 << int(self.random.integers(8))
        found = self.fmu.deSerializeFMUstate(bytes(data))
        assert not damaged, "damaged bytes passed for a state"
        self.fmu.setFMUstate(found)
        self.fmu.freeFMUstate(found)
        self.time = time
        np.testing.assert_array_equal(self.read(), outputs, err_msg="after bytes were read")

    def _reset(self) -> None:
        self.fmu.reset()
        self.begin()


CHANCES = (0.55, 0.15, 0.15, 0.05, 0.05, 0.03, 0.02)


def main() -> None:
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--calls", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--library", type=Path)
    given = parser.parse_args()
    event = {"name": "faster", "time": "0.4 s", "set": {"root": {"motor_constant_torque": "9 N.m"}}}
    with TemporaryDirectory() as folder:
        (path,) = fanfold.export(latching([event]), folder, as_one=True)
        caller = Caller(path, given.library, given.seed)
        for _ in range(given.calls):
            caller.call()
    for kind, count in caller.made.most_common():
        print(f"{kind:10} {count:9} calls, {caller.refused[kind]:7} refused")


if __name__ == "__main__":
    main()
