"""Identifiers of headline numbers: a convention that files, scripts and targets rest on."""

import pytest

from orchestrator.results.identifiers import identifier, in_order


@pytest.mark.parametrize(
    ("quantity", "of", "expected"),
    [
        ("latch time", "HL1", "latch_time.HL1"),
        ("interface force magnitude peak", "", "interface_force_peak"),
        ("numerical energy loss", "", "numerical_loss"),
        ("strand A tension min", "loop", "tension_a_min.loop"),
        ("contact force max", "pad", "contact_force_max.pad"),
    ],
)
def test_of_headline_numbers(quantity, of, expected):
    assert identifier(quantity, of) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("HL1.latch_time", "latch_time.HL1"),
        ("latch_time.HL1", "latch_time.HL1"),
        ("x.interface_force_peak", "interface_force_peak.x"),
        ("interface_force_peak.left_peak", "interface_force_peak.left_peak"),
        ("motor_energy", "motor_energy"),
        ("HL1.latch_tome", "HL1.latch_tome"),
    ],
)
def test_what_it_is_of_may_stand_in_front(text, expected):
    assert in_order(text) == expected
