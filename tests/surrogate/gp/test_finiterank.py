"""The process of finite rank against dense linear algebra, its kernel against its sum, its noise against one given."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import NDArray

from approximation.arrays import Indices
from storage.netcdf import read_whole, write_whole
from storage.sealed import FormatError
from surrogate import FactorialRegressor, Input, ScatterGP, load, save
from surrogate.gp import finiterank, scattergp
from surrogate.gp.finiterank import FiniteRank, largest
from surrogate.gp.kernels import Chebyshev
from surrogate.use.validation import validate

Array = NDArray[np.float64]
INPUTS = (Input("x", -1.0, 1.0), Input("y", 1.0, 100.0, "log"), Input("z", 0.0, 2.0))
KERNEL = Chebyshev(np.array([0.4, 0.9, 0.1]), np.array([0.5, 0.2, 0.7]))
NOISE = 0.05


def scaled(count: int, seed: int = 0) -> Array:
    return np.random.default_rng(seed).uniform(-1, 1, (3, count))


def truth(t: Array) -> Array:
    return np.stack([np.exp(t[0] * t[1]) + t[2] ** 3, 1 / (1.5 - t[0]) * np.cos(2 * t[1])], axis=1)


def cases(count: int, seed: int, noise: float = NOISE) -> xr.Dataset:
    """Inputs and outputs with noise, over `case`; the first output has five times the noise of the second."""
    t = scaled(count, seed)
    values = truth(t) + noise * np.array([1, 0.2]) * np.random.default_rng(seed + 100).normal(size=(count, 2))
    columns = {input_.name: ("case", input_.from_unit(row)) for input_, row in zip(INPUTS, t, strict=True)}
    return xr.Dataset({**columns, "f": ("case", values[:, 0], {"units": "K"}), "g": ("case", values[:, 1])})


def features(indices: Indices, t: Array) -> Array:
    """prod_j T_{a_j}(t_j), by numpy's polynomials: (r, B)."""
    tables = [chebvander(x, int(indices.max())) for x in t]
    return np.stack([np.prod([T[:, a] for T, a in zip(tables, index, strict=True)], axis=0) for index in indices])


def coefficients(degrees: int) -> Array:
    """Of T_0 .. T_degrees of every input, (3, degrees + 1)."""
    first, rho = KERNEL.first[:, None], KERNEL.rho[:, None]
    return np.concatenate([np.ones((3, 1)), first * rho ** np.arange(degrees)], axis=1)


def test_the_kernel_is_the_sum_of_its_terms() -> None:
    points, others = scaled(20), scaled(15, seed=1)
    want = np.ones((20, 15))
    for x, y, row in zip(points, others, coefficients(200), strict=True):
        want *= (chebvander(x, 200) * row) @ chebvander(y, 200).T
    np.testing.assert_allclose(KERNEL(points.T, others.T), want, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(KERNEL.diag(points.T), np.diag(KERNEL(points.T)), rtol=1e-12)


def test_the_slopes_of_the_kernel_are_differences() -> None:
    points, others, step = 0.9 * scaled(8).T, 0.9 * scaled(6, seed=1).T, 1e-5
    by_parameter = KERNEL(points, others, eval_gradient=True)[1]
    for k in range(6):
        ends = [KERNEL.clone_with_theta(KERNEL.theta + sign * step * np.eye(6)[k])(points, others) for sign in (1, -1)]
        np.testing.assert_allclose(by_parameter[..., k], (ends[0] - ends[1]) / (2 * step), rtol=1e-6, atol=1e-8)
    for k, slope in enumerate(KERNEL.slopes(points, others)):
        shift = step * np.eye(3)[k]
        want = (KERNEL(points + shift, others) - KERNEL(points - shift, others)) / (2 * step)
        np.testing.assert_allclose(slope, want, rtol=1e-6, atol=1e-8)
        ends = [np.diag(KERNEL.slopes(points, points + sign * shift)[k]) for sign in (1, -1)]
        np.testing.assert_allclose(KERNEL.steepness(points)[k], (ends[0] - ends[1]) / (2 * step), rtol=1e-5)


def test_features_are_those_of_the_largest_weights() -> None:
    indices, weights = largest(KERNEL, 60)
    rows = coefficients(25)
    all_weights = {a: float(np.prod(rows[range(3), a])) for a in product(range(26), repeat=3)}
    assert sorted(all_weights.values(), reverse=True)[:60] == pytest.approx(weights.tolist(), rel=1e-14)
    assert [all_weights[tuple(index)] for index in indices.tolist()] == pytest.approx(weights.tolist(), rel=1e-14)
    assert len({tuple(index) for index in indices.tolist()}) == 60


@pytest.mark.parametrize("noise", [0.05, 0.0])
def test_the_posterior_is_that_of_dense_linear_algebra(noise: float) -> None:
    t, query = scaled(120), scaled(9, seed=1)
    y = truth(t) + noise * np.random.default_rng(2).normal(size=(120, 2))
    model = FiniteRank.fit(t, y, 30, 0)
    prior = model.directions @ model.directions.T
    np.testing.assert_allclose(prior, np.diag(np.diag(prior)), atol=1e-12 * prior.max())
    phi, new = features(model.indices, t), features(model.indices, query)
    step = 1e-5 * np.eye(3)[1][:, None]
    slope = (features(model.indices, query + step) - features(model.indices, query - step)) / 2e-5
    mean, _ = model.mean_variance(query, None)
    new_case = model.mean_variance(query, np.ones((2, 2)))[1]
    known = model.mean_variance(query, np.array([[1.0, 1.0], [0.0, 0.0]]))[1]
    assert new_case is not None
    assert known is not None
    for p in range(2):
        offset, scale = y[:, p].mean(), y[:, p].std()
        K = model.signal[p] * phi.T @ prior @ phi + model.noise[p] * np.eye(120)
        target = np.linalg.solve(K, (y[:, p] - offset) / scale)
        for computed, cross in ((mean[p], new), (model.slopes(query)[1, p], slope)):
            want = scale * model.signal[p] * cross.T @ prior @ phi @ target
            np.testing.assert_allclose(computed, want + (offset if cross is new else 0), rtol=1e-5, atol=1e-5 * scale)
        for computed, cross in ((known[p], new), (model.slope_variances(query, np.ones((2, 2)))[1, p], slope)):
            k = model.signal[p] * cross.T @ prior @ phi
            before = model.signal[p] * np.einsum("rb,rs,sb->b", cross, prior, cross)
            want = scale**2 * (before - np.einsum("bn,nb->b", k, np.linalg.solve(K, k.T)))
            np.testing.assert_allclose(computed, want, rtol=1e-3, atol=1e-9 * scale**2 * before.max())
        np.testing.assert_allclose(new_case[p] - known[p], scale**2 * model.noise[p], rtol=1e-6, atol=1e-14)

        def cost(signal: float, noise: float, p: int = p) -> float:
            K = signal * phi.T @ prior @ phi + noise * np.eye(120)
            z = (y[:, p] - y[:, p].mean()) / y[:, p].std()
            return float(np.linalg.slogdet(K)[1] + z @ np.linalg.solve(K, z))

        best = cost(model.signal[p], model.noise[p])
        for a, b in ((1.1, 1), (0.9, 1), (1, 1.1), (1, 0.9)):
            assert cost(a * model.signal[p], b * model.noise[p]) > best


def test_noise_is_found_and_intervals_of_new_cases_hold(many: ScatterGP) -> None:
    assert isinstance(many.process_, FiniteRank)
    sigma = np.sqrt(many.process_.noise) * many.process_.scale
    np.testing.assert_allclose(sigma, [NOISE, 0.2 * NOISE], rtol=0.04)
    table = validate(many, cases(4000, seed=5), None)
    assert (np.abs(table["coverage"] - 0.95) < 0.015).all()
    exact = cases(500, seed=6, noise=0.0)
    error = many.predict(exact[["x", "y", "z"]])[["f", "g"]] - exact[["f", "g"]]
    assert float(np.sqrt((error["f"] ** 2).mean())) < 0.3 * NOISE
    assert many.predict(exact[["x", "y", "z"]])["f_std"].attrs["units"] == "K"


@pytest.fixture(scope="module")
def many() -> ScatterGP:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(finiterank, "SUBSET", 300)  # the decay is learnt well enough from these
        return ScatterGP(inputs=INPUTS, rank=150).fit(cases(3000, seed=0))


def test_an_altered_file_is_refused(many: ScatterGP, tmp_path: Path) -> None:
    save(many, tmp_path / "model.nc")
    stored = read_whole(tmp_path / "model.nc")
    for change, says in (
        ({"feature_degree": stored["feature_degree"] + 1000}, "degrees that none has"),
        ({"noise_variance": -stored["noise_variance"]}, "negative variance"),
    ):
        write_whole(stored.assign(change), tmp_path / "altered.nc")
        with pytest.raises(FormatError, match=says):
            load(tmp_path / "altered.nc")


def test_the_number_of_cases_decides_the_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scattergp, "MANY", 30)
    few, many = (ScatterGP(inputs=INPUTS).fit(cases(count, 0, 0.0)) for count in (30, 31))
    assert len(few.regressors_) == 2
    assert isinstance(many.process_, FiniteRank)
    assert len(many.process_.indices) == 15
    assert isinstance(ScatterGP("chebyshev", INPUTS).fit(cases(30, 0)).process_, FiniteRank)
    t = scaled(40)
    model = FactorialRegressor().fit(t.T, truth(t))
    assert isinstance(model.model_, ScatterGP)
    assert isinstance(model.model_.process_, FiniteRank)
    assert model.score(t.T, truth(t)) > 0.99


def test_a_constant_output_and_too_few_cases() -> None:
    data = cases(60, 0).assign(c=("case", np.full(60, 3.0)))
    answer = ScatterGP("chebyshev", INPUTS).fit(data).predict(data[["x", "y", "z"]])
    np.testing.assert_allclose(answer["c"], 3.0, rtol=1e-12)
    assert float(answer["c_std"].max()) < 1e-6
    with pytest.raises(ValueError, match="needs at least 2 cases, got 1"):
        ScatterGP("chebyshev", INPUTS).fit(cases(1, 0))
    with pytest.raises(ValueError, match="rank 0 must be at least 1"):
        ScatterGP("chebyshev", INPUTS, rank=0).fit(cases(9, 0))
