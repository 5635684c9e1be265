"""Interface of a model: posterior at scaled coordinates, training data, and state in files."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import ClassVar, Self

import xarray as xr

from approximation.arrays import Array, Indices
from surrogate.data.inputs import Input


class Core(ABC):
    """A model of p outputs over d inputs, asked at B points in scaled coordinates (d, B), which a file can hold."""

    engine: ClassVar[str]  # name of the kind in files
    inputs_: tuple[Input, ...]  # of the fitted model
    outputs_: tuple[str, ...]  # names of its outputs
    attrs_: dict[str, dict[str, str]]  # `units` and `long_name` of every output
    cases_: int  # number of cases that it was trained on

    @property
    @abstractmethod
    def parts(self) -> int:
        """Number of parts that the variance is the sum of."""

    @abstractmethod
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array | None]:
        """Return mean and variance, (p, B) each.

        Parameters
        ----------
        t : ndarray, shape (d, B), scaled coordinates
        weights : ndarray, shape (parts, p), of the parts of the variance; None: no variance
        """

    @abstractmethod
    def slopes(self, t: Array) -> Array:
        """Return the derivatives of the means by the scaled coordinates, (d, p, B)."""

    @abstractmethod
    def slope_variances(self, t: Array, weights: Array) -> Array:
        """Return the weighted variances of these derivatives, (d, p, B).

        Parameters
        ----------
        t : ndarray, shape (d, B), scaled coordinates
        weights : ndarray, shape (parts, p), of the parts of the variance
        """

    @abstractmethod
    def state(self) -> xr.Dataset:
        """Return what a file must hold beside inputs, outputs, probes and calibration."""

    @classmethod
    @abstractmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        """Return the model of a state.

        Parameters
        ----------
        stored : Dataset, what `state` gave
        inputs : tuple of Input
        outputs : dict, `units` and `long_name` of every output

        Raises
        ------
        ValueError
            What is inconsistent, by its name.
        """

    def only(self, outputs: Sequence[str]) -> Self:
        """Return a model that gives these outputs, and as few others as it can, for less."""
        return self

    def thinned(self, errors: Mapping[str, float]) -> Self:
        """Return a cheaper model, with these root-mean-square errors over the cases of some outputs, in their units."""
        return self

    def corrected(self, dataset: xr.Dataset, errors: Array, t: Array, groups: Indices) -> Array:
        """Learn to correct the means from held-out cases; return what is left of the error of each case, left out.

        Parameters
        ----------
        dataset : Dataset, the cases; it may hold more than the outputs
        errors : ndarray, shape (p, n), true minus predicted
        t : ndarray, shape (d, n), scaled coordinates of the cases
        groups : ndarray of int, shape (n,), number of the group of every case; the cases of one share some coordinates
        """
        return errors
