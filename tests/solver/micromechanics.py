"""Effective constants of two-phase composites from the full three-dimensional tensors, in mpmath.

Generalised displacement U = (u_1, u_2, u_3, phi, psi), flux S_iJ = L_iJMn U_M,n, poling along axis 3 (index 2); L is a
symmetric 15 x 15 matrix over (i, J) and (n, M). Nothing is taken from the theory's closed forms: the fibre's field
comes from the polarisation tensor of a cylinder, the laminate's from its conditions of continuity.
"""

from collections.abc import Mapping

from mpmath import cos, eye, inverse, matrix, mp, mpf, pi, sin, zeros

DIGITS = 40
_ANGLES = 12  # the integrand of the polarisation tensor has harmonics 0, 2 and 4 only
_SHEARS = {3: (1, 2), 4: (0, 2), 5: (0, 1)}


def fibrous(fibre: Mapping[str, float], host: Mapping[str, float], fraction: float) -> dict[str, mpf]:
    """Mori-Tanaka: the mean field of the host is what the single fibre of Eshelby's problem sees."""
    with mp.workdps(DIGITS):
        L_host = _tensor(host)
        gap, v = _tensor(fibre) - L_host, mpf(fraction)
        dilute = inverse(eye(15) + _cylinder_polarisation(L_host) * gap)
        return _constants(L_host + v * gap * dilute * inverse((1 - v) * eye(15) + v * dilute))


def laminate(first: Mapping[str, float], second: Mapping[str, float], fraction: float) -> dict[str, mpf]:
    """Layers normal to the poling axis: gradients along them and fluxes across them are common to both phases."""
    with mp.workdps(DIGITS):
        upper, lower, v = _tensor(first), _tensor(second), mpf(fraction)
        along, across = slice(0, 10), slice(10, 15)
        system = zeros(10)  # unknown: the gradients across the layers in the first phase, then in the second
        system[0:5, 0:5], system[0:5, 5:10] = v * eye(5), (1 - v) * eye(5)
        system[5:10, 0:5], system[5:10, 5:10] = upper[across, across], -lower[across, across]
        mean = zeros(10, 15)  # right-hand sides of a unit mean gradient of each kind
        mean[0:5, across] = eye(5)
        mean[5:10, along] = lower[across, along] - upper[across, along]
        jumps = inverse(system) * mean
        fields = [zeros(15), zeros(15)]
        for phase, field in enumerate(fields):
            field[along, along] = eye(10)
            field[across, :] = jumps[5 * phase : 5 * phase + 5, :]
        return _constants(v * upper * fields[0] + (1 - v) * lower * fields[1])


def _tensor(c: Mapping[str, float]) -> matrix:
    """L of one phase; S_i4 = D_i, S_i5 = B_i, so that the permittivities stand with a minus."""
    L = zeros(15)
    stiffness = zeros(6)
    for row, names in enumerate((("c11", "c12", "c13"), ("c12", "c11", "c13"), ("c13", "c13", "c33"))):
        for column, name in enumerate(names):
            stiffness[row, column] = mpf(c[name])
    stiffness[3, 3] = stiffness[4, 4] = mpf(c["c44"])
    stiffness[5, 5] = (mpf(c["c11"]) - mpf(c["c12"])) / 2
    for row in range(6):
        for column in range(6):
            for i, j in _pairs(row):
                for m, n in _pairs(column):
                    L[5 * i + j, 5 * n + m] = stiffness[row, column]
    for J, kind in ((3, "e"), (4, "f")):
        for axis, voigt, name in ((2, 0, "31"), (2, 1, "31"), (2, 2, "33"), (1, 3, "15"), (0, 4, "15")):
            for m, n in _pairs(voigt):
                L[5 * axis + J, 5 * n + m] = L[5 * n + m, 5 * axis + J] = mpf(c[kind + name])
    for axis, name in ((0, "11"), (1, "11"), (2, "33")):
        for J, M, kind in ((3, 3, "eps"), (3, 4, "g"), (4, 3, "g"), (4, 4, "mu")):
            L[5 * axis + J, 5 * axis + M] = -mpf(c[kind + name])
    return L


def _pairs(voigt: int) -> tuple[tuple[int, int], ...]:
    if voigt < 3:
        return ((voigt, voigt),)
    i, j = _SHEARS[voigt]
    return ((i, j), (j, i))


def _cylinder_polarisation(L: matrix) -> matrix:
    """Mean over the directions n normal to the axis of n_n n_i (n L n)^-1_MJ."""
    out = zeros(15)
    for step in range(_ANGLES):
        angle = 2 * pi * step / _ANGLES
        direction = zeros(15, 5)
        for axis, component in ((0, cos(angle)), (1, sin(angle))):
            for J in range(5):
                direction[5 * axis + J, J] = component
        out += direction * inverse(direction.T * L * direction) * direction.T
    return out / _ANGLES


def _constants(L: matrix) -> dict[str, mpf]:
    """Constants of a transversely isotropic L."""
    c = {"c11": L[0, 0], "c12": L[0, 6], "c13": L[0, 12], "c33": L[12, 12], "c44": L[2, 10]}
    for J, kind in ((3, "e"), (4, "f")):
        c |= {f"{kind}31": L[10 + J, 0], f"{kind}33": L[10 + J, 12], f"{kind}15": L[J, 10]}
    for J, M, kind in ((3, 3, "eps"), (3, 4, "g"), (4, 4, "mu")):
        c |= {f"{kind}11": -L[J, M], f"{kind}33": -L[10 + J, 10 + M]}
    rebuilt = _tensor(c)
    for row in range(15):
        for column in range(15):
            size = mp.sqrt(abs(L[row, row] * L[column, column]))
            if abs(rebuilt[row, column] - L[row, column]) > mpf(10) ** (8 - DIGITS) * size:
                raise ArithmeticError(f"effective tensor lost its symmetry at {row}, {column}")
    return c
