"""A scene and where its bodies start: points, poses, rates, rigid groups and inertias about hinge lines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Self

import numpy as np

from components import Instance
from components.contract.frames import Vector3
from components.flexible.modal import ModalData

from .bodies import (
    Attachment,
    StartPose,
    attachments,
    base_model,
    body_model,
    moved,
    point_positions,
    written_poses,
)
from .body_tables import Motion
from .component_connections import seated
from .connection_tables import Connection
from .hinge_line_tables import HingeLine
from .line_inertia import line_inertia
from .loops.constraints import Constraint, Vector, constraints, farthest
from .loops.coupled_lines import CoupledLines, coupled_lines
from .loops.initial_assembly import Closed, Weight, acts, close, closed
from .loops.rates import Standing, StartRates, start_rates
from .schema import SceneTables
from .table import SceneError

_STAGES = 16
"""Positions on the way to where motions lead, so that loops stay on the side where they start."""


class PlacedScene(SceneTables):
    """A scene file that was read and found consistent, with its geometry; each property is computed once.

    Points are positions (m) in the construction frame of their body, poses are those of this frame in the world.
    """

    @cached_property
    def rigid_models(self) -> Mapping[str, ModalData]:
        """Rigid models of a free base and of every body."""
        base = base_model(self.base)
        own = {body.name: body_model(body, flexible=False) for body in self.bodies}
        return own if base is None else {self.base.name: base, **own}

    @cached_property
    def points(self) -> Mapping[str, Mapping[str, Vector3]]:
        """Attachment points of the base and of every body, undeformed."""
        own = {body.name: point_positions(self.rigid_models[body.name]) for body in self.bodies}
        return {self.base.name: self.base.points, **own}

    @cached_property
    def attachments(self) -> tuple[Attachment, ...]:
        """Every port of every connection."""
        return tuple(attachments(self.hinge_lines, self.loops, self.dampers, self.connections))

    @cached_property
    def motions(self) -> Mapping[str, Motion]:
        """Prescribed motions of the base and of bodies."""
        found = {self.base.name: self.base.motion, **{body.name: body.motion for body in self.bodies}}
        return {name: motion for name, motion in found.items() if motion is not None}

    @cached_property
    def group_roots(self) -> Mapping[str, str]:
        """Body that names the rigid group of every body: itself, or the innermost that held lines lead to."""
        roots = {name: name for name in (self.base.name, *(body.name for body in self.bodies))}
        held = {line.outboard: line.inboard for line in self.hinge_lines if line.held}
        for body in roots:
            while (inner := held.get(roots[body])) is not None:
                roots[body] = inner
        return roots

    @cached_property
    def locked_bodies(self) -> frozenset[str]:
        """Bodies in rigid groups of several, which are therefore rigid."""
        shared = {root for body, root in self.group_roots.items() if root != body}
        return frozenset(body for body, root in self.group_roots.items() if root in shared)

    @cached_property
    def coupled_lines(self) -> tuple[CoupledLines, ...]:
        """Groups of two or more moving lines whose rates are in fixed ratios."""
        return coupled_lines(self)

    @cached_property
    def written_poses(self) -> Mapping[str, StartPose]:
        """Poses as written, before loops are closed."""
        return written_poses(self, self.points)

    @cached_property
    def constraints(self) -> tuple[Constraint, ...]:
        """Of joints with a preset, and of point motions at the start."""
        return tuple(constraints(self.connections, self.points, self.written_poses, self.header.until))

    @property
    def poses(self) -> Mapping[str, StartPose]:
        """Start poses."""
        return self.closed.poses

    @cached_property
    def closed(self) -> Closed:
        """Start poses, where placed bodies are displaced as little as closes all loops."""
        return self._closed((0.0,))

    @cached_property
    def extended(self) -> Closed:
        """The same with all motions at once as far from the start as their laws lead during the scene."""
        return self._closed(np.linspace(0.0, 1.0, _STAGES + 1).tolist())

    @cached_property
    def left_open(self) -> Mapping[str, float]:
        """How far (m or rad) joints start open that nothing closes, as hinge lines carry both of their bodies."""
        placed = {body.name for body in self.bodies if body.place is not None}
        held = [c for c in self.constraints if not acts(c, placed)]
        return {c.connection: float(np.abs(c.rows(self.poses)[0]).max()) for c in held}

    @cached_property
    def displaceable(self) -> Mapping[str, Weight]:
        """Placed bodies that loops displace as they close."""
        placed = [b.name for b in self.bodies if b.place is not None and b.name not in self.motions]
        return {name: Weight.of(self.rigid_models[name]) for name in placed}

    @cached_property
    def start_rates(self) -> StartRates:
        """Rates of bodies at the start, and what given ones contradict."""
        return start_rates(
            Standing(
                self,
                self.poses,
                self.points,
                self.rigid_models,
                self.motions,
                self.displaceable,
                self.constraints,
                self.coupled_lines,
            )
        )

    @property
    def rates(self) -> Mapping[str, Vector]:
        """Velocity of the origin and angular velocity (6,) of every body that moves at the start, world axes."""
        return self.start_rates.rates

    def effective_inertia(self, line: HingeLine) -> float:
        """Effective inertia (kg.m2) of a line as it latches, see `line_inertia`; SceneError where it has none."""
        known = self._line_inertias
        if line.name not in known:
            free = [k for k in self.lines_inward(line.outboard) if not k.held or k.name == line.name]
            has_free_base = self.base.free is not None
            try:
                known[line.name] = line_inertia(
                    free,
                    self._carrying,
                    self._carried_models,
                    self.deployed.poses,
                    self.points,
                    has_free_base,
                )
            except np.linalg.LinAlgError:
                raise SceneError(
                    [
                        f"{self.file}: hinge_line.{line.name}.latch.effective_inertia: cannot be computed from masses "
                        "and inertias of such different sizes; check these, or set it"
                    ]
                ) from None
        return known[line.name]

    @cached_property
    def deployed(self) -> Self:
        """The scene with all lines that move at their deployed angle."""
        return self.with_angles({k.name: k.deployed_angle for k in self.hinge_lines if not k.held})

    def way(self, shares: Sequence[float]) -> list[Mapping[str, StartPose]]:
        """Poses with all lines and motions at rising shares of their way; loops close from each to the next."""
        moving = [line for line in self.hinge_lines if not line.held]
        found: list[Mapping[str, StartPose]] = []
        for share in shares:
            angles = {k.name: k.initial_angle + share * (k.deployed_angle - k.initial_angle) for k in moving}
            stage = self.with_angles(angles)
            before = {name: found[-1][name] for name in self.displaceable} if found else {}
            start = {**stage.written_poses, **before, **stage._led(share)}
            held = [c._replace(distance=c.distance + share * c.travel) for c in stage._closing]
            found.append(close(held, start, self.displaceable) if held else start)
        return found

    def with_angles(self, angles: Mapping[str, float]) -> Self:
        """The scene with other start angles (rad) by line."""
        lines = tuple(
            line.model_copy(update={"start_angle": angles.get(line.name, line.start_angle)})
            for line in self.hinge_lines
        )
        found = replace(self, hinge_lines=lines)
        vars(found)["rigid_models"] = self.rigid_models  # which no angle changes
        return found

    def seated(self, connection: Connection) -> Instance:
        """The component of a connection, with its ports where bodies start, at rest."""
        return seated(connection, self.points, self.poses)

    @cached_property
    def _closing(self) -> list[Constraint]:
        """Constraints on these bodies."""
        return [c for c in self.constraints if acts(c, set(self.displaceable))]

    def _closed(self, shares: Sequence[float]) -> Closed:
        """Closed with motions at these shares of their travel, one after the other."""
        return closed(
            self.written_poses, self._closing, self.displaceable, [(s, self._led(s)) for s in shares]
        )

    def _led(self, share: float) -> Mapping[str, StartPose]:
        """Placed bodies that follow a motion, at a share of the farthest that their laws lead."""
        return {
            name: moved(
                self.written_poses[name],
                motion,
                *(share * farthest(law, self.header.until) for law in motion.laws),
            )
            for name, motion in self.motions.items()
            if name != self.base.name
        }

    @cached_property
    def _line_inertias(self) -> dict[str, float]:
        return {}

    @cached_property
    def _carrying(self) -> Mapping[str, frozenset[str]]:
        """Names of the lines that carry each body."""
        return {name: frozenset(line.name for line in self.lines_inward(name)) for name in self.points}

    @cached_property
    def _carried_models(self) -> Mapping[str, ModalData]:
        """Rigid models of all bodies that hinge lines carry, and of a free base."""
        placed = {body.name for body in self.bodies if body.place is not None}
        return {name: model for name, model in self.rigid_models.items() if name not in placed}
