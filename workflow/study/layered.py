"""A study's body of several layers, and the solver's stacks for values of the factors that it names."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, Self

import numpy as np
import xarray as xr
from pydantic import Field, model_validator

from solver import Layer, Material, MaterialError, Stack, find
from solver.material.composite import compose
from solver.names import BODY, COMPOSITES
from solver.stack.layers import RIGID
from workflow.language import titles
from workflow.language.factors import FACTORS, OF_A_LAYER, own_kind
from workflow.study.types import CompositeName, Number, Strict

#: Factors of the base below the layers.
OF_THE_BASE = ("base", "base_modulus", "base_poisson")
_BASES = ({OF_THE_BASE[0]}, set(OF_THE_BASE[1:]))
#: Most layers of a body.
_MOST_LAYERS = 20


class Below(Strict):
    """Conditions of both fields at the interface below a layer."""

    electric: Literal["grounded", "bonded"] | None = Field(None, description="null: grounded above the base")
    magnetic: Literal["grounded", "bonded", "insulated"] | None = Field(
        None, description="null: grounded above a rigid base; insulated only there"
    )


class BodyLayer(Strict):
    """A layer; its numbers may be names of factors: the top layer's own, in others these or ``<word>_<its own>``."""

    material: str | None = Field(None, description="name of a material; or else a composite")
    composite: CompositeName | None = Field(None, description="of the study's phases")
    volume_fraction: Number | str | None = Field(None, description="of a composite: a number, or a factor's name")
    scandium_fraction: Number | str | None = Field(None, description="of AlScN: a number, or a factor's name")
    thickness: Number | str = Field(description="a number [m], or a factor's name")
    below: Below = Field(default_factory=Below, description="the interface below: electric, magnetic")

    @property
    def numbers(self) -> dict[str, float | str]:
        """Numbers of the layer, or names of factors in their place."""
        numbers = {kind: getattr(self, kind) for kind in OF_A_LAYER}
        return {kind: value for kind, value in numbers.items() if value is not None}

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if (self.material is None) == (self.composite is None):
            raise ValueError("material: give either a material or a composite")
        needed = COMPOSITES[self.composite] if self.composite else None
        for kind in OF_A_LAYER[1:]:
            if kind in self.numbers and kind != needed:
                raise ValueError(f"{kind}: {self.material or self.composite} has none")
        if needed and needed not in self.numbers:
            raise ValueError(f"{needed}: missing; must be {FACTORS[needed].allowed} (composite {self.composite})")
        for kind, value in self.numbers.items():
            if isinstance(value, str):
                if kind not in (value, own_kind(value)):
                    raise ValueError(
                        f"{kind}: {value!r} is no name of such a factor; must be {kind} in the top layer, "
                        f"<word>_{kind} in another"
                    )
            elif not FACTORS[kind].allows(value):
                raise ValueError(f"{kind}: {value:g} is not {FACTORS[kind].allowed}")
        return self

    def at(self, values: Mapping[str, Any]) -> dict[str, float]:
        """Return the layer's numbers at values of the factors."""
        return {kind: float(values[value] if isinstance(value, str) else value) for kind, value in self.numbers.items()}

    def plain(self, values: Mapping[str, Any]) -> dict[str, float | str]:
        """Return the layer as the factors of a single film."""
        kind = {"material": self.material} if self.material else {"composite": str(self.composite)}
        return {**kind, **self.at(values)}

    def compose(self, values: Mapping[str, Any], materials: Mapping[str, Material], phases: Sequence[str]) -> Layer:
        """Return the solver's layer at values of the factors."""
        numbers = self.at(values)
        if self.material is not None:
            material = find(self.material, materials)
        else:
            kind = str(self.composite)
            material = compose(
                kind, (find(phases[0], materials), find(phases[1], materials)), numbers[COMPOSITES[kind]]
            )
        return Layer(material, numbers["thickness"], self.below.electric, self.below.magnetic)

    def words(self) -> str:
        """Return the layer in words."""
        parts = {
            kind: value if isinstance(value, str) else titles.value(kind, value, 4)
            for kind, value in self.numbers.items()
        }
        parts |= {f"{field} interface": condition for field, condition in self.below if condition is not None}
        return ", ".join(
            [str(self.material or self.composite), *(f"{kind} = {value}" for kind, value in parts.items())]
        )


Layers = list[BodyLayer]


def named(layers: Layers) -> list[str]:
    """Return the names of factors in the place of the layers' numbers."""
    return list(
        dict.fromkeys(number for layer in layers for number in layer.numbers.values() if isinstance(number, str))
    )


def tabled(layers: Layers) -> list[str]:
    """Return the factors with solver tables for each value: ratios of thicknesses need them, a shared one does not."""
    shared = {layer.thickness for layer in layers}
    return [name for name in named(layers) if shared != {name}]


def check(layers: Layers, fixed: Mapping[str, float | str], ranges: Mapping[str, tuple[float, float]]) -> None:
    """Raise ValueError unless every named factor is there, within bounds, and every own factor is named."""
    if len(layers) > _MOST_LAYERS:
        raise ValueError(f"body: {len(layers)} layers are more than {_MOST_LAYERS}")
    for number, layer in enumerate(layers):
        for kind, factor in layer.numbers.items():
            if not isinstance(factor, str):
                continue
            shares_top = number > 0 and factor == kind == layers[0].numbers.get(kind)
            if (factor == kind) != (number == 0) and not shares_top:
                allowed = kind if number == 0 else f"<word>_{kind}"
                raise ValueError(f"body.{number}: {kind}: {factor!r} must be {allowed}, or a number")
            if factor not in fixed and factor not in ranges:
                raise ValueError(f"body.{number}: {kind}: {factor!r} is neither in factors nor in fixed")
    parts: list[tuple[str, Mapping[str, Sequence[float | str]]]]
    parts = [("fixed", {name: [value] for name, value in fixed.items()}), ("factors", ranges)]
    for part, entries in parts:
        for name, values in entries.items():
            if own_kind(name) and name not in named(layers):
                raise ValueError(f"{part}: {name}: no layer of the body names it")
            if name not in (*named(layers), *OF_THE_BASE[1:]):
                continue
            for value in values:
                if isinstance(value, str) or not FACTORS[name].allows(value):
                    shown = f"{value!r}" if isinstance(value, str) else f"{value:g}"
                    raise ValueError(f"{part}: {name}: {shown} is not {FACTORS[name].allowed}")


def solved(
    layers: Layers,
    entrance: Callable[..., xr.Dataset],
    factors: Mapping[str, Any],
    *axes: Any,
    materials: Mapping[str, Material],
    phases: Sequence[str],
    **options: Any,
) -> xr.Dataset:
    """Solve cases of a body by an entrance of the solver (``solve``, ``solve_interior``)."""
    body_values = {name: _array(name, factors[name]) for name in factors if name in (*named(layers), *OF_THE_BASE)}
    if not any(body_values.keys() & set(OF_THE_BASE) == names for names in _BASES):
        named_base = ", ".join(name for name in OF_THE_BASE if name in body_values) or "base"
        raise ValueError(f"{named_base}: a body needs a base, or else base_modulus and base_poisson, not both")
    whole = xr.broadcast(*body_values.values())
    rows = list(zip(*(factor.values.ravel().tolist() for factor in whole), strict=True))
    stack_of_row = {
        row: stack(layers, dict(zip(body_values, row, strict=True)), materials, phases) for row in dict.fromkeys(rows)
    }
    stacks = np.empty(len(rows), dtype=object)
    stacks[:] = [stack_of_row[row] for row in rows]
    # the solver keeps a factor's name from the dimensions of others
    renamed_dims = {str(dim): f"{dim} of the body" for dim in whole[0].dims if dim in body_values}
    body = xr.DataArray(stacks.reshape(whole[0].shape), dims=[renamed_dims.get(str(dim), dim) for dim in whole[0].dims])
    other_factors = {name: value for name, value in factors.items() if name not in body_values}
    out = entrance({**other_factors, BODY: body}, *axes, materials=materials, phases=phases, **options)
    back = {renamed: dim for dim, renamed in renamed_dims.items()}
    out = out.drop_vars(BODY).rename({renamed: dim for renamed, dim in back.items() if renamed in out.dims})
    out = out.assign_coords(
        {name: xr.Variable(factor.dims, factor.values, _attrs(name)) for name, factor in body_values.items()}
    )
    dims = dict.fromkeys(dim for name, value in factors.items() for dim in _array(name, value).dims)
    words = " | ".join([*(layer.words() for layer in layers), "base"])
    return out.transpose(*(dim for dim in dims if dim in out.dims), ...).assign_attrs(body=words)


def stack(layers: Layers, values: dict[str, Any], materials: Mapping[str, Material], phases: Sequence[str]) -> Stack:
    """Return the stack of one combination of factors."""
    solver_layers = []
    for number, layer in enumerate(layers):
        try:
            solver_layers.append(layer.compose(values, materials, phases))
        except MaterialError as error:
            raise MaterialError(f"body.{number}: {error}") from None
    if "base" not in values:
        return Stack(solver_layers, Material.isotropic(values["base_modulus"], values["base_poisson"], name="base"))
    if values["base"] == RIGID:
        return Stack(solver_layers, RIGID)
    try:
        base = find(str(values["base"]), materials)
    except MaterialError as error:
        raise MaterialError(f"base: {str(error).removeprefix('material: ')} and {RIGID}") from None
    return Stack(solver_layers, base)


def _array(name: str, value: Any) -> xr.DataArray:
    """Return a factor's values with dimensions; a list lies along the factor itself."""
    if isinstance(value, xr.DataArray):
        return value.drop_vars(value.coords)
    values = np.asarray(value)
    return xr.DataArray(values, dims=(name,) * values.ndim)


def _attrs(name: str) -> dict[str, str]:
    if name not in FACTORS:
        return {"units": "1", "long_name": f"{name} of the case"}
    return {"units": FACTORS[name].units, "long_name": FACTORS[name].long_name}
