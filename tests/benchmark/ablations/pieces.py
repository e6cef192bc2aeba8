"""What joining bodies that are held saves: ARABSAT phase 1, the outer panel opens from the held stack.

Joined: the spacecraft, the yoke and four panels are one piece (the scene as it is). Locked: they are bodies of their
own on hinges whose latches hold from the start, each a lock of 1e8 N.m/rad. One panel: a scene that has never
heard of the others, the outer panel on a fixed base.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from orchestrator.assembly import Assembly
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.participant import Participant
from orchestrator.run.run import as_fmus
from orchestrator.scene import find_scene, load_scene, read_scene
from tests.benchmark.ablations.rows import Row

UNTIL = 14.0
HELD = ("HL1", "HL2", "HL3", "HL4", "HL5")
INNER_LOOPS = ("yoke_loop", "panel1_loop", "panel2_loop", "panel3_loop")
_LOCK = '{ kind = "kinematic", stiffness = "2500 N.m/rad", effective_inertia = "38 kg.m2" }'


def joined() -> Assembly:
    """Phase 1 as the scene has it."""
    return assemble(load_scene(find_scene("arabsat"), ["phase1"]))


def locked(*, flexible: bool) -> Assembly:
    """Phase 1 with the held lines as hinges with kinematic latches, panel 4 flexible or rigid.

    What acts between held bodies only, drive and inner loops, is left out as it is where they are joined.
    """
    settings = [f"hinge_line.{line}.held=false" for line in HELD]
    settings += [f"hinge_line.{line}.latch={_LOCK}" for line in HELD]
    settings += ["connection.sadm.remove=true", *(f"ccl.{loop}.remove=true" for loop in INNER_LOOPS)]
    scene = load_scene(find_scene("arabsat"), ["phase1"], settings)
    return assemble(scene, rigid=() if flexible else {"panel4"})


def one_panel() -> Assembly:
    """The outer panel alone, its line on a base that has the points of panel 4."""
    scene = load_scene(find_scene("arabsat"), ["phase1"])
    line = next(line for line in scene.tree["hinge_line"] if line["name"] == "HL6")
    points = scene.points[line["inboard"]]
    names = {hinge["inboard"] for hinge in line["hinges"]}
    tree = {
        "scene": {**scene.tree["scene"], "phases": []},
        "friction": scene.tree["friction"],
        "body": [body for body in scene.tree["body"] if body["name"] == line["outboard"]],
        "base": {"name": "spacecraft", "points": {name: list(points[name]) for name in names}},
        "hinge_line": [{**line, "inboard": "spacecraft"}],
        "damper": scene.tree["damper"],
    }
    return assemble(read_scene("one_panel", tree))


@contextmanager
def with_locks(assembly: Assembly) -> Iterator[Sequence[Participant]]:
    """Native FMUs, the latches of the held lines commanded before the first step."""
    hinges = {hinge for line in assembly.hinge_lines if line.name in HELD for hinge in line.hinges}
    with as_fmus(assembly, "native") as participants:
        for participant in participants:
            if participant.name in hinges:
                participant.inputs[participant.input_layout["latch_command"]] = 1.0
        yield participants


def rows() -> list[Row]:
    """The joined stack first, then what it is measured against."""
    return [
        Row("stack joined to one piece", joined()),
        Row("one panel on a base", one_panel()),
        Row("stack on locked hinges", locked(flexible=False), load=with_locks),
        Row("stack on locked hinges, panel 4 flex.", locked(flexible=True), load=with_locks),
    ]


def print_ratio(found: Sequence[Row]) -> None:
    """The cost of the joined stack beside that of one panel."""
    stack, panel, hinges = found[0], found[1], found[2]
    print(
        f"joined stack {stack.wall:.3f} s, one panel {panel.wall:.3f} s: ratio {stack.wall / panel.wall:.2f} "
        f"(at most 1.3); on locked hinges {hinges.wall / panel.wall:.1f}"
    )
