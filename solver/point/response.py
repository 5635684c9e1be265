"""What a half-space answers to friction, to the first order of it (points, 8)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, BoolArray
from solver.point.profile import Shape

_EDGE = np.ones(1)


@dataclass(frozen=True, eq=False)
class Response:
    """What a half-space answers to friction, without layers, per eta."""

    compliance: Array  # N of the contact; (..., 3, 3)
    coupling: Array  # k of the contact; (..., 3)
    shape: Shape  # The punch

    def part(self, cases: Indices) -> "Response":
        """Some of the cases."""
        return Response(self.compliance[cases], self.coupling[cases], self.shape)

    @cached_property
    def answers(self) -> tuple[Array, Array]:
        """N^-1 k, and N^-1 e_y for a unit shift; (..., 3) each."""
        inverse = np.linalg.inv(self.compliance)
        unit = 2 / np.pi * self.shape.exponent * self.shape.rise
        along = np.einsum("...ij,...j->...i", inverse, self.coupling)
        return np.asarray(along), np.asarray(unit * inverse[..., 0])

    def shift(self, turned: Array) -> Array:
        """c over a times the densities' unit that makes the edge smooth, of H[phi_sigma] there; (...); a disc stays."""
        if self.shape.flat:
            return np.zeros_like(turned)
        along, moved = self.answers
        return np.asarray(along[..., 0] * turned / moved[..., 0])

    def closed(self, turned: Array, b: Array, shift: Array) -> Array:
        """psi of H[phi_sigma] (..., b) and shifts (...); (..., 3, b).

        turned: (..., b), H[phi_sigma]; b: (b,); shift: (...), c over a times the densities' unit.
        """
        along, moved = self.answers
        return np.asarray(
            shift[..., None, None] * moved[..., None] * b ** (self.shape.exponent - 1)
            - along[..., None] * turned[..., None, :]
        )

    def settled(self, turned: Array, series: Array, edges: Array) -> Array:
        """c/a and coefficients of what layers add to psi, where the pressure is smooth at the edge; (cause, 1 + 3 n).

        turned: (cause,), H[phi_sigma] at the edge, of what is closed; series: (3, n, cause + 1), coefficients per
        cause, and of a unit shift; edges: (cause + 1,), what layers add to sigma_yy at the edge.
        """
        shift = np.zeros_like(turned)
        if not self.shape.flat:  # else it stays where it is
            own = self.closed(turned[:, None], _EDGE, np.zeros(turned.size))[:, 0, 0]
            shift = -(own + edges[:-1]) / (edges[-1] + self.closed(np.zeros((1, 1)), _EDGE, np.ones(1))[0, 0, 0])
        both = np.moveaxis(series[..., :-1] + series[..., -1:] * shift, -1, 0)
        return np.concatenate([shift[:, None], both.reshape(shift.size, -1)], 1)


def contact_coupling(coupling: Array, scale: Array, punch: Array | float, conducts: BoolArray) -> Array:
    """k of the contact from that of the body, in its units; (..., 3)."""
    own = coupling - np.asarray(punch / (scale[..., 0] * scale[..., 1]))[..., None] * np.eye(3)[0]
    return np.where(np.concatenate([np.ones_like(conducts[..., :1]), conducts], -1), own, 0.0)


def legendre(b: Array, count: int) -> Array:
    """P_n(2 b - 1); (b, n).

    b: (b,), 0 to 1.
    """
    return np.asarray(np.polynomial.legendre.legvander(2 * b - 1, count - 1))


def legendre_rates(b: Array, count: int) -> Array:
    """d P_n(2 b - 1) / db; (b, n).

    b: (b,), 0 to 1.
    """
    derived = np.polynomial.legendre.legder(np.eye(count), axis=0) if count > 1 else np.zeros((1, count))
    return np.asarray(2 * np.polynomial.legendre.legvander(2 * b - 1, len(derived) - 1) @ derived)
