"""What Python asks of the documents."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

from components import FanfoldError
from components.cache import disk

_INDEX, _STAMP = "index.html", "fanfold.stamp"
_PACKAGES = ("components", "fmus", "orchestrator")


def json_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of scene files, for editors that complete keys and check them while one types.

    Every quantity has its SI `unit` beside the words of JSON Schema; every key has its meaning as `description`.
    """
    from ...scene.keys.json_schema import scene_schema

    return scene_schema()


def docs(folder: str | Path | None = None, *, gallery: bool = True, rebuild: bool = False) -> Path:
    """The first page of the documents, which are built where they are not there or are of other sources.

    folder: where they are kept, by default beside the cache. gallery: run the examples too, which takes a minute or
    two. rebuild: build them in any case, so that times and numbers are measured anew. Building needs the extra `docs`;
    FanfoldError says so.
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
