"""Contact of a punch with a surface in space: window, refinement to an error, and the contact's fields and loads."""

from dataclasses import dataclass, field, replace
from enum import IntEnum
from functools import cached_property
from typing import TypeVar

import numpy as np
from scipy.ndimage import map_coordinates

from solver.arrays import Array, BoolArray
from solver.material.constants import VACUUM_PERMITTIVITY, Material
from solver.surface.newton import NO_COUPLING, Grid, Linearised, Loading, State, System, converged
from solver.surface.response import NORMAL, SurfaceBody, SurfaceError
from solver.surface.shape import Map, RoughSphere, Shape

Field = TypeVar("Field", Array, BoolArray)

_COARSE = 32  # cells a side of the first grid
_FINEST = 1024  # largest number of cells a side
_REFINED = 256  # cells a side where refinement ends, with the error that is reached
_MOST_CELLS = 2**20  # 1 GB of spectra and Krylov vectors
_LEAST_DEPTH = 1e-13  # m, a thousandth of an atom
_RADII, _RADII_TRIED = (1e-13, 2e4), 200  # m, of contacts that are tried for the first window
_FILLED = 0.72  # share of the window's lengths that the contact takes
_LOOSE = 0.45  # share below which the window is narrowed
_WINDOWS = 40  # windows that are tried
_LONGEST = 300.0  # largest ratio of the lengths of a window: a longer contact is that along a line
_SLENDER = 8.0  # largest ratio of the lengths of a cell
_ACCURACY = 1e-2  # residual over the asked error
_TANGENT = 1e-2  # residual of tangents over the asked error
_SECANT = 0.16  # change of the load's logarithm for the stiffness: a twentieth of the contact's width, several cells
# difference between two grids over the error that is left: pressure falls like a root, so that the error of loads falls
# like the cell to the power 3/2; errors of charges, at single cells of the edge and in the air, fall slower, and so do
# those of the pressure on the highest hill of a rough punch or of a map
_SHARE_LEFT = {
    **dict.fromkeys(("force", "depth", "pressure"), 1.8),
    "hill pressure": 1.4,
    **dict.fromkeys(("charge", "voltage", "stroke", "capacitance"), 0.7),
}
_SLOPED, _ROUGH = 64, 1e-2  # cells of slopes over the load, unless an error as large as this is allowed
_FALL = 4.0  # largest ratio of the errors of two grids that is believed: a smaller difference may be luck
# of the charge of a fully coupled body: smaller ones, and their voltages, have errors relative to these. Without charge
# a punch on a cut with little has parts of both signs, which do not cancel to the same digits
_LEAST_COUPLED = {"charge": 0.01, "stroke": 0.01, "voltage": 0.05}
_PER_WAVE = 4  # cells along the shortest wave of a rough punch
_LEAST_SPACINGS = 4  # points of a height map across a contact
_MOST_FRICTION = 2.0


class Slopes(IntEnum):
    """Derivatives of a contact that are solved, each with those above."""

    NONE = 0
    BY_VOLTAGE = 1  # at the load itself
    BY_LOAD = 2  # from two more loads, and of the contact without charge


@dataclass(frozen=True, eq=False)
class SurfaceContact:
    """A contact: fields on a grid of cells, loads and tangents, SI."""

    x: Array  # Middles of the cells [m]; (x,)
    y: Array  # [m]; (y,)
    pressure: Array  # -s_zz [Pa]; (x, y)
    electric_displacement: Array  # D_z [C/m2]; (x, y)
    gap: Array  # Between punch and deformed surface [m]; (x, y)
    weight: Array  # Share of each cell that is in contact; (x, y)
    depth: float  # [m]
    voltage: float  # Potential of the punch [V]
    force: Array  # Of the punch on the body, positive into the body, and friction along x and y [N]; (3,): x, y, normal
    charge: float  # Of the punch [C]
    tangent: Array  # d(force, charge)/d(depth, voltage), NaN without slopes; (2, 2)
    fixed_capacitance: float  # d charge/d voltage at a fixed contact, NaN without slopes [F]
    charge_per_force: float  # At zero voltage, under the same force or depth [C/N]
    errors: dict[str, float] = field(default_factory=dict)  # Relative, estimated from two grids
    reaches_end: bool = False  # Whether a sharp end of the punch limits it, where the pressure is infinite
    permittivity: float | None = None  # Of the air beside the contact [F/m]
    uncharged: "SurfaceContact | None" = None  # Of the same force, without charge

    @property
    def error(self) -> float:
        """Largest estimated relative error of loads, capacitance and finite largest pressure."""
        return max(self.errors.values(), default=np.nan)

    @property
    def cell(self) -> float:
        """Area of a cell [m2]."""
        return float((self.x[1] - self.x[0]) * (self.y[1] - self.y[0]))

    @cached_property
    def moments(self) -> Array:
        """Moments of pressure about x and y, and of friction about z, through the punch's origin [N m]; (3,)."""
        p = self.pressure * self.cell
        along = self.force[:2] / max(self.force[2], np.finfo(float).tiny)
        x, y = self.x[:, None], self.y
        return np.array([-np.sum(p * y), np.sum(p * x), np.sum(p * (x * along[1] - y * along[0]))])

    @property
    def area(self) -> float:
        """Area of the contact [m2]."""
        return float(np.sum(self.weight) * self.cell)

    @property
    def lengths(self) -> tuple[float, float]:
        """Lengths of the contact along x and y [m]."""
        along_x, along_y = np.max(self.weight, axis=1), np.max(self.weight, axis=0)
        return _span(along_x) * float(self.x[1] - self.x[0]), _span(along_y) * float(self.y[1] - self.y[0])

    @property
    def peak_pressure(self) -> float:
        """Largest pressure [Pa]."""
        return float(np.max(self.pressure))


def _span(shares: Array) -> float:
    """Distance between the ends of the covered part of a line of cells, in cells."""
    covered = np.flatnonzero(shares > 0)
    if covered.size == 0:
        return 0.0
    first, last = int(covered[0]), int(covered[-1])
    return last - first - 1 + float(shares[first] + shares[last]) if last > first else float(shares[first])


def solve_contact(
    body: SurfaceBody, shape: Shape, *, force: float | None = None, depth: float | None = None,
    voltage: float = 0.0, charge: float | None = None, friction: float = 0.0, direction: float = 0.0,
    air: float | None = 1.0, end: float = np.inf, punch: tuple[float, float] | None = None,
    error: float = 1e-3, cells: int | None = None, slopes: Slopes = Slopes.BY_VOLTAGE,
) -> SurfaceContact:  # fmt: skip
    """Contact of a punch with a body under a force or at a depth, at a voltage or with a charge.

    The grid is refined until the estimated error is below ``error``; ``cells`` a side fixes the grid.
    """
    if friction > _MOST_FRICTION:
        raise SurfaceError(f"friction: {friction!r} is not allowed; a finite number from 0 to {_MOST_FRICTION:g}")
    if air is None and not body.isotropic:
        raise SurfaceError("surroundings: insulated is allowed for bodies isotropic about the normal only; air")
    permittivity = None if air is None else air * VACUUM_PERMITTIVITY
    loading = Loading(force, depth, charge, voltage, friction, direction, permittivity, end)
    problem = _Problem(body, None if punch is None else isotropic_half_space(*punch), shape, loading)
    return problem.refined(error, cells, slopes)


def isotropic_half_space(modulus: float, poisson: float) -> SurfaceBody:
    """Half-space of an isotropic dielectric [Pa, 1]."""
    return SurfaceBody((), Material.isotropic(modulus, poisson, any_size=True).stiffness_tensor())


@dataclass(frozen=True)
class _Window:
    """Rectangle of cells [m]."""

    low: tuple[float, float]
    high: tuple[float, float]

    @property
    def lengths(self) -> tuple[float, float]:
        return self.high[0] - self.low[0], self.high[1] - self.low[1]

    def counts(self, cells: int) -> tuple[int, int]:
        """Cells along x and y; more along a slender window, of cells that are not too slender."""
        ratio = self.lengths[1] / self.lengths[0]
        more = max(ratio, 1 / ratio) / _SLENDER
        longer = cells * 2 ** max(int(np.ceil(np.log2(more))), 0)
        return (cells, longer) if ratio >= 1 else (longer, cells)


class _Problem:
    """A punch on a body under a load: the window and the grids."""

    def __init__(self, body: SurfaceBody, punch: SurfaceBody | None, shape: Shape, loading: Loading) -> None:
        self.body, self.punch, self.shape, self.loading = body, punch, shape, loading

    def refined(self, error: float, cells: int | None, slopes: Slopes) -> SurfaceContact:
        """Contact with its slopes on the grid that meets the error."""
        window, state, grid = self._located(error)
        by_load = slopes is Slopes.BY_LOAD
        loadings = self._loadings(by_load)
        count, least = _COARSE // 4, max(self._least_cells(window), _SLOPED if by_load and error < _ROUGH else 0)
        before, errors = dict[str, float](), dict[str, float]()
        sloped: list[tuple[dict[str, Linearised], Linearised]] = []  # on the last two fine grids
        while True:
            count = min(2 * count, cells) if cells else 2 * count
            shape = window.counts(count)
            if shape[0] * shape[1] > _MOST_CELLS:
                raise SurfaceError(f"grid_error: {error:g} needs more than {_MOST_CELLS} cells")
            grid, state = self._moved(grid, state, window, count)
            system = System(self.body, self.punch, self.shape, grid, self.grounded, state.depth)
            grounded = converged(system, state, _ACCURACY * error)[1]
            state = grounded.state
            solved = {
                name: converged(system.under(loading), state, _ACCURACY * error)[1]
                for name, loading in loadings.items()
            } or {"main": grounded}
            if count >= max(least, _SLOPED):
                sloped = [*sloped[-1:], (solved, grounded)]
            results = {name: load for each in (grounded, *solved.values()) for name, load in _loads(each).items()}
            tangents = dict.fromkeys(solved, (np.full((2, 2), np.nan), np.nan))
            if slopes is not Slopes.NONE:
                tangents = {name: linear.tangent(_TANGENT * error) for name, linear in solved.items()}
                tangent, results["capacitance"] = tangents["main"]
                if "charge" in results or "voltage" in results:  # of a body that couples
                    results["stroke"] = float(tangent[0, 1] / tangent[0, 0])
            if not self._reaches_end(grid, state):
                peak = "hill pressure" if isinstance(self.shape, (RoughSphere, Map)) else "pressure"
                results[peak] = float(np.max(solved["main"].state.pressure)) / system.compliance
            applied = 0.0 if by_load else self.loading.charge or 0.0  # by load, the voltage is that without charge
            estimated = _errors(before, results, float(grounded.loads[0] * system.per_volt), applied)
            errors = {name: max(size, errors.get(name, 0.0) / _FALL) for name, size in estimated.items()}
            before = results if 2 * count >= least else {}  # a grid that resolves nothing of the punch says no error
            is_fine = count >= least and (count >= _REFINED or (errors and max(errors.values()) <= error))
            if count == cells or (cells is None and is_fine):
                break
        contacts, (coarse, coarse_grounded) = {}, (sloped or [(solved, grounded)])[0]
        for name, linear in solved.items():
            tangent, fixed = tangents[name]
            if by_load:
                tangent = _with_secant(tangent, coarse[name], coarse_grounded, _ACCURACY * error)
            contact = _contact(linear, grounded, tangent, fixed, errors)
            contacts[name] = replace(contact, reaches_end=self._reaches_end(grid, state))
        return replace(contacts["main"], uncharged=contacts.get("uncharged"))

    def _least_cells(self, window: _Window) -> int:
        """Cells a side that resolve the points of a height map, or the waves of a rough punch, within bounds."""
        if isinstance(self.shape, RoughSphere):
            return min(int(_PER_WAVE * max(window.lengths) / self.shape.shortest_wavelength), _REFINED)
        if not isinstance(self.shape, Map):
            return 0
        points = max(length / spacing for length, spacing in zip(window.lengths, self.shape.spacing, strict=True))
        return min(int(points / 2), _FINEST // 2)

    @property
    def grounded(self) -> Loading:
        """The load at zero voltage, from whose contact others are sought: its gap closes smoothly at the edge."""
        return replace(self.loading, charge=None, voltage=0.0)

    def _loadings(self, uncharged: bool) -> dict[str, Loading]:
        """Loads besides that at zero voltage."""
        loadings = {}
        if self.loading.charge is not None or self.loading.voltage:
            loadings["main"] = self.loading
        if uncharged and self.loading.charge:
            loadings["uncharged"] = replace(self.loading, charge=0.0)
        return loadings

    def _located(self, error: float) -> tuple[_Window, State, Grid]:
        """Window that the contact fills well, with the contact on a coarse grid."""
        window = self._first_window()
        grid, state = self._moved(None, None, window, _COARSE)
        for _ in range(_WINDOWS):
            system = System(self.body, self.punch, self.shape, grid, self.grounded, state.depth, levels=0)
            state, _ = converged(system, state, max(error, 1e-3))
            low, high, touches = self._extent(grid, state)
            lengths = np.subtract(high, low)
            ratio = float(np.max(lengths) / np.min(lengths))
            if ratio > _LONGEST:
                raise SurfaceError(
                    f"contact: {ratio:.3g} times as long as wide is not allowed; at most {_LONGEST:g}, else a line"
                )
            share = lengths / window.lengths
            if (not np.any(touches) and np.all(share >= _LOOSE)) or self._is_whole(window):
                break
            middle, half = np.add(high, low) / 2, lengths / 2
            half = np.where(touches, 2 * half, np.maximum(half, 1.5 * np.array(grid.size)))
            window = self._around(middle, half)
            grid, state = self._moved(grid, state, window, _COARSE)
        else:
            raise SurfaceError("contact: leaves every window that was tried")
        self._require_resolved(low, high)
        if not np.any(touches):
            window = self._around(np.add(high, low) / 2, lengths / 2)
        return window, state, grid

    def _around(self, middle: Array, half: Array) -> _Window:
        """Window that a contact of these half lengths fills as asked, within the punch."""
        ends = np.array(self.shape.half_extent)
        half = half / _FILLED
        low, high = np.maximum(middle - half, -ends), np.minimum(middle + half, ends)
        return _Window((float(low[0]), float(low[1])), (float(high[0]), float(high[1])))

    def _is_whole(self, window: _Window) -> bool:
        ends = np.array(self.shape.half_extent)
        return bool(np.all(np.array(window.high) >= ends) and np.all(np.array(window.low) <= -ends))

    def _require_resolved(self, low: Array, high: Array) -> None:
        """Refuse a height map that the contact leaves, or whose points are as far apart as the contact is wide."""
        if not isinstance(self.shape, Map):
            return
        spacing, ends = np.array(self.shape.spacing), np.array(self.shape.half_extent)
        if np.any(np.maximum(np.abs(low), np.abs(high)) > ends - spacing):
            raise SurfaceError("height_map: the contact reaches the edge of the map; a larger map or a smaller load")
        if np.any(high - low < _LEAST_SPACINGS * spacing):
            raise SurfaceError(
                f"map_spacing: {max(spacing):g} m of the height map is too wide for a contact of {min(high - low):g} m"
            )

    def _first_window(self) -> _Window:
        """Square around the lowest point whose half length is that of a round contact of the same load.

        The contact of a film that bends on a softer base is rather that of a half-space of the film.
        """
        angles = np.linspace(0, 2 * np.pi, 16, endpoint=False)
        ends, lowest, loading = np.array(self.shape.half_extent), self.shape.lowest, self.loading
        a = np.minimum(np.geomspace(*_RADII, _RADII_TRIED), np.max(ends))
        x = np.clip(lowest[0] + np.outer(a, np.cos(angles)), -ends[0], ends[0])
        y = np.clip(lowest[1] + np.outer(a, np.sin(angles)), -ends[1], ends[1])
        heights = self.shape.gap(x, y)
        finite = np.isfinite(heights)
        height = np.sum(np.where(finite, heights, 0.0), axis=1) / np.maximum(np.sum(finite, axis=1), 1)
        compliance = self.body.multiplier(np.append(1 / a, np.inf), np.zeros(1))[:, 0, NORMAL, NORMAL].real
        stiffness = 2 * a / np.minimum(compliance[:-1], compliance[-1])
        name, load, loads = (
            ("force", loading.force, stiffness * height)
            if loading.force is not None
            else ("depth", loading.depth or 0.0, height)
        )
        place = min(int(np.searchsorted(loads, load)), a.size - 1)
        depth = load if name == "depth" else load / stiffness[place]
        if depth < _LEAST_DEPTH:
            raise SurfaceError(f"{name}: a depth of {depth:.2g} m is not allowed; at least {_LEAST_DEPTH:g} m")
        return self._around(np.array(lowest), np.minimum(a[place], ends))

    def _extent(self, grid: Grid, state: State) -> tuple[Array, Array, BoolArray]:
        """Lowest and highest position of the contact, and whether the contact touches the window along x and y."""
        low, high, touches = np.empty(2), np.empty(2), np.zeros(2, dtype=bool)
        for axis, middles in enumerate((grid.x, grid.y)):
            covered = np.flatnonzero(np.any(_on(grid, state.pressed), axis=1 - axis))
            half, end = grid.size[axis] / 2, self.shape.half_extent[axis]
            low[axis], high[axis] = middles[covered[0]] - half, middles[covered[-1]] + half
            beyond = low[axis] > -end * (1 - 1e-9) and covered[0] == 0
            above = high[axis] < end * (1 - 1e-9) and covered[-1] == middles.size - 1
            touches[axis] = beyond or above
        return low, high, touches

    def _reaches_end(self, grid: Grid, state: State) -> bool:
        """True of a contact that a sharp end of the punch limits, where the pressure is infinite."""
        low, high, _ = self._extent(grid, state)
        return bool(np.any(np.maximum(-low, high) >= np.array(self.shape.half_extent) * (1 - 1e-9)))

    def _moved(self, old: Grid | None, state: State | None, window: _Window, cells: int) -> tuple[Grid, State]:
        """Grid on a window and the start on it."""
        counts = window.counts(cells)
        x, y = (
            low + (np.arange(n) + 0.5) * (high - low) / n
            for low, high, n in zip(window.low, window.high, counts, strict=True)
        )
        height, cover = self.shape.on_cells(x, y)
        grid = Grid(x, y, height, cover)
        if not np.any(np.isfinite(height)):
            raise SurfaceError("shape: no part of the punch lies over the window")
        if old is None or state is None:
            depth = self.loading.depth or float(np.quantile(height[np.isfinite(height)], 0.3))
            pressed = height <= max(depth / 2, float(np.min(height)))
            zero = np.zeros(height.size)
            pressed = pressed.ravel()
            return grid, State(np.where(pressed, np.finfo(float).tiny, 0.0), zero, pressed, depth, 0.0)
        places = np.stack(np.broadcast_arrays(((x - old.x[0]) / old.size[0])[:, None], (y - old.y[0]) / old.size[1]))
        read = [map_coordinates(_on(old, v), places, order=1, mode="nearest") for v in (state.pressure, state.charge)]
        inside = map_coordinates(_on(old, state.pressed).astype(float), places, order=1, mode="constant") > 0.5
        finite = np.isfinite(height)
        pressed = inside & finite & (read[0] > 0)
        size = np.sqrt(grid.area / old.area)  # scaled tractions are proportional to the cell's length
        pressure = np.where(pressed, read[0] * size, 0.0)
        charge = np.where(finite if self.loading.permittivity is not None else pressed, read[1] * size, 0.0)
        around = state.charge[old.height.size :] * size  # levels around a window stay
        charges = np.concatenate([charge.ravel(), around])
        return grid, State(pressure.ravel(), charges, pressed.ravel(), state.depth, state.potential)


def _loads(linear: Linearised) -> dict[str, float]:
    """Loads whose error is estimated: what is not prescribed, without the rounding of a body that does not couple."""
    force, charge = linear.loads
    loading, per_volt = linear.system.loading, linear.system.per_volt
    mechanical = {"depth": linear.state.depth} if loading.force is not None else {"force": force}
    if loading.charge is not None:
        coupled = abs(linear.state.potential) > NO_COUPLING * linear.state.depth
        return mechanical | ({"voltage": linear.state.potential / per_volt} if coupled else {})
    return mechanical | ({"charge": charge} if abs(charge) > NO_COUPLING * force * per_volt else {})


def _contact(
    linear: Linearised, grounded: Linearised, tangent: Array, fixed_capacitance: float, errors: dict[str, float]
) -> SurfaceContact:
    """Fields and loads of a converged state."""
    system, state = linear.system, linear.state
    grid, loading = system.grid, system.loading
    normal, charge = linear.loads
    changed = _on(grid, state.pressed).astype(float) - _on(grid, grounded.state.pressed)
    weight = np.clip(grounded.share + changed * grid.cover, 0, 1)
    along = loading.friction * np.array([np.cos(loading.direction), np.sin(loading.direction)])
    return SurfaceContact(
        x=grid.x, y=grid.y,
        pressure=_on(grid, state.pressure) / system.compliance,
        electric_displacement=_on(grid, state.charge) / (system.elastance * system.per_volt),
        gap=_on(grid, np.where(state.pressed, 0.0, linear.gap)), weight=weight,
        depth=state.depth, voltage=state.potential / system.per_volt,
        force=np.append(along * normal, normal), charge=float(charge) if loading.charge is None else loading.charge,
        tangent=tangent, fixed_capacitance=fixed_capacitance,
        charge_per_force=float(grounded.loads[1] / grounded.loads[0]), errors=errors, permittivity=loading.permittivity,
    )  # fmt: skip


def _multiplied(linear: Linearised, grounded: Linearised, factor: float, tolerance: float) -> Linearised:
    """Contact with its force or depth multiplied by a factor, sought as it was itself from that at zero voltage."""
    for each in (grounded, linear) if linear is not grounded else (grounded,):
        force, depth = (
            None if v is None else factor * v for v in (each.system.loading.force, each.system.loading.depth)
        )
        system = each.system.under(replace(each.system.loading, force=force, depth=depth))
        grounded = converged(system, grounded.state, tolerance)[1]
    return grounded


def _with_secant(tangent: Array, linear: Linearised, grounded: Linearised, tolerance: float) -> Array:
    """Tangent whose direction of loading is a secant between contacts of a lower and a higher load; (2, 2).

    Cells change sides as the load grows. Where charge is dense at the edge they take it along, which no tangent sees.
    The secant is that of logarithms, so that powers of the load have their exact derivative.
    """
    per_volt = linear.system.per_volt
    low, high = (_multiplied(linear, grounded, np.exp(change), tolerance) for change in (-_SECANT, _SECANT))
    values = np.array(
        [[each.state.depth, each.state.potential / per_volt, *each.loads] for each in (low, linear, high)]
    )
    depth, voltage, force, charge = (_logarithmic(*three) for three in values.T)
    stroke = -tangent[0, 1] / tangent[0, 0]  # at fixed force
    capacitance = tangent[1, 1] + tangent[1, 0] * stroke
    causes, loads = np.array([[depth, stroke], [voltage, 1.0]]), np.array([[force, 0.0], [charge, capacitance]])
    return np.asarray(loads @ np.linalg.inv(causes))


def _logarithmic(low: float, middle: float, high: float) -> float:
    """Change between two values as the logarithm's slope at the middle says; their difference where signs differ."""
    return middle * float(np.log(high / low)) if low * middle > 0 and high * middle > 0 else high - low


def _on(grid: Grid, values: Field) -> Field:
    """Part of an array over all cells that belongs to the grid; (x, y)."""
    part: Field = values[: grid.height.size].reshape(grid.shape)
    return part


def _errors(coarse: dict[str, float], fine: dict[str, float], coupled: float, applied: float) -> dict[str, float]:
    """Relative errors on the finer of two grids, from their differences; ``coupled``: charge of a coupled body [C].

    Where the charge at zero voltage is below a least one, as near a cut without charge, those of charge, stroke and
    voltage are relative to the least one. Where the ``applied`` charge [C] nearly grounds the punch, that of voltage is
    relative to the voltage without charge.
    """
    tiny, charge = np.finfo(float).tiny, abs(fine.get("charge", np.inf))
    errors = {}
    for name in (name for name in fine if name in coarse):
        size = float(abs(fine[name] - coarse[name]) / _SHARE_LEFT[name] / max(abs(fine[name]), tiny))
        share = charge / (_LEAST_COUPLED[name] * coupled) if name in _LEAST_COUPLED else 1.0
        errors[name] = size * min(share, 1.0)
    if applied and "charge" in fine and "voltage" in errors:
        errors["voltage"] *= min(abs(applied / fine["charge"] - 1), 1.0)
    return errors
