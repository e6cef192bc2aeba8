"""Which model each body of a scene gets: rigid, modal, or a beam of large deformation."""

from __future__ import annotations

from collections.abc import Collection

from ..scene.bodies import body_definition
from ..scene.body_tables import Body, Fidelity
from ..scene.placed_scene import PlacedScene
from ..scene.table import SceneError

_WORDS: dict[Fidelity, str] = {
    "rigid": "rigid", "flexible": "flexible", "large_deformation": "of large deformation"
}  # fmt: skip
_LACKING: dict[Fidelity, str] = {
    "flexible": "only a body of the catalogue, or with a panel, frame, beam or import, can be flexible",
    "large_deformation": "only a body with a beam can deform largely; it has none",
}


def choose_fidelity(
    scene: PlacedScene,
    rigid: Collection[str],
    flexible: Collection[str],
    large_deformation: Collection[str] = (),
) -> dict[str, Fidelity]:
    """Fidelity of each body: its default, unless named (or meant by "all") in one of the three sets."""
    bodies = {body.name: body for body in scene.bodies}
    asked: dict[Fidelity, Collection[str]] = {
        "rigid": rigid, "flexible": flexible, "large_deformation": large_deformation
    }  # fmt: skip
    problems = [
        f"{scene.file}: there is no body {name!r}; bodies are {', '.join(bodies)}"
        for name in sorted({*rigid, *flexible, *large_deformation} - {*bodies, "all"})
    ]
    chosen: dict[str, Fidelity] = {}
    for name, body in bodies.items():
        wanted = [
            fidelity
            for fidelity, names in asked.items()
            if name in names or ("all" in names and _can_be(body, fidelity))
        ]
        if len(wanted) > 1:
            both = " and ".join(_WORDS[fidelity] for fidelity in wanted)
            problems.append(f"{scene.file}: body.{name}: it cannot be both {both}")
        chosen[name] = wanted[-1] if wanted else body.default_fidelity
        if not _can_be(body, chosen[name]):
            problems.append(f"{scene.file}: body.{name}: {_LACKING[chosen[name]]}")
    if "all" in large_deformation and "large_deformation" not in chosen.values():
        problems.append(f"{scene.file}: no body has a beam, which --large-deformation is meant for")
    if problems:
        raise SceneError(problems)
    return chosen


def bending(scene: PlacedScene, rigid: Collection[str], flexible: Collection[str]) -> dict[str, bool]:
    """Whether each body bends."""
    return {name: fidelity != "rigid" for name, fidelity in choose_fidelity(scene, rigid, flexible).items()}


def has_beam(body: Body) -> bool:
    """Whether a body can be a beam of large deformation."""
    return body.can_bend and body_definition(body).beam is not None


def _can_be(body: Body, fidelity: Fidelity) -> bool:
    if fidelity == "large_deformation":
        return has_beam(body)
    return fidelity == "rigid" or body.can_bend
