"""Aluminium scandium nitride Al(1-x)Sc(x)N by its composition."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from solver.arrays import Array, unmasked
from solver.material.constants import ANY_SIZE, VACUUM_PERMITTIVITY, Material, MaterialError
from solver.material.evidence import Sourced
from solver.names import FACTORS

# of AlN, of wurtzite ScN, and the bowing: v(x) = a (1 - x) + b x + c x (1 - x); GPa and C/m2
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
    x, allowed = np.asarray(unmasked(scandium_fraction), dtype=np.float64), FACTORS["scandium_fraction"]
    bad = x[~((x >= allowed.low) & (x <= allowed.high))]
    if bad.size:
        raise MaterialError(f"scandium_fraction: {bad.flat[0]:g} is not within {allowed.low:g} to {allowed.high:g}")

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
