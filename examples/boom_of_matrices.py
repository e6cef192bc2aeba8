"""A boom from another program: matrices in Matrix Market, nodes of their rows, places as a spreadsheet saves them."""

from pathlib import Path

import numpy as np
from scipy.io import mmwrite

import orchestrator as fanfold

LENGTH, PARTS, LINE_MASS, BENDING, STIFF = 3.0, 48, 0.5, 400.0, 4e6  # m, elements, kg/m, N.m2, N and N.m2
h = LENGTH / PARTS
stiffness = np.zeros((6 * (PARTS + 1), 6 * (PARTS + 1)))
for part in range(PARTS):
    for component in (0, 3):  # along the boom, and about it
        rows = 6 * part + component + np.array([0, 6])
        stiffness[np.ix_(rows, rows)] += STIFF / h * np.array([[1, -1], [-1, 1]])
    for deflection, rotation, s in ((1, 5, h), (2, 4, -h)):  # both ways across it
        rows = 6 * part + np.array([deflection, rotation, deflection + 6, rotation + 6])
        ends = [[12, 6 * s, -12, 6 * s], [6 * s, 4 * h * h, -6 * s, 2 * h * h]]
        ends += [[-12, -6 * s, 12, -6 * s], [6 * s, 2 * h * h, -6 * s, 4 * h * h]]
        stiffness[np.ix_(rows, rows)] += BENDING / h**3 * np.array(ends)
share = np.full(PARTS + 1, h)
share[[0, -1]] = 0.5 * h
mmwrite("k.mtx", stiffness)
mmwrite("m.mtx", np.diag(np.kron(share, LINE_MASS * np.array([1, 1, 1, 1e-3, 1e-4, 1e-4]))))
mmwrite("rows.mtx", np.arange(1, PARTS + 2)[:, None])  # each node has six rows, as in a mapping of Ansys
places = [f"{node + 1};{node * h:.4f};0;0".replace(".", ",") for node in range(PARTS + 1)]
Path("nodes.csv").write_text("\n".join(["node;x;y;z", *places]))

files = {"stiffness": "k.mtx", "mass": "m.mtx", "coordinates": "nodes.csv", "dofs": "rows.mtx"}
scene = fanfold.Scene("boom_of_matrices", until="1 s")
scene.joint(cross_stiffness="1e8 N.m/rad", axial_stiffness="1e9 N/m", radial_stiffness="1e9 N/m")
scene.base("base", points={"foot": (0, 0, 0)})
place = {"body": "base", "point": "foot"}
scene.body("boom", place=place, **{"import": files | {"attachment_points": {"root": 1}}})
scene.connection("weld", "hinge", preset="fixed", ports={"inboard": place, "outboard": ("boom", "root")})
frequencies = fanfold.modes(scene, as_posed=True).frequencies
print("first pair of bending modes:", *(f"{frequency:.4f} Hz" for frequency in frequencies[:2]))
