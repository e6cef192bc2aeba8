"""Dependence of modes on joints whose stiffness a scene does not state."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from components import rotation_matrix
from components.contract.component import Vector
from components.hinge import Hinge

from ..assembly.statics.linear_model import LinearModel, NormalModes
from ..assembly.statics.mechanism import Mechanism
from ..scene import PlacedScene
from ..scene.hinge_line_tables import Joint
from ..scene.joint_presets import CONSTRAINED
from ..scene.reader import whole_tree

_TOLD = 0.1
"""Of a mode's strain energy: stiff joints in their place raise its frequency by half as much."""
_MODES = 6
"""The first ones, that a scene is judged by."""
_NAMED = 3


def default_joint_warnings(scene: PlacedScene, model: LinearModel, modes: NormalModes) -> Iterator[str]:
    """A sentence for the first mode that depends most on default joint stiffness, if that is above a tenth."""
    if np.iscomplexobj(modes.shapes):
        return
    first = np.flatnonzero(~modes.is_free & (modes.eigenvalues > 0.0))[:_MODES]
    found = {
        name: _strain(model.mechanism, name, stiffness, modes.shapes[:, first]) / modes.eigenvalues[first]
        for name, stiffness in _stiff_by_default(scene)
        if name in model.mechanism.connections and stiffness.any()
    }
    whole = sum(found.values(), np.zeros(first.size))
    if not whole.max(initial=0.0) > _TOLD:
        return
    k = int(whole.argmax())
    names = sorted(found, key=lambda name: -found[name][k])
    several = ", ".join(names[:_NAMED]) + (" and others" if len(names) > _NAMED else "")
    mode = f"mode {first[k] + 1} ({modes.frequencies[first[k]]:.4g} Hz)"
    yield (
        f"{scene.header.name}: {mode} depends on default joint stiffness ({whole[k]:.0%} of its strain energy, in "
        f"{several}). Enter measured values in [joint]."
    )


def _stiff_by_default(scene: PlacedScene) -> Iterator[tuple[str, Vector]]:
    """Joints with their stiffness (6,) along and about their axes, zero where the scene states it."""
    default, stated = Joint(), scene.joint.model_fields_set
    axial, radial, cross = (
        0.0 if f"{way}_stiffness" in stated else float(getattr(default, f"{way}_stiffness"))
        for way in ("axial", "radial", "cross")
    )

    def of(kind: str, first: float, own: tuple[object, object]) -> Vector:
        along, about = CONSTRAINED[kind]
        parts = np.multiply(along, (first, radial, radial)), np.multiply(about, cross)
        return np.concatenate([part * (given is None) for part, given in zip(parts, own, strict=True)])

    # a hinge of a line is softer along it than across, a joint of a preset as stiff
    for hinge in (hinge for line in scene.hinge_lines for hinge in line.hinges):
        yield hinge.name, of(hinge.kind, axial, (hinge.translational_stiffness, hinge.rotational_stiffness))
    written = {entry["name"]: entry for entry in whole_tree(dict(scene.tree)).get("connection", ())}
    for joint in scene.connections:
        if joint.preset in CONSTRAINED:
            own = written[joint.name].get("parameters", {})
            yield (
                joint.name,
                of(
                    joint.preset,
                    radial,
                    (own.get("translational_stiffness"), own.get("rotational_stiffness")),
                ),
            )


def _strain(mechanism: Mechanism, joint: str, stiffness: Vector, shapes: Vector) -> Vector:
    """Twice the strain energy (k,) in a joint's springs."""
    connection = mechanism.connections[joint]
    axes = rotation_matrix(Hinge.states.read(connection.state).frame)
    inboard, outboard = (mechanism.jacobian(joint, port) for port in (0, 1))
    apart = (outboard - inboard) @ shapes
    own = np.concatenate([axes.T @ apart[:3], axes.T @ apart[3:]])
    strain: Vector = stiffness @ own**2
    return strain
