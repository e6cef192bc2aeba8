"""Components that cannot be, connection by connection: each is refused with a sentence."""

import numpy as np
import pytest

from components.ccl import CableLoop
from components.contact import Contact
from components.contract.component import ComponentError
from components.drag import PlateDrag
from components.drive import Drive
from components.end_stop import EndStop
from components.gear import Gear
from components.hinge import Hinge
from components.hold_down import HoldDown
from components.load import Load
from components.moving_base import MovingBase
from components.point_motion import PointMotion
from components.rail import Rail
from components.spring import Spring
from components.suspension import Suspension
from tests.references.relative_motion import inputs, port_motion
from tests.unit.components.prepared import prepared

NOWHERE, INFINITE, NO_NUMBER = (0.0, 0.0, 0.0), (np.inf, 0.0, 1.0), (np.nan, 0.0, 1.0)
STRUCTURES = [
    (HoldDown, {"axis": NOWHERE}, "hold-down's preload"),
    (Drive, {"profile": "step3"}, r"step, step5.*commanded"),
    (Drive, {"axis": NOWHERE}, "drive's axis"),
    (Contact, {"normal": NOWHERE}, "no length"),
    (Contact, {"normal": (0.0, 1.0)}, "three components"),
    (Contact, {"normal": INFINITE}, "finite components"),
    (Contact, {"normal": NO_NUMBER}, "finite components"),
    (Rail, {"normal": NOWHERE}, r"normal .*length"),
    (MovingBase, {"ports": [], "rotation_axis": NOWHERE}, "rotation_axis"),
    (MovingBase, {"ports": [], "translation": 3}, "list"),
    (Load, {"frame": "inertial"}, "world.*body"),
    (Load, {"direction": NOWHERE}, "length"),
    (PointMotion, {}, "list"),
    (PointMotion, {"axis": (1, 0)}, "has 2 numbers"),
    (Hinge, {"latch": "magnet"}, "none, spring.*kinematic"),
    (Hinge, {"wrench_mode": "middle"}, "mean.*endpoint"),
    (Hinge, {"axis": NOWHERE}, "axis"),
]
PARAMETERS = [
    (HoldDown, {"translational_stiffness": (1e3, 1e3, 0.0), "preload": 50.0}, r"translational_stiffness\[3\] is 0 N/m"),
    (Drive, {"duration": 0.0}, "duration = 0 s"),
    (Gear, {"ratio": 0.0}, "ratio is 0"),
    (Suspension, {"stiffness": 0.0}, "stiffness = 0 N/m"),
    (PlateDrag, {"start": 0.5, "end": 0.5}, r"0.5 m.*0.5 m"),
    (Hinge, {"order": 3.0}, r"order = 3.*2 or 4"),
    *(
        (kind, {name: value}, f"{name} = .* at least")
        for kind, name, value in (
            (Contact, "exponent", 0.9), (Contact, "reference_penetration", 0.0), (Contact, "damping", -1.0),
            (EndStop, "stiffness", 0.0), (EndStop, "damping", -1.0),
            (PlateDrag, "width", -1.0), (PlateDrag, "air_density", -1.0), (PlateDrag, "drag_coefficient", -1.0),
        )
    ),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "structure", "words"), STRUCTURES)
def test_structures(kind, structure, words):
    with pytest.raises(ComponentError, match=words):
        kind(**structure)


@pytest.mark.parametrize(("kind", "start", "words"), PARAMETERS)
def test_parameters(kind, start, words):
    with pytest.raises(ComponentError, match=words):
        prepared(kind(), **start)


def test_a_preload_needs_stiffness_along_its_axis_only():
    """Control."""
    prepared(HoldDown(), translational_stiffness=(1e3, 0.0, 1e3), preload=50.0)


@pytest.mark.parametrize(
    ("kind", "start", "words"),
    [
        (CableLoop, {"radius_1": 2.0}, "radii"),
        (Suspension, {}, "one point"),
        (Spring, {"stiffness": 5.0}, "one point"),
    ],
)
def test_places_of_ports(kind, start, words):
    """Pulleys 1 m apart, closer than their radii, and a spring without a length."""
    component = kind()
    apart = port_motion((1.0, 0.0, 0.0) if kind is CableLoop else NOWHERE)
    with pytest.raises(ComponentError, match=words):
        component.initial(prepared(component, **start), inputs(component, port_motion(), apart))
