"""Cases of point contacts on half-spaces, all of them at once."""

from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, column, distinct_rows
from solver.face.materials import half_plane_of
from solver.face.point import OnPoints
from solver.face.punches import punch_of
from solver.halfplane.precision import warn_of_rounding
from solver.halfplane.surface import HalfPlane
from solver.line.windows import material_from
from solver.material.constants import UNITS
from solver.point.body import HalfSpace
from solver.point.contact import Friction, Pressed
from solver.point.friction import Rim, contact_coupling
from solver.point.inside import Inside, whole
from solver.point.profile import Shape
from solver.point.state import conducted


class OnHalfSpace(OnPoints):
    """Points on half-spaces.

    Warns
    -----
    PrecisionWarning
        Rounding costs digits.
    """

    def _pressed(self) -> list[tuple[Indices, Pressed]]:
        warn_of_rounding(self._half.distinct)
        return [
            (places, self._of(places, shape, coefficient))
            for places, shape, coefficient in self._by_exponent(self._every)
        ]

    def _apart(self) -> list[tuple[Indices, Pressed]]:
        _, which = distinct_rows(np.stack(self._constants, -1))
        return [
            (places[same_body], self._of(places[same_body], shape, coefficient[same_body]))
            for places, shape, coefficient in self._by_exponent(self._every)
            for number in np.unique(which[places])
            if (same_body := np.flatnonzero(which[places] == number)).size
        ]

    @property
    def _every(self) -> Indices:
        return np.arange(int(np.prod(self.shape)))

    @cached_property
    def _half(self) -> HalfPlane:
        return half_plane_of(self.cases)

    @cached_property
    def _constants(self) -> list[Array]:
        """Constants of the materials, infinite where unknown; (case,) each."""
        return [self._flat(np.nan_to_num(getattr(self._half.material, key), nan=np.inf)) for key in UNITS]

    @cached_property
    def _compliances(self) -> tuple[Array, Array, Array]:
        """N and k of the contacts in their units, and these; (case, 3, 3), (case, 3) and (case, 4)."""
        half, punch, conducts = self._half, punch_of(self.cases), self.cases.conducts
        units = half.scale[..., 1:]
        N = half.compliance + column(punch.compliance) * np.diag([1.0, 0.0, 0.0])
        N = conducted(N / (units[..., :, None] * units[..., None, :]), conducts)
        k = contact_coupling(
            half.friction_coupling / (half.scale[..., :1] * units), half.scale, punch.coupling, conducts
        )
        return self._flat(N, 3, 3), self._flat(k, 3), self._flat(half.scale, 4)

    def _of(self, places: Indices, shape: Shape, coefficient: Array) -> Pressed:
        """Some cases of one exponent."""
        N, k, units = self._compliances
        conducts = self._flat(self.cases.conducts, 2)
        friction = Friction(self._friction[places], k[places]) if "friction" in self.cases.values else None
        return Pressed(
            HalfSpace(N[places], shape),
            units[places],
            coefficient,
            *self._loads(places),
            conducts[places],
            friction=friction,
        )

    @property
    def _lacks_c12(self) -> str | None:
        material = self._half.material
        return material.name if np.any(np.isnan(material.c12)) else None

    @cached_property
    def _rims(self) -> Rim:
        rim = Rim.of(self._half)
        stiffness, shear, *compliances = map(self._flat, (rim.stiffness, rim.shear, rim.tangential, rim.transverse))
        return Rim(self._flat(rim.coupling, 3), stiffness, shear, self._flat(rim.share, 3), *compliances)

    def _rim(self, places: Indices) -> Rim | None:
        if self._lacks_c12 is not None:
            return None
        return self._rims.part(places)

    def _inside(self, places: Indices, pressed: Pressed) -> Inside:
        constants = [float(values[places[0]]) for values in self._constants]
        dielectric = 0.0  # the last of the constants: a half-space of metal, too, is one
        return whole(
            material_from((*(None if np.isinf(value) else value for value in constants), dielectric), "half-space")
        )
