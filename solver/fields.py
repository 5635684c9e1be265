"""Surface fields on both sides of the contact (theory section 5), at dimensionless positions X = (x - c)/h.

Every field times sqrt|1 - X^2| is ``pressure_scale * U + sum_j charge_density_j * W_j``, where U depends on material,
friction, profile and position only and W on material and side only: the large shapes see one product and one sum.
"""

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, BoolArray, components
from solver.contact import Contact


@dataclass(frozen=True, eq=False)
class SurfaceFields:
    """Fields along the surface, each (..., position) in the smallest shape; [Pa], [C/m2] and [T].

    ``*_regular`` is the field times sqrt|1 - X^2|, which is finite at a smooth edge.
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
    half, sliding = contact.halfplane, contact.sliding
    inside, root, (S, S_root, HS, D_root, HD_root) = _shapes(contact, positions)
    sign = np.where(inside, 0.0, np.sign(positions))
    eta, scale = contact.friction[..., None], contact.pressure_scale[..., None]
    d, r, e, k = (
        components(v)
        for v in (sliding.friction_screening, sliding.screening, contact.charge_density, half.friction_coupling)
    )
    follow = [eta * d[j] * D_root - r[j] * S_root for j in (0, 1)]  # U of D_y, B_y
    flux_y = [np.where(inside, scale * follow[j] + e[j], 0.0) for j in (0, 1)]

    # du_x/dx = -k.(sigma_yy, D_y, B_y) + (L^-1)_xx eta H[sigma_yy]
    stiffness = half.in_plane_stiffness[..., None]
    direct = [share - stiffness * k_j for share, k_j in zip(components(half.in_plane_share), k, strict=True)]
    stretch = stiffness * half.tangential_compliance[..., None] * eta * HS + direct[0] * S
    follow_xx = stretch * root + np.where(inside, direct[1] * follow[0] + direct[2] * follow[1], 0.0)
    stress_xx = scale * follow_xx + np.where(inside, direct[1] * e[0] + direct[2] * e[1], 0.0)

    # lam d(phi, psi)/dx = s {eta [k_J S + (N_Jq.d) H[D]] + (N_J0 - N_Jq.r) H[S]} + N_Jq.e0 H[1/sqrt]
    own, coupled = components(sliding.normal_compliance), components(sliding.friction_coupling)
    gradient = []
    for j in (1, 2):
        M = components(half.compliance[..., j, 1:])
        followed = eta * (coupled[j] * S_root + (k[j] - coupled[j]) * (HD_root + S_root)) + own[j] * HS * root
        gradient.append(scale * followed - sign * (M[0] * e[0] + M[1] * e[1]))
    permittivity = [components(half.transverse_permittivity[..., j, :]) for j in (0, 1)]
    shear_share = components(half.transverse_shear_share)
    shear_regular = eta * scale * S_root
    flux_x = [
        shear_share[j] * shear_regular - permittivity[j][0] * gradient[0] - permittivity[j][1] * gradient[1]
        for j in (0, 1)
    ]
    pressure = -scale * S
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


def _shapes(contact: Contact, X: Array) -> tuple[BoolArray, Array, list[Array]]:
    """Where the contact is, sqrt|1 - X^2|, and [S, S root, H[S], D root, H[D] root] on both sides of the edges."""
    shape, slope = contact.shape, contact.pressing.slope
    inside = np.abs(X) < 1
    root: Array = np.sqrt(np.abs((1 - X) * (1 + X)))
    size = [np.broadcast_shapes(shape.factor.shape[:-1], slope.shape[:-1], contact.angle.delta.shape), X.shape]
    values: list[Array] = [np.zeros((*size[0], *size[1])) for _ in range(5)]
    S, S_root, HS, D_root, HD_root = values

    X_in = X[inside]
    S[..., inside], S_root[..., inside] = shape.traction(X_in)
    D_root[..., inside] = shape.follower(X_in)
    G = np.polynomial.polynomial.polyval(X_in, np.moveaxis(slope, -1, 0))
    HS[..., inside] = G - contact.angle.tan[..., None] * S[..., inside]
    HD_root[..., inside] = -S_root[..., inside]

    X_out = X[~inside]
    signed = np.sign(X_out) * root[~inside]
    HS[..., ~inside], HD = shape.transforms(X_out, signed, slope)
    HD_root[..., ~inside] = np.sign(X_out) * HD
    return inside, root, values
