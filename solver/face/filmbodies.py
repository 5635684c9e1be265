"""Film below every case, from factors or a stack; rows of numbers identify equal films."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from solver.arrays import Array, BoolArray
from solver.cache import cached
from solver.face.cases import Cases
from solver.face.factorvalues import absent
from solver.face.materials import base_of, material_of, phases_of
from solver.face.refusal import FactorError
from solver.material.composite import compose
from solver.material.constants import ANY_SIZE, UNITS, Material, combined
from solver.names import BODY, CHOICES, MIXTURES
from solver.stack.layers import RIGID, Layer, Stack

#: Homogeneous layers of equal thickness that stand for a graded film.
SUBLAYERS = 12
_UNGRADED = -1.0
_HALF_LENGTH = 10**0.25  # of half-planes over the thickness: the middle of a window
_INTERFACES = ("interface_electric", "interface_magnetic")


@dataclass(frozen=True, eq=False)
class Bodies:
    """Films, told apart by numbers."""

    thickness: Array  # Of the top layer [m], over the case axes
    columns: list[Array]  # Numbers that tell films apart, each over the case axes
    # From one row of the columns, and whether an electrode lies on top; the top layer of unit thickness
    film: Callable[[tuple[float, ...], bool], Stack]
    lacks_c12: str | None  # The name of a material without c12, of layers and of bases that are not rigid


def films_of(cases: Cases) -> Bodies:
    """The films of cases that are all on films."""
    return _by_stack(cases) if BODY in cases.values else _by_factors(cases)


def _by_factors(cases: Cases) -> Bodies:
    """Single films: a material or a composite, perhaps graded, on a base."""
    values = cases.values
    material, (base, rigid) = material_of(cases), base_of(cases)
    graded = values.get("base_volume_fraction", np.array(np.nan))
    is_graded = ~np.isnan(graded)
    kind = values.get("composite", np.array(CHOICES["composite"][0]))
    mixture = np.select([kind == name for name in MIXTURES], range(len(MIXTURES)), len(MIXTURES))
    exponent = np.nan_to_num(values.get("grading_exponent", np.array(np.nan)), nan=1.0)
    columns = [
        *known_constants(material),
        *(np.where(rigid, 0.0, constant) for constant in known_constants(base)),
        rigid,
        *(_interface(cases, name) for name in _INTERFACES),
        np.where(is_graded, graded, _UNGRADED),
        np.where(is_graded, values.get("volume_fraction", np.array(0.0)), _UNGRADED),
        np.where(is_graded, mixture, _UNGRADED),
        np.where(is_graded, exponent, _UNGRADED),
    ]
    lacks = _lacking([(material, np.array(True)), (base, ~rigid)])
    thickness = np.where(is_graded, values["thickness"] / SUBLAYERS, values["thickness"])
    phases = phases_of(cases) if np.any(is_graded) else ()
    return Bodies(thickness, columns, lambda row, electroded: _film(row, phases, electroded), lacks)


@cached
def _film(row: tuple[float, ...], phases: Sequence[Material], electroded: bool) -> Stack:
    """One of the films by factors."""
    count = len(UNITS) + 1  # and whether it is a conductor
    rigid, electric, magnetic, lowest, surface, kind, exponent = row[2 * count :]
    materials = [_material(row[:count], "film")]
    if lowest != _UNGRADED:
        if kind >= len(MIXTURES):
            raise FactorError(f"base_volume_fraction: {lowest:g} of a composite that has no volume_fraction")
        depths = (np.arange(SUBLAYERS) + 0.5) / SUBLAYERS
        fractions = (surface + (lowest - surface) * depths**exponent).tolist()
        materials = [compose(MIXTURES[int(kind)], phases, fraction) for fraction in fractions]
    upper = [Layer(material, 1.0, "bonded", "bonded") for material in materials[:-1]]
    interfaces = (
        None if code < 0 else CHOICES[name][int(code)]
        for name, code in zip(_INTERFACES, (electric, magnetic), strict=True)
    )
    base = RIGID if rigid else _material(row[count : 2 * count], "base")
    return Stack([*upper, Layer(materials[-1], 1.0, *interfaces)], base, electroded)


def _interface(cases: Cases, name: str) -> Array:
    """Index of an interface's condition for a field among the choices; -1 for the default of its base."""
    values = cases.values.get(name, np.array(None, dtype=object))
    codes = [-1.0 if absent(value) else CHOICES[name].index(str(value)) for value in values.flat]
    return np.array(codes).reshape(values.shape)


def _by_stack(cases: Cases) -> Bodies:
    """Films given as :class:`solver.Stack`; those that differ in size alone share tables."""
    which = cases.values[BODY]
    stacks = {stack: _over_the_top(stack) for stack in dict.fromkeys(which.flat)}
    films = list(dict.fromkeys(stacks.values()))
    number = {film: float(place) for place, film in enumerate(films)}

    def of_cases(values: Mapping[Stack, float]) -> Array:
        return np.array([values[stack] for stack in which.flat]).reshape(which.shape)

    thickness = of_cases({stack: stack.top.thickness for stack in stacks})
    columns = [of_cases({stack: number[film] for stack, film in stacks.items()})]
    lacks = _lacking([(material, np.array(True)) for stack in stacks for material in stack.materials])
    return Bodies(thickness, columns, lambda row, electroded: replace(films[int(row[0])], electroded=electroded), lacks)


def _over_the_top(stack: Stack) -> Stack:
    """A stack with lengths over the thickness of its top layer, of bare constants."""
    materials = [combined(np.asarray, [material], "film") for material in stack.materials]
    layers = [
        replace(layer, material=material, thickness=layer.thickness / stack.top.thickness)
        for layer, material in zip(stack.layers, materials, strict=False)
    ]
    return Stack(layers, RIGID if stack.rigid else materials[-1])


def half_planes(material: Material, half_length: Array) -> Bodies:
    """Half-planes as films bonded to their own material: of any thickness, which the contact is given in proportion to.

    All lie in the middle of one window of half-lengths, whatever their punch and load.
    """

    def film(row: tuple[float, ...], electroded: bool) -> Stack:
        bulk = _material([*row[:-1], 0.0], "film")  # the closed form knows no conductors
        return Stack([Layer(bulk, 1.0, "bonded", "bonded")], bulk, electroded)

    lacks = _lacking([(material, np.array(True))])
    return Bodies(half_length / _HALF_LENGTH, known_constants(material), film, lacks)


def refuse_charge(cases: Cases) -> None:
    """Refuse an electric charge of a punch on a metal, which is not the punch's to keep."""
    name = cases.kind.loads.charges[0]
    if np.any(charge := cases.number(name)):
        raise FactorError(
            f"{name}: {charge[charge != 0].flat[0]:g} of a punch on an electrode, which takes it; must be 0"
        )


def known_constants(material: Material) -> list[Array]:
    """Constants by case, infinite where unknown, and conductors; the density of what rests has no part."""
    constants = [
        np.array(np.inf) if key == "rho" else np.nan_to_num(getattr(material, key), nan=np.inf) for key in UNITS
    ]
    return [*constants, material.conductor.astype(np.float64)]


def _material(row: Sequence[float], name: str) -> Material:
    """Material of constants in the order of ``UNITS``, infinite where unknown, and of whether it is a conductor."""
    values = np.where(np.isinf(row), np.nan, row)
    constants: dict[str, Any] = dict(zip((*UNITS, "conductor"), values, strict=True))
    return Material(**constants, name=name, any_size=ANY_SIZE)


def _lacking(bodies: Sequence[tuple[Material, BoolArray]]) -> str | None:
    return next((m.name for m, used in bodies if np.any(np.isnan(m.c12) & used)), None)
