"""Electric and magnetic potentials inside the half-plane, relative to the datum (theory sections 5 and 6).

The potentials are ``Re{[Z; I] i F(x + y Pi)}`` where F is the antiderivative of the transforms of
:mod:`solver.halfplane.interior` that the logarithmic kernel asks for: with the reference length L, at the conjugate
points z,

    F_t(z) = -(1/pi) int t(s) log[(z - s) h / (i L)] ds,   F_t' = H_t,   F_t ~ -(1/pi) int t log[z h / (i L)] far away.

The charges' own F is closed. That of the pressure is integrated: far from the edges along the ray from infinity, where
Gauss's rule converges at once, and near them from a point on that ray by the double exponential rule, which no edge
troubles. On the contact of a conducting punch the potentials are those of
:mod:`solver.halfplane.quantities`, found otherwise.
"""

import numpy as np

from solver.arrays import Array, ComplexArray
from solver.halfplane.contact import Contact
from solver.halfplane.interior import parts_of, transforms

#: Components of the field whose negative integral each potential is.
POTENTIALS = {"electric_potential": "electric_field_x", "magnetic_potential": "magnetic_field_x"}

_FAR = 2.0  # |z| from which the ray is used: the edges are at 1
_START: ComplexArray = np.array([2j])
_RAY, _RAY_WEIGHTS = ((a + b) / 2 for a, b in zip(np.polynomial.legendre.leggauss(32), (1.0, 0.0), strict=True))
_STEP = 0.08
_U: Array = np.asarray(_STEP * np.arange(-41, 42), dtype=np.float64)
#: Nodes and weights of a double exponential rule from 0 to 1, which is dense at both ends.
LINE: Array = np.asarray(1 / (1 + np.exp(-np.pi * np.sinh(_U))), dtype=np.float64)
LINE_WEIGHTS: Array = np.asarray(_STEP * np.pi * np.cosh(_U) * LINE / (1 + np.exp(np.pi * np.sinh(_U))))


def potentials(contact: Contact, x: Array, y: Array, datum: Array) -> Array:
    """Electric [V] and magnetic [A] potential at points ((x - c)/h, y/h), y <= 0; (..., 2, point)."""
    ratio = np.log(contact.half_width / datum)
    parts = parts_of(contact, x, y, tuple(POTENTIALS.values()), lambda z: _antiderivatives(contact, z, ratio))
    return -contact.half_width[..., None, None] * parts.whole(contact)


def _antiderivatives(
    contact: Contact, z: ComplexArray, ratio: Array
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """F of S, of D and of -1/sqrt(1 - X^2), at points z (..., point) above the real axis or on it."""
    far = np.abs(z) >= _FAR
    far_S, far_D = _from_infinity(contact, np.where(far, z, _START))
    start_S, start_D = _from_infinity(contact, _START)
    path = np.where(far, 0.0, z - _START)
    line: ComplexArray = (_START + path[..., None] * LINE).reshape(*path.shape[:-1], -1)
    near_S, near_D = (
        path * np.sum(values.reshape(*values.shape[:-1], -1, LINE.size) * LINE_WEIGHTS, -1)
        for values in transforms(contact, line)[:2]
    )
    of_S: ComplexArray = np.where(far, far_S, start_S + near_S)
    of_D: ComplexArray = np.where(far, far_D, start_D + near_D)
    root: ComplexArray = np.sqrt(z - 1) * np.sqrt(z + 1)
    logarithm = ratio[..., None]
    of_charge: ComplexArray = np.log((z + root) / 2j) + 0j + logarithm
    return of_S - contact.shape.total[..., None] / np.pi * logarithm, of_D, of_charge


def _from_infinity(contact: Contact, z: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """F of S, with h = L, and of D at points z (..., point) off the contact's disk, by the ray from infinity."""
    ray = (z[..., None] / _RAY).reshape(*z.shape[:-1], -1)
    HS, HD, _ = transforms(contact, ray)
    total = contact.shape.total[..., None] / np.pi
    remainder = HS + total / ray
    steps = -z[..., None] / _RAY**2 * _RAY_WEIGHTS
    of_S, of_D = (
        np.sum(steps * values.reshape(*values.shape[:-1], *steps.shape[-2:]), -1) for values in (remainder, HD)
    )
    return of_S - total * np.log(z / 1j), of_D
