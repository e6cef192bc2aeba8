"""The six springs and dampers of a hinge against closed forms, and what no hinge can be made of."""

import numpy as np
import pytest

from tests.references.relative_motion import inputs, port_motion, wrenches
from tests.unit.components.hinge.hinge_cases import hinge

JOINTS = {
    "spherical": ((1e6, 1e6, 1e6), (0.0, 0.0, 0.0)),
    "revolute": ((1e6, 1e6, 1e6), (0.0, 2e4, 2e4)),
    "cylindrical": ((0.0, 1e6, 1e6), (0.0, 2e4, 2e4)),
    "fixed": ((1e6, 1e6, 1e6), (3e4, 2e4, 2e4)),
}


@pytest.mark.parametrize("joint", JOINTS)
@pytest.mark.parametrize("mode", ["mean", "endpoint"])
def test_joints_are_settings_of_the_six_stiffnesses(joint, mode):
    """Closed form -k s in each of six directions: hinge line y, radial directions x and z, turns about each.

    Round-off of a turn is that of a quaternion, 1e-16 of 3e4 N.m.
    """
    along, about = JOINTS[joint]
    component, c = hinge(mode, translational_stiffness=along, rotational_stiffness=about)
    stiffness = np.array((along[1], along[0], along[2], about[1], about[0], about[2]))
    for k in range(6):
        shift = np.zeros(6)
        shift[k] = 1e-3
        u = inputs(component, port_motion(), port_motion(shift[:3], shift[3:]))
        y = component.step(c, component.initial(c, u), u, 0.1)
        force, torque = wrenches(component.outputs(c, y, u), 2)
        assert np.concatenate((force[1], torque[1])) == pytest.approx(-stiffness * shift, abs=1e-10)


def test_damping_acts_on_motion_relative_to_the_inboard_port():
    """Closed form: ports of one turning body have no relative velocity, so a damper joint gives no wrench there.

    A further velocity of the outboard port meets the coefficient of its direction. To round-off.
    """
    component, c = hinge(
        "endpoint", translational_damping=(2.0, 3.0, 5.0), rotational_damping=(0.7, 0.8, 0.9)
    )
    spin, gap = np.array((0.3, -0.5, 0.8)), np.array((0.1, -0.2, 0.4))
    extra = np.array((0.5, 0.6, 0.7))

    def loads(velocity):
        u = inputs(component, port_motion(spin=spin), port_motion(gap, (0, 0, 0), velocity, spin))
        return wrenches(component.outputs(c, component.initial(c, u), u), 2)

    force, torque = loads(np.cross(spin, gap))
    assert np.concatenate((force, torque)) == pytest.approx(np.zeros((4, 3)), abs=1e-14)
    force, torque = loads(np.cross(spin, gap) + extra)
    assert force[1] == pytest.approx(-np.array((3.0, 2.0, 5.0)) * extra, abs=1e-14)
    assert torque[1] == pytest.approx(np.zeros(3), abs=1e-14)
