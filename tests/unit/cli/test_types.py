"""Values of options: units that must be written down, ranges, pictures."""

from __future__ import annotations

from math import pi

import click
import pytest

from orchestrator.cli.types import Count, Number, OutputFile, Picture, Several, given_quantity


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("45deg", "rad", pi / 4.0),
        (" -45 deg ", "rad", -pi / 4.0),
        (".5rad", "rad", 0.5),
        ("5.e-1 rad", "rad", 0.5),
        ("51.3N.m/deg", "N.m/rad", 51.3 * 180.0 / pi),
        ("20 N.mm", "N.m", 0.02),
    ],
)
def test_a_quantity_has_its_unit(text, unit, value):
    assert given_quantity(text, unit, "it") == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "unit", "sentence"),
    [
        ("45", "rad", "45rad or 45deg"),
        ("0", "rad", "0rad or 0deg"),
        ("", "N.m", "1N.m or 1N.mm"),
        ("deg", "rad", "1rad or 1deg"),
        ("45grad", "rad", "'45grad'"),
        ("51.3N.m", "N.m/rad", "51.3N.m/rad or 51.3N.m/deg"),
        ("1..deg", "rad", "'1..deg'"),
        ("nandeg", "rad", "finite"),
        ("1e999rad", "rad", "finite"),
        ("-1N.m", "N.m", "'-1 N.m'"),
    ],
)
def test_what_is_no_quantity_is_told(text, unit, sentence):
    """Nothing is assumed: a number without a unit, or with that of something else, is refused."""
    with pytest.raises(click.BadParameter) as refused:
        given_quantity(text, unit, "it", "zero or positive")
    assert sentence in refused.value.message


@pytest.mark.parametrize(("text", "value"), [("8ms", 0.008), ("1.5 s", 1.5), ("0.02", 0.02), (3.0, 3.0)])
def test_times_have_a_unit_or_are_seconds(text, value):
    spacing = Number("s", ("all",), min=1e-7)
    assert spacing.convert(text, None, None) == pytest.approx(value, rel=1e-15)
    assert spacing.convert("all", None, None) == "all"


@pytest.mark.parametrize("text", ["8mm", "ms", "-8ms", "nan s", "1e-9 s", ""])
def test_what_is_no_time_is_refused(text):
    with pytest.raises(click.BadParameter):
        Number("s", min=1e-7).convert(text, None, None)


def test_several_numbers_stand_between_commas():
    times = Several(Number("s"))
    assert times.convert("0, 8ms,3", None, None) == (0.0, 0.008, 3.0)
    assert times.convert((1.0, 2.0), None, None) == (1.0, 2.0)
    with pytest.raises(click.BadParameter):
        times.convert("1,,2", None, None)


def test_a_stiffness_needs_its_unit():
    kind = Number("N.m/rad", min=0.0, min_open=True)
    assert kind.convert("1 N.m/deg", None, None) == pytest.approx(180.0 / pi)
    with pytest.raises(click.BadParameter):
        kind.convert("51.3", None, None)


@pytest.mark.parametrize(
    ("kind", "shown"),
    [
        (Number(), "number"),
        (Number(min=0.0, min_open=True), "x>0"),
        (Number(min=1e-10, max=0.1), "1e-10<=x<=0.1"),
        (Number(min=1e-7), "x>=1e-7"),
        (Number(max=1e6), "x<=1e6"),
        (Count(min=2, max=100_000), "2<=x<=100000"),
    ],
)
def test_ranges_are_shown_in_few_characters(kind, shown):
    """Help and refusal name the same bounds; a number without bounds has no range in the help."""
    option = click.Option(["--x"], type=kind, help="It.")
    _, text = option.get_help_record(click.Context(click.Command("c")))
    assert text == ("It." if shown == "number" else f"It.  [{shown}]")
    if shown != "number":
        with pytest.raises(click.BadParameter) as refused:
            kind.convert("-5" if shown != "x<=1e6" else "2e6", None, None)
        assert f"{shown}" in refused.value.message


def test_a_picture_ends_like_one(tmp_path):
    assert Picture().convert(str(tmp_path / "a.PNG"), None, None) == tmp_path / "a.PNG"
    for name, sentence in (
        ("a.abc", ".png, .pdf"),
        ("a", "must end"),
        ("", "is a dir"),
    ):
        with pytest.raises(click.BadParameter) as refused:
            Picture().convert(str(tmp_path / name), None, None)
        assert sentence in refused.value.message


@pytest.mark.parametrize("kind", [OutputFile(), Picture()])
def test_what_ends_like_a_folder_is_no_file(tmp_path, kind):
    """Tried by a stranger: `--output adir/` wrote a file of the name adir."""
    with pytest.raises(click.BadParameter, match="folder"):
        kind.convert(f"{tmp_path}/adir/", None, None)
    assert kind.convert(f"{tmp_path}/adir/a.png", None, None) == tmp_path / "adir" / "a.png"
