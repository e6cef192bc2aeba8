"""Files that a study's scene is made of besides its own: a study that goes on must find them as they were."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ...scene.builder import Scene
from ...scene.digests import digests
from .distributions import StudyError


def refuse_changed(study: Path, scene: Scene, before: Mapping[str, str]) -> None:
    """StudyError where files are not what they were when the study of this file began."""
    now = digests(scene.check())
    changed = sorted(path for path in before if now.get(path) != before[path])
    if changed:
        are = "is" if len(changed) == 1 else "are"
        raise StudyError(
            f"{study}: {', '.join(changed)} {are} not as when this study began, so its samples would mix two models; "
            "put back what was there, or delete the journal and begin anew"
        )
