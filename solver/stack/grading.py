"""Films whose material varies continuously with depth (films, section 7).

The response of such a layer decays to that of its surface like powers of k only,

    Y(k) = Y0 + Y1/k + Y2/k^2 + Y3/k^3 + ...,    Y1 G + G^T Y1 = -Y0', ...    (' = d/dy),

from the Riccati equation of Y. Y(k) itself comes from sublayers that crowd at the surface, extrapolated.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import ClassVar

import numpy as np
from numpy.polynomial.chebyshev import chebder, chebval, chebvander
from scipy.special import gammainc

from approximation.chebyshev import coefficients, gauss_points
from approximation.piecewise import Piecewise
from solver.arrays import Array
from solver.material.constants import Material
from solver.stack.electroded import grounded, grounded_tails
from solver.stack.fourier import FLIP, Medium, falling
from solver.stack.layers import Layer, Stack, StackError
from solver.stack.reflection import body_below

_DEPTHS = 28  # Chebyshev points of the depth
_WINDOW = 19.0  # exponent of a wave at the end of the sublayers
_CROWDING = 4.5  # logarithm of the ratio of the last and the first sublayer
_SUBLAYERS = (8, 16, 32, 64, 128)
_TAILS = 4
_PANEL = 24  # Chebyshev points of a panel in k
_SMOOTH = 1e-6  # last coefficients of the depth over the largest: what a smooth profile is below


@dataclass(frozen=True, eq=False, init=False)
class Graded(Layer):
    """A layer whose material is a smooth function of depth over thickness; the top layer of a stack.

    Parameters
    ----------
    profile
        Material at depths over thickness, 0 (surface) to 1; called once with an array of depths.
    thickness, electric, magnetic
        As of :class:`Layer`.

    Examples
    --------
    >>> import solver
    >>> phases = solver.find("BaTiO3"), solver.find("CoFe2O4")
    >>> Graded(lambda depth: solver.fibrous(*phases, 0.2 + 0.6 * depth), 2e-4).thickness
    0.0002

    Raises
    ------
    StackError
        A profile that is not smooth, or as of :class:`Layer`.
    """

    graded: ClassVar[bool] = True
    profile: Callable[[Array], Material] = field(repr=False, kw_only=True)

    def __init__(
        self,
        profile: Callable[[Array], Material],
        thickness: float | str,
        electric: str | None = None,
        magnetic: str | None = None,
    ) -> None:
        object.__setattr__(self, "profile", profile)
        super().__init__(profile(np.zeros(())), thickness, electric, magnetic)
        if magnetic == "insulated":
            raise StackError("interface_magnetic: 'insulated' is not allowed below a graded layer; grounded, bonded")


def staircase(stack: Stack, count: int) -> Stack:
    """The stack with its graded top layer in homogeneous sublayers of the materials at their middles."""
    layer = stack.top
    if not isinstance(layer, Graded):
        raise StackError("layers: the top layer is not graded")
    thickness, last = layer.thickness / count, stack.grounded[0]
    upper = [Layer(layer.profile(np.array((i + 0.5) / count)), thickness, "bonded", "bonded") for i in range(count - 1)]
    electric, magnetic = ("grounded" if component in last else "bonded" for component in (2, 3))
    lowest = Layer(layer.profile(np.array(1 - 0.5 / count)), thickness, electric, magnetic)
    return Stack((*upper, lowest, *stack.layers[1:]), stack.base, stack.speed, stack.electroded, layer.material)


def extrapolated(by_count: Callable[[int], Array], counts: tuple[int, ...]) -> Array:
    """Limit of staircases, in even powers of their steps (Romberg)."""
    table = [by_count(count) for count in counts]
    for order in range(1, len(table)):
        table = [fine + (fine - coarse) / (4**order - 1) for coarse, fine in pairwise(table)]
    return table[0]


@dataclass(frozen=True, eq=False)
class GradedMedium:
    """A graded layer in the units of a stack."""

    layer: Graded
    scale: Array
    speed: float = 0.0

    @cached_property
    def _samples(self) -> tuple[Array, Medium]:
        """Depths [m] and the media there."""
        share = (1 + gauss_points(_DEPTHS)) / 2
        material = self.layer.profile(share)
        material.check()
        return share * self.layer.thickness, Medium(material, self.scale, self.speed)

    @cached_property
    def _constants(self) -> Array:
        """Coefficients of Y0 and G; (coefficient, 2, 4, 4)."""
        _, medium = self._samples
        series = coefficients(np.stack(np.broadcast_arrays(medium.compliance, medium.decay), 1))
        tail, size = (np.max(np.abs(part), axis=(0, 2, 3)) for part in (series[-2:], series))
        if np.any(tail > _SMOOTH * size):
            raise StackError("profile: the material is not a smooth function of depth")
        return series

    def at(self, depth: Array) -> tuple[Array, Array]:
        """Y0 and G at depths [m]; (..., 4, 4) each."""
        polynomials = chebvander(2 * depth / self.layer.thickness - 1, _DEPTHS - 1)
        constants = np.tensordot(polynomials, self._constants, 1)
        return constants[..., 0, :, :], constants[..., 1, :, :]

    @cached_property
    def tails(self) -> Array:
        """Y1 to Y4 at the surface [1/m to 1/m4], the last to 1e-4 of it; (4, 4, 4)."""
        _, medium = self._samples
        G, Q = np.broadcast_arrays(medium.decay, medium.inner)
        operator = np.einsum("ik,nlj->nijkl", np.eye(4), G) + np.einsum("jl,nki->nijkl", np.eye(4), G)
        operator = operator.reshape(-1, 16, 16)

        def solved(right: Array) -> Array:
            return np.asarray(np.linalg.solve(operator, right.reshape(-1, 16, 1)).reshape(-1, 4, 4))

        tails: list[Array] = []
        while len(tails) < _TAILS:
            right = -self._upward(tails[-1] if tails else medium.compliance)
            for early, other in zip(tails, tails[::-1], strict=True):
                right = right - early @ Q @ other
            tails.append(solved(right))
        surface = (-1.0) ** np.arange(_DEPTHS)  # T_n(-1)
        return np.array([np.tensordot(surface, coefficients(Y), 1) for Y in tails])

    def _upward(self, values: Array) -> Array:
        """d/dy at the samples."""
        derived = chebder(coefficients(values)) * (-2 / self.layer.thickness)
        return np.asarray(np.moveaxis(chebval(gauss_points(_DEPTHS), derived), -1, 0))

    def difference(self, k: Array, below: Array) -> Array:
        """Y_top - Y0 of the surface; (k, 4, 4).

        k: (k,), wavenumbers; below: (k, 4, 4), response of the body below.
        """
        Y = extrapolated(lambda count: self._staircase(k, below, count), _SUBLAYERS)
        return Y - self.at(np.zeros(()))[0]

    def _staircase(self, k: Array, below: Array, count: int) -> Array:
        """Y_top by homogeneous sublayers of the materials at their middles; (k, 4, 4)."""
        slowest = float(np.min(self._samples[1].slowest))
        window = np.minimum(self.layer.thickness, _WINDOW / (k * slowest))
        # a wave that reaches the bottom sees the whole layer alike; a short one sees what lies at the surface
        crowding = (_CROWDING * np.minimum(1.0, 2 * k * slowest * self.layer.thickness / _WINDOW) + 1e-3)[:, None]
        ends = np.expm1(crowding * np.arange(count + 1) / count) / np.expm1(crowding)
        Y = np.where((window < self.layer.thickness)[:, None, None], self.at(window)[0], below)
        for i in range(count - 1, -1, -1):
            compliance, G = self.at(window * (ends[:, i] + ends[:, i + 1]) / 2)
            E = falling(G, k * window * (ends[:, i + 1] - ends[:, i]))
            F = (FLIP * E) @ np.linalg.solve(FLIP * compliance + Y, compliance - Y) @ E
            transposed = np.swapaxes(F, -1, -2)
            Y = compliance - (compliance + FLIP * compliance) @ np.swapaxes(
                np.linalg.solve(np.eye(4) + transposed, transposed), -1, -2
            )
        return np.asarray(Y + np.swapaxes(Y, -1, -2)) / 2


@dataclass(frozen=True, eq=False)
class GradedResponse:
    """Delta(k) of a stack with a graded top layer as a punch meets it, tabulated once over wavenumbers."""

    stack: Stack
    ends: Array

    @cached_property
    def _medium(self) -> GradedMedium:
        layer = self.stack.top
        if not isinstance(layer, Graded):
            raise StackError("layers: the top layer is not graded")
        return GradedMedium(layer, self.stack.scale, self.stack.speed)

    @cached_property
    def tails(self) -> Array:
        """Y1 to Y4; (4, 4, 4)."""
        tails = self._medium.tails
        return grounded_tails(self.stack, tails) if self.stack.electroded else tails

    def _solved(self, k: Array) -> Array:
        difference = self._medium.difference(k, body_below(self.stack, k))
        return grounded(self.stack, difference) if self.stack.electroded else difference

    @cached_property
    def _table(self) -> Piecewise:
        """Delta on the panels; (k, 4, 4)."""
        return Piecewise.of(self._solved, self.ends, _PANEL)

    def difference(self, k: Array) -> Array:
        """Delta at wavenumbers; beyond the panels by its tails; (k, 4, 4)."""
        out: Array = np.einsum("jk,jab->kab", k ** -np.arange(1.0, _TAILS + 1)[:, None], self.tails)
        inside = k <= self.ends[-1]
        out[inside] = self._table.at(k[inside])
        return out

    def decayed(self, k: Array, width: float, count: int = 3) -> Array:
        """Delta without the first of its tails times 1 - exp(-bk) sum (bk)^i/i!, like k^-(count + 1); (k, 4, 4).

        k: (k,), wavenumbers [1/m].
        """
        orders = np.arange(1, count + 1)[:, None]
        smoothed: Array = np.asarray(gammainc(orders, width * k) / k**orders, dtype=np.float64)
        return np.asarray(self.difference(k) - np.einsum("jk,jab->kab", smoothed, self.tails[:count]))


def smooth_tails(x: Array, width: float) -> tuple[Array, Array]:
    """Smooth parts of the sine and the cosine transforms of the tails, j = 1, 2, 3; (3, x) each.

    x: (x,), >= 0 [m].
    """
    angle, log = np.arctan(x / width), np.log(x**2 + width**2)
    sines = np.array([-angle, x / 2 * log, width * x / 2 + x**2 / 2 * angle])
    return sines, np.array([log / 2, width + x * angle, width**2 / 4 - x**2 / 4 * log])
