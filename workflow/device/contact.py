"""Charge at zero volts and capacitance of a contact as functions of its force, from the exact solver.

The charge is that of the punch, or of a patch of an electrode below it where the case has a ``collector``.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
import xarray as xr
from numpy.polynomial.chebyshev import chebder, chebval

from approximation.arrays import Array
from approximation.chebyshev import coefficients, gauss_points
from solver import FactorError, Layer, Material, Stack, solve
from solver.body import Kind, around, kind_of
from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.materials import material_of
from solver.names import AIR, BODY
from solver.stack.electrodes import Electrode

_COUNT = 21  # Chebyshev points in the logarithm of the force: smooth curves are met to 1e-10
_CONSTANT = 1e-6  # power below which a capacitance does not depend on the force, as that of a flat punch
_SPAN = 1e4  # largest force over the smallest one that is solved

#: Solves cases: `solver.solve`, or a study's own solver with its body and materials.
Solver = Callable[[Mapping[str, Any]], xr.Dataset]


@dataclass(frozen=True, eq=False)
class ContactCurves:
    """Charge Q(P) at zero volts and capacitance C(P) of a contact, whose charge is Q(P) + C(P) V at a voltage V.

    Both are polynomials in log P through solved values, over four decades. Below them Q is proportional to P, and C is
    C0 + k P^s with value and slope continued; C0 is 0, or that of the air beside a contact that only touches.

    C is -Q over the open-circuit voltage: the charge is exact at zero volts and at zero charge. Between them it is
    exact where the voltage does not widen the contact, as on half-spaces; on films the capacitance of a fixed contact
    differs by about one percent. A patch has the capacitance of plates, without edges and other patches.
    """

    largest_force: float  # [N]
    curves: Array  # Chebyshev coefficients of Q/P [C/N] and of log C [F]; (2, point)
    plates: float | None = None  # capacitance of the patch that is read [F]; None: the punch is read
    air: bool = False  # whether air beside the contact carries charge

    @classmethod
    def from_case(
        cls,
        case: Mapping[str, Any],
        largest_force: float,
        *,
        length: float = 1.0,
        solved: Solver = solve,
        body: Stack | None = None,
    ) -> Self:
        """Solve the curves of a case; ``body`` has the electrode of a case that is read at a patch."""
        kind = _readable(case, body)
        forces = largest_force * _SPAN ** ((gauss_points(_COUNT) - 1) / 2)
        answer = solved({**case, kind.loads.force: forces / length})
        if body is not None and "collector" in case:
            charge = np.broadcast_to(answer["patch_charge_per_force"].values, forces.shape)
            size = float(case["patch_size"])
            area = size * length if kind.contact == "line" else np.pi * size**2 / 4
            plates = Electrode(body, int(case["collector"])).capacitance * area
            return cls(largest_force, coefficients(np.stack([charge, 0 * charge]), axis=1), plates)
        if "charge_per_force" not in answer:
            raise FactorError("electric: a punch that does not conduct has no charge to be read")
        charge = np.broadcast_to(answer["charge_per_force"].values, forces.shape)
        with np.errstate(all="ignore"):
            capacitance = -charge * forces / np.broadcast_to(answer["voltage"].values, forces.shape)
        if not (np.isfinite(capacitance) & (capacitance > 0)).all():
            raise FactorError("contact: its force makes no charge: nothing to be read")
        curves = coefficients(np.stack([charge, np.log(capacitance)]), axis=1)
        return cls(largest_force, curves, air=(case.get("surroundings") or around(case)) == AIR)

    def charge(self, force: Array) -> Array:
        """Return the charge at zero volts [C] at forces from 0 to the largest, (force,)."""
        return np.asarray(force * chebval(self._abscissae(force), self.curves[0]))

    def charge_slope(self, force: Array) -> Array:
        """Return the derivative of the charge at zero volts by the force [C/N], (force,)."""
        abscissae = self._abscissae(force)
        slope = chebval(abscissae, chebder(self.curves[0])) * 2 / np.log(_SPAN)
        return np.asarray(chebval(abscissae, self.curves[0]) + np.where(force > self._smallest_force, slope, 0.0))

    def capacitance(self, force: Array) -> Array:
        """Return the capacitance [F] at forces from 0 to the largest, (force,)."""
        if self.plates is not None:
            return np.full(np.shape(force), self.plates)
        limit, exponent = self._touching
        solved = np.exp(chebval(self._abscissae(force), self.curves[1]))
        share = np.minimum(force / self._smallest_force, 1) ** exponent
        return np.asarray(limit + (solved - limit) * share)

    @cached_property
    def _touching(self) -> tuple[float, float]:
        """Capacitance at zero force [F], and the power of the force by which it grows from there."""
        logs = chebval(np.array([-1, -0.5, 0]), self.curves[1])  # at the smallest force, and one and two decades above
        first, second, third = np.exp(logs)
        slope = float(chebval(-1.0, chebder(self.curves[1]))) * 2 / np.log(_SPAN) * first
        bend = third - 2 * second + first
        limit = first - (second - first) ** 2 / bend if self.air and bend > 0 else 0.0  # Aitken's extrapolation
        limit = float(np.clip(limit, 0.0, first))
        exponent = float(slope / (first - limit)) if first > limit else 0.0
        return limit, exponent if exponent > _CONSTANT else 0.0

    @property
    def _smallest_force(self) -> float:
        """The smallest force that was solved [N]."""
        return self.largest_force / _SPAN

    def _abscissae(self, force: Array) -> Array:
        """Return abscissae of the polynomials, in [-1, 1]; forces below the solved ones have that of the smallest."""
        return np.asarray(1 + 2 * np.log(np.maximum(force, self._smallest_force) / self.largest_force) / np.log(_SPAN))

    @property
    def roughness(self) -> float:
        """Last coefficients over the largest: an estimate of the polynomials' error."""
        size = np.abs(self.curves if self.plates is None else self.curves[:1])
        return float(np.max(size[:, -2:].max(axis=1) / size.max(axis=1)))


def film(
    case: Mapping[str, Any], materials: Mapping[str, Material], phases: Sequence[str]
) -> tuple[Stack | None, Material]:
    """Return the single film of a case between its electrodes, None without a film, and the body's material."""
    material = material_of(Cases(checked(dict(case)), materials, phases))
    if "thickness" not in case:
        return None, material
    if "collector" in case and "base_volume_fraction" in case:
        raise FactorError(
            f"base_volume_fraction: {float(case['base_volume_fraction']):g} of a film whose electrode a device reads; "
            "its capacitance is not given there: take a material or a volume_fraction alone"
        )
    return Stack([Layer(material, float(case["thickness"]))], electroded=case.get("electrode") == "top"), material


def _readable(case: Mapping[str, Any], body: Stack | None) -> Kind:
    """Return the kind of a case; FactorError unless its charge can be read."""
    kind = kind_of([*case, *([BODY] if body else [])], case.get("profile", "cylinder"))
    for name in (kind.loads.force, *kind.loads.charges):
        if name in case:
            raise FactorError(f"{name}: is not the case's: the history gives the force, and the circuit the charge")
    if "collector" in case:
        if "patch_size" not in case:
            raise FactorError("patch_size: missing; an electrode that is read as a whole has no end")
        if kind.contact == "point" and case.get("patch", "disc") == "strip":
            raise FactorError("patch: 'strip' below a point has no end; must be disc")
    elif kind.datum == "relative" or (kind.datum == "by_base" and case.get("interface_electric") == "bonded"):
        raise FactorError(
            "contact: its voltage depends on the datum, so that it has no capacitance; take a film on a grounded "
            "interface, or a point contact"
        )
    return kind
