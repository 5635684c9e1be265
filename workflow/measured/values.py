"""Model values for a measurement: from the solver and the constants of a material, nothing fitted."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

import solver
from solver import Material
from workflow.study.sections import ModelQuantity, ModelValue

Case = Mapping[str, float | str]
_ROUNDING = 1e-12  # relative difference that is none
_MORE = 10.0  # how many times the force, and charges per force, by which a response is compared


@dataclass(frozen=True)
class Spread:
    """A value of the model, and how far other published constants of the material move it."""

    value: float  # By the material's own constants, SI
    deviation: float  # Largest difference that an alternative set of constants makes, taken as a standard deviation
    sets: int  # Number of the alternative sets


def modelled(entry: ModelValue) -> Spread:
    """The model's value and its spread over the material's published alternatives."""
    material = solver.find(str(entry.case["material"]))
    answer = _ANSWERS[entry.quantity]
    nominal, *others = (answer(variant, entry.case) for variant in (material, *material.variants()))
    moved = max((abs(other - nominal) for other in others), default=0.0)
    return Spread(nominal, moved if moved > _ROUNDING * abs(nominal) else 0.0, len(others))


def _solved(material: Material, case: Case, **changed: float) -> xr.Dataset:
    return solver.solve({**case, **changed, "material": material})


def _charge_per_force(material: Material, case: Case) -> float:
    """Charge under a punch at zero volts over its force (real contacts, section 3: r_1 of a half-space)."""
    return abs(float(_solved(material, case)["charge_per_force"]))


def _clamped_d33(material: Material, _: Case) -> float:
    """e33 / c33: full electrodes, no strain along the film."""
    return abs(float(material.e33 / material.c33))


def _free_d33(material: Material, _: Case) -> float:
    """d33 of a body free of stress along the electrodes: e = d c, for e31 and e33."""
    stiffness = [[material.c11 + material.c12, material.c13], [2 * material.c13, material.c33]]
    return abs(float(np.linalg.solve(np.array(stiffness), np.array([material.e31, material.e33]))[1]))


def _indentation_exponent(material: Material, case: Case) -> float:
    """d log P / d log depth, at zero volts where the punch conducts."""
    at_rest = _solved(material, case)
    if "charge_per_force" in at_rest:
        charge = float(at_rest["charge_per_force"]) * float(case["force"])
        at_rest = _solved(material, case, total_charge=charge)
    return float(at_rest["contact_stiffness"] * at_rest["depth"]) / float(case["force"])


def _response_under_load(material: Material, case: Case) -> float:
    """Stroke per volt at ten times the force, over that at the force."""
    forces = (float(case["force"]), _MORE * float(case["force"]))
    low, high = (float(_solved(material, case, force=force)["stroke_per_volt"]) for force in forces)
    return high / low


def _stiffness_under_charge(material: Material, case: Case) -> float:
    """Contact stiffness of a charged punch over that of one at zero charge."""
    charge = _MORE * _charge_per_force(material, case) * float(case["force"])
    low, high = (float(_solved(material, case, total_charge=total)["contact_stiffness"]) for total in (0.0, charge))
    return high / low


def _layer_factor(material: Material, case: Case) -> float:
    """P (1 - nu) / (4 G a d) of a disc on an isotropic layer (Hayes et al. 1972)."""
    solved = _solved(material, case)
    poisson = float(material.c12 / (material.c11 + material.c12))
    size = 4 * float(material.c44) * float(solved["contact_radius"] * solved["depth"])
    return float(case["force"]) * (1 - poisson) / size


_ANSWERS: dict[ModelQuantity, Callable[[Material, Case], float]] = {
    "charge_per_force": _charge_per_force,
    "clamped_d33": _clamped_d33,
    "free_d33": _free_d33,
    "indentation_exponent": _indentation_exponent,
    "response_under_load": _response_under_load,
    "stiffness_under_charge": _stiffness_under_charge,
    "layer_factor": _layer_factor,
}
