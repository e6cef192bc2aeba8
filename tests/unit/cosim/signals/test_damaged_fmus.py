"""FMUs and SSP files that are damaged, or made to do harm: sentences from `check`, from scenes and from runs."""

import zipfile

import pytest

import orchestrator as fanfold
from components.contract.errors import _LONGEST
from fmus import archive, check_fmu
from orchestrator.cosim.fmu import FmuParticipant
from orchestrator.cosim.participant import ParticipantError
from orchestrator.cosim.signals.process import SignalProcess
from tests.references.archives import mark_encrypted
from tests.unit.cosim.signals.signal_cases import controlled, slave
from tests.unit.cosim.signals.test_what_is_joined import with_units

DESCRIPTION = "modelDescription.xml"


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    return slave(tmp_path_factory.mktemp("sound"))


def packed(file, folder, change=lambda name, content: content, kind=zipfile.ZIP_DEFLATED, **more):
    """The same members in another archive, changed, and more of them."""
    copy = folder / file.name
    with zipfile.ZipFile(file) as old, zipfile.ZipFile(copy, "w", kind) as new:
        for name in old.namelist():
            new.writestr(name, change(name, old.read(name)))
        for name, content in more.items():
            new.writestr(name, content)
    return copy


def flipped(path):
    """The data of every member with other bits."""
    content = bytearray(path.read_bytes())
    with zipfile.ZipFile(path) as packed_file:
        for member in packed_file.infolist():
            start = member.header_offset + 30 + len(member.filename)
            for k in range(start, start + member.compress_size):
                content[k] ^= 0xFF
    path.write_bytes(content)
    return path


def flagged(path):
    mark_encrypted(path)
    return path


def encoded(name):
    def change(member, content):
        return content.replace(b"UTF-8", name, 1) if member == DESCRIPTION else content

    return change


ARCHIVES = {
    "encrypted": lambda file, folder: flagged(packed(file, folder)),
    "deflated, damaged": lambda file, folder: flipped(packed(file, folder)),
    "LZMA, damaged": lambda file, folder: flipped(packed(file, folder, kind=zipfile.ZIP_LZMA)),
    "BZIP2, damaged": lambda file, folder: flipped(packed(file, folder, kind=zipfile.ZIP_BZIP2)),
    "UTF-7": lambda file, folder: packed(file, folder, encoded(b"UTF-7")),
    "no encoding": lambda file, folder: packed(file, folder, encoded(b"nope")),
    "a member outside": lambda file, folder: packed(file, folder, **{"../../outside": b"x"}),
    "many members": lambda file, folder: packed(
        file, folder, **{f"resources/{k}": b"" for k in range(archive.MOST_MEMBERS)}
    ),
}


@pytest.mark.parametrize("damage", ARCHIVES)
def test_damaged_fmus_are_sentences(sound, tmp_path, damage):
    """Reproductions: tracebacks of `check` and of scenes; what `check` refuses no scene unpacks."""
    path = ARCHIVES[damage](sound, tmp_path)
    assert check_fmu(path)
    with pytest.raises(fanfold.FanfoldError, match=r"fmu\.controller\.file: .*Controller\.fmu"):
        fanfold.simulate(controlled(path), estimate=False)


def test_no_participant_unpacks_what_check_refuses(sound, tmp_path, monkeypatch):
    """Bounds on what unpacked members would take."""
    monkeypatch.setattr(archive, "LARGEST_BYTES", 1000)
    with pytest.raises(ParticipantError, match="unpack"):
        FmuParticipant("a", sound)
    with pytest.raises(fanfold.FanfoldError, match="unpack"):
        fanfold.simulate(controlled(sound), estimate=False)

    class Asked:
        name, path, inputs, outputs, told = "a", sound, (), (), ()

    with pytest.raises(ParticipantError, match="unpack"):
        SignalProcess(Asked, 1e-4, 1.0)


@pytest.mark.parametrize("damage", [name for name in ARCHIVES if "damaged" in name or name == "encrypted"])
def test_damaged_system_structures_are_sentences(sound, tmp_path, damage):
    """Reproductions: RuntimeError of an encrypted one, zlib.error of a damaged one."""
    path = ARCHIVES[damage](sound, tmp_path).rename(tmp_path / "a.ssp")
    with pytest.raises(fanfold.FanfoldError, match=r"a\.ssp: .*SSP"):
        fanfold.load(path)


def test_a_model_identifier_with_slashes_is_no_name_of_a_platform(sound, tmp_path):
    def change(name, content):
        return (
            content.replace(b'modelIdentifier="', b'modelIdentifier="a/', 1)
            if name == DESCRIPTION
            else content
        )

    with pytest.raises(fanfold.FanfoldError, match="model identifier 'a/Controller'"):
        fanfold.simulate(controlled(packed(sound, tmp_path, change)), estimate=False)


def test_an_fmu_that_writes_into_the_pipe_is_named(tmp_path):
    """Reproduction: UnpicklingError."""
    fault = (
        "[os.write(k, b'\\0\\0\\0\\4none') for k in range(3, 64) if os.path.exists(f'/proc/self/fd/{k}') "
        + ("and os.readlink(f'/proc/self/fd/{k}').startswith('socket')]")
    )
    with pytest.raises(fanfold.FanfoldError, match=r"controller: .* t = .*read"):
        fanfold.simulate(controlled(slave(tmp_path, fault=fault)), estimate=False)


def test_a_message_without_end_is_cut_off(tmp_path):
    fault = "raise ValueError('x' * 3_000_000)"
    with pytest.raises(fanfold.FanfoldError) as told:
        fanfold.simulate(controlled(slave(tmp_path, fault=fault)), estimate=False)
    assert len(str(told.value)) < 3 * _LONGEST


MOMENT = 'kg="1" m="2" s="-2"'


@pytest.mark.parametrize(
    "base",
    [
        f'{MOMENT} factor="1000"',
        f'{MOMENT} factor="0"',
        f'{MOMENT} factor="NaN"',
        f'{MOMENT} offset="1"',
        'kg="1"',
    ],
)
def test_a_unit_of_our_name_is_not_taken_for_ours(sound, base):
    """FMI 2.0, 2.2.2: a unit is what its base unit says. Reproduction: all of these gave the same run."""
    units = f'<Unit name="N.m"><BaseUnit {base}/></Unit>'
    with pytest.raises(fanfold.FanfoldError, match=r"outputs\.torque: .*N\.m"):
        fanfold.simulate(controlled(with_units(sound, "", units, torque='unit="N.m"')), estimate=False)


@pytest.mark.parametrize("base", [MOMENT, ""])
def test_a_unit_of_our_name_that_is_ours_is_taken(sound, base):
    """Tools also write base units without a number."""
    units = f'<Unit name="N.m"><BaseUnit {base}/></Unit>'
    scene = controlled(with_units(sound, "", units, torque='unit="N.m"'), until=0.1)
    assert fanfold.simulate(scene, estimate=False)["controller", "torque"].unit == "N.m"
