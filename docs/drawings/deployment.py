"""Draw the deployment of AMOS-3 as the animation of the README: `python docs/drawings/deployment.py`."""

from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("agg")
import matplotlib.pyplot as plt
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.collections import PolyCollection

import orchestrator as fanfold
from orchestrator.views.placement import placed

FRAMES, LAST = 42, 13.2  # of the run, s
BOX = np.array([[-1.9, -0.8, -1.0], [0.0, 0.8, 1.0]])  # spacecraft, m: its side wall is at x = 0
LIGHT = np.array([0.35, -0.45, 0.82]) / np.linalg.norm([0.35, -0.45, 0.82])
CELLS, BACK, FRAME, HULL = (0.16, 0.27, 0.55), (0.78, 0.78, 0.74), (0.35, 0.35, 0.38), (0.83, 0.69, 0.38)
EYE = np.array([5.5, -9.5, 5.0])
TARGET = np.array([1.1, 0.0, 0.35])


def projected(points):
    """Screen coordinates and depth of points (..., 3) in a perspective view."""
    ahead = (TARGET - EYE) / np.linalg.norm(TARGET - EYE)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead)
    relative = points - EYE
    depth = relative @ ahead
    return np.stack([relative @ right, relative @ up], axis=-1) / depth[..., None], depth


def box_faces():
    """Faces (6, 4, 3) of the spacecraft."""
    corners = np.array([[BOX[i, 0], BOX[j, 1], BOX[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    return corners[[[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]]


def coloured(faces, colour, back):
    """Colours (F, 3): `back` where the lower side is seen, both shaded by the light."""
    normals = np.cross(faces[:, 2] - faces[:, 0], faces[:, 3] - faces[:, 1])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-12)[:, None]
    towards = np.einsum("fk,fk->f", normals, EYE - faces.mean(axis=1)) > 0.0
    shade = 0.55 + 0.45 * np.abs(normals @ LIGHT)
    return np.where(towards[:, None], colour, back) * shade[:, None]


def main(path: Path) -> None:
    result = fanfold.simulate("amos3", until=LAST, estimate=False)
    rows = np.searchsorted(result.time, np.linspace(0.0, LAST, FRAMES)).clip(0, result.time.size - 1)
    bodies = {
        name: body for name, body in result.geometry.items() if np.size(body.faces) and name != "spacecraft"
    }
    nodes = {name: placed(result, name, body, rows) for name, body in bodies.items()}
    latched = result.latch_times
    figure, axes = plt.subplots(figsize=(6.4, 3.4), dpi=100)
    figure.subplots_adjust(0, 0, 1, 1)

    def draw(k):
        axes.clear()
        axes.set_axis_off()
        axes.set_aspect("equal")
        axes.set(xlim=(-0.36, 0.42), ylim=(-0.21, 0.2))
        parts = [
            (box_faces(), np.full((6, 3), HULL) * np.array([0.62, 0.75, 0.7, 0.95, 0.7, 1.0])[:, None], 0.6)
        ]
        for name, body in bodies.items():
            faces = nodes[name][k][body.faces]
            panel = name.startswith("panel")
            colours = coloured(faces, CELLS if panel else FRAME, BACK if panel else FRAME)
            parts.append((faces, colours, 0.25 if panel else 2.2))
        faces = np.concatenate([part[0] for part in parts])
        colours = np.concatenate([part[1] for part in parts])
        widths = np.concatenate([np.full(len(part[0]), part[2]) for part in parts])
        screen, depth = projected(faces)
        behind = np.arange(len(faces)) < len(
            parts[0][0]
        )  # the spacecraft: the wing is in front of its side wall
        order = np.lexsort((-depth.mean(axis=1), ~behind))
        edges = np.where(widths[order, None] > 2.0, colours[order], 0.55 * colours[order])
        axes.add_collection(
            PolyCollection(
                screen[order], facecolors=colours[order], edgecolors=edges, linewidths=widths[order]
            )
        )
        time = result.time[rows[k]]
        states = "   ".join(f"{line} latched" for line, at in sorted(latched.items()) if at <= time)
        axes.text(
            0.03, 0.93, f"AMOS-3   {time:4.1f} s", transform=axes.transAxes, fontsize=11, family="monospace"
        )
        axes.text(0.03, 0.05, states, transform=axes.transAxes, fontsize=9, color="0.25", family="monospace")

    frames = [*range(FRAMES), *[FRAMES - 1] * 8]
    FuncAnimation(figure, draw, frames=frames).save(path, writer=PillowWriter(fps=8))


if __name__ == "__main__":
    main(Path(__file__).parent / "deployment.gif")
