"""From measured rows to uncertain constants and smooth discrepancies of a model, by Bayes' rule.

Measured = model(input, constants) + discrepancy(input) + noise, output by output (M. C. Kennedy and A. O'Hagan, J. R.
Stat. Soc. B 63 (2001) 425). The constants are scaled so that their prior is standard normal. Given the discrepancies'
hyperparameters all is linear and Gaussian but the model, which is linearised about the constants' estimate until that
stays (Gauss-Newton); the constants couple the outputs only through their k x k precision.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve

from approximation.arrays import Array
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.data.measurements import Measurements
from surrogate.transforms.measured.draws import Draw, mixture, moments
from surrogate.use.residuals import DRAWS, Residuals

#: Takes scaled constants (k,); gives the model's means at the measured values (n,) and their derivatives (n, k).
Forward = Callable[[Array], tuple[Array, Array]]

_ROUNDS, _SWEEPS, _STEP = 12, 2, 2.0


class NotSettledError(ValueError):
    """The constants' estimate did not settle: the model is too far from linear, or the rows are not of it."""


@dataclass(frozen=True)
class Learnt:
    """What measured rows say.

    Attributes
    ----------
    about : ndarray, shape (k,)
        Scaled constants about which the model was linearised last.
    draws : tuple of Draw
        Equally probable.
    odds : dict
        Natural logarithm of the odds for a discrepancy of each measured output, by its number, against none.
    left_out : tuple of ndarray, shape (n,) each
        Every measured value as predicted from all other rows, and the standard deviation of their difference.
    """

    about: Array
    draws: tuple[Draw, ...]
    odds: dict[int, float]
    left_out: tuple[Array, Array]

    @property
    def mean(self) -> Array:
        """Posterior mean of the scaled constants: 1 is one prior standard deviation; (k,)."""
        return mixture(self.draws)[0]

    @property
    def covariance(self) -> Array:
        """Their posterior covariance; the identity where nothing was learnt; (k, k)."""
        return mixture(self.draws)[1]

    @property
    def contraction(self) -> Array:
        """Posterior over prior standard deviation of every constant: (k,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def directions(self) -> tuple[Array, Array]:
        """Posterior over prior deviation along orthogonal directions, ascending (k,), which are columns of (k, k)."""
        values, vectors = np.linalg.eigh(self.covariance)
        return np.sqrt(np.maximum(values, 0)), vectors


def learn(forward: Forward, rows: Measurements, inputs: tuple[Input, ...], constants: int, spread: Array) -> Learnt:
    """Estimate constants and discrepancies from measured rows.

    Parameters
    ----------
    forward
        The model.
    rows
        What was measured.
    inputs
        Inputs of the model, which scale the points.
    constants
        How many there are.
    spread : ndarray, shape (n,)
        Standard deviation of the model's own error at every value.

    Raises
    ------
    ValueError
        Fewer values than unknowns: constants, and an amplitude an output.
    NotSettledError
        An estimate that moves without end.

    Examples
    --------
    The slope of a line, which is 2 a priori, give or take 1:

    >>> x = np.linspace(0, 1, 20)
    >>> index = np.arange(20)
    >>> rows = Measurements(x[:, None], index, 0 * index, 2.5 * x + 0.01 * np.cos(40 * x), np.full(20, 0.01))
    >>> found = learn(lambda z: ((2 + z) * x, x[:, None]), rows, (Input("x", 0, 1),), 1, np.zeros(20))
    >>> bool(abs(found.mean[0] - 0.5) < 2 * found.contraction[0] < 0.5)
    True
    """
    unknowns = constants + len(rows.outputs)
    if len(rows.value) < unknowns:
        raise ValueError(
            f"{len(rows.value)} measured values are fewer than {unknowns} unknowns "
            f"({constants} constants, {len(rows.outputs)} discrepancies)"
        )
    scaled = unit_coordinates(inputs, rows.points).T
    about, best = np.zeros(constants), dict[int, Array]()
    for _ in range(_ROUNDS):
        mean, slopes = forward(about)
        residual = rows.value - mean + slopes @ about
        parts = {}
        for q in rows.outputs:
            k = rows.of(q)
            parts[q] = Residuals.of(scaled[rows.row[k]], residual[k], slopes[k], rows.error[k], spread[k], mean[k])
        best = _chosen(parts, best, constants)
        now = Draw.of({q: one.at(best[q]) for q, one in parts.items()}, constants)
        move = np.clip(now.mean - about, -_STEP, _STEP)
        if np.all(np.abs(move) <= 0.02 + 0.1 * np.sqrt(np.diag(now.covariance))):
            draws, odds = _drawn(parts, best, constants)
            predicted, variance = moments([_left_out(rows, one) for one in draws])
            return Learnt(about, draws, odds, (predicted, np.sqrt(variance)))
        about = about + move
    raise NotSettledError(
        "the estimate of the constants does not settle: these rows are far from what the model can give"
    )


def _chosen(parts: Mapping[int, Residuals], before: Mapping[int, Array], constants: int) -> dict[int, Array]:
    """Most probable hyperparameters, one output after the other, from where they were before."""
    best = {q: before.get(q, one.first) for q, one in parts.items()}
    for _ in range(1 if before else _SWEEPS):
        for q, one in parts.items():
            best[q] = one.chosen(_others(parts, best, q, constants), best[q])
    return best


def _drawn(
    parts: Mapping[int, Residuals], best: Mapping[int, Array], constants: int
) -> tuple[tuple[Draw, ...], dict[int, float]]:
    """The posterior at draws of all hyperparameters, and the odds for every discrepancy."""
    priors = {q: _others(parts, best, q, constants) for q in parts}
    drawn = {q: one.drawn(priors[q], best[q], q) for q, one in parts.items()}
    each = ({q: one.at(drawn[q][k]) for q, one in parts.items()} for k in range(DRAWS))
    odds = {q: one.odds(priors[q], best[q]) for q, one in parts.items()}
    return tuple(Draw.of(own, constants) for own in each), odds


def _others(parts: Mapping[int, Residuals], best: Mapping[int, Array], q: int, constants: int) -> Draw:
    """What all outputs but one say of the constants."""
    return Draw.of({name: one.at(best[name]) for name, one in parts.items() if name != q}, constants)


def _left_out(rows: Measurements, draw: Draw) -> tuple[Array, Array]:
    """Every value as predicted without its row, and its variance: the row's block of the inverse joint covariance."""
    n = len(rows.value)
    pull, single, slopes = np.empty(n), np.empty(n), np.empty((n, len(draw.mean)))
    for q, one in draw.discrepancies.items():
        k = rows.of(q)
        pull[k] = one.whitened[0] - one.whitened[1] @ draw.mean
        single[k], slopes[k] = np.diag(cho_solve((one.factor, True), np.eye(len(k)))), one.whitened[1]
    predicted, variance = np.empty(n), np.empty(n)
    for row in np.unique(rows.row):
        k = np.flatnonzero(rows.row == row)
        block = np.linalg.inv(np.diag(single[k]) - slopes[k] @ draw.covariance @ slopes[k].T)
        predicted[k], variance[k] = rows.value[k] - block @ pull[k], np.diag(block)
    return predicted, variance
