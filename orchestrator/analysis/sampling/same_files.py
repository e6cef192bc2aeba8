"""Files that a study's scene is made of besides its own: a study that goes on must find them as they were."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path

from components.contract.regular import content

from ...scene.bodies import body_files
from ...scene.builder import Scene
from ...scene.layers import files_besides
from .distributions import StudyError


def digests(scene: Scene) -> dict[str, str]:
    """SHA-256 of the content of every such file by its path, empty where one cannot be read."""
    named = [Path(path) for path in files_besides(scene.tree)]
    read = [path for body in scene.check().bodies for path in body_files(body)]
    return {str(path): _digest(path) for path in dict.fromkeys((*named, *read))}


def refuse_changed(study: Path, scene: Scene, before: Mapping[str, str]) -> None:
    """StudyError where files are not what they were when the study of this file began."""
    now = digests(scene)
    changed = sorted(path for path in before if now.get(path) != before[path])
    if changed:
        are = "is" if len(changed) == 1 else "are"
        raise StudyError(
            f"{study}: {', '.join(changed)} {are} not as when this study began, so its samples would mix two models; "
            "put back what was there, or delete the journal and begin anew"
        )


def _digest(path: Path) -> str:
    try:
        return hashlib.sha256(content(path)).hexdigest()
    except OSError:
        return ""
