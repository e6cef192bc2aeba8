"""Chains of panels for scaling: folded like an accordion on a fixed base, opened by the springs of all lines.

Panels are all alike: panel 1 of AMOS-3, flexible with 10 fixed-interface modes (28 modes), or its rigid twin.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from components import REGISTRY, rotation_matrix
from components.contract.frames import exponential
from components.flexible.modal import ModalData
from fmus import Backend, build_fmu
from orchestrator.assembly import Link, Part
from orchestrator.cosim.fmu import FmuParticipant
from orchestrator.cosim.participant import Participant
from tests.benchmark.models.one_panel import hinge_start
from tests.references import catalogue

INBOARD = {"left": "hl2_left", "right": "hl2_right"}
OUTBOARD = {"left": "hl3_left", "right": "hl3_right"}
FOLDED = ((0.0, 1.0, 0.0), (0.0, -1.0, 0.0))
"""Axes of the hinge lines: of every other line, and of those between; one turns against the next."""


def panel(*, flexible: bool) -> ModalData:
    """The panel all chains are made of."""
    return catalogue.entry("amos3_panel1").flexible() if flexible else catalogue.entry("amos3_panel1").rigid()


@dataclass(frozen=True)
class Placed:
    """A panel of a chain where it starts: orientation, origin of its construction frame (m), axis of its line."""

    name: str
    orientation: tuple[float, float, float, float]
    position: tuple[float, float, float]
    axis: tuple[float, float, float]


@dataclass(frozen=True)
class Chain:
    """So many equal panels, from the base outwards."""

    count: int
    data: ModalData

    def point(self, name: str) -> np.ndarray:
        """Place of a point of the panel (m), in its construction frame."""
        place: np.ndarray = self.data.point_positions[self.data.point_names.index(name)]
        return place

    def placed(self) -> list[Placed]:
        """The panels in their folded pose."""
        found: list[Placed] = []
        angle, tip = 0.0, np.zeros(3)
        step = self.point(OUTBOARD["left"]) - self.point(INBOARD["left"])
        for k in range(self.count):
            axis = FOLDED[k % 2]
            angle -= pi * axis[1]
            turn = exponential((0.0, angle, 0.0))
            matrix = rotation_matrix(turn)
            arm = self.point(INBOARD["left"]) * (1.0, 0.0, 1.0)
            x, y, z = (tip - matrix @ arm).tolist()
            found.append(Placed(f"panel{k}", turn, (x, y, z), axis))
            tip = tip + matrix @ step
        return found

    def parts(self) -> tuple[list[Part], list[Link]]:
        """Base, panels and two hinges for each panel, and their links."""
        base = [{"name": f"out_{s}", "position": tuple(self._on_base(s))} for s in INBOARD]
        parts = [Part("base", "fixed_base", {"ports": base}, {})]
        links = []
        ports = [{"name": f"in_{s}", "point": point} for s, point in INBOARD.items()]
        more = [{"name": f"out_{s}", "point": point} for s, point in OUTBOARD.items()]
        modal = self.data.to_arrays()
        middle, last = {"modal": modal, "ports": ports + more}, {"modal": modal, "ports": ports}
        inner = "base"
        for one in self.placed():
            start: dict[str, Any] = {"initial_position": one.position, "initial_orientation": one.orientation}
            end = one.name == f"panel{self.count - 1}"
            parts.append(Part(one.name, "body", last if end else middle, start))
            for side in INBOARD:
                hinge = f"{one.name}_{side}"
                parts.append(Part(hinge, "hinge", {"axis": one.axis}, hinge_start(side)))
                links.append(Link((inner, f"out_{side}"), (hinge, "inboard")))
                links.append(Link((one.name, f"in_{side}"), (hinge, "outboard")))
            inner = one.name
        return parts, links

    def _on_base(self, side: str) -> list[float]:
        return (self.point(INBOARD[side]) * (0.0, 1.0, 0.0)).tolist()


@contextmanager
def as_instances(parts: Sequence[Part], backend: Backend) -> Iterator[list[Participant]]:
    """Participants from one FMU for every different structure, with the start values set on each instance."""
    with ExitStack() as stack:
        folder = stack.enter_context(TemporaryDirectory(prefix="fanfold_"))
        files: dict[tuple[str, int | str], Path] = {}
        participants: list[Participant] = []
        for part in parts:
            # equal panels share one structure object; hinges are told apart by their values
            key = part.kind, id(part.structure) if part.kind == "body" else repr(part.structure)
            if key not in files:
                component = REGISTRY[part.kind](**part.structure)
                files[key] = build_fmu(component, f"{part.kind}{len(files)}", folder, {}, backend)
            participants.append(FmuParticipant(part.name, files[key], part.start))
            stack.callback(participants[-1].close)
        yield participants
