"""The data files of the catalogue."""

import tomllib
from importlib.resources import files

import pytest

from components.catalogue import catalogue_data

SYSTEMS = ("workbench", "tube", "amos3", "bepicolombo", "arabsat")


def leaves(table, path=()):
    for key, entry in table.items():
        here = (*path, key)
        yield from [(here, entry)] if "value" in entry else leaves(entry, here)


def raw(system):
    return tomllib.loads((files("components") / "data" / f"{system}.toml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("system", SYSTEMS)
def test_every_value_has_unit_and_source(system):
    """Bookkeeping: value, unit and a source that says whether it is given, derived or assumed."""
    found = list(leaves(raw(system)))
    assert found
    for path, entry in found:
        assert set(entry) == {"value", "unit", "source"}, path
        assert entry["source"].split(":")[0].split(" ")[0] in ("given", "derived", "assumed"), path


@pytest.mark.parametrize("system", ["amos3", "bepicolombo", "arabsat"])
def test_no_value_stands_twice(system):
    """Bookkeeping: a wing's file names only what differs from the common plate, arm, hardware and tube."""
    common = {path: entry["value"] for name in ("workbench", "tube") for path, entry in leaves(raw(name))}
    for path, entry in leaves(raw(system)):
        assert common.get(path) != entry["value"], path


def test_numbers_alone():
    """Bookkeeping: tables keep their names, entries become their values."""
    assert catalogue_data("workbench")["plate"]["length"] == 1.5
    assert catalogue_data("tube") == {"tube": catalogue_data("tube")["tube"]}
    assert catalogue_data("tube")["tube"]["youngs_modulus"] == 120e9
