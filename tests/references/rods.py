"""Mechanisms of rods: a slender rod, joints between points, four-bar linkages side by side."""

import orchestrator as fanfold

GRAVITY = 9.81


def joined(scene, name, preset, axis, inboard, outboard):
    """A joint between two points, (body, point)."""
    across = (0, 0, 1) if axis != (0, 0, 1) else (1, 0, 0)
    ports = {
        side: {"body": body, "point": point}
        for side, (body, point) in (("inboard", inboard), ("outboard", outboard))
    }
    scene.connection(name, "hinge", preset=preset, axes={"x": axis, "z": across}, ports=ports)


def slender(mass, length, far):
    points = {"a": (0, 0, 0), "b": (far, 0, 0)}
    inertia = (1e-4, mass * length**2 / 12.0, mass * length**2 / 12.0)
    return {"mass": mass, "center_of_mass": (length / 2, 0, 0), "inertia": inertia, "points": points}


def four_bars(count: int, until: float) -> fanfold.Scene:
    """So many windows of rods of 1 m and 1 kg, upright at 1 m/s: the rate of one crank is given, the others follow."""
    scene = fanfold.Scene("four_bars", until=until, gravity=(0, 0, -GRAVITY), preload=False)
    scene.base("ground", points={f"p{i}": (float(i), 0, 0) for i in range(count + 1)})
    rod, up = slender(1.0, 1.0, 1.0), {"x": (0, 0, 1), "z": (-1, 0, 0)}
    for i in range(count + 1):
        given = {"angular_velocity": (0, 1.0, 0)} if i == 0 else {}
        place = {"body": "ground", "point": f"p{i}"}
        scene.body(f"crank{i}", rigid=rod, place={**place, "orientation": up}, **given)
        joined(scene, f"foot{i}", "revolute", (0, 1, 0), ("ground", f"p{i}"), (f"crank{i}", "a"))
        if i < count:
            scene.body(f"coupler{i}", rigid=rod, place={**place, "offset": (0, 0, 1.0)})
    for i in range(count):
        joined(scene, f"left{i}", "revolute", (0, 1, 0), (f"crank{i}", "b"), (f"coupler{i}", "a"))
        joined(scene, f"right{i}", "revolute", (0, 1, 0), (f"coupler{i}", "b"), (f"crank{i + 1}", "b"))
    return scene
