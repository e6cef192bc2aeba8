"""Scenes as parts and links: fidelities by flag, modes by number, every part a component, every port linked once."""

import pytest

from components import REGISTRY
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.participant import InProcess
from orchestrator.scene import SceneError, find_scene, load_scene
from orchestrator.scene.builder import Scene
from tests.unit.scene.scene_cases import SCENES, TWO_PANELS, amos3, load_text, parts_of


@pytest.mark.parametrize(
    ("rigid", "flexible", "sentence"),
    [
        ({"wing"}, set(), "'wing'.*inner, outer"),
        ({"inner"}, {"inner"}, "body.inner: .*rigid .*flexible"),
        (
            set(),
            {"inner"},
            "body.inner: .*panel, frame",
        ),
    ],
)
def test_impossible_fidelities_are_sentences(tmp_path, rigid, flexible, sentence):
    with pytest.raises(SceneError, match=sentence):
        assemble(load_text(tmp_path, TWO_PANELS), rigid, flexible)


def test_fidelity_flags_override_the_scene():
    assembly = assemble(amos3(), rigid={"yoke", "panel1"})
    modes = {p.name: len(p.structure["modal"]["frequency"]) for p in assembly.parts if p.kind == "body"}
    assert modes == {"yoke": 0, "panel1": 0, "panel2": 16}
    assert assembly.geometry["panel2"].shapes.shape[2] == 16


def test_modes_can_be_switched_off():
    """By the numbers of the full body's modes: without the first, the others are what they were."""
    settings = {"body.panel2.modes_off": [0], "body.panel2.damping_ratio": "2 %"}
    scene = Scene.load("amos3", settings=settings).check()
    full, modal = (
        parts_of(assemble(s, rigid={"yoke", "panel1"}))["panel2"].structure["modal"] for s in (amos3(), scene)
    )
    assert len(modal["frequency"]) == 15
    assert list(modal["frequency"]) == list(full["frequency"][1:])
    assert set(modal["damping_ratio"]) == {0.02}


@pytest.mark.parametrize("mode", ["mean", "endpoint"])
@pytest.mark.parametrize("source", ["amos3", "two_panels", "two_panels_free"])
def test_every_part_is_a_component_with_possible_parameters_and_every_port_is_linked_once(source, mode):
    path = find_scene(source) if source == "amos3" else SCENES / f"{source}.toml"
    assembly = assemble(load_scene(path), rigid={"all"}, wrench_mode=mode)
    linked = [end for link in assembly.links for end in (link.body, link.connection)]
    ports = []
    for part in assembly.parts:
        component = REGISTRY[part.kind](**part.structure)
        InProcess(part.name, component, part.start)
        ports += [(part.name, port.name) for port in component.ports]
    assert sorted(linked) == sorted(ports)


def test_a_free_base_is_a_rigid_body_of_the_same_name():
    assembly = assemble(load_scene(SCENES / "two_panels_free.toml"))
    base = parts_of(assembly)[assembly.base]
    assert base.kind == "body"
    assert base.structure["modal"]["mass"] == 1500.0
