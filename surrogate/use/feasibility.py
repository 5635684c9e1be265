"""The edge beyond which cases are refused, learnt from cases of which it is known: a region with a margin.

A polynomial of the scaled inputs by logistic regression with a ridge, its degree by cases left out in folds. Where it
is cut is a conformal threshold (V. Vovk, A. Gammerman and G. Shafer, Algorithmic Learning in a Random World (2005)): of
n refused cases left out, the k-th highest value passes a fresh refused case with a probability of k / (n + 1) at most.
The margin is a little wider: the answered cases next to the edge are given up, for there the edge is known least.
"""

from collections.abc import Sequence
from itertools import product

import numpy as np

from approximation import products
from approximation.arrays import Array, Flags, Indices
from surrogate.face.region import Region

#: Share of the refused cases that may pass, share of the answered ones that the margin takes at least, folds, and most
#: cases and terms that are learnt from.
PASSING, MARGIN, FOLDS, MOST_CASES, MOST_TERMS = 0.05, 0.01, 5, 6000, 100
#: Highest total degree that is tried, cases that a term needs, the ridge, and steps of Newton's iteration.
_DEGREES, _CASES_A_TERM, _RIDGE, _REGRESSION_STEPS = (1, 2, 3, 4, 6), 4, 1e-4, 60
#: Logarithm of the odds where all cases of a fold are answered, or refused.
_CERTAIN = 10.0
#: Refused cases whose reasons are kept.
_TOLD = 200


def learn(t: Array, refused: Flags, even: Flags, groups: Indices, which: Indices, reasons: Sequence[str]) -> Region:
    """Learn where cases are answered.

    t: (d, n); refused: (n,); even: (n,); groups: (n,); which: (k,).
    """
    random = np.random.default_rng(0)
    whole = t
    chosen = _chosen(refused, even, random)
    t, known, held, groups = t[:, chosen], refused[chosen], even[chosen], groups[chosen]
    numbers = np.unique(groups, return_inverse=True)[1].ravel()
    fold = random.permutation(np.arange(numbers.max() + 1) % FOLDS)[numbers]
    tried = [_total(len(t), degree) for degree in _DEGREES]
    tried = [degrees for degrees in tried if len(degrees) <= min(MOST_TERMS, len(known) // _CASES_A_TERM)] or [
        _total(len(t), 1)
    ]
    scores = [_left_out(degrees, t, known, fold) for degrees in tried]
    best = int(np.argmin([_loss(score, known) for score in scores]))
    degrees, score = tried[best], scores[best]
    coefficients = _fitted(products.values(degrees, t), known)
    threshold = score[known & held] if (known & held).any() else score[known]
    rank = int(PASSING * (len(threshold) + 1))
    answered = score[~known & held] if (~known & held).any() else score[~known]
    least = max(float(np.sort(threshold)[-max(rank, 1)]), float(np.quantile(answered, MARGIN)))
    places = np.flatnonzero(refused)
    sample = random.permutation(len(places))[:_TOLD]
    return Region(
        degrees,
        coefficients,
        least,
        max(rank, 1) / (len(threshold) + 1),
        float(refused[even].mean()) if even.any() else float(refused.mean()),
        float((answered < least).mean()),
        np.ascontiguousarray(whole[:, places[sample]].T),
        np.asarray(which)[sample],
        tuple(reasons),
    )


def _chosen(refused: Flags, even: Flags, random: np.random.Generator) -> Indices:
    """Choose at most so many cases: evenly spread ones first, and as many refused ones as fit."""
    chosen = []
    for kind in (refused, ~refused):
        places = random.permutation(np.flatnonzero(kind))
        chosen.append(places[np.argsort(~even[places], kind="stable")][: MOST_CASES // 2])
    return np.sort(np.concatenate(chosen))


def _total(inputs: int, degree: int) -> Indices:
    """Degrees of all terms up to a total degree, the constant first."""
    exponents = [index for index in product(range(degree + 1), repeat=inputs) if sum(index) <= degree]
    return np.array(sorted(exponents, key=lambda index: (sum(index), index)), dtype=np.intp)


def _left_out(degrees: Indices, t: Array, refused: Flags, fold: Indices) -> Array:
    """The value at every case of the polynomial that the other folds tell, (n,)."""
    terms, predicted = products.values(degrees, t), np.empty(t.shape[1])
    for number in range(FOLDS):
        out = fold == number
        if out.any():
            predicted[out] = _fitted(terms[:, ~out], refused[~out]) @ terms[:, out]
    return predicted


def _loss(score: Array, refused: Flags) -> float:
    """Mean negative logarithm of the probability of what is known."""
    return float(np.logaddexp(0.0, np.where(refused, score, -score)).mean())


def _fitted(terms: Array, refused: Flags) -> Array:
    """Coefficients by penalised likelihood, positive where cases are answered; terms (m, n), the constant first."""
    from sklearn.linear_model import LogisticRegression  # slow to import

    if refused.all() or not refused.any():  # nothing tells an edge
        return np.append(_CERTAIN * (1 if not refused.any() else -1), np.zeros(len(terms) - 1))
    regression = LogisticRegression(
        C=1 / (_RIDGE * len(refused)), solver="newton-cholesky", tol=1e-8, max_iter=_REGRESSION_STEPS
    )
    fitted = regression.fit(terms[1:].T, ~refused)
    return np.append(fitted.intercept_, fitted.coef_)
