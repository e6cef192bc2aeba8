"""Files of bodies from outside: what is wrong with them, and what stays of an earlier one."""

import pytest

from components import ComponentError
from orchestrator.scene import data_sheets
from tests.references.catalogue import entry

PANEL = """
[mine]
like = ["honeycomb_panel"]
panel.hinge_lines.inboard = "hl"
panel.length = "1.7 m"
panel.width = {{ value = 1.2, unit = "m", source = "measured" }}
{more}
"""
WRONG = {
    "panel.length = 3": "table of bodies",
    "panel.start = '1 kg'": "mine.panel.start: ",
    "panel.thickness = 1": "mine.panel.thickness: ",
    "panel.start = { value = 1 }": "'unit'",
    "[workbench_panel]": "workbench_panel: there is such a body",
    "[other]\nlike = ['none']": "other.like: .*'none'",
    "[other]\nlike = ['other']": "other.like: .*circle",
    "[other]\nlike = 3": "other.like: .*names",
    "[other]\npanel.length = 1": "other.panel: .*sandwich",
    "[other]\nlike = ['amos3_yoke']\nframe.members = [{ name = 'bar' }, { name = 'bar' }]": "frame.members: .*'bar'",
}


@pytest.fixture
def sheet(tmp_path, monkeypatch):
    monkeypatch.setattr(data_sheets, "_added", {})
    path = tmp_path / "mine.toml"
    path.write_text(PANEL.format(more=""))
    data_sheets.add_sheet(path)
    return path


def test_quantities_are_those_of_scenes_or_stated_with_a_unit(sheet):
    plate = entry("mine").panel.plate
    assert (plate.length, plate.width, plate.areal_mass) == (1.7, 1.2, 4.3)


@pytest.mark.parametrize("more", WRONG)
def test_what_is_wrong_is_told_and_the_earlier_bodies_stay(sheet, more):
    sheet.write_text(PANEL.format(more=more))
    with pytest.raises(ComponentError, match=f"mine.toml: .*{WRONG[more]}"):
        data_sheets.add_sheet(sheet)
    assert entry("mine").panel.plate.length == 1.7


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(ComponentError, match=r"none.toml: "):
        data_sheets.add_sheet(tmp_path / "none.toml")
