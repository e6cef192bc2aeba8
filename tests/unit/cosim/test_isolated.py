"""FMUs in processes of their own: the numbers are the same, what breaks is named, and nothing stays behind."""

import os
import signal
import subprocess
import sys
import zipfile
from functools import partial
from pathlib import Path
from time import monotonic, sleep

import numpy as np
import pytest

from fmus import native_library
from orchestrator.cosim.fmu import FmuParticipant
from orchestrator.cosim.participant import ParticipantError
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import RunError, as_fmus, export, run
from tests.benchmark.faults.fmus import SCENE, UNTIL, Broken, answer, loader, wing
from tests.conformance.test_check import spoiled

pytestmark = pytest.mark.skipif(native_library() is None, reason="nothing was compiled here")
linux = pytest.mark.skipif(sys.platform != "linux", reason="finds processes in /proc")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("fmus")


@pytest.mark.parametrize(
    ("kind", "owner"),
    [
        ("crash", "inner"),
        ("crash_at_instantiation", "root"),
        ("exit", "middle_left"),
        ("hang", "base"),
        ("nan_in_outputs", "root"),
        ("nan_in_observations", "outer"),
        ("error", "inner"),
        ("much_talk", "root"),
        ("slow", "outer"),
        ("printing", "base"),
    ],
)
def test_broken_fmu_breaks_its_own_process(folder, kind, owner):
    """R5: FMU, function and time in a sentence, finite rows up to there, no process left; what is sound runs on.

    A sample of `python -m tests.benchmark.faults.fmus`.
    """
    assert answer(Broken(kind, owner, 0.1), folder) == ""


def of_others(folder):
    """A native FMU and one that does the same with a binary that was not compiled here."""
    sound = next(path for path in export(wing(), folder / "sound") if path.stem == "inner")
    other = folder / "inner.fmu"
    with zipfile.ZipFile(sound) as old, zipfile.ZipFile(other, "w") as new:
        for name in old.namelist():
            new.writestr(name, old.read(name) + (b"\0" if name.startswith("binaries/") else b""))
    return sound, other


def test_who_has_a_process_of_its_own(folder):
    """What was compiled here runs here unless asked; other binaries do not unless asked."""
    sound, other = of_others(folder)
    found = []
    for path, isolate in ((sound, None), (sound, True), (other, None), (other, False)):
        one = FmuParticipant("inner", path, isolate=isolate)
        found.append(one.is_isolated)
        one.close()
    assert found == [False, True, True, False]


def test_isolated_run_is_the_same():
    """Identity of every bit."""
    here, apart = (
        run(wing(), None, Settings(), 2.0, load=partial(as_fmus, isolate=isolate)).result
        for isolate in (False, True)
    )
    for component in here.components:
        for name in here.variables(component):
            np.testing.assert_array_equal(here.signal(component, name), apart.signal(component, name))


def test_states_as_bytes(folder):
    """A state returns as it was, and steps on as it did."""
    path = next(path for path in export(wing(), folder / "sound") if path.stem == "root")
    here, apart = (FmuParticipant("root", path, isolate=isolate) for isolate in (False, True))
    states = []
    for one in (here, apart):
        one.initialize(0.0)
        one.do_step(0.0, 0.01)
        one.save()
        states.append(one.serialized())
    assert states[0] == states[1]
    apart.do_step(0.01, 0.5)
    apart.deserialize(states[0])
    for one in (here, apart):
        one.do_step(0.01, 0.01)
        one.read()
    np.testing.assert_array_equal(here.outputs, apart.outputs)
    here.close()
    apart.close()


def test_interruption_while_an_fmu_hangs(folder):
    """Ctrl-C ends a call that would last for a minute, and keeps the rows."""
    handler = signal.signal(signal.SIGALRM, signal.default_int_handler)
    load = loader(Broken("hang", "inner", 0.1), folder, 60.0)

    def interrupt_soon(*_):
        signal.setitimer(signal.ITIMER_REAL, 0.3)  # which no step but the one that hangs takes

    begin = monotonic()
    with pytest.raises(RunError, match="interrupted at t = ") as caught:
        run(wing(), None, Settings(), UNTIL, watch=interrupt_soon, load=load)
    signal.signal(signal.SIGALRM, handler)
    assert monotonic() - begin < 30.0
    assert caught.value.result.time.size > 5


def children(parent):
    """Processes of the FMUs of a process."""
    lists = Path(f"/proc/{parent}/task").glob("*/children")
    return [int(child) for one in lists for child in one.read_text().split()]


def wait_for(condition, seconds=60.0):
    end = monotonic() + seconds
    while not condition():
        assert monotonic() < end
        sleep(0.02)


@linux
def test_fmu_whose_process_is_killed(folder):
    """As by a system that is out of memory, between two calls: the FMU is named, whatever is asked of it afterwards."""
    before = children(os.getpid())
    path = next(path for path in export(wing(), folder / "sound") if path.stem == "inner")
    one = FmuParticipant("inner", path, isolate=True)
    (mine,) = {*children(os.getpid())} - {*before}
    one.initialize(0.0)
    os.kill(mine, signal.SIGKILL)
    for _ in range(2):
        with pytest.raises(
            ParticipantError, match=r"inner: cannot do a step of 0.01 s at t = 0 s: it crashed"
        ):
            one.do_step(0.0, 0.01)
    one.close()
    assert children(os.getpid()) == before


@linux
def test_fmus_do_not_outlive_their_run(tmp_path):
    """Not even one that is killed."""
    command = [sys.executable, "-c", "from orchestrator.cli.main import main; main()", "run", str(SCENE)]
    options = ["--isolate", "--until", "10000", "--no-estimate", "--output", str(tmp_path / "run.h5")]
    going = subprocess.Popen([*command, *options], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    wait_for(lambda: len(children(going.pid)) == len(wing().parts) and (tmp_path / "run.h5").exists())
    found = children(going.pid)
    going.kill()
    going.wait()
    wait_for(lambda: not any(Path(f"/proc/{one}/cmdline").exists() for one in found))


def test_booleans_and_integers_of_another_tool(folder, tmp_path):
    """FMI 2.0, 2.1.7: values have functions by type. Bit-identical to the same FMU, whose functions take numbers.

    Its description lacks what Fanfold adds, as that of another tool does.
    """
    sound = next(path for path in export(wing(), folder / "typed") if path.stem == "root")
    annotated = rb"<(Numbers|DirectionalDerivative)[^>]*>"
    plain = spoiled(sound, tmp_path, "modelDescription.xml", annotated, b"")
    found = []
    for path in (sound, plain):
        one = FmuParticipant("root", path, {"order": 4.0, "latch_automatic": 0.0})
        one.inputs[one.input_layout["latch_command"]] = 1.0
        one.initialize(0.0)
        one.do_step(0.0, 1e-3)
        one.read()
        found.append((one.outputs.copy(), one.observe().copy()))
        assert one.outputs[one.output_layout["latched"]] == 1.0
        assert one.input_layout.quantities[-1].kind == "real"
        one.close()
    assert np.array_equal(found[0][0], found[1][0])
    assert np.array_equal(found[0][1], found[1][1])
