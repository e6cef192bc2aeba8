"""The report: one file with everything inside, true numbers, data of what plays, bodies where they are."""

from __future__ import annotations

import json
import re
from base64 import b64decode, b64encode
from dataclasses import replace
from hashlib import sha256
from html.parser import HTMLParser
from io import BytesIO

import h5py
import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.image import imread

from orchestrator.cli.main import main
from orchestrator.results.result import Result
from orchestrator.views import plots
from orchestrator.views import shapes as plot_shapes
from orchestrator.views.report import animation as report_animation
from orchestrator.views.report.report import report
from tests.references import synthetic_result as reference

pytestmark = pytest.mark.slow
VOID = {"meta", "img", "input", "br", "link"}
FRAMES = 3
LESS = ("ccl", "scene", *(f"{line.name}_{side}" for line in reference.LINES[1:] for side in reference.SHARES))
"""Without these there are few figures, each of which takes most of a second with its captions and axes."""
BODIES = tuple(reference.LENGTHS)


class Page(HTMLParser):
    """Tags that stay open, addresses, texts by tag, and pictures of a page."""

    def __init__(self, text):
        super().__init__()
        self.open, self.addresses, self.ids, self.cells, self.captions = [], [], [], [], []
        self.stills, self.data = {}, ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.addresses += [values[key] for key in ("src", "href") if key in values]
        self.ids += [values["id"]] if "id" in values else []
        if values.get("alt", "").startswith("the structure at "):
            self.stills[values["alt"].split()[3]] = values["src"]
        if tag not in VOID:
            self.open.append((tag, values.get("id")))

    def handle_endtag(self, tag):
        assert self.open.pop()[0] == tag

    def handle_data(self, data):
        tag, identity = self.open[-1] if self.open else ("", None)
        if identity == "view-data":
            self.data += data
        if tag == "td":
            self.cells.append(data)
        if tag == "figcaption":
            self.captions.append(data)


def picture(address):
    kind, _, data = address.partition(",")
    assert kind == "data:image/png;base64"
    return imread(BytesIO(b64decode(data, validate=True)))


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return Result.open(reference.write(tmp_path_factory.mktemp("report") / "run.h5"))


@pytest.fixture(scope="module")
def bodies(tmp_path_factory):
    """Nothing but bodies and where they are."""
    others = tuple(name for name in reference.signals()[1] if name not in BODIES)
    return Result.open(reference.write(tmp_path_factory.mktemp("bodies") / "run.h5", leave_out=others))


@pytest.fixture(scope="module")
def text(result):
    return report(result, frame_count=FRAMES)


@pytest.fixture(scope="module")
def page(text):
    return Page(text)


def fanfold(*arguments):
    result = CliRunner().invoke(main, [str(a) for a in arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


def test_page_is_whole_and_needs_nothing_else(page, text):
    """Every tag is closed, and every address is a picture inside the file."""
    assert page.open == []
    assert all(address.startswith("data:image/png;base64,") for address in page.addresses)
    assert not re.search(r"https?://|@import|url\(", text)
    assert len(page.ids) == len(set(page.ids))
    assert "@media print" in text


def test_only_the_script_of_the_page_may_run(text):
    """CSP 2, 4.2.5: a hash in place of 'unsafe-inline' is that of the script's text; no other base, no forms."""
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1]
    scripts = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    allowed = [b64encode(sha256(script.encode()).digest()).decode() for script in scripts]
    assert [f"'sha256-{digest}'" for digest in allowed] == re.search("script-src ([^;]*);", policy)[1].split()
    assert "base-uri 'none'" in policy
    assert "form-action 'none'" in policy
    assert not re.search(r"<[a-z][^>]*\son[a-z]+=", text.split("<script>")[0])


def test_every_figure_is_inside_with_a_caption(page, result):
    drawn = list(plots.draw_all(result))
    assert {drawing.name for drawing in drawn} <= set(page.ids)
    assert {drawing.caption for drawing in drawn} <= set(page.captions)
    assert len(page.addresses) == len(drawn) + FRAMES
    for address in page.addresses:
        assert picture(address)[..., :3].std() > 0.02


def test_numbers_and_events_are_those_of_the_run(page):
    line = reference.LINES[1]
    assert f"{line.latch_time:.6f}" in page.cells
    assert any(
        c.replace(".", "").isdigit() and float(c) == pytest.approx(line.torque_peak, rel=1e-4)
        for c in page.cells
    )
    assert f"{line.name} latch-up" in page.cells


def test_provenance_is_shown(page, text):
    assert np.__version__ in page.cells
    assert "name = &#x27;synthetic&#x27;" in text


def test_stills_go_from_start_to_end(page):
    """For paper, and for browsers that show nothing in space."""
    assert [float(time) for time in page.stills] == pytest.approx(
        [0.0, 7.0, 14.0], abs=reference.LARGEST_STEP
    )
    pictures = [picture(address) for address in page.stills.values()]
    assert len({p.shape for p in pictures}) == 1
    # the structure moves: pictures differ by more than their title
    lower = [p[p.shape[0] // 5 :, :, :3] for p in pictures]
    assert np.mean(np.abs(lower[1] - lower[0]) > 0.1) > 0.01


def test_what_plays_is_inside(page):
    """Bodies and plots as data, the view and the list of plots as elements that scripts fill."""
    (one,) = json.loads(page.data)["results"]
    assert [body["name"] for body in one["bodies"]] == ["yoke", "panel1", "panel2"]
    assert "Deployment angles" in [plot["title"] for plot in one["plots"]]
    assert {"animation", "view-space", "plots-list"} <= set(page.ids)


def test_nothing_plays_without_pictures(bodies):
    """No frames: neither data nor scripts."""
    found = Page(report(bodies, frame_count=0))
    assert "shapes" in found.ids
    assert found.data == ""
    assert not {"animation", "plots-list"} & set(found.ids)


def test_pictures_that_are_large_together_are_fewer(result, monkeypatch):
    film = report_animation.frames(result, 5)
    monkeypatch.setattr(report_animation, "_LARGEST", sum(len(frame.png) for frame in film) // 2 + 100)
    fewer = report_animation.frames(result, 5)
    assert [frame.time for frame in fewer] == [frame.time for frame in film[::2]]


def test_bodies_without_a_pose_stand_where_they_are(result):
    """A fixed base with geometry: drawn in every picture at the positions of its geometry."""
    still = replace(result, geometry={**result.geometry, "base": result.geometry["yoke"]})
    structure = plot_shapes.Structure(still, np.array([0, 400]))
    assert set(structure.names) == {"yoke", "panel1", "panel2", "base"}
    for k in range(2):
        np.testing.assert_array_equal(structure._nodes["base"][k], result.geometry["yoke"].positions)
    assert len(report_animation.frames(still, 2)) == 2


@pytest.mark.thorough
def test_comparison_with_two_others(tmp_path):
    """Each against the first, by the command."""
    less = (*LESS, *BODIES)
    files = [
        reference.write(tmp_path / "run.h5", leave_out=less),
        reference.write(tmp_path / "second.h5", leave_out=(*less, "damper")),
        reference.write(tmp_path / "third.h5", leave_out=(*less, "damper")),
    ]
    others = [part for file in files[1:] for part in ("--with", str(file))]
    command = ["report", str(files[0]), *others, "--frames", "0", "--output", str(tmp_path / "page.html")]
    command += ["--require", "end_time < 99 s"] * 2
    assert CliRunner().invoke(main, command).exit_code == 0
    found = (tmp_path / "page.html").read_text(encoding="utf-8")
    page = Page(found)
    assert page.open == []
    assert {"compare_angles", "compare_interface_loads", "compare_2_angles"} <= set(page.ids)
    assert "animation" not in page.ids
    assert found.count("Only in run: damper: damper_torque, dissipated_energy.") == 2
    assert "1.0000" in page.cells
    assert "+0.0000" in page.cells
    assert page.cells.count("end_time < 99 s") == 1  # one row of both results, however often it is given
    assert found.count("The requirement is met.") == 2


def test_texts_are_escaped(bodies):
    """Bad input: names from a scene cannot become markup."""
    tree = {"scene": {"description": "<script>alert(1)</script> & more"}}
    hostile = replace(
        bodies,
        provenance={"scene": "<b>bold</b>", "scene_tree": json.dumps(tree), "flexible": "no JSON"},
        events=[(1.0, "<i>", "latch & co")],
        geometry={},
    )
    found = report(hostile, frame_count=1)
    assert "<script>alert" not in found
    assert "<b>bold" not in found
    assert "&lt;script&gt;alert(1)&lt;/script&gt; &amp; more" in found
    assert Page(found).open == []


def test_scene_with_nothing_to_draw(tmp_path):
    everything = tuple(reference.signals()[1])
    bare = Result.open(reference.write(tmp_path / "bare.h5", leave_out=everything[:-1]))
    found = Page(report(bare))
    assert found.open == []
    assert "steps" in found.ids
    assert "animation" not in found.ids


def test_report_of_a_real_run(tmp_path):
    """End to end: a short run, its report beside it, one file below 5 MB."""
    run = tmp_path / "run.h5"
    assert (
        fanfold(
            "run", "workbench", "--until", 0.02, "--rigid", "all", "--no-estimate", "--output", run
        ).exit_code
        == 3  # it ends before it latches
    )
    result = fanfold("report", run)
    assert result.exit_code == 0
    path = tmp_path / "run.html"
    assert result.stdout.strip() == str(path)
    assert path.stat().st_size < 5_000_000
    page = Page(path.read_text(encoding="utf-8"))
    assert page.open == []
    assert "deployment_angles" in page.ids
    assert "fanfold" in page.cells


def test_interrupted_run_is_told(tmp_path):
    path = reference.write(tmp_path / "run.h5", leave_out=(*LESS, *BODIES, "base", "damper"))
    with h5py.File(path, "r+") as file:
        file.attrs["complete"] = False
    result = fanfold("report", path, "--output", tmp_path / "a.html")
    assert result.exit_code == 0
    assert "at 14 s" in (tmp_path / "a.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(("name", "sentence"), [("run.h5", "end in .html"), ("scene.toml", "end in .html")])
def test_no_other_file_is_overwritten(tmp_path, name, sentence):
    """Bad input: neither the result nor a scene is lost to a report of that name."""
    path = reference.write(tmp_path / "run.h5")
    target = tmp_path / name
    before = target.read_bytes() if target.exists() else None
    result = fanfold("report", path, "--output", target)
    assert result.exit_code == 1
    assert sentence in result.stderr
    assert (target.read_bytes() if target.exists() else None) == before


def test_result_named_as_a_page_is_not_overwritten(tmp_path):
    path = reference.write(tmp_path / "run.html")
    result = fanfold("report", path)
    assert result.exit_code == 1
    assert "itself" in result.stderr
    assert Result.open(path).complete
