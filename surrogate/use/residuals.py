"""Residuals of one measured output: a discrepancy or none, the scale of the stated errors, and outliers.

All of it is drawn from its posterior by Gibbs sampling: a parameter after the other from its conditional density on a
lattice through where it is, of random step; constants and discrepancy are integrated over throughout. Errors are
stated ones times an unknown scale, and of a few values wider still (a contaminated normal: G. E. P. Box and G. C. Tiao,
Biometrika 55 (1968) 119).
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from approximation.arrays import Array, Flags, Indices
from surrogate.transforms.measured.discrepancy import Discrepancy

#: Prior of a discrepancy's amplitude over the size of its output: the density falls as a^-1/2, faster from here on.
AMPLITUDE = 0.2
#: Prior of its lengths: log-normal, with this median and deviation of the logarithm; the box is 2 wide.
LENGTH, SPREAD = 2.0, 0.7
#: Prior of the logarithm of true over stated errors: Student's t with so many degrees of freedom and this scale.
FREEDOM, TRUST = 2.0, 0.3
#: Outliers: how many times wider a value's error may be, and how probable each is a priori.
WILD, CHANCE = np.array([1.0, 5.0, 25.0]), np.array([0.98, 0.01, 0.01])

_RISE = 0.5  # of the density of log a below AMPLITUDE: that of a is a^-1/2
_AMPLITUDES, _LENGTHS, _NOISES = (1e-3, 3.0), (0.1, 50.0), (1e-6, 1.0)
_SCALES = (0.3, 30.0)
_FIRST_AMPLITUDE, _FIRST_SCALE, _FIRST_NOISE = 0.02, 2.0, 0.02
_MOST = 120  # values of an output that these are drawn from: the cost grows with their cube
_HUGE = 1000.0  # of a logarithm of odds
_FRAME = 1e300  # beyond any square of a whitened vector
_STEPS = {"amplitude": 0.7, "length": 0.8, "scale": 0.25, "loose": 0.5}  # of the lattices, at most


@dataclass(frozen=True)
class State:
    """One draw of all that is unknown of an output, but for the constants."""

    amplitude: float  # Logarithm of the discrepancy's amplitude over the size of the output
    lengths: Array  # shape (d,); Logarithms of its lengths
    scale: float  # Logarithm of true over stated errors
    loose: float  # Logarithm of the errors that nobody states, over the size of the output
    wild: Indices  # shape (n,); Number of each value's place in `WILD`


@dataclass(frozen=True)
class Residuals:
    """Measured values of one output, linear in the constants."""

    points: Array  # shape (n, d); Scaled inputs
    # shape (n,), (n, k); Measured less model with the constants at zero, and derivatives of the model by the
    # constants
    residual: Array
    slopes: Array
    # shape (n,); Variances of the model's own errors, and of those of measurement as they are stated; zero where they
    # are not
    spread: Array
    stated: Array
    unknown: Flags  # shape (n,); Values whose error of measurement nobody states: they share one
    size: float  # Size of the output, by which amplitude and unknown errors are scaled

    @classmethod
    def of(cls, points: Array, residual: Array, slopes: Array, error: Array, spread: Array, mean: Array) -> "Residuals":
        """Return those of values at points.

        points: (n, d), scaled inputs; residual: (n,), measured less model with the constants at zero; slopes: (n,
        k), derivatives of the model by the constants; error: (n,), stated standard deviations of measurement; NaN:
        unknown; spread: (n,), standard deviations of the model's own errors; mean: (n,), the model's means.
        """
        size = float(np.sqrt(np.mean(mean**2))) or float(np.abs(residual).max()) or 1.0
        return cls(points, residual, slopes, spread**2, np.nan_to_num(error) ** 2, np.isnan(error), size)

    @property
    def first(self) -> State:
        """Return the first state of a chain: larger errors than stated, no discrepancy, no outlier."""
        lengths = np.full(self.points.shape[1], np.log(LENGTH))
        amplitude, scale, loose = np.log([_FIRST_AMPLITUDE, _FIRST_SCALE, _FIRST_NOISE]).tolist()
        return State(amplitude, lengths, scale, loose, np.zeros(len(self.residual), np.intp))

    def at(self, state: State) -> Discrepancy:
        """Return the process with what a state says."""
        amplitude = float(np.exp(state.amplitude)) * self.size
        return Discrepancy(
            self.points, self._noise(state), amplitude, np.exp(state.lengths), self.residual, self.slopes
        )

    def few(self) -> tuple["Residuals", Indices]:
        """Return as many of the values as states are drawn from, and which they are."""
        n = len(self.residual)
        chosen = np.arange(n) if n <= _MOST else np.sort(np.random.default_rng(0).choice(n, _MOST, replace=False))
        names = ("points", "residual", "slopes", "spread", "stated", "unknown")
        return replace(self, **{name: getattr(self, name)[chosen] for name in names}), chosen

    def usual(self, state: State) -> Array:
        """Return variances of the errors of values that are no outliers, (n,)."""
        return np.asarray(self.spread + self._plain(state))

    def swept(self, state: State, mean: Array, covariance: Array, random: np.random.Generator) -> tuple[State, float]:
        """Return a state after one Gibbs round over all unknowns, and log-odds of each discrepancy."""
        misfit, shared = self.residual - self.slopes @ mean, self.slopes @ covariance @ self.slopes.T
        noisy = shared + np.diag(self._noise(state))
        state, odds = self._with_amplitude(state, misfit, noisy, random)
        state = self._with_lengths(state, misfit, noisy, random)
        covariance_rest = shared + (np.exp(state.amplitude) * self.size) ** 2 * self._smooth(state.lengths[None])[0]
        wider = WILD[state.wild] ** 2
        if self.unknown.any():
            levels = _lattice(state.loose, _NOISES, _STEPS["loose"], random)
            extra = np.where(self.unknown, self.size**2 * wider, 0) * np.exp(2 * levels)[:, None]
            likely = _densities(
                _with_diagonals(covariance_rest, self.spread + wider * self._stated(state) + extra), misfit
            )
            state = replace(state, loose=float(levels[_pick(likely, random)]))
        if not self.unknown.all():
            levels = _lattice(state.scale, _SCALES, _STEPS["scale"], random)
            stated = wider * self.stated * np.exp(2 * levels)[:, None]
            likely = _densities(
                _with_diagonals(covariance_rest, self.spread + wider * self._loose(state) + stated), misfit
            )
            likely -= (FREEDOM + 1) / 2 * np.log1p((levels / TRUST) ** 2 / FREEDOM)
            state = replace(state, scale=float(levels[_pick(likely, random)]))
        return replace(state, wild=self._wild(state, misfit, covariance_rest, random)), odds

    def completed(self, state: State, chosen: Indices, mean: Array, random: np.random.Generator) -> State:
        """Return a state that was drawn from some of the values with outliers drawn for the others too.

        mean: (k,), the constants.
        """
        wild = np.zeros(len(self.residual), np.intp)
        wild[chosen] = state.wild
        whole = replace(state, wild=wild)
        others = np.setdiff1d(np.arange(len(wild)), chosen)
        if not len(others):
            return whole
        known = self.few()[0].at(state)
        discrepancy, by_constants, variance = known.at(self.points[others])
        misfit = self.residual[others] - self.slopes[others] @ mean - discrepancy + by_constants @ mean
        noise = self.spread[others, None] + (self._plain(whole)[others, None] * WILD**2) + variance[:, None]
        likely = np.log(CHANCE) - 0.5 * np.log(noise) - 0.5 * misfit[:, None] ** 2 / noise
        wild[others] = [_pick(chances, random) for chances in likely]
        return replace(state, wild=wild)

    def _with_amplitude(
        self, state: State, misfit: Array, noisy: Array, random: np.random.Generator
    ) -> tuple[State, float]:
        levels = _lattice(state.amplitude, _AMPLITUDES, _STEPS["amplitude"], random)
        prior = _RISE * levels - 0.5 * (np.exp(levels) / AMPLITUDE) ** 2
        shares = self.size**2 * np.concatenate([[0.0], np.exp(2 * levels)])
        none, *densities = _densities(noisy + shares[:, None, None] * self._smooth(state.lengths[None]), misfit)
        likely = np.asarray(densities) + prior
        odds = float(np.logaddexp.reduce(likely) - np.logaddexp.reduce(prior) - none)
        return replace(state, amplitude=float(levels[_pick(likely, random)])), odds

    def _with_lengths(self, state: State, misfit: Array, noisy: Array, random: np.random.Generator) -> State:
        variance, lengths = (np.exp(state.amplitude) * self.size) ** 2, state.lengths.copy()
        for i in range(len(lengths)):
            levels = _lattice(lengths[i], _LENGTHS, _STEPS["length"], random)
            candidates = np.repeat(lengths[None], len(levels), 0)
            candidates[:, i] = levels
            likely = _densities(noisy + variance * self._smooth(candidates), misfit)
            likely -= 0.5 * ((levels - np.log(LENGTH)) / SPREAD) ** 2
            lengths[i] = levels[_pick(likely, random)]
        return replace(state, lengths=lengths)

    def _wild(self, state: State, misfit: Array, covariance: Array, random: np.random.Generator) -> Indices:
        """Outliers, a value after the other: what a wider error changes of the density is of rank one."""
        inverse = np.linalg.inv(covariance + np.diag(self._noise(state)))
        pull, wild, plain = inverse @ misfit, state.wild.copy(), self._plain(state)
        left, drawn = random.permutation(len(misfit)), random.uniform(size=len(misfit))
        while len(left):  # until one changes, the conditional chances of all stay as they are
            added = plain[left, None] * (WILD**2 - WILD[wild[left], None] ** 2)
            grown = 1 + added * inverse[left, left, None]
            chance = CHANCE / np.sqrt(grown) * np.exp(
                0.5 * np.minimum(added * pull[left, None] ** 2 / grown, _HUGE)
            )  # fmt: skip
            share = np.cumsum(chance, axis=1)
            drawn_level = (share < drawn[left, None] * share[:, -1:]).sum(axis=1)
            changed = np.flatnonzero(drawn_level != wild[left])
            if not len(changed):
                break
            first = changed[0]
            i, k = left[first], drawn_level[first]
            wild[i], column, part = k, inverse[:, i].copy(), added[first, k] / grown[first, k]
            pull = pull - part * pull[i] * column
            inverse = inverse - part * np.outer(column, column)
            left = left[first + 1 :]
        return wild

    def _stated(self, state: State) -> Array:
        return np.asarray(self.stated * np.exp(2 * state.scale))

    def _loose(self, state: State) -> Array:
        return np.where(self.unknown, (np.exp(state.loose) * self.size) ** 2, 0.0)

    def _plain(self, state: State) -> Array:
        """Variances of measurement of values that are no outliers."""
        return self._stated(state) + self._loose(state)

    def _noise(self, state: State) -> Array:
        return np.asarray(self.spread + WILD[state.wild] ** 2 * self._plain(state))

    def _smooth(self, lengths: Array) -> Array:
        """Correlations of the process among the points, with what keeps them definite: lengths (g, d) to (g, n, n)."""
        n = len(self.points)
        square = np.exp(-2 * lengths) @ self._squares.reshape(lengths.shape[1], -1)
        return np.asarray(np.exp(-0.5 * square).reshape(-1, n, n) + 1e-10 * np.eye(n))

    @cached_property
    def _squares(self) -> Array:
        """Squared distances along every input, (d, n, n)."""
        t = self.points.T
        return np.asarray((t[:, :, None] - t[:, None, :]) ** 2)


def _lattice(current: float, ends: tuple[float, float], step: float, random: np.random.Generator) -> Array:
    """Levels of a logarithm from one end to the other through where it is now, a random step apart."""
    (low, high), step = np.log(ends), step * float(random.uniform(0.6, 1.0))
    return np.asarray(
        current + step * np.arange(np.ceil((low - current) / step), np.floor((high - current) / step) + 1)
    )


def _densities(covariances: Array, misfit: Array) -> Array:
    """Logarithms of normal densities (g,) of one vector (n,) under covariances (g, n, n), up to a constant."""
    g, n = len(covariances), len(misfit)
    framed = np.empty((g, n + 1, n + 1))  # the last row of its root is the vector, whitened
    framed[:, :n, :n], framed[:, n, :n], framed[:, :n, n], framed[:, n, n] = covariances, misfit, misfit, _FRAME
    roots = np.linalg.cholesky(framed)
    sizes = np.log(np.diagonal(roots, axis1=1, axis2=2)[:, :n]).sum(axis=1)
    return np.asarray(-0.5 * (roots[:, n, :n] ** 2).sum(axis=1) - sizes)


def _with_diagonals(matrix: Array, diagonals: Array) -> Array:
    """A matrix (n, n) with diagonals (g, n) added, (g, n, n)."""
    matrices = np.repeat(matrix[None], len(diagonals), 0)
    n = len(matrix)
    matrices[:, np.arange(n), np.arange(n)] += diagonals
    return matrices


def _pick(likely: Array, random: np.random.Generator) -> int:
    """A number by log-densities."""
    share = np.cumsum(np.exp(likely - likely.max()))
    return int(np.searchsorted(share, random.uniform() * share[-1]))
