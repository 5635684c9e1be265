"""Predictive distributions at points: intervals at any level, quantiles and samples, from means and deviations."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from approximation.arrays import Array, Flags
from surrogate.data.labels import Attrs
from surrogate.data.points import Points, Queries
from surrogate.face.labelled import EXTRAPOLATED, Labelled
from surrogate.intervals.calibration import Calibration
from surrogate.intervals.copula import MOST_POINTS
from surrogate.intervals.sums import ends


class Predictive(Labelled):
    """Outputs that are their mean plus their standard deviation times a standardised error of a known distribution."""

    # ends of one level, with what they were made from: a query alone asks for the same again and again
    _made_ends: tuple[Calibration | None, float, Array] | None = None

    def reached(self, mean: Array, std: Array, away: Array) -> Array:
        """Return what lies so many standard deviations away from means.

        Parameters
        ----------
        mean, std : ndarray, shape (p, ...), of the outputs, in their units
        away : ndarray that broadcasts with them, numbers of standard deviations
        """
        return mean + away * std

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
        both = {end: self.reached(mean, std, own) for end, own in zip(("lower", "upper"), away, strict=True)}
        values = {f"{name}_{end}": both[end][k] for k, name in enumerate(self.outputs_) for end in both}

        def attrs() -> Attrs:
            of = f"end of the {100 * level:g} % interval of"
            own = {
                f"{name}_{end}": {**told, "long_name": f"{end} {of} {told.get('long_name', name)}"}
                for name, told in self.attrs_.items()
                for end in both
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
        for probability in asked[~((1 - most <= asked) & (asked <= most))]:
            raise ValueError(f"q {probability:g} is not between {1 - most:.4g} and {most:.10g}{self._told()}")
        named, (mean, std), flags = self._asked(points, True, extrapolate)
        away = np.broadcast_to(self.distribution.quantile(asked).T, (len(mean), len(asked)))[..., None]
        values = self.reached(np.repeat(mean[:, None], len(asked), axis=1), std[:, None], away)
        coordinate = ("quantile", asked, {"long_name": "probability of no more"})
        quantiles = self._stacked("quantile", values, named, flags).assign_coords(quantile=coordinate)
        return quantiles if np.ndim(q) else quantiles.isel(quantile=0)

    def sample(
        self, points: Queries, n: int, seed: int, *, extrapolate: bool = False, together: bool = True
    ) -> xr.Dataset:
        """Draw from the predictive distributions, outputs and points together.

        Errors of outputs go together as those of the held-out cases did, and those of near points by a length along
        every input (module `copula`): a ratio or a difference of what is drawn is as uncertain as it really is. A model
        that is not calibrated, or that measured rows have corrected, knows of no such thing, and draws every point
        and output for itself.

        Parameters
        ----------
        points, extrapolate
            As for `predict`.
        n : int
            Draws, >= 1.
        seed : int
            The same seed gives the same draws.
        together : bool
            Whether points are drawn together, 3,000 of them at most; else each for itself, with its outputs together.

        Returns
        -------
        Dataset
            `<output>` over `sample`, then the broadcast dimensions.

        Raises
        ------
        OutOfBoxError, ValueError
            As for `predict`; n below one; more points than are drawn together; a model whose file, of an earlier
            version, kept no rows of its calibration.
        """
        if n < 1:
            raise ValueError(f"n {n} must be at least 1")
        named, (mean, std), flags = self._asked(points, True, extrapolate)
        share = self._shares(named.X, n, np.random.default_rng(seed), together)
        away = self.distribution.inverse(share.reshape(len(share), -1)).reshape(share.shape)
        drawn = self.reached(np.broadcast_to(mean[:, None], away.shape), std[:, None], away)
        return self._stacked("sample", drawn, named, flags)

    def _shares(self, X: Array, n: int, random: np.random.Generator, together: bool) -> Array:
        """Draw a probability for every output and point (m, d): (p, n, m)."""
        if self.calibration_ is None:
            return random.uniform(np.finfo(float).tiny, 1, (len(self.outputs_), n, len(X)))
        copula = self.calibration_.copula
        if copula is None:
            raise ValueError("the model's file kept no rows of its calibration to draw together: `make run` anew")
        if not together:
            alone = copula.drawn(np.zeros((len(copula.lengths), 1)), n * len(X), random)
            return alone.reshape(len(self.outputs_), n, len(X))
        if len(X) > MOST_POINTS:
            raise ValueError(
                f"{len(X)} points are more than the {MOST_POINTS} that are drawn together; together=False draws each "
                "for itself"
            )
        return copula.drawn(self.calibrated_at(X), n, random)

    def ends_of_sum(self, X: NDArray[np.floating[Any]], weights: Array, level: float | None = None) -> Array:
        """Return the ends of the interval of a weighted sum of outputs at points, less its mean.

        Parameters
        ----------
        X : ndarray, shape (n, d)
            Plain points.
        weights : ndarray, shape (n, n_outputs)
            Of every output at every point, with signs: the derivatives of what follows from the outputs.
        level : float, optional
            As for `interval`.

        Returns
        -------
        ndarray, shape (2,)
            By how errors go together (module `sums`); without a calibration the ends of all of them are added up.

        Raises
        ------
        OutOfBoxError, ValueError
            As `predict_array`; a level that the calibration cases do not tell.
        """
        _, std = self.predict_array(X, return_std=True)
        copula = None if self.calibration_ is None else self.calibration_.copula
        known = self.calibrated_at(np.asarray(X, dtype=np.float64))
        return ends(self.distribution, copula, self.checked_level(level), (weights * std).T, known)

    def interval_array(
        self, X: NDArray[np.floating[Any]], level: float | None = None, *, extrapolate: bool = False
    ) -> tuple[Array, Array]:
        """Return the lower and upper ends of `interval` at plain points, (n, p) each.

        Parameters
        ----------
        X : ndarray, shape (n, d), points in physical units
        level : float, probability of the interval; None: `level_`
        extrapolate : bool, whether points may be outside of the box

        Raises
        ------
        ValueError
            The calibration cases do not tell this level; otherwise as `predict_array`.
        """
        level = self.checked_level(level)
        mean, std = self.predict_array(X, return_std=True, extrapolate=extrapolate)
        lower, upper = (self.reached(mean.T, std.T, away[:, None]).T for away in self._ends(level))
        return lower, upper

    def _ends(self, level: float) -> Array:
        """Ends of the central interval of a level in standard deviations, (2, p) or (2, 1)."""
        made = self._made_ends
        if made is None or made[0] is not self.calibration_ or made[1] != level:
            made = self._made_ends = (self.calibration_, level, self.distribution.ends(level))
        return made[2]

    def _stacked(self, dim: str, values: Array, named: Points, flags: dict[str, Flags]) -> xr.Dataset:
        """Label several values of every output at each point, (p, m, n), over a dimension of these m."""
        dims = (dim, *named.dims)
        each = {
            name: xr.Variable(dims, own.reshape(-1, *named.shape), self.attrs_[name])
            for name, own in zip(self.outputs_, values, strict=True)
        }
        return named.dataset({name: (flag, EXTRAPOLATED[name]) for name, flag in flags.items()}).assign(each)
