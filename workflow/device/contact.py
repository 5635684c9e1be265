"""What a contact gives to a circuit by its force: charge at zero volts, and capacitance, from the exact solver.

The charge is that of the punch, or of a patch of an electrode below it where the case has a ``collector``.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import xarray as xr

from approximation.arrays import Array
from approximation.chebyshev import coefficients, gauss_points, polynomials, slopes
from solver import FactorError, Layer, Material, Stack, solve
from solver.body import Kind, kind_of
from solver.names import BODY
from solver.stack.electrodes import Electrode

_COUNT = 33  # points in the logarithm of the force: 1e-11 of smooth curves
_SPAN = 1e4  # from the least force of the curves to the largest


@dataclass(frozen=True, eq=False)
class Contact:
    """Charge Q(P) at zero volts and capacitance C(P) of a contact: its charge is Q(P) + C(P) V at a voltage V.

    Both are polynomials in log P through the solver's values at Chebyshev points, over four decades. Below them both go
    with P.

    C is what takes the charge Q, at P, from zero volts to the open circuit: -Q over the open-circuit voltage. So the
    charge is exact at zero volts and at zero charge; between, it is so where the contact does not widen by the voltage,
    as on half-spaces. On films the capacitance of a contact held fixed differs from it by about one percent. That of a
    patch is that of plates, whatever presses: its edges, and other patches, are left out.
    """

    most: float  # The largest force [N]
    curves: Array  # Coefficients of Q/P [C/N] and of log C [F]; (2, point)
    plates: float | None = None  # Capacitance of the patch that is read [F]; None: the punch is read

    @classmethod
    def of(
        cls,
        case: Mapping[str, Any],
        most: float,
        *,
        length: float = 1.0,
        materials: Mapping[str, Material] | None = None,
        solved: Callable[[dict[str, Any]], xr.Dataset] | None = None,
        body: Stack | None = None,
    ) -> Self:
        """Curves of a case from the exact solver."""
        forces = most * _SPAN ** ((gauss_points(_COUNT) - 1) / 2)
        charge, capacitance = response(case, forces, length=length, materials=materials, solved=solved, body=body)
        plates = float(capacitance[0]) if body is not None and "collector" in case else None
        log = np.log(capacitance) if plates is None else 0 * charge
        return cls(most, coefficients(np.stack([charge, log]), axis=1), plates)

    def at(self, force: Array) -> tuple[Array, Array]:
        """Charge at zero volts [C] and capacitance [F] at forces from 0 to the largest [N], (force,): (force,) each."""
        charge, capacitance = self.curves @ polynomials(self._places(force), _COUNT)
        if self.plates is not None:
            return charge * force, np.full_like(charge, self.plates)
        return charge * force, np.exp(capacitance) * np.minimum(force / self._least, 1)

    def rates(self, force: Array) -> tuple[Array, Array]:
        """Derivatives of both by the force [C/N, F/N] at forces as of :meth:`at`; (force,) each."""
        places, within = self._places(force), force > self._least
        T = polynomials(places, _COUNT)
        charge, capacitance = self.curves @ T
        charge_slope, slope = np.where(within, self.curves @ slopes(places, T) * 2 / np.log(_SPAN), 0.0)
        if self.plates is not None:
            return charge + charge_slope, np.zeros_like(charge)
        reached = np.maximum(force, self._least)
        return charge + charge_slope, np.exp(capacitance) / reached * np.where(within, slope, 1.0)

    @property
    def _least(self) -> float:
        """The least force of the curves [N]."""
        return self.most / _SPAN

    def _places(self, force: Array) -> Array:
        """Where forces are on the interval of the polynomials."""
        return np.asarray(1 + 2 * np.log(np.maximum(force, self._least) / self.most) / np.log(_SPAN))

    @property
    def roughness(self) -> float:
        """Last of the coefficients over the largest: how far the polynomials are from having met the curves."""
        size = np.abs(self.curves if self.plates is None else self.curves[:1])
        return float(np.max(size[:, -2:].max(axis=1) / size.max(axis=1)))


def response(
    case: Mapping[str, Any],
    forces: Array,
    *,
    length: float = 1.0,
    materials: Mapping[str, Material] | None = None,
    solved: Callable[[dict[str, Any]], xr.Dataset] | None = None,
    body: Stack | None = None,
) -> tuple[Array, Array]:
    """Charge per force at zero volts [C/N] and capacitance [F] of a case at some forces; (force,) each.

    forces: (force,).
    """
    kind = _readable(case, body)
    pressed = {**case, kind.loads.force: forces / length}
    answer = solved(pressed) if solved else solve(pressed, materials=materials or {})
    if body is not None and "collector" in case:
        charge = np.broadcast_to(answer["patch_charge_per_force"].values, forces.shape)
        size = float(case["patch_size"])
        area = size * length if kind.contact == "line" else np.pi * size**2 / 4
        plates = Electrode(body, int(case["collector"])).capacitance * area
        return charge, np.full(forces.shape, plates)
    if "charge_per_force" not in answer:
        raise FactorError("electric: a punch that does not conduct has no charge to be read")
    charge = np.broadcast_to(answer["charge_per_force"].values, forces.shape)
    with np.errstate(all="ignore"):
        capacitance = -charge * forces / np.broadcast_to(answer["voltage"].values, forces.shape)
    if not (np.isfinite(capacitance) & (capacitance > 0)).all():
        raise FactorError("contact: its force makes no charge: nothing to be read")
    return charge, capacitance


def film(case: Mapping[str, Any], material: Material) -> Stack:
    """What lies between the electrodes of a case on a single film, whatever its base."""
    if "collector" in case and "base_volume_fraction" in case:
        raise FactorError(
            f"base_volume_fraction: {float(case['base_volume_fraction']):g} of a film whose electrode a device reads; "
            "its capacitance is not given there: take a material or a volume_fraction alone"
        )
    return Stack([Layer(material, float(case["thickness"]))], electroded=case.get("electrode") == "top")


def _readable(case: Mapping[str, Any], body: Stack | None) -> Kind:
    """The kind of a case whose charge can be read."""
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
