"""A sample of the benchmark of mutated scenes: refused with sentences, or sound enough to be looked at and run."""

import pytest

from tests.benchmark.faults import scenes

pytestmark = pytest.mark.slow


def test_mutated_scenes_are_refused_with_sentences(tmp_path):
    """Twenty of them; 30 and 40 pass the check and are run."""
    assert list(scenes.faults(20, 26, tmp_path)) == []


def test_what_is_no_sentence_is_seen(tmp_path, monkeypatch):
    """Control: an exception of another kind is a fault."""
    monkeypatch.setattr(scenes.fanfold, "check_scene", lambda scene: 1 / 0)
    assert any("ZeroDivisionError" in fault.what for fault in scenes.faults(4, 9, tmp_path))
