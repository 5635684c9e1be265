"""Linear quantile regression, with the check function smoothed so that Newton's method applies."""

import numpy as np
from scipy.special import ndtr

from approximation.arrays import Array

# The smoothing ends at this share of the residuals' upper spread, where its bias no longer matters.
BANDWIDTH = 0.1
# Further away, in widths, a case has no weight in the curvature: its density is below the last digit of the nearest's.
FAR = 8.5
# Keeps at zero what few values tell: in sparse parts of the box a share may lie below whatever is large enough.
RIDGE = 1.0


def quantile_regression(A: Array, y: Array, level: float, start: Array | None = None) -> Array:
    """Fit coefficients b so that a share `level` of y lies below A b.

    Minimises the check function of R. Koenker and G. Bassett, Econometrica 46 (1978) 33, convolved with a Gaussian (M.
    Fernandes, E. Guerre and E. Horta, J. Bus. Econ. Stat. 39 (2021) 338), whose width shrinks as the fit improves.

    A: (n, k); y: (n,); start: (k,), optional; result: (k,).
    """
    A = np.ascontiguousarray(A)  # cases are picked out of it
    if start is None:
        b = np.zeros(A.shape[1])
        b[0] = np.quantile(y, level)
        width = float(np.std(y))
    else:
        b, width = start, BANDWIDTH * _spread(y - A @ start, level)
    while width > 0:
        b = _newton(A, y, level, width, b)
        spread = _spread(y - A @ b, level)
        if width <= BANDWIDTH * spread or spread == 0:
            break
        width = max(width / 2.5, 0.9 * BANDWIDTH * spread)
    return b


def _spread(residual: Array, level: float) -> float:
    return float(np.quantile(residual, (1 + level) / 2) - np.quantile(residual, 0.5))


def _newton(A: Array, y: Array, level: float, width: float, b: Array) -> Array:
    penalty = np.full(A.shape[1], RIDGE)
    penalty[0] = 0

    def cost(b: Array) -> float:
        u = y - A @ b
        z = u / width
        return float(np.sum(u * (level - ndtr(-z)) + width * _density(z)) + 0.5 * penalty @ b**2)

    value = cost(b)
    for _ in range(30):
        z = (y - A @ b) / width
        if _density(z).sum() < 1e-9:  # no case is near: two clusters, with the quantile between them
            break
        slope = penalty * b - A.T @ (level - ndtr(-z))
        near = np.abs(z) < FAR
        root = A[near] * np.sqrt(_density(z[near]) / width)[:, None]
        curvature = root.T @ root + np.diag(penalty)
        curvature[np.diag_indices_from(curvature)] += 1e-6 * np.trace(curvature) / len(b)
        step = np.linalg.solve(curvature, slope)
        length = 1.0
        reached = cost(b - step)
        while reached > value - 1e-4 * length * float(slope @ step) and length > 1e-8:
            length /= 2
            reached = cost(b - length * step)
        b = b - length * step
        before, value = value, reached
        if before - value < 1e-5 * abs(value):
            break
    return b


def _density(z: Array) -> Array:
    return np.asarray(np.exp(-0.5 * z * z) / np.sqrt(2 * np.pi))
