"""FMUs in a run: those that fail are named with the time and nothing recorded is lost; sound ones change nothing."""

from __future__ import annotations

import re
import shutil
import sys
import zipfile
from contextlib import ExitStack, contextmanager, nullcontext
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from fmus import build_fmu
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.fmu import FmuParticipant
from orchestrator.cosim.participant import InProcess, ParticipantError, all_finite, in_process
from orchestrator.cosim.settings import Settings
from orchestrator.results.result import Result
from orchestrator.run.run import RunError, as_fmus, export, run
from orchestrator.scene import load_scene
from tests.unit.cosim.faulty import FAILS_AT, FaultyDamper

PANELS = Path(__file__).parents[2] / "scenes" / "two_panels.toml"
TWO_PANELS = PANELS.read_text(encoding="utf-8")
END = 2.0 * FAILS_AT
DAMPER = '[[damper]]\nname = "brake"\nhinge = "root"\ndamping_coefficient = 2.0\n'
SOFT = (
    '[joint]\naxial_stiffness = "200 N/m"\nradial_stiffness = "200 N/m"\ncross_stiffness = "50 N.m/rad"\n'
    'damping_ratio = 0.5\ndamping_frequency = "1 Hz"\n'
)


def scene(folder, extra=DAMPER):
    """Two panels with a brake at the root, as an assembly."""
    path = folder / "scene.toml"
    path.write_text(TWO_PANELS + extra, encoding="utf-8")
    return assemble(load_scene(path))


def with_brake(assembly, brake):
    """A loader: all parts in process, but for the brake."""

    @contextmanager
    def load(_):
        with ExitStack() as stack:
            stack.callback(brake.close)
            yield [*in_process([p for p in assembly.parts if p.name != "brake"]), brake]

    return load


def faulty_brake(assembly, fault):
    """The brake in process, with a fault."""
    part = next(p for p in assembly.parts if p.name == "brake")
    return InProcess(part.name, FaultyDamper(fault, **part.structure), part.start)


def faulty_fmu(folder, assembly, fault):
    """The path of an FMU of a faulty brake in place of the scene's, which does not stay in the user's cache."""
    part = next(p for p in assembly.parts if p.name == "brake")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FANFOLD_CACHE", str(folder / "cache"))
        return build_fmu(FaultyDamper(fault, **part.structure), "brake", folder, part.start, "python")


def error_of(function, *arguments, **options):
    with pytest.raises((RunError, ParticipantError)) as caught:
        function(*arguments, **options)
    sentence = str(caught.value)
    assert "\n" not in sentence
    return sentence


def run_with(folder, fault, **settings):
    assembly = scene(folder)
    brake = FmuParticipant("brake", faulty_fmu(folder, assembly, fault))
    return run(assembly, folder / "run.h5", Settings(**settings), END, load=with_brake(assembly, brake))


def assert_readable_up_to_the_fault(path):
    """What was recorded before it fails is there, finite, and marked as not complete."""
    result = Result.open(path)
    assert not result.complete
    assert result.time.size > 5
    assert 0.9 * FAILS_AT < result.time[-1] <= FAILS_AT
    assert np.all(np.isfinite(result.signal("root", "angle")))
    assert np.ptp(result.signal("inner", "kinetic_energy")) > 0.0


def test_brake_without_fault_runs_to_the_end(tmp_path):
    """Control: the faulty component is sound but for its faults, so that the tests below show these."""
    outcome = run_with(tmp_path, "none")
    assert outcome.headline.complete
    assert outcome.headline.end_time == pytest.approx(END, abs=1e-9)


def test_fmu_that_returns_an_error(tmp_path):
    """Bad input: the FMU, the time and its own reason are told; the result holds all steps before."""
    sentence = error_of(run_with, tmp_path, "error")
    assert "two_panels: brake: cannot do a step of" in sentence
    assert "at t = 0.0" in sentence
    assert "magnet" in sentence
    assert str(tmp_path / "run.h5") in sentence
    assert_readable_up_to_the_fault(tmp_path / "run.h5")


def test_fmu_whose_output_is_no_number(tmp_path):
    """Bad input: the FMU, the output and the time are told; no such number reaches the result."""
    sentence = error_of(run_with, tmp_path, "nan")
    assert "brake" in sentence
    assert "output inboard.torque[2] is nan" in sentence
    assert "t = 0.0" in sentence
    assert_readable_up_to_the_fault(tmp_path / "run.h5")


def test_observation_that_is_no_number(tmp_path):
    """R10: an observation is recorded and added up, so the FMU, the observation and the time are told as of outputs."""
    sentence = error_of(run_with, tmp_path, "observation")
    assert "brake: observation dissipated_energy" in sentence
    assert_readable_up_to_the_fault(tmp_path / "run.h5")


def test_observation_of_a_component_that_is_no_number(tmp_path):
    """The same without an FMU around it."""
    assembly = scene(tmp_path)
    load = with_brake(assembly, faulty_brake(assembly, "observation"))
    sentence = error_of(run, assembly, tmp_path / "run.h5", Settings(), END, load=load)
    assert "brake: observation dissipated_energy is nan" in sentence


def test_large_outputs_are_numbers():
    """R22: finite values whose sum is not are none that are refused; the one that is no number is found beside them."""
    large = np.array([1e308, 1e308, 0.0])
    assert all_finite(large)
    assert not all_finite(np.array([1e308, np.nan]))


def damaged(folder, fmu, name):
    """A copy of an FMU with one kind of damage."""
    path = folder / name / "brake.fmu"
    path.parent.mkdir()
    if name == "no archive":
        path.write_bytes(b"not an FMU")
    elif name == "truncated":
        path.write_bytes(fmu.read_bytes()[:-500])
    else:
        with zipfile.ZipFile(fmu) as old, zipfile.ZipFile(path, "w") as new:
            for entry in old.namelist():
                data = old.read(entry)
                if name == "no binary" and entry.startswith("binaries/"):
                    continue
                if name == "no description" and entry == "modelDescription.xml":
                    continue
                if name == "version 3" and entry == "modelDescription.xml":
                    data = data.replace(b'fmiVersion="2.0"', b'fmiVersion="3.0"')
                new.writestr(entry, data)
    return path


@pytest.mark.parametrize("damage", ["no archive", "truncated", "no binary", "no description", "version 3"])
def test_fmu_file_that_is_damaged(tmp_path, damage):
    """Bad input: instance and file are told in one sentence, and nothing unpacked stays behind."""
    fmu = faulty_fmu(tmp_path, scene(tmp_path), "none")
    sentence = error_of(FmuParticipant, "brake", damaged(tmp_path, fmu, damage))
    assert sentence.startswith("brake: ")
    assert "brake.fmu" in sentence


@pytest.mark.skipif(sys.platform != "linux", reason="ELF binaries")
@pytest.mark.parametrize("share", [0.001, 0.1, 0.5, 0.9, 0.999])
def test_binary_that_is_cut_short(tmp_path, share):
    """R21: it is told before the loader meets its end, which would end the whole process."""
    assembly = scene(tmp_path)
    fmu = export(assembly, tmp_path / "sound")[0]
    path = tmp_path / "cut.fmu"
    with zipfile.ZipFile(fmu) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            data = old.read(name)
            new.writestr(name, data[: int(share * len(data))] if name.startswith("binaries/") else data)
    sentence = error_of(FmuParticipant, "inner", path)
    assert "cut.fmu" in sentence
    assert "cut short" in sentence


def test_reason_of_a_native_fmu_that_makes_no_instance(tmp_path):
    """R9: its own words are told, not only that it did not."""
    fmu = export(scene(tmp_path), tmp_path / "sound")[0]
    path = tmp_path / "other.fmu"
    with zipfile.ZipFile(fmu) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            data = old.read(name)
            if name == "modelDescription.xml":
                data = re.sub(rb'guid="[^"]*"', b'guid="{another}"', data)
            new.writestr(name, data)
    sentence = error_of(FmuParticipant, "inner", path)
    assert "other.fmu" in sentence
    assert "another" in sentence


def test_fmu_file_that_does_not_exist(tmp_path):
    """Bad input: a missing file is told by name."""
    assert "none.fmu" in error_of(FmuParticipant, "brake", tmp_path / "none.fmu")


def test_fmu_that_cannot_be_made_an_instance(tmp_path):
    """Bad input: the reason that the FMU itself gives while loading is told."""
    path = faulty_fmu(tmp_path, scene(tmp_path), "load")
    sentence = error_of(FmuParticipant, "brake", path)
    assert "brake: " in sentence
    assert "licence server" in sentence


def test_run_with_an_fmu_that_cannot_be_loaded(tmp_path):
    """Bad input: the run ends with the scene's name before the sentence, and frees what was loaded."""
    assembly = scene(tmp_path)
    freed = []

    @contextmanager
    def load(_):
        with ExitStack() as stack:
            stack.callback(freed.append, True)
            yield [FmuParticipant("brake", tmp_path / "none.fmu")]

    sentence = error_of(run, assembly, tmp_path / "run.h5", Settings(), 0.05, load=load)
    assert sentence.startswith("two_panels: brake: none.fmu ")
    assert freed == [True]
    assert not (tmp_path / "run.h5").exists()


def test_no_unpacked_files_stay_behind(tmp_path, monkeypatch):
    """Clean-up: whether an FMU loads or not, its unpacked files are gone in the end."""
    monkeypatch.setattr("orchestrator.cosim.fmu.mkdtemp", lambda dir: str((tmp_path / "unpacked").resolve()))
    assembly = scene(tmp_path)
    FmuParticipant("brake", faulty_fmu(tmp_path, assembly, "none")).close()
    assert not (tmp_path / "unpacked").exists()
    error_of(FmuParticipant, "brake", faulty_fmu(tmp_path, assembly, "load"))
    assert not (tmp_path / "unpacked").exists()


def test_unknown_parameter_is_refused(tmp_path):
    """Bad input: a start value for a parameter that the FMU does not have."""
    path = faulty_fmu(tmp_path, scene(tmp_path), "none")
    sentence = error_of(FmuParticipant, "brake", path, {"colour": 1.0})
    assert sentence.startswith("brake: ")
    assert "'colour'" in sentence


def test_tolerance_that_cannot_be_met(tmp_path):
    """Bad input: a connection that answers at random; the error names it, its residual, time and step."""
    assembly = scene(tmp_path)
    load = with_brake(assembly, faulty_brake(assembly, "noise"))
    sentence = error_of(run, assembly, tmp_path / "run.h5", Settings(), 0.05, load=load)
    assert "t = 0.000000 s" in sentence
    assert "brake.outboard on inner.brake" in sentence
    assert "tolerance" in sentence
    assert Result.open(tmp_path / "run.h5").time.size == 1


def test_fmus_equal_components(tmp_path):
    """Independent path: a wing as PythonFMUs and in process agrees in every bit, the coupling being the same."""
    assembly = assemble(load_scene(PANELS))
    load = partial(as_fmus, backend="python")
    outside = run(assembly, tmp_path / "fmus.h5", Settings(), 0.02, load=load)
    within = run(
        assembly,
        tmp_path / "components.h5",
        Settings(),
        0.02,
        load=lambda _: nullcontext(in_process(assembly.parts)),
    )
    assert outside.segments == within.segments
    assert outside.costs.iterations == within.costs.iterations
    one, other = Result.open(outside.path), Result.open(within.path)
    assert one.components == other.components
    for component in one.components:
        assert one.variables(component) == other.variables(component)
        for variable in one.variables(component):
            np.testing.assert_array_equal(
                one.signal(component, variable), other.signal(component, variable), f"{component}.{variable}"
            )


def test_state_is_saved_over_and_over(tmp_path):
    """Roll-back: after any number of saves a step from the last saved state gives the same outputs again."""
    brake = FmuParticipant("brake", faulty_fmu(tmp_path, scene(tmp_path), "none"))
    brake.initialize(0.0)
    for step in range(3):
        brake.save()
        brake.inputs[brake.input_layout["outboard.angular_velocity"]] = (0.0, 1.0 + step, 0.0)
        found = []
        for _ in range(2):
            brake.restore()
            brake.write()
            brake.do_step(0.01 * step, 0.01)
            brake.read()
            found.append(brake.outputs.copy())
        np.testing.assert_array_equal(*found)
    brake.close()


def without_rollback(path):
    """The same FMU, but its description says that it cannot save its state."""
    copy = path.with_name(f"fixed_{path.name}")
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(copy, "w") as new:
        for entry in old.namelist():
            data = old.read(entry)
            if entry == "modelDescription.xml":
                assert data.count(b'canGetAndSetFMUstate="true"') == 1
                data = data.replace(b'canGetAndSetFMUstate="true"', b'canGetAndSetFMUstate="false"')
                data = data.replace(b'canSerializeFMUstate="true"', b'canSerializeFMUstate="false"')
            new.writestr(entry, data)
    shutil.move(copy, path)
    return path


class Untouchable(FmuParticipant):
    """An FMU that must never be asked for its state."""

    def save(self):
        raise AssertionError("saved")

    restore = save


def test_fmu_that_cannot_roll_back(tmp_path):
    """Fallback: the explicit master takes over with a warning that names the FMU; motion as in the implicit run."""
    assembly = scene(tmp_path, DAMPER + SOFT)
    path = without_rollback(faulty_fmu(tmp_path, assembly, "none"))
    warnings = []
    outcome = run(
        assembly,
        tmp_path / "run.h5",
        Settings(fixed_step=2e-4),
        0.1,
        warn=warnings.append,
        load=with_brake(assembly, Untouchable("brake", path, isolate=False)),
    )
    assert (outcome.master, outcome.order) == ("gauss-seidel", 2)
    assert len(warnings) == 1
    assert "brake cannot" in warnings[0]
    implicit = run(
        assembly,
        tmp_path / "implicit.h5",
        Settings(),
        0.1,
        load=lambda _: nullcontext(in_process(assembly.parts)),
    )
    angles = [Result.open(o.path).signal("middle_left", "angle") for o in (outcome, implicit)]
    assert implicit.master == "implicit"
    assert angles[0][-1] == pytest.approx(angles[1][-1], rel=2e-2)
