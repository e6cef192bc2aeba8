"""The process that has an FMU: `python -P child.py LIBRARY MEMORY FROM TO PARENT`, numbers of files and of a process.

It runs in Python so that PythonFMUs find the interpreter that they need; no Python stands in the way of a call. Signals
are for the process that asks: this one ends with it.
"""

from __future__ import annotations

import signal
import sys
from ctypes import CDLL, c_int


def main(library: str, memory: str, from_: str, to: str, parent: str) -> int:
    """Serve until there is no more to do; the exit code."""
    for one in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(one, signal.SIG_IGN)
    serve = CDLL(library).isolated_serve
    serve.argtypes = (c_int, c_int, c_int, c_int)
    code: int = serve(int(memory), int(from_), int(to), int(parent))
    return code


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
