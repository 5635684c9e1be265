"""The structured process against a dense one, interpolation, refits and its cross approximation."""

from collections.abc import Callable, Sequence
from math import prod
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.polynomial.chebyshev import chebval, chebvander
from numpy.typing import NDArray

from surrogate import CrossGP, GridGP, Input, load, save
from surrogate.data.inputs import physical_points
from surrogate.face import model as face_model
from surrogate.gp import correction, imputation
from surrogate.gp.correction import correct, degrees
from surrogate.gp.factors import Factor
from surrogate.gp.gridgp import level_errors
from surrogate.levels import counts, lines
from surrogate.use.sensitivity import sobol
from surrogate.use.validation import validate
from tests.refusals import assert_refused
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


COUNTS = (16, 6, 5, 6, 3)


@pytest.mark.parametrize("weighted", [False, True])
def test_the_remainder_of_a_case_is_that_of_a_fit_to_the_others(
    weighted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(1)
    levels, rho = (7, 5), (0.2, 0.1)
    t, scale = rng.uniform(-1, 1, (2, 150)), rng.uniform(0.1, 3, 150)
    error = (np.sin(9 * t[0]) * np.exp(t[1]))[None]
    monkeypatch.setattr(correction, "LEAST_GAIN", 0.0 if weighted else np.inf)
    monkeypatch.setattr(correction, "_rough_scale", lambda left, t: scale)
    groups = np.concatenate([np.arange(100), np.full(20, 100), np.full(30, 101)])
    correction_, left = correct(error, t, levels, rho, groups)
    assert correction_ is not None
    terms = np.stack(
        [
            chebval(t[f], np.eye(n + 1)[n])
            * np.prod([chebval(x, np.eye(a + 1)[a]) for x, a in zip(t, row, strict=True)], 0)
            for f, n in enumerate(levels)
            for row in correction_.indices
        ],
        axis=1,
    )
    root = scale**-0.25 if weighted else np.ones(150)
    for case in (0, 17, 149):
        others = groups != groups[case]
        fitted = np.linalg.lstsq(terms[others] * root[others, None], (error[0] * root)[others], rcond=1e-12)[0]
        assert left[0, case] == pytest.approx(error[0, case] - terms[case] @ fitted, rel=1e-6)


def test_cases_beyond_the_most_are_held_out_from_the_regression(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(2)
    t = rng.uniform(-1, 1, (2, 500))
    error = np.stack([np.sin(9 * t[0]) * np.exp(t[1]), np.cos(7 * t[0] * t[1])])
    indices = degrees((0.2, 0.1), 500)
    assert indices is not None
    monkeypatch.setattr(correction, "MOST_CASES", 300)
    monkeypatch.setattr(face_model, "BLOCK", 64)
    correction_, left = correct(error, t, (7, 5), (0.2, 0.1), np.arange(500))
    assert correction_ is not None
    np.testing.assert_allclose(left[:, 300:], (error - correction_.values(t))[:, 300:], rtol=0, atol=1e-12)
    assert left.shape == error.shape


def test_an_error_that_no_term_explains_leaves_the_mean_alone() -> None:
    rng = np.random.default_rng(3)
    error = rng.standard_normal((2, 400))
    correction_, left = correct(error, rng.uniform(-1, 1, (2, 400)), (7, 5), (0.2, 0.1), np.arange(400))
    assert correction_ is not None
    assert not correction_.coefficients.any()
    np.testing.assert_array_equal(left, error)


def test_a_corrected_mean_is_far_better_on_fresh_cases_and_in_its_gradient() -> None:
    model = GridGP(inputs=functions.INPUTS).fit(functions.factorial(COUNTS))
    model.calibrate(functions.scattered(2000, seed=1))
    fresh = functions.scattered(2000, seed=2)
    table = validate(model, fresh, None).sel(output=["near_pole", "smooth", "ratio", "no_bias"])
    assert bool((table["rmse"] < 0.3 * table["raw_rmse"]).all())
    assert float((table["rmse"] / table["raw_rmse"]).median()) < 0.1
    points, true = functions.true_slopes(fresh[list(model.box)].isel(case=slice(200)), functions.INPUTS[0])
    plain, corrected = model.uncalibrated().gradient(points), model.gradient(points)
    for name in ("near_pole", "no_bias"):
        slopes = (gradient[name].sel(input=functions.INPUTS[0].name) for gradient in (plain, corrected))
        before, after = (float(np.abs(slope - true[name]).max()) for slope in slopes)
        assert after < 0.5 * before


def test_factors_that_do_not_tell_what_is_missing_are_filled_all_along() -> None:
    """The same as of the whole grid with the same kernel, where the hole is small enough to be filled in at once."""
    random = np.random.default_rng(3)
    factors = [Factor(n, 0.3) for n in (5, 4, 6)]
    values = random.normal(size=(5, 4, 6, 2))
    holes = np.zeros((5, 4, 6), dtype=bool)
    holes[3:, :, 4:] = True
    result = imputation.expected(factors, values, holes)
    turned = imputation.expected(
        [factors[k] for k in (1, 0, 2)], values.transpose(1, 0, 2, 3), holes.transpose(1, 0, 2)
    )
    filled = np.zeros((5, 4, 6, 2))
    filled[holes] = result
    np.testing.assert_allclose(filled.transpose(1, 0, 2, 3)[holes.transpose(1, 0, 2)], turned, rtol=1e-9)
    # K^-1 y is zero there: by dense matrices, which share no code
    K = np.ones((1, 1))
    for n, factor in zip((5, 4, 6), factors, strict=True):
        T = np.cos(np.arange(2 * n) * np.arccos(factor.t)[:, None])
        K = np.kron(K, T @ np.diag([1.0, *(0.3 ** np.arange(1, 2 * n))]) @ T.T)
    whole = np.where(holes[..., None], filled, values).reshape(-1, 2)
    left = np.linalg.solve(K, whole)[holes.ravel()]
    assert np.abs(left).max() < 1e-6 * np.abs(np.linalg.solve(K, whole)).max()


BOX = tuple(Input(name, 0.0, 1.0) for name in "uvwxyz")
LEVELS = {"u": 4, "v": 6, "w": 5, "x": 7, "y": 6, "z": 4}
CROSSED = ("x", "y", "v", "u")


def truth(x: xr.Dataset) -> xr.Dataset:
    smooth = np.exp(x.x * x.y + x.z * x.w + 0.3 * x.u * x.v) / (2 + x.x)
    return xr.Dataset({"f": smooth, "g": np.cos(x.w + x.x + x.y) + x.z * x.v, "h": x.u + 0 * x.x})


def crossing(tolerance: float = 1e-9, most: int = 10_000) -> CrossGP:
    return CrossGP(BOX, LEVELS, CROSSED, tolerance, compression=1e-11, most=most)


def solved(places: xr.Dataset) -> xr.Dataset:
    whole = {input_.name: input_.levels(LEVELS[input_.name]) for input_ in BOX if input_.name not in CROSSED}
    return places.assign_coords(whole).pipe(lambda points: points.assign(truth(points)))


def asked(model: CrossGP) -> tuple[xr.Dataset, float]:
    """Cases of all places that a model asks for, and its error."""
    data = solved(model.ask(None))
    while "place" in (places := model.ask(data)).sizes:
        data = xr.concat([data, solved(places)], "place", data_vars="all")
    return data, float(places["error"].max())


@pytest.fixture(scope="module")
def cases() -> xr.Dataset:
    data, error = asked(crossing())
    assert error <= 1e-9
    return data


def test_no_place_is_asked_for_twice_and_the_most_ends_the_sweeps() -> None:
    data, error = asked(crossing(1e-15, most=30))
    places = np.stack([data[name] for name in CROSSED], axis=1)
    assert len(np.unique(places, axis=0)) == len(places) > 30
    assert error > 1e-15


@pytest.fixture(scope="module")
def grid() -> xr.Dataset:
    return truth(xr.Dataset(coords={input_.name: input_.levels(LEVELS[input_.name]) for input_ in BOX}))


@pytest.fixture(scope="module")
def model(cases: xr.Dataset) -> CrossGP:
    return crossing().fit(cases)


def test_it_is_the_process_of_the_whole_grid(
    model: CrossGP, grid: xr.Dataset, cases: xr.Dataset, tmp_path: Path
) -> None:
    whole = GridGP(inputs=BOX, compression=1e-11).fit(grid)
    X = np.random.default_rng(0).uniform(size=(60, len(BOX)))
    (mean, std), (expected, spread) = model.predict_array(X, return_std=True), whole.predict_array(X, return_std=True)
    np.testing.assert_allclose(mean, expected, atol=1e-7)
    np.testing.assert_allclose(std, spread, rtol=0.02, atol=1e-12)
    np.testing.assert_allclose(model.gradient_array(X), whole.gradient_array(X), atol=1e-5)
    np.testing.assert_allclose(sobol(model)["total"], sobol(whole)["total"], atol=1e-6)
    assert model.places_ == cases.sizes["place"] < prod(LEVELS[name] for name in CROSSED) / 2
    assert max(model.error_.values()) <= 1e-9
    save(model, tmp_path / "model.nc")
    assert isinstance(load(tmp_path / "model.nc"), GridGP)


def test_lines_of_the_cases_decay_as_those_of_the_grid(cases: xr.Dataset, grid: xr.Dataset) -> None:
    line_decays, grid_decays = lines.decays(crossing(), cases), counts.decays(grid, BOX)
    assert list(line_decays) == list(grid_decays)
    for output, along in grid_decays.items():
        for name, decay in along.items():
            coefficients = line_decays[output][name].coefficients
            assert (coefficients <= decay.coefficients * (1 + 1e-9) + 1e-12).all()
            assert coefficients[1] >= 0.3 * decay.coefficients[1] - 1e-12


def test_missing_and_bad_cases_are_named(cases: xr.Dataset) -> None:
    assert_refused(ValueError, r"\d+ places are still to be solved", crossing().fit, cases.isel(place=slice(0, 40)))
    with pytest.raises(ValueError, match=r"input .x.: 0\.1234 is none of its 7 levels"):
        crossing().fit(cases.assign(x=("place", np.full(cases.sizes["place"], 0.1234))))
    assert_refused(ValueError, "output 'f' is not finite", crossing().fit, cases.assign(f=cases["f"] * np.nan))
    assert_refused(ValueError, "crossed and levels must name inputs", CrossGP, BOX, LEVELS, ("x", "q"), 1e-3)
