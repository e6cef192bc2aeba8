"""The report in headless Chromium: it plays, reads what the file holds, obeys mouse and keys, and says nothing."""

from __future__ import annotations

import json
import re
from base64 import b64decode
from dataclasses import replace
from math import floor, log10
from time import sleep

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.results.key_figures import line_latch_torque
from orchestrator.views.report.report import report
from orchestrator.views.viewers.stressed import stressed
from tests.references import synthetic_result as reference
from tests.unit.views.report import browser as chromium

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        chromium.CHROMIUM is None, reason="Chromium is not installed (Debian: apt install chromium)"
    ),
]
HOSTILE = "</script><img src=x onerror=alert(1)><b>&\u2028"
DRAWN = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))"
TIME = "Number(document.getElementById('view-time').value)"
FRAME = 0.02
"""s; the time of a frame may be that of its beginning"""
VISIBLE = "(name => document.getElementById(name).getClientRects().length > 0)"


def written(value, largest):
    """As the page writes it: five digits of the largest value of the plot."""
    return f"{np.float32(value):.{4 - floor(log10(largest))}f}"


def set_to(page, name, value, event="input"):
    page.run(f"""(() => {{ const one = document.getElementById({json.dumps(name)}); one.value = {json.dumps(value)};
        one.dispatchEvent(new Event({json.dumps(event)})); }})()""")
    page.run(DRAWN)


def readings(page, title):
    """What the plot of a title reads: where, and texts of value and unit by label."""
    return page.run(f"""(() => {{
        const plots = [...document.querySelectorAll(".plot")];
        const plot = plots.find(one => one.firstChild.textContent === {json.dumps(title)});
        const rows = [...plot.querySelectorAll("tr")].map(row => [...row.children].map(cell => cell.textContent));
        return [plot.querySelector(".at").textContent, Object.fromEntries(rows.map(row => [row[1], row.slice(2)]))];
    }})()""")


def changed(before, after):
    """Share of pixels that are others."""
    return np.mean(np.abs(before - after).max(axis=2) > 0.05)


def key(page, name):
    for kind in ("keyDown", "keyUp"):
        page.ask(
            "Input.dispatchKeyEvent",
            type=kind,
            key=name,
            text=name if len(name) == 1 and kind == "keyDown" else "",
        )
    page.run(DRAWN)


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """Bodies and lines of the made-up deployment, of which a line and an event have names that are markup."""
    path = tmp_path_factory.mktemp("browser") / "run.h5"
    found = fanfold.Result.open(reference.write(path, leave_out=("ccl", "damper", "base", "scene")))
    first, *others = found.hinge_lines
    events = [(time, name, f"{text} {HOSTILE}") for time, name, text in found.events]
    return replace(found, hinge_lines=(replace(first, name=HOSTILE), *others), events=events)


@pytest.fixture(scope="module")
def file(result, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "run.html"
    path.write_text(report(result, frame_count=2), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    with chromium.Browser(tmp_path_factory.mktemp("profile")) as found:
        yield found


@pytest.fixture
def page(browser, file):
    browser.told.clear()
    browser.open(file)
    browser.run(DRAWN)
    yield browser
    assert browser.told == []


def test_the_structure_moves_with_time(page):
    """It is shown instead of the stills, and pixels change when time does and not before."""
    assert page.run(f"{VISIBLE}('view-space') && !{VISIBLE}('view-stills')")
    first = page.picture("stage")
    assert first.std() > 0.05
    assert changed(first, page.picture("stage")) == 0.0
    set_to(page, "view-time", 8.0)
    assert page.run("document.getElementById('view-clock').value") == "8.000 s"
    assert changed(first, page.picture("stage")) > 0.02


def test_it_plays_at_a_speed(page):
    """Twice as fast as the clock, until it is stopped; watched from inside, as frames may be seconds apart."""
    set_to(page, "view-speed", "2", "change")
    played, passed = page.run("""new Promise(done => {
        const start = performance.now();
        const slider = document.getElementById("view-time");
        const look = () => {
            const played = Number(slider.value);
            if (played < 0.5) { requestAnimationFrame(look); return; }
            const passed = (performance.now() - start) / 1000;
            document.getElementById("view-play").click();
            done([played, passed]);
        };
        document.getElementById("view-play").click();
        look();
    })""")
    assert 0.5 <= played <= 2.0 * (passed + FRAME)
    still = page.run(TIME)
    assert still == pytest.approx(played)
    sleep(0.2)
    assert page.run(TIME) == still


def shortest_gap(page):
    """Least time (s), by the clock of frames, between four changes of the picture's time as it plays."""
    return page.run("""new Promise(done => {
        const told = document.getElementById("view-clock");
        let [last, times] = [told.value, []];
        const look = now => {
            if (told.value !== last) [last, times] = [told.value, [...times, now]];
            if (times.length < 4) { requestAnimationFrame(look); return; }
            document.getElementById("view-play").click();
            done(Math.min(...times.slice(1).map((time, k) => time - times[k])) / 1000);
        };
        document.getElementById("view-play").click();
        requestAnimationFrame(look);
    })""")


def test_little_motion_for_those_who_want_it(page):
    """With prefers-reduced-motion pictures follow each other in half a second at the soonest; without, sooner."""
    page.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
    try:
        assert shortest_gap(page) > 0.4
    finally:
        page.ask("Emulation.setEmulatedMedia", features=[])
    assert shortest_gap(page) < 0.4


def test_the_cursor_reads_the_file(page, result):
    """At a latch-up, the row before it; at a time between rows, the nearest one; with unit."""
    line = result.hinge_lines[2]
    torque = line_latch_torque(result, line)
    (time,) = [time for time, name, _ in result.events if name in line.hinges]
    largest = max(np.abs(line_latch_torque(result, one)).max() for one in result.hinge_lines)
    page.run("document.querySelectorAll('#view-events button')[2].click()")
    first = np.searchsorted(result.time, time)
    for row in (first, first + 40):
        set_to(page, "view-time", result.time[row] + 1e-5)
        told, values = readings(page, "Latch torques, sum over the hinges of a line")
        assert told == f"Recorded values at {result.time[row]:.6f} s"
        assert values["hl3"] == [written(torque[row], largest), "N.m"]
    angle = np.rad2deg(result.signal("hl2_left", "angle"))[row]
    assert readings(page, "Deployment angles")[1]["hl2"] == [written(angle, 180.0), "deg"]


def test_pointing_reads_and_clicking_sets_the_time(page, result):
    """Where the mouse is, the nearest row is read; the picture's time stays until the click."""
    page.run("document.querySelector('.plot').scrollIntoView()")
    box = page.run("""(() => {
        const box = document.querySelector(".plot .stack").getBoundingClientRect();
        return [box.x, box.y, box.width];
    })()""")
    place = {"x": box[0] + 64 + 0.5 * (box[2] - 74), "y": box[1] + 80}
    page.ask("Input.dispatchMouseEvent", type="mouseMoved", **place)
    page.run(DRAWN)
    told, values = readings(page, "Deployment angles")
    time = float(told.split()[-2])
    assert time == pytest.approx(7.0, abs=0.05)
    row = int(np.argmin(np.abs(result.time - time)))
    assert values["hl2"][0] == written(np.rad2deg(result.signal("hl2_left", "angle")[row]), 180.0)
    assert page.run("document.getElementById('view-clock').value") == "0.000 s"
    for kind in ("mousePressed", "mouseReleased"):
        page.ask("Input.dispatchMouseEvent", type=kind, button="left", clickCount=1, **place)
    page.run(DRAWN)
    assert page.run(TIME) == pytest.approx(7.0, abs=0.05)


def test_plots_zoom_and_shift(page):
    """Curves change, and come back with the whole run."""
    page.run("document.getElementById('plots-in').click()")
    page.run("document.getElementById('plots-all').click()")
    whole = page.picture("plots-list")
    page.run("document.getElementById('plots-in').click()")
    near = page.picture("plots-list")
    page.run("document.getElementById('plots-right').click()")
    assert changed(whole, near) > 0.01
    assert changed(near, page.picture("plots-list")) > 0.005
    page.run("document.getElementById('plots-all').click()")
    assert changed(whole, page.picture("plots-list")) == 0.0


def test_keys_turn_the_view_and_play(page):
    """And the wheel zooms what has the focus."""
    page.run("document.getElementById('view-space').focus()")
    before = page.picture("stage")
    key(page, "ArrowLeft")
    turned = page.picture("stage")
    assert changed(before, turned) > 0.005
    key(page, "+")
    assert changed(turned, page.picture("stage")) > 0.005
    key(page, "0")
    assert changed(before, page.picture("stage")) < 0.002  # but for the ring of the focus
    key(page, ".")
    assert page.run(TIME) > 0.0
    key(page, " ")
    assert page.run("document.getElementById('view-play').textContent") == "Pause"
    key(page, " ")
    assert page.run("document.getElementById('view-play').textContent") == "Play"


def test_a_dark_screen_has_a_dark_view(page):
    """And paper a light one."""
    page.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
    try:
        page.run(DRAWN)
        assert np.median(page.picture("stage")) < 0.3
        assert np.median(page.picture("plots-list")) < 0.3
        page.ask("Page.printToPDF")
        shown = page.run("""(async () => {
            const image = document.querySelector("#view-printed img");
            await image.decode();
            const pen = Object.assign(document.createElement("canvas"), { width: 1, height: 1 }).getContext("2d");
            pen.drawImage(image, 0, 0);
            return pen.getImageData(0, 0, 1, 1).data[0];
        })()""")
        assert shown > 200
    finally:
        page.ask("Emulation.setEmulatedMedia", features=[])
    page.run(DRAWN)
    assert np.median(page.picture("stage")) > 0.7


def test_deformation_grows_with_its_factor(page):
    set_to(page, "view-time", 6.3)
    before = page.picture("stage")
    set_to(page, "view-factor", "6")
    assert changed(before, page.picture("stage")) > 0.005


def test_hostile_names_stay_text(page):
    """Bad input: a line and events whose names are markup are shown as they are, and nothing of them runs."""
    assert page.run("document.querySelectorAll('img[onerror], b').length") == 0
    told = page.run("document.getElementById('view-events').textContent")
    assert "</script><img src=x onerror=alert(1)><b>&" in told
    assert HOSTILE in readings(page, "Deployment angles")[1]


def test_paper_shows_what_the_reader_sees(page):
    """Before print the picture of now takes the place of the canvas, in all its pixels."""
    set_to(page, "view-time", 8.0)
    page.ask("Page.printToPDF")
    told = page.run("document.getElementById('view-printed').textContent")
    assert told == "At 8.00 s"
    pixels = "[one.naturalWidth ?? one.width, one.naturalHeight ?? one.height]"
    printed, shown = (
        page.run(f"(one => {pixels})(document.querySelector('{name}'))")
        for name in ("#view-printed img", "#view-space")
    )
    assert printed == shown
    assert shown[0] > 300


def test_without_webgl_there_are_stills_and_plots(file, result, tmp_path):
    """What cannot be shown is told on the page and nowhere else."""
    with chromium.Browser(tmp_path / "profile", "--disable-3d-apis") as page:
        page.open(file)
        page.run(DRAWN)
        assert page.run(f"{VISIBLE}('view-stills') && !{VISIBLE}('view-space')")
        assert "WebGL2" in page.run("document.getElementById('view-missing').textContent")
        assert readings(page, "Deployment angles")[1]["hl2"][1] == "deg"
        page.run("document.querySelectorAll('.plot .over')[0].focus()")
        key(page, "ArrowRight")
        assert readings(page, "Deployment angles")[0] == f"Recorded values at {result.time[1]:.6f} s"
        assert page.told == []


def test_a_scene_before_its_run(browser, tmp_path):
    """The page of `check` opens the scene by its slider, with angles over the way, and says nothing."""
    _, path = fanfold.plot(fanfold.check_scene("amos3", rigid="all"), tmp_path)
    browser.told.clear()
    browser.open(path)
    browser.run(DRAWN)
    stowed = browser.picture("stage")
    set_to(browser, "view-time", 50.0)
    assert browser.run("document.getElementById('view-clock').value") == "50.0 %"
    assert changed(stowed, browser.picture("stage")) > 0.02
    assert readings(browser, "Deployment angles")[1]["HL1"] == ["45.00", "deg"]
    assert browser.told == []


def test_stress_and_two_results(browser, tmp_path):
    """Colours of stress, and the largest of now as the analysis has it; a second result beside or over the first."""
    options = {"tolerance": 1e-3, "estimate": False, "signals": ("*.angle", "panel.*")}
    first = fanfold.simulate("workbench", until=0.05, **options)
    second = fanfold.simulate("workbench", until=0.04, rigid="all", **options)
    path = tmp_path / "two.html"
    path.write_text(report(first, [second], frame_count=1), encoding="utf-8")
    browser.told.clear()
    browser.open(path)
    row = int(np.searchsorted(first.time, 0.03))
    set_to(browser, "view-time", first.time[row])
    bodies = browser.picture("stage")
    set_to(browser, "view-colour", "stress", "change")
    assert changed(bodies, browser.picture("stage")) > 0.01
    told = browser.run("document.getElementById('view-reading').textContent")
    shown = 1e6 * float(told.partition("largest stress: panel ")[2].partition(" MPa")[0])
    assert shown == pytest.approx(stressed(first, "panel", np.array([row])).von_mises.max(), rel=0.03)
    beside = browser.picture("stage")
    set_to(browser, "view-arrangement", "over", "change")
    assert changed(beside, browser.picture("stage")) > 0.01
    labels = readings(browser, "Deployment angles")[1]
    assert {label[:3] for label in labels} == {"A: ", "B: "}
    paper = b64decode(browser.ask("Page.printToPDF", preferCSSPageSize=True)["data"])
    assert 1 <= len(re.findall(rb"/Type\s*/Page\b", paper)) <= 8
    assert browser.told == []
