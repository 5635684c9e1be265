"""Reading of an electrode from the factors of cases: which electrode, and which patch of it."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from solver.arrays import Array, BoolArray
from solver.body import KINDS
from solver.face.cases import Cases
from solver.face.filmfactors import among, bare, in_space, kinds_of, refuse
from solver.face.refusal import FactorError
from solver.names import CHOICES, FACTORS, OF_AN_ELECTRODE
from solver.stack.electrodes import DISC, STRIP, Reading

#: Factors of an electrode, and the factor that each needs beside it.
_NEEDS = {
    "patch_size": "collector", "patch": "patch_size", "patch_position": "patch_size", "patch_pitch": "patch_size",
}  # fmt: skip


def reading_of(cases: Cases) -> Reading | None:
    """Reading of the cases; None without a ``collector``."""
    if "collector" not in cases.values:
        return None
    axes = tuple(cases.sizes.values())

    def flat(name: str) -> Array:
        return np.asarray(np.broadcast_to(cases.number(name), axes).ravel(), dtype=np.float64)

    size, pitch = (flat(name) if name in cases.values else None for name in ("patch_size", "patch_pitch"))
    usual = CHOICES["patch"][STRIP if cases.kind.contact == "line" else DISC]
    is_strip = np.asarray(cases.values.get("patch", np.array(usual))) == CHOICES["patch"][STRIP]
    shapes = np.broadcast_to(np.where(is_strip, STRIP, DISC), axes).ravel()
    return Reading(flat("collector"), shapes, flat("patch_position"), size, pitch)


def electroded(cases: Cases) -> BoolArray:
    """Return whether an electrode without stiffness lies on the film; (...)."""
    return np.asarray(cases.values.get("electrode", np.array("none")) == "top")


def check_electrodes(arrays: Mapping[str, xr.DataArray]) -> None:
    """Raise FactorError unless a film has the electrode, its number is whole and its patches do not touch."""
    names = [name for name in OF_AN_ELECTRODE if name in arrays]
    if not names:
        return
    for name in names:
        if (needed := _NEEDS.get(name)) and needed not in arrays:
            raise FactorError(f"{needed}: missing; {name} needs it; must be {FACTORS[needed].allowed}")
    kinds, values = kinds_of(arrays), {name: bare(arrays, name) for name in names}
    readable = [kind.name for kind in KINDS.values() if "collector" in kind.factors and not kind.air]
    lines = [kind.name for kind in KINDS.values() if kind.contact == "line"]
    for name in names:
        refuse(arrays, name, in_space(arrays), "of a contact in space; electrodes are read below lines and points")
        absent = values[name] == "none" if name == "electrode" else xr.DataArray(False)
        refuse(arrays, name, ~absent & ~kinds.isin(readable), "without a film in insulated surroundings")
    if "collector" not in arrays:
        return
    number = values["collector"]
    refuse(arrays, "collector", number != np.floor(number), "is not a whole number >= 1 [1]")
    discs = among(arrays, "patch", ["disc"])
    refuse(arrays, "patch", discs & kinds.isin(lines), "below a contact along a line; must be strip")
    if "patch_pitch" in arrays:
        touching = values["patch_pitch"] <= values["patch_size"]
        refuse(arrays, "patch_pitch", touching, "is not more than patch_size: a patch would touch its neighbour")
