"""A four-bar of three bending links against an independent solution.

That is in the crank's angle and in what links bend to beside the straight lines between their pins, sines of the way
along: no joint, no frame of a body and no modes of ours. Lagrange's equations at Gauss points, by DOP853.
"""

import numpy as np
from scipy.integrate import solve_ivp

import orchestrator as fanfold

GRAVITY, SINES, POINTS = 9.81, 3, 8
GROUND, LENGTHS = 1.2, (0.5, 1.0, 0.8)
"""m; of crank, coupler and rocker."""
JOINTS = ("first", "second", "third")
LINE_MASS, BENDING = 1.0, (60.0, 100.0, 80.0)
"""kg/m, N.m2; first frequencies of pinned links are 48, 16 and 22 Hz."""


def directions(angle):
    """Angles (3,) of crank, coupler and rocker where the crank is at one, and their derivatives by it, (3,), twice."""
    crank, coupler, rocker = LENGTHS

    def unit(a):
        return np.array((np.cos(a), np.sin(a)))

    gap = crank * unit(angle) - (GROUND, 0.0)
    size = np.hypot(*gap)
    opening = np.arccos((rocker**2 + size**2 - coupler**2) / (2.0 * rocker * size))
    last = np.arctan2(gap[1], gap[0]) - opening
    middle = np.arctan2(*(rocker * unit(last) - gap)[::-1])
    angles = np.array((angle, middle, last))
    # crank e1 + coupler e2 - rocker e3 stays: of first, then of second derivatives
    across = (
        np.array([(-np.sin(a), np.cos(a)) for a in angles]) * np.array((crank, coupler, -rocker))[:, None]
    )
    along = np.array([unit(a) for a in angles]) * np.array((crank, coupler, -rocker))[:, None]
    first = np.append(1.0, np.linalg.solve(across[1:].T, -across[0]))
    second = np.append(0.0, np.linalg.solve(across[1:].T, along.T @ first**2))
    return angles, first, second


def four_bar(angle, until):
    """From rest and straight: solution in 1 + 3 SINES coordinates, the crank angle first, and their rates."""
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    share, weights = 0.5 * (1.0 + nodes), 0.5 * weights
    sines = np.array([np.sin(k * np.pi * share) for k in range(1, SINES + 1)])
    masses = LINE_MASS * np.array(LENGTHS)[:, None, None, None] * weights[:, None, None]
    stiffness = np.concatenate(
        [
            [0.5 * stiff * length * (k * np.pi / length) ** 4 for k in range(1, SINES + 1)]
            for stiff, length in zip(BENDING, LENGTHS, strict=True)
        ]
    )

    def rates(t, y):
        q, v = np.split(y, 2)
        angles, first, second = directions(q[0])
        moved, felt = np.zeros((3, POINTS, 2, q.size)), np.zeros((3, POINTS, 2))
        lead = bias = np.zeros(2)
        for i, length in enumerate(LENGTHS):
            e, n = np.array([(np.cos(angles[i]), np.sin(angles[i])), (-np.sin(angles[i]), np.cos(angles[i]))])
            own = slice(1 + i * SINES, 1 + (i + 1) * SINES)
            x, w, turn = share[:, None] * length, (q[own] @ sines)[:, None], first[i] * v[0]
            if i == 2:  # the rocker starts at the ground
                lead = bias = np.zeros(2)
            moved[i, :, :, 0] = lead + first[i] * (x * n - w * e)
            moved[i, :, :, own] = n[None, :, None] * sines.T[:, None, :]
            felt[i] = bias + second[i] * v[0] ** 2 * (x * n - w * e) - turn**2 * (x * e + w * n)
            felt[i] -= 2.0 * turn * (v[own] @ sines)[:, None] * e - (0.0, GRAVITY)
            lead, bias = (
                lead + first[i] * length * n,
                bias + length * (second[i] * v[0] ** 2 * n - turn**2 * e),
            )
        rows = moved.reshape(-1, q.size)
        weighted = (masses * moved).reshape(rows.shape)
        force = np.append(0.0, -stiffness * q[1:]) - weighted.T @ felt.ravel()
        mass = weighted.T @ rows
        return np.concatenate((v, np.linalg.solve(mass, force)))

    y = np.zeros(2 + 6 * SINES)
    y[0] = angle
    return solve_ivp(rates, (0.0, until), y, method="DOP853", rtol=1e-6, atol=1e-8, dense_output=True)


def expected(angle, t):
    """Angles (3, T) of crank to ground, of coupler to crank and of rocker to coupler, at their pins, less the first."""
    y = four_bar(angle, float(t[-1])).sol(t)
    angles = np.array([directions(a)[0] for a in y[0]]).T
    orders = np.arange(1, SINES + 1)[:, None]
    near, far = [], []
    for i, length in enumerate(LENGTHS):
        slopes = orders * np.pi / length * y[1 + i * SINES : 1 + (i + 1) * SINES]
        near.append(angles[i] + slopes.sum(0))
        far.append(angles[i] + (slopes * (-1.0) ** orders).sum(0))
    joints = np.array((near[0], near[1] - far[0], far[2] - far[1]))
    return joints - joints[:, :1]


def scene_of(angle, until):
    """The same with a modal body a link, joints 1e4 times as stiff as what bends."""
    scene = fanfold.Scene("four_bar", until=until, gravity=(0, 0, -GRAVITY), tolerance=1e-3)
    scene.joint(axial_stiffness=1e8, radial_stiffness=1e8)
    scene.base(points={"left": (0, 0, 0), "right": (GROUND, 0, 0)})
    angles = directions(angle)[0]
    tip = [LENGTHS[0] * float(np.cos(angle)), 0.0, LENGTHS[0] * float(np.sin(angle))]
    for name, point, offset, turn, length, bending in zip(
        ("crank", "coupler", "rocker"), ("left", "left", "right"), ((0, 0, 0), tip, (0, 0, 0)),
        angles, LENGTHS, BENDING, strict=True,
    ):  # fmt: skip
        section = {
            "axial": 1e7, "shear_y": 1e8, "shear_z": 1e8, "torsion": 1e3, "bending_y": bending, "bending_z": 1e3,
            "line_mass": LINE_MASS, "inertia_y": 1e-7, "inertia_z": 1e-7,
        }  # fmt: skip
        beam = {
            "length": length,
            "elements": 8,
            "section": section,
            "attachment_points": {"a": 0, "b": length},
        }
        along = (float(np.cos(turn)), 0.0, float(np.sin(turn)))
        place = {"body": "base", "point": point, "offset": offset, "orientation": {"x": along}}
        scene.body(
            name,
            beam=beam,
            place=place,
            fidelity="flexible",
            fixed_interface_modes=4,
            second_order_modes=0,
            damping_ratio=0.0,
        )
    for name, ends in {
        "first": (("base", "left"), ("crank", "a")),
        "second": (("crank", "b"), ("coupler", "a")),
        "third": (("coupler", "b"), ("rocker", "b")),
        "fourth": (("base", "right"), ("rocker", "a")),
    }.items():
        ports = {s: {"body": b, "point": p} for s, (b, p) in zip(("inboard", "outboard"), ends, strict=True)}
        scene.connection(name, "hinge", ports=ports, preset="revolute", axes={"x": (0, 1, 0)})
    return scene


def test_a_four_bar_that_bends_falls():
    """Independent solution, in the three angles between the links at their pins, against what bending makes of them.

    Slopes of sines converge with the fourth power of their number: two a link leave 1.5 %, three 0.5 %.
    """
    angle, until = 1.2, 0.18
    scene = scene_of(angle, until)
    result, rigid = (fanfold.simulate(scene, rigid=r, estimate=False) for r in ((), "all"))
    t = np.linspace(0.0, until, 51)
    # about y, what turns from x to z turns to minus
    wanted = np.unwrap(expected(angle, t))
    bending, stiff = (
        np.array([np.unwrap(r[name, "angle"].at(t)) + way for name, way in zip(JOINTS, wanted, strict=True)])
        for r in (result, rigid)
    )
    assert np.abs(stiff).max() > 2e-3
    assert np.abs(bending).max() < 0.01 * np.abs(stiff).max()
