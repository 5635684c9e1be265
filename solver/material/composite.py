"""Effective constants of two-phase composites poled along y and of AlScN (theory, section 7)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from solver.arrays import Array, column, outer, stack, unmasked
from solver.material.constants import ANY_SIZE, UNITS, VACUUM_PERMITTIVITY, Material, MaterialError
from solver.material.evidence import Sourced
from solver.names import COMPOSITES, FACTORS, THERMAL

_FIELD = 1e9  # V/m: scales couplings and permittivities of ceramics to the size of their stiffnesses
# of AlN, of wurtzite ScN, and the bowing, as in theory, section 7; GPa and C/m2
_BOWED = {
    "c11": (410.2, 295.3, -210.3),
    "c12": (142.4, 198.6, -61.9),
    "c13": (110.1, 135.5, 78.9),
    "c33": (385.0, -23.8, -101.4),
    "c44": (122.9, 169.5, -137.3),
    "e31": (-0.63, -0.492, -0.615),
    "e33": (1.46, 8.193, -5.912),
    "e15": (-0.39, -0.458, 0.417),
}
_SWITCHING = (
    "2 to 5 MV/cm, the less the more scandium: abstract of a paper on ferroelectric AlScN, read at arxivlens.com"
)


def fibrous(fibre: Material, matrix: Material, fraction: ArrayLike) -> Material:
    """1-3 composite by Mori-Tanaka: circular fibres along y in a matrix.

    Parameters
    ----------
    fibre, matrix
        The phases; both need c12.
    fraction
        Volume fraction of the fibres, 0 to 1, any shape.

    Raises
    ------
    MaterialError
        Fraction outside 0..1, a phase without c12, or an inadmissible result.

    Notes
    -----
    Closed form of theory section 7, with the differences of the phases' bulk moduli cancelled by hand, so that
    equal phases and the fractions 0 and 1 are ordinary values. Constants for heat follow for one fraction alone: those
    of films by the exact relation of V.M. Levin (1967), with the expansion of each phase alike in all directions, the
    conductivity of phases side by side.

    Examples
    --------
    >>> import solver
    >>> half = fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), [0.0, 0.5])
    >>> half.shape, bool(half.c33[0] == solver.find("CoFe2O4").c33), f"{half.g11[1]:.3g}"
    ((2,), True, '-5.23e-12')
    """
    v = _fraction("volume_fraction", fraction)
    for phase in (fibre, matrix):
        phase.check()
        if np.any(np.isnan(phase.c12)):
            raise MaterialError(f"{phase.name}: c12: missing; a fibrous composite needs it [Pa]")
    bulk_f, bulk_m = (fibre.c11 + fibre.c12) / 2, (matrix.c11 + matrix.c12) / 2
    shear_f, shear_m = (fibre.c11 - fibre.c12) / 2, (matrix.c11 - matrix.c12) / 2

    weight = v * (bulk_m + shear_m) + (1 - v) * (bulk_f + shear_m)
    bulk = (bulk_f + shear_m) * (bulk_m + shear_m) / weight - shear_m
    strain_share = v * (bulk_m + shear_m) / weight  # (k* - k_m) / (k_f - k_m)
    curvature = v * (1 - v) / weight  # -(k* - <k>) / (k_f - k_m)^2
    shear_gap = shear_f - shear_m
    softening = (1 - v) * (bulk_m + 2 * shear_m) / (2 * shear_m * (bulk_m + shear_m))
    shear = shear_m + v * shear_gap / (1 + shear_gap * softening)

    h_f, h_m = (stack(m.c13, m.e31, m.f31) for m in (fibre, matrix))
    h_gap = h_f - h_m
    h = h_m + strain_share[..., None] * h_gap
    T_f, T_m = (m.generalised_stiffness()[2][..., 1:, 1:] for m in (fibre, matrix))
    T = column(v) * T_f + column(1 - v) * T_m - column(curvature) * outer(h_gap)
    G_f, G_m = (m.generalised_stiffness()[0][..., 1:, 1:] for m in (fibre, matrix))
    G = _mori_tanaka_shear(G_f, G_m, v)

    return _admissible(
        Material(
            **_of_blocks(h, T, G), c11=bulk + shear, c12=bulk - shear,
            rho=v * fibre.rho + (1 - v) * matrix.rho,
            name=f"fibrous {fibre.name} in {matrix.name}", source="Mori-Tanaka of the phases",
            any_size=ANY_SIZE,
        ),
        (fibre, matrix), v, parallel=True,
    )  # fmt: skip


def laminate(first: Material, second: Material, fraction: ArrayLike) -> Material:
    """2-2 composite, exact: layers normal to y.

    Parameters
    ----------
    first, second
        The phases; c12 of the result is NaN unless both have it.
    fraction
        Volume fraction of the first phase, 0 to 1, any shape.

    Raises
    ------
    MaterialError
        Fraction outside 0..1, or an inadmissible result.

    Examples
    --------
    >>> import solver
    >>> half = laminate(solver.find("BaTiO3"), solver.find("CoFe2O4"), 0.5)
    >>> f"{float(half.c33):.4g}"
    '2.234e+11'
    """
    v = _fraction("volume_fraction", fraction)
    for phase in (first, second):
        phase.check()
    scales = outer(_scale(first, second))
    Q_1, R_1, T_1 = (block * scales for block in first.generalised_stiffness())
    Q_2, R_2, T_2 = (block * scales for block in second.generalised_stiffness())

    def average(first_block: Array, second_block: Array) -> Array:
        return column(v) * first_block + column(1 - v) * second_block

    I_1, I_2 = np.linalg.inv(T_1), np.linalg.inv(T_2)
    schur = average(Q_1 - R_1 @ I_1 @ R_1.mT, Q_2 - R_2 @ I_2 @ R_2.mT)
    T_inv = average(np.asarray(I_1), np.asarray(I_2))
    T = np.linalg.inv(T_inv)
    R = average(R_1 @ I_1, R_2 @ I_2) @ T
    Q = (schur + R @ T_inv @ R.mT) / scales
    R, T = R / scales, T / scales

    # c12 is of the out-of-plane stress, which the plane blocks lack: the layers share eps_xx, and the shear stiffness
    # (c11 - c12)/2 in the plane of the layers averages
    shear = v * (first.c11 - first.c12) / 2 + (1 - v) * (second.c11 - second.c12) / 2
    return _admissible(
        Material(
            **_of_blocks(R[..., 0, 1:], T[..., 1:, 1:], Q[..., 1:, 1:]),
            c11=Q[..., 0, 0], c12=Q[..., 0, 0] - 2 * shear,
            rho=v * first.rho + (1 - v) * second.rho,
            name=f"laminate of {first.name} and {second.name}", source="exact laminate of the phases",
            any_size=ANY_SIZE,
        ),
        (first, second), v, parallel=False,
    )  # fmt: skip


def aluminium_scandium_nitride(scandium_fraction: ArrayLike) -> Material:
    """Al(1-x)Sc(x)N of the wurtzite structure, which is exactly transversely isotropic, poled along y.

    Parameters
    ----------
    scandium_fraction
        Share x of the metal atoms, 0 to 0.5, any shape.

    Returns
    -------
    Material
        Constants of the shape of x. The density is unknown.

    Raises
    ------
    MaterialError
        A fraction outside 0 to 0.5, beyond which the wurtzite structure does not hold.

    Notes
    -----
    M.A. Caro, S. Zhang, T. Riekkinen et al., J. Phys.: Condens. Matter 27 (2015) 245901: quadratic fits to density
    functional theory, which a measured e33 supports. The fits and the permittivity (one for both directions) are as
    coded in a public module that cites the paper, not read in print; that module's density, 3512 kg/m3 of AlN, is 8 %
    above the handbooks' and is not taken. A film on its substrate is clamped: it has e33/c33 = 3.8 pC/N at x = 0 and
    15.8 at x = 0.43 by these fits, where films were measured to have 5.5 and 27.6, between that and the free d33 of the
    fits, 5.0 and 33.9.

    Examples
    --------
    >>> film = aluminium_scandium_nitride(0.3)
    >>> f"{film.c33 / 1e9:.1f} GPa, {film.e33:.3f} C/m2"
    '241.1 GPa, 2.238 C/m2'
    """
    x = _fraction("scandium_fraction", scandium_fraction)

    def bowed(name: str) -> Array:
        nitride, scandium, bowing = _BOWED[name]
        scale = 1e9 if name.startswith("c") else 1.0
        return scale * (nitride * (1 - x) + scandium * x + bowing * x * (1 - x))

    permittivity = VACUUM_PERMITTIVITY * (9.37 + 3.7161 * x + 40.293 * x**2)
    constants: dict[str, Any] = {name: bowed(name) for name in _BOWED}
    material = Material(
        **constants,
        eps11=permittivity,
        eps33=permittivity,
        name="AlScN",
        source="M.A. Caro et al., J. Phys.: Condens. Matter 27 (2015) 245901, fits as coded in a public module",
        any_size=ANY_SIZE,
        limits={"coercive_field": Sourced(200e6, _SWITCHING)},
    )
    material.check()
    return material


def _of_blocks(h: Array, T: Array, G: Array) -> dict[str, Any]:
    """Constants by name of h (..., 3), coupled to eps_xx, and of the blocks T and G (..., 3, 3) of (y, phi, psi)."""
    constants = {"c13": h[..., 0], "e31": h[..., 1], "f31": h[..., 2]}
    for block, (c, e, f, axis) in ((T, ("c33", "e33", "f33", "33")), (G, ("c44", "e15", "f15", "11"))):
        constants |= {c: block[..., 0, 0], e: block[..., 0, 1], f: block[..., 0, 2]}
        constants |= {f"eps{axis}": -block[..., 1, 1], f"g{axis}": -block[..., 1, 2], f"mu{axis}": -block[..., 2, 2]}
    return constants


def _fraction(factor: str, values: ArrayLike) -> Array:
    """Return values of a factor as an array, or refuse those outside its bounds."""
    fractions, allowed = np.asarray(unmasked(values), dtype=np.float64), FACTORS[factor]
    bad = fractions[~((fractions >= allowed.low) & (fractions <= allowed.high))]
    if bad.size:
        raise MaterialError(f"{factor}: {bad.flat[0]:g} is not within {allowed.low:g} to {allowed.high:g}")
    return fractions


def _scale(*phases: Material) -> Array:
    """Diagonal that scales the blocks of all phases to the order of one; (4,)."""
    stiffness = max(float(np.max(p.c33)) for p in phases)
    electric = max(float(np.max(p.eps33)) for p in phases)
    magnetic = max(float(np.max(p.mu33)) for p in phases)
    return np.array([stiffness, stiffness, electric, magnetic]) ** -0.5


def _mori_tanaka_shear(G_f: Array, G_m: Array, v: Array) -> Array:
    """Longitudinal shear block G* of the fibrous composite, scaled before the inverse; (..., 3, 3)."""
    scales = outer(1 / np.sqrt(np.abs(np.linalg.diagonal(G_m))))
    gap, host = (G_f - G_m) * scales, G_m * scales
    concentration = np.linalg.inv(np.eye(3) + column((1 - v) / 2) * np.linalg.solve(host, gap))
    return np.asarray((host + column(v) * gap @ concentration) / scales)


def _admissible(material: Material, phases: tuple[Material, Material], v: Array, *, parallel: bool) -> Material:
    """Check a composite, and add thermal constants if it has no case axes."""
    material.check()
    return material if v.shape else replace(material, thermal=_thermal(material, phases, float(v), parallel))


def _thermal(composite: Material, phases: tuple[Material, Material], v: float, parallel: bool) -> dict[str, Sourced]:
    """Thermal constants of a composite that its phases have; ``parallel``: heat flows through them side by side."""
    first, second = ({name: known.value for name, known in phase.thermal.items()} for phase in phases)
    values: dict[str, float] = {}
    for name, power in (("heat_capacity", 1), ("conductivity", 1 if parallel else -1)):
        if name in first and name in second:
            values[name] = (v * first[name] ** power + (1 - v) * second[name] ** power) ** power
    loads = [_thermal_load(phase, known) for phase, known in zip(phases, (first, second), strict=True)]
    matrix_1, matrix_2, matrix = (_axial(body) for body in (*phases, composite))
    if loads[0] is not None and loads[1] is not None and np.linalg.matrix_rank(matrix_1 - matrix_2) == len(matrix):
        # with the change of temperature these strains and fields are uniform in both phases, and so in the composite
        uniform = np.linalg.solve(matrix_1 - matrix_2, loads[1] - loads[0])
        load = loads[0] + (matrix_1 - matrix) @ uniform
        across, along = np.linalg.solve(matrix[:2, :2], -load[:2])
        values["expansion"] = across
        values["pyroelectric"] = load[2] / _FIELD + composite.e31 * 2 * across + composite.e33 * along
    source = f"of {phases[0].name} and {phases[1].name} by the relation of Levin (1967) and rules of mixtures"
    return {name: Sourced(float(values[name]), source) for name in THERMAL if name in values}


def _axial(material: Material) -> Array:
    """Matrix from strains across and along the axis and both fields to stresses and inductions, scaled; (4, 4)."""
    m = {name: float(getattr(material, name)) for name in UNITS}
    matrix = np.array([
        [m["c11"] + m["c12"], m["c13"], -m["e31"], -m["f31"]],
        [2 * m["c13"], m["c33"], -m["e33"], -m["f33"]],
        [2 * m["e31"], m["e33"], m["eps33"], m["g33"]],
        [2 * m["f31"], m["f33"], m["g33"], m["mu33"]],
    ])  # fmt: skip
    scale = np.array([1.0, 1.0, _FIELD, _FIELD / 100])
    return np.asarray(matrix * outer(scale))


def _thermal_load(material: Material, known: Mapping[str, float]) -> Array | None:
    """Scaled stresses and inductions per kelvin at zero strain and field (4,), None if a constant is unknown."""
    polar = bool(material.e31 or material.e33 or material.e15)
    if "expansion" not in known or (polar and "pyroelectric" not in known) or np.isnan(material.c12):
        return None
    free = np.array([known["expansion"], known["expansion"], 0.0, 0.0])
    load = np.asarray(-_axial(material) @ free)
    load[2] += _FIELD * known.get("pyroelectric", 0.0)
    return load


#: The two phases of a composite in ``solver.names.MIXTURES``; empty for another.
Phases = Sequence[Material]

_LAWS: dict[str, Callable[[Phases, float | Array], Material]] = {
    "fibrous": lambda phases, fraction: fibrous(phases[0], phases[1], fraction),
    "laminate": lambda phases, fraction: laminate(phases[0], phases[1], fraction),
    "AlScN": lambda _, fraction: aluminium_scandium_nitride(fraction),
}


def compose(composite: str, phases: Phases, fraction: float | Array) -> Material:
    """Return the composite of a name, with its phases and its fraction (...)."""
    if composite not in _LAWS:
        raise MaterialError(f"composite: {composite!r} is not one of {', '.join(COMPOSITES)}")
    return _LAWS[composite](phases, fraction)
