"""Layers of cases: the stack of one case from its factors, and the distinct films of many cases."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, distinct_rows
from solver.cache import cached
from solver.face.cases import Cases, factorized
from solver.face.factorvalues import absent
from solver.face.materials import one_material, one_of_case
from solver.face.refusal import FactorError
from solver.material.constants import Material, MaterialError, combined
from solver.names import BODY, CHOICES, MIXTURES, OF_A_FILM, OF_MATERIAL
from solver.stack.layers import RIGID, Layer, Stack

#: Number of homogeneous layers of equal thickness that approximate a graded film.
SUBLAYERS = 12
#: Factors of the stack of a case, without the thickness of a film.
OF_A_STACK = (BODY, *OF_MATERIAL, "cut", "cut_angle", *OF_A_FILM[1:], "electrode")


def stack_of(
    case: Mapping[str, Any],
    materials: Mapping[str, Material] = MappingProxyType({}),
    phases: Sequence[str | Material] = ("BaTiO3", "CoFe2O4"),
) -> Stack:
    """Return layers and base of a case of single factors, with layers of 1 m if it has no thickness."""
    case = {name: value for name, value in case.items() if not absent(value)}
    electroded = case.get("electrode") == "top"
    if BODY in case:
        body: Stack = case[BODY]
        return replace(body, electroded=electroded)
    material = one_of_case(case, materials, phases)
    if not {"base", "base_modulus"} & case.keys():  # a half-plane is a layer bonded to its own material
        bulk = replace(material, conductor=np.array(False))  # the closed form has no conductors
        return Stack([Layer(bulk, 1.0, "bonded", "bonded")], bulk)
    sublayers = _graded(case, materials, phases) if "base_volume_fraction" in case else [material]
    thickness = float(case.get("thickness", len(sublayers))) / len(sublayers)
    upper = [Layer(layer, thickness, "bonded", "bonded") for layer in sublayers[:-1]]
    interfaces = (case.get("interface_electric"), case.get("interface_magnetic"))
    return Stack([*upper, Layer(sublayers[-1], thickness, *interfaces)], _base(case, materials), electroded)


def _graded(
    case: Mapping[str, Any], materials: Mapping[str, Material], phases: Sequence[str | Material]
) -> list[Material]:
    """Return the materials of the sublayers of a graded film, from the surface down."""
    kind, lowest = str(case.get("composite", CHOICES["composite"][0])), float(case["base_volume_fraction"])
    if kind not in MIXTURES:
        raise FactorError(f"base_volume_fraction: {lowest:g} of a composite that has no volume_fraction")
    surface, depths = float(case["volume_fraction"]), (np.arange(SUBLAYERS) + 0.5) / SUBLAYERS
    fractions = surface + (lowest - surface) * depths ** float(case.get("grading_exponent", 1.0))
    return [one_of_case({**case, "volume_fraction": fraction}, materials, phases) for fraction in fractions.tolist()]


def _base(case: Mapping[str, Any], materials: Mapping[str, Material]) -> Material | str:
    """Return the base of a case: rigid, by name, or by modulus."""
    if "base" not in case:
        name = "a base by its modulus"
        return Material.isotropic(case["base_modulus"], case["base_poisson"], name=name, any_size=True)
    if case["base"] == RIGID:
        return RIGID
    try:
        return one_material("base", case["base"], materials)
    except MaterialError as error:
        _, _, reason = str(error).partition("material: ")
        also = f", {RIGID}" if "known are" in reason else ""
        raise FactorError(f"base: {reason}{also}" if reason else f"base: {error}") from None


@dataclass(frozen=True, eq=False)
class Bodies:
    """Films of cases."""

    films: list[Stack]  # Distinct films, whose top layers have unit thickness
    which: Indices  # Film of each case; over the case axes
    thickness: Array  # Thickness of the top layers [m]; over the case axes
    lacks_c12: str | None  # Name of a material of layers or bases without c12


def stacks_of(cases: Cases) -> tuple[list[Stack], Indices]:
    """Return the distinct stacks of cases, single films with layers of 1 m, and the index of each case's (...)."""
    columns = {name: factorized(cases.values[name]) for name in OF_A_STACK if name in cases.values}
    codes = np.broadcast_arrays(*(codes.reshape(cases.values[name].shape) for name, (codes, _) in columns.items()))
    rows, which = distinct_rows(np.stack(codes, -1).reshape(-1, len(columns)))
    stacks = []
    for row in rows.tolist():
        case = {name: values[code] for (name, (_, values)), code in zip(columns.items(), row, strict=True)}
        stacks.append(stack_of(case, cases.materials, cases.phases))
    return stacks, which.reshape(codes[0].shape)


def films_of(cases: Cases) -> Bodies:
    """Return the films of cases; films that differ in size alone are one."""
    stacks, which = stacks_of(cases)
    lacks = (m.name for stack in stacks for m in stack.materials if np.isnan(m.c12))
    number: dict[Stack, int] = {}
    film_index = np.array([number.setdefault(_over_the_top(stack), len(number)) for stack in stacks])
    if BODY in cases.values:
        thickness = np.array([stack.top.thickness for stack in stacks])[which]
    else:
        thickness = cases.number("thickness") / np.array([len(stack.layers) for stack in stacks])[which]
    return Bodies(list(number), film_index[which], thickness, next(lacks, None))


@cached
def _over_the_top(stack: Stack) -> Stack:
    """Return a stack with lengths over its top layer's thickness, of bare constants without the density."""
    materials = [replace(combined(np.asarray, [m], "film"), rho=np.array(np.nan)) for m in stack.materials]
    layers = [
        replace(layer, material=material, thickness=layer.thickness / stack.top.thickness)
        for layer, material in zip(stack.layers, materials, strict=False)
    ]
    return Stack(layers, RIGID if stack.rigid else materials[-1], stack.electroded)


def refuse_charge(cases: Cases) -> None:
    """Refuse an electric charge of a punch on a metal or an electrode, which takes it."""
    name = cases.kind.loads.charges[0]
    if np.any(charge := cases.number(name)):
        raise FactorError(
            f"{name}: {charge[charge != 0].flat[0]:g} of a punch on an electrode, which takes it; must be 0"
        )
