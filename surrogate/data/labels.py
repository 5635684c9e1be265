"""Answers under their names: data sets by xarray's rules; those of plain numbers are copied from one made before."""

from collections.abc import Callable, Hashable, Mapping
from typing import Any

import xarray as xr
from numpy.typing import NDArray

from surrogate.data.points import Points

Attrs = Mapping[str, Mapping[str, str]]


class Labels:
    """Maker of a model's data sets."""

    def __init__(self, attrs: Attrs) -> None:
        self.attrs = attrs
        self._forms: dict[Hashable, xr.Dataset] = {}

    def dataset(
        self, kind: Hashable, named: Points, values: Mapping[str, NDArray[Any]], attrs: Callable[[], Attrs]
    ) -> xr.Dataset:
        """Label one value per point of every name."""
        if named.dims:
            return self._made(named, values, attrs())
        numbers = {name: array.reshape(()) for name, array in values.items()}
        form = self._forms.get(kind)
        if form is None:
            self._forms[kind] = form = self._made(named, values, attrs())
        # to check the names, shapes and coordinates of an answer costs more than the answer: the first one's are kept
        copied = form.copy(data=numbers)
        for name, coord in named.coords.items():
            copied.variables[name].values = coord.values
        return copied

    @staticmethod
    def _made(named: Points, values: Mapping[str, NDArray[Any]], attrs: Attrs) -> xr.Dataset:
        return named.dataset({name: (array, attrs[name]) for name, array in values.items()})
