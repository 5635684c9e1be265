"""Files that say what they hold: every variable has its meaning and its unit, the file its title and its source."""

from collections.abc import Mapping
from importlib.metadata import version

import xarray as xr

LICENSE = "MIT"


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
    """Attributes that every file has, by CF and ACDD. No date and no machine: equal data give equal files."""
    title = dataset.attrs.get("title") or "data set"
    sizes = ", ".join(f"{dim} ({size})" for dim, size in dataset.sizes.items()) or "nothing"
    names = ", ".join(str(name) for name in dataset.data_vars)
    return {
        "Conventions": "CF-1.11",
        "summary": f"{title}: {names} over {sizes}",
        "history": f"written by meecontact {version('meecontact')}",
        "license": LICENSE,
    }
