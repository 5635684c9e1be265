"""Base class of all bodies: names of fields, fields that need c12, and joining the outputs of groups of cases."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence, Set
from math import prod
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from approximation.arrays import Indices
from solver.arrays import Array, Scalar, joined
from solver.face.cases import Cases
from solver.face.electrodes import electroded
from solver.face.refusal import CaseError, FactorError
from solver.fields import FIELDS, INTERIOR, NEED_C12, POINT_FIELDS, SINGULAR
from solver.halfplane.interior import with_derived
from solver.halfplane.pressing import ContactError
from solver.material.constants import MaterialError


class Body(ABC):
    """Solved cases of one kind: arrays by the names of ``solver.names``, over the case axes, then other axes."""

    #: Whether fields may be NaN at some points, such as those in a rigid base.
    hollow: ClassVar[bool] = True
    #: Fields inside that need c12, and fields on the surface that are singular at the edges.
    _need_c12: ClassVar[tuple[str, ...]] = NEED_C12
    _singular: ClassVar[tuple[str, ...]] = SINGULAR

    def __init__(self, cases: Cases) -> None:
        self.cases = cases
        self.shape = tuple(cases.sizes.values())

    @abstractmethod
    def quantities(self) -> dict[str, Array]:
        """Quantities that are solved together and that every case has; (...)."""

    def requested(self, names: Set[str] | None) -> dict[str, Array]:
        """Quantities of these names (None: all), and others that cost nothing; (...)."""
        return self.quantities()

    @abstractmethod
    def peaks(self, requested: Set[str]) -> dict[str, Array]:
        """Requested quantities that need a search and that every case has; (...)."""

    @abstractmethod
    def curves(self, regions: Sequence[str]) -> dict[str, Array]:
        """Sizes and curves of regions (``solver.curves``) that every case has; (...) and (..., point)."""

    @np.errstate(all="ignore")  # here and below: values that are not finite are reported with the outputs
    def surface(self, positions: Array, *, regular: bool) -> dict[str, Array]:
        """Surface fields, and if ``regular`` the regular form of those singular at the edges; (..., position)."""
        values = self._surface(positions, regular)
        ordered = [name for field in {**FIELDS, **POINT_FIELDS} for name in (field, f"{field}_regular")]
        return {name: values[name] for name in ordered if name in values}

    @np.errstate(all="ignore")
    def interior(self, x: Array, y: Array, requested: Sequence[str] | None) -> dict[str, Array]:
        """Fields inside on a grid, for a point contact in a plane through the axis; (..., y, x)."""
        names = requested or [name for name in INTERIOR if name not in self._need_c12 or self._lacks_c12 is None]
        for name in names:
            if name in self._need_c12:
                self._require_c12(f"{name} needs")
        return with_derived(names, lambda linear: self._interior(x, y, linear))

    @abstractmethod
    def _surface(self, positions: Array, regular: bool) -> dict[str, Array]:
        """Surface fields like :meth:`surface`, in any order."""

    @abstractmethod
    def _interior(self, x: Array, y: Array, names: tuple[str, ...]) -> dict[str, Array]:
        """Fields inside that are linear in the tractions, and potentials; shaped like :meth:`interior`."""

    @property
    @abstractmethod
    def _lacks_c12(self) -> str | None:
        """Name of a material without c12, or None."""

    def _require_c12(self, what_needs: str) -> None:
        """Refuse a material without c12."""
        if self._lacks_c12 is not None:
            raise MaterialError(f"{self._lacks_c12}: c12: missing; {what_needs} it [Pa]")

    def _with_regular(self, values: dict[str, Array], positions: Array) -> dict[str, Array]:
        """Surface fields, and the singular ones times sqrt|1 - X^2|; (..., position) each."""
        root = np.sqrt(np.abs((1 - positions) * (1 + positions)))
        return values | {f"{name}_regular": values[name] * root for name in self._singular if name in values}

    def _refuse_electroded(self, what: str) -> None:
        """Refuse outputs that are not solved under an electrode on top."""
        if np.any(electroded(self.cases)):
            raise FactorError(f"electrode: 'top': {what} under it are not given; ask for quantities alone")

    def _flat(self, values: NDArray[Scalar], *axes: int) -> NDArray[Scalar]:
        """Values of all cases along one axis; (case, other axes)."""
        return np.broadcast_to(values, (*self.shape, *axes)).reshape(-1, *axes)

    @np.errstate(all="ignore")
    def _put_together(self, parts: Iterable[tuple[Indices, Mapping[str, Array]]]) -> dict[str, Array]:
        """Join outputs of indexed cases, as far as all cases have them; (...)."""
        try:
            solved = list(parts)
        except ContactError as error:
            raise CaseError(str(error)) from None
        outputs = joined(solved, prod(self.shape))
        return {name: values.reshape((*self.shape, *values.shape[1:])) for name, values in outputs.items()}
