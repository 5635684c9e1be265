"""Densities over a contact whose derivatives are singular at its edge, and integrals of singular kernels (points, 4).

A density phi(b), 0 <= b <= 1, is a polynomial of u on each of three pieces: of b itself about the centre, even, and
beside it, and of u = (1 - b)^(1/3) up to the edge, where (1 - b) log(1 - b) is nearly smooth in u. A profile that is
kinked at its apex has such a piece about the centre, too. A kernel that is singular at a distance of 0 is integrated by
nodes that crowd there. What friction makes of a density is odd in b, and stands at the same nodes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise

import numpy as np
from scipy.sparse import csr_array

from approximation.arrays import Indices
from solver.arrays import Array

_INNER, _OUTER = 0.48, 0.85  # where the pieces meet, and no pressure is sampled
_SMOOTH, _ROUGH = 20, 36  # nodes of a piece, and of one that ends where something is singular
_EDGE, _APEX = 3.0, 3.0  # powers of u there
_CENTRE = 1e-6  # radius within which a kinked profile is read at it
_STEP, _STEPS, _FAR_STEPS = 3.0, 8, 2  # of the distances that nodes crowd in; a mirror image is far
_CROWD, _INMOST, _POWER = 20, 24, 4.0  # nodes of a step, and of the one at the singularity, v^power there


@cache
def _gauss(count: int) -> tuple[Array, Array]:
    """Nodes and weights on 0 to 1."""
    x, w = np.polynomial.legendre.leggauss(count)
    return (1 + x) / 2, w / 2


@dataclass(frozen=True)
class Piece:
    """b = start + stretch u^power of 0 <= u <= 1, and polynomials of u."""

    start: float
    stretch: float
    power: float
    count: int
    even: bool = False
    odd: bool = False

    @cached_property
    def nodes(self) -> Array:
        """u; (node,)."""
        return 2 * _gauss(2 * self.count)[0][self.count :] - 1 if self.even else _gauss(self.count)[0]

    def b(self, u: Array) -> Array:
        """The place of u."""
        return np.asarray(self.start + self.stretch * np.abs(u) ** self.power)

    def slope(self, u: Array) -> Array:
        """Size of db/du."""
        return np.asarray(abs(self.stretch) * self.power * np.abs(u) ** (self.power - 1))

    def u(self, b: Array) -> Array:
        """Where b is, beyond 0 or 1 at the nearer end."""
        return np.asarray(np.clip((b - self.start) / self.stretch, 0.0, 1.0) ** (1 / self.power))

    @cached_property
    def weights(self) -> Array:
        """Of int db at the nodes; (node,)."""
        own = 2 * _gauss(2 * self.count)[1][self.count :] if self.even else _gauss(self.count)[1]
        return np.asarray(own * self.slope(self.nodes))

    @cached_property
    def _cardinal(self) -> Array:
        """Legendre coefficients of the polynomials that are 1 at one node; (degree + 1, node)."""
        if not self.even:
            return np.asarray(np.linalg.inv(np.polynomial.legendre.legvander(2 * self.nodes - 1, self.count - 1)))
        found = np.zeros((2 * self.count, self.count))
        found[self.odd :: 2] = np.linalg.inv(
            np.polynomial.legendre.legvander(self.nodes, 2 * self.count - 1)[:, self.odd :: 2]
        )
        return found

    def shares(self, u: Array) -> Array:
        """Of the nodes in phi; (u, node)."""
        return self._read(u, self._cardinal)

    def derived(self, u: Array) -> Array:
        """Of the nodes in dphi/du; (u, node)."""
        own = np.polynomial.legendre.legder(self._cardinal) * (1 if self.even else 2)
        return self._read(u, np.asarray(own, dtype=np.float64))

    def _read(self, u: Array, series: Array) -> Array:
        at = u if self.even else 2 * u - 1
        return np.asarray(np.polynomial.legendre.legvander(at, len(series) - 1) @ series)


def _crowded(at: float, low: float, steps: int) -> tuple[Array, Array]:
    """Nodes and weights on low to 1 for what is singular at a place in it."""
    away = (1 - low) * _STEP ** -np.arange(steps + 1.0)
    ends = np.unique(np.clip(np.concatenate([at + away, at - away, [at, low, 1.0]]), low, 1.0))
    start, length = ends[:-1], np.diff(ends)
    beside = (start == at) | (ends[1:] == at)
    x, w = _gauss(_CROWD)
    v, own = _gauss(_INMOST)
    signed = np.where(start == at, length, -length)[beside, None]
    nodes = [(start[~beside, None] + length[~beside, None] * x).ravel(), (at + signed * v**_POWER).ravel()]
    weights = [
        (length[~beside, None] * w).ravel(),
        (np.abs(signed) * _POWER * v ** (_POWER - 1) * own).ravel(),
    ]
    return np.concatenate(nodes), np.concatenate(weights)


@dataclass(frozen=True, eq=False)
class Points:
    """Where a kernel of b - b' is asked for, of all places b."""

    places: Indices  # Numbers of the places; (point,)
    # b - b', to its own digits, and b'; (point,) each
    distances: Array
    sources: Array
    weights: Array  # Of int db'; (point,)

    @classmethod
    def joined(cls, parts: Sequence["Points"]) -> "Points":
        """Those of all parts."""
        return cls(
            np.concatenate([part.places for part in parts]),
            *(np.concatenate([getattr(part, name) for part in parts]) for name in ("distances", "sources", "weights")),
        )


@dataclass(frozen=True)
class Pieces:
    """The pieces of a contact."""

    kinked: bool = False
    odd: bool = False

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """From the centre to the edge."""
        apex = Piece(0.0, _INNER, _APEX, _ROUGH) if self.kinked else Piece(0.0, _INNER, 1.0, _SMOOTH, True, self.odd)
        return apex, Piece(_INNER, _OUTER - _INNER, 1.0, _SMOOTH), Piece(1.0, _OUTER - 1, _EDGE, _ROUGH)

    @property
    def count(self) -> int:
        """Number of nodes."""
        return sum(piece.count for piece in self.pieces)

    @property
    def _columns(self) -> list[slice]:
        ends = np.cumsum([0, *(piece.count for piece in self.pieces)]).tolist()
        return [slice(*pair) for pair in pairwise(ends)]

    @cached_property
    def nodes(self) -> Array:
        """b; (node,)."""
        return np.concatenate([piece.b(piece.nodes) for piece in self.pieces])

    @cached_property
    def weights(self) -> Array:
        """Of int_0^1 phi db; (node,)."""
        return np.concatenate([piece.weights for piece in self.pieces])

    def shares(self, b: Array) -> Array:
        """Of the nodes in phi at 0 <= b <= 1; (b, node)."""
        found = np.zeros((b.size, self.count))
        which = np.searchsorted([_INNER, _OUTER], b)
        for number, (piece, span) in enumerate(zip(self.pieces, self._columns, strict=True)):
            there = np.flatnonzero(which == number)
            found[there, span] = piece.shares(piece.u(b[there]))
        return found

    @cached_property
    def _rule(self) -> tuple["Points", csr_array]:
        """Where kernels are asked for, of all places, and what they sum to; (point,), (place node, point).

        The places are the nodes, and the edge behind them.
        """
        parts, values, columns, rows = list[Points](), [], [], []
        points = place = 0
        for number, own in enumerate(self.pieces):
            for at in (*own.nodes.tolist(), *([0.0] if own is self.pieces[-1] else [])):
                for other, (piece, span) in enumerate(zip(self.pieces, self._columns, strict=True)):
                    for mirrored in (False,) if piece.even else (False, True):
                        part, shares = _towards(own, at, piece, same=number == other, mirrored=mirrored, place=place)
                        parts.append(part)
                        values.append((-shares if mirrored and self.odd else shares).ravel())
                        columns.append(np.repeat(points + np.arange(part.places.size), piece.count))
                        rows.append(np.tile(place * self.count + np.arange(span.start, span.stop), part.places.size))
                        points += part.places.size
                place += 1
        where = np.concatenate(rows), np.concatenate(columns)
        matrix = csr_array((np.concatenate(values), where), shape=(place * self.count, points))
        return Points.joined(parts), matrix

    @property
    def points(self) -> "Points":
        """Where :meth:`integrated` needs a kernel."""
        return self._rule[0]

    def integrated(self, kernels: Array) -> Array:
        """Matrix of int_-1^1 kernel(b - b') phi(b') db' for densities of this parity; (node + 1, node, c)."""
        return np.asarray(self._rule[1] @ kernels).reshape(self.count + 1, self.count, -1)

    def summed(self, kernels: Array) -> Array:
        """int_-1^1 of what is known at the points: a kernel times a density; (node + 1, c)."""
        points = self.points
        found = np.zeros((self.count + 1, kernels.shape[1]))
        np.add.at(found, points.places, points.weights[:, None] * kernels)
        return found

    def bounded(self, x: Array, power: int = 0) -> Array:
        """Shares of the nodes and of phi(1) in int_r^1 phi'(b) b^power db / sqrt(b^2 - r^2); (x, node + 1).

        r^2 = 1 - x^2. Where the pieces meet their polynomials differ by what is neglected: that step belongs to the
        derivative. The centre of a kinked profile, where rounding would grow, is taken at r = 1e-6.

        x: (x,), sqrt(1 - r^2/a^2).
        """
        return np.array([self._bounded_at(top, power) for top in x.tolist()])

    def _bounded_at(self, top: float, power: int) -> Array:
        square = max((1 - top) * (1 + top), _CENTRE**2 if self.kinked else 0.0)
        r = np.sqrt(square)
        found, (x, w) = np.zeros(self.count + 1), _gauss(_INMOST)
        for piece, span in zip(self.pieces, self._columns, strict=True):
            low, high = sorted(piece.b(np.array([0.0, 1.0])).tolist())
            if r >= high:
                continue
            at, end = float(piece.u(r)), 0.0 if piece.stretch < 0 else 1.0
            places = at + (end - at) * np.append(0.0, _STEP ** -np.arange(_STEPS, -1.0, -1.0))
            for first, last in zip(places[:-1].tolist(), places[1:].tolist(), strict=True):
                if first == at and r >= low:  # from r itself, by the root in it
                    far = np.sqrt(piece.b(last) ** 2 - square)
                    b = np.sqrt(square + (far * x) ** 2)
                    u, weights = piece.u(b), far * w / b
                    weights = weights / piece.slope(u)
                else:
                    u = first + (last - first) * x
                    b = piece.b(u)
                    weights = abs(last - first) * w / np.sqrt(b**2 - square)
                found[span] += np.sign(piece.stretch) * ((weights * b**power) @ piece.derived(u))
        return found + self._steps_at(square, power)

    def _steps_at(self, square: float, power: int) -> Array:
        """What steps between the pieces, and at the edge, have of it."""
        found = np.zeros(self.count + 1)
        found[-1] = 1 / np.sqrt(1 - square)
        for piece, span in zip(self.pieces, self._columns, strict=True):
            for end, sign in ((0.0, np.sign(piece.stretch)), (1.0, -np.sign(piece.stretch))):
                b = float(piece.b(np.array(end)))
                apart = b**2 - square
                if apart > 0 and not (end == 0 and piece.start == 0):
                    found[span] += sign * b**power * piece.shares(np.array([end]))[0] / np.sqrt(apart)
        return found


def _towards(own: Piece, at: float, piece: Piece, *, same: bool, mirrored: bool, place: int) -> tuple[Points, Array]:
    """From a place u of one piece to nodes on another or its mirror image, and shares times weights."""
    b = own.b(np.array(at))
    if mirrored:
        nearest, steps = (float(piece.u(-b)), _FAR_STEPS if piece.start else _STEPS)
    else:
        nearest, steps = at if same else float(piece.u(b)), _STEPS
    u, weights = _crowded(nearest, -1.0 if piece.even else 0.0, steps)
    sources = np.sign(u) * piece.b(u) * (-1 if mirrored else 1)
    if mirrored or not same:
        away = b - sources
    elif piece.even:
        away = piece.stretch * (at - u)
    else:
        away = piece.stretch * (at**piece.power - u**piece.power)
    weights = weights * piece.slope(u)
    return Points(np.full(u.size, place), away, sources, weights), weights[:, None] * piece.shares(u)
