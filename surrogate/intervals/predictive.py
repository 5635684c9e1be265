"""Predictive distributions at points: intervals at any level, quantiles and samples, from means and deviations."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from approximation.arrays import Array, Flags
from surrogate.data.labels import Attrs, Labels
from surrogate.data.points import Points, Queries
from surrogate.intervals.conformal import Calibration
from surrogate.intervals.distribution import NOMINAL, Distribution, Normal

#: Attributes of the variable that tells where an answer is outside of the trained box.
EXTRAPOLATED = {"extrapolated": {"long_name": "outside the trained box"}}


class Predictive(ABC):
    """Outputs that are their mean plus their standard deviation times a standardised error of a known distribution.

    Attributes
    ----------
    level_ : float
        Level of its intervals where none is said.
    """

    outputs_: tuple[str, ...]
    attrs_: dict[str, dict[str, str]]
    calibration_: Calibration | None
    level_: float = NOMINAL
    _made_labels: Labels | None = None
    # ends of one level, with what they were made from: a query alone asks for the same again and again
    _made_ends: tuple[Calibration | None, float, Array] | None = None

    @abstractmethod
    def predict(self, points: Queries, return_std: bool = True, *, extrapolate: bool = False) -> xr.Dataset:
        """Return every output, with its standard deviation, at labelled points."""

    @abstractmethod
    def predict_array(
        self, X: NDArray[np.floating[Any]], return_std: Literal[True], *, extrapolate: bool = False
    ) -> tuple[Array, Array]:
        """Return means and standard deviations at plain points, (n, d) -> two of (n, n_outputs)."""

    @abstractmethod
    def _asked(
        self, points: Queries, with_std: bool, extrapolate: bool
    ) -> tuple[Points, list[Array], dict[str, Flags]]:
        """Return points, means and, if wanted, deviations, (p, n), and what lies outside, with `extrapolate`."""

    def _labels(self) -> Labels:
        if self._made_labels is None or self._made_labels.attrs is not self.attrs_:
            self._made_labels = Labels(self.attrs_)
        return self._made_labels

    @property
    def distribution(self) -> Distribution:
        """Distribution of (truth - mean) / std: what the calibration cases say, a normal one without them."""
        return Normal() if self.calibration_ is None else self.calibration_.distribution

    def interval(self, points: Queries, level: float | None = None, *, extrapolate: bool = False) -> xr.Dataset:
        """Return the ends of the interval that holds the true value of an output in a share `level` of the cases.

        As many true values lie above it as below. Before `calibrate` it is the process's own interval, which may not
        hold.

        Parameters
        ----------
        points, extrapolate
            As for `predict`.
        level : float, optional
            Share, 0 < level < 1, by default `level_`; n calibration cases tell levels up to 1 - 2/(n + 1), and up to
            0.999.

        Returns
        -------
        Dataset
            `<output>_lower` and `<output>_upper` over the broadcast dimensions.

        Raises
        ------
        OutOfBoxError, ValueError
            As for `predict`; a level that the calibration cases do not tell.

        Examples
        --------
        >>> import numpy as np, xarray as xr
        >>> from surrogate import GridGP, Input
        >>> x, y = Input("x", 0, 1), Input("y", 0, 1)
        >>> def truth(x, y):
        ...     return np.exp(x * y) / (1 + x)
        >>> grid = xr.Dataset(coords={"x": x.levels(6), "y": y.levels(4)})
        >>> model = GridGP(inputs=[x, y]).fit(grid.assign(f=truth(grid.x, grid.y)))
        >>> rng = np.random.default_rng(0)
        >>> cases = xr.Dataset({name: ("case", rng.uniform(size=500)) for name in "xy"})
        >>> found = model.calibrate(cases.assign(f=truth(cases.x, cases.y))).interval({"x": 0.3, "y": 0.8}, level=0.9)
        >>> bool(found["f_lower"] <= truth(0.3, 0.8) <= found["f_upper"])
        True
        """
        level = self.checked_level(level)
        named, (mean, std), flags = self._asked(points, True, extrapolate)
        away = self._ends(level)[..., None]
        ends = {"lower": mean + away[0] * std, "upper": mean + away[1] * std}
        values = {f"{name}_{end}": ends[end][k] for k, name in enumerate(self.outputs_) for end in ends}

        def attrs() -> Attrs:
            of = f"end of the {100 * level:g} % interval of"
            own = {
                f"{name}_{end}": {**told, "long_name": f"{end} {of} {told.get('long_name', name)}"}
                for name, told in self.attrs_.items()
                for end in ends
            }
            return {**own, **EXTRAPOLATED}

        return self._labels().dataset(("interval", level, extrapolate), named, values | flags, attrs)

    def quantile(self, points: Queries, q: float | Sequence[float], *, extrapolate: bool = False) -> xr.Dataset:
        """Return the values that the true output stays below with probability q.

        Parameters
        ----------
        points, extrapolate
            As for `predict`.
        q : float or sequence of float
            Probabilities, as far out as `interval` has levels.

        Returns
        -------
        Dataset
            `<output>` over the broadcast dimensions; with a sequence, over `quantile` before them.

        Raises
        ------
        OutOfBoxError, ValueError
            As for `predict`; a probability that the calibration cases do not tell.
        """
        asked = np.atleast_1d(np.asarray(q, dtype=np.float64))
        if asked.ndim != 1:
            raise ValueError(f"q must be a number or a sequence of numbers, got an array of {asked.ndim} dimensions")
        most = (1 + self.distribution.highest_level()) / 2
        for one in asked[~((1 - most <= asked) & (asked <= most))]:
            raise ValueError(f"q {one:g} is not between {1 - most:.4g} and {most:.10g}{self._told()}")
        found = self._quantiles(points, asked, extrapolate)
        return found if np.ndim(q) else found.isel(quantile=0)

    def sample(self, points: Queries, n: int, seed: int, *, extrapolate: bool = False) -> xr.Dataset:
        """Draw from the predictive distributions, independently for every point and output.

        Parameters
        ----------
        points, extrapolate
            As for `predict`.
        n : int
            Draws, >= 1.
        seed : int
            The same seed gives the same draws.

        Returns
        -------
        Dataset
            `<output>` over `sample`, then the broadcast dimensions.

        Raises
        ------
        OutOfBoxError, ValueError
            As for `predict`; n below one.
        """
        if n < 1:
            raise ValueError(f"n {n} must be at least 1")
        found = self.predict(points, extrapolate=extrapolate)
        random = np.random.default_rng(seed)
        answer: dict[str, xr.DataArray] = {}
        for k, name in enumerate(self.outputs_):
            mean, std = found[name], found[f"{name}_std"]
            share = random.uniform(np.finfo(float).tiny, 1, (n, *mean.shape))
            away = self.distribution.quantile(share)
            drawn = mean.values + std.values * away[..., k if away.shape[-1] > 1 else 0]
            answer[name] = xr.DataArray(drawn, coords=mean.coords, dims=("sample", *mean.dims), attrs=mean.attrs)
        flags = {"extrapolated": found["extrapolated"]} if extrapolate else {}
        return xr.Dataset(answer | flags)

    def interval_array(
        self, X: NDArray[np.floating[Any]], level: float | None = None, *, extrapolate: bool = False
    ) -> tuple[Array, Array]:
        """Return the lower and upper ends of `interval` at plain points: X (n, d) -> two of (n, n_outputs).

        Raises as `predict_array`, and ValueError for a level that the calibration cases do not tell.
        """
        level = self.checked_level(level)
        mean, std = self.predict_array(X, return_std=True, extrapolate=extrapolate)
        lower, upper = self._ends(level)
        return mean + lower * std, mean + upper * std

    def _ends(self, level: float) -> Array:
        """Ends of the central interval of a level in standard deviations, (2, p) or (2, 1)."""
        made = self._made_ends
        if made is None or made[0] is not self.calibration_ or made[1] != level:
            made = self._made_ends = (self.calibration_, level, self.distribution.ends(level))
        return made[2]

    def checked_level(self, level: float | None) -> float:
        """Return a level that the calibration cases tell, by default `level_`; ValueError as `check_level`."""
        chosen = self.level_ if level is None else level
        self.check_level(chosen)
        return chosen

    def check_level(self, level: float) -> None:
        """Raise ValueError, with what is allowed, for a level of intervals that the calibration cases do not tell."""
        most = self.distribution.highest_level()
        if not 0 < level <= most:
            raise ValueError(f"level {level:g} is not between 0 and {most:.10g}{self._told()}")

    def _told(self) -> str:
        """Who sets the bounds of levels, for messages."""
        if self.calibration_ is None:
            return ""
        return f", all that {self.calibration_.distribution.cases} calibration cases tell"

    def _quantiles(self, points: Queries, q: Array, extrapolate: bool) -> xr.Dataset:
        found = self.predict(points, extrapolate=extrapolate)
        away = self.distribution.quantile(q)
        answer: dict[str, xr.Variable] = {}
        for k, name in enumerate(self.outputs_):
            mean, std = found.variables[name], found.variables[f"{name}_std"]
            own = away[:, k if away.shape[1] > 1 else 0].reshape(-1, *[1] * mean.ndim)
            answer[name] = xr.Variable(("quantile", *mean.dims), mean.values + own * std.values, mean.attrs)
        flags = {"extrapolated": found.variables["extrapolated"]} if extrapolate else {}
        along = xr.Variable("quantile", q, {"long_name": "probability of no more"})
        return xr.Dataset(answer | flags, {**found.coords, "quantile": along})
