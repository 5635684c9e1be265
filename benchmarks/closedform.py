"""Sliding cylinders on half-planes in plain numpy: the yardstick for tables of scattered cases.

All quantities of `solver.solve` for conducting punches, as written down for this one profile: factors are not checked,
outputs have no units. Materials are arrays of constants, one entry each.
"""

from collections.abc import Mapping

import numpy as np
import scipy

from approximation.arrays import Array, Indices


def surfaces(m: Mapping[str, Array]) -> dict[str, Array]:
    """Return N, k, (L^-1)_xx, c11 - h T^-1 h of each material by its Stroh eigenproblem; constants by name, (n,)."""
    zero = np.zeros_like(m["c11"])

    def matrix(*rows: tuple[Array, ...]) -> Array:
        return np.moveaxis(np.array(rows), -1, 0)

    Q = matrix((m["c11"], zero, zero, zero), (zero, m["c44"], m["e15"], m["f15"]),
               (zero, m["e15"], -m["eps11"], -m["g11"]), (zero, m["f15"], -m["g11"], -m["mu11"]))  # fmt: skip
    R = matrix(
        (zero, m["c13"], m["e31"], m["f31"]),
        (m["c44"], zero, zero, zero),
        (m["e15"], zero, zero, zero),
        (m["f15"], zero, zero, zero),
    )
    T = matrix((m["c44"], zero, zero, zero), (zero, m["c33"], m["e33"], m["f33"]),
               (zero, m["e33"], -m["eps33"], -m["g33"]), (zero, m["f33"], -m["g33"], -m["mu33"]))  # fmt: skip
    scale = np.stack([m["c33"], m["c33"], m["eps33"], m["mu33"]], -1) ** -0.5
    scales = scale[:, :, None] * scale[:, None, :]
    Q, R, T = Q * scales, R * scales, T * scales
    inverse, transposed = np.linalg.inv(T), np.swapaxes(R, 1, 2)
    stroh = np.block([[-inverse @ transposed, inverse], [R @ inverse @ transposed - Q, -R @ inverse]])
    roots, vectors = np.linalg.eig(stroh)
    upper = np.take_along_axis(vectors, np.argsort(-roots.imag, -1)[:, None, :4], -1)
    impedance = -upper[:, :4] @ np.linalg.inv(upper[:, 4:]) * scales
    h = R[:, 0, 1:]
    in_plane = (
        m["c11"] - np.einsum("ni,ni->n", h, np.linalg.solve(T[:, 1:, 1:], h[..., None])[..., 0]) / scales[:, 0, 0]
    )
    return {
        "N": impedance.imag[:, 1:, 1:], "k": -impedance.real[:, 1:, 0], "across": impedance.imag[:, 0, 0] * in_plane
    }  # fmt: skip


def cylinders(
    materials: Mapping[str, Array], which: Indices, radius: Array, load: Array, friction: Array, datum: float = 1.0
) -> dict[str, Array]:
    """Return all quantities of sliding cylinders without charges, (case,); which: the material of each case."""
    surface = surfaces(materials)
    N, k = surface["N"], surface["k"]
    r, d = (np.linalg.solve(N[:, 1:, 1:], right[..., None])[..., 0] for right in (N[:, 1:, 0], k[:, 1:]))
    lam, kap = N[:, 0, 0] - np.sum(N[:, 0, 1:] * r, -1), k[:, 0] - np.sum(N[:, 0, 1:] * d, -1)
    stroke = -N[:, 0, 1:] / np.diagonal(N[:, 1:, 1:], axis1=1, axis2=2)
    tan = friction * (kap / lam)[which]
    delta = np.arctan(tan) / np.pi
    per_tan = np.cos(np.pi * delta) / (np.pi * np.sinc(delta))
    h = np.sqrt(2 * lam[which] * load * radius / (np.pi * (1 - 4 * delta**2)))
    scale = h / (radius * lam[which])
    trailing, leading = h * (1 - 2 * delta), h * (1 + 2 * delta)
    digamma = scipy.special.digamma(1.5 + delta) - scipy.special.digamma(1.5)
    first = -np.divide(digamma, delta, out=np.full_like(delta, np.pi**2 / 2 - 4), where=delta != 0) - 4 / (
        1 + 2 * delta
    )
    third = (2 * delta - 2 * delta * (-2 - 2 * delta * first) + first) / 2
    follower = -2 * friction * per_tan * (first - third) / (np.pi * (1 - 4 * delta**2)) - friction / 2
    logarithm = np.log(h / (2 * datum)) / np.pi
    tangents, parts = [], []
    for J in range(3):
        part = N[which, J, 0] * logarithm + k[which, J] * follower
        if J == 0:
            part += lam[which] * (digamma + 0.5) / np.pi - kap[which] * (follower + friction / 2)
        parts.append(part)
        tangents.append(part + N[which, J, 0] / (2 * np.pi))
    rise = trailing**2 / (2 * radius)
    out = {
        "contact_trailing": trailing, "contact_leading": leading, "pressure_exponent": 0.5 + delta,
        "depth": rise - load * parts[0],
        "peak_pressure": scale * np.cos(np.pi * delta) * h**-1 * leading ** (0.5 + delta) * trailing ** (0.5 - delta),
        "trailing_tension": surface["across"][which] * friction * scale * (1 - 2 * delta),
        "leading_compression": -surface["across"][which] * friction * scale * (1 + 2 * delta),
    }  # fmt: skip
    names = (
        ("electric", "voltage", "voltage_per_load", "charge_per_force", "stroke_per_volt", "blocked_load_per_volt"),
        ("magnetic", "magnetic_potential", "magnetic_potential_per_load", "flux_per_force", "stroke_per_ampere",
         "blocked_load_per_ampere"),
    )  # fmt: skip
    root, sheared = np.sqrt(np.pi * h), friction * per_tan * scale
    for j, (field, potential, per_load, charge, moved, blocked) in enumerate(names):
        carried = -r[which, j] * load / (np.pi * h)
        for end, polynomial in (("trailing", 2 - 2 * delta), ("leading", -2 - 2 * delta)):
            out[f"{field}_edge_intensity_{end}"] = root * (sheared * polynomial * d[which, j] + carried)
        direct, cross = N[which, 1 + j, 1 + j], -N[which, 0, 1 + j]
        out[potential], out[per_load] = load * parts[1 + j], tangents[1 + j]
        out[charge] = -parts[1 + j] / (direct * logarithm)
        out[moved] = stroke[which, j]
        out[blocked] = cross / (tangents[1 + j] * cross - direct * (rise / load - tangents[0]))
    return out
