"""A sphere that slides with air beside it, to the first order in friction, by collocation in r from kernels in space.

Tractions of 1 and of cos(angle) are polynomials on panels in r, and move the surface of a half-space by N/2 pi over the
distance: rings with complete elliptic integrals, integrated towards every node. A film on a rigid, grounded base adds
what an exponential of its system tells, with Bessel functions. At rest Newton's iteration finds the charges in the
gap; the first order is linear about it. The punch conducts the electric field. Lengths are in contact radii.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.special import ellipe, ellipkm1, jv

from verification.oracles.film_waves import film, half_space, pieces
from verification.oracles.surface_response import STIFFNESS, UNITS, Array

_VACUUM = 8.8541878128e-12
_NODES = 6  # a panel
_INNER = np.pi / 2 - np.array([np.pi / 2, 1.2, 0.85, 0.5, 0.25, 0.1, 0.04, 0.012, 0.0])  # r = sin(angle)
_OUTER = np.array([0.0, 0.06, 0.15, 0.3, 0.55, 0.9, 1.4, 2.0, 2.8, 3.6, 4.6, 5.8, 7.2, 8.8])  # r = cosh(angle)
_TOWARDS = np.append(0.0, 0.15 ** np.arange(11, -1, -1.0))  # pieces of a panel towards a node
_RULE = 10  # nodes of a piece
_FAR = 50.0  # r/a from which a film, grounded below, answers nothing beside the gap
_NEWTON_MOST, _CLOSE = 40, 1e-7


@dataclass(frozen=True, eq=False)
class SlidingGap:
    """The contact of a given radius."""

    material: Mapping[str, float]  # Constants of the body, SI
    sphere: float  # Radius of the punch [m], at which its gap ends
    radius: float  # Of the contact [m]
    charge: float = 0.0  # T [C]
    thickness: float = np.inf  # Of a film on a rigid, grounded base [m]; infinite: a half-space
    permittivity: float = 1.0  # Of the medium in the gap over vacuum's

    # -- the body ------------------------------------------------------------------------------------------------------
    @cached_property
    def _half(self) -> tuple[Array, Array]:
        """N over (y, phi) and k, in units of order one."""
        return half_space(self.material)

    @cached_property
    def _film(self) -> tuple[Array, Array, Array]:
        """Wavenumbers times the radius, weights, and what the film adds to N and k there; (q,), (q,), (q, 2, 3)."""
        return film(self.material, self.thickness / self.radius, 2 * _FAR)

    # -- rings ---------------------------------------------------------------------------------------------------------
    @cached_property
    def _panels(self) -> list[tuple[bool, float, float]]:
        """Panels: True for the exterior, and the ends in the angle."""
        within = [(False, low, high) for low, high in pairwise(_INNER.tolist())]
        return within + [(True, low, high) for low, high in pairwise(_OUTER.tolist())]

    @cached_property
    def _angles(self) -> Array:
        """Angles of the nodes, those within first; (n,)."""
        x = np.polynomial.legendre.leggauss(_NODES)[0]
        return np.concatenate([low + (high - low) * (1 + x) / 2 for _, low, high in self._panels])

    @property
    def _count(self) -> int:
        """Nodes within."""
        return _NODES * (_INNER.size - 1)

    @cached_property
    def r(self) -> Array:
        """Nodes r/a; (n,)."""
        return np.concatenate([np.sin(self._angles[: self._count]), np.cosh(self._angles[self._count :])])

    @cached_property
    def _rings(self) -> Array:
        """Mean of 1 and of cos over the distance around rings, integrated over the unknowns; (order, n, n)."""
        kernels = np.zeros((2, self.r.size, self.r.size))
        for row, (node, r) in enumerate(zip(self._angles.tolist(), self.r.tolist(), strict=True)):
            out = row >= self._count
            for panel, (outside, low, high) in enumerate(self._panels):
                target = node if out == outside else (0.0 if outside else np.pi / 2)
                angle, offset, weights = _towards(target, low, high)
                if out != outside:  # both distances to the edge
                    inner, outer = (angle, node) if out else (node, angle)
                    between = 2 * np.sin((np.pi / 2 - inner) / 2) ** 2 + 2 * np.sinh(outer / 2) ** 2
                elif out:
                    between = 2 * np.sinh(offset / 2) * np.sinh(node + offset / 2)
                else:
                    between = 2 * np.sin(offset / 2) * np.cos(node + offset / 2)
                other, carried = _carried(angle, outside)
                values = np.stack(_means(r, other, np.asarray(between))) * weights * carried
                kernels[:, row, _NODES * panel : _NODES * (panel + 1)] = values @ _shape(angle, low, high)
        return kernels

    def _sums(self, order: int) -> Array:
        """int t J(q r) r dr at the film's wavenumbers, from the unknowns; (q, n)."""
        q, parts = self._film[0], []
        for outside, low, high in self._panels:
            near, far = _carried(np.array([low, high]), outside)[0]
            angle, weights = pieces(low, high, float(q[-1] * (far - near) / (high - low)) if near < _FAR else 1.0)
            other, carried = _carried(angle, outside)
            parts.append((jv(order, q[:, None] * other) * weights * carried) @ _shape(angle, low, high))
        return np.concatenate(parts, 1)

    def _moved(self, order: int) -> Array:
        """(u_y, phi) at the nodes from (sigma_yy, D_y); (2, 2, n, n)."""
        operator = np.einsum("ij,rn->ijrn", self._half[0], self._rings[order])
        if np.isfinite(self.thickness):
            q, weights, added = self._film
            waves = jv(order, self.r[:, None] * q) * weights
            operator += np.einsum("rq,qij,qn->ijrn", waves, added[..., :2], self._sums(order), optimize=True)
            far = self.r > _FAR
            operator[:, :, far] = 0.0
            operator[..., far] = 0.0
        return np.asarray(operator)

    # -- at rest -------------------------------------------------------------------------------------------------------
    @property
    def _curved(self) -> float:
        """Half the radius over the sphere's: the profile is this times r^2."""
        return self.radius / (2 * self.sphere)

    @property
    def _widened(self) -> Array:
        """1 + r^2/end^2 beside the contact."""
        return 1 + (self.r[self._count :] * self.radius / self.sphere) ** 2

    @property
    def _medium(self) -> float:
        return self.permittivity * _VACUUM * float(UNITS[2] ** 2) / STIFFNESS

    def _parted(self, moved: Array) -> Array:
        """(u_y, phi) at the nodes from sigma_yy within and all of D_y; (2, n, unknown)."""
        return np.concatenate([moved[:, 0, :, : self._count], moved[:, 1]], -1)

    @cached_property
    def _edge(self) -> Array:
        """Singular part of sigma_yy at the edge; (count,)."""
        row = np.zeros(self._count)
        row[-_NODES:] = _shape(np.array([np.pi / 2]), *_INNER[-2:].tolist())[0]
        return row

    @cached_property
    def _totals(self) -> Array:
        """int t r dr, from the unknowns; (n,)."""
        parts = []
        for outside, low, high in self._panels:
            angle, weights = pieces(low, high, 1.0)
            parts.append((weights * _carried(angle, outside)[1]) @ _shape(angle, low, high))
        return np.concatenate(parts)

    @cached_property
    def _at_rest(self) -> tuple[Array, Array, Array]:
        """sigma_yy within and D_y, scaled; (u0, V); and (gap, phi - V) beside; all over lengths of a radius."""
        count, n = self._count, self.r.size
        moved = self._parted(self._moved(0))
        profile = self._curved * self.r**2
        x: Array = np.zeros(count + n + 2)  # sigma, D, u0, V
        charge = self.charge * float(UNITS[2]) / (STIFFNESS * 2 * np.pi * self.radius**2)
        gap = self._curved * (self.r[count:] ** 2 - 1) ** 1.5 / self.r[count:]
        for step in range(_NEWTON_MOST):
            levels = np.concatenate([moved, np.zeros((2, n, 2))], -1)
            levels[0, :, -2] = levels[1, :, -1] = -1.0
            rows = np.zeros((x.size, x.size))
            right = np.zeros(x.size)
            rows[:count], right[:count] = levels[0, :count], profile[:count]
            rows[count : 2 * count] = levels[1, :count]
            gap_rows = slice(2 * count, count + n)
            D = x[2 * count : count + n]
            rows[gap_rows] = -self._medium * levels[1, count:]
            rows[gap_rows, 2 * count : count + n] += np.diag(gap * self._widened)
            if step > 1:  # Newton's; before, the gap is as without charges
                rows[gap_rows] -= (D * self._widened)[:, None] * levels[0, count:]
                right[gap_rows] = -D * self._widened * (levels[0, count:] @ x)
            rows[-2, :count] = self._edge
            rows[-1, count : count + n], right[-1] = self._totals, -charge
            new = np.asarray(np.linalg.solve(rows, right), dtype=np.float64)
            change, x = float(np.max(np.abs(new - x)) / np.max(np.abs(new))), new
            gap = profile[count:] - (levels[0, count:] @ x)
            if change < _CLOSE and step > 2:
                return x[: count + n], x[count + n :], np.stack([gap, levels[1, count:] @ x])
        raise ArithmeticError(f"the charges in the gap still change by {change:.1e}")

    # -- to the first order --------------------------------------------------------------------------------------------
    @cached_property
    def _pulled(self) -> Array:
        """(u_y, phi) of cos(angle) at the nodes by friction sigma_xy = sigma_yy; (2, n)."""
        k = self._half[1][:, None]
        pressure = self._at_rest[0][: self._count]
        integral, start = np.zeros(self.r.size), 0.0
        for panel in range(_INNER.size - 1):  # 1/r of the load within r
            block, (low, high) = slice(_NODES * panel, _NODES * (panel + 1)), _INNER[panel : panel + 2].tolist()
            for place in range(block.start, block.stop):
                angle, weights = pieces(low, float(self._angles[place]), 1.0)
                integral[place] = start + (weights * np.sin(angle)) @ _shape(angle, low, high) @ pressure[block]
            angle, weights = pieces(low, high, 1.0)
            start += float((weights * np.sin(angle)) @ _shape(angle, low, high) @ pressure[block])
        integral[self._count :] = start
        answer = k * integral / self.r
        if np.isfinite(self.thickness):
            q, weights, added = self._film
            waved = self._sums(0)[:, : self._count] @ pressure
            answer += np.einsum("rq,qi->ir", jv(1, self.r[:, None] * q) * weights, added[..., 2] * waved[:, None])
            answer[:, self.r > _FAR] = 0.0
        return np.asarray(answer)

    @cached_property
    def _turned(self) -> tuple[Array, float]:
        """sigma_yy within and D_y of cos(angle), scaled, and the shift over the radius, per friction."""
        count, n = self._count, self.r.size
        moved = np.concatenate([self._parted(self._moved(1)), np.zeros((2, n, 1))], -1)
        moved[0, :, -1] = -2 * self._curved * self.r
        at_rest, _, (gap, _) = self._at_rest
        D, far = at_rest[2 * count :], self._widened
        rows, right = np.zeros((count + n + 1,) * 2), np.zeros(count + n + 1)
        rows[:count], right[:count] = moved[0, :count], -self._pulled[0, :count]
        rows[count : 2 * count], right[count : 2 * count] = moved[1, :count], -self._pulled[1, :count]
        gap_rows = slice(2 * count, count + n)
        rows[gap_rows] = -self._medium * moved[1, count:] - (D * far)[:, None] * moved[0, count:]
        rows[gap_rows, 2 * count : count + n] += np.diag(gap * far)
        rows[gap_rows, -1] += D * gap * 2 * self.r[count:] * (self.radius / self.sphere) ** 2
        right[gap_rows] = self._medium * self._pulled[1, count:] + D * far * self._pulled[0, count:]
        rows[-1, :count] = self._edge
        solution = np.asarray(np.linalg.solve(rows, right), dtype=np.float64)
        return solution[:-1], float(solution[-1])

    # -- outputs -------------------------------------------------------------------------------------------------------
    @property
    def force(self) -> float:
        """P [N]."""
        pressure = self._at_rest[0][: self._count]
        return float(-2 * np.pi * self.radius**2 * STIFFNESS * (self._totals[: self._count] @ pressure))

    @property
    def voltage(self) -> float:
        """V [V]."""
        return float(self._at_rest[1][1] * UNITS[2] * self.radius)

    @property
    def offset(self) -> float:
        """Shift to the trailing side per friction [m]."""
        return self._turned[1] * self.radius

    @property
    def charges(self) -> tuple[Array, Array]:
        """D_y at the nodes at rest, and per friction that of cos(angle) [C/m2]; (n,) each."""
        within = np.cos(self._angles[: self._count])
        size = np.concatenate([1 / within, np.ones(self.r.size - self._count)]) * STIFFNESS / UNITS[2]
        return self._at_rest[0][self._count :] * size, self._turned[0][self._count :] * size

    @property
    def pressures(self) -> tuple[Array, Array]:
        """The same of the pressure at the nodes within [Pa]; (count,) each."""
        size = -STIFFNESS / np.cos(self._angles[: self._count])
        return self._at_rest[0][: self._count] * size, self._turned[0][: self._count] * size


def _towards(target: float, low: float, high: float) -> tuple[Array, Array, Array]:
    """Nodes between two ends that crowd about a target or the end next to it, their distance to it, and weights."""
    x, w = np.polynomial.legendre.leggauss(_RULE)
    centre, parts = min(max(target, low), high), []
    for sign, length in ((-1.0, centre - low), (1.0, high - centre)):
        if length > 0:
            pieces = length * _TOWARDS
            half = np.diff(pieces)[:, None] / 2
            steps = (pieces[:-1, None] + half * (1 + x)).ravel()
            parts.append(np.stack([centre + sign * steps, sign * steps + (centre - target), (half * w).ravel()]))
    angle, offset, weights = np.concatenate(parts, 1)
    return angle, offset, weights


def _shape(angle: Array, low: float, high: float) -> Array:
    """Interpolation matrix from a panel's nodes to angles; (angle, node)."""
    nodes = np.polynomial.legendre.leggauss(_NODES)[0]
    local = (2 * angle - low - high) / (high - low)
    to_series = np.linalg.inv(np.polynomial.legendre.legvander(nodes, _NODES - 1))
    return np.asarray(np.polynomial.legendre.legvander(local, _NODES - 1) @ to_series)


def _carried(angle: Array, outside: bool) -> tuple[Array, Array]:
    """r, and t r dr/d(angle) over the unknown: t beside the contact, t cos(angle) within, as singular as it may be."""
    return (np.cosh(angle), np.cosh(angle) * np.sinh(angle)) if outside else (np.sin(angle), np.sin(angle))


def _means(r: float, other: Array, between: Array) -> tuple[Array, Array]:
    """Mean of 1 and of cos over the distance of a ring from a point; their radii, and the difference of these."""
    total = r + other
    K, E = ellipkm1((between / total) ** 2), ellipe(1 - (between / total) ** 2)
    return 2 / np.pi * K / total, ((r**2 + other**2) * K / total - total * E) / (np.pi * r * other)
