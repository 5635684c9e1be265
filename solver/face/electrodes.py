"""The electrode that is read, by its factors: which it is, and patches of it."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from solver.arrays import Array, BoolArray
from solver.body import KINDS
from solver.face.cases import Cases
from solver.face.filmfactors import kinds_of, refuse
from solver.face.refusal import FactorError
from solver.film.electrodes import Reading
from solver.names import CHOICES, FACTORS, OF_AN_ELECTRODE

_NEEDS = {"patch_size": "collector", "patch": "patch_size", "patch_position": "patch_size", "patch_pitch": "patch_size"}


def reading_of(cases: Cases) -> Reading | None:
    """What is read of cases; None without a ``collector``."""
    if "collector" not in cases.values:
        return None
    shape = tuple(cases.sizes.values())

    def flat(values: Any) -> Array:
        return np.asarray(np.broadcast_to(values, shape).ravel(), dtype=np.float64)

    usual = CHOICES["patch"][1 if cases.kind.contact == "line" else 0]
    size, pitch = (flat(cases.values[name]) if name in cases.values else None for name in ("patch_size", "patch_pitch"))
    return Reading(
        flat(cases.number("collector")),
        flat(cases.values.get("patch", np.array(usual)) == "strip") > 0,
        flat(cases.number("patch_position")),
        size,
        pitch,
    )


def electroded(cases: Cases) -> BoolArray:
    """Whether an electrode without stiffness lies on the film; (...)."""
    return np.asarray(cases.values.get("electrode", np.array("none")) == "top")


def check_electrodes(arrays: Mapping[str, xr.DataArray]) -> None:
    """Only films have an electrode that is read, a number of it is whole, and neighbours do not touch.

    Raises
    ------
    FactorError
        Naming the factor, its value and what is allowed.
    """
    given = [name for name in OF_AN_ELECTRODE if name in arrays]
    if not given:
        return
    for name in given:
        if (needed := _NEEDS.get(name)) and needed not in arrays:
            raise FactorError(f"{needed}: missing; {name} needs it; must be {FACTORS[needed].allowed}")
    kinds, plain = kinds_of(arrays), {name: arrays[name].drop_vars(arrays[name].coords) for name in given}
    read = [kind.name for kind in KINDS.values() if "collector" in kind.factors and not kind.air]
    for name in given:
        bare = plain[name] == "none" if name == "electrode" else xr.DataArray(False)
        refuse(arrays, name, ~bare & ~kinds.isin(read), "without a film in insulated surroundings")
    if "collector" not in arrays:
        return
    if (
        "friction" in arrays
    ):  # what friction adds to a point's tractions has no charge in all, but moves that of patches
        points = kinds.isin([kind.name for kind in KINDS.values() if kind.contact == "point"])
        slides = arrays["friction"].drop_vars(arrays["friction"].coords) != 0
        refuse(arrays, "friction", slides & points, "of a point contact above an electrode that is read; must be 0")
    refuse(arrays, "collector", plain["collector"] != np.floor(plain["collector"]), "is not a whole number >= 1 [1]")
    if "patch" in arrays:
        lines = kinds.isin([kind.name for kind in KINDS.values() if kind.contact == "line"])
        refuse(arrays, "patch", (plain["patch"] == "disc") & lines, "below a contact along a line; must be strip")
    if "patch_pitch" in arrays:
        close = plain["patch_pitch"] < plain["patch_size"]
        refuse(arrays, "patch_pitch", close, "is less than patch_size: a patch would touch its neighbour")
