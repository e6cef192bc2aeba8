"""An assembly as one SSP file (System Structure and Parameterization 1.0): FMUs and their connections.

Start values are those of the FMUs, the end time is that of the scene. SSP has no step size: OMSimulator reads it from
the annotation, for other tools it is printed. The file also contains the scene, for `fanfold run`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, NamedTuple
from zipfile import ZIP_DEFLATED, ZipFile

from fmpy import read_model_description

from components import FanfoldError, Quantity
from fmus import Experiment
from fmus.description.units import base_unit, has_root

from ..assembly import Assembly, Link
from ..cosim.ports import MOTION, UNITS, WRENCH
from ..scene.body_tables import Fidelity
from ..scene.system_structure import MEMBER, carried

if TYPE_CHECKING:
    from pyssp_standard.ssd import Component, Connection

_OMSIMULATOR = "org.openmodelica"
_OMS = "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"


class SystemStructureError(FanfoldError):
    """A sentence for the user: why no SSP file can be written."""


def check_ssp(path: Path) -> None:
    """SystemStructureError without the library for the format, or for a name that does not end in .ssp."""
    if path.suffix != ".ssp":
        raise SystemStructureError(f"{path}: an SSP file is meant; let its name end in .ssp")
    if find_spec("pyssp_standard") is None:
        raise SystemStructureError(
            "writing SSP files needs pyssp_standard; install it with: pip install 'fanfold[ssp]'"
        )


def write_ssp(path: Path, assembly: Assembly, fmus: Sequence[Path], experiment: Experiment) -> Path:
    """Write the SSP file of an assembly from its FMUs, made with end-point wrenches, and return its path.

    Or from the one FMU that it is, whose inputs and outputs all are connectors. Errors of `check_ssp`.
    """
    check_ssp(path)
    from pyssp_standard.ssd import DefaultExperiment, System
    from pyssp_standard.ssp import SSP

    system = System(name=assembly.name.replace("-", "_").replace(".", "_"))
    links = assembly.links if len(fmus) > 1 else ()
    connectors = [list(_linked(links, fmu.stem) if links else _all_of(fmu)) for fmu in fmus]
    system.elements = [_component(fmu, found) for fmu, found in zip(fmus, connectors, strict=True)]
    system.connections = [c for link in links for c in _connections(link)]
    if experiment.step_size is not None:
        system.annotations.add_annotation(_step_annotation(experiment.step_size, assembly.tolerance))
    run = DefaultExperiment()
    run.start_time, run.stop_time = 0.0, experiment.stop_time
    with TemporaryDirectory() as folder:
        part = Path(folder) / path.name
        with SSP(part, mode="w") as archive:
            with archive.system_structure as structure:
                structure.name, structure.version = system.name, "1.0"
                structure.system, structure.default_experiment = system, run
                for unit in _units(one.unit for found in connectors for one in found if one.unit is not None):
                    structure.units.add_unit(unit)
            _order(archive.get_file_temp_path("SystemStructure.ssd"))
            for fmu in fmus:
                archive.add_resource(fmu)
        with ZipFile(part, "a", ZIP_DEFLATED) as archive:
            system = {name: archive.read(name) for name in archive.namelist()}
            archive.writestr(MEMBER, carried(assembly.scene_tree, _fidelities(assembly), system))
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(part.read_bytes())
    return path


def _fidelities(assembly: Assembly) -> dict[str, Fidelity]:
    """Of every body that is a part; one that is held belongs to another and stays what its scene says."""
    found: dict[str, Fidelity] = {part.name: "rigid" for part in assembly.parts}
    found |= dict.fromkeys(assembly.flexible, "flexible")
    return found | dict.fromkeys(assembly.large_deformation, "large_deformation")


def _order(description: Path) -> None:
    """Put the units before the default experiment, where the schema wants them and the library does not."""
    from lxml.etree import parse

    tree = parse(str(description))
    experiment, units = (tree.getroot().find(f"{{*}}{tag}") for tag in ("DefaultExperiment", "Units"))
    experiment.addprevious(units)
    tree.write(str(description), encoding="utf-8", xml_declaration=True)


class _Connector(NamedTuple):
    """What a connector stands for: a scalar's name, causality and unit, None where SSP can tell none."""

    name: str
    kind: str
    unit: str | None


def _component(fmu: Path, connectors: Sequence[_Connector]) -> Component:
    """An FMU of the archive with its connectors."""
    from pyssp_standard.common_content_ssc import TypeReal
    from pyssp_standard.ssd import Component, Connector

    found = Component()
    found.name, found.source = fmu.stem, f"resources/{fmu.name}"
    found.component_type, found.implementation = "application/x-fmu-sharedlibrary", "CoSimulation"
    found.connectors += [Connector(None, one.name, one.kind, TypeReal(one.unit)) for one in connectors]
    return found


def _linked(links: Sequence[Link], name: str) -> Iterator[_Connector]:
    """Every scalar that a link of a component carries."""
    for link in links:
        for side, given, taken in ((link.body, MOTION, WRENCH), (link.connection, WRENCH, MOTION)):
            if side[0] == name:
                for kind, names in (("output", given), ("input", taken)):
                    for one in names:
                        yield from (_Connector(s, kind, UNITS[one]) for s in _scalars(side[1], one))


def _all_of(fmu: Path) -> Iterator[_Connector]:
    """Every input and output of an FMU."""
    for variable in read_model_description(str(fmu), validate=False).modelVariables:
        if variable.causality in ("input", "output"):
            unit = variable.unit
            yield _Connector(variable.name, variable.causality, None if has_root(unit) else unit)


def _connections(link: Link) -> Iterator[Connection]:
    """Motions from the body to the connection, wrenches back."""
    for source, target, names in ((link.body, link.connection, MOTION), (link.connection, link.body, WRENCH)):
        for name in names:
            yield from _wired(source, target, name)


def _wired(source: tuple[str, str], target: tuple[str, str], name: str) -> Iterator[Connection]:
    from pyssp_standard.ssd import Connection

    for given, taken in zip(_scalars(source[1], name), _scalars(target[1], name), strict=True):
        yield Connection(
            start_element=source[0], start_connector=given, end_element=target[0], end_connector=taken
        )


def _scalars(port: str, name: str) -> tuple[str, ...]:
    return Quantity(f"{port}.{name}", UNITS[name], "", 4 if name == "orientation" else 3).scalar_names()


def _units(names: Iterable[str]) -> Iterator[Any]:
    """Definitions of units."""
    from pyssp_standard.unit import BaseUnit, Unit

    for name in dict.fromkeys(names):
        exponents, factor = base_unit(name)
        yield Unit(name, BaseUnit({**exponents, **({"factor": factor} if factor != 1.0 else {})}))


def _step_annotation(step: float, tolerance: float) -> Any:  # noqa: ANN401
    """The fixed step of a master and its tolerances, which are 0 where they are left out, in OMSimulator's words."""
    from lxml.etree import Element, SubElement
    from pyssp_standard.common_content_ssc import Annotation

    found = Annotation(_OMSIMULATOR)
    annotations = Element(f"{{{_OMS}}}Annotations", nsmap={"oms": _OMS})
    information = SubElement(annotations, f"{{{_OMS}}}SimulationInformation")
    numbers = {"stepSize": step, "absoluteTolerance": tolerance, "relativeTolerance": tolerance}
    attributes = {name: f"{number:g}" for name, number in numbers.items()}
    SubElement(information, f"{{{_OMS}}}FixedStepMaster", {"description": "oms-ma", **attributes})
    found.add_element(annotations)
    return found
