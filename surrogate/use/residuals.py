"""What a model leaves of one measured output: amplitude and lengths of its discrepancy, and noise that nobody knows.

Their posterior is drawn from by importance sampling about its mode (C. E. Rasmussen and C. K. I. Williams, Gaussian
Processes for Machine Learning (2006), section 5.4; Laplace's approximation: section 3.4). With the mode alone intervals
are too short, since a few rows say little of the size of what is smooth.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_solve
from scipy.optimize import Bounds, minimize
from scipy.special import logsumexp
from scipy.stats import multivariate_normal, norm

from approximation.arrays import Array, Flags
from surrogate.transforms.measured.discrepancy import Discrepancy
from surrogate.transforms.measured.draws import Draw

#: Prior of a discrepancy's amplitude over the size of its output: the density falls as a^-1/2, faster from here on.
AMPLITUDE = 0.2
#: Prior of its lengths: log-normal, with this median and deviation of the logarithm; the box is 2 wide.
LENGTH, SPREAD = 2.0, 0.7
#: Draws of the hyperparameters that a posterior is the mixture of.
DRAWS = 16

_RISE = 0.5  # of the density of log a below AMPLITUDE: that of a is a^-1/2
_NOTHING, _AMPLITUDES, _LENGTHS, _NOISES = 1e-9, (1e-3, 3.0), (0.1, 50.0), (1e-6, 1.0)
_FIRST_AMPLITUDE, _FIRST_NOISE = 0.02, 0.02
_MOST = 250  # values that hyperparameters are chosen from: the cost grows with their cube
_PROPOSED, _WIDER = 64, 1.3

Loss = Callable[[Array], tuple[float, Array]]


@dataclass(frozen=True)
class Residuals:
    """Measured values of one output, linear in the constants.

    Attributes
    ----------
    plain : Discrepancy
        Its values, with the noise that is known.
    unknown : ndarray of bool, shape (n,)
        Values whose error of measurement nobody knows: they share one.
    size : float
        Size of the output, by which amplitude and unknown noise are scaled.
    """

    plain: Discrepancy
    unknown: Flags
    size: float

    @classmethod
    def of(cls, points: Array, residual: Array, slopes: Array, error: Array, spread: Array, mean: Array) -> "Residuals":
        """Return those of values at scaled points, with their errors (NaN: unknown), those of the model, its means."""
        size = float(np.sqrt(np.mean(mean**2))) or float(np.abs(residual).max()) or 1.0
        noise = spread**2 + np.nan_to_num(error) ** 2
        lengths = np.full(points.shape[1], LENGTH)
        plain = Discrepancy(points, noise, _FIRST_AMPLITUDE * size, lengths, residual, slopes)
        return cls(plain, np.isnan(error), size)

    @property
    def first(self) -> Array:
        """Where a search begins: logarithms of amplitude over size, lengths, unknown noise over size."""
        noise = [np.log(_FIRST_NOISE)] if self.unknown.any() else []
        return np.array([np.log(_FIRST_AMPLITUDE), *np.log(self.plain.lengths), *noise])

    def at(self, parameters: Array) -> Discrepancy:
        """Return the process with these hyperparameters."""
        d = len(self.plain.lengths)
        noise = self.plain.noise + self._extra(parameters)
        amplitude = float(np.exp(parameters[0])) * self.size
        return replace(self.plain, amplitude=amplitude, lengths=np.exp(parameters[1 : d + 1]), noise=noise)

    def chosen(self, prior: Draw, start: Array) -> Array:
        """Return the most probable hyperparameters, given what other outputs say of the constants."""
        (low, high), loss = self._bounds, self._few().loss(prior)
        found = minimize(
            loss, np.clip(start, low, high), jac=True, method="L-BFGS-B", bounds=Bounds(low, high),
            options={"maxiter": 60},
        )  # fmt: skip
        return np.asarray(found.x)

    def drawn(self, prior: Draw, best: Array, seed: int) -> Array:
        """Return draws of the hyperparameters about the most probable ones: (DRAWS, of them).

        Half of the proposals are Laplace's approximation, widened, half the prior: for what nobody sees.
        """
        loss, (low, high) = self._few().loss(prior), self._bounds
        steps = 0.05 * np.eye(len(best))
        curvature = np.stack([(loss(best + step)[1] - loss(best - step)[1]) / 0.1 for step in steps])
        values, vectors = np.linalg.eigh((curvature + curvature.T) / 2)
        near = multivariate_normal(best, _WIDER**2 * (vectors / np.maximum(values, 0.25)) @ vectors.T)
        middle, width = best.copy(), np.sqrt(np.diag(near.cov))
        lengths = slice(1, 1 + len(self.plain.lengths))
        middle[lengths], width[lengths] = np.log(LENGTH), SPREAD
        random = np.random.default_rng(seed)
        far = random.normal(middle, width, (_PROPOSED, len(best)))
        far[:, 0] = random.uniform(low[0], high[0], _PROPOSED)
        close = near.rvs(_PROPOSED, random).reshape(_PROPOSED, -1)
        proposed = np.clip(np.concatenate([close, far]), low, high)
        density = np.asarray(norm.logpdf(proposed[:, 1:], middle[1:], width[1:])).sum(axis=1) - np.log(high[0] - low[0])
        few = self._few()
        likely = [_evidence(few.at(one), prior)[0] + few.prior(one) for one in proposed]
        likely -= np.logaddexp(near.logpdf(proposed), density)
        share = np.cumsum(np.exp(likely - likely.max()))
        places = (np.arange(DRAWS) + random.uniform()) / DRAWS * share[-1]
        return np.asarray(random.permutation(proposed[np.searchsorted(share, places)]))

    def odds(self, prior: Draw, best: Array) -> float:
        """Return the logarithm of the odds for a discrepancy: the evidence over all amplitudes against that of none."""
        one = self.at(best)
        shares = np.geomspace(_AMPLITUDES[0], 3 * AMPLITUDE, 40)
        density = shares**_RISE * np.exp(-0.5 * (shares / AMPLITUDE) ** 2)
        none, *some = (
            _evidence(replace(one, amplitude=share * self.size), prior)[0] for share in (_NOTHING, *shares.tolist())
        )
        return float(logsumexp(some, b=density / density.sum()) - none)

    def prior(self, parameters: Array) -> float:
        """Return the logarithm of the prior density of hyperparameters, up to a constant."""
        share = np.exp(parameters[0]) / AMPLITUDE
        away = (parameters[1 : 1 + len(self.plain.lengths)] - np.log(LENGTH)) / SPREAD
        return float(_RISE * parameters[0] - 0.5 * share**2 - 0.5 * away @ away)

    def loss(self, prior: Draw) -> Loss:
        """Return the negative logarithm of the posterior density of hyperparameters, and its slope, as a function."""
        return lambda parameters: self._loss(parameters, prior)

    def _loss(self, parameters: Array, prior: Draw) -> tuple[float, Array]:
        one, lengths = self.at(parameters), slice(1, 1 + len(self.plain.lengths))
        evidence, estimate, covariance = _evidence(one, prior)
        residual, slopes = one.whitened
        u = residual - slopes @ estimate
        pull = np.outer(u, u) - cho_solve((one.factor, True), np.eye(len(u))) + slopes @ covariance @ slopes.T
        weight = pull * one.covariance(one.points)
        share, away = one.amplitude / self.size / AMPLITUDE, (parameters[lengths] - np.log(LENGTH)) / SPREAD
        slope = np.empty_like(parameters)
        slope[0] = weight.sum() + _RISE - share**2
        for i, x in enumerate((one.points / one.lengths).T):
            slope[1 + i] = 0.5 * (weight * (x[:, None] - x) ** 2).sum() - away[i] / SPREAD
        slope[lengths.stop :] = np.diag(pull) @ self._extra(parameters)
        return -(evidence + self.prior(parameters)), -slope

    @property
    def _bounds(self) -> tuple[Array, Array]:
        noise = [_NOISES] if self.unknown.any() else []
        low, high = np.log([_AMPLITUDES, *[_LENGTHS] * len(self.plain.lengths), *noise]).T
        return low, high

    def _extra(self, parameters: Array) -> Array:
        """Variance of the unknown noise of every value."""
        if len(parameters) == 1 + len(self.plain.lengths):
            return np.zeros(len(self.unknown))
        return np.where(self.unknown, (np.exp(parameters[-1]) * self.size) ** 2, 0.0)

    def _few(self) -> "Residuals":
        """As many of the values as hyperparameters are chosen from."""
        n = len(self.unknown)
        if n <= _MOST:
            return self
        some = np.random.default_rng(0).choice(n, _MOST, replace=False)
        parts = {name: getattr(self.plain, name)[some] for name in ("points", "noise", "residual", "slopes")}
        return replace(self, plain=replace(self.plain, **parts), unknown=self.unknown[some])


def _evidence(one: Discrepancy, prior: Draw) -> tuple[float, Array, Array]:
    """Log-evidence of an output's residuals, and the posterior mean and covariance of the constants with it."""
    precision, weighted = one.information
    before, before_size = prior.precision
    after = before + precision
    covariance = np.asarray(np.linalg.inv(after), dtype=np.float64)
    estimate = covariance @ (before @ prior.mean + weighted)
    gone, (residual, slopes) = estimate - prior.mean, one.whitened
    fit = (one.residual - one.slopes @ estimate) @ (residual - slopes @ estimate) + gone @ before @ gone
    size = np.linalg.slogdet(after)[1] - before_size + 2 * np.log(np.diag(one.factor)).sum()
    return -0.5 * float(fit + size + len(residual) * np.log(2 * np.pi)), estimate, covariance
