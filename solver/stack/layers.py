"""Layers on a base: materials, thicknesses, and the electric and magnetic conditions of the interfaces."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Literal

import numpy as np

from solver.arrays import Array, is_finite
from solver.material.constants import VACUUM_PERMEABILITY, Material, MaterialError
from solver.material.library import find
from solver.stack.fourier import Medium
from solver.units import in_si

RIGID: Literal["rigid"] = "rigid"

#: Conditions of an interface for each field: at zero potential, transparent, or without normal induction.
CONDITIONS: dict[str, tuple[str, ...]] = {
    "electric": ("grounded", "bonded"),
    "magnetic": ("grounded", "bonded", "insulated"),
}


class StackError(MaterialError):
    """A layer, a base or an interface that is malformed or not allowed."""


@dataclass(frozen=True, eq=False, init=False)
class Layer:
    """A homogeneous layer and the interface below it.

    Parameters
    ----------
    material
        An admissible material without case axes, or the name of a built-in one.
    thickness
        Thickness > 0 [m], or with its unit, as ``"20 um"``.
    electric
        ``grounded`` (a thin electrode at phi = 0) or ``bonded`` (phi and D_y continuous). By default grounded above
        the base and bonded between layers; above a rigid base it is grounded, and so it is beside a conductor.
    magnetic
        ``grounded`` (psi = 0), ``bonded``, or ``insulated`` (B_y = 0; above a rigid base only). By default grounded
        above a rigid base and bonded elsewhere.

    Raises
    ------
    StackError
        Naming the entry, its value and what is allowed.

    Examples
    --------
    >>> import solver
    >>> Layer(solver.find("PZT-4"), 2e-4, electric="grounded").thickness
    0.0002
    >>> Layer("copper", "20 um").thickness
    2e-05
    """

    material: Material
    thickness: float
    electric: str | None = None
    magnetic: str | None = None

    def __init__(
        self,
        material: Material | str,
        thickness: float | str,
        electric: str | None = None,
        magnetic: str | None = None,
    ) -> None:
        try:
            metres = in_si(thickness, "m") if isinstance(thickness, str) else thickness
        except ValueError as error:
            raise StackError(f"thickness: {error}") from None
        values = {
            "material": find(material) if isinstance(material, str) else material,
            "thickness": metres,
            "electric": electric,
            "magnetic": magnetic,
        }
        for name, entry in values.items():
            object.__setattr__(self, name, entry)
        if not is_finite(self.thickness) or not self.thickness > 0:
            raise StackError(f"thickness: {self.thickness!r} is not allowed; a finite number > 0 [m]")
        _require_single(self.material, "material")
        for name, allowed in CONDITIONS.items():
            value = getattr(self, name)
            if value is not None and value not in allowed:
                raise StackError(f"interface_{name}: {value!r} is unknown; allowed are {', '.join(allowed)}")


@dataclass(frozen=True, eq=False)
class Stack:
    """Layers, the top one first, on a base; stacks of equal content are equal.

    Parameters
    ----------
    layers
        At least one.
    base
        ``rigid`` (u = 0, phi = 0, bonded) or the material of the half-plane below, or its name.
    electroded
        Whether the surface is a grounded electrode without stiffness, which the punch then presses.

    Examples
    --------
    >>> import solver
    >>> titanate = Layer(solver.find("BaTiO3"), 0.5e-3, electric="grounded")  # a metal conducts
    >>> film = Stack([titanate, Layer("copper", "0.1 mm")], "silicon")
    >>> film.name, len(film.materials)
    ('BaTiO3 0.0005 m | copper 0.0001 m | silicon', 3)
    >>> film.top.material.name, round(film.thickness, 6), film.rigid, film.insulated, film.above_ground
    ('BaTiO3', 0.0006, False, False, 1.0)
    >>> round(float(solver.solve({"body": film, "radius": 0.05, "load": 1e4})["voltage"]), 2)
    -53.72

    Raises
    ------
    StackError
        No layer, an unknown base, or an interface that its base does not have.
    """

    layers: Sequence[Layer]
    base: Material | str = RIGID
    electroded: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "layers", tuple(self.layers))
        if not self.layers:
            raise StackError("layers: none; a stack has at least one layer")
        if isinstance(self.base, str) and self.base != RIGID:
            try:
                object.__setattr__(self, "base", find(self.base))
            except MaterialError as error:
                raise StackError(f"base: {error}") from None
        if not isinstance(self.base, str):
            _require_single(self.base, "base")
        *upper, lowest = self.layers
        for layer in upper:
            if layer.magnetic == "insulated":
                raise StackError("interface_magnetic: 'insulated' is allowed above a rigid base only")
        if self.rigid:
            if lowest.electric == "bonded":
                raise StackError("interface_electric: 'bonded' is not allowed above a rigid base: it is grounded")
            if lowest.magnetic == "bonded":
                raise StackError("interface_magnetic: 'bonded' is not allowed above a rigid base; grounded, insulated")
        elif lowest.magnetic == "insulated":
            raise StackError("interface_magnetic: 'insulated' is allowed above a rigid base only; grounded, bonded")

    @cached_property
    def _content(self) -> tuple[object, ...]:
        layers = ((layer.thickness, layer.electric, layer.magnetic) for layer in self.layers)
        values = (getattr(material, field.name) for material in self.materials for field in fields(material))
        contents = (value.tobytes() if isinstance(value, np.ndarray) else str(value) for value in values)
        return self.electroded, self.rigid, *layers, *contents

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Stack) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)

    @property
    def name(self) -> str:
        """Materials and thicknesses in words, as ``"PZT-4 0.0002 m | rigid"``."""
        base = self.base if isinstance(self.base, str) else self.base.name
        return " | ".join([*(f"{layer.material.name} {layer.thickness:g} m" for layer in self.layers), base])

    @property
    def rigid(self) -> bool:
        """True if the base is rigid."""
        return isinstance(self.base, str)

    @property
    def top(self) -> Layer:
        """The layer under the punch."""
        return self.layers[0]

    @property
    def thickness(self) -> float:
        """H: thickness of all layers [m]."""
        return float(sum(layer.thickness for layer in self.layers))

    @property
    def materials(self) -> list[Material]:
        """Materials of the layers, and of an elastic base last."""
        return [layer.material for layer in self.layers] + ([] if isinstance(self.base, str) else [self.base])

    @property
    def above_ground(self) -> float:
        """Thickness above the first grounded electrode, or of all layers, over that of the top layer."""
        above = next((count for count, components in enumerate(self.grounded, 1) if 2 in components), len(self.layers))
        return sum(layer.thickness for layer in self.layers[:above]) / self.top.thickness

    @property
    def insulated(self) -> bool:
        """True if B_y = 0 on a rigid base, so that all magnetic flux leaves sideways."""
        return self.rigid and self.layers[-1].magnetic == "insulated"

    @cached_property
    def conductors(self) -> tuple[bool, ...]:
        """True for each layer, and the base last, that is a conductor; its potential is zero at all k but 0."""
        return (*(bool(material.conductor) for material in self.materials), *([False] if self.rigid else []))

    @cached_property
    def grounded(self) -> tuple[tuple[int, ...], ...]:
        """Components (2: phi, 3: psi) held at zero by the interface below each layer."""
        last = len(self.layers) - 1
        metal = self.conductors
        grounded = []
        for number, layer in enumerate(self.layers):
            electric = layer.electric or ("grounded" if number == last else "bonded")
            electric = "grounded" if metal[number] or metal[number + 1] else electric
            magnetic = layer.magnetic or ("grounded" if number == last and self.rigid else "bonded")
            grounded.append(tuple(c for c, kind in ((2, electric), (3, magnetic)) if kind == "grounded"))
        return tuple(grounded)

    @cached_property
    def scale(self) -> Array:
        """Units of the stack, those of its top layer; (4,)."""
        return Medium(self.top.material, np.ones(4)).halfplane.scale

    @cached_property
    def media(self) -> tuple[Medium, ...]:
        """The layers' materials in the units of the stack."""
        return tuple(Medium(layer.material, self.scale) for layer in self.layers)

    @cached_property
    def base_medium(self) -> Medium | None:
        """The base's material in the units of the stack, None if the base is rigid."""
        base = self.base
        if isinstance(base, str):
            return None
        if base.conductor and 3 in self.grounded[-1] and not (base.f31 or base.f33 or base.f15):
            vacuum = np.array(VACUUM_PERMEABILITY)  # no flux gets there: its permeability must not change any bit
            base = replace(base, mu11=vacuum, mu33=vacuum)
        return Medium(base, self.scale)


def _require_single(material: object, name: str) -> None:
    """Refuse what is not an admissible material without case axes."""
    if not isinstance(material, Material):
        raise StackError(f"{name}: {material!r} is not a Material")
    if material.shape:
        raise StackError(f"{name}: {material.name} has case axes {material.shape}; a stack has one material a layer")
    material.check()
