"""The smooth kernels applied to the basis of the tractions, at many half-lengths at once (films, section 4)."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.polynomial.chebyshev import chebint, chebvander
from scipy.special import betainc, exp1, jv

from approximation.chebyshev import coefficients, gauss_points
from solver.arrays import Array
from solver.line.basis import Basis, double_exponential, jacobi
from solver.line.kernel import CHANNEL, POTENTIAL, POTENTIAL_SHEAR, SHEAR, TANGENTIAL
from solver.line.system import System
from solver.stack.electroded import lowest, surface
from solver.stack.grading import GradedResponse
from solver.stack.wavenumbers import wavenumbers

#: Types of integrals: sgn, its product with (X - S) and (X - S)^2; the same of log; the same of 1.
SIGN, LOG, PLAIN = 0, 3, 6


@dataclass(frozen=True, eq=False)
class Rough:
    """Integrals of the basis with the parts of a graded film's kernels that are not smooth (films, section 7).

    Parts that decay like k^-j in Fourier space are, in x, a smooth remainder and multiples of

        K_oo:  -Y1/2 sgn x + Y2/pi x log|x| + Y3/4 x|x|,     K_ox:  Y1/pi log|x| + Y2/2 |x| - Y3/(2 pi) x^2 log|x|

    Integrals of the basis times sgn(X - S) and log|X - S| are closed; recurrences give their products with X - S. A
    double exponential rule projects these parts, for any exponent at the edges.
    """

    basis: Basis

    @cached_property
    def _rule(self) -> tuple[Array, Array, Array, Array]:
        """X, 1 - X, 1 + X and weights of a double exponential rule on [-1, 1]."""
        A, B = self.basis.exponents
        return double_exponential(min(1 - A, 1 - B, 1 + A, 1 + B), 301 + 8 * self.basis.terms)

    @cached_property
    def projected(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Coefficients in P^(-A,-B) and in U, of the pressure's terms and of a field's; (type, M, term) each.

        Behind the M coefficients in U stand the sums of all, M and beyond, at X = 1 and at X = -1 with the signs of
        T_n there: integrals with sqrt((1 +- X) / (1 -+ X)) / pi.
        """
        X, to_trailing, to_leading, weights = self._rule
        basis = self.basis
        A, B = basis.exponents
        dual = basis.dual(X, basis.terms) * (weights * to_trailing**-A * to_leading**-B) / basis.dual_norms[:, None]
        angle = 2 * np.arctan2(np.sqrt(to_trailing), np.sqrt(to_leading))
        orders = np.arange(1, basis.terms + 1)[:, None]
        whole = np.stack([1 / np.tan(angle / 2), -np.tan(angle / 2)]) / 2  # sums of sin(n angle), with the signs
        series = 2 / np.pi * np.concatenate([np.sin(orders * angle), whole]) * weights  # U_(n-1) sqrt(1 - X^2)
        pressed, charged = self.pressures(X, to_trailing, to_leading), self.charges(to_trailing, to_leading)
        return (dual @ pressed, series @ pressed), (dual @ charged, series @ charged)

    def at(self, X: Array) -> tuple[Array, Array]:
        """Integrals at points on either side of the edges; (type, point, term), of the pressure and of a field."""
        inside = np.abs(X) <= 1
        within, beyond = X[inside], X[~inside]
        closed = self.pressures(within, 1 - within, 1 + within), self.charges(1 - within, 1 + within)
        S, to_trailing, to_leading, weights = self._rule
        A, B = self.basis.exponents
        angle = 2 * np.arctan2(np.sqrt(to_trailing), np.sqrt(to_leading))[:, None]
        terms = (
            (weights * to_trailing**A * to_leading**B)[:, None] * self.basis.pressure_factor(S),
            (weights / np.sqrt(to_trailing * to_leading))[:, None] * np.cos(angle * np.arange(self.basis.terms + 1)),
        )
        distance = np.where(beyond[:, None] > 0, beyond[:, None] - 1 + to_trailing, beyond[:, None] + 1 - to_leading)
        functions = np.array([np.sign(distance), np.log(np.abs(distance)), np.ones_like(distance)])
        parts = []
        for values, rule in zip(closed, terms, strict=True):
            whole = np.empty((9, X.size, rule.shape[1]))
            whole[:, inside] = values
            for kind, power in np.ndindex(3, 3):
                whole[3 * kind + power, ~inside] = (functions[kind] * distance**power) @ rule
            parts.append(whole)
        return parts[0], parts[1]

    def pressures(self, X: Array, to_trailing: Array, to_leading: Array) -> Array:
        """Integrals of w P_j; (type, point, pressures).

        X, to_trailing, to_leading: (point,), points, and 1 - X and 1 + X of them.
        """
        A, B = self.basis.exponents
        count = self.basis.pressures + 2
        j = np.arange(1, count)
        sign = np.empty((X.size, count))
        sign[:, 0] = self.basis.total * (2 * betainc(B + 1, A + 1, to_leading / 2) - 1)
        edge = (to_trailing ** (A + 1) * to_leading ** (B + 1))[:, None]
        sign[:, 1:] = -edge * jacobi(count - 1, A + 1, B + 1, X) / j
        # d/dX int w P_j log|X - S| = pi tan(theta) w P_j + pi gain P_(j+k0)^(-A,-B)
        tan = np.tan(np.pi * self.basis.delta)
        log = np.pi / 2 * tan * sign + self._smooth_logs(X, count, tan)
        shift = _multiplication(count, A, B)
        return self._by_distance(X, sign, log, self.basis.total, shift)[..., : self.basis.pressures]

    def _smooth_logs(self, X: Array, count: int, tan: float) -> Array:
        """The polynomial part of the logarithmic integrals, with its constants from X = 1; (X, count)."""
        A, B = self.basis.exponents
        size = count + 2
        dual = jacobi(count + 1, -A, -B, gauss_points(size))
        order = self.basis.order
        local = dual[:, order : order + count] if order >= 0 else np.concatenate([0 * dual[:, :1], dual], 1)[:, :count]
        series = chebint(np.pi * self.basis.gain * coefficients(local))
        values = chebvander(X, size) @ series
        at_one = np.sum(series, 0)  # T_n(1) = 1
        S, to_trailing, to_leading, weights = self._rule
        exact = (weights * to_trailing**A * to_leading**B * np.log(to_trailing)) @ jacobi(count, A, B, S)
        moments = np.zeros(count)
        moments[0] = self.basis.total
        return np.asarray(values + (exact - np.pi / 2 * tan * moments - at_one))

    def charges(self, to_trailing: Array, to_leading: Array) -> Array:
        """Integrals of T_n / sqrt(1 - X^2); (type, point, M + 1).

        to_trailing, to_leading: (point,), 1 - X and 1 + X of points.
        """
        count = self.basis.terms + 3
        angle = 2 * np.arctan2(np.sqrt(to_trailing), np.sqrt(to_leading))[:, None]
        n = np.arange(1, count)
        sign = np.concatenate([np.pi - 2 * angle, -2 / n * np.sin(n * angle)], 1)
        log = np.concatenate([np.full_like(angle, -np.pi * np.log(2)), -np.pi / n * np.cos(n * angle)], 1)
        shift = (np.eye(count, k=1) + np.eye(count, k=-1)) / 2
        shift[0, 1] = 1.0
        return self._by_distance(np.cos(angle[:, 0]), sign, log, np.pi, shift)[..., : self.basis.terms + 1]

    @staticmethod
    def _by_distance(X: Array, sign: Array, log: Array, total: float, shift: Array) -> Array:
        """All types from integrals F_j of a kernel: that of X - S times it is X F_j - sum_l shift_jl F_l."""
        plain = np.zeros_like(sign)
        plain[:, 0] = total
        parts = []
        for kernel in (sign, log, plain):
            first = X[:, None] * kernel - kernel @ shift.T
            parts += [kernel, first, X[:, None] * first - first @ shift.T]
        return np.array(parts)


def weights(tails: Array, friction: float, carried: Array, half_lengths: Array) -> Array:
    """Shares of the types in du/dx of (y, phi, psi, x); (half, 4, type)."""
    shear = friction * carried[0]
    odd = np.concatenate([tails[:, 1:, 1:] @ carried, tails[:, :1, 0] * shear], 1)
    even = np.concatenate([tails[:, 1:, 0] * shear, -(tails[:, 1:, 0] @ carried)[:, None]], 1)
    h = half_lengths[:, None]
    logarithm = np.log(h)
    out = np.empty((half_lengths.size, 4, 9))
    out[..., SIGN] = -odd[0] / 2
    out[..., SIGN + 1] = h * even[1] / 2
    out[..., SIGN + 2] = h**2 * odd[2] / 4
    out[..., LOG] = even[0] / np.pi + 0 * h
    out[..., LOG + 1] = h * odd[1] / np.pi
    out[..., LOG + 2] = -(h**2) * even[2] / (2 * np.pi)
    out[..., PLAIN:] = logarithm[..., None] * out[..., LOG:PLAIN]
    return out * h[..., None]


def _multiplication(count: int, a: float, b: float) -> Array:
    """S P_j = sum_l shift_jl P_l^(a,b); (count, count), the last row cut."""
    shift = np.zeros((count, count))
    shift[0, :2] = 1 - 2 * (a + 1) / (a + b + 2), 2 / (a + b + 2)
    for j in range(1, count):
        t = 2 * j + a + b
        above = 2 * (j + 1) * (j + a + b + 1) * t
        slope, bias = t * (t + 1) * (t + 2) / above, (t + 1) * (a * a - b * b) / above
        shift[j, j - 1], shift[j, j] = 2 * (j + a) * (j + b) * (t + 2) / above / slope, -bias / slope
        if j + 1 < count:
            shift[j, j + 1] = 1 / slope
    return shift


EDGES = np.array([1.0, -1.0])

_FAR = 300.0  # k h at which the means of a graded layer end: they decay like (k h)^-5


@dataclass(frozen=True, eq=False)
class Assembly:
    """Integrals of kernels against the basis of one system at half-lengths of like size."""

    system: System
    basis: Basis
    half_lengths: Array
    points: Array = field(default_factory=lambda: EDGES)

    @cached_property
    def unknowns(self) -> Array:
        """Unknowns for every cause; (half, unknown, cause)."""
        rough = None if self._rough is None else (self._rough[0], self._rough[1][:, :, : self.basis.terms])
        return self.system.solve(self.basis, self.at_nodes, rough)

    @property
    def at_nodes(self) -> Array:
        """du/dx of (y, phi, psi) at the collocation nodes, by the smooth kernels; (half, 3, M, unknown)."""
        return self._integrals[0][:, :3, : self.basis.terms]

    @property
    def gradients(self) -> Array:
        """du/dx of (y, phi, psi, x) at the points; (half, 4, point, unknown)."""
        at_points = self._integrals[0][:, :, self.basis.terms :]
        return at_points if self._rough is None else at_points + self._rough[2]

    @property
    def beyond(self) -> tuple[Array, Array] | None:
        """Terms beyond M by the equations, at X = 1 and -1; None if the top layer is homogeneous.

        Sums of c_n T_n for n > M, (half, field, 2, unknown), and of the right sides s_j of (eta kap + lam H), (half,
        2, unknown): near an edge rough kernels leave terms that fall slowly.
        """
        if self._rough is None:
            return None
        system, M = self.system, self.basis.terms
        series = system.eliminated(self._rough[1])[1]
        signs = np.stack([np.ones(M), (-1.0) ** np.arange(1, M + 1)])
        rows = system.eliminated(self._rough[0])[0], system.eliminated(self._rough[2][:, :3])[0]
        return signs @ series[:, :, :M] - series[:, :, M:], rows[1] - self.basis.dual(EDGES, M).T @ rows[0]

    @property
    def displacements(self) -> Array:
        """Means of u / h of (y, phi, psi) with weight (1 - X^2)^(3/2); (half, 3, unknown)."""
        graded = self.system.kernel.graded
        return self._integrals[1] if graded is None else self._means(graded)

    @cached_property
    def _integrals(self) -> tuple[Array, Array]:
        points = np.concatenate([self.basis.nodes, self.points])
        size = self.half_lengths.size
        gradients = np.zeros((size, 4, points.size, self.system.unknowns(self.basis)))
        displacements = np.zeros((size, 3, self.system.unknowns(self.basis)))
        for columns, nodes, rule, carried in self.sources():
            distances = self.half_lengths[:, None, None] * (points[:, None] - nodes)
            kernels = self.system.kernel.at(distances, mixing(self.system.coefficients.friction, carried))
            # (half, 4, point, node), contiguous: matrices that are not are multiplied without BLAS
            slopes = np.ascontiguousarray(np.moveaxis(kernels[..., :4], -1, 1))
            gradients[..., columns] = self.half_lengths[:, None, None, None] * (slopes @ rule)
            mean = np.tensordot(self.basis.mean, kernels[:, : self.basis.terms, :, 4:], (0, 1))
            displacements[..., columns] = np.swapaxes(mean, 1, 2) @ rule
        return gradients, displacements

    @cached_property
    def _rough(self) -> tuple[Array, Array, Array] | None:
        """Integrals of the rough kernels with each unknown: projected onto P^(-A,-B), onto U, and at the points."""
        graded, h, system = self.system.kernel.graded, self.half_lengths, self.system
        if graded is None:
            return None
        rough = Rough(self.basis)
        at_points = rough.at(self.points)
        size = (h.size, 4, self.basis.terms, system.unknowns(self.basis))
        summed = (*size[:2], self.basis.terms + 2, size[3])
        out = np.zeros(size), np.zeros(summed), np.zeros((*size[:2], self.points.size, size[3]))
        for columns, _, _, carried in self.sources():
            share = weights(graded.tails, system.coefficients.friction, carried, h)
            which = 0 if columns.start == 0 else 1
            for whole, integrals in zip(out, (*rough.projected[which], at_points[which]), strict=True):
                whole[..., columns] = np.tensordot(share, integrals, 1)
        return out[0][:, :3], out[1][:, :3], out[2]

    def _means(self, graded: GradedResponse) -> Array:
        """Displacements under a graded layer in Fourier space (films, section 5); (half, 3, unknown)."""
        system, width = self.system, self.system.kernel.width
        stack, friction = system.kernel.stack, system.coefficients.friction
        regular = (surface(stack) - lowest(stack))[1:, 1:]
        out = np.zeros((self.half_lengths.size, 3, system.unknowns(self.basis)))
        fine = replace(self.basis, samples=max(self.basis.samples, self.basis.terms + int(_FAR / 2) + 20))
        sources = replace(self, basis=fine).sources()
        for number, h in enumerate(self.half_lengths):
            k, weight = wavenumbers(stack, 2 * h, 34 * h / _FAR)
            difference = (weight / k)[:, None, None] * graded.difference(k)
            averaged = difference * (8 * jv(2, k * h) / (k * h) ** 2)[:, None, None]
            datum = float(weight / k @ np.exp(-k * width)) + float(exp1(_FAR / h * width))
            for columns, nodes, rule, carried in sources:
                phase = k[:, None] * h * nodes
                mean = np.einsum("koj,j,kz->oz", averaged[:, 1:, 1:], carried, np.cos(phase) @ rule)
                mean += friction * carried[0] * np.einsum("ko,kz->oz", averaged[:, 1:, 0], np.sin(phase) @ rule)
                mean += datum * (regular @ carried)[:, None] * rule.sum(0)
                out[number][:, columns] = mean / np.pi
        return out

    def sources(self) -> list[tuple[slice, Array, Array, Array]]:
        """Unknowns, quadrature nodes, rule and (sigma_yy, D_y, B_y) carried, of the pressure and of each field."""
        basis, c = self.basis, self.system.coefficients
        carried = np.concatenate([[1.0], c.follower * [f in c.fields for f in (0, 1)]])
        rules = [(slice(0, basis.pressures), *basis.pressure_rule, carried)]
        for f, start in self.system.starts(basis).items():
            rules.append((slice(start, start + basis.terms + 1), *basis.charge_rule, np.eye(3)[1 + f]))
        return rules


def mixing(friction: float, carried: Array) -> Array:
    """Matrix from the kernel's channels to du/dx of (y, phi, psi, x), then u of (y, phi, psi); (19, 7)."""
    matrix = np.zeros((19, 7))
    shear = friction * carried[0]
    for o in range(3):
        for source in range(3):
            matrix[CHANNEL[o, source], o] += carried[source]
            matrix[POTENTIAL[o, source], 4 + o] += carried[source]
        matrix[SHEAR[o], o] += shear
        matrix[POTENTIAL_SHEAR[o], 4 + o] += shear
        matrix[SHEAR[o], 3] -= carried[o]
    matrix[TANGENTIAL, 3] += shear
    return matrix
