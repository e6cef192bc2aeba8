"""The data sheets of the catalogue."""

import tomllib
from importlib.resources import files

import pytest

from tests.references import catalogue

SHEETS = ("workbench", "amos3", "bepicolombo", "arabsat")


def leaves(table, path=()):
    """Places and values of all that is no table: numbers with unit and source, and what only names or chooses."""
    for key, entry in table.items():
        here = (*path, key)
        if isinstance(entry, dict) and "value" not in entry:
            yield from leaves(entry, here)
        elif isinstance(entry, list) and entry and isinstance(entry[0], dict):
            for k, one in enumerate(entry):
                yield from leaves(one, (*here, k))
        else:
            yield here, entry


def raw(sheet):
    return tomllib.loads((files("components") / "data" / f"{sheet}.toml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("sheet", SHEETS)
def test_every_value_has_unit_and_source(sheet):
    """Bookkeeping: value, unit and a source that says whether it is given, derived or assumed; mesh sizes have none."""
    found = [(path, entry) for path, entry in leaves(raw(sheet)) if isinstance(entry, dict)]
    assert found
    for path, entry in found:
        assert set(entry) == {"value", "unit", "source"}, path
        assert entry["source"].split(":")[0].split(" ")[0] in ("given", "derived", "assumed"), path
    for path, entry in leaves(raw(sheet)):
        plain = isinstance(entry, int | float) and not isinstance(entry, bool)
        assert not plain or path[-1] == "elements", path


@pytest.mark.parametrize("sheet", SHEETS)
def test_no_value_stands_twice(sheet):
    """Bookkeeping: a body says only what it does not have from those that it is like."""
    tables = {name: table for other in SHEETS for name, table in raw(other).items()}
    for table in raw(sheet).values():
        waiting = list(table.get("like", ()))
        while waiting:
            other = tables[waiting.pop()]
            waiting += other.get("like", ())
            inherited = dict(leaves(other))
            for path, entry in leaves(table):
                if path[0] != "like" and isinstance(entry, dict):
                    assert inherited.get(path, {}).get("value") != entry["value"], path


def test_values_of_entries():
    """Bookkeeping: what is written in the sheets is what bodies have, over what they are like."""
    plate = catalogue.entry("arabsat_panel").panel.plate
    assert (plate.length, plate.bending[0]) == (2.50, 14000.0)
    assert plate.membrane == catalogue.entry("workbench_panel").panel.plate.membrane
    tube = raw("amos3")["tube_frame"]["frame"]["tube"]
    section = catalogue.entry("bepicolombo_inboard").frame.members[0].section
    area = 3.141592653589793 * (0.015**2 - 0.0135**2)
    assert section.axial == pytest.approx(tube["youngs_modulus"]["value"] * area, rel=1e-12)
