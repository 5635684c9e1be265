"""Contact of a rigid punch on a film: extent, punch response, edge values, tangents (films, sections 4 and 5).

Arrays have the case axis first. Displacements are linear in the causes at a fixed contact; tangents at fixed load move
the edges, so that reciprocity, exact at a fixed contact, does not hold for them.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, dot
from solver.halfplane.profile import Profile
from solver.line import outputs
from solver.line.basis import mean_rule
from solver.line.extent import Causes, Loading, extent
from solver.line.table import Table
from solver.stack.electroded import lowest

_NORMAL = np.diag([1.0, 0.0, 0.0])  # (y, y) among (y, phi, psi)


@dataclass(frozen=True, eq=False)
class FilmContact:
    """Contacts of cases read from a table."""

    table: Table
    profile: Profile
    load: Array
    charges: Array
    datum: Array
    punch_datum: Array | None = None

    @property
    def scale(self) -> Array:
        """Units of the stack; (4,)."""
        return self.table.system.kernel.stack.scale

    @cached_property
    def loading(self) -> Loading:
        """Slope and loads in the units of the stack; a punch that tilts has the slope that its moment asks for."""
        loading = Loading.of(self.table, self.profile, self.load, self.charges)
        if self.profile.moment is None or self._corners is None:
            return loading
        half = self._corners
        tilted = np.array(loading.slope)
        tilted[:, 0] = 0.0
        causes = Loading(tilted, loading.loads, loading.smooth).at(half, np.zeros_like(half)).values
        moments = self.table.interval.read(np.log(half), self.table.series[:, outputs.MOMENT])
        required = np.asarray(self.profile.moment) * self.scale[1] / half**2
        tilted[:, 0] = (required - dot(moments, causes)) / moments[:, 0]
        return Loading(tilted, loading.loads, loading.smooth)

    @property
    def _corners(self) -> Array | None:
        """Half the width of a punch with two corners [m]; (case,)."""
        width = self.profile.width
        return None if width is None else np.array(np.broadcast_to(np.asarray(width) / 2, self.load.shape))

    @cached_property
    def _extent(self) -> tuple[Array, Array]:
        return extent(self.table, self.loading, self._corners)

    @property
    def half_width(self) -> Array:
        """h = (a + b)/2 [m]."""
        return self._extent[0]

    @property
    def centre(self) -> Array:
        """c/h = (a - b)/(a + b)."""
        return self._extent[1]

    @property
    def exponent(self) -> float:
        """Pressure exponent alpha, that of the top material's half-plane."""
        return 0.5 + self.table.system.coefficients.delta

    @cached_property
    def causes(self) -> Causes:
        """Causes at the extent."""
        return self.loading.at(self.half_width, self.centre)

    def _read(self, which: slice, *, rate: bool = False) -> Array:
        """Outputs, or their derivatives in log h, for every cause; (case, output, cause)."""
        series = self.table.rates if rate else self.table.series
        return self.table.interval.read(np.log(self.half_width), series[:, which])

    def output(self, which: slice) -> Array:
        """Outputs of :mod:`solver.line.outputs`, powers of h out, units of the stack; (case, output)."""
        return self.table.interval.read(np.log(self.half_width), self.table.series[:, which], self.causes.values)

    # -- edges ---------------------------------------------------------------------------------------------------------
    def edge_intensity(self, edge: float) -> Array:
        """lim sqrt(2 pi r) (D_y, B_y) [C m^-3/2, T m^1/2] at X = 1 trailing or -1 leading; (case, 2)."""
        intensities = self.output(outputs.INTENSITY)[:, (0, 2) if edge > 0 else (1, 3)]
        return np.asarray(np.sqrt(self.half_width)[:, None] * intensities / self.scale[2:])

    def edge_stress(self, edge: float) -> Array:
        """sigma_xx [Pa] on the free surface just outside a smooth edge, X = 1 trailing or -1 leading; (case,)."""
        return np.asarray(self.output(outputs.EDGE_STRESS)[:, 0 if edge > 0 else 1] / self.scale[1])

    # -- response ------------------------------------------------------------------------------------------------------
    @cached_property
    def far(self) -> Array:
        """(Y_low)_oo log(L/b) / pi: displacements per total of the tractions that the datum adds; (case or 1, 3, 3)."""
        system = self.table.system
        punch_length = self.datum if self.punch_datum is None else self.punch_datum
        body, punch = (
            np.log(np.asarray(L, dtype=np.float64) / system.kernel.width) for L in (self.datum, punch_length)
        )
        far = lowest(system.kernel.stack)[1:, 1:] / np.pi * body[..., None, None]
        return np.asarray(far + system.coefficients.punch[0] / np.pi * punch[..., None, None] * _NORMAL)

    @cached_property
    def response(self) -> Array:
        """Depth [m], voltage [V] and magnetic potential [A] of the punch; (case, 3)."""
        displacement = self.half_width[:, None] * self.output(outputs.DISPLACEMENT)
        whole = displacement - dot(self.far, self.loading.loads[:, None, :])
        whole[:, 0] = rise(self.loading.slope, self.half_width, self.centre)[:, 0] - whole[:, 0]
        return np.asarray(whole * self.scale[1:])

    @cached_property
    def at_fixed_contact(self) -> Array:
        """d (depth, voltage, magnetic potential) / d (T, J) at a fixed width of the contact, SI; (case, 3, 2).

        Charges carry a part of the load, which changes with them, and move the contact where there is friction.
        """
        slopes = self._by_load
        if self.loading.order != -1:
            jacobian, right, by_edges = self._edges
            shift = right[:, 1, 1:] / jacobian[:, 1, 1, None]
            carried = jacobian[:, 0, 1, None] * shift - right[:, 0, 1:]
            slopes = slopes[..., 1:] - self.far[..., :1] * carried[:, None, :] + by_edges[..., 1:] * shift[:, None, :]
        else:
            slopes = slopes[..., 1:]
        return self._si(slopes, self.scale[2:])

    @property
    def _first_charge(self) -> int:
        return len(self.table.system.powers)

    @cached_property
    def tangents(self) -> Array:
        """d (depth, voltage, magnetic potential) / d (P, T, J) with the moving edges, SI; (case, 3, 3)."""
        if self.loading.order == -1:
            return self._si(self._by_load, self.scale[1:])
        jacobian, right, by_edges = self._edges
        return self._si(self._by_load + by_edges @ np.linalg.solve(jacobian, right), self.scale[1:])

    @cached_property
    def _by_load(self) -> Array:
        """d (displacement, potentials) / d (P, T, J) at fixed edges and slope, units of the stack; (case, 3, 3)."""
        first, read = self._first_charge, self._read(outputs.DISPLACEMENT)
        slopes = np.zeros((self.load.size, 3, 3))
        slopes[..., 1:] = read[..., first : first + 2]
        slopes -= self.far
        if self.loading.order == -1:
            slopes[..., 0] += read[..., -1]
            if self.profile.moment is not None:
                moments = self._read(slice(outputs.MOMENT, outputs.MOMENT + 1))[:, 0]
                slopes -= read[..., :1] * (moments[:, [-1, first, first + 1]] / moments[:, :1])[:, None, :]
        return slopes

    @cached_property
    def _edges(self) -> tuple[Array, Array, Array]:
        """Derivatives that move smooth edges, with log h and c/h as unknowns.

        Derivatives of load and balance by them, (case, 2, 2), the changes by (P, T, J) that these undo, (case, 2, 3),
        and the derivatives of (displacement, potentials) by them, (case, 3, 2); units of the stack.
        """
        h, causes, first = self.half_width, self.causes, self._first_charge
        read, rate = self._read(outputs.DISPLACEMENT), self._read(outputs.DISPLACEMENT, rate=True)
        rows = slice(outputs.LOAD, outputs.BALANCE + 1)
        values, kept_rate = (r[:, :: outputs.BALANCE] for r in (self._read(rows), self._read(rows, rate=True)))
        carried = h[:, None] * _sum(values[:, :1], causes.values)
        jacobian = np.zeros((h.size, 2, 2))
        jacobian[:, 0, 0] = (carried + h[:, None] * _moved(values[:, :1], kept_rate[:, :1], causes))[:, 0]
        jacobian[:, 1, 1] = 1.0
        right = np.zeros((h.size, 2, 3))
        right[:, 0, 0] = 1.0
        right[:, 0, 1:] = -values[:, 0, first : first + 2]
        if self.loading.order == 1:
            jacobian[:, 0, 1] = h * _sum(values[:, :1], causes.by_centre)[:, 0]
            jacobian[:, 1, 0] = causes.constant_by_width - _moved(values[:, 1:], kept_rate[:, 1:], causes)[:, 0]
            jacobian[:, 1, 1] = causes.constant_by_centre - _sum(values[:, 1:], causes.by_centre)[:, 0]
            right[:, 1, 1:] = values[:, 1, first : first + 2] / h[:, None]
        by_edges = np.empty((h.size, 3, 2))
        by_edges[..., 0] = h[:, None] * (_sum(read, causes.values) + _moved(read, rate, causes))
        by_edges[..., 1] = h[:, None] * _sum(read, causes.by_centre)
        by_edges[:, 0] -= rise(self.loading.slope, h, self.centre)[:, 1:]
        return jacobian, right, by_edges

    def _si(self, tangents: Array, loads: Array) -> Array:
        """Derivatives by some loads in SI, those of the displacement as depth, g - u_y."""
        scaled = tangents * self.scale[1:, None] * loads
        scaled[:, 0] *= -1
        return np.asarray(scaled)

    def part(self, places: Indices) -> "FilmContact":
        """Some of the cases."""
        size = self.load.shape

        def chosen(values: Array) -> Array:
            return np.asarray(np.broadcast_to(values, size)[places])

        punch_datum = None if self.punch_datum is None else chosen(self.punch_datum)
        profile, charges = self.profile.part(places, size), self.charges[places]
        return FilmContact(self.table, profile, self.load[places], charges, chosen(self.datum), punch_datum)


def _sum(read: Array, causes: Array) -> Array:
    return np.asarray(np.einsum("coq,cq->co", read, causes))


def _moved(read: Array, rate: Array, causes: Causes) -> Array:
    """Derivative of outputs in log h at fixed loads."""
    return _sum(rate, causes.values) + _sum(read, causes.by_width)


def rise(slope: Array, half: Array, centre: Array) -> Array:
    """Mean of g over the contact with weight (1 - X^2)^(3/2), and its derivatives in log h and c/h; (case, 3).

    slope: (case, power), coefficients of g'.
    """
    result = np.zeros((half.size, 3))
    for i, coefficient in enumerate(slope.T):
        size, mean = coefficient * half ** (i + 1), _mean_power(centre, i + 1)
        result += size[:, None] * np.stack([mean / (i + 1), mean, _mean_power(centre, i)], 1)
    return result


def _mean_power(centre: Array, n: int) -> Array:
    """Mean of (X + c/h)^n with weight (1 - X^2)^(3/2) at c/h (case,), by Gauss's rule; (case,)."""
    X, weights = mean_rule(n // 2 + 4)
    return np.asarray((X + centre[:, None]) ** n @ weights)
