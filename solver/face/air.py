"""Cases with air beside the contact, on films and on half-planes, which are films bonded to their own material."""

from collections.abc import Sequence, Set
from dataclasses import replace

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.body import HALF_PLANE_IN_AIR
from solver.face.film import OnFilm, Outputs
from solver.face.filmbodies import Bodies, films_of
from solver.face.halfplane import contact_of
from solver.gap.fields import body_curves, body_peaks, curves, fields, inside, peaks
from solver.gap.quantities import quantities
from solver.names import PEAKS

_HALF_LENGTH = 10**0.25  # over the thickness of the film that replaces a half-plane: the middle of a window


class FilmInAir(OnFilm):
    """Contact of cases of one kind of punch on films, with air beside it."""

    _outputs = Outputs(quantities, peaks, curves, fields, inside)

    def _medium(self, index: Indices) -> tuple[Array, ...]:
        """Relative permittivity in the gaps of the indexed cases; (case,)."""
        return (self._flat(self.cases.number("gap_permittivity"))[index],)


class HalfPlaneInAir(FilmInAir):
    """Contact of cases of one kind of punch on half-planes, with air beside it."""

    def _films_of_cases(self) -> Bodies:
        """Return films of the half-planes' materials, so thick that all contacts are in the middle of one window."""
        # the half-length is that of the closed form: charges beside the contact do not change a half-plane's pressure
        with np.errstate(all="ignore"):
            return replace(films_of(self.cases), thickness=contact_of(self.cases).half_width / _HALF_LENGTH)

    def quantities(self) -> dict[str, Array]:
        """Quantities of a half-plane in air that every case has; (...)."""
        return {name: value for name, value in super().quantities().items() if name in HALF_PLANE_IN_AIR.quantities}

    def peaks(self, requested: Set[str]) -> dict[str, Array]:
        """Requested quantities of ``solver.names.PEAKS``; (...)."""
        names = [name for name in PEAKS if name in requested]
        if names:
            self._require_c12(f"{names[0]} needs")
        return self._of_groups(body_peaks, requested)

    def curves(self, regions: Sequence[str]) -> dict[str, Array]:
        """Sizes and curves of the region ``body``; (...) and (..., point)."""
        self._require_c12("peak_von_mises needs")
        return self._of_groups(body_curves)
