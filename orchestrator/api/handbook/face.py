"""What Python asks of the documents."""

from __future__ import annotations

from typing import Any


def json_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of scene files, for editors that complete keys and check them while one types.

    Every quantity has its SI `unit` beside the words of JSON Schema; every key has its meaning as `description`.
    """
    from ...scene.keys.json_schema import scene_schema

    return scene_schema()
