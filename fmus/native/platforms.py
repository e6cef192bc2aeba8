"""The library of all components for other platforms than this one, cross-compiled by Zig's C compiler."""

from __future__ import annotations

import hashlib
import struct
import tempfile
from collections.abc import Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import NamedTuple

from components.cache.disk import kept

from ..description.choices import FmiVersion
from .compile import FLAGS, LINK_FLAGS, ZIG, CompileError, compile_library, sources


class Platform(NamedTuple):
    """What a platform is called, and how its library is made.

    folder2: among the binaries of FMI 2.0 (section 2.3), which has names for processors of type x86 only and none for
    others; there, and for web assembly, the tuple of architecture and system of FMI 3.0 (section 2.5.1.4.1), folder3.
    target: of Zig, with the oldest C library that it runs with. processor: of Zig; empty for the oldest one.
    """

    folder2: str
    folder3: str
    target: str
    suffix: str
    link_flags: tuple[str, ...] = LINK_FLAGS
    processor: str = ""


_REACTOR = ("-s", "-mexec-model=reactor", "-Wl,--export-dynamic,--export=malloc,--export=free")
"""A module that is called and has no end of its own; hosts put what they pass into memory that they ask it for."""
_VECTORS = "generic+simd128"
"""All hosts of web assembly since 2021 have its vector instructions, with which a wing takes two thirds of the time."""
PLATFORMS = {
    "linux64": Platform("linux64", "x86_64-linux", "x86_64-linux-gnu.2.17", ".so"),
    "aarch64-linux": Platform("aarch64-linux", "aarch64-linux", "aarch64-linux-gnu.2.17", ".so"),
    "win64": Platform("win64", "x86_64-windows", "x86_64-windows-gnu", ".dll"),
    "darwin64": Platform("darwin64", "x86_64-darwin", "x86_64-macos.11.0", ".dylib"),
    "aarch64-darwin": Platform("darwin64", "aarch64-darwin", "aarch64-macos.11.0", ".dylib"),
    "wasm32": Platform("wasm32-wasi", "wasm32-wasi", "wasm32-wasi", ".wasm", _REACTOR, _VECTORS),
}
_UNIVERSAL, _ALIGNMENT = 0xCAFEBABE, 14
"""Mark of a Mach-O file for several processors, and the power of two that its parts start at multiples of."""


def libraries(names: Sequence[str], fmi: FmiVersion) -> dict[str, bytes]:
    """Libraries of platforms by the folder and suffix that they have in an FMU, such as `win64/*.dll`.

    Of FMI 2.0 both processors of macOS share a folder, and so one universal file.
    """
    found: dict[str, list[bytes]] = {}
    for name in dict.fromkeys(names):
        library = cross_compiled(name)
        one = PLATFORMS[name]
        folder = one.folder3 if fmi == "3.0" else one.folder2
        found.setdefault(f"{folder}/*{one.suffix}", []).append(library)
    return {path: files[0] if len(files) == 1 else universal(files) for path, files in found.items()}


@cache
def cross_compiled(name: str) -> bytes:
    """The library of a platform, from the cache where these sources have been compiled before.

    CompileError where there is no such platform, or no Zig (the extra `platforms`).
    """
    if name not in PLATFORMS:
        raise CompileError(f"there is no platform {name!r}; there are {', '.join(PLATFORMS)}")
    try:
        zig = version("ziglang")
    except PackageNotFoundError:
        raise CompileError("compiling for other platforms needs Zig: pip install '.[platforms]'") from None
    platform = PLATFORMS[name]
    texts = sources()
    said = [
        zig,
        platform.target,
        *FLAGS,
        *platform.link_flags,
        platform.processor,
        *(part for item in texts.items() for part in item),
    ]
    return kept("library", hashlib.sha256("\0".join(said).encode()).hexdigest(), lambda: _compiled(platform))


def _compiled(platform: Platform) -> bytes:
    command = [*ZIG, "-target", platform.target]
    if platform.processor:
        command.append(f"-mcpu={platform.processor}")
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / f"fanfold{platform.suffix}"
        compile_library(target, FLAGS, command, platform.link_flags)
        return target.read_bytes()


def universal(files: Sequence[bytes]) -> bytes:
    """Mach-O libraries of several processors as one file (Apple's `fat.h`); each of them starts with its processor."""
    size = 1 << _ALIGNMENT
    header = struct.pack(">II", _UNIVERSAL, len(files))
    offset, parts = size, b""
    for file in files:
        _, processor, kind = struct.unpack_from("<III", file)
        header += struct.pack(">IIIII", processor, kind, offset + len(parts), len(file), _ALIGNMENT)
        parts += file + bytes(-len(file) % size)
    return header.ljust(size, b"\0") + parts
