"""Libraries for other platforms: where they are in an FMU, what refuses, and one that is loaded here."""

import struct
import sys
import zipfile
from importlib.metadata import PackageNotFoundError
from importlib.util import find_spec

import numpy as np
import pytest
from fmpy import simulate_fmu, supported_platforms

import orchestrator as fanfold
from components import REGISTRY, ComponentError
from fmus import PLATFORMS, build_fmu
from fmus.native import platforms

X86, ARM = 0x01000007, 0x0100000C
"""Processors as Mach-O counts them."""


def mach_o(processor, size):
    return struct.pack("<III", 0xFEEDFACF, processor, 3) + bytes(range(256)) * (size // 256)


@pytest.fixture
def made_up(monkeypatch):
    """No compiler: libraries whose content is their target."""

    def compiled(platform):
        if "macos" in platform.target:
            return mach_o(ARM if platform.target.startswith("aarch64") else X86, 20000)
        return platform.target.encode()

    monkeypatch.setattr(platforms, "_compiled", compiled)
    monkeypatch.setattr(platforms, "version", lambda name: "made up")
    monkeypatch.setattr(platforms, "kept", lambda group, key, build: build())
    platforms.cross_compiled.cache_clear()
    yield
    platforms.cross_compiled.cache_clear()


def binaries(path):
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist() if name.startswith("binaries/")}


def test_folders_are_those_of_the_standard(made_up, tmp_path):
    """FMI 2.0, section 2.3, FMI 3.0, section 2.5.1.4.1; the library of here is left out unless asked for."""
    hinge = REGISTRY["hinge"]()
    found = binaries(build_fmu(hinge, "one", tmp_path, platforms=["win64", "wasm32", "aarch64-linux"]))
    assert found == {
        "binaries/win64/one.dll": b"x86_64-windows-gnu",
        "binaries/wasm32-wasi/one.wasm": b"wasm32-wasi",
        "binaries/aarch64-linux/one.so": b"aarch64-linux-gnu.2.17",
    }
    path = build_fmu(hinge, "one", tmp_path, fmi="3.0", platforms=list(PLATFORMS))
    assert {name.split("/")[1] for name in binaries(path)} == {one.folder3 for one in PLATFORMS.values()}
    assert set(supported_platforms(str(path))) >= {"linux64", "win64", "darwin64"}


def test_both_processors_of_macos_share_a_file_of_fmi_2(made_up, tmp_path):
    """Apple's format: mark, count, then processor, kind, place, size and alignment of each part, all big-endian."""
    (file,) = binaries(
        build_fmu(REGISTRY["hinge"](), "one", tmp_path, platforms=["darwin64", "aarch64-darwin"])
    ).values()
    assert struct.unpack_from(">II", file) == (0xCAFEBABE, 2)
    for number, processor in enumerate((X86, ARM)):
        kind, _, place, size, power = struct.unpack_from(">IIIII", file, 8 + 20 * number)
        assert kind == processor
        assert place % 2**power == 0
        assert file[place : place + size] == mach_o(processor, 20000)


def test_what_is_no_platform_or_has_no_compiler(monkeypatch, tmp_path):
    """Bad input: sentences."""
    with pytest.raises(fanfold.FanfoldError, match=r"'amiga'.*linux64, "):
        fanfold.export("workbench", tmp_path, rigid="all", platforms="amiga")

    def absent(name):
        raise PackageNotFoundError(name)

    monkeypatch.setattr(platforms, "version", absent)
    platforms.cross_compiled.cache_clear()
    with pytest.raises(fanfold.FanfoldError, match=r"needs Zig: pip install '\.\[platforms\]'"):
        fanfold.export("workbench", tmp_path, rigid="all", platforms="win64")
    with pytest.raises(ComponentError, match="platform"):
        build_fmu(REGISTRY["hinge"](), "one", tmp_path, backend="python", platforms=["win64"])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(find_spec("ziglang") is None, reason="Zig is not installed (pip install '.[platforms]')")
@pytest.mark.skipif(sys.platform != "linux", reason="the library for Linux is tried")
def test_a_library_for_linux_runs(tmp_path):
    """Identity: what Zig compiles does what the library of here does; `tests.benchmark.platforms` tries the others."""
    hinge = REGISTRY["hinge"]()
    ours, zigs = (
        build_fmu(hinge, name, tmp_path, platforms=chosen)
        for name, chosen in (("ours", []), ("zigs", ["linux64"]))
    )
    assert binaries(ours) != binaries(zigs)
    results = [simulate_fmu(str(path), stop_time=0.1, output_interval=0.01) for path in (ours, zigs)]
    found = [np.array(rows.tolist()) for rows in results]
    assert np.abs(found[0]).max() > 0.0
    assert found[0] == pytest.approx(found[1], rel=1e-12, abs=1e-15)
