"""The native back end: C sources, how they are compiled, and where the library is."""

from __future__ import annotations

from pathlib import Path

from .compile import FLAGS, CompileError, compile_library, compiler, equations, sources, suffix

__all__ = ["FLAGS", "CompileError", "compile_library", "compiler", "equations", "native_library", "sources"]


def native_library() -> Path | None:
    """The compiled library of all components; None where the package was never installed."""
    path = Path(__file__).parent / "lib" / f"fanfold{suffix()}"
    return path if path.exists() else None
