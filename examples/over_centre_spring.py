"""How fast does a flap open by a spring that passes its dead centre? With a second flap on gears as well."""

import numpy as np

import orchestrator as fanfold

STIFFNESS, FREE, INERTIA = 400.0, 0.05, 0.05 + 0.5 * 0.2**2  # N/m, m, kg.m2 about the hinge


def opened(geared):
    """The run of one flap, or of two that gears turn against each other."""
    scene = fanfold.Scene("flap", until="1.2 s", tolerance=1e-5)
    scene.base("frame", points={"hinge": (0, 0, 0), "other": (0, 0.5, 0), "anchor": (-0.1, 0, 0)})
    points = {"root": (0, 0, 0), "lug": (0.1, 0, 0.02)}
    rigid = {"mass": 0.5, "center_of_mass": (0.2, 0, 0), "inertia": (0.01, 0.05, 0.05), "points": points}
    for name, at in (("flap", "hinge"), ("second", "other"))[: 2 if geared else 1]:
        scene.body(name, rigid=rigid, place={"body": "frame", "point": at})
        ports = {"inboard": {"body": "frame", "point": at}, "outboard": {"body": name, "point": "root"}}
        scene.connection(f"{name}_pin", "hinge", ports=ports, preset="revolute", axes={"x": (0, 1, 0)})
    ports = {"inboard": {"body": "frame", "point": "anchor"}, "outboard": {"body": "flap", "point": "lug"}}
    scene.connection(
        "spring", "spring", ports=ports, parameters={"stiffness": STIFFNESS, "preload_length": FREE}
    )
    if geared:
        wheels = {"first": {"body": "flap", "point": "root"}, "second": {"body": "second", "point": "root"}}
        ports = {"carrier": {"body": "frame", "point": "hinge"}, **wheels}
        scene.connection("gear", "gear", ports=ports, parameters={"ratio": -1})
    return fanfold.simulate(scene, estimate=False)


runs = {"one flap": opened(geared=False), "two flaps": opened(geared=True)}
rates = {}
for name, run in runs.items():
    angle = np.abs(run["flap_pin", "angle"][:])
    rates[name] = np.interp(
        np.pi / 2, angle[: angle.argmax()], np.abs(run["flap_pin", "angular_rate"][: angle.argmax()])
    )
    print(
        f"{name}: {rates[name]:.3f} rad/s at 90 deg, spring force up to {np.max(run['spring', 'tension'][:]):.1f} N"
    )
