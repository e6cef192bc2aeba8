"""A C host and all native sources as one program under AddressSanitizer and UndefinedBehaviorSanitizer."""

from __future__ import annotations

import subprocess

import pytest

from fmus.native import FLAGS, compiler, sources

SANITIZERS = ("-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")


def program(host, folder):
    """The path of the program made of the host's source file; skips the test where there are no sanitizers."""
    own = {path.name: path.read_text(encoding="utf-8") for path in (host, *host.parent.glob("*.h"))}
    for name, text in {**sources(), **own}.items():
        (folder / name).write_text(text, encoding="utf-8")
    flags = [flag for flag in FLAGS if not flag.startswith(("-O", "-fvisibility"))]
    made = folder / host.stem
    command = [*compiler(), *flags, *SANITIZERS, *map(str, folder.glob("*.c")), "-o", str(made), "-lm"]
    run = subprocess.run(command, capture_output=True, text=True)
    if "cannot find" in run.stderr and "san" in run.stderr:
        pytest.skip("the compiler has no sanitizers")
    assert run.returncode == 0, run.stderr[-2000:]
    return made


def told(host, *arguments):
    """Numbers of instances that the program made, and of messages that they gave."""
    run = subprocess.run([host, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stdout + run.stderr[-3000:]
    made, _, messages, _ = run.stdout.split()
    return int(made), int(messages)
