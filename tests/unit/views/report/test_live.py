"""The live report in headless Chromium: the wing runs in the page, as `fanfold run --set` would run it."""

import re
from importlib.util import find_spec
from time import monotonic, sleep

import pytest

import orchestrator as fanfold
from components import FanfoldError
from fmus.native import platforms
from tests.unit.views.report import browser as chromium

needs_browser = [
    pytest.mark.slow,
    pytest.mark.skipif(
        chromium.CHROMIUM is None, reason="Chromium is not installed (Debian: apt install chromium)"
    ),
    pytest.mark.skipif(
        find_spec("ziglang") is None, reason="Zig is not installed (pip install '.[platforms]')"
    ),
]
PATIENCE = 120.0
"""s, for a run on a busy machine."""
SETTINGS = {"hinge_line.HL.motor.stowed": "2.7 N.m"}


@pytest.fixture(scope="module")
def result():
    return fanfold.simulate("workbench", rigid="all")


@pytest.fixture(scope="module")
def page(result, tmp_path_factory):
    """A page that has run with the values of the scene."""
    folder = tmp_path_factory.mktemp("live")
    path = fanfold.report(
        result,
        folder / "live.html",
        frames=1,
        live=True,
        slider="hinge_line.HL.motor.stowed=1.8..3.2 N.m",
        require="latch_torque_peak < 150 N.m",
    )
    assert path.stat().st_size < 6e6
    with chromium.Browser(folder / "profile") as browser:
        browser.open(path)
        wait(browser, 1)
        yield browser


def wait(page, run):
    """Until the page has made so many runs."""
    end = monotonic() + PATIENCE
    while int(page.run("document.getElementById('live').dataset.run || 0")) < run:
        assert monotonic() < end, page.run("document.body.innerText")
        sleep(0.05)


def numbers(page):
    """Numbers of the reference and the run by quantity and component, with all their digits, and what differs."""
    rows = page.run("""[...document.querySelectorAll("#live-numbers tbody tr")]
        .map(row => [...row.children].map(cell => cell.title || cell.textContent))""")
    return {(row[0], row[1]): [*map(float, row[2:4]), row[4]] for row in rows}


@pytest.mark.usefixtures("result")
class TestPage:
    """One page, in this order."""

    pytestmark = needs_browser

    def test_a_run_with_the_values_of_the_scene(self, page, result):
        """Identity: the stored result, by the same steps; the words of its verdict; no message and no request."""
        assert page.told == []
        words = page.run("document.getElementById('live-verdict').textContent")
        assert words.startswith(result.headline.verdict)
        found = numbers(page)
        assert found["latch time", "HL"][:2] == pytest.approx([result.latch_times["HL"]] * 2, abs=1e-5)
        assert found["latch time", "HL"][2] == "within the error"
        peak = result.headline.latch_torque_peaks["HL"]
        assert found["latch torque peak", "HL"][:2] == pytest.approx([peak] * 2, rel=1e-5)

    def test_a_slider_moved(self, page):
        """Identity: `fanfold run --set` of the same scene, within the tolerance of both."""
        key, text = next(iter(SETTINGS.items()))
        page.run(f"""(() => {{ const slider = document.getElementById("live-{key}");
            slider.value = {text.split()[0]}; slider.dispatchEvent(new Event("input"));
            slider.dispatchEvent(new Event("change")); }})()""")
        wait(page, 2)
        scene = fanfold.load("workbench", settings=SETTINGS)
        exact = fanfold.simulate(scene, rigid="all", estimate=False)
        found = numbers(page)
        assert found["latch time", "HL"][1] == pytest.approx(exact.latch_times["HL"], rel=1e-4)
        peak = exact.headline.latch_torque_peaks["HL"]
        assert found["latch torque peak", "HL"][1] == pytest.approx(peak, rel=1e-4)
        words = page.run("document.getElementById('live-verdict').textContent")
        assert "1 of 1 requirements is not met: latch_torque_peak.HL < 150 N.m" in words
        cells = page.run(
            """[...document.querySelectorAll("#live-requirements td")].map(cell => cell.textContent)"""
        )
        assert cells[4] == "not met"
        assert float(cells[2].split()[0]) == pytest.approx(peak, rel=1e-3)
        events = page.run("document.getElementById('view-events').textContent")
        assert f"run: HL latch-up, {exact.latch_times['HL']:.3f} s" in events

    def test_a_run_is_kept(self, page):
        """What it is compared with from then on; playing moves both."""
        page.run("document.getElementById('live-keep').click()")
        row = numbers(page)["latch time", "HL"]
        assert row[0] == row[1]
        words = page.run("document.getElementById('live-reference-verdict').textContent")
        assert words.startswith("Kept run 1: HL motor stowed 2.7 N.m. HL latched at 3.98")
        assert "kept 1: HL" in page.run("document.getElementById('plots-list').textContent")
        page.run("document.getElementById('view-play').click()")
        end = monotonic() + PATIENCE
        while float(page.run("document.getElementById('view-time').value")) == 0.0:
            assert monotonic() < end
            sleep(0.05)
        assert page.told == []


def test_no_compiler(result, tmp_path, monkeypatch):
    """Bad input: a sentence, before anything is assembled."""

    def absent(name):
        raise platforms.PackageNotFoundError(name)

    monkeypatch.setattr(platforms, "version", absent)
    platforms.cross_compiled.cache_clear()
    with pytest.raises(FanfoldError, match=r"needs Zig: pip install '\.\[platforms\]'"):
        fanfold.report(result, tmp_path / "live.html", live=True)
    platforms.cross_compiled.cache_clear()
    with pytest.raises(FanfoldError, match="--live"):
        fanfold.report(result, tmp_path / "live.html", slider="friction.coefficient=0..1")


def test_a_notebook_shows_a_page(result):
    """HTML 4.8.5: a frame with the page as text. CSP 3: styles by their hash, WebAssembly only in a live page."""
    shown = result.view(height=500)
    frame = shown._repr_html_()
    assert frame.startswith('<iframe sandbox="allow-scripts" style="width: 100%; height: 500px')
    assert frame.count("<") == 2
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', shown.html)[1]
    assert "unsafe" not in policy
    assert "style-src 'sha256-" in policy
