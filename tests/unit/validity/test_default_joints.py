"""Modes that hang on the stiffness of joints which a scene does not state."""

from __future__ import annotations

import re
import warnings

import pytest

import orchestrator as fanfold

TUBE = {
    "diameter": 0.1, "wall": 1.5e-3, "youngs_modulus": 70e9, "poisson_ratio": 0.3, "density": 2700.0,
}  # fmt: skip
STATED = {"axial_stiffness": 2e6, "radial_stiffness": 5e6, "cross_stiffness": 2e4}
"""The defaults."""


def mast(parameters=None, **joint):
    """A tube of 2 m, about as stiff in bending as the joint of preset fixed that clamps it to the ground."""
    scene = fanfold.Scene("mast", until="1 s")
    ground = scene.base("ground", points={"o": (0, 0, 0)})
    beam = scene.body(
        "beam",
        place={"body": ground, "point": "o"},
        beam={"length": 2.0, "tube": TUBE, "attachment_points": {"root": 0.0, "tip": 2.0}},
    )
    ports = {"inboard": (ground, "o"), "outboard": (beam, "root")}
    scene.connection("clamp", preset="fixed", ports=ports, parameters=parameters or {})
    if joint:
        scene.joint(**joint)
    return scene


def modes_and_sentences(scene):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = fanfold.modes(scene)
    sentences = [str(one.message) for one in caught]
    return found, [s for s in sentences if "W-joint-stiffness" in s]


def test_a_share_tells_what_stiffness_does_to_the_frequency():
    """Rayleigh: f changes by half the share of what the stiffness changes by, to first order; a hundredth here."""
    found, (sentence,) = modes_and_sentences(mast())
    match = re.fullmatch(r"mast: mode (?P<mode>\d+) .*\((?P<share>\d+)% .* clamp\).*", sentence)
    assert match
    stiffer, none = modes_and_sentences(mast(**{name: 1.01 * k for name, k in STATED.items()}))
    assert not none
    rise = stiffer.frequencies[int(match["mode"]) - 1] / found.frequencies[int(match["mode"]) - 1] - 1.0
    assert 2.0 * rise / 0.01 == pytest.approx(int(match["share"]) / 100.0, abs=0.01)


def test_stated_joints_are_believed():
    """The same stiffness as by default, stated."""
    assert not modes_and_sentences(mast(**STATED))[1]


def test_what_a_joint_says_itself_is_believed():
    """Rule: the numbers of the default, stated by the joint; a radial stiffness that is the axial one by default."""
    own = {"translational_stiffness": (5e6,) * 3, "rotational_stiffness": (2e4,) * 3}
    assert not modes_and_sentences(mast(own))[1]
    assert not modes_and_sentences(mast(radial_stiffness=STATED["axial_stiffness"], cross_stiffness=3e4))[1]


@pytest.mark.parametrize("scene", ["workbench", "bepicolombo", "amos3"])
def test_scenes_state_their_joints(scene):
    """What the program ships says itself how stiff its joints are."""
    assert not modes_and_sentences(fanfold.load(scene))[1]
