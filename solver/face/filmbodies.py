"""Which film every case lies on, by factors or as a stack: told apart by numbers, made of layers."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, BoolArray
from solver.face.cases import Cases
from solver.face.filmfactors import absent
from solver.face.materials import base_of, material_of, phases_of
from solver.face.refusal import FactorError
from solver.film.powerlaw import Constants, PowerLaw, constants_of
from solver.film.stack import Stack
from solver.film.windows import Coat
from solver.material.constants import UNITS, Material
from solver.names import CHOICES, MIXTURES

_UNGRADED = -1.0
_HALF_LENGTH = 10**0.25  # of half-planes over the thickness: the middle of a window
_INTERFACES = ("interface_electric", "interface_magnetic")

Film = tuple[tuple[Coat, ...], Constants | None]


class Bodies(Protocol):
    """Films, told apart by numbers, whose top layer has a thickness [m] over the case axes."""

    thickness: Array

    @property
    def columns(self) -> list[Array]:
        """Numbers that tell films apart, each over the case axes."""

    def film(self, row: Sequence[float]) -> Film:
        """The layers, the top one of unit thickness, and the base, of one row of the columns."""

    @property
    def lacks_c12(self) -> str | None:
        """The name of a material without c12."""


class ByFactors:
    """Single films: a material or a composite, perhaps graded, on a base.

    Raises
    ------
    FactorError, MaterialError
        A material or a base that is unknown or inadmissible.
    """

    def __init__(self, cases: Cases) -> None:
        self._cases = cases
        self._material, (self._base, self._rigid) = material_of(cases), base_of(cases)
        self.thickness: Array = cases.values["thickness"]

    @property
    def columns(self) -> list[Array]:
        """Numbers that tell films apart, each over the case axes."""
        values = self._cases.values
        graded = values.get("base_volume_fraction", np.array(np.nan))
        there = ~np.isnan(graded)
        kind = values.get("composite", np.array(CHOICES["composite"][0]))
        mixture = np.select([kind == name for name in MIXTURES], range(len(MIXTURES)), len(MIXTURES))
        exponent = np.nan_to_num(values.get("grading_exponent", np.array(np.nan)), nan=1.0)
        return [
            *_known(self._cases, self._material),
            *(np.where(self._rigid, 0.0, constant) for constant in _known(self._cases, self._base)),
            self._rigid,
            *(self._interface(name) for name in _INTERFACES),
            np.where(there, graded, _UNGRADED),
            np.where(there, values.get("volume_fraction", np.array(0.0)), _UNGRADED),
            np.where(there, mixture, _UNGRADED),
            np.where(there, exponent, _UNGRADED),
        ]

    def film(self, row: Sequence[float]) -> Film:
        """The layers, the top one of unit thickness, and the base, of one row of the columns."""
        count = len(UNITS) + 1  # and whether it is a conductor
        rigid, electric, magnetic, lowest, surface, kind, exponent = row[2 * count :]
        of: Constants | PowerLaw = _constants(row[:count])
        if lowest != _UNGRADED:
            one, two = (constants_of(phase) for phase in phases_of(self._cases))
            if kind >= len(MIXTURES):
                raise FactorError(f"base_volume_fraction: {lowest:g} of a composite that has no volume_fraction")
            of = PowerLaw(MIXTURES[int(kind)], (one, two), surface, lowest, exponent)
        interfaces = (
            None if code < 0 else CHOICES[name][int(code)]
            for name, code in zip(_INTERFACES, (electric, magnetic), strict=True)
        )
        return (Coat(of, 1.0, *interfaces),), None if rigid else _constants(row[count : 2 * count])

    @property
    def lacks_c12(self) -> str | None:
        """The name of a material without c12, of films and of bases that are not rigid."""
        return _lacking([(self._material, np.array(True)), (self._base, ~self._rigid)])

    def _interface(self, name: str) -> Array:
        """What the interface is to a field: the place among the choices, -1 for the default of its base."""
        values = self._cases.values.get(name, np.array(None, dtype=object))
        codes = [-1.0 if absent(value) else CHOICES[name].index(str(value)) for value in values.flat]
        return np.array(codes).reshape(values.shape)


class ByStack:
    """Films given as :class:`solver.Stack`."""

    def __init__(self, cases: Cases) -> None:
        which = cases.values["body"]
        self._stacks: list[Stack] = list(dict.fromkeys(which.flat))
        films = [_over_the_top(stack) for stack in self._stacks]
        self._films = list(dict.fromkeys(films))  # those that differ in size alone share tables
        number = {film: place for place, film in enumerate(self._films)}
        place = {stack: number[film] for stack, film in zip(self._stacks, films, strict=True)}
        top = {stack: stack.top.thickness for stack in self._stacks}
        self._number: NDArray[np.intp] = np.array([place[stack] for stack in which.flat]).reshape(which.shape)
        self.thickness: Array = np.array([top[stack] for stack in which.flat]).reshape(which.shape)

    @property
    def columns(self) -> list[Array]:
        """Numbers that tell films apart, each over the case axes."""
        return [np.asarray(self._number, dtype=np.float64)]

    def film(self, row: Sequence[float]) -> Film:
        """The layers, the top one of unit thickness, and the base, of one row of the columns."""
        return self._films[int(row[0])]

    @property
    def lacks_c12(self) -> str | None:
        """The name of a material without c12, of layers and of bases that are not rigid."""
        bodies = [layer.material for stack in self._stacks for layer in stack.layers]
        bodies += [stack.base for stack in self._stacks if not isinstance(stack.base, str)]
        return _lacking([(body, np.array(True)) for body in bodies])


def _over_the_top(stack: Stack) -> Film:
    """A stack's layers, lengths over the top one's thickness, and its base."""
    layers = tuple(Coat.like(layer, stack.top.thickness) for layer in stack.layers)
    return layers, None if isinstance(stack.base, str) else constants_of(stack.base)


class HalfPlanes:
    """Half-planes as films bonded to their own material: of any thickness, which the contact is given in proportion to.

    All lie in the middle of one window of half-lengths, whatever their punch and load.
    """

    def __init__(self, cases: Cases, material: Material, half_length: Array) -> None:
        self._cases, self._material = cases, material
        self.thickness: Array = half_length / _HALF_LENGTH

    @property
    def columns(self) -> list[Array]:
        """Numbers that tell films apart, each over the case axes."""
        return _known(self._cases, self._material)

    def film(self, row: Sequence[float]) -> Film:
        """The layers, the top one of unit thickness, and the base, of one row of the columns."""
        of = (*_constants(row)[:-1], 0.0)  # the closed form knows no conductors
        return (Coat(of, 1.0, "bonded", "bonded"),), of

    @property
    def lacks_c12(self) -> str | None:
        """The name of a material without c12."""
        return _lacking([(self._material, np.array(True))])


def films_of(cases: Cases) -> Bodies:
    """The films of cases that are all on films."""
    return ByStack(cases) if "body" in cases.values else ByFactors(cases)


def refuse_charge(cases: Cases) -> None:
    """Refuse an electric charge of a punch on a metal, which is not the punch's to keep.

    Raises
    ------
    FactorError
        Naming the charge.
    """
    name = cases.kind.loads.charges[0]
    if np.any(charge := cases.number(name)):
        raise FactorError(
            f"{name}: {charge[charge != 0].flat[0]:g} of a punch on an electrode, which takes it; must be 0"
        )


def _known(cases: Cases, material: Material) -> list[Array]:
    """Constants by case, infinite where unknown, and conductors; the density of what rests has no part."""
    moving = cases.number("speed") > 0
    known = {key: np.nan_to_num(getattr(material, key), nan=np.inf) for key in UNITS}
    constants = [np.where(moving, value, np.inf) if key == "rho" else value for key, value in known.items()]
    return [*constants, material.conductor.astype(np.float64)]


def _constants(row: Sequence[float]) -> Constants:
    """Constants in the order of ``UNITS``, None where unknown, and whether it is a conductor."""
    return tuple(None if np.isinf(value) else value for value in row)


def _lacking(bodies: Sequence[tuple[Material, BoolArray]]) -> str | None:
    return next((m.name for m, there in bodies if np.any(np.isnan(m.c12) & there)), None)
