"""Bayesian learning from measured rows: uncertain constants and smooth discrepancies of a model.

Measured = model(input, constants) + discrepancy(input) + noise for every output (M. C. Kennedy and A. O'Hagan, J. R.
Stat. Soc. B 63 (2001) 425). Scaled constants have a standard normal prior; that of single constants is multiplied by an
unknown share. Unknown too are each output's discrepancy, the scale of the stated errors, and the outliers, whose errors
are wider (contaminated normal: G. E. P. Box and G. C. Tiao, Biometrika 55 (1968) 119).

One Gibbs chain samples these unknowns in turn, each from its conditional density on a lattice of random step through
its current value. Constants and discrepancies are integrated over: given the other unknowns the problem is linear and
Gaussian, once the model is linearised about the constants' estimate (Gauss-Newton). The constants couple the outputs
only through their precision, (k, k).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import cho_solve

from approximation.arrays import Array, Flags, Indices
from surrogate.data.inputs import Input, unit_coordinates
from surrogate.transforms.measured import Discrepancy, Draw, Measurements, mixture, moments, posterior, summed

# Priors: density a^-1/2 of a discrepancy's amplitude over the size of its output, falling faster from AMPLITUDE on;
# log-normal lengths with this median and deviation, in a box of width 2; Student's t with so many degrees of freedom
# and this scale for the logarithm of true over stated errors.
AMPLITUDE = 0.2
LENGTH, SPREAD = 2.0, 0.7
FREEDOM, TRUST = 2.0, 0.3
#: Factors on the errors of outliers, and their prior probabilities.
WILD, CHANCE = np.array([1.0, 5.0, 25.0]), np.array([0.98, 0.01, 0.01])

_RISE = 0.5  # slope of the logarithm of the density of log a below AMPLITUDE
_AMPLITUDES, _LENGTHS, _NOISES = (1e-3, 3.0), (0.1, 50.0), (1e-6, 1.0)
_SCALES = (0.3, 30.0)
_FIRST_AMPLITUDE, _FIRST_SCALE, _FIRST_NOISE = 0.02, 2.0, 0.02
_MOST_VALUES = 120  # values of an output in the chain, whose cost grows with their cube
_LARGEST_ODDS = 1000.0  # bound of a logarithm of odds
_FRAME = 1e300  # exceeds any square of a whitened vector
_LATTICE_STEPS = {"amplitude": 0.7, "length": 0.8, "scale": 0.25, "unstated": 0.5}  # largest steps of the lattices


@dataclass(frozen=True)
class State:
    """One draw of an output's unknowns other than the constants."""

    amplitude: float  # logarithm of the discrepancy's amplitude over the size of the output
    lengths: Array  # shape (d,); logarithms of its lengths
    scale: float  # logarithm of true over stated errors
    unstated: float  # logarithm of unstated errors over the size of the output
    wild: Indices  # shape (n,); index in `WILD` of every value


@dataclass(frozen=True)
class Residuals:
    """Measured values of one output, linear in the constants."""

    points: Array  # shape (n, d); scaled inputs
    residual: Array  # shape (n,); measured values less the linearised model with the constants at zero
    slopes: Array  # shape (n, k); derivatives of the model by the constants
    spread: Array  # shape (n,); variances of the model's errors
    stated: Array  # shape (n,); stated variances of the errors of measurement, zero where none is stated
    unknown: Flags  # shape (n,); values without a stated error, which share one unknown error
    size: float  # size of the output, the unit of amplitudes and unstated errors

    @classmethod
    def of(cls, points: Array, residual: Array, slopes: Array, error: Array, spread: Array, mean: Array) -> "Residuals":
        """Return residuals of values with stated errors, (n,), NaN where unknown, and the size of the means (n,)."""
        size = float(np.sqrt(np.mean(mean**2))) or float(np.abs(residual).max()) or 1.0
        return cls(points, residual, slopes, spread**2, np.nan_to_num(error) ** 2, np.isnan(error), size)

    @property
    def first(self) -> State:
        """Return the first state of a chain: larger errors than stated, no discrepancy, no outlier."""
        lengths = np.full(self.points.shape[1], np.log(LENGTH))
        amplitude, scale, unstated = np.log([_FIRST_AMPLITUDE, _FIRST_SCALE, _FIRST_NOISE]).tolist()
        return State(amplitude, lengths, scale, unstated, np.zeros(len(self.residual), np.intp))

    def at(self, state: State) -> Discrepancy:
        """Return the discrepancy's process at a state."""
        amplitude, lengths = float(np.exp(state.amplitude)) * self.size, np.exp(state.lengths)
        return Discrepancy(self.points, self._noise(state), amplitude, lengths, self.residual, self.slopes)

    @cached_property
    def chosen(self) -> Indices:
        """Indices of the values in the chain, at most `_MOST_VALUES`."""
        n = len(self.residual)
        return np.sort(np.random.default_rng(0).choice(n, min(n, _MOST_VALUES), replace=False))

    @cached_property
    def few(self) -> "Residuals":
        """The values in the chain."""
        names = ("points", "residual", "slopes", "spread", "stated", "unknown")
        return replace(self, **{name: getattr(self, name)[self.chosen] for name in names})

    def usual(self, state: State) -> Array:
        """Return the variances of all errors, (n,), without outliers."""
        return np.asarray(self.spread + self._plain(state))

    def swept(self, state: State, mean: Array, covariance: Array, random: np.random.Generator) -> tuple[State, float]:
        """Return the state after one Gibbs round and the log-odds for a discrepancy, given the constants' moments."""
        misfit, shared = self.residual - self.slopes @ mean, self.slopes @ covariance @ self.slopes.T
        noisy = shared + np.diag(self._noise(state))
        state, odds = self._with_amplitude(state, misfit, noisy, random)
        state = self._with_lengths(state, misfit, noisy, random)
        covariance_rest = shared + (np.exp(state.amplitude) * self.size) ** 2 * self._smooth(state.lengths[None])[0]
        for name, ends, members in (("unstated", _NOISES, self.unknown), ("scale", _SCALES, ~self.unknown)):
            if not members.any():
                continue
            current = getattr(state, name)
            levels = _lattice(current, ends, _LATTICE_STEPS[name], random)
            errors = WILD[state.wild] ** 2 * self._plain(state) * np.exp(2 * (levels - current))[:, None]
            noise = np.where(members, self.spread + errors, self._noise(state))
            likely = _densities(_with_diagonals(covariance_rest, noise), misfit)
            if name == "scale":
                likely -= (FREEDOM + 1) / 2 * np.log1p((levels / TRUST) ** 2 / FREEDOM)
            sampled: dict[str, Any] = {name: float(levels[_pick(likely, random)])}
            state = replace(state, **sampled)
        return replace(state, wild=self._wild(state, misfit, covariance_rest, random)), odds

    def completed(self, state: State, mean: Array, random: np.random.Generator) -> State:
        """Return a state of the chain's values with sampled outliers of all others, at constants `mean`, (k,)."""
        others = np.setdiff1d(np.arange(len(self.residual)), self.chosen)
        if not len(others):
            return state
        wild = np.zeros(len(self.residual), np.intp)
        wild[self.chosen] = state.wild
        discrepancy, by_constants, variance = self.few.at(state).at(self.points[others])
        misfit = self.residual[others] - self.slopes[others] @ mean - discrepancy + by_constants @ mean
        noise = self.spread[others, None] + (self._plain(state)[others, None] * WILD**2) + variance[:, None]
        likely = np.log(CHANCE) - 0.5 * np.log(noise) - 0.5 * misfit[:, None] ** 2 / noise
        wild[others] = [_pick(chances, random) for chances in likely]
        return replace(state, wild=wild)

    def _with_amplitude(
        self, state: State, misfit: Array, noisy: Array, random: np.random.Generator
    ) -> tuple[State, float]:
        levels = _lattice(state.amplitude, _AMPLITUDES, _LATTICE_STEPS["amplitude"], random)
        prior = _RISE * levels - 0.5 * (np.exp(levels) / AMPLITUDE) ** 2
        shares = self.size**2 * np.concatenate([[0.0], np.exp(2 * levels)])
        none, *densities = _densities(noisy + shares[:, None, None] * self._smooth(state.lengths[None]), misfit)
        likely = np.asarray(densities) + prior
        odds = float(np.logaddexp.reduce(likely) - np.logaddexp.reduce(prior) - none)
        return replace(state, amplitude=float(levels[_pick(likely, random)])), odds

    def _with_lengths(self, state: State, misfit: Array, noisy: Array, random: np.random.Generator) -> State:
        variance, lengths = (np.exp(state.amplitude) * self.size) ** 2, state.lengths.copy()
        for i in range(len(lengths)):
            levels = _lattice(lengths[i], _LENGTHS, _LATTICE_STEPS["length"], random)
            candidates = np.repeat(lengths[None], len(levels), 0)
            candidates[:, i] = levels
            likely = _densities(noisy + variance * self._smooth(candidates), misfit)
            likely -= 0.5 * ((levels - np.log(LENGTH)) / SPREAD) ** 2
            lengths[i] = levels[_pick(likely, random)]
        return replace(state, lengths=lengths)

    def _wild(self, state: State, misfit: Array, covariance: Array, random: np.random.Generator) -> Indices:
        """Return the outliers, (n,), sampled value by value: a wider error is a change of rank one."""
        inverse = np.linalg.inv(covariance + np.diag(self._noise(state)))
        pull, wild, plain = inverse @ misfit, state.wild.copy(), self._plain(state)
        left, uniform = random.permutation(len(misfit)), random.uniform(size=len(misfit))
        while len(left):  # the conditional chances of all values hold until one value changes
            added = plain[left, None] * (WILD**2 - WILD[wild[left], None] ** 2)
            grown = 1 + added * inverse[left, left, None]
            odds = 0.5 * np.minimum(added * pull[left, None] ** 2 / grown, _LARGEST_ODDS)
            chance = CHANCE / np.sqrt(grown) * np.exp(odds)
            share = np.cumsum(chance, axis=1)
            sampled = (share < uniform[left, None] * share[:, -1:]).sum(axis=1)
            changed = np.flatnonzero(sampled != wild[left])
            if not len(changed):
                break
            first = changed[0]
            i, k = left[first], sampled[first]
            wild[i], column, part = k, inverse[:, i].copy(), added[first, k] / grown[first, k]
            pull = pull - part * pull[i] * column
            inverse = inverse - part * np.outer(column, column)
            left = left[first + 1 :]
        return wild

    def _plain(self, state: State) -> Array:
        """Return the variances of the errors of measurement, (n,), without outliers."""
        unstated = (np.exp(state.unstated) * self.size) ** 2
        return np.asarray(np.where(self.unknown, unstated, self.stated * np.exp(2 * state.scale)))

    def _noise(self, state: State) -> Array:
        return np.asarray(self.spread + WILD[state.wild] ** 2 * self._plain(state))

    def _smooth(self, lengths: Array) -> Array:
        """Return correlations among the points, (g, n, n), with a definite diagonal, for log-lengths (g, d)."""
        n = len(self.points)
        square = np.exp(-2 * lengths) @ self._squares.reshape(lengths.shape[1], -1)
        return np.asarray(np.exp(-0.5 * square).reshape(-1, n, n) + 1e-10 * np.eye(n))

    @cached_property
    def _squares(self) -> Array:
        """Squared distances along every input, (d, n, n)."""
        t = self.points.T
        return np.asarray((t[:, :, None] - t[:, None, :]) ** 2)


def _lattice(current: float, ends: tuple[float, float], step: float, random: np.random.Generator) -> Array:
    """Return levels between the logarithms of two ends, through the current one, a random step apart."""
    (low, high), step = np.log(ends), step * float(random.uniform(0.6, 1.0))
    first, last = np.ceil((low - current) / step), np.floor((high - current) / step)
    return np.asarray(current + step * np.arange(first, last + 1))


def _densities(covariances: Array, misfit: Array) -> Array:
    """Return log-densities, (g,), of a normal vector (n,) with covariances (g, n, n), up to a constant."""
    g, n = len(covariances), len(misfit)
    framed = np.empty((g, n + 1, n + 1))  # the last row of its Cholesky factor is the whitened vector
    framed[:, :n, :n], framed[:, n, :n], framed[:, :n, n], framed[:, n, n] = covariances, misfit, misfit, _FRAME
    roots = np.linalg.cholesky(framed)
    sizes = np.log(np.diagonal(roots, axis1=1, axis2=2)[:, :n]).sum(axis=1)
    return np.asarray(-0.5 * (roots[:, n, :n] ** 2).sum(axis=1) - sizes)


def _with_diagonals(matrix: Array, diagonals: Array) -> Array:
    """Return a matrix (n, n) plus each of the diagonals (g, n): (g, n, n)."""
    matrices = np.repeat(matrix[None], len(diagonals), 0)
    n = len(matrix)
    matrices[:, np.arange(n), np.arange(n)] += diagonals
    return matrices


def _pick(likely: Array, random: np.random.Generator) -> int:
    """Return a random index by log-densities."""
    share = np.cumsum(np.exp(likely - likely.max()))
    return int(np.searchsorted(share, random.uniform() * share[-1]))


#: From scaled constants (k,) to the model's means at the measured values (n,) and their derivatives (n, k).
Forward = Callable[[Array], tuple[Array, Array]]

#: Draws in the mixture of a posterior, and rounds of the chain.
DRAWS, ROUNDS = 16, 160
#: Shares of the prior deviations of single constants, equal for all of them, and their prior probabilities.
SHARES, SHARE_CHANCES = np.array([0.0, 0.5, 1.0, 2.0]), np.array([0.15, 0.25, 0.4, 0.2])

_BURNT, _CHAINS, _CHAIN_STEPS, _FARTHEST_MOVE, _HUGE = 30, 4, 12, 2.0, 500.0
_STALE = 0.3  # move of the constants, in prior deviations, beyond which a new chain is run


class NotSettledError(ValueError):
    """The constants' estimate did not settle: the model is too far from linear, or the rows are not of it."""


@dataclass(frozen=True)
class Chain:
    """Draws of one chain, round by round."""

    states: tuple[dict[int, State], ...]  # state of every measured output, by its number
    shares: Array  # shape (rounds,); share of the prior of single constants
    odds: dict[int, Array]  # shape (rounds,); conditional log-odds for a discrepancy of every measured output
    single: Array  # shape (rounds,); conditional probability that single constants differ at all


@dataclass(frozen=True)
class Learnt:
    """Result of learning from measured rows."""

    about: Array  # shape (k,); scaled constants about which the model was last linearised
    draws: tuple[Draw, ...]  # equally probable
    chain: Chain  # draws of the other unknowns
    wild: Array  # shape (n,); probability that a value is an outlier
    left_out: tuple[Array, Array]  # shape (n,); predictions from all other rows, and deviations of their errors

    @property
    def mean(self) -> Array:
        """Posterior mean of the scaled constants, in prior standard deviations, (k,)."""
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
        """Posterior over prior deviations, (k,), ascending, along orthogonal directions, the columns of (k, k)."""
        values, vectors = np.linalg.eigh(self.covariance)
        return np.sqrt(np.maximum(values, 0)), vectors

    @property
    def odds(self) -> dict[int, float]:
        """Odds for a discrepancy of every measured output against none, by its number."""
        return {q: float(1 / np.mean(np.exp(-np.clip(odds, -_HUGE, _HUGE)))) for q, odds in self.chain.odds.items()}

    @property
    def own_odds(self) -> float:
        """Bayes factor for deviations of single constants against deviations of their families alone."""
        share = float(self.chain.single.mean())
        return float(share / max(1 - share, 1e-200) * SHARE_CHANCES[0] / (1 - SHARE_CHANCES[0]))

    def scale(self, output: int) -> tuple[float, float, float]:
        """Return median and ends of the 95 % interval of true over stated errors of a measured output."""
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
    """Estimate constants and discrepancies from measured rows; the model's errors have deviations `spread`, (n,)."""
    single = np.zeros(constants, np.bool_) if single_constants is None else single_constants
    scaled = unit_coordinates(inputs, rows.points).T

    def linearised(about: Array) -> dict[int, Residuals]:
        """Return the residuals of every measured output, with the model linearised about some constants (k,)."""
        mean, slopes = forward(about)
        residual, parts = rows.value - mean + slopes @ about, {}
        for q in rows.outputs:
            k = rows.of(q)
            parts[q] = Residuals.of(scaled[rows.row[k]], residual[k], slopes[k], rows.error[k], spread[k], mean[k])
        return parts

    about, start = np.zeros(constants), None
    for number in range(_CHAINS):
        parts, rounds = linearised(about), ROUNDS if number else DRAWS
        chain = _chained(parts, single, start, np.random.default_rng(number), rounds)
        rounds_used = np.linspace(0, rounds - 1, DRAWS).round().astype(np.intp)
        random = np.random.default_rng(0)
        states = []
        for k in rounds_used:
            few = {q: part.few for q, part in parts.items()}
            mean = _draw(few, chain.states[k], chain.shares[k], single).mean
            states.append({q: part.completed(chain.states[k][q], mean, random) for q, part in parts.items()})
        previous = about
        about, draws = _settled(linearised, about, states, chain.shares[rounds_used], single)
        start = chain.states[-1]
        if number and np.abs(about - previous).max() <= _STALE:
            break
    wild = np.zeros(len(rows.value))
    for q in rows.outputs:
        wild[rows.of(q)] = np.mean([state[q].wild > 0 for state in states], axis=0)
        wild[rows.of(q)[parts[q].chosen]] = np.mean([state[q].wild > 0 for state in chain.states], axis=0)
    plain = [{q: part.usual(state[q]) for q, part in parts.items()} for state in states]
    predicted, variance = moments([_left_out(rows, draw, noise) for draw, noise in zip(draws, plain, strict=True)])
    return Learnt(about, draws, chain, wild, (predicted, np.sqrt(variance)))


def _settled(
    linearised: Callable[[Array], dict[int, Residuals]],
    about: Array,
    states: Sequence[Mapping[int, State]],
    shares: Array,
    single: Flags,
) -> tuple[Array, tuple[Draw, ...]]:
    """Return constants, (k,), that are their own estimate given drawn states, and the posterior draws there."""
    for _ in range(_CHAIN_STEPS):
        parts = linearised(about)
        draws = tuple(_draw(parts, state, share, single) for state, share in zip(states, shares, strict=True))
        mean, covariance = mixture(draws)
        move = np.clip(mean - about, -_FARTHEST_MOVE, _FARTHEST_MOVE)
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
    """Return a chain over all unknowns but constants and discrepancies, which are integrated over."""
    few = {q: part.few for q, part in parts.items()}
    state = {q: part.first for q, part in few.items()} if start is None else dict(start)
    information = {q: part.at(state[q]).information for q, part in few.items()}
    share = 1.0 if single.any() else 0.0
    states, shares, offs = [], [], []
    odds: dict[int, list[float]] = {q: [] for q in few}
    for number in range(_BURNT + rounds):
        prior = np.where(single, share, 1.0)
        chances = {}
        for q, part in few.items():
            others = summed((information[name] for name in few if name != q), len(prior))
            state[q], chances[q] = part.swept(state[q], *posterior(*others, prior), random)
            information[q] = part.at(state[q]).information
        likely = _shares(information.values(), single)
        chance = np.exp(likely - likely.max())
        chance /= chance.sum()
        share = float(SHARES[random.choice(len(SHARES), p=chance)]) if single.any() else 0.0
        if number >= _BURNT:
            states.append(dict(state))
            shares.append(share)
            offs.append(1 - chance[0])
            for q, term in chances.items():
                odds[q].append(term)
    return Chain(tuple(states), np.array(shares), {q: np.array(term) for q, term in odds.items()}, np.array(offs))


def _shares(information: Iterable[tuple[Array, Array]], single: Flags) -> Array:
    """Return log-probabilities of `SHARES`, up to a constant, from every output's information on the constants."""
    precision, weighted = summed(information, len(single))
    shares: Array = np.log(SHARE_CHANCES)
    for k, share in enumerate(SHARES):
        prior = np.where(single, share, 1.0)
        inner = np.eye(len(prior)) + prior[:, None] * precision * prior
        shares[k] += 0.5 * (posterior(precision, weighted, prior)[0] @ weighted - np.linalg.slogdet(inner)[1])
    return shares


def _draw(parts: Mapping[int, Residuals], states: Mapping[int, State], share: float, single: Flags) -> Draw:
    """Return the posterior of the constants given a draw of all other unknowns."""
    return Draw.of({q: part.at(states[q]) for q, part in parts.items()}, np.where(single, share, 1.0))


def _left_out(rows: Measurements, draw: Draw, usual: Mapping[int, Array]) -> tuple[Array, Array]:
    """Return predictions of all values without their rows, and variances with `usual` errors, without outliers."""
    # both follow from the row's block of the inverse joint covariance
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
