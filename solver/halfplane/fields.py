"""Surface fields on both sides of the contact (theory section 5), at dimensionless positions X = (x - c)/h.

Every field times sqrt|1 - X^2| is ``pressure_scale * U + g * W``, where U depends on material, friction, profile and
position only, g on the case without the position, and W on the position only: the large shapes see two products and a
sum.
"""

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, BoolArray, components
from solver.halfplane.contact import Contact


@dataclass(frozen=True, eq=False)
class Separable:
    """A field ``(scale * shared + strength * weight) / root`` that is singular at the edges.

    ``scale`` and ``strength`` have the case axes and an axis of length 1 (..., 1), ``shared`` has a position axis in
    the smallest shape (..., position), ``weight`` and ``root = sqrt|1 - X^2|`` have nothing else (position,).
    """

    scale: Array
    shared: Array
    strength: Array
    weight: Array
    root: Array

    @property
    def values(self) -> Array:
        """The field itself, (..., position)."""
        return self._sum(self.shared / self.root, self.weight / self.root)

    @property
    def regular(self) -> Array:
        """The field times ``root``, which is finite at a smooth edge."""
        return self._sum(self.shared, self.weight)

    def _sum(self, shared: Array, weight: Array) -> Array:
        pressed, carried = self.scale * shared, self.strength * weight
        if np.broadcast_shapes(pressed.shape, carried.shape) != carried.shape:
            return np.asarray(pressed + carried)
        return np.add(pressed, carried, out=carried)  # of two arrays of full size, one is enough


@dataclass(frozen=True, eq=False)
class SurfaceFields:
    """Fields along the surface, each (..., position) in the smallest shape; [Pa], [C/m2] and [T]."""

    contact_pressure: Array
    shear_traction: Array
    electric_displacement_y: Separable
    magnetic_induction_y: Separable
    stress_xx: Separable
    electric_displacement_x: Separable
    magnetic_induction_x: Separable


def surface_fields(contact: Contact, positions: Array) -> SurfaceFields:
    """Fields of every case at every position."""
    half, sliding = contact.halfplane, contact.sliding
    inside, root, (S, S_root, HS, D_root, HD_root) = _shapes(contact, positions)
    within, beyond = inside.astype(np.float64), np.where(inside, 0.0, np.sign(positions))
    eta, scale = contact.friction[..., None], contact.pressure_scale[..., None]
    d, r, e, k = (
        components(v)
        for v in (sliding.friction_screening, sliding.screening, contact.charge_density, half.friction_coupling)
    )
    # D_y, B_y; nothing outside the contact
    follow = [np.where(inside, eta * d[j] * D_root - r[j] * S_root, 0.0) for j in (0, 1)]

    # du_x/dx = -k.(sigma_yy, D_y, B_y) + (L^-1)_xx eta H[sigma_yy]
    stiffness = half.in_plane_stiffness[..., None]
    direct = [share - stiffness * k_j for share, k_j in zip(components(half.in_plane_share), k, strict=True)]
    stretch = stiffness * half.tangential_compliance[..., None] * eta * HS + direct[0] * S
    follow_xx = stretch * root + direct[1] * follow[0] + direct[2] * follow[1]

    # lam d(phi, psi)/dx = s {eta [k_J S + (N_Jq.d) H[D]] + (N_J0 - N_Jq.r) H[S]} + N_Jq.e0 H[1/sqrt]
    normal, coupled = components(sliding.normal_compliance), components(sliding.friction_coupling)
    gradient, carried = [], []
    for j in (1, 2):
        M = components(half.compliance[..., j, 1:])
        gradient.append(eta * (coupled[j] * S_root + (k[j] - coupled[j]) * (HD_root + S_root)) + normal[j] * HS * root)
        carried.append(M[0] * e[0] + M[1] * e[1])
    permittivity = [components(half.transverse_permittivity[..., j, :]) for j in (0, 1)]
    shear_share = components(half.transverse_shear_share)
    flux_x = [
        Separable(
            scale,
            shear_share[j] * eta * S_root - permittivity[j][0] * gradient[0] - permittivity[j][1] * gradient[1],
            permittivity[j][0] * carried[0] + permittivity[j][1] * carried[1],
            beyond,
            root,
        )
        for j in (0, 1)
    ]
    pressure = -scale * S
    return SurfaceFields(
        contact_pressure=pressure,
        shear_traction=-eta * pressure,
        electric_displacement_y=Separable(scale, follow[0], e[0], within, root),
        magnetic_induction_y=Separable(scale, follow[1], e[1], within, root),
        stress_xx=Separable(scale, follow_xx, direct[1] * e[0] + direct[2] * e[1], within, root),
        electric_displacement_x=flux_x[0],
        magnetic_induction_x=flux_x[1],
    )


def _shapes(contact: Contact, X: Array) -> tuple[BoolArray, Array, list[Array]]:
    """Mask of the contact, sqrt|1 - X^2|, and [S, S root, H[S], D root, H[D] root] on both sides of the edges."""
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
