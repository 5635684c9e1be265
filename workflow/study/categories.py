"""Categories of a study, which take one of a few names: a surrogate's outputs are ``quantity[names]``, one for each."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import product

import xarray as xr

from workflow.language import titles

#: Name of every category in one combination.
Combination = dict[str, str]


def combinations(categories: Mapping[str, Sequence[str]]) -> list[Combination]:
    """Return every combination of names; one empty combination without categories."""
    return [dict(zip(categories, names, strict=True)) for names in product(*categories.values())]


def named(combination: Mapping[str, str]) -> str:
    """Return the names of a combination between commas."""
    return ", ".join(combination.values())


def output(quantity: str, combination: Mapping[str, str]) -> str:
    """Return the surrogate's name of a quantity of one combination."""
    return f"{quantity}[{named(combination)}]" if combination else quantity


def parted(output: str) -> tuple[str, str]:
    """Return the quantity and the names of a combination, empty without any, from a surrogate's output."""
    quantity, _, names = output.removesuffix("]").partition("[")
    return quantity, names


def titled(output: str) -> str:
    """Return a surrogate's output in words."""
    quantity, names = parted(output)
    return titles.title(quantity) + (f": {names.replace('_', ' ')}" if names else "")


def apart(data: xr.Dataset, categories: Mapping[str, Sequence[str]], quantities: Iterable[str]) -> xr.Dataset:
    """Return quantities without the categories' dimensions: one variable for each quantity and combination."""
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
