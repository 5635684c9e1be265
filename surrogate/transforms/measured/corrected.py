"""A surrogate that measured rows have corrected: its constants moved, discrepancies added, both uncertain."""

from collections.abc import Callable, Mapping, Sequence
from typing import ClassVar, Self

import numpy as np
import xarray as xr
from typing_extensions import override

from approximation.arrays import Array
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.data.measurements import MOST_ROWS, Measurements
from surrogate.face.model import GaussianProcess
from surrogate.intervals.distribution import NOMINAL, Normal
from surrogate.transforms.measured.discrepancy import Discrepancy, Draw, mixture, moments
from surrogate.transforms.transformed import Transformed

_MOST_DRAWS = 64  # that a file may hold


class CorrectedGP(Transformed):
    """A nominal surrogate, the effects of uncertain constants on it, and what measured rows say of both.

    An output is that of the nominal model, plus the effect of the constants about which it was linearised, plus its
    derivatives by the constants times these, plus the discrepancy of a measured output. The intervals hold the nominal
    model's own error, that of the effects, and what is left unknown of constants and discrepancies.

    about: (k,); effect_std: (p,).
    """

    engine: ClassVar[str] = "corrected"
    MEMBERS = ("nominal", "effect")
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
        """Return the model itself: its constants are those of all outputs that were measured."""
        return self

    def _unchanged(self) -> set[str]:
        return set(self.outputs_)

    @property
    def calibrated(self) -> bool:
        """Return True if the intervals rest on held-out cases of the nominal model too."""
        return self.nominal_.calibrated

    @property
    def parts(self) -> int:
        """Number of parts of the variance: one."""
        return 1

    @property
    def posterior(self) -> tuple[Array, Array]:
        """Mean (k,) and covariance (k, k) of the scaled constants; a priori zero and the identity."""
        return mixture(self.draws_)

    @property
    def _each(self) -> int:
        """Outputs of the effects for every output."""
        return 1 + len(self.constants_)

    @override
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array | None]:
        X = self.physical(t)
        base, std = self.nominal_.predict_array(X, return_std=True, extrapolate=True)
        effect = self.effect_.predict_array(X, extrapolate=True).T.reshape(len(self.outputs_), self._each, -1)
        mean, variance = self._shifts(effect, lambda discrepancy: discrepancy.at(t.T))
        mean += base.T
        if weights is None:
            return mean, None
        reach = np.abs(self.nominal_.distribution.ends(NOMINAL)).max(axis=0) / Normal().ends(NOMINAL)[1]
        variance += (std * reach).T ** 2 + self.effect_std_[:, None] ** 2
        return mean, weights[0][:, None] * variance

    def _shifts(self, effect: Array, known: Callable[[Discrepancy], tuple[Array, Array, Array]]) -> tuple[Array, Array]:
        """Shift of the nominal means or slopes over all draws, and its variance, (..., p, B) each.

        effect: (..., p, 1 + k, B), of the constants; known: takes a discrepancy, gives `at` or `gradient`.
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
        """Means and variances of the slopes, (d, p, B) each."""
        effect = self._derivatives(self.effect_, t)[0].reshape(len(t), len(self.outputs_), self._each, -1)
        shift, variance = self._shifts(effect, lambda discrepancy: discrepancy.gradient(t.T))
        nominal, own_variance = self._derivatives(self.nominal_, t)
        return nominal + shift, own_variance + variance

    def _derivatives(self, model: GaussianProcess, t: Array) -> tuple[Array, Array]:
        """Derivatives of a member by the scaled inputs, and their variances, (d, p, B) each."""
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
        """Join parts, one a measured output, into an array over the measured values."""
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
