"""Steps a web-assembly FMU as `host.c` does, under wasmtime; its resources are a folder that it is given to read."""

from __future__ import annotations

import struct
from pathlib import Path

RESOURCES = "/resources"


def stepped(library: Path, resources: Path, guid: str, task: bytes) -> bytes:
    """What `host.c` writes for a task."""
    from wasmtime import Engine, Linker, Module, Store, WasiConfig

    engine = Engine()
    store, linker = Store(engine), Linker(engine)
    linker.define_wasi()
    configuration = WasiConfig()
    configuration.preopen_dir(str(resources), RESOURCES)
    store.set_wasi(configuration)
    exports = linker.instantiate(store, Module.from_file(engine, str(library))).exports(store)
    memory = exports["memory"]

    def call(name: str, *values: float) -> int:
        return exports[name](store, *values)

    def put(content: bytes) -> int:
        """Where the content is, in the module's memory."""
        place = call("malloc", len(content))
        memory.write(store, content, place)
        return place

    def done(name: str, *values: float) -> None:
        status = call(name, *values)
        assert status == 0, f"{name}: status {status}"

    inputs, outputs, steps = struct.unpack_from("<3i", task)
    references = task[12 : 12 + 4 * (inputs + outputs)]
    (h,) = struct.unpack_from("<d", task, 12 + len(references))
    values = task[20 + len(references) :]
    call("_initialize")
    texts = [put(text.encode() + b"\0") for text in ("one", guid, f"file://{RESOURCES}")]
    callbacks = put(bytes(20))  # functions of the host are optional, of which these are none
    fmu = call("fmi2Instantiate", texts[0], 1, texts[1], texts[2], callbacks, 0, 0)
    assert fmu, "fmi2Instantiate failed"
    done("fanfoldAcceptNumbers", fmu)
    done("fmi2SetupExperiment", fmu, 0, 0.0, 0.0, 0, 0.0)
    done("fmi2EnterInitializationMode", fmu)
    done("fmi2ExitInitializationMode", fmu)
    read, written = put(references[: 4 * inputs]), put(references[4 * inputs :])
    row, found = call("malloc", 8 * inputs), call("malloc", 8 * outputs)
    rows = []
    for step in range(steps):
        memory.write(store, values[8 * inputs * step : 8 * inputs * (step + 1)], row)
        done("fmi2SetReal", fmu, read, inputs, row)
        done("fmi2DoStep", fmu, step * h, h, 1)
        done("fmi2GetReal", fmu, written, outputs, found)
        rows.append(bytes(memory.read(store, found, found + 8 * outputs)))
    call("fmi2FreeInstance", fmu)
    return b"".join(rows)
