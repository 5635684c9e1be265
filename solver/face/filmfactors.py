"""The factors that only a film has: all of them where there is a thickness, none where there is not."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from solver.arrays import shown
from solver.body import KINDS, Kind, around, is_cut
from solver.face.refusal import FactorError
from solver.material.constants import Material
from solver.names import (
    AIR,
    ANGLED_CUTS,
    BODY,
    FACTORS,
    HEIGHT_MAP,
    OF_A_FILM,
    OF_A_GAP,
    OF_AN_ELECTRODE,
    OF_HEAT,
    OF_SPACE,
    ON_CUTS,
    PROFILES,
)
from solver.stack.layers import RIGID, Stack

_POINTED = [name for name, outline in PROFILES.items() if outline.contact == "point"]
_IN_SPACE = [name for name, outline in PROFILES.items() if outline.space]
_BASE = f"{RIGID!r} or a material's name, or else base_modulus and base_poisson"


def absent(value: object) -> bool:
    """Return whether a value means that the case does not have this factor of films."""
    return (
        value is None or (isinstance(value, str) and not value) or (isinstance(value, float) and bool(np.isnan(value)))
    )


def _has(arrays: Mapping[str, xr.DataArray], name: str) -> xr.DataArray:
    """True for cases that have a factor of films."""
    if name not in arrays:
        return xr.DataArray(False)
    array = arrays[name]
    if array.dtype.kind in "fU":
        return xr.DataArray(~np.isnan(array.values) if array.dtype.kind == "f" else array.values != "", dims=array.dims)
    present = [not absent(value) for value in array.values.flat]
    return xr.DataArray(np.array(present, dtype=bool).reshape(array.shape), dims=array.dims)


def kinds_of(arrays: Mapping[str, xr.DataArray]) -> xr.DataArray:
    """The kind of body of every case, by name; a case with a thickness or a stack has layers."""
    if not arrays.keys() & {BODY, "thickness", "profile", "surroundings"}:
        return xr.DataArray(KINDS["line", False, False].name)
    layered = xr.DataArray(True) if BODY in arrays else _has(arrays, "thickness")
    pointed, air = among(arrays, "profile", _POINTED), among(arrays, "surroundings", [AIR])
    layered, pointed, air, space = xr.broadcast(layered, pointed, air, in_space(arrays))
    touches = np.select([space.values, pointed.values], ["space", "point"], "line")
    holds = [(touches == touch) & (layered.values == layers) & (air.values == airy) for touch, layers, airy in KINDS]
    return xr.DataArray(np.select(holds, [kind.name for kind in KINDS.values()], ""), dims=layered.dims)


def in_space(arrays: Mapping[str, xr.DataArray]) -> xr.DataArray:
    """True for contacts in space: by the profile, or of revolution on a cut crystal."""
    if "profile" not in arrays:
        return xr.DataArray(False)
    space = among(arrays, "profile", _IN_SPACE)
    on_cuts = among(arrays, "profile", ON_CUTS)
    if not on_cuts.values.any():
        return space
    if "cut" in arrays:
        return space | on_cuts
    for name in ("material", "base", BODY):
        if name in arrays and arrays[name].dtype.kind in "OU":
            known = {value: is_cut(value) for value in dict.fromkeys(arrays[name].values.flat)}
            if any(known.values()):
                cut = [known[value] for value in arrays[name].values.flat]
                space = space | (on_cuts & xr.DataArray(np.reshape(cut, arrays[name].shape), dims=arrays[name].dims))
    return space


def present(arrays: Mapping[str, xr.DataArray]) -> list[Kind]:
    """The kinds of the cases."""
    names = kinds_of(arrays).values.ravel()
    return [kind for kind in KINDS.values() if (names == kind.name).any()]


def check_films(arrays: Mapping[str, xr.DataArray]) -> None:
    """Every film has a base, every half-plane has none of a film's factors; what has layers or air has no speed."""
    if "speed" in arrays:
        plain = kinds_of(arrays) == KINDS["line", False, False].name
        refuse(arrays, "speed", (bare(arrays, "speed") != 0) & ~plain, "m/s of what is no half-plane without air")
    if not arrays.keys() & {BODY, *OF_A_FILM}:
        return
    present = {name: _has(arrays, name) for name in OF_A_FILM}
    film = present["thickness"]
    if BODY in arrays:
        _check_stacks(arrays)
    for name in OF_A_FILM[1:]:
        refuse(arrays, name, present[name] & ~film, "without a thickness; only a film has one")
    if not film.values.any():
        return
    if "base" in arrays:
        for value in arrays["base"].values.flat:
            if not (absent(value) or isinstance(value, str | Material)):
                raise FactorError(f"base: {shown(value)} is no material; must be {_BASE}")
    check_elasticity(arrays, "base")
    if (film & ~present["base"] & ~present["base_modulus"]).values.any():
        raise FactorError(f"base: missing; must be {_BASE}")
    graded, exponent = present["base_volume_fraction"], present["grading_exponent"]
    refuse(arrays, "base_volume_fraction", graded & in_space(arrays), "grades a film below a contact in space")
    if "volume_fraction" not in arrays:
        refuse(arrays, "base_volume_fraction", graded, "without a volume_fraction, which a graded film has on top")
    refuse(arrays, "grading_exponent", exponent & ~graded, "without a base_volume_fraction; only a graded film has one")


def check_elasticity(arrays: Mapping[str, xr.DataArray], body: str) -> None:
    """A base or a punch is either named or has both modulus and Poisson's ratio."""
    modulus, poisson = f"{body}_modulus", f"{body}_poisson"
    if not arrays.keys() & {modulus, poisson}:
        return
    present = {name: _has(arrays, name) for name in (body, modulus, poisson)}
    for name in (modulus, poisson):
        refuse(arrays, name, present[name] & present[body], f"beside a {body}; give either")
    for name, other in ((poisson, modulus), (modulus, poisson)):
        if (present[other] & ~present[name]).values.any():
            raise FactorError(f"{name}: missing; must be {FACTORS[name].allowed}")


def check_gaps(arrays: Mapping[str, xr.DataArray]) -> None:
    """Only a gap with air has a permittivity and a radius, and only a sphere says itself where its gap ends."""
    if not arrays.keys() & {"surroundings", *OF_A_GAP}:
        return
    air = among(arrays, "surroundings", [AIR])
    for name in OF_A_GAP:
        if name in arrays:
            usual = FACTORS[name].default
            set_by_user = _has(arrays, name) if usual is None else bare(arrays, name) != usual
            refuse(arrays, name, set_by_user & ~air, f"without surroundings: {AIR}; only its gap has one")
    pointed = among(arrays, "profile", _POINTED)
    ended = _has(arrays, "gap_radius")
    if "gap_radius" in arrays:
        refuse(arrays, "gap_radius", ended & ~pointed, "beside a contact along a line; only a point's gap has one")
    if (air & ~ended & among(arrays, "profile", ["cone", "power"])).values.any():
        raise FactorError(
            f"gap_radius: missing; must be {FACTORS['gap_radius'].allowed}: a cone or a power beside air says nowhere "
            "how wide the punch is, and the charge in its gap grows with that"
        )


def check_space(arrays: Mapping[str, xr.DataArray]) -> None:
    """Only contacts in space have a cut, a direction of sliding and a height map; their punch conducts a field."""
    if not arrays.keys() & {"profile", *OF_SPACE, HEIGHT_MAP}:
        return
    names = [name for name in (*OF_SPACE, HEIGHT_MAP) if name in arrays]
    mapped = among(arrays, "profile", ["map"])
    if mapped.values.any() and HEIGHT_MAP not in arrays:
        raise FactorError(f"{HEIGHT_MAP}: missing; a file of heights or an array over x and y [m] (profile map)")
    space = in_space(arrays)
    for name in names:
        if name == HEIGHT_MAP and not mapped.values.all():
            raise FactorError(f"{name}: only the profile map has one")
        if not space.values.all():
            raise FactorError(
                f"{name}: only contacts in space have it: profile {', '.join(_IN_SPACE)}, or {', '.join(ON_CUTS)} with "
                "a cut"
            )
    angled = among(arrays, "cut", ANGLED_CUTS)
    if angled.values.any() and "cut_angle" not in arrays:
        raise FactorError(f"cut_angle: missing; must be {FACTORS['cut_angle'].allowed}, as '36 deg'")
    if "cut_angle" in arrays and "cut" not in arrays:
        raise FactorError("cut: missing; must be rotated Y or tilt where there is a cut_angle")
    for name, words in (("electric", "conducting"), ("total_flux", "0")):
        if name in arrays:
            other = among(arrays, name, ["insulating"]) if name == "electric" else bare(arrays, name) != 0
            refuse(arrays, name, other & space, f"of a contact in space; must be {words}")


_NEEDS = {"touch_temperature": "hold", "hold": "touch_temperature", "feedback_resistance": "feedback_capacitance"}


def check_heat(arrays: Mapping[str, xr.DataArray]) -> None:
    """Raise FactorError unless every case that is touched is a film, with a time, and no other has factors of heat."""
    names = [name for name in OF_HEAT if name in arrays]
    if not names:
        return
    kinds, space = kinds_of(arrays), in_space(arrays)
    for name in names:
        refuse(arrays, name, space, "of a contact in space; heat is solved for contacts along a line and at a point")
        filmless = [kind for kind in np.unique(kinds) if "film" not in kind]
        refuse(arrays, name, kinds.isin(filmless), "without a film; heat needs its thickness")
        if np.any(np.isnan(bare(arrays, name).values)):
            raise FactorError(f"{name}: missing in a case; heat is asked of all cases or of none")
    for name in names if "touch_temperature" in arrays else ["touch_temperature", *names]:
        if name not in arrays or (needed := _NEEDS.get(name, name)) not in arrays:
            missing = name if name not in arrays else needed
            raise FactorError(
                f"{missing}: missing; {names[0] if name not in arrays else name} needs it; must be "
                f"{FACTORS[missing].allowed}"
            )


def bare(arrays: Mapping[str, xr.DataArray], name: str) -> xr.DataArray:
    """A factor without coordinates."""
    return arrays[name].drop_vars(arrays[name].coords)


def among(arrays: Mapping[str, xr.DataArray], name: str, choices: Sequence[str]) -> xr.DataArray:
    """True for cases whose factor is one of the choices; False if the factor is missing."""
    if name not in arrays:
        return xr.DataArray(False)
    matches = [arrays[name].values == choice for choice in choices]
    return xr.DataArray(np.any(matches, axis=0), dims=arrays[name].dims)


def _check_stacks(arrays: Mapping[str, xr.DataArray]) -> None:
    """Stacks are stacks, and nothing beside them says what a body is made of."""
    for value in arrays[BODY].values.flat:
        if not isinstance(value, Stack):
            raise FactorError(f"{BODY}: {shown(value)} is no solver.Stack")
        if value.electroded:
            raise FactorError(f"{BODY}: {value.name}: electroded is said by the factor electrode: top")
    for name in ("material", "composite", "volume_fraction", "cut", "cut_angle", *OF_A_FILM):
        if name in arrays:
            raise FactorError(f"{name}: beside a {BODY}; a stack has its own materials, thicknesses and interfaces")


def refuse(arrays: Mapping[str, xr.DataArray], name: str, bad: xr.DataArray, why: str) -> None:
    """Raise FactorError, with the first offending value, where there is one."""
    if not bad.values.any():
        return
    values, places = xr.broadcast(bare(arrays, name), bad)
    first: Any = values.values[places.values].flat[0]
    number = isinstance(first, float | np.floating)
    raise FactorError(f"{name}: {f'{first:g}' if number else shown(getattr(first, 'name', first))} {why}")


#: Factors that :func:`solver.body.around` reads: by their value, or only by whether a case has them, other than 0.
_READ = (
    "surroundings",
    BODY,
    "material",
    "base",
    "cut",
    "profile",
    "electric",
    "magnetic",
    "electrode",
    "interface_magnetic",
)
_THERE = ("thickness", "gap_radius", *OF_AN_ELECTRODE[1:])


def settled(arrays: Mapping[str, xr.DataArray]) -> dict[str, xr.DataArray]:
    """Factors with the surroundings of every case, where a film or a table leaves them open."""
    surroundings = arrays.get("surroundings")
    opened = (
        arrays.keys() & {BODY, "thickness"} or in_space(arrays).values.any()
        if surroundings is None
        else any(map(absent, surroundings.values.flat))
    )
    if not opened:
        return dict(arrays)
    read = {name: _labels(arrays[name], name in _THERE) for name in (*_READ, *_THERE) if name in arrays}
    cases = xr.broadcast(*read.values())
    around_of: dict[tuple[Any, ...], str] = {}
    for values in (rows := list(zip(*(labels.values.flat for labels in cases), strict=True))):
        if values not in around_of:
            case = {name: value for name, value in zip(read, values, strict=True) if not absent(value)}
            around_of[values] = str(case.get("surroundings") or around(case))
    chosen = xr.DataArray(np.reshape([around_of[values] for values in rows], cases[0].shape), dims=cases[0].dims)
    return {**arrays, "surroundings": chosen if len({*around_of.values()}) > 1 else chosen[(0,) * chosen.ndim]}


def _labels(array: xr.DataArray, only_presence: bool) -> xr.DataArray:
    """A factor's values, or 1 where a case has it and it is not 0; without dimension where all are one."""
    values = array.values
    if only_presence:
        values = np.where([not absent(value) and value != 0 for value in values.flat], 1.0, np.nan)
        values = values.reshape(array.shape)
    labels = xr.DataArray(values.astype(object), dims=array.dims)
    first = labels.values.flat[0] if labels.size else None
    alike = all(label is first or label == first or (absent(label) and absent(first)) for label in labels.values.flat)
    return labels.isel(dict.fromkeys(labels.dims, 0)) if labels.size and alike else labels
