"""Normal modes of a scene in a configuration: frequencies, damping, effective masses, the bodies that move.

About static equilibrium (lines that are not latched are held for it, then free), with preload and geometric
stiffness of the connections; without friction. Modal damping is the diagonal of the modal damping matrix; modes that
it does not tell enough of are marked. On a base that turns by a law, all is about the steady spin at the rate that the
law begins with, in axes that turn along.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from math import isnan
from typing import Any, Literal, NamedTuple

import numpy as np

from components.contract.component import Vector

from ..assembly.statics.configuration import Configuration, scene_model
from ..assembly.statics.configuration import Named as Named
from ..assembly.statics.linear_model import (
    LinearModel,
    NormalModes,
    coupled_by_damping,
    damping_shares,
    effective_masses,
    kinetic_shares,
    modal_damping,
    normal_modes,
    spinning_modes,
)
from ..assembly.statics.steady_spin import spin_at_start
from ..records import short_repr
from ..scene import PlacedScene, SceneError
from ..scene.damping import StructuralDamping
from .vibration import DIRECTIONS

_SMALLEST_SHARE = 1e-3
_LOADED = 1e-3
"""N or N.m out of balance, and Hz, up to which nothing is compared."""
_COMPARED, _OFF = 6, 0.01
"""Modes as posed that are compared with those in equilibrium, and by how much one of them is off where it is told."""
_CLOSE, _CLOSE_DAMPED = 0.1, 5.0
"""Relative distance of closely spaced modes, and in damping ratios (US NRC Regulatory Guide 1.92)."""
_COUPLED = 0.1
"""Part of its damping that a mode may lose to others before that is told."""


class Mode(NamedTuple):
    """One mode that is no free motion."""

    number: int
    """from 1, free motions counted before"""
    frequency: float
    """Hz; negative: the growth rate of an unstable motion over 2 pi"""
    damping_ratio: float
    effective_mass_fractions: tuple[float, ...]
    """in `DIRECTIONS` of the base, rotations about its reference point; not a number on a base that turns"""
    body: str
    """with the largest share in the kinetic energy"""
    share: float
    damping_shares: Mapping[str, float]
    """of what damps it, by body and connection, the largest first"""
    coupled_by_damping: bool
    """whether what damps it moves other modes so much that they leave it less damping than its ratio says"""

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "mode": self.number,
            "frequency_hz": self.frequency,
            "damping_ratio": None if isnan(self.damping_ratio) else self.damping_ratio,
            "damping_share": dict(self.damping_shares),
            "coupled_by_damping": self.coupled_by_damping,
            "effective_mass_fraction": {
                direction: None if isnan(fraction) else fraction
                for direction, fraction in zip(DIRECTIONS, self.effective_mass_fractions, strict=True)
            },
            "body": self.body,
            "kinetic_energy_share": self.share,
        }


@short_repr
@dataclass(frozen=True)
class Modes:
    """Normal modes of a scene in a configuration.

    base: "fixed" to ground, "free" to swing with the wing, whose modes have no effective masses, or free and "held".
    listed: those beyond the free motions, of which there are `free_motions`. unbalanced: force (N) and torque (N.m)
    that nothing balances there.
    """

    scene: str
    configuration: Configuration
    base: Literal["fixed", "held", "free"]
    listed: tuple[Mode, ...]
    free_motions: int
    unbalanced: tuple[float, float]
    structural_damping: StructuralDamping | None
    model: LinearModel = field(repr=False)
    shapes: NormalModes = field(repr=False)

    @property
    def frequencies(self) -> Vector:
        """Frequencies (Hz) of the listed modes, shape (M,); negative where the motion is unstable, see `Mode`."""
        return np.array([mode.frequency for mode in self.listed])

    @property
    def closely_spaced(self) -> list[tuple[Mode, Mode]]:
        """Neighbours whose responses combine in phase or beat: within 10 %, or five damping ratios above 2 %.

        The definition of US NRC Regulatory Guide 1.92, revision 2, relative to the lower frequency.
        """
        pairs = zip(self.listed, self.listed[1:], strict=False)
        return [
            (low, high) for low, high in pairs if 0.0 < high.frequency - low.frequency < _spacing(low, high)
        ]

    @property
    def turns(self) -> bool:
        """Whether they are those of a steady spin, where modes have no effective masses."""
        return self.model.mechanism.spin is not None

    @property
    def damping_ratios(self) -> Vector:
        """Fractions of critical damping of the listed modes, shape (M,)."""
        return np.array([mode.damping_ratio for mode in self.listed])

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        structural = self.structural_damping
        return {
            "scene": self.scene,
            **self.configuration.as_dict(),
            "base": self.base,
            "unbalanced_force_n": self.unbalanced[0],
            "unbalanced_torque_nm": self.unbalanced[1],
            "free_motions": self.free_motions,
            "structural_damping": None
            if structural is None
            else {"ratio": structural.ratio, "reference_frequency_hz": structural.reference_frequency},
            "modes": [mode.as_dict() for mode in self.listed],
            "closely_spaced": [[low.number, high.number] for low, high in self.closely_spaced],
        }


def _spacing(low: Mode, high: Mode) -> float:
    """Distance (Hz) up to which two modes are closely spaced; damping that is not a number counts as none."""
    damping = max((one.damping_ratio for one in (low, high) if not isnan(one.damping_ratio)), default=0.0)
    return low.frequency * max(_CLOSE, _CLOSE_DAMPED * damping)


def find_modes(
    scene: PlacedScene,
    rigid: Collection[str],
    flexible: Collection[str],
    target: Configuration,
    as_posed: bool,
    count: int,
    held: bool = False,
) -> Modes:
    """The first modes of a scene in a configuration, loaded or as posed; held: a free base does not move."""
    spin = spin_at_start(scene)
    model = scene_model(scene, rigid, flexible, target, as_posed, spin)
    base: Literal["fixed", "held", "free"] = "fixed" if model.is_grounded else "held" if held else "free"
    held_rows = model.base_constraints if base == "held" else None
    shapes = spinning_modes(model) if spin else normal_modes(model, held_rows)
    return Modes(
        scene.header.name, target, base, tuple(mode_table(model, shapes, count)), int(shapes.is_free.sum()),
        model.unbalanced, scene.structural_damping, model, shapes,
    )  # fmt: skip


def posing_sentence(
    scene: PlacedScene,
    rigid: Collection[str],
    flexible: Collection[str],
    target: Configuration,
    unbalanced: tuple[float, float],
) -> str:
    """Where frequencies as posed, with this (N, N.m) out of balance, are not those in equilibrium; empty elsewhere."""
    if max(unbalanced) <= _LOADED:
        return ""
    try:
        both = [find_modes(scene, rigid, flexible, target, as_posed, _COMPARED) for as_posed in (True, False)]
    except SceneError:
        return ""
    said = (
        f"{scene.header.name}: as posed, {unbalanced[0]:.3g} N and {unbalanced[1]:.3g} N.m of cables, motors, "
        "gravity or spin are not balanced by joints and latches. "
    )
    free = [found.free_motions for found in both]
    if free[0] != free[1]:
        return (
            f"{said}There are {free[0]} rigid-body modes, and {free[1]} in equilibrium (without --as-posed)."
        )
    posed, settled = (found.frequencies for found in both)
    count = min(len(posed), len(settled))
    off = np.abs(posed[:count] - settled[:count]) / np.maximum(np.abs(settled[:count]), _LOADED)
    if off.max(initial=0.0) <= _OFF:
        return ""
    k = int(np.argmax(off))
    return f"{said}A frequency is {posed[k]:.4g} Hz, and {settled[k]:.4g} Hz in equilibrium (without --as-posed)."


def mode_table(model: LinearModel, modes: NormalModes, count: int) -> list[Mode]:
    """The first modes beyond the free motions; an unstable one comes first."""
    damping = modal_damping(model, modes)
    effective, total = effective_masses(model, modes)
    shares, losses = kinetic_shares(model, modes), damping_shares(model, modes)
    coupled = coupled_by_damping(model, modes) > _COUPLED
    found: list[Mode] = []
    for k, frequency in enumerate(modes.frequencies.tolist()):
        if modes.is_free[k] or len(found) == count:
            continue
        body = max(shares, key=lambda name: float(shares[name][k]))
        fractions = tuple((effective[:, k] / total).tolist())
        share, damped_by = float(shares[body][k]), _largest({name: float(s[k]) for name, s in losses.items()})
        found.append(
            Mode(k + 1, frequency, float(damping[k]), fractions, body, share, damped_by, bool(coupled[k]))
        )
    return found


def _largest(shares: Mapping[str, float]) -> dict[str, float]:
    """Shares of a thousandth and more, in their order."""
    ordered = sorted(shares.items(), key=lambda item: -item[1])
    return {name: share for name, share in ordered if share >= _SMALLEST_SHARE}
