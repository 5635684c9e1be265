"""Usual sizes of material constants: a bare number far outside has probably lost its unit, and is questioned."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.names import LIMITS
from solver.units import VACUUM_PERMEABILITY, VACUUM_PERMITTIVITY

_MOST_COUPLED = 1e3  # e^2/(c eps) of one field; the strongest relaxor crystals reach 30


@dataclass(frozen=True)
class Usual:
    """Smallest and largest size of a constant in any material, and likely causes of numbers beyond them."""

    low: float
    high: float
    below: str = ""  # likely meaning of a smaller number {0}
    above: str = ""  # likely meaning of a larger number {0}, which is {1} in SI
    unit: float = 1.0  # {1} over {0}


# hydrogels have 1 kPa, diamond 1.08 TPa; Landolt-Boernstein tables count in dyn/cm2
_STIFFNESS = Usual(1e3, 1.3e12, "{0:g} GPa", "{0:g} dyn/cm2 = {1:g} Pa", 0.1)
# cellular polymers have 1e-4 C/m2, relaxor crystals and potassium niobate up to 50 C/m2
_PIEZOELECTRIC = Usual(
    1e-8, 1e2, "d = {0:g} C/N (e is d times the stiffness)", "{0:g} uC/cm2 = {1:g} C/m2", 1e-2
)  # fmt: skip
# garnets have 1 N/(A m), amorphous ribbons some 1e4
_PIEZOMAGNETIC = Usual(1e-7, 1e6, "d = {0:g} m/A (f is d times the stiffness)")
# nothing is below the vacuum, relaxors reach 1e5 times the vacuum
_PERMITTIVITY = Usual(1e-12, 1e-5, above="{0:g} eps0 = {1:.4g} F/m, or {0:g} nF/m", unit=VACUUM_PERMITTIVITY)
# diamagnets are by less than a thousandth below the vacuum, mu-metal reaches 1e5 times the vacuum
_PERMEABILITY = Usual(1e-7, 0.5, above="{0:g} mu0 = {1:.4g} N s2/C2", unit=VACUUM_PERMEABILITY)
# chromium oxide has 4e-12 s/m, composites up to 1e-7 s/m
_MAGNETOELECTRIC = Usual(1e-16, 1e-5, above="{0:g} ps/m = {1:g} s/m", unit=1e-12)
# foams have 25 kg/m3, osmium 22 590
_DENSITY = Usual(25.0, 3e4, "{0:g} g/cm3")
# gels tear at some kPa, the strongest fibres at 60 GPa
_STRENGTH = Usual(1e3, 1e11, "{0:g} MPa")
# soft relaxors switch at some 1e4 V/m, thin oxides break down at 1e9 V/m
_FIELD = Usual(1e3, 1e10, "{0:g} kV/mm")
# cellular polymers have 1e-7 C/m2/K, relaxor crystals near a transition some 1e-2
_PYROELECTRIC = Usual(1e-9, 0.1, above="{0:g} uC/m2/K = {1:g} C m-2 K-1", unit=1e-6)
# glass ceramics are below 1e-7 1/K, gels reach 1e-3
_EXPANSION = Usual(1e-9, 5e-3, above="{0:g} ppm/K = {1:g} K-1", unit=1e-6)
# foams and aerogels have 0.01 W/m/K, graphene 5e3
_CONDUCTIVITY = Usual(1e-3, 1e4)
# foams have 2e4 J/m3/K, nickel and steel 4e6
_HEAT_CAPACITY = Usual(1e3, 1e7, "{0:g} MJ/m3/K")

#: Usual sizes of every constant, and of every entry of ``solver.names.LIMITS`` and ``THERMAL``.
USUAL: dict[str, Usual] = {
    **dict.fromkeys(("c11", "c12", "c13", "c14", "c33", "c44", "young"), _STIFFNESS),
    **dict.fromkeys(("e31", "e33", "e15", "e11", "e14", "e22"), _PIEZOELECTRIC),
    **dict.fromkeys(("f31", "f33", "f15"), _PIEZOMAGNETIC),
    **dict.fromkeys(("eps11", "eps33"), _PERMITTIVITY),
    **dict.fromkeys(("mu11", "mu33"), _PERMEABILITY),
    **dict.fromkeys(("g11", "g33"), _MAGNETOELECTRIC),
    "rho": _DENSITY,
    "pyroelectric": _PYROELECTRIC,
    "expansion": _EXPANSION,
    "conductivity": _CONDUCTIVITY,
    "heat_capacity": _HEAT_CAPACITY,
    **{name: {"Pa": _STRENGTH, "V m-1": _FIELD}[limit.units] for name, limit in LIMITS.items()},
}

#: Coupling, stiffness and permittivity or permeability of one effect.
_COUPLED = (
    ("e33", "c33", "eps33"), ("e15", "c44", "eps11"), ("e31", "c11", "eps33"),
    ("f33", "c33", "mu33"), ("f15", "c44", "mu11"), ("f31", "c11", "mu33"),
)  # fmt: skip


def question(name: str, values: float | Array, units: str) -> str:
    """Return a question about the first value whose size no material has, or an empty text."""
    usual, flat = USUAL[name], np.atleast_1d(values).ravel()
    size = np.abs(flat)
    odd = flat[((size < usual.low) & (size > 0)) | (size > usual.high)]
    if not odd.size:
        return ""
    value = float(odd[0])
    likely = (usual.above if abs(value) > usual.high else usual.below).format(value, value * usual.unit)
    meant = f"did you mean {likely}? " if likely else ""
    return (
        f"{name}: {value:g} {units} is of a size that no material has ({usual.low:g} to {usual.high:g}); "
        f"{meant}'{value:g} {units}', with its unit, is read as it stands"
    )


def questions(values: Mapping[str, Array], units: Mapping[str, str], bare: Collection[str]) -> dict[str, str]:
    """Return questions, by name, about ``bare`` constants whose size or coupling no material has."""
    texts = {name: text for name in bare if name in values and (text := question(name, values[name], units[name]))}
    for coupling, stiffness, store in _COUPLED:
        names = (coupling, stiffness, store)
        if any(name in bare for name in names) and all(name in values and name not in texts for name in names):
            e, c, eps = np.broadcast_arrays(*(values[name] for name in names))
            odd = np.flatnonzero(np.abs(e) > np.sqrt(_MOST_COUPLED) * np.sqrt(np.abs(c)) * np.sqrt(np.abs(eps)))
            if odd.size:
                sizes = [
                    f"{name} = {array.flat[odd[0]]:g} {units[name]}"
                    for name, array in zip(names, (e, c, eps), strict=True)
                ]
                texts |= dict.fromkeys(
                    names,
                    f"{sizes[0]} couples {sizes[1]} and {sizes[2]} more than any material does; did one of them lose "
                    "its unit? Numbers with a unit are read as they stand",
                )
    return texts
