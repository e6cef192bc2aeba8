"""The scene that an SSP file carries: what it was exported from, as long as its system is still the same.

Its FMUs are for tools that do not iterate, so a run builds its own from the scene and couples these.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile

import tomli_w

from ..body_tables import Fidelity
from ..table import SceneError

MEMBER = "resources/scene.json"
_SCENE, _SYSTEM, _OF_SCENE = "scene", "system", "digest"


def carried(tree: Mapping[str, Any], fidelities: Mapping[str, Fidelity], system: Mapping[str, bytes]) -> str:
    """What an SSP file carries as `MEMBER`: a scene with the fidelity of its bodies by name, and digests.

    system: contents of the other members by name, which the scene stands for.
    """
    bodies = [
        {**body, "fidelity": fidelities[body["name"]]} if body.get("name") in fidelities else body
        for body in tree.get("body", ())
    ]
    scene = tomli_w.dumps({**tree, **({"body": bodies} if bodies else {})})
    digests = {name: _digest(content) for name, content in system.items()}
    return json.dumps({_SCENE: scene, _OF_SCENE: _digest(scene.encode()), _SYSTEM: digests})


def scene_of(path: Path) -> str:
    """The text of the scene that an SSP file carries; SceneError for one that has none, or whose system was changed."""
    from fmus.archive import archive_problems  # takes its time, which scene files need not

    if problems := list(archive_problems(path)):
        raise SceneError([f"{path.name}: cannot be read as an SSP file: {problems[0]}"])
    try:
        with ZipFile(path) as archive:
            sizes = {member.filename: member.file_size for member in archive.infolist()}
            if MEMBER not in sizes:
                raise SceneError(
                    [
                        f"{path.name}: holds no scene, as SSP files that Fanfold exports do; FMUs of other tools run "
                        "as [[fmu]] of a scene"
                    ]
                )
            found = json.loads(archive.read(MEMBER))
            scene, system = found[_SCENE], found[_SYSTEM]
            lost = sorted(system.keys() - sizes.keys())
            there = system.items() if not lost else ()
            changed = [name for name, digest in there if _digest(archive.read(name)) != digest]
            changed += sorted(sizes.keys() - system.keys() - {MEMBER})
            digest_of_scene = _digest(scene.encode())
            if found.get(_OF_SCENE, digest_of_scene) != digest_of_scene:
                changed.append(MEMBER)
    except (
        BadZipFile,
        OSError,
        ValueError,
        KeyError,
        TypeError,
        AttributeError,
        RecursionError,
    ) as error:
        raise SceneError([f"{path.name}: is damaged, or no SSP file: {error}"]) from None
    if lost:
        raise SceneError([f"{path.name}: {', '.join(lost)} of the file that was exported is missing"])
    if changed:
        names = ", ".join(changed)
        raise SceneError(
            [
                f"{path.name}: its scene is that of the file that was exported, and since then others were put in "
                f"place of {names}; lay changes over the scene, with --set, and export it again"
            ]
        )
    return str(scene)


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
