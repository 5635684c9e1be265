"""The structured process against a dense one, against interpolation, and its invariants."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest
import xarray as xr
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import NDArray

from surrogate import GridGP, Input
from surrogate.data.inputs import physical_points
from surrogate.gp.factors import Factor
from surrogate.gp.gridgp import level_errors
from tests.surrogate import functions

Array = NDArray[np.float64]
FactorKernel = Callable[[Array, Array], Array]
PLANE = (Input("x", -1.0, 3.0), Input("y", 0.1, 10.0, "log"), Input("z", 0.0, 1.0))


def sample(counts: Sequence[int]) -> xr.Dataset:
    x, y, z = functions.grid(PLANE, counts).coords.values()
    return xr.Dataset({"f": np.exp(0.3 * x) / (1 + 0.2 * y) + z * np.cos(x), "g": np.sin(x) * np.log(y) * (1 + z**3)})


def unit_points(count: int) -> Array:
    return np.random.default_rng(7).uniform(-1, 1, (count, 3))


def dense_posterior(
    kernels: Sequence[FactorKernel], levels: Sequence[Array], values: Array, t: Array
) -> tuple[Array, Array]:
    """Mean and covariance at t (B, d) given values (n_1, ..., n_d); the prior has mean 0 and variance 1."""
    grid = np.stack(np.meshgrid(*levels, indexing="ij"), axis=-1).reshape(-1, len(levels))
    pairs = [(grid, grid), (t, grid), (t, t)]
    K, cross, prior = (np.prod([k(u[:, f], v[:, f]) for f, k in enumerate(kernels)], axis=0) for u, v in pairs)
    weights = np.linalg.solve(K, cross.T)
    return weights.T @ values.ravel(), np.asarray(prior - cross @ weights)


def chebyshev_kernel(levels: int, rho: float, amplitude: float) -> FactorKernel:
    """1 + amplitude sum_{0<m<2n} rho^m T_m T_m, and 1 + amplitude T_1 T_1 on two levels."""
    terms = 2 if levels == 2 else 2 * levels
    weights = amplitude * (np.ones(2) if levels == 2 else rho ** np.arange(terms))
    weights[0] = 1
    return lambda x, y: (chebvander(x, terms - 1) * weights) @ chebvander(y, terms - 1).T


def dense_kernels(model: GridGP, counts: tuple[int, ...], p: int) -> list[FactorKernel]:
    fixed = [model.hyperparameters_[input_.name] for input_ in PLANE]
    return [
        chebyshev_kernel(n, rho, model.amplitude_[f, p]) for f, (n, rho) in enumerate(zip(counts, fixed, strict=True))
    ]


@pytest.mark.parametrize("rho", [0.3, 0.5, 0.8])
@pytest.mark.parametrize("counts", [(3, 4, 2), (5, 3, 4)])
def test_it_agrees_with_a_dense_process(rho: float, counts: tuple[int, ...]) -> None:
    data, fixed = sample(counts), {"x": rho, "y": rho / 2, "z": 0.3}
    model = GridGP(PLANE, hyperparameters=fixed, compression=0).fit(data)
    t = unit_points(40)
    mean, std = model.predict_array(physical_points(PLANE, t.T), return_std=True)
    unit = [input_.to_unit(data[input_.name].values) for input_ in PLANE]
    for p, name in enumerate(model.outputs_):
        values = data[name].transpose("x", "y", "z").values
        offset, scale = values.mean(), values.std()
        kernels = dense_kernels(model, counts, p)
        want, covariance = dense_posterior(kernels, unit, (values - offset) / scale, t)
        np.testing.assert_allclose(mean[:, p], offset + scale * want, rtol=0, atol=1e-10 * np.ptp(values))
        room = 1e-10 * model.variance_[p]
        variance = model.variance_[p] * np.diag(covariance)
        np.testing.assert_allclose((std[:, p] / scale) ** 2, variance, rtol=0, atol=room)


def test_the_variance_of_a_derivative_is_that_of_a_dense_difference_quotient() -> None:
    counts, step = (5, 3, 2), 1e-3
    data = sample(counts)
    model = GridGP(PLANE, hyperparameters={"x": 0.5, "y": 0.4, "z": 0.6}, compression=0).fit(data)
    levels, t = [input_.to_unit(data[input_.name]) for input_ in PLANE], unit_points(12)
    X = physical_points(PLANE, t.T)
    slopes = model.gradient(X, return_std=True)
    for p, name in enumerate(model.outputs_):
        kernels = dense_kernels(model, counts, p)
        size = model.variance_[p] * data[name].values.std() ** 2
        for k, input_ in enumerate(PLANE):
            ends = np.concatenate([t + step * np.eye(3)[k], t - step * np.eye(3)[k]])
            _, C = dense_posterior(kernels, levels, data[name].transpose("x", "y", "z").values, ends)
            above, below = np.diag(C)[:12], np.diag(C)[12:]
            want = size * (above + below - 2 * np.diag(C[:12, 12:])) / (2 * step) ** 2
            std = slopes[f"{name}_std"].sel(input=input_.name).values / input_.unit_slope(X[:, k])
            np.testing.assert_allclose(std**2, want, rtol=1e-4, atol=1e-7 * size)


def test_leave_one_level_out_errors_are_those_of_refitting_without_the_level() -> None:
    input_, n = PLANE[0], 6
    levels = input_.levels(n)
    t = input_.to_unit(levels)
    values = np.stack([np.exp(levels), np.sin(2 * levels)])
    factor = Factor(n, 0.4)
    inside = (factor.basis.T @ values.T)[:, :, None] * (factor.basis.T @ values.T)[:, :, None].transpose(2, 1, 0)
    errors, variances = level_errors(factor, inside.transpose(1, 0, 2))
    k = chebyshev_kernel(n, 0.4, 1.0)
    for i in range(n):
        others = np.arange(n) != i
        for p in range(2):
            mean, variance = dense_posterior([k], [t[others]], values[p, others], t[i : i + 1, None])
            assert errors[p, i] == pytest.approx((values[p, i] - mean[0]) ** 2, rel=1e-6, abs=1e-12)
            assert variances[i] == pytest.approx(variance[0, 0], rel=1e-6)


def test_compression_keeps_its_tolerance() -> None:
    data, held = functions.factorial((12, 5, 5, 5, 2)), functions.scattered(3000, seed=8)
    points = held[[input_.name for input_ in functions.INPUTS]]
    full = GridGP(inputs=functions.INPUTS, compression=0).fit(data).predict(points)
    for tolerance in (1e-3, 1e-6, 1e-9):
        model = GridGP(inputs=functions.INPUTS, compression=tolerance).fit(data)
        short = model.predict(points)
        for p, name in enumerate(model.outputs_):
            error = float(np.sqrt(((short[name] - full[name]) ** 2).mean()))
            assert 0 < error <= tolerance * model.scale_[p]


def test_an_output_that_is_zero_everywhere_has_no_spread() -> None:
    """Rounding that keeps logarithms finite is no spread: calibrated or not, of one point or of many."""
    x = Input("x", 0.0, 1.0)
    data = xr.Dataset({"f": ("x", np.exp(x.levels(5))), "g": ("x", np.zeros(5))}, coords={"x": x.levels(5)})
    model = GridGP(inputs=[x]).fit(data)
    drawn = np.random.default_rng(0).uniform(0, 1, 60)
    held = xr.Dataset({"f": ("case", np.exp(drawn)), "g": ("case", np.zeros(60))}, coords={"x": ("case", drawn)})
    for points in (np.array([[0.3]]), np.array([[0.3], [0.7]])):
        for fitted in (model, model.calibrate(held)):
            std, ends = fitted.predict_array(points, return_std=True)[1], np.array(fitted.interval_array(points))
            assert (std[:, 0] > 0).all()
            assert not std[:, 1].any()
            assert not ends[..., 1].any()
