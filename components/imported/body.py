"""An imported body as it is written down: files, units, points; what is in the files is read when it is needed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

from ..flexible.finite_elements import FiniteElementModel
from ..flexible.modal import ModalData
from . import agreement
from .agreement import NOTHING_STATED, Finding, Stated
from .data import FiniteElementData, checked, in_si, without_empty
from .hourglass import with_stiffness_everywhere
from .massless_dofs import with_mass_everywhere
from .model import finite_element_model
from .points import JoinedPoint, with_means, with_rigid_elements
from .reading import read


@dataclass(frozen=True)
class ImportedBody:
    """Finite elements from files, with points at their nodes.

    files: paths by what they hold: `file` for everything, or a matrix. digest: of their content. length, mass: of the
    model's units, in m and kg.
    """

    files: tuple[tuple[str, str], ...]
    digest: str
    attachment_points: tuple[tuple[str, int], ...] = ()
    nodes: tuple[tuple[str, int], ...] = ()
    rigid_elements: tuple[JoinedPoint, ...] = ()
    means: tuple[JoinedPoint, ...] = ()
    length: float = 1.0
    mass: float = 1.0
    stated: Stated = NOTHING_STATED

    def data(self) -> FiniteElementData:
        """What the files hold, in SI units and basic axes; ComponentError where it does not fit together."""
        return _loaded(self)[0]

    def model(self) -> FiniteElementModel:
        """Finite elements with these points; ComponentError where the agreement check fails."""
        return _loaded(self)[1]

    def modes(self, asked: int) -> int:
        """Fixed-interface modes to keep: as many as asked for, of a reduced model at most its own.

        One whose degrees of freedom are all at its attachment points has none.
        """
        data, model = _loaded(self)[:2]
        if data.ready:
            return min(asked, data.amplitudes)
        return asked if model.stiffness.shape[0] > 6 * len(model.attachment_dofs) else 0

    def agreement(self, reduced: ModalData | None = None) -> tuple[Finding, ...]:
        """The agreement check, with the frequencies of the reduced body where it is given."""
        _, model, findings = _loaded(self)
        if reduced is None:
            return findings
        return (*findings, *agreement.compare_frequencies(model, tuple(model.attachment_dofs), reduced))


@lru_cache(maxsize=8)
def _loaded(body: ImportedBody) -> tuple[FiniteElementData, FiniteElementModel, tuple[Finding, ...]]:
    data = in_si(checked(read({name: Path(path) for name, path in body.files})), body.length, body.mass)
    symmetry = agreement.check_symmetry(data)
    agreement.refuse(symmetry)
    data = replace(data, stiffness=agreement.symmetric(data.stiffness), mass=agreement.symmetric(data.mass))
    sections = [JoinedPoint(name, (node,)) for name, node in body.attachment_points if node in data.members]
    data, rigid = with_rigid_elements(data, [*body.rigid_elements, *sections])
    data, means = with_means(data, body.means)
    points = {**dict(body.attachment_points), **rigid, **means}
    data = with_mass_everywhere(with_stiffness_everywhere(without_empty(data, points.values())))
    model = finite_element_model(data, points, dict(body.nodes))
    findings = (*symmetry, *agreement.check_model(data, model, body.stated))
    agreement.refuse(findings)
    return data, model, findings
