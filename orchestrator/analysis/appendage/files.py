"""Files of a linear appendage: JSON, npz, MATLAB, Nastran's op4, and the flexible body of the simulator 42."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from components.contract.component import Vector
from components.imported.nastran import pyyeti

from ...scene import SceneError
from .model import Appendage


def write_appendage(found: Appendage, path: Path) -> Path:
    """Write an appendage in the format that the ending of the path stands for; SceneError where there is none."""
    writer = WRITERS.get(path.suffix.lower())
    if writer is None:
        raise SceneError([f"{path}: an appendage is written to a file that ends with {', '.join(WRITERS)}"])
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        writer(found, path)
    except OSError as error:
        raise SceneError([f"{path}: cannot be written: {error.strerror or error}"]) from None
    return path


def write_appendages(found: Sequence[Appendage], path: Path) -> list[Path]:
    """One file for each; of several, each has the name of its point behind that of the path."""
    if len(found) == 1:
        return [write_appendage(found[0], path)]
    return [write_appendage(one, path.with_stem(f"{path.stem}_{one.point}")) for one in found]


def _write_json(found: Appendage, path: Path) -> None:
    path.write_text(json.dumps(found.as_dict(), indent=1) + "\n", encoding="utf-8")


def _write_npz(found: Appendage, path: Path) -> None:
    arrays: dict[str, Any] = dict(found.arrays())
    np.savez(path, **arrays)


def _write_matlab(found: Appendage, path: Path) -> None:
    from scipy.io import savemat  # takes its time

    savemat(path, dict(found.arrays()), oned_as="column")


def craig_bampton(found: Appendage) -> dict[str, Vector]:
    """Mass, damping and stiffness (6 + k, 6 + k) of a body with one attachment grid, its six motions first."""
    modes = len(found.frequency)
    zero = np.zeros((6, 6))
    mass = np.block([[found.rigid_mass, found.participation.T], [found.participation, np.eye(modes)]])
    return {
        "maa": mass,
        "baa": _on_modes(zero, found.damping),
        "kaa": _on_modes(zero, np.diag(found.angular_frequency**2)),
    }


def _on_modes(attachment: Vector, modal: Vector) -> Vector:
    none = np.zeros((6, len(modal)))
    return np.block([[attachment, none], [none.T, modal]])


def _write_op4(found: Appendage, path: Path) -> None:
    pyyeti().op4.write(path, craig_bampton(found))


def _write_42(found: Appendage, path: Path) -> None:
    path.write_text(_text_of_42(found), encoding="utf-8")


_LINE_OF_42 = 78
"""Characters of a line that 42 reads."""
_ROUNDING = 1e-12
"""Of the largest element of a matrix."""


def _text_of_42(found: Appendage) -> str:
    """A flexible body of 42 (its file Flex_Simple.txt), whose reference point is the joint at the point of the base.

    Terms of second order in its modal coordinates are left out.
    """
    modes = range(len(found.frequency))
    about = f"{found.scene} about {found.point}; REFPT_JOINT"[:_LINE_OF_42]
    lines = [_heading("Flexible Body Inputs for 42"), about, _said(len(modes), "Number of Flex Modes")]
    lines += [_heading("Initial Modal States x, u"), *(_said("0.0 0.0", f"Mode {k}") for k in modes)]
    lines += [
        _heading("Joint Node Mode Shapes"),
        *_no_shapes(),
        _heading("Analysis Node Mode Shapes"),
        *_no_shapes(),
    ]
    for name, values in (
        ("Mass", np.eye(len(modes))),
        ("Stiffness", np.diag(found.angular_frequency**2)),
        ("Damping", found.damping),
    ):
        lines += _matrix_of_42(f"Non-zero {name} Matrix Elements", values)
    momenta = found.participation[:, :3], found.participation[:, 3:]
    for name, rows in zip(
        ("Linear Momentum Modal Integral, Pf", "Angular Momentum Modal Integral, Hf"), momenta, strict=True
    ):
        lines += [_heading(f"{name}, 3 x Nf")]
        lines += [_said(" ".join(f"{value:.9e}" for value in row), f"Mode {k}") for k, row in enumerate(rows)]
    for name in ("Linear Modal Integral, L, 3 x 3 x Nf", "Angular Modal Integral, N, 3 x 3 x Nf x Nf"):
        lines += [_heading(name), _said(0, "Number of non-zero elements")]
    return "\n".join(lines) + "\n"


def _heading(words: str) -> str:
    return f"********* {words} *********"


def _said(value: object, words: str) -> str:
    return f"{value}  ! {words}"


def _no_shapes() -> list[str]:
    lines = []
    for name in ("Translation Mode Shape (PSI)", "Rotation Mode Shape (THETA)"):
        lines += [_heading(f"Non-zero {name} Elements"), _said(0, "Number of non-zero elements")]
    return lines


def _matrix_of_42(words: str, values: Vector) -> list[str]:
    """Its diagonal, and what is more beside it than rounding."""
    told = np.abs(values) > _ROUNDING * np.abs(values).max(initial=0.0)
    np.fill_diagonal(told, True)
    rows = [_said(f"{j} {k} {values[j, k]:.12e}", "[Row] [Col] Value") for j, k in np.argwhere(told).tolist()]
    return [_heading(words), _said(len(rows), "Number of non-zero elements"), *rows]


WRITERS: Mapping[str, Callable[[Appendage, Path], None]] = {
    ".json": _write_json,
    ".npz": _write_npz,
    ".mat": _write_matlab,
    ".op4": _write_op4,
    ".txt": _write_42,
}
"""By the ending of a file; .txt is a flexible body of the simulator 42."""
