"""Attributes of a solution and of its outputs, including the defaults that were used."""

from collections.abc import Mapping, Sequence
from typing import Any

import xarray as xr

from solver.body import KINDS, Kind, Touch
from solver.described import Described
from solver.face.factorvalues import FactorValues
from solver.halfplane.profile import Profile
from solver.material.constants import Material
from solver.names import (
    BODY,
    CHOICES,
    CONTACTS,
    FACTORS,
    OF_A_GAP,
    OF_A_LINE,
    OF_A_PUNCH,
    OF_AN_ELECTRODE,
    OF_HEAT,
    OF_SPACE,
    PROFILES,
)

#: Method of each kind of contact (CF: the method of production).
SOURCES: dict[Touch, str] = {
    "line": "meecontact: closed-form solution of plane contact in the Stroh formalism",
    "point": "meecontact: closed-form solution of axisymmetric contact in the Stroh formalism",
    "space": "meecontact: contact on a grid of cells in the Stroh formalism",
}
_RELATIVE = " relative to the datum"
_FILM_DATUM = "of a film absolute above a grounded interface (depths: on a rigid base); elsewhere it "
_PUNCH_DATUM = "an elastic punch's own: its radius, of a flat one its width, of a wedge the datum"
_LISTS = ("composite", "phases", "defaults")
_TEXTS = ("title", "source")


def attributes(title: str, cases: FactorValues, phases: Sequence[str | Material]) -> dict[str, str]:
    """Return title, source, composite, phases, and the defaults of all factors that were not given."""
    defaults, arrays, kinds = _defaults(cases), cases.arrays, cases.kinds
    attrs = {
        "title": title.replace("half-plane", " or ".join(sorted(kind.name for kind in kinds))),
        "source": "; ".join(
            SOURCES[touch] + "".join(kind.method for kind in kinds if kind.touch == touch)
            for touch in dict.fromkeys(kind.touch for kind in kinds)
        ),
    }
    if "material" not in arrays and BODY not in arrays:
        used = _kinds(arrays, "composite") or [str(defaults["composite"])]
        attrs["composite"] = ", ".join(str(composite) for composite in used)
    if "volume_fraction" in arrays:
        attrs["phases"] = ", ".join(phase.name if isinstance(phase, Material) else phase for phase in phases)
    words = {name: f" {FACTORS[name].units}" for name in defaults if name in FACTORS and FACTORS[name].units != "1"}
    shown = {name: f"{value:g}" if isinstance(value, float) else value for name, value in defaults.items()}
    return {**attrs, "defaults": ", ".join(f"{name} = {text}{words.get(name, '')}" for name, text in shown.items())}


def of_output(described: Described, arrays: Mapping[str, xr.DataArray], kinds: Sequence[Kind]) -> dict[str, str]:
    """Return the CF attributes of an output of cases of some kinds, with the datum that it depends on."""
    attrs = _of_body(described, arrays, kinds)
    line = any(kind.contact == "line" for kind in kinds)
    if described.on_punch and line and not set(OF_A_PUNCH).isdisjoint(arrays):
        attrs["comment"] = "; ".join(filter(None, [attrs.get("comment"), _PUNCH_DATUM]))
    return attrs


def _of_body(described: Described, arrays: Mapping[str, xr.DataArray], kinds: Sequence[Kind]) -> dict[str, str]:
    """Return the CF attributes of an output, with the datum of the body."""
    if not described.on_datum:
        return described.attrs
    if all(kind.datum == "absolute" for kind in kinds):
        return {"units": described.units, "long_name": described.long_name.removesuffix(_RELATIVE)}
    datum = arrays.get("datum")
    if datum is None:
        length = f"{FACTORS['datum'].default:g} m, the default"
    else:
        length = "that of the coordinate datum" if datum.ndim else f"{float(datum):.15g} m"
    absolute = [kind.datum != "relative" for kind in kinds]
    words = described.long_name.removesuffix(_RELATIVE) if all(absolute) else described.long_name
    comment = f"{_FILM_DATUM if any(absolute) else ''}{described.comment}; datum: {length}"
    return described.attrs | {"long_name": words, "comment": comment}


def united(parts: Sequence[Mapping[Any, Any]]) -> dict[Any, Any]:
    """Join the attributes of joined solutions: the union of their lists, the longest of their texts."""
    attrs = dict(parts[0])
    attrs |= {key: max((str(part.get(key, "")) for part in parts), key=len) for key in _TEXTS if key in attrs}
    for key in _LISTS:
        entries = [entry for part in parts for entry in str(part.get(key, "")).split(", ") if entry]
        if entries:
            attrs[key] = ", ".join(dict.fromkeys(entries))
    return attrs


def _defaults(cases: FactorValues) -> dict[str, float | str]:
    """Return the defaults that the cases use."""
    arrays = cases.arrays
    defaults: dict[str, float | str] = {
        name: factor.default for name, factor in FACTORS.items() if factor.default is not None and name not in arrays
    }
    profiles = _kinds(arrays, "profile") or [CHOICES["profile"][0]]
    takes = {name for kind in profiles if not isinstance(kind, Profile) for name in PROFILES[str(kind)].may}
    if "slope" in takes and not {"slope", "moment"} & set(arrays):
        defaults["slope"] = 0.0
    spared = {"composite"} if {"material", BODY} & set(arrays) else set()  # choices that are not listed
    spared |= set() if "corner" in takes else {"corner"}
    spared |= {name for kind in KINDS.values() for name in kind.factors}
    if BODY not in arrays:
        spared -= {name for kind in cases.kinds for name in kind.factors}
    contacts = {kind.contact for kind in cases.kinds}
    unused = {name for contact, loads in CONTACTS.items() if contact not in contacts for name in loads.charges}
    unused |= set() if "line" in contacts else set(OF_A_LINE)
    unused |= set() if any(kind.air for kind in cases.kinds) else {*OF_A_GAP}
    unused |= set() if any(kind.space for kind in cases.kinds) else {*OF_SPACE}
    unused |= {name for outline in PROFILES.values() if outline.space for name in outline.may} - takes
    unused |= set() if "patch_size" in arrays else {*OF_AN_ELECTRODE}
    unused |= {*OF_HEAT}  # which the contact does not know
    spared |= {"patch", "cut"} | unused
    defaults = {name: value for name, value in defaults.items() if name not in unused}
    if "interface_magnetic" not in {*arrays, *spared}:
        spared |= {"interface_magnetic"}
        defaults["interface_magnetic"] = "grounded on a rigid base and bonded on others"
    if "patch_size" in arrays and "patch" not in arrays:
        defaults["patch"] = "disc below a point and strip below a line"
    return defaults | {name: names[0] for name, names in CHOICES.items() if name not in arrays and name not in spared}


def _kinds(arrays: Mapping[str, xr.DataArray], name: str) -> list[Any]:
    """Return the distinct values of a factor, none if it is not given."""
    return list(dict.fromkeys(arrays[name].values.ravel().tolist())) if name in arrays else []
