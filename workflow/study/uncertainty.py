"""Uncertain constants of a study's materials: families that are scaled together, with priors of their sizes.

A family is scaled by exp(std z), z standard normal a priori, so that a material stays admissible. The prior standard
deviation is the difference of other published values, at least 5 %. An isotropic elastic material has Young's modulus,
and Poisson's ratio, to which 0.02 z is added. In a study of heat the constants for heat are uncertain as well.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver import Material, MaterialError, find
from solver.material.constants import UNITS, VACUUM_PERMEABILITY, VACUUM_PERMITTIVITY
from solver.names import MIXTURES
from solver.stack.layers import RIGID
from workflow.language.spelling import nearest
from workflow.study.model import Study
from workflow.study.reading import InputError

#: Constants that are scaled together, by the name of their family.
FAMILIES: dict[str, tuple[str, ...]] = {
    "stiffness": ("c11", "c12", "c13", "c33", "c44"),
    "piezoelectricity": ("e31", "e33", "e15"),
    "piezomagnetism": ("f31", "f33", "f15"),
    "permittivity": ("eps11", "eps33"),
    "magnetoelectricity": ("g11", "g33"),
    "permeability": ("mu11", "mu33"),
}
#: Prior standard deviation of the logarithm where no other values are published, and of Poisson's ratio.
USUAL, POISSON = 0.05, 0.02
#: The same for the constants for heat: conductivities and pyroelectric coefficients of a material differ by source.
HEAT = {"pyroelectric": 0.2, "conductivity": 0.2, "heat_capacity": USUAL, "expansion": USUAL}
#: Prior standard deviation of the logarithm of one constant beside its family, at least.
OWN = 0.03
_STEP = 0.1  # of difference quotients, in prior standard deviations: what they leave out is 1e-5 of a derivative
_WIDE = 0.3  # prior standard deviation from which the alternatives are solved: a first-order product would mislead
_MOST_OWN = 0.1  # of a scatter: variants that differ more are other materials
_ELASTIC = {"modulus": FAMILIES["stiffness"], "poisson": FAMILIES["stiffness"]}
_VACUUM = {"permittivity": VACUUM_PERMITTIVITY, "permeability": VACUUM_PERMEABILITY}
_KINDS = ("base", "material")


@dataclass(frozen=True)
class Constant:
    """Uncertain constant, or family of constants, of a material."""

    material: str  # name
    family: str  # a family of constants, ``modulus``, ``poisson``, or one constant
    std: float  # prior standard deviation: of the logarithm, of Poisson's ratio itself

    @property
    def name(self) -> str:
        """Name of the constant with its material."""
        return f"{self.material} {self.family}"

    @property
    def members(self) -> tuple[str, ...]:
        """Names of the constants of its family."""
        return (FAMILIES | _ELASTIC).get(self.family, (self.family,))

    @property
    def prior(self) -> str:
        """Prior in words."""
        return f"+-{self.std:g}" if self.family == "poisson" else f"+-{100 * self.std:.3g} %"

    def change(self, z: float) -> str:
        """Return the change by z prior standard deviations in words."""
        return f"{z * self.std:+.3g}" if self.family == "poisson" else f"{100 * np.expm1(z * self.std):+.3g} %"

    def moved(self, material: Material, z: float) -> Material:
        """Return the material with the constant moved by z; MaterialError if that is not admissible."""
        if self.family == "poisson":
            young, poisson = _engineering(material)
            other = Material.isotropic(young, poisson + self.std * z, name=material.name)
            changed: dict[str, Any] = {name: getattr(other, name) for name in FAMILIES["stiffness"]}
        elif self.family in HEAT:
            value = material.thermal[self.family]
            scaled = replace(value, value=value.value * float(np.exp(self.std * z)))
            changed = {"thermal": {**material.thermal, self.family: scaled}}
        else:
            changed = {name: getattr(material, name) * np.exp(self.std * z) for name in self.members}
        moved = replace(material, **changed, alternatives=())
        moved.check()
        return moved


def uncertain(study: Study, priors: Mapping[str, float | None] | None = None) -> list[Constant]:
    """Return the uncertain constants of a study, all or those of `priors`, with their standard deviations."""
    has_heat = "touch_temperature" in {*study.fixed_of_cases, *study.factors}
    constants = {name: _constants(name, find(name, study.own_materials), has_heat) for name in materials(study)}
    if not constants:
        raise InputError(f"{study.path}: no material whose constants could be uncertain")
    if priors is None:
        return [family for families in constants.values() for family in families]
    return [_asked(name, std, constants, study) for name, std in priors.items()]


def own(study: Study, constants: list[Constant]) -> list[Constant]:
    """Return the single constants of families, with priors of their deviation from the family."""
    singles, named = list[Constant](), {constant.name for constant in constants}
    for family in constants:
        material = find(family.material, study.own_materials)
        for name in members(material, family.family):
            single = Constant(family.material, name, _scatter(material, family.family))
            singles += [] if single.name in named else [single]
    return singles


def members(material: Material, family: str) -> list[str]:
    """Return the constants of a material that a family scales, if there are two or more."""
    values = {name: float(getattr(material, name)) for name in FAMILIES.get(family, ())}
    names = [name for name, value in values.items() if value not in (0.0, _VACUUM.get(family)) and value == value]
    return names if len(names) > 1 else []


def moved(study: Study, constants: list[Constant], z: NDArray[np.float64]) -> Study:
    """Return the study with constants moved by z, (k,), standard normal; MaterialError if no material is admissible."""
    changed: dict[str, Material] = {}
    for constant, value in zip(constants, z, strict=True):
        if value:
            start = changed.get(constant.material, find(constant.material, study.own_materials))
            changed[constant.material] = constant.moved(start, float(value))
    return study.with_materials(changed)


def sensitivities(
    study: Study, constants: list[Constant], values: Callable[[Study], NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Return relative changes of values by one prior standard deviation of each constant alone, (value, constant)."""
    nominal = values(study)
    shares = np.empty((len(nominal), len(constants)))
    for column, constant in enumerate(constants):
        with np.errstate(divide="ignore", invalid="ignore"):
            if constant.std > _WIDE and (alternatives := _alternatives(study, constant)):  # the largest change counts
                changes = np.stack([values(alternative) for alternative in alternatives]) / nominal - 1
                shares[:, column] = np.take_along_axis(changes, np.abs(changes).argmax(0)[None], 0)[0]
                continue
            step = _STEP if constant.std <= _WIDE else 1.0
            ends = [values(moved(study, [constant], np.array([z]))) for z in (step, -step)]
            shares[:, column] = (ends[0] - ends[1]) / (2 * step) / nominal
    shares[~np.isfinite(shares)] = np.nan
    return shares


def _alternatives(study: Study, constant: Constant) -> list[Study]:
    """Return the study with a family of each published alternative of its material that is admissible."""
    material = find(constant.material, study.own_materials)
    studies = []
    for variant in material.variants():
        pairs = {name: (getattr(material, name), getattr(variant, name)) for name in constant.members}
        changed: dict[str, Any] = {
            name: other for name, (value, other) in pairs.items() if value * other > 0 and value != other
        }
        with suppress(MaterialError):
            moved_material = replace(material, **changed, alternatives=())
            moved_material.check()
            studies += [study.with_materials({constant.material: moved_material})] if changed else []
    return studies


def concerned(study: Study, constant: Constant) -> dict[str, str]:
    """Return the categories that must be at a name for a constant to matter; none where it always does."""
    held = {kind: constant.material for kind in _KINDS if constant.material in study.categories.get(kind, [])}
    elsewhere = [*study.fixed.values(), *(layer.material for layer in study.body), *_phases(study)]
    return {} if constant.material in elsewhere or len(held) > 1 else held


def materials(study: Study) -> list[str]:
    """Return the names of the materials of a study's cases."""
    names: list[str] = [*_phases(study), *(layer.material for layer in study.body if layer.material)]
    names += [name for kind in _KINDS for name in study.names(kind)]
    return [name for name in dict.fromkeys(names) if name not in ("", RIGID)]


def _phases(study: Study) -> list[str]:
    """Return the phases if a composite consists of them."""
    composites: list[str | None] = [layer.composite for layer in study.body]
    if not study.body and "material" not in study.fixed and "material" not in study.categories:
        composites = [*study.names("composite", "fibrous")]
    return list(study.phases) if any(kind in MIXTURES for kind in composites) else []


def _constants(name: str, material: Material, has_heat: bool) -> list[Constant]:
    """Return the families of a material with constants other than zero and the vacuum's."""
    constants = [Constant(name, family, std) for family, std in HEAT.items() if has_heat and family in material.thermal]
    if _is_isotropic(material):
        stiffness = Constant(name, "modulus", _spread(material, FAMILIES["stiffness"]))
        return [stiffness, Constant(name, "poisson", POISSON), *constants]
    for family, names in FAMILIES.items():
        values = [float(getattr(material, key)) for key in names if not np.isnan(getattr(material, key))]
        if any(value not in (0.0, _VACUUM.get(family)) for value in values):
            constants.append(Constant(name, family, _spread(material, names)))
    return constants


def _asked(name: str, std: float | None, constants: Mapping[str, list[Constant]], study: Study) -> Constant:
    known = {family.name: family for families in constants.values() for family in families}
    if name not in known:
        material, _, constant = name.rpartition(" ")
        named_material = find(material, study.own_materials) if material in constants else None
        if (
            named_material is None
            or constant not in UNITS
            or constant == "rho"
            or float(getattr(named_material, constant)) in (0.0, np.nan)
        ):
            raise InputError(f"--uncertain: {name!r} is unknown; {nearest(name, list(known))}; or one constant, as e33")
        known[name] = Constant(material, constant, _spread(named_material, (constant,)))
    return known[name] if std is None else replace(known[name], std=std)


def _spread(material: Material, names: tuple[str, ...]) -> float:
    """Return the usual prior, or the largest mean logarithm by which published values of a family differ."""
    return max([USUAL, *(abs(float(np.mean(off))) for off in _differences(material, names) if off)])


def _scatter(material: Material, family: str) -> float:
    """Return the largest standard deviation of published logarithms about their family's mean, from 0.03 to 0.1."""
    differences = _differences(material, members(material, family))
    return min(max([OWN, *(float(np.std(off, ddof=1)) for off in differences if len(off) > 1)]), _MOST_OWN)


def _differences(material: Material, names: Sequence[str]) -> Iterator[list[float]]:
    """Yield logarithms of other published values over the material's own, for each variant; those of equal sign."""
    for variant in material.variants():
        pairs = [(float(getattr(variant, name)), float(getattr(material, name))) for name in names]
        yield [np.log(a / b) for a, b in pairs if a * b > 0]


def _is_isotropic(material: Material) -> bool:
    coupled = [getattr(material, name) for family in list(FAMILIES)[1:3] for name in FAMILIES[family]]
    pairs = [
        (material.c33, material.c11),
        (material.c13, material.c12),
        (2 * material.c44, material.c11 - material.c12),
    ]
    return not np.any(coupled) and all(np.isclose(a, b, rtol=1e-3) for a, b in pairs)


def _engineering(material: Material) -> tuple[float, float]:
    """Return Young's modulus and Poisson's ratio of an isotropic material."""
    poisson = float(material.c12 / (material.c11 + material.c12))
    return float(2 * material.c44 * (1 + poisson)), poisson
