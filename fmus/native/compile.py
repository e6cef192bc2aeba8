"""Compile the native core and all equations files into the one binary that every native FMU carries.

Every `kernels/NAME.c` is the equations of one component and defines `NAME_kernel`. It is compiled
twice, for plain numbers and for numbers that carry a derivative (`real.h`); the second unit and the list of
kernels are written here, so a new component needs its own file only. Imports nothing of the project, because
the build hook runs before anything is installed.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache, partial
from importlib.util import find_spec
from pathlib import Path

HERE = Path(__file__).parent
FLAGS = (
    "-std=c99",
    "-O3",
    "-fPIC",
    "-fvisibility=hidden",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-fcx-limited-range",  # complex numbers carry derivatives here and are never infinite by design
    "-Werror=incompatible-pointer-types",  # a plain state is no state that carries a derivative
    "-Werror=implicit-function-declaration",
)
LINK_FLAGS = ("-s", "-shared")
"""A library that FMUs carry has no names but those that hosts call."""
ASSEMBLY = "assembly"
"""Kind of a scene with its master as one component: its kernel, in `coupling`, drives those of the others."""
ZIG = (sys.executable, "-m", "ziglang", "cc")
"""Zig's C compiler, which the Python package `ziglang` contains."""
_PROBE = "#include <math.h>\ndouble probe(double x) { return sin(x); }\n"


class CompileError(Exception):
    """The compiler is missing or refused: a sentence."""


@cache
def equations() -> tuple[str, ...]:
    """Names of the components that have a native kernel."""
    return tuple(sorted(path.stem for path in (HERE / "kernels").glob("*.c")))


def sources() -> dict[str, str]:
    """Every source and header by its file name, the generated ones included; compiling every .c makes the library.

    They include each other by file name only, which is unique over all folders here, so that an FMU can carry them
    in one folder.
    """
    files = {path.name: path for path in HERE.rglob("*.[ch]")}
    texts = {name: path.read_text(encoding="utf-8") for name, path in sorted(files.items())}
    names = equations()
    for name in names:
        texts[f"{name}_derivative.c"] = f'#define FANFOLD_COMPLEX\n#include "{name}.c"\n'
    made = [*names, ASSEMBLY]
    listed = ", ".join(f"&{name}_kernel" for name in made)
    declared = "".join(f"extern const Kernel {name}_kernel;\n" for name in made)
    texts["kernels.c"] = (
        f'#include "kernel.h"\n\n{declared}\nconst Kernel *const kernels[] = {{{listed}}};\n'
        f"const size_t kernel_count = {len(made)};\n"
    )
    return texts


def suffix() -> str:
    """File name suffix of shared libraries here."""
    return {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def compiler() -> list[str] | None:
    """The C compiler with its arguments; None where there is none.

    It is what CC names, else the first of cc, gcc and clang that works, else Zig where `ziglang` is installed. Zig
    compiles for every processor of this architecture, as the others do, because FMUs carry the library elsewhere.
    """
    chosen = shlex.split(os.environ.get("CC", ""))
    if chosen:
        return chosen
    paths = filter(None, map(shutil.which, ("cc", "gcc", "clang")))
    working = next(filter(_works, paths), None)
    if working is not None:
        return [working]
    return [*ZIG, "-mcpu=baseline"] if find_spec("ziglang") else None


@cache
def _works(path: str) -> bool:
    """Whether a compiler makes a library; without developer tools macOS has one that does not."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "probe.c"
        source.write_text(_PROBE, encoding="utf-8")
        try:
            compile_files([source], source.with_suffix(suffix()), FLAGS, [path], LINK_FLAGS)
        except CompileError:
            return False
    return True


def compile_files(
    names: Sequence[Path],
    target: Path,
    flags: Sequence[str] = FLAGS,
    command: Sequence[str] | None = None,
    link_flags: Sequence[str] = ("-shared",),
) -> None:
    """Compile C files, one on each core at a time, into a shared library; CompileError with what the compiler said.

    command: the compiler with its arguments, by default what `compiler` finds.
    """
    found = list(command) if command is not None else compiler()
    if found is None:
        raise CompileError("there is no C compiler: install cc, gcc or clang, or Zig (pip install ziglang)")
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent) as folder:
        made = Path(folder) / target.name
        objects = [str(Path(folder) / f"{number}.o") for number in range(len(names))]
        run = partial(_run, found)
        pairs = zip(names, objects, strict=True)
        compilations = [[*flags, "-c", str(name), "-o", made_of_it] for name, made_of_it in pairs]
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(run, compilations))  # the list raises what a compilation has raised
        run([*flags, *link_flags, *objects, "-o", str(made), "-lm"])
        os.replace(made, target)


def _run(compiler: Sequence[str], arguments: Sequence[str]) -> None:
    command = [*compiler, *arguments]
    try:
        run = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise CompileError(f"{compiler[0]} cannot be run: {error}") from None
    if run.returncode:
        raise CompileError(f"{shlex.join(compiler)} failed: {run.stderr.strip()[-2000:]}")


def compile_library(
    target: Path,
    flags: Sequence[str] = FLAGS,
    command: Sequence[str] | None = None,
    link_flags: Sequence[str] = LINK_FLAGS,
) -> None:
    """Compile the library of all components to `target`; CompileError where that is impossible."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in sources().items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        compile_files(sorted(Path(folder).glob("*.c")), target, flags, command, link_flags)
