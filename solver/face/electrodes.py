"""The electrode that is read, by its factors: which it is, and patches of it."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from solver.arrays import Array, BoolArray
from solver.body import KINDS
from solver.face.cases import Cases
from solver.face.filmfactors import among, bare, kinds_of, refuse
from solver.face.refusal import FactorError
from solver.names import CHOICES, FACTORS, OF_AN_ELECTRODE
from solver.stack.electrodereading import Reading

_NEEDS = {
    "electrode_voltage": "collector", "patch_size": "collector", "patch": "patch_size", "patch_position": "patch_size",
    "patch_pitch": "patch_size", "patch_hole": "patch", "patch_length": "patch", "floating_neighbours": "patch_pitch",
}  # fmt: skip
#: What a shape of patches has beside its size.
_OWN = {"ring": "patch_hole", "rectangle": "patch_length"}


def reading_of(cases: Cases) -> Reading | None:
    """What is read of cases; None without a ``collector``."""
    if "collector" not in cases.values:
        return None
    shape = tuple(cases.sizes.values())

    def flat(values: Any) -> Array:
        return np.asarray(np.broadcast_to(values, shape).ravel(), dtype=np.float64)

    usual = CHOICES["patch"][1 if cases.kind.contact == "line" else 0]
    some = ("patch_size", "patch_pitch", "floating_neighbours", "electrode_voltage")
    size, pitch, floating, voltage = (flat(cases.values[name]) if name in cases.values else None for name in some)
    shapes = np.asarray(cases.values.get("patch", np.array(usual)))
    of_shape = flat(sum(place * (shapes == name) for place, name in enumerate(CHOICES["patch"])))
    other = sum(flat(cases.values.get(own, 0.0) * (shapes == name)) for name, own in _OWN.items())
    if cases.kind.contact == "line":  # a rectangle has, of the force on its length, what a strip has
        of_shape, other = np.full_like(of_shape, CHOICES["patch"].index("strip")), np.zeros_like(of_shape)
    position = flat(cases.number("patch_position"))
    return Reading(
        flat(cases.number("collector")), of_shape, position, np.asarray(other), size, pitch, floating, voltage
    )


def electroded(cases: Cases) -> BoolArray:
    """Whether an electrode without stiffness lies on the film; (...)."""
    return np.asarray(cases.values.get("electrode", np.array("none")) == "top")


def check_electrodes(arrays: Mapping[str, xr.DataArray]) -> None:
    """Only films have an electrode that is read, a number of it is whole, and neighbours do not touch."""
    given = [name for name in OF_AN_ELECTRODE if name in arrays]
    if not given:
        return
    for name in given:
        if (needed := _NEEDS.get(name)) and needed not in arrays:
            allowed = (
                FACTORS[needed].allowed
                if needed in FACTORS
                else next(choice for choice, own in _OWN.items() if own == name)
            )
            raise FactorError(f"{needed}: missing; {name} needs it; must be {allowed}")
    kinds, plain = kinds_of(arrays), {name: bare(arrays, name) for name in given}
    read = [kind.name for kind in KINDS.values() if "collector" in kind.factors and not kind.air]
    points = kinds.isin([kind.name for kind in KINDS.values() if kind.contact == "point"])
    for name in given:
        none = plain[name] == "none" if name == "electrode" else xr.DataArray(False)
        refuse(arrays, name, ~none & ~kinds.isin(read), "without a film in insulated surroundings")
    if "collector" not in arrays:
        return
    for name, least in (("collector", 1), ("floating_neighbours", 0)):
        if name in arrays:
            refuse(arrays, name, plain[name] != np.floor(plain[name]), f"is not a whole number >= {least} [1]")
    if "floating_neighbours" in arrays:  # a strip without end takes no voltage of a finite charge
        no_discs = plain["patch"] != "disc" if "patch" in arrays else xr.DataArray(False)
        refuse(arrays, "floating_neighbours", points & no_discs, "below a point contact, of patches that are no discs")
    if "patch" in arrays:
        round_ = among(arrays, "patch", ["disc", "ring"])
        refuse(arrays, "patch", round_ & ~points, "below a contact along a line; must be strip or rectangle")
        for shape, own in _OWN.items():
            there = plain["patch"] == shape
            if own not in arrays:
                refuse(arrays, "patch", there, f"without a {own}, which must be {FACTORS[own].allowed}")
            else:
                refuse(arrays, own, ~there & (plain[own] == plain[own]), f"of a patch that is no {shape}")
    if "patch_hole" in arrays:
        refuse(arrays, "patch_hole", plain["patch_hole"] >= plain["patch_size"], "is not less than patch_size")
    if "patch_pitch" in arrays:
        close = plain["patch_pitch"] <= plain["patch_size"]
        refuse(arrays, "patch_pitch", close, "is not more than patch_size: a patch would touch its neighbour")
