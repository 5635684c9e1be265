"""Exact Gaussian processes with product kernels on complete factorial grids.

Hyper-parameters follow from leaving out all cases at one level of one factor. Their errors depend on that factor's
kernel matrix only (Rasmussen and Williams, section 5.4.2): e_i = [K^-1 y]_i / [K^-1]_ii with variance 1 / [K^-1]_ii.
Sums over these cases need only the Gram matrix G = C C^T, (n, n), of the data's coefficients C along the factor.
"""

from collections.abc import Mapping, Sequence
from copy import copy
from typing import Any, ClassVar, Self

import numpy as np
import scipy  # scipy.optimize, slow to import, when something is fitted
import xarray as xr
from typing_extensions import override

from approximation.arrays import Array, Indices
from surrogate.data.factorial import Factorial, check_levels, complete_factorial
from surrogate.data.inputs import Input
from surrogate.face.model import GaussianProcess
from surrogate.gp.correction import Correction, correct
from surrogate.gp.factors import Factor, Features, cosine_basis
from surrogate.gp.tensortrain import TensorTrain, compress

SHARE_LIMIT = 0.9  # largest share of the variation along a factor that its amplitude may claim
COARSE = 25  # points of the first, coarse search


def level_errors(factor: Factor, grams: Array) -> tuple[Array, Array]:
    """Return leave-one-level-out errors, (p, n), and their variances, (n,), from Gram matrices (p, n, n)."""
    inverse, diagonal = factor.inverse()
    squares = np.einsum("pij,ij->pi", inverse @ grams, inverse)
    # a constant or exactly reproduced output has no error: rounding keeps its logarithm finite
    energy = np.trace(grams, axis1=1, axis2=2)[:, None]
    return np.maximum(squares, 0) / diagonal**2 + np.finfo(float).eps ** 2 * energy + np.finfo(float).tiny, 1 / diagonal


def most_predictive(levels: int, grams: Array) -> Factor:
    """Return the factor whose rho maximises the leave-one-level-out density of all outputs, from `grams` (p, n, n)."""

    def cost(logarithm: float) -> float:
        factor = Factor(levels, float(np.exp(logarithm)))
        errors, variances = level_errors(factor, grams)
        # of a kernel with the outputs' unit variance, averaged over the levels: its decay follows the errors' size
        variances = variances / (1 + factor.features(factor.t, 1).prior.mean())
        return float(np.mean(errors / variances) + np.mean(np.log(variances)))

    lowest = max(1e-3, 10.0 ** (-125 / levels))  # rho^(2n) does not underflow
    grid = np.linspace(float(np.log(lowest)), float(np.log(0.95)), COARSE)
    best = int(np.argmin([cost(logarithm) for logarithm in grid]))
    around = (grid[max(best - 1, 0)], grid[min(best + 1, COARSE - 1)])
    optimum = scipy.optimize.minimize_scalar(cost, bounds=around, method="bounded", options={"xatol": 1e-3})
    return Factor(levels, float(np.exp(optimum.x)))


def amplitudes(factors: Sequence[Factor], grams: Sequence[Array]) -> tuple[Array, Array]:
    """Return amplitudes, (d, p), that predict the size of the leave-one-level-out errors, and variances, (p,).

    The prior variance averaged over the levels is 1; the mean depends on neither. grams: (p, n, n) for every factor.
    """
    outputs = len(grams[0])
    ratios, sizes = np.empty((len(factors), outputs)), np.empty(len(factors))
    for f, (factor, gram) in enumerate(zip(factors, grams, strict=True)):
        errors, variances = level_errors(factor, gram)
        ratios[f] = (errors / variances).mean(axis=1)
        sizes[f] = factor.features(factor.t, 1).prior.mean()
        if factor.affine:
            # two levels have no leave-one-level-out error: take the share of the slope
            ratios[f] = gram[:, 1, 1] / np.maximum(np.trace(gram, axis1=1, axis2=2), np.finfo(float).tiny) / sizes[f]
    share = ratios * sizes[:, None]
    limited = np.minimum(share, SHARE_LIMIT)
    amplitude = limited / (1 - limited) / sizes[:, None]
    # an output that does not vary at all has no share anywhere
    excess = np.divide(share, limited, out=np.ones_like(share), where=limited > 0)
    variance = excess.max(axis=0) / np.prod(1 + amplitude * sizes[:, None], axis=0)
    return amplitude, variance


KERNEL = "chebyshev"  # name of the factor kernel in files
AFFINE_DECAY = 1e-3  # rho of an affine factor in the correction of the mean


class GridGP(GaussianProcess):
    """Gaussian process on a complete factorial of Chebyshev-Gauss levels, noise-free, any number of outputs.

    Its mean has the accuracy of tensor Chebyshev interpolation; a factor with 2 levels is taken as affine.
    The covariance is the Kronecker product of the factors' kernels (Y. Saatci, Scalable Inference for Structured
    Gaussian Process Models, 2011, chapter 5), so inference needs one small matrix a factor. The mean's coefficients are
    compressed to a tensor train; the variance is a sum over factors of what their levels leave unknown.

    Parameters
    ----------
    inputs : sequence of Input, optional
        Inputs with box and scale. By default read off the data set, see `factorial.complete_factorial`.
    outputs : sequence of str, optional
        Outputs to model, by default every variable.
    hyperparameters : mapping, optional
        Fixes, by input name, the decay rho of the kernel. By default they maximise the leave-one-level-out predictive
        density of all outputs.
    compression : float
        Root-mean-square error allowed to the compressed mean, relative to every output's standard deviation; 0 is none.

    Attributes
    ----------
    hyperparameters_ : dict of str to float
        Chosen or fixed rho of every input.
    amplitude_ : ndarray, shape (d, p)
        Amplitude of every factor's kernel beside its constant.
    variance_ : ndarray, shape (p,)
        Variance of the process of every output, in units of its squared standard deviation `scale_`.
    correction_ : Correction or None
        What `calibrate` has learnt of the error of the mean; None before.

    Examples
    --------
    >>> x = Input("x", 0, 1)
    >>> data = xr.Dataset({"f": ("x", np.exp(x.levels(9)))}, coords={"x": x.levels(9)})
    >>> model = GridGP(inputs=[x]).fit(data)
    >>> bool(abs(model.predict({"x": 0.3})["f"] - np.exp(0.3)) < 1e-9)
    True
    """

    engine: ClassVar[str] = "grid"
    factors_: tuple[Factor, ...]
    order_: tuple[int, ...]
    train_: TensorTrain
    correction_: Correction | None

    def __init__(
        self,
        inputs: Sequence[Input] | None = None,
        outputs: Sequence[str] | None = None,
        hyperparameters: Mapping[str, float] | None = None,
        compression: float = 1e-12,
    ) -> None:
        self.inputs = inputs
        self.outputs = outputs
        self.hyperparameters = hyperparameters
        self.compression = compression

    def fit(self, X: xr.Dataset) -> Self:
        """Fit to a complete factorial.

        Parameters
        ----------
        X : Dataset
            Dimensions are the factors with their levels as coordinates; variables are the outputs, which may lack
            factors that they do not depend on.

        Raises
        ------
        ValueError
            A data set that is no complete factorial of Chebyshev-Gauss levels (the message names what is wrong).
        """
        data = complete_factorial(X, self.inputs, self.outputs)
        for name in self.hyperparameters or {}:
            if name not in [input_.name for input_ in data.inputs]:
                raise ValueError(f"hyperparameters name {name!r}, which is no input")
        self.inputs_, self.levels_ = data.inputs, data.levels
        self.outputs_, self.attrs_ = tuple(data.outputs), data.attrs
        self.cases_, self.calibration_, self.correction_ = self._places(), None, None
        coefficients, grams = self._coefficients(data)
        self._choose(grams)
        self.order_, ordered = joined(coefficients)
        weights = [self.factors_[k].weights[:size] for k, size in zip(self.order_, ordered.shape, strict=False)]
        self.train_ = compress(ordered, float(np.sqrt(self._allowed()))).scaled(weights)
        return self

    def _choose(self, grams: Sequence[Array]) -> None:
        """Choose the factors' kernels and the variance from Gram matrices, (p, n, n), per case of a level."""
        self.factors_ = tuple(self._factor(*pair) for pair in zip(self.inputs_, grams, strict=True))
        self.hyperparameters_ = {
            input_.name: f.parameter for input_, f in zip(self.inputs_, self.factors_, strict=True)
        }
        self.amplitude_, self.variance_ = amplitudes(self.factors_, grams)

    def _coefficients(self, data: Factorial) -> tuple[list[Array], list[Array]]:
        """Return the standardised outputs' significant coefficients, and every factor's Gram matrices (p, n, n)."""
        bases = [cosine_basis(len(levels))[0] for levels in data.levels]
        self.offset_, self.scale_ = np.empty(len(data.outputs)), np.empty(len(data.outputs))
        grams = [np.empty((len(data.outputs), *basis.shape)) for basis in bases]
        significant = []
        for p, values in enumerate(data.outputs.values()):
            output_grams = [gram[p] for gram in grams]
            coefficients, self.offset_[p], self.scale_[p] = standardised(values, bases, output_grams)
            tails = [np.cumsum(np.diag(gram)[::-1])[::-1] for gram in output_grams]
            sizes = [max(1, int(np.count_nonzero(tail > self._allowed() / len(bases)))) for tail in tails]
            significant.append(coefficients[tuple(map(slice, sizes))].copy())
        for gram in grams:  # per case of a level
            gram /= self._places() / gram.shape[1]
        return significant, grams

    def _places(self) -> int:
        """Number of places of the grid."""
        return int(np.prod([len(levels) for levels in self.levels_]))

    def _allowed(self) -> float:
        """Sum of squared errors allowed for dropping high modes, and again for the tensor train."""
        return self.compression**2 * self._places() / 2

    def _factor(self, factor_input: Input, grams: Array) -> Factor:
        rho, levels = (self.hyperparameters or {}).get(factor_input.name), grams.shape[1]
        if rho is None and levels > 2:
            return most_predictive(levels, grams)
        return Factor(levels, 0.5 if rho is None else rho)  # a factor of two levels does not depend on rho

    @override
    def state(self) -> xr.Dataset:
        d = len(self.inputs_)
        state = xr.Dataset(
            {
                "hyperparameter": ("input", [f.parameter for f in self.factors_]),
                "contraction_order": ("input", np.array(self.order_)),
                "amplitude": (("input", "output"), self.amplitude_),
                "variance": ("output", self.variance_),
                "output_offset": ("output", self.offset_),
                "output_scale": ("output", self.scale_),
            },
            attrs={"kernel": KERNEL, "compression": self.compression},
        )
        for k, (levels, core) in enumerate(zip(self.levels_, self.train_.cores, strict=True)):
            state[f"levels_{k}"] = (f"level_{k}", levels)
            state[f"core_{k}"] = ((f"rank_{k}", f"mode_{k}", f"rank_{k + 1}" if k < d - 1 else "output"), core)
        return state if self.correction_ is None else state.assign(self.correction_.state())

    @override
    @classmethod
    def restore(cls, stored: xr.Dataset, inputs: tuple[Input, ...], outputs: dict[str, dict[str, str]]) -> Self:
        attrs, d = stored.attrs, len(inputs)
        if attrs["kernel"] != KERNEL:
            raise ValueError(f"unknown kernel {attrs['kernel']!r}")
        model = cls(inputs, tuple(outputs), None, float(attrs["compression"]))
        model.inputs_, model.outputs_, model.attrs_ = inputs, tuple(outputs), outputs
        model.levels_ = tuple(stored[f"levels_{k}"].values for k in range(d))
        check_levels(inputs, model.levels_)
        parameters = stored["hyperparameter"].values.tolist()
        model.factors_ = tuple(Factor(len(levels), rho) for levels, rho in zip(model.levels_, parameters, strict=True))
        model.hyperparameters_ = {input_.name: f.parameter for input_, f in zip(inputs, model.factors_, strict=True)}
        model.order_ = tuple(int(k) for k in stored["contraction_order"].values)
        if sorted(model.order_) != list(range(d)):
            raise ValueError(f"contraction_order {model.order_} is no order of {d} inputs")
        model.amplitude_ = stored["amplitude"].transpose("input", "output").values
        model.variance_, model.offset_ = stored["variance"].values, stored["output_offset"].values
        model.scale_ = stored["output_scale"].values
        if (model.amplitude_ < 0).any() or (model.variance_ < 0).any():
            raise ValueError("negative variance or amplitude")
        model.train_ = TensorTrain(tuple(stored[f"core_{k}"].values for k in range(d)))
        model.train_.check([len(model.levels_[k]) for k in model.order_], len(outputs))
        counts = tuple(map(len, model.levels_))
        model.correction_ = Correction.restore(stored, counts, len(outputs))
        return model

    def only(self, outputs: Sequence[str]) -> Self:
        """Return the model of these outputs, with cheaper queries and means that agree within `compression`."""
        columns = [self.outputs_.index(name) for name in outputs]
        part = copy(self)
        part.outputs_, part.attrs_ = tuple(outputs), {name: self.attrs_[name] for name in outputs}
        part.offset_, part.scale_ = self.offset_[columns], self.scale_[columns]
        part.amplitude_, part.variance_ = self.amplitude_[:, columns], self.variance_[columns]
        part.calibration_ = None if self.calibration_ is None else self.calibration_.only(columns)
        part.correction_ = None if self.correction_ is None else self.correction_.only(columns)
        part._thin(columns, np.full(len(columns), self.compression))
        return part

    @override
    def thinned(self, errors: Mapping[str, float]) -> Self:
        scales = zip(self.outputs_, self.scale_, strict=True)
        allowed = np.array([max(self.compression, errors.get(name, 0.0) / scale) for name, scale in scales])
        part = copy(self)
        part._thin(range(len(allowed)), allowed)
        return part

    def _thin(self, columns: Sequence[int], errors: Array) -> None:
        """Cut the ranks of the train of `columns` to an error of every output, in its standard deviations."""
        weights = [self.factors_[k].weights[:size] for k, size in zip(self.order_, self.train_.modes, strict=True)]
        plain = self.train_.scaled([1 / scale for scale in weights])
        least = np.maximum(errors, 1e-15)
        eased = TensorTrain((*plain.cores[:-1], plain.cores[-1][..., list(columns)] / least))
        cut = eased.only(range(len(least)), float(np.sqrt(self._places())))
        self.train_ = TensorTrain((*cut.cores[:-1], cut.cores[-1] * least)).scaled(weights)

    @property
    def parts(self) -> int:
        """Number of parts of the variance: one per factor."""
        return len(self.inputs_)

    @override
    def mean_variance(self, t: Array, weights: Array | None) -> tuple[Array, Array]:
        features = self._features(t)
        mean = self.train_.evaluate([features[k].mean for k in self.order_])
        mean *= self.scale_[:, None]
        mean += self.offset_[:, None]
        if self.correction_ is not None:
            mean += self.correction_.values(t)
        return mean, np.zeros_like(mean) if weights is None else self._variance(features, weights)

    @override
    def slopes(self, t: Array) -> Array:
        features, slopes = self._features(t), self._features(t, slopes=True)
        parts = self.train_.gradient([features[k].mean for k in self.order_], [slopes[k].mean for k in self.order_])
        derivatives = np.asarray(parts[np.argsort(self.order_)] * self.scale_[:, None])
        return derivatives if self.correction_ is None else derivatives + self.correction_.slopes(t)

    @override
    def uncalibrated(self) -> Self:
        plain = super().uncalibrated()
        plain.correction_ = None
        return plain

    @override
    def corrected(self, dataset: xr.Dataset, errors: Array, t: Array, groups: Indices) -> Array:
        """Learn the correction of the means (`surrogate.gp.correction`) and return the remaining errors, (p, n)."""
        decays = [AFFINE_DECAY if factor.affine else factor.parameter for factor in self.factors_]
        self.correction_, left = correct(errors, t, tuple(map(len, self.levels_)), decays, groups)
        return left

    @override
    def slope_variances(self, t: Array, weights: Array) -> Array:
        features, slopes = self._features(t), self._features(t, slopes=True)
        if self.correction_ is not None:
            slopes = [self.correction_.steepened(k, slope) for k, slope in enumerate(slopes)]
        return np.stack([self._variance(features, weights, (k, slope)) for k, slope in enumerate(slopes)])

    def _variance(self, features: list[Features], weights: Array, slope: tuple[int, Features] | None = None) -> Array:
        """Return the variance, (p, B), of the means or, with a factor's `slope`, of their derivatives along it.

        With k_f = q_f + r_f, the known and the unknown part of factor f, prod_f k_f - prod_f q_f is the sum over f of
        q_1 .. q_{f-1} r_f k_{f+1} .. k_d: no cancellation, never negative. weights: (d, p), of its terms.
        """
        shape = (len(self.outputs_), len(features[0].prior))
        unknown, known = np.zeros(shape), np.ones(shape)
        for f, (amplitude, weight) in enumerate(zip(self.amplitude_, weights, strict=True)):
            derived = slope is not None and slope[0] == f
            feature = slope[1] if slope is not None and derived else features[f]
            k = amplitude[:, None] * feature.prior + (0.0 if derived else 1.0)
            r = amplitude[:, None] * feature.residual
            unknown *= k
            unknown += known * r * weight[:, None]
            k -= r
            known *= k
        return np.asarray(unknown * (self.variance_ * self.scale_**2)[:, None])

    def _features(self, t: Array, slopes: bool = False) -> list[Features]:
        modes = dict(zip(self.order_, self.train_.modes, strict=True))
        return [(f.slopes if slopes else f.features)(t[k], modes[k]) for k, f in enumerate(self.factors_)]


def standardised(values: Array, bases: Sequence[Array], grams: Sequence[Array]) -> tuple[Array, float, float]:
    """Return a standardised output's coefficients (n_1, ..., n_d), its mean and deviation; fill `grams`, (n_f, n_f)."""
    offset = float(values.mean())
    residual: Any = values - offset
    spread = float(np.sqrt(np.vdot(residual, residual) / values.size))
    scale = spread if spread > 0 else 1.0
    # each product transforms the leading axis and moves it to the end, so that all of them restore the order
    for basis, gram in zip(bases, grams, strict=True):
        residual = residual.reshape(len(basis), -1).T @ (basis / scale)
        gram[...] = residual.T @ residual
        scale = 1.0
    return residual.reshape(values.shape), offset, spread if spread > 0 else 1.0


def joined(coefficients: Sequence[Array]) -> tuple[tuple[int, ...], Array]:
    """Return the order of the factors, most modes first, and the outputs' coefficients as one tensor, outputs last."""
    modes = np.max([part.shape for part in coefficients], axis=0)
    # contracting the largest factors first keeps the ranks of the tensor train, hence the cost of a query, small
    order = tuple(np.argsort(-modes, kind="stable").tolist())
    tensor = np.zeros((*modes, len(coefficients)))
    for p, part in enumerate(coefficients):
        tensor[..., p][tuple(map(slice, part.shape))] = part
    return order, tensor.transpose(*order, len(modes))
