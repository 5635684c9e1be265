"""Contact of a punch of any shape on one grid: pressure, D_z and contact by a semismooth Newton iteration.

With p = -s_zz and the gap g = f - depth - u_z of a punch of height f, cells in contact have g = 0 and phi = V, and
others p = 0 and phi - V = D_z g / epsilon of the air, or D_z = 0 where the air does not count.
"""

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.fft

from solver.arrays import Array, BoolArray, ComplexArray
from solver.surface.edge import share_in_contact
from solver.surface.kernel import NORMAL_PAIRS, SLIDING_PAIRS, Kernel, kernel, workers
from solver.surface.response import NORMAL, PHI, SurfaceBody, SurfaceError
from solver.surface.shape import Shape

_STEPS = 40  # of Newton's iteration; smooth contacts take 4 to 8
_KRYLOV = 40  # vectors between restarts of GMRES
_RESTARTS = 4  # for tangents; from a poor state a step of Newton's iteration is not worth them
_ENTRIES = 3  # after which a cell stays in contact: its charge pulls, so that neither side is free of error
_LEVELS = 16  # coarser levels of the air around the grid
_GROWTH = 2  # ratio of a level's length to that of the level below
_FEWEST = 4  # cells along a side that does not grow
_SLENDER = 4.0  # largest ratio of the lengths of a cell of a level
_PARTS = 4  # of a coarse cell, a side, of its mean capacitance
_NEGLIGIBLE = 1000.0  # potential across the gap over that by the charges of a level, beyond which charges are alone
_RAYS, _RAY_NODES, _FAR = 64, 40, 1e3  # of the gap's capacitance beyond, to this multiple of its end
_FREE, _NEARLY = 14, 0.05  # steps after which, and residual below which, cells at the edge no longer change sides
_CUT = 0.52  # of the elastance of a cell, times 1/w - 1 for a share w: a disc of 12 cells is then exact to 1e-3
_LEAST_GAP = 1e-15  # m, of undeformed punches: rough ones reach below their mean; its capacitance shorts a cell
_ROUNDING = 0.05  # resistance of the gap over the elastance of a cell, below which the gap counts as closing
_STALLED = 2e-3  # smallest residual of all steps that is accepted where the iteration does not settle
NO_COUPLING = 1e-9  # electric load over the mechanical one, in scaled units, below which it is rounding
_HARDLY_COUPLED = 1e-4  # charge over pressure, in scaled units, below which residuals count as those of this ratio
_FORCING = 0.02  # share of a residual that the linear solution of one step leaves


@dataclass(frozen=True, eq=False)
class Grid:
    """Cells under a punch."""

    x: Array  # Middles [m]; (x,)
    y: Array  # Middles [m]; (y,)
    height: Array  # Of the undeformed punch [m], infinite beside a punch that ends; (x, y)
    cover: Array  # Share of each cell under the punch; (x, y)

    @property
    def shape(self) -> tuple[int, int]:
        """Number of cells along x and y."""
        return self.x.size, self.y.size

    @property
    def size(self) -> tuple[float, float]:
        """Lengths of a cell [m]."""
        return float(self.x[1] - self.x[0]), float(self.y[1] - self.y[0])

    @property
    def area(self) -> float:
        """Area of a cell [m2]."""
        return self.size[0] * self.size[1]


@dataclass(frozen=True, eq=False)
class Loading:
    """Two of force, depth, charge and voltage, friction and the medium beside the contact."""

    force: float | None = None  # [N]
    depth: float | None = None  # [m]
    charge: float | None = None  # [C]
    voltage: float = 0.0  # [V], where no charge is prescribed
    friction: float = 0.0  # [1]
    direction: float = 0.0  # Of sliding, from x [rad]
    permittivity: float | None = None  # Of the air [F/m]; None: no charge beside the contact
    end: float = np.inf  # Distance from which the gap's field falls as beside a finite punch [m]


@dataclass(frozen=True, eq=False)
class State:
    """Unknowns of a contact: a pressure and D_z by cell in the units of :class:`System`, depth and potential."""

    pressure: Array  # (cell,)
    charge: Array  # (cell,)
    pressed: BoolArray  # Cells in contact; (cell,)
    depth: float  # [m]
    potential: float  # Scaled voltage [m]


class System:
    """Linear operators of a body on the cells of a grid and, coarser, on those of the air around it.

    Arrays over cells hold those of the grid, then those of each coarser level. Tractions and potentials are scaled to
    lengths: a cell of the grid alone has compliance and elastance 1.
    """

    def __init__(
        self,
        body: SurfaceBody,
        punch: SurfaceBody | None,
        shape: Shape,
        grid: Grid,
        loading: Loading,
        depth: float,
        *,
        levels: int = _LEVELS,
    ) -> None:
        self.grid, self.loading, self.layered = grid, loading, bool(body.layers)
        pairs = NORMAL_PAIRS + (SLIDING_PAIRS if loading.friction else ())
        fine = kernel(body, punch, pairs, grid.shape, *grid.size)
        # displacement by pressure and potential by charge of a cell alone
        self.compliance, self.elastance = fine.influence[NORMAL], -fine.influence[PHI]
        self.per_volt = float(np.sqrt(self.compliance / self.elastance))  # length per volt
        self._mixed = float(np.sqrt(self.compliance * self.elastance))
        self._inverse = self._inverted(fine)
        self._tables = [fine]
        heights, outside, areas, single = [grid.height], [np.ones(grid.shape, dtype=bool)], [1.0], [1.0]
        resistances = [self._per_gap(grid)]
        self._interpolation: list[tuple[Array, Array]] = []
        self._averages: list[_Average] = []
        self._outside = outside
        while loading.permittivity is not None and len(heights) <= levels:
            uncovered = _uncovered(grid, shape)
            grows = _growth(grid, uncovered)
            edges = [np.ravel(heights[-1].take([0, -1], axis)) for axis in uncovered]
            border = np.concatenate([*edges, np.full(1, np.inf)]) * float(np.min(resistances[-1]))
            if np.min(border) > _NEGLIGIBLE * single[-1] * max(grid.shape):
                break
            # all shrink as the cells of the grid do; the first, next to the contact, has cells twice as long
            cells = min(self.grid.shape) if grid is self.grid else min(self.grid.shape) // 2
            coarse = _around(grid, grows, 4 * max(cells // 4, 1))
            table = kernel(body, punch, pairs, coarse.shape, *coarse.size, is_level=True)
            alone = -table.influence[PHI] / self.elastance
            per_gap = self._per_gap(coarse)
            height, average = _averaged(shape, coarse, alone / per_gap)
            self._tables.append(table)
            inside = np.zeros(coarse.shape, dtype=bool)
            inside[*(_middle(n, n // grow) for n, grow in zip(coarse.shape, grows, strict=True))] = True
            self._interpolation.append((_linear(coarse.x, grid.x), _linear(coarse.y, grid.y)))
            heights.append(height)
            outside.append(~inside)
            self._averages.append(average)
            areas.append(coarse.area / self.grid.area)
            single.append(alone)
            resistances.append(per_gap)
            grid = coarse
        self._shapes = [h.shape for h in heights]
        self._ends = np.cumsum([h.size for h in heights])
        sizes = [h.size for h in heights]
        self.area = np.repeat(areas, sizes)  # of each cell over that of a cell of the grid
        self.single = np.repeat(single, sizes)  # scaled potential by the charge of a cell alone
        height = np.concatenate([h.ravel() for h in heights])
        self.finite = np.isfinite(height) & np.concatenate([o.ravel() for o in outside])
        self.height = np.where(self.finite, height, 0.0)
        cut = np.where(self.grid.cover > 0, _CUT * (1 / np.maximum(self.grid.cover, np.finfo(float).tiny) - 1), 0.0)
        self.cut = np.concatenate([cut.ravel(), np.zeros(height.size - cut.size)])  # of cells that the punch's end cuts
        per_gap = np.concatenate([np.ravel(r) for r in resistances])
        self.per_gap = None if loading.permittivity is None else per_gap  # Scaled resistance of the air over its gap
        self.tail = 0.0 if loading.permittivity is None else self._tail(shape, grid, depth)

    def under(self, loading: Loading) -> "System":
        """The system under another force, depth, charge or voltage."""
        system = copy(self)
        system.loading = loading
        return system

    @property
    def fine(self) -> int:
        """Number of cells of the grid."""
        return int(self._ends[0])

    def _per_gap(self, grid: Grid) -> Array:
        weakened = 1 + (grid.x[:, None] ** 2 + grid.y**2) / self.loading.end**2
        return np.asarray(weakened / ((self.loading.permittivity or np.inf) * self.elastance))

    def _tail(self, shape: Shape, grid: Grid, depth: float) -> float:
        """Capacitance of the gap beyond the outermost level [F]; none of a gap without end."""
        if not np.isfinite(self.loading.end) or self.loading.permittivity is None:
            return 0.0
        half = np.array(_lengths(grid)) / 2
        middle = (grid.x[0] + grid.x[-1]) / 2, (grid.y[0] + grid.y[-1]) / 2
        angle = 2 * np.pi * (np.arange(_RAYS) + 0.5) / _RAYS
        start = np.minimum(half[0] / np.abs(np.cos(angle)), half[1] / np.abs(np.sin(angle)))
        low, high = np.log(start), np.log(np.maximum(_FAR * self.loading.end, 2 * start))
        nodes, weights = np.polynomial.legendre.leggauss(_RAY_NODES)
        r = np.exp(low + (high - low) * (nodes[:, None] + 1) / 2)
        x, y = middle[0] + r * np.cos(angle), middle[1] + r * np.sin(angle)
        height = shape.gap(x, y)
        gap = np.maximum(height - depth, height / 2)  # the surface there yields by less than half the gap
        density = r**2 / (gap * (1 + (x**2 + y**2) / self.loading.end**2))
        return float(self.loading.permittivity * np.sum(weights @ density * (high - low) / 2) * 2 * np.pi / _RAYS)

    def _scaled(self, table: Kernel) -> tuple[Array | ComplexArray, ...]:
        s, loading = table.spectra, self.loading
        rows = []
        for row, size in ((NORMAL, self.compliance), (PHI, self._mixed)):
            by_pressure = s[row, NORMAL]
            if loading.friction:
                c, q = loading.friction * np.cos(loading.direction), loading.friction * np.sin(loading.direction)
                by_pressure = by_pressure - c * s[row, 0] - q * s[row, 1]
            rows.append(by_pressure / size)
        return rows[0], -s[NORMAL, PHI] / self._mixed, rows[1], -s[PHI, PHI] / self.elastance

    def _inverted(self, table: Kernel) -> tuple[Array | ComplexArray, ...]:
        c = table.circulant
        zz, pp, zp = c[NORMAL, NORMAL] / self.compliance, -c[PHI, PHI] / self.elastance, c[NORMAL, PHI] / self._mixed
        determinant = zz * pp + np.abs(zp) ** 2
        return pp / determinant, zp / determinant, -np.conj(zp) / determinant, zz / determinant

    @cached_property
    def _groups(self) -> list["_Levels"]:
        """Grid and levels, those of equal shape together."""
        places: dict[tuple[int, int], list[int]] = {}
        for level, shape in enumerate(self._shapes):
            places.setdefault(shape, []).append(level)
        return [_Levels(levels, [self._tables[level] for level in levels], self._scaled) for levels in places.values()]

    def apply(self, pressure: Array, charge: Array) -> tuple[Array, Array]:
        """Depression -u_z of the surface and scaled -phi; (cell,) each."""
        parts = np.split(charge, self._ends[:-1])
        level_charges = [D.reshape(shape) for D, shape in zip(parts, self._shapes, strict=True)]
        P, D = pressure[: self.fine].reshape(self._shapes[0]), level_charges[0]
        inner = [(P, D)]  # of the grid and the levels below, on the cells of each level
        for level, (bx, by) in enumerate(self._interpolation, 1):
            ratio = self.area[self._ends[level - 1]] / self.area[self._ends[level - 1] - 1]
            P, D = bx.T @ P @ by / ratio, bx.T @ D @ by / ratio
            inner.append((P, D))
            D = D + level_charges[level]
        fields: dict[int, Array] = {}  # by tractions below a level and by its own charges; (2, 2, x, y)
        for group in self._groups:
            fields |= group.fields(inner, level_charges)
        results, beyond, charges = [fields[0][0]], [], [level_charges[0]]
        for level, D in enumerate(level_charges[1:], 1):
            # the film's answer to charges at their own place stays with their level, and does not spread to other cells
            local = -self._tables[level].local / self.elastance
            below = np.where(self._outside[level], inner[level][1], 0)
            results.append(fields[level][0] + fields[level][1])
            results[-1][1] -= local * below
            beyond.append(fields[level][1])
            beyond[-1][1] -= local * D
            charges.append(D + np.where(self._outside[level], 0.0, inner[level][1]))
        added: Array | float = 0.0
        for level in range(len(self._interpolation), 0, -1):
            bx, by = self._interpolation[level - 1]
            added = bx @ (beyond[level - 1] + added) @ by.T
            results[level - 1] += added
        for level, average in enumerate(self._averages, 1):
            by_others = results[level][1] - self.single[self._ends[level] - 1] * charges[level]
            results[level][1] += average.change(by_others)
        u, phi = (np.concatenate([result[field].ravel() for result in results]) for field in (0, 1))
        return u, phi

    def precondition(self, first: Array, second: Array) -> tuple[Array, Array]:
        """Approximate inverse of :meth:`apply` on the grid; cells of coarser levels count alone."""
        shape, threads = self._shapes[0], workers(self._shapes[0])
        P, D = (scipy.fft.rfft2(v[: self.fine].reshape(shape), workers=threads) for v in (first, second))
        zz, zp, pz, pp = self._inverse
        a, b = first.copy(), second / self.single
        a[: self.fine] = scipy.fft.irfft2(zz * P + zp * D, shape, workers=threads).ravel()
        b[: self.fine] = scipy.fft.irfft2(pz * P + pp * D, shape, workers=threads).ravel()
        return a, b

    @property
    def force_unit(self) -> float:
        """Force of a unit of scaled pressure in one cell [N]."""
        return self.grid.area / self.compliance

    @property
    def charge_unit(self) -> float:
        """Charge on the punch of a negative unit of scaled charge in one cell [C]."""
        return self.grid.area / (self.elastance * self.per_volt)


class _Levels:
    """Influence of the cells of levels of equal shape, all transformed together."""

    def __init__(
        self, levels: list[int], tables: list[Kernel], scaled: Callable[[Kernel], tuple[Array | ComplexArray, ...]]
    ) -> None:
        self._levels, self._table = levels, tables[0]
        self._spectra = [np.stack(spectra) for spectra in zip(*map(scaled, tables), strict=True)]  # (level, kx, ky)

    def fields(self, inner: Sequence[tuple[Array, Array]], charges: Sequence[Array]) -> dict[int, Array]:
        """Depression and scaled -phi of each level, by tractions below and by its own charges; (2, 2, x, y) each.

        On the grid, which has nothing below, by tractions alone.
        """
        is_grid = self._levels == [0]
        tractions = [[*inner[level], *(() if is_grid else (charges[level],))] for level in self._levels]
        transformed = self._table.transformed(np.array(tractions))
        (zz, zp, pz, pp), (P, D) = self._spectra, transformed[:, :2].swapaxes(0, 1)
        spectra = [zz * P + zp * D, pz * P + pp * D]
        if not is_grid:
            spectra += [zp * transformed[:, 2], pp * transformed[:, 2]]
        values = self._table.back(np.stack(spectra, 1))
        return {level: part.reshape(-1, 2, *part.shape[1:]) for level, part in zip(self._levels, values, strict=True)}


def _lengths(grid: Grid) -> tuple[float, float]:
    """Lengths of a grid [m]."""
    return grid.size[0] * grid.x.size, grid.size[1] * grid.y.size


def _uncovered(grid: Grid, shape: Shape) -> list[int]:
    """Axes along which the punch extends beyond a grid."""
    ends = [
        end - (length / 2 - abs(v[0] + v[-1]) / 2)
        for v, length, end in zip((grid.x, grid.y), _lengths(grid), shape.half_extent, strict=True)
    ]
    return [axis for axis, length in enumerate(_lengths(grid)) if ends[axis] > 1e-9 * length]


def _growth(grid: Grid, uncovered: Sequence[int]) -> tuple[int, int]:
    """Factors by which the next level is longer along x and y; a slender grid grows along its short side only."""
    lengths = _lengths(grid)
    waits = [len(uncovered) == 2 and lengths[axis] >= _GROWTH * lengths[1 - axis] for axis in (0, 1)]
    x, y = (_GROWTH if axis in uncovered and not waits[axis] else 1 for axis in (0, 1))
    return x, y


def _around(grid: Grid, grows: tuple[int, int], cells: int) -> Grid:
    """Coarser level around a grid, longer by the factors along x and y, of ``cells`` along a side that grows."""
    lengths = [length * grow for length, grow in zip(_lengths(grid), grows, strict=True)]
    counts = [cells if grow > 1 else count for grow, count in zip(grows, grid.shape, strict=True)]
    for axis in (0, 1):  # no needlessly slender cells
        while (
            grows[axis] == 1
            and counts[axis] > _FEWEST
            and _SLENDER * lengths[1 - axis] / cells >= 2 * lengths[axis] / counts[axis]
        ):
            counts[axis] //= 2
    x, y = (
        (v[0] + v[-1]) / 2 + (np.arange(count) - (count - 1) / 2) * length / count
        for v, count, length in zip((grid.x, grid.y), counts, lengths, strict=True)
    )
    return Grid(x, y, np.zeros((x.size, y.size)), np.ones((x.size, y.size)))


def _middle(count: int, covered: int) -> slice:
    """Cells in the middle of a line of cells."""
    return slice((count - covered) // 2, (count + covered) // 2)


@dataclass(frozen=True, eq=False)
class _Average:
    """Mean of a potential over the cells of a level, weighted by the charge that it draws there."""

    slopes: tuple[Array, Array]  # weights of central differences along x and y; (x, y) each
    bends: tuple[Array, Array, Array]  # of second differences along x and y, and of the mixed one; (x, y) each

    def change(self, potential: Array) -> Array:
        """Weighted mean over each cell minus the value at its middle; (x, y)."""
        result, v = np.zeros_like(potential), potential
        inner = v[1:-1, 1:-1]
        result[1:-1, 1:-1] = (
            self.slopes[0] * (v[2:, 1:-1] - v[:-2, 1:-1]) / 2
            + self.slopes[1] * (v[1:-1, 2:] - v[1:-1, :-2]) / 2
            + self.bends[0] * (v[2:, 1:-1] + v[:-2, 1:-1] - 2 * inner) / 2
            + self.bends[1] * (v[1:-1, 2:] + v[1:-1, :-2] - 2 * inner) / 2
            + self.bends[2] * (v[2:, 2:] - v[2:, :-2] - v[:-2, 2:] + v[:-2, :-2]) / 4
        )
        return result


def _averaged(shape: Shape, grid: Grid, film: Array) -> tuple[Array, _Average]:
    """Heights of uniform gaps that draw the same charge as the gaps over the cells, (x, y), and the mean potential.

    film: gap of the same elastance as a cell alone [m]; (x, y).
    """
    parts = (np.arange(_PARTS) + 0.5) / _PARTS - 0.5
    x, y = ((v[:, None] + parts * step).ravel() for v, step in zip((grid.x, grid.y), grid.size, strict=True))
    gap = np.maximum(shape.gap(x[:, None], y), _LEAST_GAP).reshape(grid.x.size, _PARTS, grid.y.size, _PARTS)
    drawn = film[:, None, :, None] / (film[:, None, :, None] + gap)  # over the charge of a closed gap
    mean = drawn.mean(axis=(1, 3))
    with np.errstate(divide="ignore", invalid="ignore"):
        height = np.where(mean > 0, film * (1 / mean - 1), np.inf)
        weights = np.where(mean[:, None, :, None] > 0, drawn / mean[:, None, :, None], 0.0) / _PARTS**2
    inner = weights[1:-1, :, 1:-1]
    x_slope, y_slope = np.einsum("iajb,a->ij", inner, parts), np.einsum("iajb,b->ij", inner, parts)
    x_bend, y_bend = np.einsum("iajb,a->ij", inner, parts**2), np.einsum("iajb,b->ij", inner, parts**2)
    mixed = np.einsum("iajb,a,b->ij", inner, parts, parts)
    return height, _Average((x_slope, y_slope), (x_bend, y_bend, mixed))


def _linear(coarse: Array, fine: Array) -> Array:
    """Linear interpolation from coarse to fine middles; (fine, coarse)."""
    place = (fine - coarse[0]) / (coarse[1] - coarse[0])
    low = np.clip(np.floor(place).astype(int), 0, coarse.size - 2)
    matrix = np.zeros((fine.size, coarse.size))
    rows = np.arange(fine.size)
    matrix[rows, low], matrix[rows, low + 1] = 1 - (place - low), place - low
    return matrix


class Linearised:
    """Newton's linear system about a state: rows of the gap, of the potential and of what is prescribed."""

    def __init__(self, system: System, state: State) -> None:
        self.system, self.state = system, state
        self.depression, self.minus_phi = system.apply(state.pressure, state.charge)
        self.gap = np.where(system.finite, system.height - state.depth + self.depression, np.inf)
        pressed = state.pressed
        if system.per_gap is None:
            self.charged = pressed
            self.resistance = np.zeros_like(self.gap)
            self.resistance_rate = np.zeros_like(self.gap)
        else:
            self.charged = system.finite
            air = system.finite & ~pressed
            # smooth where the gap closes, so that Newton's iteration does not alternate between both sides
            g, rounding = np.where(air, self.gap, 0.0), _ROUNDING / system.per_gap
            root = np.hypot(g, rounding)
            self.resistance = np.where(air, (g + root) / 2 * system.per_gap, 0.0)
            self.resistance_rate = np.where(air, state.charge * system.per_gap * (1 + g / root) / 2, 0.0)
        self.resistance = self.resistance + system.cut
        self._row = 1 / (system.single + self.resistance)
        self._row_scale = self._row * np.sqrt(system.area)  # a large cell holds more of the charge
        share = system.single * self._row
        self._weight = np.sqrt(share) * self.charged
        self._alone = np.where(self.charged, (1 - share) * self._row, 0.0)

    @property
    def share(self) -> Array:
        """Share of each cell of the grid that is in contact at zero voltage; (x, y).

        The charge at the edge of a contact with layers opens the gap faster: there cells count as wholes.
        """
        grid, fine = self.system.grid, slice(0, self.system.fine)
        pressed = self.state.pressed[fine].reshape(grid.shape)
        if self.system.layered:
            return np.asarray(pressed * grid.cover)
        return share_in_contact(self.gap[fine].reshape(grid.shape), pressed) * grid.cover

    @property
    def _root(self) -> float:
        """Root of the number of cells in contact."""
        return float(np.sqrt(np.count_nonzero(self.state.pressed)))

    @property
    def loads(self) -> Array:
        """Force [N] and charge of the punch [C]; (2,)."""
        system, state = self.system, self.state
        charge = system.tail * state.potential / system.per_volt - system.area @ state.charge * system.charge_unit
        return np.array([np.sum(state.pressure) * system.force_unit, charge])

    def tangent(self, tolerance: float) -> tuple[Array, float]:
        """Change of force and charge with depth and voltage, (2, 2), and of the charge at a fixed contact [F].

        A contact is fixed while the pressure stays smooth at its edge: its changes there vanish in the mean over the
        edge. A contact that ends with the punch is fixed at a fixed force.
        """
        pressed, system = self.state.pressed, self.system
        covered = (pressed | ~system.finite)[: system.fine].reshape(system.grid.shape)
        padded = np.pad(covered, 1, constant_values=True)
        inner = padded[2:, 1:-1] & padded[:-2, 1:-1] & padded[1:-1, 2:] & padded[1:-1, :-2]
        edge = np.where(pressed, self.state.pressure, 0.0)
        edge[: system.fine][inner.ravel()] = 0.0
        units = np.array([system.force_unit, -system.charge_unit])
        changes = [self.response(border, tolerance) for border in (0, 1)]
        tangent = np.stack([units * [np.sum(P), system.area @ D] for P, D in changes], -1)
        tangent[1, 1] += system.tail / system.per_volt
        opening = np.array([np.sum(edge * pressure) for pressure, _ in changes]) if np.any(edge) else tangent[0]
        fixed = tangent[1, 1] - tangent[1, 0] * opening[1] / opening[0]
        return np.asarray(tangent * [1.0, system.per_volt]), float(fixed * system.per_volt)

    def product(self, pressure: Array, charge: Array) -> tuple[Array, Array]:
        """Rows of the gap and of the potential by changes of the cells' unknowns."""
        first, second = self.system.apply(pressure, charge)
        second = second + self.resistance * charge + self.resistance_rate * first
        return self._rows(first + self.system.cut * pressure, second)

    def _rows(self, first: Array, second: Array) -> tuple[Array, Array]:
        return np.where(self.state.pressed, first, 0.0), np.where(self.charged, second * self._row_scale, 0.0)

    def precondition(self, first: Array, second: Array) -> tuple[Array, Array]:
        """Approximate inverse of :meth:`product`."""
        second = second / self._row_scale
        a, b = self.system.precondition(first, self._weight * second)
        a = a / (1 + self.system.cut)
        return np.where(self.state.pressed, a, 0.0), self._weight * b + self._alone * second

    @cached_property
    def residual(self) -> tuple[Array, Array]:
        """Gap in the contact and error of the potential; (cell,) each."""
        second = self.minus_phi + self.state.potential + self.resistance * self.state.charge
        return self._rows(np.where(self.state.pressed, self.gap + self.system.cut * self.state.pressure, 0.0), second)

    @cached_property
    def borders(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Changes of the rows with the depth and with the scaled voltage."""
        zero = np.zeros_like(self.gap)
        return self._rows(zero - 1, -self.resistance_rate), self._rows(zero, zero + 1)

    @cached_property
    def free(self) -> tuple[bool, bool]:
        """Whether the force and the charge are prescribed, so that depth and voltage are unknown."""
        loading = self.system.loading
        return loading.force is not None, loading.charge is not None

    @cached_property
    def missing(self) -> Array:
        """Prescribed minus present sums of pressure and charge, or 0, over the root of the cells in contact; (2,)."""
        system, loading = self.system, self.system.loading
        force = 0.0 if loading.force is None else loading.force / system.force_unit - np.sum(self.state.pressure)
        charge = 0.0 if loading.charge is None else (self.loads[1] - loading.charge) / system.charge_unit
        return np.array([force, charge]) / self._root

    @property
    def error(self) -> float:
        """Largest of the residuals over depression, over potential by a charge, and of the loads over their sums."""
        state, tiny = self.state, np.finfo(float).tiny
        # the charge of a body that hardly couples need not be exact beside its rounding
        area, least = self.system.area, _HARDLY_COUPLED * float(np.max(np.abs(state.pressure)))
        scales = [
            self._root * float(np.max(np.abs(self.depression))),
            self._root * max(float(np.max(np.abs(state.charge))), least),
            float(np.sum(state.pressure)) / self._root,
            max(float(area @ np.abs(state.charge)), _HARDLY_COUPLED * float(np.sum(state.pressure))) / self._root,
        ]
        sizes = [*(float(np.linalg.norm(rows)) for rows in self.residual), *np.abs(self.missing)]
        return max(float(size / max(scale, tiny)) for size, scale in zip(sizes, scales, strict=True))

    def step(self, tolerance: float) -> tuple[Array, Array, float, float]:
        """Changes of pressure, charge, depth and potential that remove the residual."""
        first, second = self.residual
        right = np.concatenate([-first, -second, self.missing])
        x = self._solved(right, self.free, tolerance, 0)
        P, D = x[:-2].reshape(2, -1)
        return P, D, float(x[-2]), float(x[-1])

    def response(self, border: int, tolerance: float) -> tuple[Array, Array]:
        """Changes of pressure and charge by the depth (0) or the scaled voltage (1), the other held."""
        first, second = self.borders[border]
        right = np.concatenate([-first, -second, np.zeros(2)])
        P, D = self._solved(right, (False, False), tolerance, _RESTARTS)[:-2].reshape(2, -1)
        return P, D

    def _solved(self, right: Array, free: tuple[bool, bool], tolerance: float, restarts: int) -> Array:
        """Solution of the system bordered by depth and voltage, by GMRES."""
        system, size = self.system, self.gap.size
        borders = np.stack([np.concatenate(border) for border in self.borders], -1)
        share = 1 / self._root
        # the charge beyond the outermost level, of which a voltage v has tail / charge_unit
        tail = -system.tail / system.per_volt / system.charge_unit if free[1] else 0.0

        def sums(v: Array) -> Array:
            P, D = v.reshape(2, -1)
            return np.array([np.sum(P) if free[0] else 0.0, system.area @ D if free[1] else 0.0]) * share

        def product(v: Array) -> Array:
            rows = np.concatenate(self.product(*v[:-2].reshape(2, -1))) + borders @ v[-2:]
            loads = np.where(free, sums(v[:-2]), v[-2:])
            loads[1] += tail * share * v[-1]
            return np.concatenate([rows, loads])

        def inverse(v: Array) -> Array:
            return np.concatenate(self.precondition(*v.reshape(2, -1)))

        moved = np.stack([inverse(borders[:, j]) if free[j] else np.zeros(2 * size) for j in (0, 1)], -1)
        schur = np.stack([-sums(moved[:, j]) for j in (0, 1)], -1) + np.diag(1.0 - np.array(free))
        schur[1, 1] += tail * share

        def precondition(v: Array) -> Array:
            x = inverse(v[:-2])
            t = np.linalg.solve(schur, v[-2:] - sums(x))
            return np.concatenate([x - moved @ t, t])

        return gmres(product, precondition, right, tolerance, restarts)


def gmres(
    product: Callable[[Array], Array],
    precondition: Callable[[Array], Array],
    right: Array,
    tolerance: float,
    restarts: int,
) -> Array:
    """Solution x of ``product(x) = right`` to a relative residual, preconditioned from the right, with restarts."""
    x, residual, target = np.zeros_like(right), right, tolerance * float(np.linalg.norm(right))
    for _ in range(restarts + 1):
        norm = float(np.linalg.norm(residual))
        if norm <= target:
            break
        basis, H, left = [residual / norm], np.zeros((_KRYLOV + 1, _KRYLOV)), norm
        weights: Array = np.zeros(0)
        while left > target and len(basis) <= _KRYLOV:
            n = len(basis)
            w = product(precondition(basis[-1]))
            for j, v in enumerate(basis):
                H[j, n - 1] = v @ w
                w -= H[j, n - 1] * v
            H[n, n - 1] = np.linalg.norm(w)
            basis.append(w / max(H[n, n - 1], np.finfo(float).tiny))
            start = np.zeros(n + 1)
            start[0] = norm
            weights = np.asarray(np.linalg.lstsq(H[: n + 1, :n], start)[0], dtype=np.float64)
            left = float(np.linalg.norm(H[: n + 1, :n] @ weights - start))
        combined = np.zeros_like(right)
        for weight, v in zip(weights, basis[:-1], strict=True):
            combined += weight * v
        x = x + precondition(combined)
        if left <= target:
            break
        residual = right - product(x)
    return x


def converged(system: System, state: State, tolerance: float) -> tuple[State, Linearised]:
    """Contact from a start, to a residual over the depth, by Newton's iteration on the cells in contact."""
    cells, fine = system.height.size, system.fine
    coarser = (0, cells - fine)
    pressure, pressed = np.pad(state.pressure[:fine], coarser), np.pad(state.pressed[:fine], coarser)
    charge = state.charge if state.charge.size == cells else np.pad(state.charge[:fine], coarser)
    state = replace(state, pressure=pressure, charge=charge, pressed=pressed)
    if system.loading.depth is not None:
        state = replace(state, depth=system.loading.depth)
    if system.loading.charge is None:
        state = replace(state, potential=system.loading.voltage * system.per_volt)
    entries = np.zeros(cells, dtype=np.int8)
    least, best = _STALLED, None  # where a few cells at the edge open and close for ever
    for step in range(_STEPS):
        linear = Linearised(system, state)
        pressed = np.where(state.pressed, (state.pressure > 0) | (entries >= _ENTRIES), linear.gap < 0)
        if not np.any(pressed):
            pressed = linear.gap <= np.min(linear.gap)
        pressed[fine:] = False
        if step >= _FREE and linear.error < _NEARLY:
            pressed = state.pressed
        settled = np.array_equal(pressed, state.pressed)
        error = linear.error
        if settled and error <= tolerance:
            return state, linear
        if settled and error < least:
            least, best = error, (state, linear)
        if not settled:
            entries += pressed & ~state.pressed
            # without a charge of its own, which may open a gap twice: with and without charge
            charge = np.where(state.pressed & ~pressed, 0.0, state.charge)
            state = replace(state, pressure=np.where(pressed, state.pressure, 0.0), charge=charge, pressed=pressed)
            linear = Linearised(system, state)
        P, D, depth, potential = linear.step(max(_FORCING, 0.3 * tolerance / max(error, tolerance)))
        state = State(
            state.pressure + P, state.charge + D, state.pressed, state.depth + depth, state.potential + potential
        )
    if best is None:
        raise SurfaceError("contact: no state is found for this load and these charges on this grid")
    return best
