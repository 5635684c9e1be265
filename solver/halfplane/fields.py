"""Surface fields on both sides of the contact (theory, section 5), at dimensionless positions X = (x - c)/h.

Every field times sqrt|1 - X^2| is ``pressure_scale * U + g * W``, where U depends on material, friction, profile and
position only, g on the case alone, and W on the position alone: large arrays take two products and a sum.
"""

import numpy as np

from solver.arrays import Array, BoolArray, components, power_series
from solver.halfplane.contact import Contact


def surface_fields(contact: Contact, positions: Array, *, regular: bool = False) -> dict[str, Array]:
    """Fields by name, SI; if ``regular`` the singular ones times sqrt|1 - X^2|, too; (..., position) each."""
    half, sliding = contact.halfplane, contact.sliding
    inside, root, (S, S_root, HS, D_root, HD_root) = _shapes(contact, positions)
    within, beyond = inside.astype(np.float64), np.where(inside, 0.0, np.sign(positions))
    eta, scale = contact.friction[..., None], contact.pressure_scale[..., None]
    d, r, e, k = (
        components(v)
        for v in (sliding.friction_screening, sliding.screening, contact.charge_density, half.friction_coupling)
    )
    # D_y, B_y; 0 outside the contact
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
    # shared part U, (..., position), strength g, (..., 1), and weight W, (position,)
    singular: dict[str, tuple[Array, Array, Array]] = {
        "electric_displacement_y": (follow[0], e[0], within),
        "magnetic_induction_y": (follow[1], e[1], within),
        "stress_xx": (follow_xx, direct[1] * e[0] + direct[2] * e[1], within),
    }
    for j, name in enumerate(("electric_displacement_x", "magnetic_induction_x")):
        (electric, magnetic), share = permittivity[j], shear_share[j]
        shared = share * eta * S_root - electric * gradient[0] - magnetic * gradient[1]
        singular[name] = shared, electric * carried[0] + magnetic * carried[1], beyond
    pressure = -scale * S
    fields = {"contact_pressure": pressure, "shear_traction": -eta * pressure}
    for name, (shared, strength, weight) in singular.items():
        fields[name] = _sum(scale * (shared / root), strength * (weight / root))
        if regular:
            fields[f"{name}_regular"] = _sum(scale * shared, strength * weight)
    return fields


def _sum(pressed: Array, carried: Array) -> Array:
    """Sum of two arrays, in the memory of the second one if it has the full shape."""
    full = np.broadcast_shapes(pressed.shape, carried.shape) == carried.shape
    return np.add(pressed, carried, out=carried) if full else np.asarray(pressed + carried)


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
    G = power_series(slope, X_in)
    HS[..., inside] = G - contact.angle.tan[..., None] * S[..., inside]
    HD_root[..., inside] = -S_root[..., inside]

    X_out = X[~inside]
    signed = np.sign(X_out) * root[~inside]
    HS[..., ~inside], HD = shape.transforms(X_out, signed, slope)
    HD_root[..., ~inside] = np.sign(X_out) * HD
    return inside, root, values
