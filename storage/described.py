"""Files that say what they hold: every variable has its meaning and its unit, the file its title and its source."""

from collections.abc import Mapping

import xarray as xr


def described(dataset: xr.Dataset, title: str, source: str, meanings: Mapping[str, str]) -> xr.Dataset:
    """A copy in which every variable has `long_name` and `units`, and the data set `title` and `source`.

    What a variable says of itself stays. A name with a number at its end means what it means without.

    Parameters
    ----------
    dataset
        Any; what has a unit of its own says so already, all else is a plain number, or a text.
    title, source
        What the data set is, and how it was made.
    meanings
        `long_name` by name.
    """
    copy = dataset.copy()
    for name, variable in copy.variables.items():
        plain = str(name).rstrip("0123456789").removesuffix("_")
        meaning = meanings.get(str(name), meanings.get(plain))
        said = {"long_name": meaning, "units": "1"} if meaning else {"units": "1"}
        variable.attrs = {**said, **variable.attrs}
    return copy.assign_attrs({"title": title, "source": source, **copy.attrs})
