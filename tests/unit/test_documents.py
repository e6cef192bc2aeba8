"""Documents say what there is: every message code, and paths that exist."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from orchestrator.messages import CODES

DOCUMENTS = Path(__file__).parents[2] / "docs"
WITH_EVIDENCE = ("validation.md", "performance.md", "extending.md", "../CONTRIBUTING.md")


def test_every_message_code_is_explained():
    """Completeness: the page has the codes and meanings of `CODES`, each with something to do."""
    text = (DOCUMENTS / "messages.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([WN]-[a-z-]+)` \| (.+?) \| (.+?) \|$", text, re.MULTILINE)
    assert {code: meaning for code, meaning, _ in rows} == CODES
    assert len(rows) == len(CODES)


@pytest.mark.parametrize("page", WITH_EVIDENCE)
def test_evidence_exists(page):
    """Completeness: tests, benchmarks and files that a page names are in the repository."""
    text = (DOCUMENTS / page).read_text(encoding="utf-8")
    root = DOCUMENTS.parent
    paths = re.findall(r"((?:components|fmus|orchestrator|tests|examples)/[\w/.]*\w)", text)
    modules = [name.replace(".", "/") for name in re.findall(r"python -m ((?:tests|fmus)[.\w]*\w)", text)]
    assert paths
    missing = [path for path in paths if not (root / path).exists()]
    missing += [
        m for m in modules if not ((root / f"{m}.py").exists() or (root / m / "__main__.py").exists())
    ]
    assert missing == []


@pytest.mark.slow
def test_the_recipe_by_impulses(tmp_path, monkeypatch):
    """Independent path: latch times of the scene with the spacecraft built in, `amos3 --variant free`, all rigid."""
    monkeypatch.chdir(tmp_path)
    text = (DOCUMENTS.parent / "examples/wing_on_a_spacecraft.py").read_text(encoding="utf-8")
    found = {}
    exec(compile(text.replace("END = 10e-3, 14.0", "END = 10e-3, 8.5"), "recipe", "exec"), found)
    assert found["latch_times"]["HL3"] == pytest.approx(7.39688, abs=1e-4)
    assert found["latch_times"]["HL2"] == pytest.approx(8.47970, abs=1e-4)
