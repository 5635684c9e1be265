"""Categories of a study: composite, profile, material and the like, which take one of a few names.

A Gaussian process over continuous factors knows no names. It learns every quantity of every combination of them as an
output of its own, ``quantity[names]``: all of them share the factorial, and a query answers them at once.
"""

from collections.abc import Iterable, Mapping, Sequence
from itertools import product

import xarray as xr

from workflow.language import titles

#: The name that every category takes.
Combination = dict[str, str]


def combinations(categories: Mapping[str, Sequence[str]]) -> list[Combination]:
    """Every combination of names; one without any where there are no categories."""
    return [dict(zip(categories, names, strict=True)) for names in product(*categories.values())]


def named(combination: Mapping[str, str]) -> str:
    """A combination in words."""
    return ", ".join(combination.values())


def output(quantity: str, combination: Mapping[str, str]) -> str:
    """Name in the surrogate of a quantity of one combination."""
    return f"{quantity}[{named(combination)}]" if combination else quantity


def parted(output: str) -> tuple[str, str]:
    """The quantity and the names of a combination, of what `output` calls them; no names where there are none."""
    quantity, _, names = output.removesuffix("]").partition("[")
    return quantity, names


def titled(output: str) -> str:
    """The same in words."""
    quantity, names = parted(output)
    return titles.title(quantity) + (f": {names.replace('_', ' ')}" if names else "")


def apart(data: xr.Dataset, categories: Mapping[str, Sequence[str]], quantities: Iterable[str]) -> xr.Dataset:
    """Quantities without the categories' dimensions: each of every combination as a variable of its own."""
    if not categories:
        return data[list(quantities)]
    parts: dict[str, xr.DataArray] = {}
    for combination in combinations(categories):
        for name in quantities:
            array = data[name].sel(combination).drop_vars(list(combination))
            if combination:
                array = array.assign_attrs(long_name=f"{array.attrs['long_name']}, {named(combination)}")
            parts[output(name, combination)] = array
    return xr.Dataset(parts, attrs=data.attrs)
