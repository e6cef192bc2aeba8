"""Numbers of the catalogue's data files, SI."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from importlib.resources import files
from typing import Any


def values(table: Mapping[str, Any]) -> dict[str, Any]:
    """Numbers of a data table whose entries are `{value, unit, source}`, sub-tables included."""
    return {k: v["value"] if "value" in v else values(v) for k, v in table.items()}


def catalogue_data(system: str) -> dict[str, Any]:
    """Numbers of data/`system`.toml: workbench, tube, amos3, bepicolombo or arabsat."""
    text = (files("components") / "data" / f"{system}.toml").read_text(encoding="utf-8")
    return values(tomllib.loads(text))
