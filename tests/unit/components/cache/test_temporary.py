"""Temporary folders: one a process, gone when it ends, and when it was killed, gone at the next start."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[4]
ALONE = """
import sys
from types import ModuleType
for name in ("components", "components.cache"):
    sys.modules[name] = ModuleType(name)
    sys.modules[name].__path__ = [name.replace(".", "/")]
"""
"""The modules of this folder without all kinds of components, whose import is most of what a process would cost."""
MADE = f"""{ALONE}
from components.cache.temporary import process_folder
folder = process_folder()
(folder / "unpacked").mkdir()
(folder / "unpacked" / "file").write_text("x")
assert process_folder() == folder
print(folder, flush=True)
sys.stdin.readline()
"""
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs signals")


def start(temporary):
    """A process that has made its folder, and that folder."""
    process = subprocess.Popen(
        [sys.executable, "-c", MADE],
        cwd=ROOT,
        env={**os.environ, "TMPDIR": str(temporary)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    return process, Path(process.stdout.readline().strip())


def test_folder_goes_with_its_process(tmp_path):
    process, folder = start(tmp_path)
    assert (folder / "unpacked" / "file").exists()
    process.communicate("\n", timeout=60)
    assert not folder.exists()


def test_folder_of_a_killed_process_goes_at_the_next_start(tmp_path):
    """Those of processes that live stay, and so does what is not of this kind."""
    killed, abandoned = start(tmp_path)
    living, kept = start(tmp_path)
    other = abandoned.parent / "reduction-0"
    other.mkdir()
    killed.send_signal(signal.SIGKILL)
    killed.communicate(timeout=60)
    assert abandoned.exists()
    process, _ = start(tmp_path)
    assert not abandoned.exists()
    assert kept.exists()
    assert other.exists()
    for one in (living, process):
        one.communicate("\n", timeout=60)
    assert list(abandoned.parent.iterdir()) == [other]


def test_fork_leaves_the_folder_of_its_parent(tmp_path):
    """A fork that ends as a program does takes nothing with it."""
    program = (
        f"{ALONE}\nimport os\nfrom components.cache.temporary import process_folder\nfolder = process_folder()\n"
        "child = os.fork()\nif child == 0:\n    assert process_folder() != folder\n    sys.exit()\n"
        "os.waitpid(child, 0)\nassert folder.exists()\nassert len(list(folder.parent.iterdir())) == 1\n"
    )
    subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, env={**os.environ, "TMPDIR": str(tmp_path)}, check=True
    )
