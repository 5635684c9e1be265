"""A sliding sphere on a grid of the surface: unilateral contact to every order of friction, by FFT and an active set.

Uniform tractions on square cells move the surface by Boussinesq's potential of a square, in closed form, and friction
by the integral of x/r^2 over it; what layers add is smooth and taken at the middles. Friction follows the pressure, the
contact follows the gap: nothing is assumed of its shape, and nothing is of first order.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft2, next_fast_len, rfft2
from scipy.interpolate import CubicSpline
from scipy.sparse.linalg import LinearOperator, gmres
from scipy.special import j0, j1

from verification.oracles.film_waves import film, half_space
from verification.oracles.surface_response import STIFFNESS, UNITS, Array

_ACTIVE = 40  # solutions at most
_PLACES = 400  # of the spline of the layers' contribution


@dataclass(frozen=True, eq=False)
class SlidingSphere:
    """A rigid, grounded sphere that conducts the electric field, pressed to a depth and slid."""

    material: Mapping[str, float]
    radius: float
    depth: float
    friction: float
    width: float
    cells: int
    thickness: float = np.inf
    base: Mapping[str, float] | None = None

    @cached_property
    def _half(self) -> tuple[Array, Array]:
        """N over (y, phi) and k, in units of order one."""
        return half_space(self.material)

    @property
    def _size(self) -> float:
        return 2 * self.width / self.cells

    @cached_property
    def places(self) -> tuple[Array, Array]:
        """x and y of the cells' middles [m]; (cells, cells) each."""
        line = (np.arange(self.cells) + 0.5) * self._size - self.width
        x, y = np.meshgrid(line, line, indexing="ij")
        return x, y

    @cached_property
    def _transforms(self) -> tuple[NDArray[Any], NDArray[Any]]:
        """Kernels of (sigma_yy, D_y), (2, 2, ...), and of the friction that follows sigma_yy, (2, ...), transformed."""
        span = np.arange(1 - self.cells, self.cells) * self._size
        x, y = np.meshgrid(span, span, indexing="ij")
        half = self._size / 2

        def cell(whole: Any) -> Array:
            return np.asarray(sum(a * b * whole(x + a * half, y + b * half) for a in (1, -1) for b in (1, -1)))

        potential = cell(lambda x, y: x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))) / (2 * np.pi)
        pulled = cell(lambda x, y: y * np.log(np.hypot(x, y)) + x * np.arctan(y / x) - y) / (2 * np.pi)
        normal, along = (
            factor[..., None, None] * kernel for factor, kernel in zip(self._half, (potential, pulled), strict=True)
        )
        if np.isfinite(self.thickness):
            r = np.hypot(x, y)
            layered, turned = self._layers(r)
            normal, along = normal + layered * self._size**2, along + turned * x / np.maximum(r, half) * self._size**2
        lengths = [next_fast_len(3 * self.cells, real=True)] * 2
        return rfft2(normal, lengths), rfft2(along, lengths)

    def _layers(self, r: Array) -> tuple[Array, Array]:
        """Contribution of the layers per traction at a distance: of 1 and of the cosine; (2, 2, ...) and (2, ...)."""
        places = np.linspace(0, float(np.max(r)) * 1.01, _PLACES)
        k, weights, added = film(self.material, self.thickness, float(places[-1]), self.base)
        added *= weights[:, None, None] / (2 * np.pi)
        spline = CubicSpline(places, np.tensordot(j0(places[:, None] * k), added[..., :2], 1))
        turned = CubicSpline(places, np.tensordot(j1(places[:, None] * k), added[..., 2], 1))
        return np.moveaxis(spline(r), (-2, -1), (0, 1)), np.moveaxis(turned(r), -1, 0)

    def _moved(self, t: Array) -> Array:
        """(u_y, phi) of tractions (2, cells, cells), in units; the same."""
        normal, along = self._transforms
        lengths = [next_fast_len(3 * self.cells, real=True)] * 2
        waved = rfft2(t, lengths)
        level = irfft2(np.einsum("ij...,j...->i...", normal, waved) + self.friction * along * waved[0], lengths)
        inside = slice(self.cells - 1, 2 * self.cells - 1)
        return np.asarray(level[:, inside, inside])

    @cached_property
    def _sharpened(self) -> tuple[Array, Array]:
        """|k| of the grid, and N^-1: nearly the inverse of what tractions move, by which GMRES is sooner done."""
        k = 2 * np.pi * np.hypot(np.fft.fftfreq(2 * self.cells)[:, None], np.fft.rfftfreq(2 * self.cells))
        return np.asarray(k / self._size, dtype=np.float64), np.asarray(np.linalg.inv(self._half[0]), dtype=np.float64)

    def solved(self) -> dict[str, float]:
        """Force [N], charge [C], first moments of both along x [N m, C m] and largest pressure [Pa].

        Without signs of tension; the largest on a parabola through the cells along x of a row beside the middle.
        """
        x, y = self.places
        profile = (x**2 + y**2) / (2 * self.radius)
        wanted = np.stack([(profile - self.depth) / UNITS[1], np.zeros_like(x)])
        inside = profile < self.depth / 2
        seen = {inside.tobytes()}
        t = np.zeros((2, self.cells, self.cells))
        for _ in range(_ACTIVE):
            t = self._under(inside, wanted, t)
            gap = wanted[0] - self._moved(t)[0]
            touching = np.where(inside, t[0] < 0, gap < 0)
            if touching.tobytes() in seen:  # the same, or one of those in which cells of the rim touch by turns
                area = self._size**2
                load, charge = t * (STIFFNESS / UNITS[1:3])[:, None, None] * area
                return {
                    "force": -float(load.sum()), "charge": -float(charge.sum()),
                    "force_moment": -float((x * load).sum()), "charge_moment": -float((x * charge).sum()),
                    "peak_pressure": _crest(-load[:, self.cells // 2]) / area,
                }  # fmt: skip
            inside = touching
            seen.add(inside.tobytes())
        raise RuntimeError("the contact of the grid is not found")

    def _under(self, inside: NDArray[np.bool_], level: Array, start: Array) -> Array:
        """Tractions on a given contact; (2, cells, cells)."""
        k, inverse = self._sharpened
        cells = np.stack([inside, inside])

        def spread(values: Array) -> Array:
            t = np.zeros(cells.shape)
            t[cells] = values
            return t

        def sharpened(values: Array) -> Array:
            waved = rfft2(spread(values), [2 * self.cells] * 2)
            smooth = irfft2(k * waved, [2 * self.cells] * 2)[:, : self.cells, : self.cells]
            return np.asarray(np.einsum("ij,j...->i...", inverse, smooth)[cells])

        count = int(cells.sum())
        applied = LinearOperator((count, count), lambda values: self._moved(spread(values))[cells], dtype=np.float64)
        near = LinearOperator((count, count), sharpened, dtype=np.float64)
        solution, failed = gmres(applied, level[cells], start[cells], rtol=1e-7, M=near, restart=60, maxiter=4)
        if failed:
            raise RuntimeError("the equations of the grid are not solved")
        return spread(solution)


def _crest(values: Array) -> float:
    """Largest of the parabola through the largest of some values and those beside it."""
    best = int(np.clip(np.argmax(values), 1, values.size - 2))
    before, top, after = values[best - 1 : best + 2].tolist()
    return float(top - (after - before) ** 2 / (8 * (before - 2 * top + after)))
