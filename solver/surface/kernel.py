"""Influence of cells of constant traction on the surface of an infinite body, and its products by FFT.

The displacement I at r by a unit traction J is ``H(phi)/r + D(r, phi)``: the half-space of the top, whose harmonics of
the direction have ``int_0^inf J_n(kr) dk = 1/r``, and the layers' smooth contribution. H/r is homogeneous of degree -1,
so that its integral over a cell is one over the cell's edges; it scales with the length of the cell.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import factorial

import numpy as np
import scipy.fft
from scipy.interpolate import BSpline, PPoly, make_interp_spline
from scipy.ndimage import map_coordinates, spline_filter
from scipy.special import j0, j1, jv

from approximation.arrays import Indices
from solver.arrays import Array, BoolArray, ComplexArray
from solver.cache import cached
from solver.stack.wavenumbers import on_panels
from solver.surface.response import NORMAL, PHI, SurfaceBody, SurfaceError

#: Component pairs (displacement, traction) of contacts without friction, and those that friction adds.
NORMAL_PAIRS = ((NORMAL, NORMAL), (NORMAL, PHI), (PHI, PHI))
SLIDING_PAIRS = ((NORMAL, 0), (NORMAL, 1), (PHI, 0), (PHI, 1))
Pairs = tuple[tuple[int, int], ...]

_THREADED = 2**18  # numbers from which an FFT takes two threads
_NEAR = 8  # cells around the loaded one that take the fine rules
_EDGE_NODES, _FAR_EDGE_NODES = 24, 3  # of an edge, in asinh of its position
_ANGLES = 512  # of the table of H
_DECAYED = 36.0  # exponent at the largest wavenumber: e^-36 is below rounding
_SPACING = 0.05  # of the table of D, in asinh(r / (2 decay h))
_WIDEST = 400.0  # largest distance over the thickness of the top layer
_ROUNDING = 1e-13  # share of the largest harmonic of the direction that is rounding
_BLUR, _BLURRED = 0.125, 4.0  # of a cell that is wider than the layers; exp(-(4)^2) is 1e-7
_LEAST = 1e-200  # of a Bessel function that starts a recurrence: smaller ones have few digits
_MARGIN = 12  # rows and columns around the table, for its spline


def workers(shape: tuple[int, ...]) -> int:
    """Threads of an FFT: of a small one they cost more than they save."""
    return 2 if np.prod(shape) >= _THREADED else 1


@cached
def half_space_table(body: SurfaceBody, pairs: Pairs, is_far: bool = False) -> Array:
    """H at equally spaced angles over a full turn, of the top or, seen from afar, of the base; (pair, angle)."""
    count = body.directions
    theta = 2 * np.pi * np.arange(count) / count
    Y = body.multiplier(np.array([0.0]), theta)[0] if is_far else body.response(np.array([np.inf]), theta)[0]
    harmonics = np.fft.fft(np.stack([Y[:, i, j] for i, j in pairs]), axis=1) / count
    n = np.fft.fftfreq(count, 1 / count).astype(int)
    turned = harmonics * _occurs(body, pairs, n) * 1j ** np.abs(n) / (2 * np.pi)
    wide = np.zeros((len(pairs), _ANGLES), np.complex128)
    wide[:, n % _ANGLES] = turned
    return np.asarray(np.fft.ifft(wide, axis=1).real * _ANGLES)


def _occurs(body: SurfaceBody, pairs: Pairs, n: Indices) -> BoolArray:
    """Whether the harmonic n of the direction is no rounding of perturbed roots; (pair, n).

    On a body that is isotropic about z, normal tractions and charges have harmonic 0, tangential tractions 1.
    """
    tangential = np.array([[J < NORMAL] for _, J in pairs])
    return np.asarray((np.abs(n) == tangential) | (not body.isotropic))


@cached
def _half_space_cells(body: SurfaceBody, pairs: Pairs, nx: int, ny: int, aspect: float, is_far: bool = False) -> Array:
    """Integrals of H/r over cells of size (1, aspect) at offsets -n..n; (pair, 2 nx + 1, 2 ny + 1)."""
    table = half_space_table(body, pairs, is_far)
    x, y = np.arange(-nx, nx + 1.0), np.arange(-ny, ny + 1.0) * aspect
    x_edges, y_edges = np.append(x - 0.5, nx + 0.5), np.append(y - aspect / 2, (ny + 0.5) * aspect)
    vertical = _edges(table, x_edges, y_edges, False)
    horizontal = _edges(table, y_edges, x_edges, True).swapaxes(1, 2)
    return np.asarray(np.diff(vertical, axis=1) + np.diff(horizontal, axis=2))


def _edges(table: Array, across: Array, along: Array, swapped: bool) -> Array:
    """Integral of X H/r over edges at the distance X, between neighbours of ``along``; (pair, across, along - 1)."""
    result = np.empty((len(table), across.size, along.size - 1))
    middle = (across.size // 2, (along.size - 1) // 2)
    constant = np.ptp(table, axis=1) <= 1e-12 * np.max(np.abs(table), axis=1)
    rows = max(1, 2**18 // along.size)
    for first in range(0, across.size, rows):
        part = slice(first, first + rows)
        X = across[part, None]
        result[:, part] = _edge_integrals(table, constant, X, along[:-1], along[1:], _FAR_EDGE_NODES, swapped)
    near = [slice(max(m - _NEAR, 0), m + _NEAR + 1) for m in middle]
    ends = along[near[1].start : near[1].stop + 1]
    result[:, near[0], near[1]] = _edge_integrals(
        table, constant, across[near[0], None], ends[:-1], ends[1:], _EDGE_NODES, swapped
    )
    return result


def _polynomials(spline: BSpline) -> PPoly:
    """Polynomials between the knots of a quintic spline, which are read several times as fast."""
    knots = np.unique(spline.t[5:-5])
    return PPoly([spline(knots[:-1], m) / factorial(m) for m in range(5, -1, -1)], knots, spline.extrapolate)


def _edge_integrals(
    table: Array, constant: BoolArray, X: Array, start: Array, end: Array, count: int, swapped: bool
) -> Array:
    """Gauss rule in s of Y = X sinh s; (pair, X, edge)."""
    low, high = np.arcsinh(start / np.abs(X)), np.arcsinh(end / np.abs(X))
    half, middle = (high - low) / 2, (high + low) / 2
    result = np.zeros((len(table), *half.shape))
    result[constant] = table[constant, 0, None, None] * 2 * half
    varying = np.flatnonzero(~constant)
    if varying.size:
        angles = 2 * np.pi * np.arange(_ANGLES + 1) / _ANGLES
        turn = np.concatenate([table[varying], table[varying, :1]], axis=1).T
        by_angle = _polynomials(make_interp_spline(angles, turn, 5, bc_type="periodic"))
        nodes, weights = np.polynomial.legendre.leggauss(count)
        for node, weight in zip(nodes, weights, strict=True):
            y, x = np.abs(X) * np.sinh(middle + half * node), np.broadcast_to(X, half.shape)
            values = by_angle(np.arctan2(x, y) if swapped else np.arctan2(y, x))
            result[varying] += weight * half * np.moveaxis(values, -1, 0)
    return np.asarray(X * result)


@dataclass(frozen=True, eq=False)
class _LayerTable:
    """D over asinh(r / width) and the angle."""

    width: float  # [m]
    radial: PPoly | None = None  # Of all pairs over asinh(r / width), where D does not depend on the angle
    values: Array | None = None  # Coefficients of splines, with margins; (pair, r, angle)
    angles: int = 0  # Number of angles over a full turn

    def at(self, x: Array, y: Array) -> Array:
        """D on a grid that is symmetric about its middle [m]; (pair, x, y)."""
        if self.radial is not None:
            (right, of_x), (upper, of_y) = _mirrored(x), _mirrored(y)
            quarter = self.radial(np.arcsinh(np.hypot(right[:, None], upper) / self.width))
            return np.moveaxis(quarter, -1, 0)[:, of_x[:, None], of_y]
        assert self.values is not None
        result = np.empty((len(self.values), x.size, y.size))
        rows = max(1, 2**18 // y.size)  # bounds the memory
        for first in range(0, x.size, rows):
            part = slice(first, first + rows)
            r, angle = np.hypot(x[part, None], y), np.arctan2(y, x[part, None])
            places = np.stack([
                np.arcsinh(r / self.width) / _SPACING + _MARGIN,
                (angle % (2 * np.pi)) * (self.angles / (2 * np.pi)) + _MARGIN,
            ])  # fmt: skip
            for number, v in enumerate(self.values):
                result[number, part] = map_coordinates(v, places, order=5, mode="mirror", prefilter=False)
        return result


def _mirrored(values: Array) -> tuple[Array, Indices]:
    """Positive half of values that are symmetric about 0, and the place in it of each value's size."""
    places = np.arange(values.size)
    return values[values.size // 2 :], np.maximum(places - values.size // 2, (values.size - 1) // 2 - places)


@cached
def _layer_table(body: SurfaceBody, pairs: Pairs, reach: float, blur: float) -> _LayerTable:
    """Table of D up to the distance ``reach`` [m]; with a blur [m], of what layers add to the base seen from afar."""
    thickness, count = body.thickness, body.directions
    width = 2 * body.decay * thickness
    end = _DECAYED / width
    k, weights = _wavenumbers(body, reach, min(end, _BLURRED / blur) if blur else end)
    weights = weights * np.exp(-((k * blur) ** 2))
    half = count // 2
    theta = 2 * np.pi * np.arange(half) / count
    added = np.empty((len(pairs), k.size, count), np.complex128)
    for first in range(0, k.size, 200):  # bounds the memory
        part = slice(first, first + 200)
        Y = (
            body.multiplier(k[part], theta) - body.multiplier(np.zeros(1), theta)
            if blur
            else body.response(k[part], theta)[1]
        )
        for number, (i, j) in enumerate(pairs):
            added[number, part, :half], added[number, part, half:] = Y[:, :, i, j], np.conj(Y[:, :, i, j])
    n = np.fft.fftfreq(count, 1 / count).astype(int)
    harmonics = np.fft.fft(added, axis=-1) * _occurs(body, pairs, n)[:, None] * weights[:, None] / count
    last = int(np.arcsinh(reach / width) / _SPACING) + 2 + _MARGIN
    r = width * np.sinh(_SPACING * np.arange(last + 1))
    radial = np.zeros((len(pairs), r.size, count), np.complex128)
    size = np.max(np.abs(harmonics[..., : count // 2]), axis=(0, 1))
    highest = int(np.max(np.flatnonzero(size > _ROUNDING * np.max(size)), initial=0))
    for order, bessel in _bessel(highest, np.outer(r, k)):
        for place in {order, -order % count}:
            by_pair = harmonics[:, :, place].T  # complex: twice as fast part by part
            sums = bessel @ np.ascontiguousarray(by_pair.real) + 1j * (bessel @ np.ascontiguousarray(by_pair.imag))
            radial[:, :, place] = sums.T * 1j**order / (2 * np.pi)
    if highest == 0:
        values = radial[:, :, 0].real
        values = np.concatenate([values[:, _MARGIN:0:-1], values], axis=1)
        places = _SPACING * np.arange(-_MARGIN, last + 1)
        return _LayerTable(width, _polynomials(make_interp_spline(places, values.T, 5)))
    angles = max(2 * count, 16)
    wide = np.zeros((len(pairs), r.size, angles), np.complex128)
    wide[:, :, n % angles] = radial
    values = np.fft.ifft(wide, axis=-1).real * angles
    # a negative distance is the opposite angle
    mirrored = np.roll(values[:, _MARGIN:0:-1], angles // 2, axis=-1)
    values = np.concatenate([mirrored, values], axis=1)
    values = np.concatenate([values[..., -_MARGIN:], values, values[..., : _MARGIN + 1]], axis=-1)
    splines = np.stack([spline_filter(v, order=5, mode="mirror") for v in values])
    return _LayerTable(width, values=splines, angles=angles)


def _wavenumbers(body: SurfaceBody, reach: float, end: float) -> tuple[Array, Array]:
    """Nodes and weights in k up to an end; panels grow from the smallest structure of the response."""
    total = sum(layer.thickness for layer in body.layers)
    bodies = [np.abs(np.einsum("iJJi->J", E))[: PHI + 1] for E in body.stiffnesses]
    contrast = float(np.min(np.min(bodies, axis=0) / np.max(bodies, axis=0)))
    ends = [0.0, 0.05 * contrast / total]
    while ends[-1] < end:
        ends.append(ends[-1] * 2.0)
    ends[-1] = end
    return on_panels(np.array(ends), np.full(len(ends) - 1, reach))


def _bessel(highest: int, x: Array) -> Iterator[tuple[int, Array]]:
    """J_n(x) for n up to the highest, by the stable recurrence: upwards in n where x is larger, else downwards."""
    is_small = x <= highest + 1
    downward = _bessel_downward(highest, x[is_small])
    inverse = np.where(is_small, 0.0, 2 / np.where(is_small, 1.0, x))
    lower, value = -j1(x), j0(x)
    for n in range(highest + 1):
        value[is_small] = downward[n]
        yield n, value
        lower, value = value, n * inverse * value - lower


def _bessel_downward(highest: int, x: Array) -> Array:
    """J_n(x) for n from 0 to the highest; (n, x)."""
    result = np.empty((highest + 1, x.size))
    upper, result[highest] = jv(highest + 1, x), jv(highest, x)
    inverse = 2 / np.where(x == 0, 1.0, x)
    for n in range(highest, 0, -1):
        result[n - 1] = np.where(x == 0, float(n == 1), n * inverse * result[n] - upper)
        upper = result[n]
    is_lost = (result[highest] < _LEAST) & (x > 0)  # next to underflow, where the start has no digits
    result[:, is_lost] = jv(np.arange(highest + 1)[:, None], x[is_lost])
    return result


def _layer_cells(
    body: SurfaceBody, pairs: Pairs, shape: tuple[int, int], dx: float, dy: float, *, is_level: bool, is_far: bool
) -> Array:
    """Integrals of D over cells at offsets -n..n; (pair, 2 nx + 1, 2 ny + 1) [m2 times D]."""
    nx, ny = shape
    farthest = _farthest(shape, dx, dy) / body.thickness
    if farthest > _WIDEST and not is_far:
        raise SurfaceError(
            f"thickness: {body.thickness:g} m of the top layer is below 1/{_WIDEST:g} of the surface that is solved"
        )
    if is_level and not is_far:
        farthest = _WIDEST  # so that levels share a table
    reach = body.thickness * 2.0 ** max(np.ceil(np.log2(farthest)), -3)
    # of blurs that are powers of two, so that the levels of all windows share tables
    blur = 2.0 ** round(np.log2(_BLUR * min(dx, dy))) if is_far else 0.0
    table = _layer_table(body, pairs, reach, blur)
    x, y = (np.asarray(np.arange(-n - 2, n + 3) * d, np.float64) for n, d in ((nx, dx), (ny, dy)))
    mean = _cell_mean(_cell_mean(table.at(x, y), 1), 2)
    near_x, near_y = min(_NEAR, nx), min(_NEAR, ny)
    count = 4 + min(int(6 * max(dx, dy) / table.width), 28)
    nodes, weights = np.polynomial.legendre.leggauss(count)
    fine_x, fine_y = (
        np.asarray((np.arange(-n, n + 1)[:, None] + nodes / 2).ravel() * d, np.float64)
        for n, d in ((near_x, dx), (near_y, dy))
    )
    values = table.at(fine_x, fine_y).reshape(len(pairs), 2 * near_x + 1, count, 2 * near_y + 1, count)
    near = np.einsum("pxayb,a,b->pxy", values, weights / 2, weights / 2)
    mean[:, nx - near_x : nx + near_x + 1, ny - near_y : ny + near_y + 1] = near
    return np.asarray(mean * dx * dy)


def _farthest(shape: tuple[int, int], dx: float, dy: float) -> float:
    """Largest distance between cells whose influence is tabulated [m]."""
    return float(np.hypot((shape[0] + 3) * dx, (shape[1] + 3) * dy))


def _cell_mean(values: Array, axis: int) -> Array:
    """Means over cells from values at their middles, by central differences to the sixth order; two cells shorter."""
    v = np.moveaxis(values, axis, 0)
    second = v[3:-1] - 2 * v[2:-2] + v[1:-3]
    fourth = v[4:] - 4 * v[3:-1] + 6 * v[2:-2] - 4 * v[1:-3] + v[:-4]
    return np.moveaxis(v[2:-2] + second / 24 - 17 / 5760 * fourth, 0, axis)


@dataclass(frozen=True, eq=False)
class Kernel:
    """Spectra of the influence of cells on a grid, padded so that no image counts."""

    shape: tuple[int, int]  # Cells of the grid
    padded: tuple[int, int]
    spectra: dict[tuple[int, int], Array | ComplexArray]  # By component pair
    circulant: dict[tuple[int, int], Array | ComplexArray]  # Of the nearest periodic operators on the grid itself
    influence: dict[int, float]  # Displacement or potential at the middle of a cell by its unit traction or charge
    local: float  # Potential at the middle of a cell by its unit charge over that at the cells beside

    @cached_property
    def workers(self) -> int:
        """Threads of an FFT."""
        return workers(self.padded)

    def transformed(self, tractions: Array) -> ComplexArray:
        """Spectra of cell tractions; (..., padded x, padded y // 2 + 1)."""
        rows = scipy.fft.rfft(tractions, self.padded[1], axis=-1, workers=self.workers)
        return np.asarray(scipy.fft.fft(rows, self.padded[0], axis=-2, workers=self.workers))

    def back(self, spectra: ComplexArray) -> Array:
        """Values on the grid of spectra; (..., x, y)."""
        nx, ny = self.shape
        rows = scipy.fft.ifft(spectra, axis=-2, workers=self.workers, overwrite_x=True)[..., :nx, :]
        return np.asarray(scipy.fft.irfft(rows, self.padded[1], axis=-1, workers=self.workers)[..., :ny])


@cached
def kernel(
    body: SurfaceBody,
    punch: SurfaceBody | None,
    pairs: Pairs,
    shape: tuple[int, int],
    dx: float,
    dy: float,
    *,
    is_level: bool = False,
) -> Kernel:
    """Kernel of a body, with the compliance of an elastic punch, on a grid of cells (dx, dy) [m].

    is_level: the cells are of a level of the air, which may be far larger than the layers are thick. From there on the
    layers' contribution is blurred over a fraction of a cell.
    """
    nx, ny = shape
    is_far = is_level and bool(_farthest(shape, dx, dy) > _WIDEST * body.thickness)
    aspect = round(dy / dx, 12)
    cells = dx * _half_space_cells(body if is_far else body.half_space, pairs, nx, ny, aspect, is_far)
    if body.layers:
        cells += _layer_cells(body, pairs, shape, dx, dy, is_level=is_level, is_far=is_far)
    if punch is not None:
        elastic: Pairs = tuple(pair for pair in pairs if pair[0] == NORMAL and pair[1] != PHI)
        added = dx * _half_space_cells(punch, elastic, nx, ny, aspect)
        for pair, value in zip(elastic, added, strict=True):  # the punch is the mirror image of a body
            cells[pairs.index(pair)] += value if pair[1] == NORMAL else -value
    if not body.couples:  # without the rounding of perturbed roots
        cells[[(i == PHI) != (J == PHI) for i, J in pairs]] = 0.0
    padded = (scipy.fft.next_fast_len(2 * nx - 1), scipy.fft.next_fast_len(2 * ny - 1, True))
    spectra: dict[tuple[int, int], Array | ComplexArray] = {}
    circulant: dict[tuple[int, int], Array | ComplexArray] = {}
    for pair, value in zip(pairs, cells, strict=True):
        spectra[pair] = _spectrum(_wrapped(value, shape, padded), pair)
        if pair in NORMAL_PAIRS:
            circulant[pair] = _spectrum(_nearest_periodic(value, shape), pair)
    for table in (spectra, circulant):  # displacement I at -r by J is displacement J at r by I
        table[PHI, NORMAL] = np.conj(table[NORMAL, PHI])
    influence = {pair[0]: float(cells[pairs.index(pair)][nx, ny]) for pair in pairs if pair[0] == pair[1]}
    by_charge = cells[pairs.index((PHI, PHI))]
    beside = by_charge[nx + 1, ny] + by_charge[nx, ny + 1]  # the same on the other sides
    return Kernel(shape, padded, spectra, circulant, influence, float(by_charge[nx, ny] - beside / 2))


def _spectrum(cells: Array, pair: tuple[int, int]) -> Array | ComplexArray:
    spectrum = scipy.fft.rfft2(cells, workers=workers(cells.shape))
    return spectrum.real.copy() if pair[0] == pair[1] else spectrum


def _wrapped(cells: Array, shape: tuple[int, int], padded: tuple[int, int]) -> Array:
    """Influence at offsets -(n - 1)..n - 1 in the order of a periodic grid; (padded)."""
    result = np.zeros(padded)
    result[np.ix_(*(np.arange(-(n - 1), n) for n in shape))] = cells[1:-1, 1:-1]
    return result


def _nearest_periodic(cells: Array, shape: tuple[int, int]) -> Array:
    """Cells of the circulant matrix nearest to the influence matrix (T. Chan 1988); (x, y)."""
    values = cells
    for axis, n in enumerate(shape):
        v, share = np.moveaxis(values, axis, 0), np.arange(n)[:, None] / n
        values = np.moveaxis((1 - share) * v[n : 2 * n] + share * v[:n], 0, axis)
    return values
