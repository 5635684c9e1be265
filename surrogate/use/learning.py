"""Bayesian learning from measured rows: uncertain constants and smooth discrepancies of a model.

Measured = model(input, constants) + discrepancy(input) + noise, output by output (M. C. Kennedy and A. O'Hagan, J. R.
Stat. Soc. B 63 (2001) 425). The constants are scaled so that their prior is standard normal; some of them, each for
itself, may be off by less, by an unknown share of their prior (`shares`). Whether an output has a discrepancy, how true
stated errors are, which values are outliers, and that share are unknown too: competing explanations of the same rows,
weighed against each other by one chain. Given them all is linear and Gaussian but the model, which is linearised about
the constants' estimate until that stays (Gauss-Newton); the constants couple the outputs only through their k x k
precision.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve

from approximation.arrays import Array, Flags
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.data.measurements import Measurements
from surrogate.transforms.measured.discrepancy import Draw, mixture, moments, posterior
from surrogate.use.residuals import Residuals, State

#: Takes scaled constants (k,); gives the model's means at the measured values (n,) and their derivatives (n, k).
Forward = Callable[[Array], tuple[Array, Array]]

#: Draws that a posterior is the mixture of, and rounds of the chain that they and all shares are taken from.
DRAWS, ROUNDS = 16, 160
#: Shares of their prior deviation by which single constants may be off, all alike, and how probable each is a priori.
OWN, OWN_CHANCE = np.array([0.0, 0.5, 1.0, 2.0]), np.array([0.15, 0.25, 0.4, 0.2])

_BURNT, _CHAINS, _STEPS, _STEP, _HUGE = 30, 4, 12, 2.0, 500.0
_STALE = 0.3  # how far constants may move, in prior deviations, until all else is drawn anew


class NotSettledError(ValueError):
    """The constants' estimate did not settle: the model is too far from linear, or the rows are not of it."""


@dataclass(frozen=True)
class Chain:
    """Draws of one chain, round by round."""

    states: tuple[dict[int, State], ...]  # State of every measured output, by its number
    shares: Array  # (rounds,), share of their prior by which single constants are off
    # Log-odds for a discrepancy of every measured output against none, given all else of a round: (rounds,)
    odds: dict[int, Array]
    single: Array  # shape (rounds,); Probability that single constants are off at all, given all else of a round


@dataclass(frozen=True)
class Learnt:
    """Result of learning from measured rows."""

    about: Array  # shape (k,); Scaled constants about which the model was linearised last
    draws: tuple[Draw, ...]  # Equally probable
    chain: Chain  # All that is unknown beside constants and discrepancies
    wild: Array  # shape (n,); Probability that a value is an outlier
    # tuple of ndarray, shape (n,) each; Every measured value as predicted from all other rows, and the standard
    # deviation of their difference
    left_out: tuple[Array, Array]

    @property
    def mean(self) -> Array:
        """Posterior mean of the scaled constants: 1 is one prior standard deviation; (k,)."""
        return mixture(self.draws)[0]

    @property
    def covariance(self) -> Array:
        """Posterior covariance of the constants, (k, k); the identity where nothing was learnt."""
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

    @property
    def odds(self) -> dict[int, float]:
        """Odds for a discrepancy of every measured output against none, by its number."""
        return {
            q: float(1 / np.mean(np.exp(-np.clip(log_odds, -_HUGE, _HUGE)))) for q, log_odds in self.chain.odds.items()
        }

    @property
    def own_odds(self) -> float:
        """Bayes factor for single constants being off, compared with their families alone."""
        share = float(self.chain.single.mean())
        return float(share / max(1 - share, 1e-200) * OWN_CHANCE[0] / (1 - OWN_CHANCE[0]))

    def scale(self, output: int) -> tuple[float, float, float]:
        """True over stated errors of a measured output: the median, and the ends of its 95 % interval."""
        scales = [states[output].scale for states in self.chain.states]
        low, median, high = np.exp(np.quantile(scales, [0.025, 0.5, 0.975])).tolist()
        return median, low, high


def learn(
    forward: Forward,
    rows: Measurements,
    inputs: tuple[Input, ...],
    constants: int,
    spread: Array,
    single_constants: Flags | None = None,
) -> Learnt:
    """Estimate constants and discrepancies from measured rows.

    spread: (n,); single_constants: (k,), optional.
    """
    single = np.zeros(constants, np.bool_) if single_constants is None else single_constants
    model = _Linearised(forward, rows, inputs, spread)
    about, start = np.zeros(constants), None
    for number in range(_CHAINS):
        parts, rounds = model.at(about), ROUNDS if number else DRAWS
        chain = _chained(parts, single, start, np.random.default_rng(number), rounds)
        rounds_used = np.linspace(0, rounds - 1, DRAWS).round().astype(np.intp)
        random = np.random.default_rng(0)
        states = []
        for k in rounds_used:
            mean = _draw({q: part.few()[0] for q, part in parts.items()}, chain.states[k], chain.shares[k], single).mean
            states.append(
                {q: part.completed(chain.states[k][q], part.few()[1], mean, random) for q, part in parts.items()}
            )
        previous = about
        about, draws = _settled(model, about, states, chain.shares[rounds_used], single)
        start = chain.states[-1]
        if number and np.abs(about - previous).max() <= _STALE:
            break
    wild = np.zeros(len(rows.value))
    for q in rows.outputs:
        wild[rows.of(q)] = np.mean([state[q].wild > 0 for state in states], axis=0)
        few_rows = parts[q].few()[1]
        wild[rows.of(q)[few_rows]] = np.mean([state[q].wild > 0 for state in chain.states], axis=0)
    plain = [{q: part.usual(state[q]) for q, part in parts.items()} for state in states]
    predicted, variance = moments([_left_out(rows, draw, noise) for draw, noise in zip(draws, plain, strict=True)])
    return Learnt(about, draws, chain, wild, (predicted, np.sqrt(variance)))


@dataclass(frozen=True)
class _Linearised:
    """A model about constants, and what was measured."""

    forward: Forward
    rows: Measurements
    inputs: tuple[Input, ...]
    spread: Array

    def at(self, about: Array) -> dict[int, Residuals]:
        """Return the residuals of every measured output, linear in the constants."""
        rows = self.rows
        mean, slopes = self.forward(about)
        residual = rows.value - mean + slopes @ about
        scaled, parts = unit_coordinates(self.inputs, rows.points).T, {}
        for q in rows.outputs:
            k = rows.of(q)
            parts[q] = Residuals.of(scaled[rows.row[k]], residual[k], slopes[k], rows.error[k], self.spread[k], mean[k])
        return parts


def _settled(
    model: _Linearised, about: Array, states: Sequence[Mapping[int, State]], shares: Array, single: Flags
) -> tuple[Array, tuple[Draw, ...]]:
    """Constants about which their estimate stays, all else at its draws, and the posterior there."""
    for _ in range(_STEPS):
        parts = model.at(about)
        draws = tuple(_draw(parts, state, share, single) for state, share in zip(states, shares, strict=True))
        mean, covariance = mixture(draws)
        move = np.clip(mean - about, -_STEP, _STEP)
        if np.all(np.abs(move) <= 0.02 + 0.1 * np.sqrt(np.diag(covariance))):
            return about, draws
        about = about + move
    raise NotSettledError(
        "the estimate of the constants does not settle: these rows are far from what the model can give"
    )


def _chained(
    parts: Mapping[int, Residuals],
    single: Flags,
    start: Mapping[int, State] | None,
    random: np.random.Generator,
    rounds: int,
) -> Chain:
    """Rounds of a chain over all that is unknown but constants and discrepancies, which are integrated over."""
    few = {q: part.few()[0] for q, part in parts.items()}
    state = {q: part.first for q, part in few.items()} if start is None else dict(start)
    information = {q: part.at(state[q]).information for q, part in few.items()}
    share = 1.0 if single.any() else 0.0
    states, shares, offs = [], [], []
    odds: dict[int, list[float]] = {q: [] for q in few}
    for number in range(_BURNT + rounds):
        prior = np.where(single, share, 1.0)
        chances = {}
        for q, part in few.items():
            others = [information[name] for name in few if name != q]
            precision = sum((term for term, _ in others), np.zeros((len(prior), len(prior))))
            weighted = sum((term for _, term in others), np.zeros(len(prior)))
            mean, covariance = posterior(precision, weighted, prior)
            state[q], chances[q] = part.swept(state[q], mean, covariance, random)
            information[q] = part.at(state[q]).information
        likely = _shares(list(information.values()), single)
        chance = np.exp(likely - likely.max())
        chance /= chance.sum()
        share = float(OWN[random.choice(len(OWN), p=chance)]) if single.any() else 0.0
        if number >= _BURNT:
            states.append(dict(state))
            shares.append(share)
            offs.append(1 - chance[0])
            for q, term in chances.items():
                odds[q].append(term)
    return Chain(tuple(states), np.array(shares), {q: np.array(term) for q, term in odds.items()}, np.array(offs))


def _shares(information: Sequence[tuple[Array, Array]], single: Flags) -> Array:
    """Log-probabilities of the shares `OWN`, up to a constant, from what every output says of the constants."""
    precision, weighted = (np.sum([pair[k] for pair in information], axis=0) for k in (0, 1))
    shares: Array = np.log(OWN_CHANCE)
    for k, share in enumerate(OWN):
        prior = np.where(single, share, 1.0)
        inner = np.eye(len(prior)) + prior[:, None] * precision * prior
        shares[k] += 0.5 * (posterior(precision, weighted, prior)[0] @ weighted - np.linalg.slogdet(inner)[1])
    return shares


def _draw(parts: Mapping[int, Residuals], states: Mapping[int, State], share: float, single: Flags) -> Draw:
    """The posterior of the constants where all else is at a draw."""
    return Draw.of({q: part.at(states[q]) for q, part in parts.items()}, np.where(single, share, 1.0))


def _left_out(rows: Measurements, draw: Draw, usual: Mapping[int, Array]) -> tuple[Array, Array]:
    """Every value as predicted without its row, and its variance, were it no outlier, with usual variances of errors.

    These follow from the row's block of the inverse joint covariance.
    """
    n = len(rows.value)
    pull, single, slopes, less = np.empty(n), np.empty(n), np.empty((n, len(draw.mean))), np.empty(n)
    for q, discrepancy in draw.discrepancies.items():
        k = rows.of(q)
        less[k] = discrepancy.noise - usual[q]
        pull[k] = discrepancy.whitened[0] - discrepancy.whitened[1] @ draw.mean
        single[k], slopes[k] = np.diag(cho_solve((discrepancy.factor, True), np.eye(len(k)))), discrepancy.whitened[1]
    predicted, variance = np.empty(n), np.empty(n)
    for row in np.unique(rows.row):
        k = np.flatnonzero(rows.row == row)
        block = np.linalg.inv(np.diag(single[k]) - slopes[k] @ draw.covariance @ slopes[k].T)
        predicted[k], variance[k] = rows.value[k] - block @ pull[k], np.diag(block) - less[k]
    return predicted, variance
