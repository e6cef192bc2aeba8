"""What Python asks of the documents."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

from components import FanfoldError
from components.cache import disk

from ..options import Folder

_INDEX, _STAMP = "index.html", "fanfold.stamp"
_PACKAGES = ("components", "fmus", "orchestrator")


def json_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of scene files, for completion and checks in editors.

    Returns
    -------
    dict
        Schema; every quantity has its SI `unit`, every key its meaning as `description`.
    """
    from ...scene.keys.json_schema import scene_schema

    return scene_schema()


def docs(folder: Folder | None = None, *, gallery: bool = True, rebuild: bool = False) -> Path:
    """Build the documents if they are not there or are of other sources.

    Parameters
    ----------
    folder
        Folder of the pages; by default next to the cache.
    gallery
        Run the examples too, which takes a minute.
    rebuild
        Build again, and measure times and numbers on this machine again.

    Returns
    -------
    Path
        The first page.

    Raises
    ------
    FanfoldError
        If the extra `docs` is missing, or there is no folder for the pages.
    """
    from .build import ROOT, build

    target = _folder() if folder is None else Path(folder)
    stamp = f"{_digest(ROOT)} {'with' if gallery else 'without'} gallery"
    stamped = target / _STAMP
    is_built = (
        (target / _INDEX).is_file() and stamped.is_file() and stamped.read_text(encoding="utf-8") == stamp
    )
    if rebuild or not is_built:
        build(target, gallery)
        stamped.write_text(stamp, encoding="utf-8")
    return target / _INDEX


def _folder() -> Path:
    place = disk.written_folder()
    if place is None:
        raise FanfoldError("there is no folder that the documents could be kept in; name one")
    return place / "documents"


def _digest(documents: Path) -> str:
    """Of everything that the documents are made from."""
    packages = [Path(__file__).parents[3] / name for name in _PACKAGES]
    content = hashlib.sha256()
    for folder in (*packages, documents / "docs", documents / "examples"):
        for path in sorted(folder.rglob("*")):
            if path.suffix in (".py", ".md", ".toml", ".svg"):
                content.update(path.read_bytes())
    return content.hexdigest()
