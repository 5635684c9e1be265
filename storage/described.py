"""Attributes of files: meaning and unit of every variable, title and source of the file.

UDUNITS, by which other programs read units, knows whole exponents only: it reads ``C m-3/2`` as 0.5 C m-3. In a file
such a quantity is divided by the square root of 1 m. Its number stays, `units` are those that UDUNITS reads correctly,
`long_name` mentions the division, and `si_units` keeps the unit for people.
"""

import re
from collections.abc import Callable, Hashable, Mapping
from importlib.metadata import version
from typing import Any

import xarray as xr

LICENSE = "MIT"
SI_UNITS = "si_units"
_ROOT = re.compile(r"(^| )m(-?\d*[13579])/2(?= |$)")
_SCALED = ", divided by the square root of 1 m"


def described(dataset: xr.Dataset, title: str, source: str, meanings: Mapping[str, str]) -> xr.Dataset:
    """Return a copy in which every variable has `long_name` and `units`, and the data set `title` and `source`."""
    copy = dataset.copy()
    for name, variable in copy.variables.items():
        plain = str(name).rstrip("0123456789").removesuffix("_")
        meaning = meanings.get(str(name), meanings.get(plain))
        said = {"long_name": meaning, "units": "1"} if meaning else {"units": "1"}
        variable.attrs = {**said, **variable.attrs}
    return copy.assign_attrs({"title": title, "source": source, **copy.attrs})


def standard(dataset: xr.Dataset) -> dict[str, str]:
    """Return the attributes of every file by CF and ACDD, without date and machine: equal data give equal files."""
    title = dataset.attrs.get("title") or "data set"
    sizes = ", ".join(f"{dim} ({size})" for dim, size in dataset.sizes.items()) or "nothing"
    names = ", ".join(str(name) for name in dataset.data_vars)
    return {
        "Conventions": "CF-1.11",
        "summary": f"{title}: {names} over {sizes}",
        "history": f"written by meecontact {version('meecontact')}",
        "license": LICENSE,
    }


def scaled(attrs: Mapping[Any, Any]) -> dict[Hashable, Any]:
    """Return a variable's attributes as in a file, with units that UDUNITS reads."""
    units = attrs.get("units")
    if not isinstance(units, str) or not (root := _ROOT.search(units)):
        return dict(attrs)
    whole = (int(root[2]) - 1) // 2
    other_units = _ROOT.sub(f" m{whole}" if whole not in (0, 1) else " m" * whole, units, count=1).strip()
    name = f"{attrs.get('long_name', 'the quantity')}{_SCALED}"
    return {**attrs, "units": other_units or "1", "long_name": name, SI_UNITS: units}


def unscaled(attrs: Mapping[Any, Any]) -> dict[Hashable, Any]:
    """Undo `scaled`."""
    if SI_UNITS not in attrs:
        return dict(attrs)
    plain = {key: value for key, value in attrs.items() if key != SI_UNITS}
    return {**plain, "units": attrs[SI_UNITS], "long_name": str(attrs.get("long_name", "")).removesuffix(_SCALED)}


def as_stored(dataset: xr.Dataset) -> xr.Dataset:
    """Return a copy whose variables have the attributes of a file."""
    return _changed(dataset.copy(), scaled)


def as_meant(dataset: xr.Dataset) -> xr.Dataset:
    """Return the data set of a file itself, which its reader closes, with units as people write them."""
    return _changed(dataset, unscaled)


def _changed(dataset: xr.Dataset, change: Callable[[Mapping[Any, Any]], dict[Hashable, Any]]) -> xr.Dataset:
    for variable in dataset.variables.values():
        variable.attrs = change(variable.attrs)
    return dataset
