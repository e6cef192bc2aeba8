"""Functions of the documents for Python."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

from components import FanfoldError
from components.cache import disk

_INDEX, _STAMP = "index.html", "fanfold.stamp"
_PACKAGES = ("components", "fmus", "orchestrator")


def json_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of scene files, for completion and checks in editors.

    Returns
    -------
    dict
        schema; every quantity has its SI `unit`, every key its meaning as `description`
    """
    from ...scene.keys.json_schema import scene_schema

    return scene_schema()


def docs(folder: str | Path | None = None, *, gallery: bool = True, rebuild: bool = False) -> Path:
    """Build the documents if they are missing or out of date, and return their first page.

    Parameters
    ----------
    folder : str or Path, optional
        folder of the pages; by default next to the cache
    gallery : bool
        also run the examples, which takes one or two minutes; by default True
    rebuild : bool
        build in any case

    Returns
    -------
    Path
        first page (HTML)

    Raises
    ------
    FanfoldError
        if the extra `docs` is not installed
    """
    from .build import build

    target = _folder() if folder is None else Path(folder)
    stamp = f"{_digest()} {'with' if gallery else 'without'} gallery"
    known = target / _STAMP
    is_built = (target / _INDEX).is_file() and known.is_file() and known.read_text(encoding="utf-8") == stamp
    if rebuild or not is_built:
        build(target, gallery)
        known.write_text(stamp, encoding="utf-8")
    return target / _INDEX


def _folder() -> Path:
    place = disk.written_folder()
    if place is None:
        raise FanfoldError("there is no folder that the documents could be kept in; name one")
    return place / "documents"


def _digest() -> str:
    """Of everything that the documents are made from."""
    root = Path(__file__).parents[3]
    content = hashlib.sha256()
    for package in _PACKAGES:
        for path in sorted((root / package).rglob("*")):
            if path.suffix in (".py", ".md", ".toml"):
                content.update(path.read_bytes())
    return content.hexdigest()
