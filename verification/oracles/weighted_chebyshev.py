"""Moments, Hilbert transforms and end-proof quadrature of (1-X)^A (1+X)^B times Chebyshev polynomials."""

import numpy as np
from scipy.special import gamma, hyp2f1, rgamma, roots_jacobi

from verification.oracles.surface_response import Array

_ABSCISSAE = np.linspace(-5.9, 5.9, 1181)


def moments(A: float, B: float, count: int) -> Array:
    """(1/pi) int (1-X)^A (1+X)^B T_n dX, n < count, by Gauss-Jacobi quadrature."""
    with np.errstate(invalid="ignore"):  # at A + B = -1 SciPy computes 0/0 for an entry that it does not use
        x, w = roots_jacobi(count, A, B)
    out: Array = w @ np.polynomial.chebyshev.chebvander(x, count - 1) / np.pi
    return out


def transforms(X: Array, A: float, B: float, count: int) -> Array:
    """(1/pi) PV int (1-s)^A (1+s)^B T_n(s)/(s-X) ds, (count, points).

    The first from Erdogan, Gupta and Cook (Methods of Analysis and Solutions of Crack Problems, 1973, chapter 7), the
    others from T_n+1 = 2 X T_n - T_n-1.

    X: (points,), |X| < 1.
    """
    mean = moments(A, B, max(count, 2))
    out = np.empty((max(count, 2), len(X)))
    factor = 2 ** (A + B) * gamma(A) * gamma(B + 1) * rgamma(A + B + 1) / np.pi
    out[0] = (1 - X) ** A * (1 + X) ** B / np.tan(np.pi * A) - factor * hyp2f1(1, -A - B, 1 - A, (1 - X) / 2)
    out[1] = X * out[0] + mean[0]
    for n in range(1, len(out) - 1):
        out[n + 1] = 2 * (X * out[n] + mean[n]) - out[n - 1]
    return out[:count]


def end_proof_nodes() -> tuple[Array, Array, Array]:
    """1 - X, 1 + X and weights of double-exponential quadrature over -1 < X < 1, whatever the exponents at the ends."""
    growth = np.exp(np.pi * np.sinh(_ABSCISSAE))
    right, left = 2 / (1 + growth), 2 / (1 + 1 / growth)
    return right, left, (_ABSCISSAE[1] - _ABSCISSAE[0]) * np.pi * np.cosh(_ABSCISSAE) * right * left / 2
