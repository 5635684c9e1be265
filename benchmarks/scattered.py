"""Scattered cases by the thousand: error, interval, time and memory beside other packages.

Six inputs, three functions: the voltage of a transformerless push-pull circuit (E. N. Ben-Ari and D. M. Steinberg,
Qual. Eng. 19 (2007) 327) as it is, the same with noise of 1 % of its range, and one with a kink. Errors are against the
truth without noise, over its range; coverage is that of 95 % intervals of new cases, with noise. The rivals estimate
noise too where they can.

``python -m benchmarks.scattered [CASES ...]``
"""

import sys
import warnings
from collections.abc import Callable
from functools import partial
from itertools import product
from resource import RUSAGE_SELF, getrusage

import numpy as np
import xarray as xr

from approximation.arrays import Array
from benchmarks import printed, timed
from benchmarks.rivals import REACH, Predict, Rival, installed, openturns, scikit_learn, smt, standardised, tinygp
from surrogate import Input, ScatterGP

#: Cases of a fit, and fresh ones.
CASES = (1000, 3000)
FRESH = 4000
# Ends of the circuit's inputs: resistances b1, b2, f, c1, c2 in kilo-ohms, and the current gain.
_LOW = np.array([50, 25, 0.5, 1.2, 0.25, 50])
_HIGH = np.array([150, 70, 3, 2.5, 1.2, 300])


def circuit(t: Array) -> Array:
    """Midpoint voltage at scaled inputs, (n, 6) -> (n,)."""
    b1, b2, f, c1, c2, gain = (_LOW + (t + 1) / 2 * (_HIGH - _LOW)).T
    amplified = gain * (c2 + 9)
    base = 12 * b2 / (b1 + b2)
    share = amplified + f
    return np.asarray((base + 0.74) * amplified / share + 11.35 * f / share + 0.74 * f * amplified / (share * c1))


def kinked(t: Array) -> Array:
    """A product with a kink across the middle of the box, (n, 6) -> (n,)."""
    return np.asarray(np.abs(t[:, 0] + 0.5 * t[:, 1]) * np.exp(0.5 * t[:, 2]) + t[:, 3] * t[:, 4] + 0.1 * t[:, 5])


#: Functions and the noise of their cases, over their range.
FUNCTIONS: dict[str, tuple[Callable[[Array], Array], float]] = {
    "circuit": (circuit, 0.0), "circuit with noise": (circuit, 0.01), "kink": (kinked, 0.0),
}  # fmt: skip


def ours(t: Array, y: Array) -> Predict:
    """`ScatterGP` as it comes.

    t: (n, d), scaled coordinates of the cases; y: (n, 1), the output.
    """
    names = [f"x{k}" for k in range(t.shape[1])]
    data = xr.Dataset({name: ("case", column) for name, column in zip(names, t.T, strict=True)})
    model = ScatterGP(inputs=[Input(name, -1, 1) for name in names]).fit(data.assign(y=("case", y[:, 0])))
    return lambda X, with_std: model.predict_array(X, return_std=True)


def _libkriging(t: Array, y: Array) -> Predict:
    """Nested kriging (D. Rulliere et al., Stat. Comput. 28 (2018) 849), groups of 250 cases, without noise."""
    import pylibkriging

    model = pylibkriging.NestedKriging(y[:, 0], np.asfortranarray(t), "matern5_2", max(2, len(t) // 250))

    def predict(X: Array, with_std: bool) -> tuple[Array, Array]:
        mean, std = model.predict(np.asfortranarray(X), True)
        return np.reshape(mean, (-1, 1)), np.reshape(std, (-1, 1))

    return predict


METHODS = [
    Rival("ScatterGP", "surrogate", ours, CASES),
    Rival("scikit-learn GP (RBF, noise)", "sklearn", partial(scikit_learn, noisy=True), CASES[:1]),
    Rival("libKriging nested kriging", "pylibkriging", _libkriging, CASES),
    Rival("SMT Kriging", "smt", partial(smt, noisy=True), CASES[:1]),
    Rival("OpenTURNS Gaussian process", "openturns", openturns, CASES[:1]),
    Rival("tinygp", "tinygp", tinygp, CASES[:1]),
]


def measure(cases: tuple[int, ...] = CASES) -> dict[str, float]:
    """Seconds, memory, errors and coverage by method, function and number of cases."""
    methods, missing = installed(METHODS)
    print(f"  left out, as not installed here: {', '.join(missing) or 'none'}")
    measured: dict[str, float] = {}
    for method, count, name in product(methods, cases, FUNCTIONS):
        if count <= max(method.cases):
            print(f"  {method.name}, {name}, {count} cases ...", flush=True)
            for key, value in row(method, name, count).items():
                measured[f"{method.name}, {name}, {count} cases: {key}"] = value
    return measured


def row(method: Rival, name: str, count: int) -> dict[str, float]:
    """Seconds, memory, errors and coverage of one method on one function."""
    function, share = FUNCTIONS[name]
    random = np.random.default_rng(0)
    t, fresh = random.uniform(-1, 1, (count, 6)), random.uniform(-1, 1, (FRESH, 6))
    truth = function(fresh)
    over = float(np.ptp(truth))
    y, new = (values + share * over * random.normal(size=len(values)) for values in (function(t), truth))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a bound met: the rivals' own affair
        predict, cost = timed(lambda: standardised(y[:, None], lambda values: method.fit(t, values)))
        answers, answered = timed(lambda: predict(fresh, True))
    mean, std = (np.asarray(answer)[:, 0] for answer in answers)
    return {
        "fit, seconds": cost.seconds,
        "fit, seconds of processor time": cost.processor,
        "process so far, megabytes at its peak": getrusage(RUSAGE_SELF).ru_maxrss / 1e3,
        "a query, microseconds": 1e6 * answered.seconds / FRESH,
        "largest error over range": float(np.abs(mean - truth).max()) / over,
        "root-mean-square error over range": float(np.sqrt(np.mean((mean - truth) ** 2))) / over,
        "coverage": float(np.mean(np.abs(mean - new) <= REACH * std)),
    }


if __name__ == "__main__":
    print(printed(measure(tuple(int(word) for word in sys.argv[1:]) or CASES)))
