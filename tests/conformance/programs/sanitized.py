"""A C host and all native sources as one program under AddressSanitizer and UndefinedBehaviorSanitizer."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from components.cache.locks import hold
from fmus.native import FLAGS, compiler, sources
from fmus.native.compile import suffix

SANITIZERS = (
    "-g1",
    "-O0",
    "-fsanitize=address,undefined",
    "-fno-sanitize=null",
    "-fno-sanitize-recover=all",
    "-fsanitize-undefined-trap-on-error",
)
"""Without optimization, which takes four times as long and may remove what they would find.

Undefined behaviour ends the program by a signal, as its sentences take a fifth of the compiler's time: a debugger
tells where. Accesses by a null pointer are AddressSanitizer's, with line numbers.
"""


def objects(temporary):
    """The folder of all native sources, compiled once a session; skips the test where there are no sanitizers.

    temporary: pytest's factory of folders.
    """
    shared = _shared_folder(temporary) / "sanitized"
    shared.mkdir(exist_ok=True)
    lock = hold(shared)
    try:
        if not list(shared.glob("*.o")):
            for name, text in sources().items():
                (shared / name).write_text(text, encoding="utf-8")
            _compile(["-c", *(path.name for path in shared.glob("*.c"))], shared)
    finally:
        os.close(lock)
    return shared


def program(host, temporary):
    """The path of the program made of the host's source file and all native sources."""
    shared = objects(temporary)
    made = temporary.mktemp("host") / host.stem
    _compile(
        [str(host), f"-I{host.parent}", f"-I{shared}", *map(str, shared.glob("*.o")), "-o", str(made), "-lm"],
        shared,
    )
    return made


def library(temporary):
    """The path of the library of all native sources."""
    shared = objects(temporary)
    made = temporary.mktemp("library") / f"fanfold{suffix()}"
    _compile(["-shared", *map(str, shared.glob("*.o")), "-o", str(made), "-lm"], shared)
    return made


def _shared_folder(temporary) -> Path:
    """That of the session, the parent of its workers' where there are some."""
    own = temporary.getbasetemp()
    return own.parent if "PYTEST_XDIST_WORKER" in os.environ else own


def flags():
    """What the compiler is told, with the sanitizers."""
    return (*(flag for flag in FLAGS if not flag.startswith(("-O", "-fvisibility", "-shared"))), *SANITIZERS)


def sanitizer():
    """The compiler; skips the test where it is none or Zig, which ignores AddressSanitizer."""
    found = compiler()
    if found is None or "ziglang" in found:
        pytest.skip("there is no C compiler that has AddressSanitizer")
    return found


def runtime():
    """Libraries that a program without sanitizers preloads for a library with them; skips the test where none are."""
    names = ["libasan.so", "libubsan.so"]
    told = [
        subprocess.run(
            [*sanitizer(), f"-print-file-name={name}"], capture_output=True, text=True
        ).stdout.strip()
        for name in names
    ]
    if not all(map(os.path.isabs, told)):
        pytest.skip("the compiler has no sanitizers as shared libraries")
    return " ".join(told)


def _compile(arguments, folder):
    command = [*sanitizer(), *flags(), *arguments]
    run = subprocess.run(command, capture_output=True, text=True, cwd=folder)
    if "cannot find" in run.stderr and "san" in run.stderr:
        pytest.skip("the compiler has no sanitizers")
    assert run.returncode == 0, run.stderr[-2000:]


def told(host, *arguments):
    """Numbers of instances that the program made, and of messages that they gave."""
    run = subprocess.run([host, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stdout + run.stderr[-3000:]
    made, _, messages, _ = run.stdout.split()
    return int(made), int(messages)
