"""Material constants of theory section 7, in SI units, for the tests of the oracles."""

ELECTRIC = ("e31", "e33", "e15", "g11", "g33")
MAGNETIC = ("f31", "f33", "f15")
SIH_SONG = {"c11": 226e9, "c13": 124e9, "c33": 216e9, "c44": 44e9, "e31": -2.2, "e33": 9.3, "e15": 5.8, "f31": 290.2}
SIH_SONG |= {"f33": 350.0, "f15": 275.0, "eps11": 5.64e-9, "eps33": 6.35e-9, "g11": 5.367e-12, "g33": 2.7375e-9}
SIH_SONG |= {"mu11": 297e-6, "mu33": 83.5e-6, "rho": 5550.0}
BARIUM_TITANATE = {"c11": 166e9, "c13": 78e9, "c33": 162e9, "c44": 43e9, "e31": -4.4, "e33": 18.6, "e15": 11.6}
BARIUM_TITANATE |= {"eps11": 11.2e-9, "eps33": 12.6e-9, "mu11": 5e-6, "mu33": 10e-6, "g11": 0.0, "g33": 0.0}
BARIUM_TITANATE |= dict.fromkeys(MAGNETIC, 0.0)
COBALT_FERRITE = {"c11": 286e9, "c13": 170.5e9, "c33": 269.5e9, "c44": 45.3e9, "f31": 580.3, "f33": 699.7, "f15": 550.0}
COBALT_FERRITE |= {"eps11": 0.08e-9, "eps33": 0.093e-9, "mu11": 590e-6, "mu33": 157e-6}
COBALT_FERRITE |= dict.fromkeys(ELECTRIC, 0.0)


def isotropic(young: float, poisson: float) -> dict[str, float]:
    """Plane constants of an isotropic elastic material [Pa]."""
    shear = young / (2 * (1 + poisson))
    lame = 2 * shear * poisson / (1 - 2 * poisson)
    constants = {"c11": lame + 2 * shear, "c13": lame, "c33": lame + 2 * shear, "c44": shear}
    constants |= {"eps11": 1e-10, "eps33": 1e-10, "mu11": 1e-6, "mu33": 1e-6}
    return constants | dict.fromkeys((*ELECTRIC, *MAGNETIC), 0.0)
