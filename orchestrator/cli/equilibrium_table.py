"""Tables of static equilibria: the loads of one; angles, torques and tensions over a sweep."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..analysis.equilibrium import Equilibrium
from ..results.round_off import noise_floor
from ..scene.units import degrees_text
from .tables import Column, table_of, tables_that_fit, terminal

_BASE_LOADS = (("force", "N"), ("torque", "N.m"))


def print_loads(found: Equilibrium) -> None:
    """Holding torques of lines, then all loads above round-off."""
    cells = [
        (line, f"holding torque at {degrees_text(found.angles[line], 3)} deg", f"{torque + 0.0:.5g}", "N.m")
        for line, torque in found.holding_torques.items()
    ]
    rows = list(_load_rows(found))
    floors = _noise_floors(rows, found.reach)
    shown = [row for row in rows if abs(row[2]) > floors[row[3]]]
    previous = ""
    for connection, name, value, unit in shown:
        cells.append(("" if connection == previous else connection, name, f"{value:.5g}", unit))
        previous = connection
    table = table_of(
        "static equilibrium", ("connection", "load", "value", "unit"), cells, ("connection", "load", "unit")
    )
    console = terminal()
    console.print(table)
    left_out = len(rows) - len(shown)
    if left_out:
        console.print(
            f"{left_out} {'load is' if left_out == 1 else 'loads are'} not shown: zero, or below a millionth of "
            "the largest; --json lists all"
        )


def _load_rows(found: Equilibrium) -> Iterator[tuple[str, str, float, str]]:
    """Connection, load, value and unit; the base last."""
    for connection, loads in found.loads.items():
        for name, (value, unit) in loads.items():
            yield connection, name.replace("_", " "), value, unit
    names = [(f"{what} {axis}", unit) for what, unit in _BASE_LOADS for axis in "xyz"]
    for (name, unit), value in zip(names, found.base_load, strict=True):
        yield "base", name, value, unit


def _noise_floors(rows: Sequence[tuple[str, str, float, str]], reach: float) -> dict[str, float]:
    """Loads that are round-off, by unit: forces make torques over the reach of the structure, and the reverse."""
    force, torque = (
        noise_floor(value for _, _, value, kind in rows if kind == unit) for unit in ("N", "N.m")
    )
    if reach == 0.0:
        return {"N": force, "N.m": torque}
    return {"N": max(force, torque / reach), "N.m": max(torque, force * reach)}


def print_sweep(found: Sequence[Equilibrium]) -> None:
    """Angles of all lines, torques that hold some, and tensions of cables, one row per equilibrium."""
    first = found[0]
    columns = [
        Column(f"torque\nto hold\n{line}, N.m", [f"{one.holding_torques[line] + 0.0:.5g}" for one in found])
        for line in first.holding_torques
    ]
    columns += [
        Column(f"tension\n{name}\n{_strand(load)}N", [f"{one.loads[name][load][0]:.5g}" for one in found])
        for name, loads in first.loads.items()
        for load in loads
        if load.startswith("tension")
    ]
    angles = [
        Column(f"{line},\ndeg", [degrees_text(one.angles[line], 2) for one in found]) for line in first.angles
    ]
    console = terminal()
    for table in tables_that_fit("quasi-static sweep", angles, columns, console.width):
        console.print(table)


def _strand(load: str) -> str:
    """Which strand a tension is of, where there are two."""
    strand = load.removeprefix("tension").strip("_")
    return f"{strand}, " if strand else ""
