"""Cases with air beside the contact: a film's as without, a half-plane's as a film bonded to its own material."""

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

_HALF_LENGTH = 10**0.25  # of half-planes over the thickness: the middle of a window


class FilmInAir(OnFilm):
    """Contact of cases of one kind of punch on films, with air beside it."""

    _outputs = Outputs(quantities, peaks, curves, fields, inside)

    def _medium(self, places: Indices) -> tuple[Array, ...]:
        """Relative permittivity of what fills the gaps of some cases; (place,)."""
        return (self._flat(self.cases.number("gap_permittivity"))[places],)


class HalfPlaneInAir(FilmInAir):
    """The same on half-planes.

    Its half-length is that of the closed form: a half-plane's pressure does not know what charges lie beside it.
    """

    def _made(self) -> Bodies:
        """Half-planes as films of their own material, as thick as puts all contacts into the middle of one window."""
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
