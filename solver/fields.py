"""Surface fields on both sides of the contact (theory section 5), at dimensionless positions X = (x - c)/h.

Every field times sqrt|1 - X^2| is ``pressure_scale * U + sum_j charge_density_j * W_j``, where U depends on material,
friction and position only and W on material and side only: the large shapes see one product and one sum.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import exprel

from solver.arrays import Array
from solver.contact import Contact
from solver.special import atanh_minus, exprel2, exprel3


@dataclass(frozen=True, eq=False)
class SurfaceFields:
    """Fields along the surface, each (..., position) in the smallest shape; [Pa], [C/m2] and [T].

    ``*_regular`` is the field times sqrt|1 - X^2|, which is finite at the edges.
    """

    contact_pressure: Array
    shear_traction: Array
    electric_displacement_y_regular: Array
    magnetic_induction_y_regular: Array
    stress_xx_regular: Array
    electric_displacement_x_regular: Array
    magnetic_induction_x_regular: Array
    root: Array

    def singular(self, name: str) -> Array:
        """The field itself from its regular form."""
        return np.asarray(getattr(self, f"{name}_regular") / self.root)


def surface_fields(contact: Contact, positions: Array) -> SurfaceFields:
    """Fields of every case at every position.

    Parameters
    ----------
    contact
        The solved contact, case axes (...).
    positions
        X, shape (position,), finite, never exactly +-1.
    """
    X = positions
    inside = np.abs(X) < 1
    root = np.sqrt(np.abs((1 - X) * (1 + X)))
    X_in, X_out = np.where(inside, X, 0.0), np.where(inside, 2.0, X)

    half = contact.halfplane
    delta, rho, tan = (v[..., None] for v in (contact.delta, contact.delta_over_tan, contact.tan_theta))
    eta, scale = contact.friction[..., None], contact.pressure_scale[..., None]
    d, r, e, k = (
        _components(v)
        for v in (contact.friction_screening, contact.screening, contact.charge_density, half.friction_coupling)
    )

    shape = np.where(inside, root * np.exp(-2 * delta * np.arctanh(X_in)), 0.0) * contact.cos_theta[..., None]
    bracket = eta * friction_bracket(delta, rho, tan, contact.log_cos_over_tan[..., None], X_in)
    follow = [d[j] * bracket + r[j] * shape * root for j in (0, 1)]  # U of D_y, B_y
    flux_y = [np.where(inside, scale * follow[j] + e[j], 0.0) for j in (0, 1)]

    # H[sigma_yy] / pressure_scale; du_x/dx = -k.(sigma_yy, D_y, B_y) + (L^-1)_xx eta H[sigma_yy]
    hilbert = np.where(inside, tan * shape + X_in - 2 * delta, -_stress_transform(delta, X_out))
    stiffness = half.in_plane_stiffness[..., None]
    direct = [share - stiffness * k_j for share, k_j in zip(_components(half.in_plane_share), k, strict=True)]
    stretch = stiffness * half.tangential_compliance[..., None] * eta * hilbert - direct[0] * shape
    follow_xx = stretch * root + np.where(inside, direct[1] * follow[0] + direct[2] * follow[1], 0.0)
    stress_xx = scale * follow_xx + np.where(inside, direct[1] * e[0] + direct[2] * e[1], 0.0)

    # d(phi, psi)/dx vanishes under the conducting punch; outside it is N H[t], where M d = kq and M r = n
    M = [_components(half.compliance[..., j, 1:]) for j in (1, 2)]
    sign = np.sign(X_out)
    away = eta * _friction_bracket_outside(delta, rho, X_out)
    gradient = [sign * (scale * k[1 + j] * away - M[j][0] * e[0] - M[j][1] * e[1]) for j in (0, 1)]
    permittivity = [_components(half.transverse_permittivity[..., j, :]) for j in (0, 1)]
    shear_share = _components(half.transverse_shear_share)
    shear_regular = -eta * shape * root
    flux_x = [
        np.where(
            inside,
            shear_share[j] * shear_regular * scale,
            -permittivity[j][0] * gradient[0] - permittivity[j][1] * gradient[1],
        )
        for j in (0, 1)
    ]
    pressure = scale * shape
    return SurfaceFields(
        contact_pressure=pressure,
        shear_traction=-eta * pressure,
        electric_displacement_y_regular=flux_y[0],
        magnetic_induction_y_regular=flux_y[1],
        stress_xx_regular=stress_xx,
        electric_displacement_x_regular=flux_x[0],
        magnetic_induction_x_regular=flux_x[1],
        root=root,
    )


def friction_bracket(delta: Array, rho: Array, tan: Array, log_cos_over_tan: Array, X: Array) -> Array:
    """[(1 - X^2)(1 - cos(theta) E) + 2 delta X - 2 delta^2] / tan(theta), E = ((1-X)/(1+X))^delta, for |X| < 1.

    The part of (D_y, B_y) sqrt(1 - X^2) that friction adds, in units of eta d h / (lam R); rho = delta / tan(theta).
    """
    slope = log_cos_over_tan - 2 * rho * np.arctanh(X)  # log(cos(theta) E) / tan(theta)
    return 2 * rho * (X - delta) - (1 - X) * (1 + X) * slope * exprel(slope * tan)


def _friction_bracket_outside(delta: Array, rho: Array, X: Array) -> Array:
    """[(X^2 - 1)(1 - E) + 2 delta^2 - 2 delta X] / tan(theta), E = ((X-1)/(X+1))^delta, for |X| > 1.

    Minus sqrt(X^2 - 1) times the Hilbert transform of the same part; expanded in 1/X, where the leading orders cancel.
    """
    u = 1 / X
    gap = atanh_minus(u)
    y = u + gap
    v = -2 * delta * y
    near = 2 * gap * (1 - delta * (y + u)) + 8 * delta**2 * y**3 * exprel3(v)
    return rho * (near * X**2 - 2 * y * exprel(v))


def _stress_transform(delta: Array, X: Array) -> Array:
    """-H[sigma_yy] / pressure_scale for |X| > 1: X(z) - Pol X of theory section 3, expanded in 1/X."""
    u = 1 / X
    gap = atanh_minus(u)
    half_log = 0.5 * np.log1p(-u * u)
    v = half_log - 2 * delta * (u + gap)
    return X * (v**2 * exprel2(v) + half_log - 2 * delta * gap)


def _components(vector: Array) -> list[Array]:
    """Components of (..., n) as n arrays (..., 1), ready for a position axis."""
    return [vector[..., j, None] for j in range(vector.shape[-1])]
