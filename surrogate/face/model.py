"""The face that all surrogates share: fitted, judged on cases, calibrated, and made of other models."""

from collections.abc import Mapping
from copy import copy
from functools import partial
from typing import ClassVar, Self

import numpy as np
import xarray as xr

from approximation.arrays import Array
from surrogate.data.inputs import unit_coordinates
from surrogate.data.points import EVEN, named_points, require_inside
from surrogate.face.physical import in_blocks
from surrogate.face.predictive import Predictive
from surrogate.face.summary import page, text
from surrogate.intervals.calibration import MINIMUM
from surrogate.intervals.conformal import calibrate
from surrogate.intervals.sharing import sharing


class GaussianProcess(Predictive):
    """Base of the surrogates: several outputs over named inputs, each a distribution at every point.

    Subclasses fit on a data set and answer at scaled coordinates (`Core`); this class checks, labels and scales. They
    are no estimators of scikit-learn, which take plain arrays: `surrogate.FactorialRegressor` is one, over them.

    Attributes
    ----------
    inputs_ : tuple of Input
        Inputs of the fitted model.
    outputs_ : tuple of str
        Names of its outputs.
    attrs_ : dict
        `units` and `long_name` of every output.
    calibration_ : Calibration or None
        What `calibrate` has learnt; None before.
    cases_ : int
        Number of cases that it was trained on.
    region_ : Region or None
        Where in the box it has answers; None where that is all of it.
    made_from_ : str
        A word of the caller's that tells what the model was made from, kept in its file; empty by default.

    Examples
    --------
    >>> from surrogate import GridGP, Input
    >>> x, y = Input("x", 0, 1), Input("y", 1, 2)
    >>> grid = xr.Dataset(coords={"x": x.levels(7), "y": y.levels(7)})
    >>> model = GridGP(inputs=[x, y]).fit(grid.assign(f=np.exp(grid.x) * grid.y, g=grid.x + grid.y))
    >>> isinstance(model, GaussianProcess), list(model.box), model.parts
    (True, ['x', 'y'], 2)
    >>> found = model.predict({"x": [0.2, 0.4], "y": 1.5})
    >>> found["g"].values.round(6).tolist(), list(found.data_vars)
    ([1.7, 1.9], ['f', 'f_std', 'g', 'g_std'])
    >>> model.gradient({"x": 0.2, "y": 1.5})["g"].values.round(6).tolist()
    [1.0, 1.0]
    >>> model.predict_array(np.array([[0.2, 1.5]])).shape, model.gradient_array(np.array([[0.2, 1.5]])).shape
    ((1, 2), (1, 2, 2))

    Held-out cases make means and intervals right:

    >>> rng = np.random.default_rng(0)
    >>> cases = xr.Dataset({"x": ("case", rng.uniform(0, 1, 300)), "y": ("case", rng.uniform(1, 2, 300))})
    >>> cases = cases.assign(f=np.exp(cases.x) * cases.y, g=cases.x + cases.y)
    >>> model.score(cases) > 0.999999, sorted(model.cases(cases)[1])
    (True, ['f', 'g'])
    >>> median = model.calibrate(cases).quantile({"x": 0.2, "y": 1.5}, 0.5)
    >>> bool(abs(median["f"] - 1.5 * np.exp(0.2)) < 1e-6)
    True
    >>> model.sample({"x": 0.2, "y": 1.5}, n=5, seed=0)["f"].shape
    (5,)
    >>> lower, upper = model.interval_array(np.array([[0.2, 1.5]]))
    >>> bool((lower < upper).all()), model.calibrated, model.distribution.cases
    (True, True, 300)
    >>> least, most = model.ends_of_sum(np.array([[0.2, 1.5]]), np.array([[1.0, -1.0]]))  # of f - g
    >>> bool(least < 0 < most), model.everywhere() is model, model.within(None).region_
    (True, True, None)
    >>> float(model.reached(np.array(1.0), np.array(0.1), np.array(-2.0)))
    0.8
    >>> model.require_answers(np.array([[0.2, 1.5]]))
    >>> model.has_answers(np.array([[0.2, 1.5], [0.2, 3.0]])).tolist()
    [True, False]
    >>> model.check_level(0.9)
    >>> model.calibrate_under(cases, np.stack([cases.x, cases.y - 1])).calibrated  # by inputs of another
    True
    >>> model.only(["g"]).outputs_, model.thinned({"f": 1e-3}).outputs_, model.uncalibrated().calibration_
    (('g',), ('f', 'g'), None)
    """

    MEMBERS: ClassVar[tuple[str, ...]] = ()
    made_from_: str = ""

    def fit(self, X: xr.Dataset) -> Self:
        """Fit to a data set that holds inputs and outputs."""
        raise NotImplementedError(f"a {type(self).__name__} is not fitted to a data set")

    @property
    def members(self) -> Mapping[str, "GaussianProcess"]:
        """Models that it is made of, by the names of `MEMBERS`: a file holds them too."""
        return {}

    def over(self, members: Mapping[str, "GaussianProcess"]) -> Self:
        """Return the same over other models than those that it is made of; ValueError unless they fit."""
        return self

    @property
    def calibrated(self) -> bool:
        """Whether its intervals rest on held-out cases."""
        return self.calibration_ is not None

    def __str__(self) -> str:
        return text(self) if hasattr(self, "inputs_") else f"{type(self).__name__}, not fitted yet"

    def _repr_html_(self) -> str:
        """What a notebook shows: what `print` says, the box as a table."""
        return page(self) if hasattr(self, "inputs_") else f"<p><b>{type(self).__name__}</b>, not fitted yet</p>"

    def score(self, X: xr.Dataset, y: xr.Dataset | None = None) -> float:
        """Return the coefficient of determination R2 averaged over the outputs.

        Parameters
        ----------
        X : Dataset
            Cases with inputs and outputs: the kind of data set that `fit` takes, or scattered cases.
        y : Dataset, optional
            The outputs, when X holds the inputs only.
        """
        points, truth = self.cases(X if y is None else X.merge(y, join="exact"))
        mean = self.predict(points, return_std=False)
        scores = []
        for name in self.outputs_:
            true, predicted = xr.broadcast(truth[name], mean[name])
            spread = float(((true - true.mean()) ** 2).sum())
            error = float(((true - predicted) ** 2).sum())
            scores.append(1 - error / spread if spread else float(error == 0))
        return float(np.mean(scores))

    def cases(self, dataset: xr.Dataset) -> tuple[dict[str, xr.DataArray], xr.Dataset]:
        """Take a data set of cases, factorial or scattered, apart into points and true outputs.

        Raises ValueError for an input or output that it lacks.
        """
        self._require_fitted()
        for name in [own.name for own in self.inputs_] + list(self.outputs_):
            if name not in dataset.variables:
                raise ValueError(f"{name!r} is not in the data set; it has {', '.join(map(str, dataset.variables))}")
        return {own.name: dataset[own.name] for own in self.inputs_}, dataset[list(self.outputs_)]

    def calibrate(self, dataset: xr.Dataset) -> Self:
        """Make means and distributions right on held-out cases: marginally, and in slabs and corners of the box.

        The means of a grid on Chebyshev-Gauss levels are corrected by what the cases tell of their error (module
        `correction`); others stay as they are. The distributions are made to hold at every level (module `conformal`).

        Parameters
        ----------
        dataset : Dataset
            Held-out cases, inputs and true outputs over one dimension; 10,000 spread over the box are a good number,
            3,000 leave corners of two inputs about 5 % short, and 500 give the right marginal coverage. They must not
            serve for validation as well. Where some are drawn towards the ends of the box, the variable
            `evenly_drawn`, over the same dimension, is 1 for those that are spread evenly and 0 for these.

        Raises
        ------
        ValueError
            Missing variables, NaN, a case outside the box, or fewer than 40 cases.
        """
        return self.calibrate_under(dataset, None)

    def calibrate_under(self, dataset: xr.Dataset, outer: Array | None) -> Self:
        """As `calibrate`, for a model that stands on this one.

        Parameters
        ----------
        dataset
            As for `calibrate`.
        outer : ndarray, shape (e, n), or None
            Scaled coordinates of the cases in the inputs by which that model is asked.
        """
        points, truth = self.cases(dataset)
        named = named_points(points, self.inputs_)
        require_inside(named.X, self.inputs_)
        drawn = np.ones(len(named.X)) if EVEN not in dataset else dataset[EVEN].values.ravel()
        even = drawn > 0
        if np.count_nonzero(even) < MINIMUM:
            raise ValueError(
                f"calibration needs at least {MINIMUM} cases, got {np.count_nonzero(even)}; about 10,000 make it local"
            )
        t = unit_coordinates(self.inputs_, named.X)
        like = named.labelled(np.zeros(len(named.X)), {})
        true = np.stack([named.flat(truth[name], like) for name in self.outputs_])
        bad = ~np.isfinite(true).all(axis=1)
        if bad.any():
            raise ValueError(f"output {self.outputs_[int(bad.argmax())]!r} is not finite in a case of the calibration")
        mean = self.uncalibrated().means(t)
        single = np.repeat(np.eye(self.parts)[..., None], len(self.outputs_), axis=2)  # weights of one part alone
        parts = [in_blocks(t, partial(self.variance, weights=weights)) for weights in single]
        groups = sharing(t)
        left = self.corrected(dataset, true - mean, t, groups)
        self.calibration_ = calibrate(left, parts, t, groups, even, outer)
        return self

    def uncalibrated(self) -> Self:
        """Return the model without what `calibrate` has learnt."""
        plain = copy(self)
        plain.calibration_ = None
        return plain
