"""Other methods on complete factorials, behind one face: tensor Chebyshev and cubic splines, a Kronecker process."""

from collections.abc import Callable, Sequence
from functools import reduce

import numpy as np
from scipy.interpolate import NdBSpline, make_interp_spline
from scipy.optimize import minimize

from approximation.arrays import Array
from approximation.chebyshev import coefficients, polynomials
from benchmarks.rivals import Predict
from surrogate.use.baseline import contracted

#: From the scaled levels of every factor and standardised outputs (n_1, ..., n_d, p) to a predictor.
GridFit = Callable[[Sequence[Array], Array], Predict]
# Noise of the Kronecker process, as a share of its variance: what double precision needs.
_NOISE = 1e-10


def _chebyshev(levels: Sequence[Array], values: Array) -> Predict:
    """The tensor polynomial through all cases; the transform belongs to the fit."""
    kept = reduce(coefficients, range(len(levels)), values)

    def predict(at: Array, with_std: bool) -> tuple[Array, None]:
        rows = [polynomials(column, len(own)).T for column, own in zip(at.T, levels, strict=True)]
        return contracted(kept, rows), None

    return predict


def _cubic_spline(levels: Sequence[Array], values: Array) -> Predict:
    """The tensor product of cubic splines, not-a-knot; of lower degree along a factor with fewer than four levels."""
    knots, degrees, kept = [], [min(3, len(own) - 1) for own in levels], values
    for axis, (own, degree) in enumerate(zip(levels, degrees, strict=True)):
        spline = make_interp_spline(own, kept, degree, axis=axis)
        knots.append(spline.t)
        kept = np.moveaxis(spline.c, 0, axis)  # the spline keeps its axis first
    interpolant = NdBSpline(tuple(knots), np.ascontiguousarray(kept), tuple(degrees))
    return lambda at, with_std: (np.asarray(interpolant(at)), None)


def kronecker(levels: Sequence[Array], values: Array) -> Predict:
    """A Gaussian process an output with an RBF kernel a factor, by marginal likelihood, in plain numpy.

    The covariance is a Kronecker product (Y. Saatci, Scalable Inference for Structured Gaussian Process Models, 2011,
    chapter 5): eigenvectors of every factor's matrix diagonalise it, and mean and variance are contractions over the
    whole grid.

    levels: sequence of ndarray, shape (n_f,), of every factor in [-1, 1]; values: (n_1, ..., n_d, p), the outputs.
    """
    parts = [_process(levels, own) for own in np.moveaxis(values, -1, 0)]

    def predict(at: Array, with_std: bool) -> tuple[Array, Array | None]:
        pairs = [part(at, with_std) for part in parts]
        mean = np.stack([mean for mean, _ in pairs], axis=1)
        return mean, np.stack([std for _, std in pairs], axis=1) if with_std else None

    return predict


def _process(levels: Sequence[Array], values: Array) -> Callable[[Array, bool], tuple[Array, Array]]:
    def decomposed(logs: Array) -> tuple[list[Array], Array, Array]:
        """Eigenvectors, the eigenvalues of the whole, and the data in the eigenvectors."""
        pairs = [np.linalg.eigh(_rbf(own, own, np.exp(log))) for own, log in zip(levels, logs, strict=True)]
        vectors = [vector for _, vector in pairs]
        spectrum = reduce(np.multiply.outer, [np.maximum(value, 0.0) for value, _ in pairs]) + _NOISE
        return vectors, spectrum, _transformed(values, vectors)

    def loss(logs: Array) -> float:
        _, spectrum, data = decomposed(logs)
        # the variance of the process is profiled out
        return float(values.size * np.log((data**2 / spectrum).mean()) + np.log(spectrum).sum())

    bounds = [(np.log(0.2), np.log(20.0))] * len(levels)
    fit = minimize(
        loss, np.full(len(levels), 0.7), method="L-BFGS-B", bounds=bounds, options={"maxiter": 50, "eps": 1e-4}
    )
    vectors, spectrum, data = decomposed(fit.x)
    variance = float((data**2 / spectrum).mean())
    weights = _transformed(data / spectrum, [vector.T for vector in vectors])

    def predict(at: Array, with_std: bool) -> tuple[Array, Array]:
        near = [_rbf(column, own, np.exp(log)) for column, own, log in zip(at.T, levels, fit.x, strict=True)]
        mean = contracted(weights[..., None], near)[:, 0]
        if not with_std:
            return mean, mean
        squares = [(rows @ vector) ** 2 for rows, vector in zip(near, vectors, strict=True)]
        known = contracted(1 / spectrum[..., None], squares)[:, 0]
        return mean, np.sqrt(variance * np.maximum(1 - known, 0.0))

    return predict


def _rbf(a: Array, b: Array, length: float) -> Array:
    return np.asarray(np.exp(-0.5 * ((a[:, None] - b) / length) ** 2))


def _transformed(values: Array, bases: Sequence[Array]) -> Array:
    """Multiply every axis by the transpose of its basis."""
    for basis in bases:
        values = np.tensordot(values, basis, (0, 0))  # the axis moves to the end, so after all the order is the old
    return values


GRID_RIVALS: dict[str, GridFit] = {
    "tensor Chebyshev interpolation": _chebyshev,
    "cubic grid spline (scipy NdBSpline)": _cubic_spline,
    "Kronecker RBF GP (numpy)": kronecker,
}
