"""Drawings of the documents, from the scenes of the pages and of the package: `python docs/drawings/draw.py`.

Each function draws one SVG file. Text stays text, and the same scenes make the same bytes.
"""

from __future__ import annotations

import re
import tempfile
import tomllib
from collections.abc import Callable, Mapping
from math import acos, cos, degrees, radians, sin
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, FancyBboxPatch, Rectangle
from numpy.typing import ArrayLike

import orchestrator as fanfold
from orchestrator.scene.bodies import body_definition

HERE = Path(__file__).parent
PAGES = HERE.parent
STYLE: Mapping[str, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "fanfold",
    "font.family": "sans-serif",
    "font.size": 8,
    "lines.solid_capstyle": "round",
}
BLUE, ORANGE, GREEN, GREY, INK = "#0072B2", "#D55E00", "#009E73", "#9A9A9A", "#222222"
PALE = "#E8EEF4"
WHITE = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.4}
_BLOCK = re.compile(r"^```(?:toml|python)\n(# (\S+\.(?:toml|py))\n.*?)^```", re.M | re.S)


def blocks(page: Path) -> dict[str, str]:
    """Scenes and programs of a page by the file name in their first line."""
    return {name: text for text, name in _BLOCK.findall(page.read_text(encoding="utf-8"))}


def scene_of(page: str, name: str, folder: Path) -> Path:
    """A scene of a page as a file in a folder."""
    path = folder / name
    path.write_text(blocks(PAGES / page)[name], encoding="utf-8")
    return path


def hinge_angle(folder: Path) -> Figure:
    """A line that opens from the side wall, and one between two panels, both from the side."""
    figure, (left, right) = _figure(7.2, 3.5, 2)
    wing = scene_of("first_hour.md", "wing.toml", folder)
    _from_the_wall(left, wing)
    _between_panels(right, scene_of("scenes.md", "two_panels.toml", folder))
    return figure


def _from_the_wall(axes: Any, scene: Path) -> None:
    now = 35.0
    at = {angle: _side_views(scene, {"HL1": angle})["panel"] for angle in (0.0, now, 90.0)}
    axes.add_patch(Rectangle((-0.55, -0.5), 0.5, 1.0, facecolor=PALE, edgecolor=INK, linewidth=0.8))
    axes.text(-0.3, 0.3, "spacecraft\n(inboard)", ha="center", va="center")
    _plate(axes, at[0.0], GREY, "--")
    _plate(axes, at[now], BLUE, "-")
    _plate(axes, at[90.0], GREEN, "--")
    _arc(axes, (0.0, 0.0), 0.75, 90.0 - now, 90.0, BLUE, "hinge angle", (-0.05, 0.78))
    _arc(axes, (0.0, 0.0), 1.25, 0.0, 90.0, GREY, "aligned_angle\n= 90 deg", (1.2, 0.55))
    axes.text(0.06, 1.93, "stowed: angle 0", color=INK, ha="left")
    axes.text(*np.add(at[now][1], (0.03, 0.03)), "panel (outboard)", color=BLUE, ha="left")
    axes.text(0.35, -0.1, "deployed: axes parallel, latched", color=GREEN, ha="left", va="top")
    _triad(axes, (-0.45, -0.4), (1.0, 0.0), (0.0, 1.0), INK)
    direction, normal = _directions(at[now])
    _triad(axes, np.array(at[now][0]) + 1.05 * direction, direction, normal, BLUE)
    _into_page(axes, (0.0, 0.0), 'axis = "+y"', (0.05, -0.4))
    _frame(axes, (-0.6, 2.35), (-0.6, 2.1), "a line at the side wall")


def _between_panels(axes: Any, scene: Path) -> None:
    now = 60.0
    views = {angle: _side_views(scene, {"HL1": 90.0, "HL2": angle}) for angle in (0.0, now, 180.0)}
    _plate(axes, views[0.0]["panel1"], INK, "-")
    lowered = [np.array(end) - (0.0, 0.12) for end in views[0.0]["panel2"]]
    _plate(axes, lowered, GREY, "--")
    _plate(axes, views[now]["panel2"], BLUE, "-")
    _plate(axes, views[180.0]["panel2"], GREEN, "--")
    line = np.array(views[now]["panel2"][0])
    _arc(axes, line, 0.8, 180.0, 180.0 + now, BLUE, "hinge angle", np.add(line, (-0.62, -0.62)))
    _arc(axes, line, 1.4, 180.0, 360.0, GREY, "aligned_angle\n= 180 deg", np.add(line, (0.75, -1.45)))
    axes.text(0.62, 0.12, "panel1 (inboard)", ha="left")
    axes.text(0.0, -0.33, "stowed: angle 0", ha="left")
    axes.text(*np.add(views[now]["panel2"][1], (-0.1, 0.05)), "panel2\n(outboard)", color=BLUE, ha="right")
    axes.text(3.45, 0.1, "deployed", color=GREEN, ha="center")
    _triad(axes, (0.1, 0.3), (1.0, 0.0), (0.0, 1.0), INK, 0.35)
    direction, normal = _directions(views[now]["panel2"])
    _triad(axes, line + 1.3 * direction, direction, normal, BLUE, 0.35)
    _out_of_page(axes, line, 'axis = "-y"', np.add(line, (0.25, 0.32)))
    _frame(axes, (-0.2, 4.7), (-2.4, 1.4), "a line between two panels")


def _side_views(scene: Path, angles: Mapping[str, float]) -> dict[str, list[tuple[float, float]]]:
    """Both ends (x, z) of every panel along its x axis, with lines at some angles in degrees."""
    settings = {f"hinge_line.{line}.start_angle": f"{angle} deg" for line, angle in angles.items()}
    found = fanfold.check_scene(scene, settings={**settings, "scene.preload": False}, rigid="all")
    assert found.stowed is not None, found.problems
    lengths = {body.name: body.size[0] for body in found.bodies}
    views = {}
    for name, (origin, axes) in found.stowed.frames.items():
        end = origin + lengths[name] * axes[:, 0]
        views[name] = [(float(origin[0]), float(origin[2])), (float(end[0]), float(end[2]))]
    return views


def panel(folder: Path) -> Figure:
    """Plan and side view of the panel of the page on bodies, with the keys of its dimensions."""
    scene = scene_of("bodies.md", "drawn_panel.toml", folder)
    table = tomllib.loads(scene.read_text(encoding="utf-8"))["body"][0]["panel"]
    points = fanfold.load(scene).check_one_run().points["panel1"]
    size = {key: _metres(table[key]) for key in ("length", "width")}
    arm = {key: _metres(table["arm"][key]) for key in ("y", "length", "patch")}
    figure, (plan, side) = _figure(7.2, 5.2, 2, rows=True, heights=(3.6, 1.0))
    start, half = arm["length"], 0.5 * size["width"]
    end = start + size["length"]
    plan.add_patch(Rectangle((start, -half), size["length"], 2 * half, facecolor=PALE, edgecolor=INK))
    _arms_and_points(plan, points, arm, (start, end))
    insert = table["inserts"][0]
    x, patch = _metres(insert["x"]), _metres(insert["patch"])
    plan.add_patch(Rectangle((x - patch / 2, -patch / 2), patch, patch, facecolor=ORANGE, alpha=0.5))
    _label(plan, (x, 0.0), (x + 0.12, 0.14), 'insert "lock": patch = 80 mm', ORANGE)
    tip = points["tip_left"][0]
    for place, name in ((0.0, 'hinge line "hl2"'), (tip, 'hinge line "tip"')):
        plan.plot([place, place], [-half - 0.12, half + 0.12], color=INK, linestyle="-.", linewidth=0.8)
        plan.text(place, half + 0.15, name, ha="center")
    _triad(plan, (0.0, 0.0), (1.0, 0.0), (0.0, 1.0), INK, 0.25, ("x", "y"))
    _dimension(plan, (start, -half - 0.28), (end, -half - 0.28), "length = 2.2 m")
    _dimension(plan, (end + 0.42, -half), (end + 0.42, half), "width\n= 1.1 m")
    _dimension(plan, (-0.33, 0.0), (-0.33, arm["y"]), "arm y\n= 0.45 m")
    _label(plan, (start / 2, -arm["y"]), (-0.28, -half - 0.18), "arm: length = 40 mm", BLUE)
    _label(plan, (start + arm["patch"] / 2, -arm["y"]), (0.3, -0.3), "arm: patch = 60 mm", BLUE)
    _frame(plan, (-0.75, 3.05), (-1.0, 0.85), "")
    offset = 1e3 * _metres(table["hinge_line_offsets"]["outboard"])
    side.plot([start, end], [0, 0], color=INK, linewidth=4, alpha=0.35)
    for place, z, name in ((0.0, 0.0, "inboard: 0"), (tip, offset, f"outboard: {offset:g} mm")):
        side.plot(place, z, marker="o", color=BLUE, markersize=4)
        side.plot([place, start if place < start else end], [z, 0.0], color=BLUE, linewidth=1.2)
        side.text(place, z - 6, name, ha="center", va="top", color=BLUE)
    side.text(0.5 * (start + end), 5, "from the side: hinge_line_offsets along z", ha="center")
    side.axis("off")
    side.set(xlim=(-0.75, 3.05), ylim=(-28, 14))
    return figure


def _arms_and_points(
    axes: Any,
    points: Mapping[str, Any],
    arm: Mapping[str, float],
    edges: tuple[float, float],
) -> None:
    patch = arm["patch"]
    for name, (x, y, _) in points.items():
        if name.endswith(("_left", "_right")):
            edge = edges[0] if x < edges[0] else edges[1]
            inner = edge if x < edge else edge - patch
            axes.add_patch(Rectangle((inner, y - patch / 2), patch, patch, facecolor=BLUE, alpha=0.45))
            axes.plot([x, edge], [y, y], color=BLUE, linewidth=2)
            out = -0.04 if x < edges[0] else 0.04
            axes.text(x + out, y, name, ha="right" if out < 0 else "left", va="center")
        elif name in ("sensor", "center"):
            axes.text(x, y - 0.05, f'node "{name}"', ha="center", va="top", color=GREEN)
        colour = GREEN if name in ("sensor", "center") else ORANGE if name == "lock" else BLUE
        axes.plot(x, y, marker="o", color=colour, markersize=3.5)


def yoke(folder: Path) -> Figure:
    """The yoke of AMOS-3: members through joints, attachment points and nodes."""
    del folder
    scene = fanfold.load("amos3").check_one_run()
    definition = body_definition(next(body for body in scene.bodies if body.name == "yoke"))
    assert definition.frame is not None
    places = dict(definition.frame.joints)
    figure, (axes,) = _figure(5.4, 4.0, 1)
    for member, colour in zip(definition.frame.members, (BLUE, GREEN, ORANGE), strict=True):
        course = np.array([places[name] for name in member.joints])
        axes.plot(course[:, 0], course[:, 1], color=colour, linewidth=2.5)
        tube = member.section
        told, side = f'member "{member.name}"', 1.0 if course[-1][1] > 0 else -1.0
        if member.name == "bar":
            axes.text(course[0][0] + 0.02, 0.0, told, color=colour, rotation=90, va="center")
        else:
            axes.text(0.68, side * 0.49, told, color=colour, ha="right", va="center")
    for name, (x, y, _) in places.items():
        attached, node = name in definition.attachment_points, name in definition.nodes
        colour = INK if attached else GREEN if node else GREY
        kind = "attachment point" if attached else "node" if node else "joint"
        axes.plot(x, y, marker="o" if attached else "s", color=colour, markersize=6)
        place = (x + 0.04, y) if attached and x > 0.0 else (0.24, 0.0) if attached else (0.44, 1.2 * y)
        axes.text(
            *place, f'{kind} "{name}"\n({x:g}, {y:g}, 0) m', ha="left" if attached else "right", va="center"
        )
    axes.text(0.0, -0.62, f"tube: EA = {tube.axial:.3g} N, {tube.line_mass:.3g} kg/m", ha="left")
    _triad(axes, (0.0, 0.0), (1.0, 0.0), (0.0, 1.0), INK, 0.16, ("x", "y"))
    axes.plot([0, 0], [-0.29, 0.24], color=INK, linestyle="-.", linewidth=0.8)
    axes.text(-0.02, -0.25, "HL1", ha="right")
    bar = places["hl2_left"]
    for side in (1.0, -1.0):
        ends = [side * bar[1], side * (bar[1] + 0.13)]
        axes.plot([bar[0]] * 2, ends, color=INK, linestyle="-.", linewidth=0.8)
    axes.text(bar[0], bar[1] + 0.14, "HL2", ha="center")
    _frame(axes, (-0.12, 1.45), (-0.72, 0.76), "")
    return figure


def ccl(folder: Path) -> Figure:
    """The cable loop of two panels: pulleys, strands, radii against travels; the distance is shortened."""
    found = fanfold.check_scene(scene_of("scenes.md", "two_panels.toml", folder), rigid="all")
    loop = found.loops[0]
    assert loop.travels is not None
    radii = [1e3 * radius for radius in loop.radii]
    turns = [abs(degrees(travel)) for travel in loop.travels]
    figure, (axes,) = _figure(6.6, 3.1, 1)
    far = 320.0
    axes.plot([0, far], [0, 0], color=GREY, linewidth=6, alpha=0.5, solid_capstyle="butt")
    axes.text(0.52 * far, 6, "panel1, the body between: carries no pulley", ha="center")
    lean = acos((radii[0] - radii[1]) / far)
    for sign in (1, -1):
        ends = [(x + r * cos(lean), sign * r * sin(lean)) for x, r in ((0.0, radii[0]), (far, radii[1]))]
        axes.plot(*np.transpose(ends), color=INK, linewidth=1.2)
        x, y = np.mean(ends, axis=0)
        axes.text(x, y + sign * 5, "strand", ha="center", va="bottom" if sign > 0 else "top")
        along = sign * np.subtract(ends[0], ends[1]) / far
        axes.annotate(
            "", (x, y) + 75 * along, (x, y) + 45 * along, arrowprops={"arrowstyle": "->", "lw": 1.2}
        )
    for x, radius, turn, colour, body, key in (
        (0.0, radii[0], turns[0], BLUE, loop.bodies[0], "pulley_1"),
        (far, radii[1], turns[1], ORANGE, loop.bodies[1], "pulley_2"),
    ):
        axes.add_patch(Circle((x, 0), radius, facecolor="white", edgecolor=colour, linewidth=1.8))
        axes.plot([x, x], [0, -radius], color=colour, linewidth=1.0)
        axes.text(x + 3, -0.55 * radius, f"{radius:.0f}", color=colour, ha="left", va="center")
        told = f"{key} on {body}\nradius = {radius:.0f} mm\ntravel {turn:.0f} deg relative to panel1"
        axes.text(x, -radius - 10, told, ha="center", va="top", color=colour)
        axes.plot(x, 0, marker="o", color=colour, markersize=3.5)
        axes.add_patch(
            Arc((x, 0), 1.3 * radius, 1.3 * radius, theta1=20, theta2=160, color=colour, linewidth=1.0)
        )
        tip = (x - 0.65 * radius * cos(radians(20)), 0.65 * radius * sin(radians(20)))
        axes.annotate(
            "", tip, (tip[0] + 2, tip[1] + 5), arrowprops={"arrowstyle": "->", "color": colour, "lw": 1.0}
        )
    axes.text(0, radii[0] + 8, "HL1", ha="center")
    axes.text(far, radii[1] + 8, "HL2", ha="center")
    told = " = ".join(f"{r:.0f} mm x {t:.0f} deg" for r, t in zip(radii, turns, strict=True))
    axes.text(0.5 * far, 86, f"radius_1 x travel_1 = radius_2 x travel_2: {told}", ha="center")
    _frame(axes, (-95, 415), (-122, 100), "")
    return figure


def step(folder: Path) -> Figure:
    """What the master does in one communication step."""
    del folder
    figure, (axes,) = _figure(8.0, 5.0, 1)
    texts = {
        "predict": (0.2, 9.0, "1  predict\nwrenches at all ports,\nsave all states"),
        "bodies": (3.75, 9.0, "2  bodies step\nfrom saved states to t + H,\nwith mean and slope of wrenches"),
        "motion": (7.3, 9.0, "3  poses at t + H,\nfirst moments of velocity"),
        "connections": (7.3, 6.6, "4  connections return\nmean wrenches and slopes"),
        "residual": (3.75, 6.6, "5  residual = returned\nless assumed wrenches"),
        "newton": (0.2, 6.6, "6  Newton step with\ninterface Jacobian"),
        "checks": (3.75, 4.2, "7  energy balance,\nlocal error"),
        "event": (3.75, 1.8, "8  event function\nchanged its sign?"),
        "reject": (0.2, 4.2, "reject: restore states,\nsmaller step"),
        "root": (0.2, 1.8, "restore states, step to\nthe root, event there"),
        "accept": (7.3, 1.8, "accept: record row,\nnext step size"),
    }
    wide, high = 2.6, 1.3
    colours = {"reject": ORANGE, "accept": GREEN, "root": BLUE}
    for key, (x, y, text) in texts.items():
        colour = colours.get(key, INK)
        box = FancyBboxPatch((x, y), wide, high, boxstyle="round,pad=0.05", facecolor=PALE, edgecolor=colour)
        axes.add_patch(box)
        axes.text(x + wide / 2, y + high / 2, text, ha="center", va="center", color=colour)
    mid = {key: (x + wide / 2, y + high / 2) for key, (x, y, _) in texts.items()}
    for start, end, text, away in (
        ("predict", "bodies", "", (0, 0)),
        ("bodies", "motion", "", (0, 0)),
        ("motion", "connections", "", (0, 0)),
        ("connections", "residual", "", (0, 0)),
        ("residual", "newton", "large", (0, 0.12)),
        ("residual", "checks", "small", (0.4, 0.0)),
        ("checks", "reject", "open\nor large", (0, 0.12)),
        ("checks", "event", "closed, small", (0.65, 0.0)),
        ("event", "root", "yes", (0, 0.12)),
        ("event", "accept", "no", (0, 0.12)),
    ):
        _arrow(axes, mid[start], mid[end], (wide, high), text, away)
    axes.annotate("", (4.3, 8.93), (2.5, 7.97), arrowprops={"arrowstyle": "->", "color": INK, "lw": 1.0})
    axes.text(3.75, 8.35, "next sweep", ha="left", va="center")
    axes.text(8.6, 5.3, "sweep: 2 to 5,\nusually two to four a step", ha="center", va="center", color=GREY)
    axes.set_aspect("auto")
    _frame(axes, (-0.1, 10.1), (1.5, 10.6), "", equal=False)
    return figure


def first_hour(folder: Path) -> Figure:
    """Angle and latch torque of the wing of the first hour, rigid and flexible."""
    scene = scene_of("first_hour.md", "wing.toml", folder)
    figure, (left, right) = _figure(7.2, 2.7, 2)
    for name, rigid, colour, dash in (("rigid", "all", BLUE, "-"), ("flexible", (), ORANGE, "--")):
        result = fanfold.simulate(scene, rigid=rigid, estimate=False)
        angle, torque = result["hl1_left", "angle"], result.latch_torque("HL1")
        near = (result.time > 4.5) & (result.time < 5.6)
        every = slice(None, None, max(1, result.time.size // 400))
        left.plot(
            result.time[every], np.degrees(angle[:][every]), dash, color=colour, linewidth=1.2, label=name
        )
        right.plot(
            result.time[near][::2], torque[:][near][::2], dash, color=colour, linewidth=1.0, label=name
        )
    for axes, told in ((left, "hinge angle, deg"), (right, "latch torque, N.m")):
        axes.set(xlabel="time, s", ylabel=told)
        axes.grid(alpha=0.35, linewidth=0.5)
        axes.legend(frameon=False)
    figure.subplots_adjust(left=0.08, right=0.98, bottom=0.17, top=0.96, wspace=0.28)
    return figure


def _figure(
    width: float, height: float, count: int, *, rows: bool = False, heights: ArrayLike = ()
) -> tuple[Figure, Any]:
    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    shape = (count, 1) if rows else (1, count)
    given = {"height_ratios": heights} if rows else None
    axes = np.atleast_1d(figure.subplots(*shape, gridspec_kw=given)).ravel()
    figure.subplots_adjust(left=0.01, right=0.99, bottom=0.01, top=0.95, wspace=0.03, hspace=0.02)
    return figure, axes


def _frame(axes: Any, x: ArrayLike, y: ArrayLike, title: str, *, equal: bool = True) -> None:
    axes.axis("off")
    axes.set(xlim=x, ylim=y)
    axes.set_title(title, fontsize=9)
    if equal:
        axes.set_aspect("equal")


def _plate(axes: Any, ends: Any, colour: str, dash: str) -> None:
    axes.plot(*np.transpose(ends), color=colour, linestyle=dash, linewidth=2.6 if dash == "-" else 1.6)
    axes.plot(*ends[0], marker="o", color=INK, markersize=4, zorder=5)


def _directions(ends: Any) -> tuple[Any, Any]:
    """Unit vectors (x, z) along a panel and along its normal."""
    along = np.subtract(ends[1], ends[0])
    along = along / np.hypot(*along)
    return along, np.array([-along[1], along[0]])


def _arc(
    axes: Any, centre: Any, radius: float, low: float, high: float, colour: str, text: str, at: Any
) -> None:
    axes.add_patch(Arc(centre, 2 * radius, 2 * radius, theta1=low, theta2=high, color=colour, linewidth=1.0))
    side = "left" if at[0] > centre[0] else "right"
    axes.text(*at, text, color=colour if colour != GREY else INK, ha=side, va="center")


def _triad(
    axes: Any,
    origin: ArrayLike,
    first: ArrayLike,
    second: ArrayLike,
    colour: str,
    size: float = 0.28,
    names: tuple[str, str] = ("x", "z"),
) -> None:
    for name, direction in zip(names, (first, second), strict=True):
        tip = np.asarray(origin) + size * np.asarray(direction)
        axes.annotate("", tip, origin, arrowprops={"arrowstyle": "->", "color": colour, "lw": 1.1}, zorder=6)
        axes.text(
            *(tip + 0.22 * size * np.asarray(direction)),
            name,
            color=colour,
            ha="center",
            va="center",
            zorder=6,
            bbox=WHITE,
        )


def _into_page(axes: Any, at: Any, text: str, place: Any) -> None:
    axes.plot(*at, marker="o", markersize=9, markerfacecolor="white", markeredgecolor=INK, zorder=7)
    axes.plot(*at, marker="x", markersize=6, color=INK, zorder=8)
    axes.text(*place, f"{text},\ninto the page", ha="left", va="center")


def _out_of_page(axes: Any, at: Any, text: str, place: Any) -> None:
    axes.plot(*at, marker="o", markersize=9, markerfacecolor="white", markeredgecolor=INK, zorder=7)
    axes.plot(*at, marker="o", markersize=3, color=INK, zorder=8)
    axes.text(*place, f"{text},\nout of the page", ha="center", va="bottom")


def _dimension(axes: Any, start: Any, end: Any, text: str) -> None:
    axes.annotate("", start, end, arrowprops={"arrowstyle": "<->", "color": GREY, "lw": 0.9})
    x, y = np.mean([start, end], axis=0)
    if start[0] == end[0]:
        side = -1.0 if x < 0.0 else 1.0
        axes.text(x + 0.03 * side, y, text, ha="right" if side < 0.0 else "left", va="center")
    else:
        axes.text(x, y - 0.03, text, ha="center", va="top")


def _label(axes: Any, at: Any, place: Any, text: str, colour: str) -> None:
    arrow = {"arrowstyle": "-", "color": colour, "lw": 0.7}
    axes.annotate(text, at, place, color=colour, arrowprops=arrow, va="center", ha="left")


def _arrow(axes: Any, start: Any, end: Any, size: tuple[float, float], text: str, away: Any) -> None:
    """An arrow from the edge of one box of a size to that of another in its row or column."""
    start, end = np.array(start), np.array(end)
    way = np.sign(end - start)
    reach = 0.5 * np.array(size) + 0.08
    tail, head = start + way * reach * (way != 0), end - way * reach * (way != 0)
    axes.annotate("", head, tail, arrowprops={"arrowstyle": "->", "color": INK, "lw": 1.0})
    if text:
        axes.text(*(0.5 * (tail + head) + away), text, ha="center", va="bottom" if way[0] else "center")


def _metres(text: str) -> float:
    """A length as scenes write it, in m."""
    number, unit = text.split()
    return float(number) * {"m": 1.0, "mm": 1e-3}[unit]


DRAWINGS: Mapping[str, Callable[[Path], Figure]] = {
    drawing.__name__: drawing for drawing in (hinge_angle, panel, yoke, ccl, step, first_hour)
}


def draw(folder: Path) -> list[Path]:
    """Write every drawing into a folder; the paths written."""
    paths = []
    with tempfile.TemporaryDirectory() as scenes, mpl.rc_context(STYLE):
        for name, drawing in DRAWINGS.items():
            paths.append(folder / f"{name}.svg")
            drawing(Path(scenes)).savefig(paths[-1], metadata={"Date": None, "Creator": None})
    return paths


if __name__ == "__main__":
    for path in draw(HERE):
        print(path.name, path.stat().st_size)
