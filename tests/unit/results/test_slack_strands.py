"""Slack strands: definition, on made-up tensions."""

from types import SimpleNamespace

import numpy as np

from components.contract.roles import LOAD
from orchestrator.results.slack_strands import Slack, slack_strands

TENSIONS = {
    "tension_a": [5.0, 0.0, 3.0, 0.0, 0.0, 0.0, 4.0],  # slack twice, the second time longer
    "tension_b": [1.0] * 7,
    "tension": [0.0] * 7,  # never taut
    "tension_c": [-1.0, -0.5, 0.5, 2.0, 1.0, -0.5, 3.0],  # a spring that pushes and pulls
    "axial_force": [0.0, 1.0] * 3 + [0.0],  # no tension of a strand
}


def test_the_longest_stretch_of_a_strand():
    result = SimpleNamespace(
        time=np.arange(7.0),
        in_role=lambda role: [("loop", name) for name in TENSIONS if role == LOAD],
        signal=lambda name, variable: np.array(TENSIONS[variable]),
    )
    assert slack_strands(result) == (Slack("loop", "tension_a", 3.0, 5.0),)
