"""Contact of a punch of any shape on one grid: pressure, D_z and contact by a semismooth Newton iteration.

With p = -s_zz and the gap g = f - depth - u_z of a punch of height f, cells in contact have g = 0 and phi = V, and
others p = 0 and phi - V = D_z g / epsilon of the air, or D_z = 0 where the air does not count.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.fft

from solver.arrays import Array, BoolArray, ComplexArray
from solver.surface.kernel import NORMAL_PAIRS, SLIDING_PAIRS, WORKERS, Kernel, kernel
from solver.surface.response import NORMAL, PHI, SurfaceBody, SurfaceError

_STEPS = 40  # of Newton's iteration; smooth contacts take 4 to 8
_KRYLOV = 40  # vectors between restarts of GMRES
_RESTARTS = 5
_ENTRIES = 3  # after which a cell stays in contact: its charge pulls, so that neither side is free of error
_FORCING = 0.02  # share of a residual that the linear solution of one step leaves


@dataclass(frozen=True, eq=False)
class Grid:
    """Cells under a punch."""

    x: Array  # Middles [m]; (x,)
    y: Array  # Middles [m]; (y,)
    height: Array  # Of the undeformed punch [m], infinite beside a punch that ends; (x, y)

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

    pressure: Array
    charge: Array
    pressed: BoolArray  # Cells in contact
    depth: float  # [m]
    potential: float  # Scaled voltage [m]


class System:
    """Linear operators of a body on a grid; tractions and potentials are scaled to lengths."""

    def __init__(self, body: SurfaceBody, punch: SurfaceBody | None, grid: Grid, loading: Loading) -> None:
        self.grid, self.loading = grid, loading
        pairs = NORMAL_PAIRS + (SLIDING_PAIRS if loading.friction else ())
        self.kernel = kernel(body, punch, pairs, grid.shape, *grid.size)
        influence = self.kernel.influence
        # displacement by pressure and potential by charge of a cell alone
        self.compliance, self.elastance = influence[NORMAL], -influence[PHI]
        self.per_volt = float(np.sqrt(self.compliance / self.elastance))  # length per volt
        mixed = float(np.sqrt(self.compliance * self.elastance))
        self._operators = self._scaled(self.kernel, mixed)
        self._inverse = self._inverted(self.kernel, mixed)
        x, y = grid.x[:, None], grid.y
        self.finite = np.isfinite(grid.height)
        self.height = np.where(self.finite, grid.height, 0.0)
        self.per_gap: Array | None = None  # Scaled resistance of the air over the gap
        if loading.permittivity is not None:
            weakened = 1 + (x**2 + y**2) / loading.end**2
            self.per_gap = weakened / (loading.permittivity * self.elastance)

    def _scaled(self, kernel: Kernel, mixed: float) -> tuple[Array | ComplexArray, ...]:
        s, loading = kernel.spectra, self.loading
        rows = []
        for row, size in ((NORMAL, self.compliance), (PHI, mixed)):
            by_pressure = s[row, NORMAL]
            if loading.friction:
                c, q = loading.friction * np.cos(loading.direction), loading.friction * np.sin(loading.direction)
                by_pressure = by_pressure - c * s[row, 0] - q * s[row, 1]
            rows.append(by_pressure / size)
        return rows[0], -s[NORMAL, PHI] / mixed, rows[1], -s[PHI, PHI] / self.elastance

    def _inverted(self, kernel: Kernel, mixed: float) -> tuple[Array | ComplexArray, ...]:
        c = kernel.circulant
        zz, pp, zp = c[NORMAL, NORMAL] / self.compliance, -c[PHI, PHI] / self.elastance, c[NORMAL, PHI] / mixed
        determinant = zz * pp + np.abs(zp) ** 2
        return pp / determinant, zp / determinant, -np.conj(zp) / determinant, zz / determinant

    def apply(self, pressure: Array, charge: Array) -> tuple[Array, Array]:
        """Depression -u_z of the surface and scaled -phi; (x, y) each."""
        P, D = self.kernel.transformed(pressure), self.kernel.transformed(charge)
        zz, zp, pz, pp = self._operators
        return self.kernel.back(zz * P + zp * D), self.kernel.back(pz * P + pp * D)

    def precondition(self, first: Array, second: Array) -> tuple[Array, Array]:
        """Approximate inverse of :meth:`apply`."""
        P, D = (scipy.fft.rfft2(v, workers=WORKERS) for v in (first, second))
        zz, zp, pz, pp = self._inverse
        return (
            scipy.fft.irfft2(zz * P + zp * D, self.grid.shape, workers=WORKERS),
            scipy.fft.irfft2(pz * P + pp * D, self.grid.shape, workers=WORKERS),
        )

    @property
    def force_unit(self) -> float:
        """Force of a unit of scaled pressure in one cell [N]."""
        return self.grid.area / self.compliance

    @property
    def charge_unit(self) -> float:
        """Charge on the punch of a negative unit of scaled charge in one cell [C]."""
        return self.grid.area / (self.elastance * self.per_volt)


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
            gap = np.where(air, np.maximum(self.gap, 0.0), 0.0)
            self.resistance = gap * system.per_gap
            self.resistance_rate = np.where(gap > 0, state.charge * system.per_gap, 0.0)
        self._row = 1 / (1 + self.resistance)
        self._weight = np.sqrt(self._row) * self.charged
        self._single = np.where(self.charged, (1 - self._row) * self._row, 0.0)

    @property
    def _root(self) -> float:
        """Root of the number of cells in contact."""
        return float(np.sqrt(np.count_nonzero(self.state.pressed)))

    @property
    def loads(self) -> Array:
        """Force [N] and charge of the punch [C]; (2,)."""
        system, state = self.system, self.state
        return np.array([np.sum(state.pressure) * system.force_unit, -np.sum(state.charge) * system.charge_unit])

    def tangent(self, tolerance: float) -> tuple[Array, float]:
        """Change of force and charge with depth and voltage, (2, 2), and of the charge at a fixed contact [F].

        A contact is fixed while the pressure stays smooth at its edge: its changes there vanish in the mean over the
        edge. A contact that ends with the punch is fixed at a fixed force.
        """
        pressed, system = self.state.pressed, self.system
        padded = np.pad(pressed | ~system.finite, 1, constant_values=True)
        inner = padded[2:, 1:-1] & padded[:-2, 1:-1] & padded[1:-1, 2:] & padded[1:-1, :-2]
        edge = np.where(pressed & ~inner, self.state.pressure, 0.0)
        units = np.array([system.force_unit, -system.charge_unit])
        changes = [self.response(border, tolerance) for border in (0, 1)]
        tangent = np.stack([units * [np.sum(part) for part in change] for change in changes], -1)
        opening = np.array([np.sum(edge * pressure) for pressure, _ in changes]) if np.any(edge) else tangent[0]
        fixed = tangent[1, 1] - tangent[1, 0] * opening[1] / opening[0]
        return np.asarray(tangent * [1.0, system.per_volt]), float(fixed * system.per_volt)

    def product(self, pressure: Array, charge: Array) -> tuple[Array, Array]:
        """Rows of the gap and of the potential by changes of the cells' unknowns."""
        first, second = self.system.apply(pressure, charge)
        return self._rows(first, second + self.resistance * charge + self.resistance_rate * first)

    def _rows(self, first: Array, second: Array) -> tuple[Array, Array]:
        return np.where(self.state.pressed, first, 0.0), np.where(self.charged, second * self._row, 0.0)

    def precondition(self, first: Array, second: Array) -> tuple[Array, Array]:
        """Approximate inverse of :meth:`product`."""
        second = second / self._row
        a, b = self.system.precondition(first, self._weight * second)
        return np.where(self.state.pressed, a, 0.0), self._weight * b + self._single * second

    @cached_property
    def residual(self) -> tuple[Array, Array]:
        """Gap in the contact and error of the potential; (x, y) each."""
        second = self.minus_phi + self.state.potential + self.resistance * self.state.charge
        return self._rows(np.where(self.state.pressed, self.gap, 0.0), second)

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
        count = self._root
        force = 0.0 if loading.force is None else loading.force / system.force_unit - np.sum(self.state.pressure)
        charge = 0.0 if loading.charge is None else -loading.charge / system.charge_unit - np.sum(self.state.charge)
        return np.array([force, charge]) / count

    def step(self, tolerance: float) -> tuple[Array, Array, float, float]:
        """Changes of pressure, charge, depth and potential that remove the residual."""
        right = np.concatenate([-np.stack(self.residual).ravel(), self.missing])
        x = self._solved(right, self.free, tolerance)
        P, D = x[:-2].reshape(2, *self.gap.shape)
        return P, D, float(x[-2]), float(x[-1])

    def response(self, border: int, tolerance: float) -> tuple[Array, Array]:
        """Changes of pressure and charge by the depth (0) or the scaled voltage (1), the other held."""
        right = np.concatenate([-np.stack(self.borders[border]).ravel(), np.zeros(2)])
        P, D = self._solved(right, (False, False), tolerance)[:-2].reshape(2, *self.gap.shape)
        return P, D

    def _solved(self, right: Array, free: tuple[bool, bool], tolerance: float) -> Array:
        """Solution of the system bordered by depth and voltage, by GMRES."""
        shape, size = self.gap.shape, self.gap.size
        borders = np.stack([np.stack(border).ravel() for border in self.borders], -1)
        share = 1 / self._root

        def sums(v: Array) -> Array:
            return np.array([np.sum(v[:size]) if free[0] else 0.0, np.sum(v[size:]) if free[1] else 0.0]) * share

        def product(v: Array) -> Array:
            rows = np.stack(self.product(*v[:-2].reshape(2, *shape))).ravel() + borders @ v[-2:]
            return np.concatenate([rows, np.where(free, sums(v[:-2]), v[-2:])])

        def inverse(v: Array) -> Array:
            return np.stack(self.precondition(*v.reshape(2, *shape))).ravel()

        moved = np.stack([inverse(borders[:, j]) if free[j] else np.zeros(2 * size) for j in (0, 1)], -1)
        schur = np.stack([-sums(moved[:, j]) for j in (0, 1)], -1) + np.diag(1.0 - np.array(free))

        def precondition(v: Array) -> Array:
            x = inverse(v[:-2])
            t = np.linalg.solve(schur, v[-2:] - sums(x))
            return np.concatenate([x - moved @ t, t])

        return gmres(product, precondition, right, tolerance)


def gmres(
    product: Callable[[Array], Array], precondition: Callable[[Array], Array], right: Array, tolerance: float
) -> Array:
    """Solution x of ``product(x) = right`` to a relative residual, preconditioned from the right, with restarts."""
    x, residual, target = np.zeros_like(right), right, tolerance * float(np.linalg.norm(right))
    for _ in range(_RESTARTS):
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
    entries = np.zeros(system.grid.shape, dtype=np.int8)
    for _ in range(_STEPS):
        linear = Linearised(system, state)
        pressed = np.where(state.pressed, (state.pressure > 0) | (entries >= _ENTRIES), linear.gap < 0)
        if not np.any(pressed):
            pressed = linear.gap <= np.min(linear.gap)
        settled = np.array_equal(pressed, state.pressed)
        rows = np.sqrt(np.count_nonzero(state.pressed))
        size = rows * max(float(np.max(np.abs(linear.depression))), np.finfo(float).tiny)
        error = np.linalg.norm(np.concatenate([*(r.ravel() for r in linear.residual), linear.missing])) / size
        if settled and error <= tolerance:
            return state, linear
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
    raise SurfaceError("contact: no state is found for this load and these charges on this grid")
