"""Hyper-parameters by leaving one level of one factor out, which decouples the factors.

With the whole slab of cases at one level of factor f left out and the other factors at their levels, the predictive
error follows from the factor's own kernel matrix alone (Rasmussen and Williams, section 5.4.2, applied to one factor):
e_i = [K^-1 y]_i / [K^-1]_ii with variance 1 / [K^-1]_ii. Their sums over the slab need only the n x n matrix
G = C C^T of the data's coefficients C along the factor.
"""

from collections.abc import Callable, Sequence

import numpy as np
import scipy  # scipy.optimize, slow to import, when something is fitted

from approximation.arrays import Array
from surrogate.gp.factors import Factor

# Largest share of the variation along a factor that its amplitude may claim, and the steps of the first, coarse search.
SHARE_LIMIT = 0.9
COARSE = 25


def level_errors(factor: Factor, grams: Array) -> tuple[Array, Array]:
    """Return leave-one-level-out errors and their variances.

    grams: (p, n, n); result: (p, n).
    """
    inverse, diagonal = factor.inverse()
    squares = np.einsum("pij,ij->pi", inverse @ grams, inverse)
    # a constant or exactly reproduced output has no error: rounding keeps its logarithm finite
    energy = np.trace(grams, axis1=1, axis2=2)[:, None]
    return np.maximum(squares, 0) / diagonal**2 + np.finfo(float).eps ** 2 * energy + np.finfo(float).tiny, 1 / diagonal


def most_predictive(make: Callable[[float], Factor], grams: Array, bounds: tuple[float, float]) -> Factor:
    """Return the factor whose parameter maximises the leave-one-level-out predictive density, summed over outputs.

    The kernel has unit variance averaged over the levels, as the standardised outputs have, so that its decay follows
    the size of the errors: the mean hardly depends on it.

    grams: (p, n, n), C C^T of every output along the factor.
    """

    def cost(logarithm: float) -> float:
        factor = make(float(np.exp(logarithm)))
        errors, variances = level_errors(factor, grams)
        variances = variances / (1 + factor.features(factor.t, 1).prior.mean())
        return float(np.mean(errors / variances) + np.mean(np.log(variances)))

    return make(least(cost, bounds, COARSE))


def least(cost: Callable[[float], float], bounds: tuple[float, float], steps: int) -> float:
    """Return the positive number of least cost: the best of some steps, then a search between its neighbours."""
    grid = np.linspace(float(np.log(bounds[0])), float(np.log(bounds[1])), steps)
    best = int(np.argmin([cost(logarithm) for logarithm in grid]))
    around = (grid[max(best - 1, 0)], grid[min(best + 1, steps - 1)])
    optimum = scipy.optimize.minimize_scalar(cost, bounds=around, method="bounded", options={"xatol": 1e-3})
    return float(np.exp(optimum.x))


def rho_bounds(levels: int) -> tuple[float, float]:
    """Range of the Chebyshev kernel's rho: neither end under- or overflows in rho^(2n)."""
    return max(1e-3, 10.0 ** (-125 / levels)), 0.95


def amplitudes(factors: Sequence[Factor], grams: Sequence[Array]) -> tuple[Array, Array]:
    """Return the amplitude of every factor and output, (d, p), and the variance of every output, (p,).

    The mean does not depend on either. With standardised outputs, prior variance averaged over the levels is 1, and the
    amplitude of a factor makes its leave-one-level-out errors as large as predicted.

    grams: sequence of ndarray, shape (p, n, n), C C^T of every output along each factor.
    """
    outputs = len(grams[0])
    ratios, sizes = np.empty((len(factors), outputs)), np.empty(len(factors))
    for f, (factor, gram) in enumerate(zip(factors, grams, strict=True)):
        errors, variances = level_errors(factor, gram)
        ratios[f] = (errors / variances).mean(axis=1)
        sizes[f] = factor.features(factor.t, 1).prior.mean()
        if factor.affine:
            # two levels carry no error to learn from: take the share of the slope
            ratios[f] = gram[:, 1, 1] / np.maximum(np.trace(gram, axis1=1, axis2=2), np.finfo(float).tiny) / sizes[f]
    share = ratios * sizes[:, None]
    limited = np.minimum(share, SHARE_LIMIT)
    amplitude = limited / (1 - limited) / sizes[:, None]
    # an output that does not vary at all has no share anywhere
    excess = np.divide(share, limited, out=np.ones_like(share), where=limited > 0)
    variance = excess.max(axis=0) / np.prod(1 + amplitude * sizes[:, None], axis=0)
    return amplitude, variance
