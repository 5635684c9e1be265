"""Fields and potentials inside the half-plane (theory, sections 5 and 6), at points ((x - c)/h, y/h), y <= 0.

With ``Pi`` of :mod:`solver.halfplane.spectrum`, ``Z = A B^-1`` and the stress function phi, whose phi,x are the
tractions (sigma_xy, sigma_yy, D_y, B_y), tractions t on the surface have

    [u,x; phi,x] = Re{ [Z; I] i H_t(x + y Pi) },   H_t(z) = (1/pi) int t(s)/(s - z) ds,   [u,y; phi,y] = N [u,x; phi,x].

Every field is ``pressure_scale * U + sum_j charge_density_j * W_j``. The potentials relative to the datum L are
``Re{[Z; I] i F_t(x + y Pi)}`` with the antiderivative

    F_t(z) = -(1/pi) int t(s) log[(z - s) h / (i L)] ds,   F_t' = H_t,   F_t ~ -(1/pi) int t log[z h / (i L)] far away.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, ComplexArray, stack
from solver.fields import STRESSES
from solver.halfplane.contact import Contact
from solver.halfplane.spectrum import spectrum
from solver.halfplane.surface import HalfPlane

#: Functions of S, of D and of the charges at points z.
Functions = Callable[[ComplexArray], tuple[ComplexArray, ComplexArray, ComplexArray]]

#: Fields that are linear in the tractions, in the order of the rows of :func:`field_rows`.
LINEAR = (
    "stress_xx", "stress_yy", "stress_xy", "stress_zz",
    "electric_displacement_x", "electric_displacement_y", "magnetic_induction_x", "magnetic_induction_y",
    "electric_field_x", "electric_field_y", "magnetic_field_x", "magnetic_field_y",
    "strain_xx", "strain_yy", "strain_xy",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class InteriorParts:
    """Fields per pressure scale and per charge density, each in its smallest shape."""

    of_load: Array  # U; (..., field, point)
    of_charges: tuple[Array, Array]  # W_0 (electric) and W_1 (magnetic); each (..., field, point)

    def whole(self, contact: Contact) -> Array:
        """Fields of the contact, SI; (..., field, point)."""
        scale, e = contact.pressure_scale[..., None, None], contact.charge_density[..., None, None, :]
        return np.asarray(scale * self.of_load + e[..., 0] * self.of_charges[0] + e[..., 1] * self.of_charges[1])


def interior_parts(contact: Contact, x: Array, y: Array, fields: tuple[str, ...]) -> InteriorParts:
    """Parts of the named fields of ``LINEAR`` at points (x, y); (point,) each."""
    return parts_of(contact, x, y, fields, lambda z: transforms(contact, z))


def transforms(contact: Contact, z: ComplexArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """H[S], H[D] and -H[1/sqrt(1 - X^2)] at z (..., point), on or above the real axis; (..., point) each."""
    root: ComplexArray = np.sqrt(z - 1) * np.sqrt(z + 1)
    HS, HD_root = contact.shape.transforms(z, root, contact.pressing.slope)
    inverse = 1 / root
    return HS, HD_root * inverse, inverse


def parts_of(contact: Contact, x: Array, y: Array, fields: tuple[str, ...], functions: Functions) -> InteriorParts:
    """Parts as of :func:`interior_parts`, with ``functions`` of z in place of :func:`transforms`."""
    half, sliding = contact.halfplane, contact.sliding
    nodes, weights = spectrum(half)
    rows = field_rows(half)[..., [LINEAR.index(name) for name in fields], :]
    blocks = np.concatenate([half.surface_impedance, np.broadcast_to(np.eye(4), half.surface_impedance.shape)], -2)
    # fields per traction vector at the nodes; (..., node, field, 4)
    responses = 1j * (rows @ blocks)[..., None, :, :] @ (weights * half.scale[..., None, None, :])

    zero, unit, eta, r = np.zeros(()), np.ones(()), contact.friction, sliding.screening
    d = eta[..., None] * sliding.friction_screening
    pressed = _applied(responses, stack(eta, unit, -r[..., 0], -r[..., 1]))
    followed = _applied(responses, stack(zero, zero, d[..., 0], d[..., 1]))
    charged = [_applied(responses, np.eye(4)[2 + j]) for j in (0, 1)]

    load, electric, magnetic = np.zeros(()), np.zeros(()), np.zeros(())
    for j in range(nodes.shape[-1]):
        S, D, charge = functions(_conjugate_points(x, y, nodes[..., j]))
        load = load + _real(pressed[..., j, :], S) + _real(followed[..., j, :], D)
        electric = electric - _real(charged[0][..., j, :], charge)
        magnetic = magnetic - _real(charged[1][..., j, :], charge)
    return InteriorParts(load, (electric, magnetic))


def _applied(responses: ComplexArray, traction: Array) -> ComplexArray:
    """Fields of one traction vector (..., 4), conjugated like the points; (..., node, field)."""
    return np.asarray(np.conj(responses @ traction[..., None, :, None])[..., 0])


def _conjugate_points(x: Array, y: Array, p: ComplexArray) -> ComplexArray:
    """Conjugates of x + p y, on or above the real axis, with +0 as imaginary part on the surface; (..., point)."""
    z = np.empty(np.broadcast_shapes(x.shape, y.shape, (*p.shape, 1)), np.complex128)
    z.real = x + p.real[..., None] * y
    z.imag = np.abs(p.imag[..., None] * y)
    return z


def _real(coefficients: ComplexArray, values: ComplexArray) -> Array:
    """Re(coefficients (..., field) * values (..., point)); (..., field, point)."""
    c, v = coefficients[..., :, None], values[..., None, :]
    return np.asarray(c.real * v.real - c.imag * v.imag)


def with_derived(names: Sequence[str], linear: Callable[[tuple[str, ...]], Mapping[str, Array]]) -> dict[str, Array]:
    """Fields by name; ``von_mises`` and ``principal_tension`` are computed from the four stresses."""
    needed = [*(name for name in names if name not in _DERIVED), *(STRESSES if _DERIVED.keys() & set(names) else ())]
    fields = linear(tuple(dict.fromkeys(needed)))
    stresses = [fields.get(name) for name in STRESSES]
    return {name: _DERIVED[name](*stresses) if name in _DERIVED else fields[name] for name in names}


def field_rows(half: HalfPlane) -> Array:
    """Matrix from the scaled [u,x; phi,x] to the fields of ``LINEAR``, SI; (..., field, 8)."""
    m, N = half.material, half.stroh_matrix
    units = np.concatenate([half.scale, 1 / half.scale], -1)
    along = units[..., None] * np.eye(8)  # [u,x; phi,x]
    down = units[..., None] * N  # [u,y; phi,y]
    Q, R, _ = m.generalised_stiffness()
    first = Q @ along[..., :4, :] + R @ down[..., :4, :]  # (sigma_xx, sigma_xy, D_x, B_x), at any speed
    couplings = ((m.c12, along, 0), (m.c13, down, 1), (m.e31, down, 2), (m.f31, down, 3))
    shape = np.broadcast_shapes(first.shape[:-2], m.shape)
    rows = [
        first[..., 0, :], along[..., 5, :], along[..., 4, :], sum(c[..., None] * v[..., k, :] for c, v, k in couplings),
        first[..., 2, :], along[..., 6, :], first[..., 3, :], along[..., 7, :],
        -along[..., 2, :], -down[..., 2, :], -along[..., 3, :], -down[..., 3, :],
        along[..., 0, :], down[..., 1, :], (down[..., 0, :] + along[..., 1, :]) / 2,
    ]  # fmt: skip
    return np.stack([np.broadcast_to(row, (*shape, 8)) for row in rows], -2)


def von_mises(xx: Array, yy: Array, xy: Array, zz: Array) -> Array:
    """Von Mises stress of plane strain [Pa]."""
    return np.asarray(np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * xy**2))


def principal_tension(xx: Array, yy: Array, xy: Array, zz: Array) -> Array:
    """Largest of the three principal stresses [Pa]."""
    return np.asarray(np.maximum((xx + yy) / 2 + np.hypot((xx - yy) / 2, xy), zz))


_DERIVED: dict[str, Callable[..., Array]] = {"von_mises": von_mises, "principal_tension": principal_tension}


#: Components of the field whose negative integral each potential is.
POTENTIALS = {"electric_potential": "electric_field_x", "magnetic_potential": "magnetic_field_x"}

_FAR = 2.0  # |z| from which F is integrated along the ray from infinity: the edges are at 1
_START: ComplexArray = np.array([2j])  # of the paths to points nearer than that
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
    """F of S, of D and of -1/sqrt(1 - X^2) at points z (..., point), Im z >= 0; (..., point) each."""
    far = np.abs(z) >= _FAR
    far_S, far_D = _from_infinity(contact, np.where(far, z, _START))
    start_S, start_D = _from_infinity(contact, _START)
    path = np.where(far, 0.0, z - _START)
    line: ComplexArray = (_START + path[..., None] * LINE).reshape(*path.shape[:-1], -1)
    near_S, near_D = (
        path * np.sum(values.reshape(*values.shape[:-1], -1, LINE.size) * LINE_WEIGHTS, -1)
        for values in transforms(contact, line)[:2]
    )
    S: ComplexArray = np.where(far, far_S, start_S + near_S)
    D: ComplexArray = np.where(far, far_D, start_D + near_D)
    root: ComplexArray = np.sqrt(z - 1) * np.sqrt(z + 1)
    logarithm = ratio[..., None]
    charge: ComplexArray = np.log((z + root) / 2j) + 0j + logarithm
    return S - contact.shape.total[..., None] / np.pi * logarithm, D, charge


def _from_infinity(contact: Contact, z: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """F of S, with h = L, and of D at points |z| >= 2 (..., point), by Gauss's rule along the ray from infinity."""
    ray = (z[..., None] / _RAY).reshape(*z.shape[:-1], -1)
    HS, HD, _ = transforms(contact, ray)
    total = contact.shape.total[..., None] / np.pi
    remainder = HS + total / ray
    steps = -z[..., None] / _RAY**2 * _RAY_WEIGHTS
    S, D = (np.sum(steps * values.reshape(*values.shape[:-1], *steps.shape[-2:]), -1) for values in (remainder, HD))
    return S - total * np.log(z / 1j), D
