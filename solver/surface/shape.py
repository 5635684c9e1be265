"""Shapes of punches: height of the undeformed punch above its lowest point."""

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike
from scipy.ndimage import map_coordinates, spline_filter
from typing_extensions import override

from solver.arrays import Array, is_finite
from solver.surface.response import SurfaceError

_SAMPLES = 8  # a side of a cell that the end of a punch cuts
_LEAST_POINTS = 4  # a side of a height map: those of a cubic spline
_MOST_POINTS = 4096  # a side of a height map: 134 MB
_WAVES = 400  # of a rough surface: the root mean square of its heights in a contact then scatters as that of a real one
_HURST = 0.8  # of polished and ground surfaces
_SMOOTH = 1e4  # height over the roughness beyond which waves change no charge: by 1e-8, its inverse square


@dataclass(frozen=True, eq=False)
class Shape:
    """A punch above its lowest point."""

    #: Bound that each parameter exceeds.
    exceeds: ClassVar[Mapping[str, float]] = {}

    def __post_init__(self) -> None:
        for name, least in self.exceeds.items():
            value = getattr(self, name)
            may_be_infinite = getattr(type(self), name, 0.0) == np.inf  # by default
            if not ((is_finite(value) or (may_be_infinite and value == np.inf)) and value > least):
                raise SurfaceError(f"{name}: {value!r} is not allowed; a finite number > {least:g}")

    @abstractmethod
    def gap(self, x: Array, y: Array) -> Array:
        """Height at positions [m]; infinite beside a punch that ends; broadcasts."""

    @property
    def half_extent(self) -> tuple[float, float]:
        """Largest |x| and |y| of the punch [m]."""
        return np.inf, np.inf

    @property
    def lowest(self) -> tuple[float, float]:
        """Position of the lowest point [m]."""
        return 0.0, 0.0

    def on_cells(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Height at the middle of the covered part of cells [m], and the share that is covered; (x, y) each.

        x, y: (x,) and (y,), equally spaced middles [m].
        """
        height = np.asarray(self.gap(x[:, None], y))
        cover = np.isfinite(height).astype(float)
        near = np.pad(cover, 1, mode="edge")
        n, m = cover.shape
        parts = [near[1 + i : 1 + i + n, 1 + j : 1 + j + m] for i in (-1, 0, 1) for j in (-1, 0, 1)]
        rows, columns = np.nonzero(np.ptp(parts, axis=0) > 0)
        if rows.size:
            samples = (np.arange(_SAMPLES) + 0.5) / _SAMPLES - 0.5
            fine_x = x[rows][:, None, None] + (samples * (x[1] - x[0]))[:, None]
            fine_y = y[columns][:, None, None] + samples * (y[1] - y[0])
            heights = self.gap(*np.broadcast_arrays(fine_x, fine_y))
            inside = np.isfinite(heights)
            share = np.mean(inside, axis=(1, 2))
            cover[rows, columns] = share
            total = np.sum(np.where(inside, heights, 0.0), axis=(1, 2))
            with np.errstate(divide="ignore", invalid="ignore"):
                mean = np.where(share > 0, total / (share * _SAMPLES**2), np.inf)
            height[rows, columns] = mean
        return height, cover


@dataclass(frozen=True, eq=False)
class Ellipsoid(Shape):
    """Paraboloid of two radii of curvature."""

    radius_x: float  # [m]
    radius_y: float  # [m]
    exceeds: ClassVar[Mapping[str, float]] = {"radius_x": 0.0, "radius_y": 0.0}

    @override
    def gap(self, x: Array, y: Array) -> Array:
        return np.asarray(x**2 / (2 * self.radius_x) + y**2 / (2 * self.radius_y))


def sphere(radius: float) -> Ellipsoid:
    """Return the paraboloid of a sphere."""
    return Ellipsoid(radius, radius)


@dataclass(frozen=True, eq=False)
class RoughSphere(Shape):
    """Sphere with random waves of all directions, whose amplitude rises as their wavelength to the power 0.8.

    The heights are those of a self-affine surface of Hurst exponent 0.8, as of most polished surfaces (B.N.J.
    Persson, Tribol. Lett. 54 (2014) 99). They are a sum of waves, so that no grid cuts them off.
    """

    radius: float  # [m]
    roughness: float  # Root mean square of the waves' heights [m]
    longest_wavelength: float  # [m]
    shortest_wavelength: float  # [m]
    realisation: float = 0  # Whole number of the random surface
    exceeds: ClassVar[Mapping[str, float]] = dict.fromkeys(
        ("radius", "roughness", "longest_wavelength", "shortest_wavelength"), 0.0
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.realisation != int(self.realisation) or self.realisation < 0:
            raise SurfaceError(f"realisation: {self.realisation:g} is not allowed; a whole number >= 0")
        if not self.shortest_wavelength <= self.longest_wavelength:
            raise SurfaceError(
                f"shortest_wavelength: {self.shortest_wavelength:g} m is not allowed; at most the longest, "
                f"{self.longest_wavelength:g} m"
            )

    @cached_property
    def _waves(self) -> tuple[Array, Array, Array]:
        """Wavenumbers along x and y [1/m] and complex amplitudes [m]; (wave,) each."""
        random = np.random.default_rng([_WAVES, int(self.realisation)])
        share, direction, phase = random.random((3, _WAVES))
        length = self.longest_wavelength * (self.shortest_wavelength / self.longest_wavelength) ** share
        amplitude = length**_HURST
        amplitude *= self.roughness / np.sqrt(np.sum(amplitude**2) / 2)
        k = 2 * np.pi / length * np.exp(2j * np.pi * direction)
        return k.real, k.imag, amplitude * np.exp(2j * np.pi * phase)

    @override
    def gap(self, x: Array, y: Array) -> Array:
        along, across, amplitude = self._waves
        x, y = np.asarray(x), np.asarray(y)
        heights = np.asarray((np.square(x) + np.square(y)) / (2 * self.radius))
        reach = np.sqrt(2 * self.radius * _SMOOTH * self.roughness)
        if x.ndim == 2 and x.shape[1] == 1 and y.ndim == 1:  # a grid, of products
            near_x, near_y = np.abs(x[:, 0]) < reach, np.abs(y) < reach
            waves_x = amplitude * np.exp(1j * along * x[near_x])
            waves_y = np.exp(1j * np.outer(across, y[near_y]))
            heights[np.ix_(near_x, near_y)] += waves_x.real @ waves_y.real - waves_x.imag @ waves_y.imag
            return heights
        near = np.hypot(x, y) < reach
        x, y = (np.broadcast_to(v, near.shape)[near, None] for v in (x, y))
        heights[near] += np.sum(amplitude * np.exp(1j * (along * x + across * y)), axis=-1).real
        return heights


@dataclass(frozen=True, eq=False)
class Cone(Shape):
    """Cone."""

    slope: float  # Rise over distance [1]
    exceeds: ClassVar[Mapping[str, float]] = {"slope": 0.0}

    @override
    def gap(self, x: Array, y: Array) -> Array:
        return np.asarray(self.slope * np.hypot(x, y))


@dataclass(frozen=True, eq=False)
class Disc(Shape):
    """Flat circular punch."""

    radius: float  # [m]
    exceeds: ClassVar[Mapping[str, float]] = {"radius": 0.0}

    @override
    def gap(self, x: Array, y: Array) -> Array:
        return np.where(np.hypot(x, y) <= self.radius, 0.0, np.inf)

    @property
    @override
    def half_extent(self) -> tuple[float, float]:
        return self.radius, self.radius


@dataclass(frozen=True, eq=False)
class Roller(Shape):
    """Roller along y of finite length, with a crown and a tilt."""

    radius: float  # [m]
    length: float  # [m]
    crown_radius: float = np.inf  # Radius of curvature along the axis [m]
    tilt: float = 0.0  # Slope of the axis [rad]
    exceeds: ClassVar[Mapping[str, float]] = {"radius": 0.0, "length": 0.0, "crown_radius": 0.0, "tilt": -1.0}

    @override
    def gap(self, x: Array, y: Array) -> Array:
        height = x**2 / (2 * self.radius) + self._axis(y) - self._axis(self.lowest[1])
        return np.where(np.abs(y) <= self.length / 2, height, np.inf)

    def _axis(self, y: ArrayLike) -> Array:
        y = np.asarray(y, np.float64)
        return y**2 / (2 * self.crown_radius) + self.tilt * y

    @property
    @override
    def lowest(self) -> tuple[float, float]:
        turning = -self.tilt * self.crown_radius if self.tilt else 0.0
        return 0.0, float(np.clip(turning, -self.length / 2, self.length / 2))

    @property
    @override
    def half_extent(self) -> tuple[float, float]:
        return np.inf, self.length / 2


@dataclass(frozen=True, eq=False)
class Map(Shape):
    """Height map, with a cubic spline between its points."""

    heights: Array  # (x, y) [m]
    spacing: tuple[float, float]  # Between points along x and y [m]

    def __post_init__(self) -> None:
        heights = np.asarray(self.heights, dtype=np.float64)
        if heights.ndim != 2 or min(heights.shape) < _LEAST_POINTS or max(heights.shape) > _MOST_POINTS:
            raise SurfaceError(
                f"height_map: shape {heights.shape} is not allowed; {_LEAST_POINTS} to {_MOST_POINTS} points a side"
            )
        if not np.all(np.isfinite(heights)):
            raise SurfaceError(f"height_map: not a finite number [m] at {np.sum(~np.isfinite(heights))} of its points")
        spacing = np.broadcast_to(np.asarray(self.spacing, dtype=np.float64), 2)
        if not (np.all(np.isfinite(spacing)) and np.all(spacing > 0)):
            raise SurfaceError(f"map_spacing: {self.spacing!r} is not allowed; finite numbers > 0 [m]")
        object.__setattr__(self, "heights", heights - np.min(heights))
        object.__setattr__(self, "spacing", (float(spacing[0]), float(spacing[1])))

    @cached_property
    def _spline(self) -> Array:
        return np.asarray(spline_filter(self.heights, order=3, mode="mirror"))

    @override
    def gap(self, x: Array, y: Array) -> Array:
        x, y = np.broadcast_arrays(x, y)
        (nx, ny), (dx, dy) = self.heights.shape, self.spacing
        places = np.stack([x.ravel() / dx + (nx - 1) / 2, y.ravel() / dy + (ny - 1) / 2])
        heights = map_coordinates(self._spline, places, order=3, mode="mirror", prefilter=False).reshape(x.shape)
        half_x, half_y = self.half_extent
        return np.where((np.abs(x) <= half_x) & (np.abs(y) <= half_y), heights, np.inf)

    @property
    @override
    def half_extent(self) -> tuple[float, float]:
        (nx, ny), (dx, dy) = self.heights.shape, self.spacing
        return nx * dx / 2, ny * dy / 2

    @property
    @override
    def lowest(self) -> tuple[float, float]:
        i, j = np.unravel_index(np.argmin(self.heights), self.heights.shape)
        (nx, ny), (dx, dy) = self.heights.shape, self.spacing
        return float((i - (nx - 1) / 2) * dx), float((j - (ny - 1) / 2) * dy)
