"""Measured rows, and surrogates with constants and discrepancies that were learnt from them.

Kennedy and O'Hagan, J. R. Stat. Soc. B 63 (2001) 425: measured = model(input, constants) + discrepancy(input) + noise,
with a discrepancy that is a smooth Gaussian process of the inputs.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Self

import numpy as np
import xarray as xr
from scipy.linalg import cho_solve, cholesky, solve_triangular
from scipy.spatial.distance import cdist
from typing_extensions import override

from approximation.arrays import Array, Indices
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.face.model import GaussianProcess
from surrogate.intervals.distribution import NOMINAL, Normal
from surrogate.transforms.transformed import Transformed

MOST_ROWS = 1000  # measured rows; the cost grows with their cube
_MOST_DRAWS = 64  # in a file


@dataclass(frozen=True)
class Measurements:
    """Measured values as a flat list, with several of them or none in a row."""

    points: Array  # shape (rows, d); inputs of every row, in their units
    row: Indices  # shape (n,); row of every value
    output: Indices  # shape (n,); number of its output; no row has an output twice
    value: Array  # shape (n,); in the output's unit
    error: Array  # shape (n,); standard deviation of its error; NaN if unknown

    def __post_init__(self) -> None:
        if any(map(np.ma.is_masked, (self.points, self.value, self.error))):
            raise ValueError("measured rows hold masked cells; leave these rows out")
        if not np.isfinite(self.points).all() or not np.isfinite(self.value).all():
            raise ValueError("measured rows must hold finite numbers")
        if (self.error <= 0).any() or np.isinf(self.error).any():
            raise ValueError("errors of measurement must be positive and finite, or NaN where unknown")
        if len({*zip(self.row.tolist(), self.output.tolist(), strict=True)}) < len(self.row):
            raise ValueError("an output is measured twice in a row")

    def of(self, output: int) -> Indices:
        """Return the indices of the values of one output."""
        return np.flatnonzero(self.output == output)

    @property
    def outputs(self) -> list[int]:
        """Numbers of the measured outputs, ascending."""
        return [int(number) for number in np.unique(self.output)]


@dataclass(frozen=True)
class Discrepancy:
    """A process a^2 exp(-|x - x'|^2/2) in the scaled inputs over their lengths, known at measured points."""

    points: Array  # shape (n, d); scaled inputs, -1 to 1, of the measured values
    noise: Array  # shape (n,); variance of their errors and of the model's
    amplitude: float  # standard deviation a of the process, in the output's unit
    lengths: Array  # shape (d,); length along every scaled input
    residual: Array  # shape (n,); measured values less the linearised model with the constants at zero
    slopes: Array  # shape (n, k); derivatives of the model by the constants at the points

    def covariance(self, points: Array) -> Array:
        """Return the covariance of the process between scaled points (m, d) and the measured ones: (m, n)."""
        square = cdist(points / self.lengths, self.points / self.lengths, "sqeuclidean")
        return np.asarray(self.amplitude**2 * np.exp(-0.5 * square))

    @cached_property
    def factor(self) -> Array:
        """Lower Cholesky factor of the covariance of the residuals at given constants, (n, n)."""
        covariance = self.covariance(self.points)
        covariance.flat[:: len(covariance) + 1] += self.noise + 1e-10 * self.amplitude**2
        return np.asarray(cholesky(covariance, lower=True))

    @cached_property
    def whitened(self) -> tuple[Array, Array]:
        """Inverse covariance times residuals, (n,), and times slopes, (n, k)."""
        solved = cho_solve((self.factor, True), np.column_stack([self.residual, self.slopes]))
        return solved[:, 0], solved[:, 1:]

    @property
    def information(self) -> tuple[Array, Array]:
        """Precision (k, k) of the constants, and its product with their estimate, (k,)."""
        residual, slopes = self.whitened
        return self.slopes.T @ slopes, self.slopes.T @ residual

    def at(self, points: Array) -> tuple[Array, Array, Array]:
        """Return m0 (m,), m1 (m, k) and the variance (m,) at scaled points (m, d): the mean is m0 - m1 @ constants."""
        return self._conditioned(self.covariance(points), self.amplitude**2)

    def gradient(self, points: Array) -> tuple[Array, Array, Array]:
        """Return m0, m1 and the variance of the derivatives by the scaled inputs: (d, m), (d, m, k), (d, m)."""
        cross = self.covariance(points)
        parts = [
            self._conditioned(
                -(points[:, i, None] - self.points[:, i]) / length**2 * cross, (self.amplitude / length) ** 2
            )
            for i, length in enumerate(self.lengths)
        ]
        mean, by_constants, variance = map(np.stack, zip(*parts, strict=True))
        return mean, by_constants, variance

    def _conditioned(self, cross: Array, prior: float) -> tuple[Array, Array, Array]:
        """Return m0, m1 and the variance from a prior variance and the covariances with the values, (m, n)."""
        residual, slopes = self.whitened
        white = solve_triangular(self.factor, cross.T, lower=True)
        variance = prior - np.einsum("nm,nm->m", white, white)
        return cross @ residual, cross @ slopes, np.maximum(variance, 0)


@dataclass(frozen=True)
class Draw:
    """Posterior of the scaled constants, given one draw of the discrepancies' parameters, errors and outliers."""

    mean: Array  # shape (k,)
    covariance: Array  # shape (k, k)
    discrepancies: Mapping[int, Discrepancy]  # process of every measured output, by its number

    @classmethod
    def of(cls, discrepancies: Mapping[int, Discrepancy], prior: Array) -> "Draw":
        """Return the posterior of scaled constants with prior deviations (k,), zero for known ones."""
        information = summed((discrepancy.information for discrepancy in discrepancies.values()), len(prior))
        return cls(*posterior(*information, prior), discrepancies)


def summed(information: Iterable[tuple[Array, Array]], constants: int) -> tuple[Array, Array]:
    """Return the sums of precisions (k, k) of the constants and of their products with estimates (k,)."""
    precision, weighted = np.zeros((constants, constants)), np.zeros(constants)
    for term, estimate in information:
        precision += term
        weighted += estimate
    return precision, weighted


def posterior(precision: Array, weighted: Array, prior: Array) -> tuple[Array, Array]:
    """Return mean (k,) and covariance (k, k) of normal unknowns with zero prior means and prior deviations (k,)."""
    inner = np.linalg.inv(np.eye(len(prior)) + prior[:, None] * precision * prior)
    covariance = prior[:, None] * (inner + inner.T) / 2 * prior
    return covariance @ weighted, covariance


def moments(parts: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Return mean and variance of an even mixture from the means and variances, any shape, of its parts."""
    means, variances = (np.stack(part) for part in zip(*parts, strict=True))
    return means.mean(axis=0), variances.mean(axis=0) + means.var(axis=0)


def mixture(draws: Sequence[Draw]) -> tuple[Array, Array]:
    """Return mean (k,) and covariance (k, k) of the scaled constants over all draws."""
    means = np.stack([draw.mean for draw in draws])
    deviation = means - means.mean(axis=0)
    inner = np.mean([draw.covariance for draw in draws], axis=0)
    return means.mean(axis=0), inner + deviation.T @ deviation / len(draws)


class CorrectedGP(Transformed):
    """A nominal surrogate, corrected for uncertain constants and discrepancies that measured rows determine.

    An output is the sum of the nominal model, the effect of the constants (k,) about which it was linearised, its
    derivatives by the constants times their deviation, and a discrepancy. Intervals include the errors of the nominal
    model and of the effects, (p,), and the posterior uncertainty of constants and discrepancies.
    """

    engine: ClassVar[str] = "corrected"
    MEMBERS = ("nominal", "effect")
    parts: ClassVar[int] = 1
    nominal_: GaussianProcess
    effect_: GaussianProcess

    def __init__(
        self,
        nominal: GaussianProcess,
        effect: GaussianProcess,
        constants: Mapping[str, str],
        about: Array,
        draws: Sequence[Draw],
        rows: Measurements,
        effect_std: Array,
        learnt: str = "",
    ) -> None:
        self._describe(nominal.inputs_, nominal.outputs_, nominal.attrs_)
        self.cases_, self.level_ = nominal.cases_, nominal.level_
        self.nominal_, self.effect_, self.made_from_ = nominal, effect, nominal.made_from_
        self.constants_, self.about_, self.draws_ = dict(constants), about, tuple(draws)
        self.rows_, self.effect_std_, self.learnt_ = rows, effect_std, learnt

    def _describe(self, inputs: tuple[Input, ...], outputs: Sequence[str], attrs: dict[str, dict[str, str]]) -> None:
        self.inputs_, self.outputs_, self.attrs_ = inputs, tuple(outputs), attrs
        self.calibration_ = None

    def _lay_out(self) -> None:
        if self.nominal_.inputs_ != self.inputs_ or self.nominal_.outputs_ != self.outputs_:
            raise ValueError("the nominal model has other inputs or outputs")
        if self.effect_.inputs_ != self.inputs_ or len(self.effect_.outputs_) != len(self.outputs_) * self._each:
            raise ValueError("the effects have other inputs, or not an output for every output and constant")

    def only(self, outputs: Sequence[str]) -> Self:
        """Return the model itself, since its constants depend on all measured outputs."""
        return self

    @property
    def calibrated(self) -> bool:
        """Return True if the nominal model is calibrated on held-out cases."""
        return self.nominal_.calibrated

    @property
    def posterior(self) -> tuple[Array, Array]:
        """Posterior mean (k,) and covariance (k, k) of the scaled constants; a priori zero and the identity."""
        return mixture(self.draws_)

    @property
    def _each(self) -> int:
        """Number of outputs of `effect_` for every output."""
        return 1 + len(self.constants_)

    @override
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array]:
        X = self.physical(t)
        base, std = self.nominal_.predict_array(X, return_std=True, extrapolate=True)
        effect = self.effect_.predict_array(X, extrapolate=True).T.reshape(len(self.outputs_), self._each, -1)
        mean, variance = self._shifts(effect, lambda discrepancy: discrepancy.at(t.T))
        mean += base.T
        if weights is None:
            return mean, np.zeros_like(mean)
        reach = np.abs(self.nominal_.distribution.ends(NOMINAL)).max(axis=0) / Normal().ends(NOMINAL)[1]
        variance += (std * reach).T ** 2 + self.effect_std_[:, None] ** 2
        return mean, weights[0][:, None] * variance

    def _shifts(self, effect: Array, known: Callable[[Discrepancy], tuple[Array, Array, Array]]) -> tuple[Array, Array]:
        """Return mean and variance over all draws, (..., p, B) each, of the shift of nominal means or slopes.

        effect: (..., p, 1 + k, B), of the constants; known: returns a discrepancy's `at` or `gradient`.
        """
        parts = []
        for draw in self.draws_:
            slopes = np.moveaxis(effect[..., 1:, :], -2, -1).copy()
            mean = effect[..., 0, :] - slopes @ self.about_
            variance = np.zeros_like(mean)
            for q, discrepancy in draw.discrepancies.items():
                shift, by_constants, variance[..., q, :] = known(discrepancy)
                mean[..., q, :] += shift
                slopes[..., q, :, :] -= by_constants
            variance += np.einsum("...bk,kl,...bl->...b", slopes, draw.covariance, slopes)
            parts.append((mean + slopes @ draw.mean, variance))
        return moments(parts)

    @override
    def slopes(self, t: Array) -> Array:
        return self._slope_moments(t)[0]

    @override
    def slope_variances(self, t: Array, weights: Array) -> Array:
        return np.asarray(weights[0][:, None] * self._slope_moments(t)[1])

    def _slope_moments(self, t: Array) -> tuple[Array, Array]:
        """Return means and variances of the slopes, (d, p, B) each."""
        effect = self._derivatives(self.effect_, t)[0].reshape(len(t), len(self.outputs_), self._each, -1)
        shift, variance = self._shifts(effect, lambda discrepancy: discrepancy.gradient(t.T))
        nominal, nominal_variance = self._derivatives(self.nominal_, t)
        return nominal + shift, nominal_variance + variance

    def _derivatives(self, model: GaussianProcess, t: Array) -> tuple[Array, Array]:
        """Return a member's derivatives by the scaled inputs, and their variances, (d, p, B) each."""
        X = self.physical(t)
        gradient = model.gradient(X, return_std=True, extrapolate=True)
        chain = self.unit_slopes(X)
        mean, std = (
            np.stack([gradient[f"{name}{part}"].values for name in model.outputs_], 1) for part in ("", "_std")
        )
        return mean / chain, (std / chain) ** 2

    @override
    def state(self) -> xr.Dataset:
        rows, names, first = self.rows_, list(self.constants_), self.draws_[0].discrepancies
        mean, covariance = self.posterior
        dim = "measurement"
        state = xr.Dataset(
            {
                "constant_prior": ("constant", list(self.constants_.values())),
                "constant_mean": ("constant", mean),
                "constant_std": ("constant", np.sqrt(np.diag(covariance))),
                "constant_covariance": (("constant", "other_constant"), covariance),
                "constant_about": ("constant", self.about_),
                "error_of_effects": ("output", self.effect_std_),
                "row_point": (("row", "input"), rows.points),
                "measured_row": (dim, rows.row),
                "measured_output": (dim, rows.output),
                "measured_value": (dim, rows.value),
                "measured_error": (dim, np.nan_to_num(rows.error, nan=0.0)),
                "measured_residual": (dim, self._flat([part.residual for part in first.values()])),
                "measured_slope": ((dim, "constant"), self._flat([part.slopes for part in first.values()])),
                "draw_mean": (("draw", "constant"), np.stack([draw.mean for draw in self.draws_])),
                "draw_covariance": (
                    ("draw", "constant", "other_constant"), np.stack([draw.covariance for draw in self.draws_]),
                ),
                "draw_noise": (("draw", dim), np.stack([
                    self._flat([draws_of.noise for draws_of in draw.discrepancies.values()]) for draw in self.draws_
                ])),
                "draw_amplitude": (("draw", "discrepancy"), np.array([
                    [discrepancy.amplitude for discrepancy in draw.discrepancies.values()] for draw in self.draws_
                ])),
                "draw_length": (("draw", "discrepancy", "input"), np.array([
                    [discrepancy.lengths for discrepancy in draw.discrepancies.values()] for draw in self.draws_
                ])),
            },
            coords={"constant": names, "discrepancy": [self.outputs_[q] for q in first]},
        )  # fmt: skip
        return state.assign_attrs(learnt=self.learnt_)

    def _flat(self, parts: Sequence[Array]) -> Array:
        """Join parts, one per measured output, into an array over the measured values."""
        whole = np.empty((len(self.rows_.value), *parts[0].shape[1:]))
        for q, part in zip(self.rows_.outputs, parts, strict=True):
            whole[self.rows_.of(q)] = part
        return whole

    @override
    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        model = cls.__new__(cls)
        model._describe(inputs, tuple(outputs), outputs)
        arrays = {str(name): stored[name].values for name in stored.data_vars}
        error = arrays["measured_error"]
        output, row = (arrays[f"measured_{name}"].astype(np.intp) for name in ("output", "row"))
        points = stored["row_point"].transpose("row", "input").values
        if len(points) > MOST_ROWS or stored.sizes["draw"] > _MOST_DRAWS:
            raise ValueError(f"more than {MOST_ROWS} measured rows, or than {_MOST_DRAWS} draws")
        if not (set(output.tolist()) <= set(range(len(outputs))) and set(row.tolist()) <= set(range(len(points)))):
            raise ValueError("a measured value is of no output or no row")
        rows = Measurements(points, row, output, arrays["measured_value"], np.where(error > 0, error, np.nan))
        model.rows_, model.about_, model.effect_std_ = rows, arrays["constant_about"], arrays["error_of_effects"]
        model.constants_ = dict(zip(stored["constant"].values.tolist(), arrays["constant_prior"].tolist(), strict=True))
        model.learnt_ = str(stored.attrs["learnt"])
        scaled = unit_coordinates(inputs, points).T
        draws = []
        for k in range(stored.sizes["draw"]):
            discrepancies = {}
            for number, q in enumerate(rows.outputs):
                place = rows.of(q)
                discrepancies[q] = Discrepancy(
                    scaled[row[place]], arrays["draw_noise"][k, place], float(arrays["draw_amplitude"][k, number]),
                    arrays["draw_length"][k, number],
                    arrays["measured_residual"][place], arrays["measured_slope"][place],
                )  # fmt: skip
            draws.append(Draw(arrays["draw_mean"][k], arrays["draw_covariance"][k], discrepancies))
        model.draws_ = tuple(draws)
        return model
