"""A beam of large deformation at rest: its nodes' poses, generalised forces, and their exact derivatives.

Its coordinates are six small motions of every node in world axes, a translation and a rotation vector.
"""

from __future__ import annotations

import numpy as np

from components.beam import Beam
from components.contract.component import Vector
from components.contract.frames import (
    Quaternion,
    exponential,
    multiply,
    normalized,
    rotate_back,
    rotation_between,
    rotation_matrix,
)

from .. import Part
from .placed_body import Memory, PlacedBody


class PlacedBeam(PlacedBody):
    """A beam at rest by the places (n, 3) and orientations (n, 4) of its nodes."""

    is_led = False

    def _place(self, part: Part) -> None:
        self.beam = Beam(**part.structure)
        state, at = self._instance.state, self.beam.state_layout
        self._points = state[at["position"]].reshape(-1, 3).copy()
        self._turned = state[at["orientation"]].reshape(-1, 4).copy()
        self._built = self.memory()
        self.body, self.modes = None, 0

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return 6 * len(self._points)

    @property
    def points(self) -> Vector:
        """(n, 3), about which the coordinates are."""
        return self._points

    def memory(self) -> Memory:
        """Where it is."""
        return self._points, self._turned

    def remember(self, memory: Memory) -> None:
        """Come back to there."""
        self._points, self._turned = memory

    def move(self, step: Vector) -> None:
        """Move by small coordinates (size,)."""
        motions = step.reshape(-1, 6)
        self._points = self._points + motions[:, :3]
        turned = [
            normalized(multiply(exponential((x, y, z)), (a, b, c, d)))
            for (x, y, z), (a, b, c, d) in zip(motions[:, 3:].tolist(), self._turned.tolist(), strict=True)
        ]
        self._turned = np.array(turned)

    def _rest(self) -> None:
        state, at = self._instance.state, self.beam.state_layout
        state[at["position"]], state[at["orientation"]] = self._points.ravel(), self._turned.ravel()
        state[at["velocity"]] = state[at["angular_velocity"]] = 0.0

    def forces(self, wrenches: Vector) -> Vector:
        """Generalised forces (size,) of wrenches (ports, 6), weight and elasticity."""
        self._rest()
        return self.beam.loads_at_rest(self._instance.constants, self._instance.state, wrenches).ravel()

    def port_jacobian(self, port: int) -> Vector:
        """Motion (6, size) of a port under unit coordinates."""
        self._rest()
        return self.beam.motion_of_port(self._instance.state, port)

    def stiffness(self, wrenches: Vector) -> Vector:
        """Minus the derivative (size, size) of the generalised forces under wrenches (ports, 6)."""
        self._rest()
        return self.beam.stiffness_at_rest(self._instance.state, wrenches)

    def mass(self) -> Vector:
        """Mass matrix (size, size)."""
        self._rest()
        return self.beam.mass_at_rest(self._instance.state)

    def bent_from(self, orientation: Quaternion) -> dict[str, tuple[float, ...]]:
        """Start values of the nodes of a beam that was built with this orientation, and unbent."""
        moved = (self._points - self._built[0]) @ rotation_matrix(orientation)
        turns = [
            rotate_back(orientation, rotation_between((w, x, y, z), (a, b, c, d)))
            for (w, x, y, z), (a, b, c, d) in zip(self._built[1].tolist(), self._turned.tolist(), strict=True)
        ]
        return {
            "initial_displacement": tuple(moved.ravel().tolist()),
            "initial_rotation": tuple(np.ravel(turns).tolist()),
        }
