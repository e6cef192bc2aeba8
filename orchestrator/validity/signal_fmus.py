"""Probable mistakes in the use of FMUs of other tools."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from ..assembly import Assembly, Event, HingeLine, SignalFmu
from ..messages import coded
from ..scene.placed_scene import PlacedScene
from ..scene.signal_tables import Fmu


def signal_fmu_warnings(assembly: Assembly, scene: PlacedScene) -> Iterator[str]:
    """All warnings about FMUs of other tools in a scene."""
    tables: Mapping[str, Fmu] = {table.name: table for table in scene.fmus}
    for fmu in assembly.signal_fmus:
        if (table := tables.get(fmu.name)) is not None:
            yield from coded("W-fmu-unit", _bare_units(fmu))
            yield from coded("W-fmu-hinges", _of_several_hinges(fmu, table, assembly.hinge_lines))
            yield from coded("W-fmu-events", _set_by_events(fmu, assembly.events))
            yield from coded("W-fmu-delay", _read_late(fmu, assembly.signal_fmus))
            if fmu.is_wing:
                yield from coded("W-fmu-wing", _driven_wing(fmu))


def _bare_units(fmu: SignalFmu) -> Iterator[str]:
    """Variables without a unit."""
    bare = [s for s in (*fmu.inputs, *fmu.outputs) if not s.says_unit and s.unit != "1"]
    if bare:
        listed = ", ".join(dict.fromkeys(f"{s.variable} in {s.unit}" for s in bare))
        yield (
            f"fmu.{fmu.name}: {Path(fmu.path).name} declares no unit for some variables, which are read as "
            f"{listed}. Check these units."
        )


def _of_several_hinges(fmu: SignalFmu, table: Fmu, lines: Sequence[HingeLine]) -> Iterator[str]:
    """Loads addressed by the name of a line with several hinges."""
    hinges = {line.name: line for line in lines if len(line.hinges) > 1}
    units = {name: quantity.unit for name, quantity in fmu.recorded().items()}
    for name, source in table.inputs.items():
        line = hinges.get(source.partition(".")[0])
        if line is not None and "N" in units[name]:
            number = len(line.hinges)
            yield (
                f"fmu.{fmu.name}.inputs.{name}: {source} is the value of {line.sensor}, one of {number} hinges, "
                "not that of the line. Multiply it for the line."
            )
    for name in table.outputs:
        for target in table.targets(name):
            line = hinges.get(target.partition(".")[0])
            if line is not None and "N" in units[name]:
                yield (
                    f"fmu.{fmu.name}.outputs.{name}: each of the {len(line.hinges)} hinges of {line.name} gets the "
                    f"full value. Divide a value for the line by {len(line.hinges)}."
                )


def _set_by_events(fmu: SignalFmu, events: Sequence[Event]) -> Iterator[str]:
    """Parameters that an event sets as well."""
    targets = {(s.part, s.quantity) for s in fmu.outputs}
    for event in events:
        for setting in event.settings:
            if (setting.part, setting.parameter) in targets:
                yield (
                    f"event.{event.name}: it sets {setting.part}.{setting.parameter}, which the FMU {fmu.name} "
                    "sets as well. From the event on the value of the event applies."
                )


def _read_late(fmu: SignalFmu, fmus: Sequence[SignalFmu]) -> Iterator[str]:
    """Inputs from FMUs that step after this one, or from itself."""
    late = {one.name for one in fmus[fmus.index(fmu) :]}
    for signal in fmu.inputs:
        if signal.part in late:
            yield (
                f"fmu.{fmu.name}.inputs.{signal.variable}: it reads {signal.part}.{signal.quantity} in a loop of "
                f"FMUs, so it gets the value of the previous step. Reduce the step of {signal.part} if this delay "
                "matters."
            )


def order_of_fmus(assembly: Assembly) -> Iterator[str]:
    """In which order FMUs that read each other step."""
    names = [fmu.name for fmu in assembly.signal_fmus]
    if any(signal.part in names for fmu in assembly.signal_fmus for signal in fmu.inputs):
        yield (
            f"{assembly.name}: FMUs with the same communication point step in the order {', '.join(names)}. Each "
            "reads the outputs of those before it without delay."
        )


def _driven_wing(fmu: SignalFmu) -> Iterator[str]:
    """Limits of a wing with constant loads over a step."""
    yield (
        f"fmu.{fmu.name}: loads of this wing are constant over a step, which may be unstable if it is heavy "
        "relative to its spacecraft. Compare two steps, or build the wing into the scene."
    )
