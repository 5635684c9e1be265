"""Contacts of punches on a film: extent, punch response, edge values and tangents (films, sections 4 and 5).

Tangents move the edges, so that reciprocity, exact at a fixed contact, does not hold for them.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array, dot, selected
from solver.halfplane.profile import Profile
from solver.line import outputs
from solver.line.basis import mean_rule
from solver.line.extent import Causes, Loading, extent
from solver.line.table import Table
from solver.stack.electroded import lowest

_NORMAL = np.diag([1.0, 0.0, 0.0])  # (y, y) among (y, phi, psi)


@dataclass(frozen=True, eq=False)
class FilmContact:
    """Contacts of cases, read from a table."""

    table: Table
    profile: Profile
    load: Array  # P [N/m]; (case,)
    charges: Array  # T [C/m] and J [Wb/m]; (case, 2)
    datum: Array  # L [m]; (case,)
    punch_datum: Array | None = None  # Reference length of an elastic punch [m]; by default L

    @property
    def scale(self) -> Array:
        """Units of the stack; (4,)."""
        return self.table.system.kernel.stack.scale

    @cached_property
    def loading(self) -> Loading:
        """Slope and loads in the units of the stack; a punch free to tilt has the slope that its moment requires."""
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
        """Half-length [m] and c/h; (case,) each."""
        return extent(self.table, self.loading, self._corners)

    @property
    def half_width(self) -> Array:
        """Half-length h = (a + b)/2 [m]; (case,)."""
        return self._extent[0]

    @property
    def centre(self) -> Array:
        """Centre c/h = (a - b)/(a + b); (case,)."""
        return self._extent[1]

    @property
    def exponent(self) -> float:
        """Pressure exponent alpha of the top material's half-plane."""
        return 0.5 + self.table.system.coefficients.delta

    @cached_property
    def causes(self) -> Causes:
        """Causes at the contact's extent."""
        return self.loading.at(self.half_width, self.centre)

    def _read(self, which: slice, *, rate: bool = False) -> Array:
        """Outputs, or their derivatives by log h, for every cause; (case, output, cause)."""
        series = self.table.rates if rate else self.table.series
        return self.table.interval.read(np.log(self.half_width), series[:, which])

    def output(self, which: slice) -> Array:
        """Outputs of :mod:`solver.line.outputs` in the units of the stack, powers of h divided out; (case, output)."""
        return self.table.interval.read(np.log(self.half_width), self.table.series[:, which], self.causes.values)

    # -- edges ---------------------------------------------------------------------------------------------------------
    def edge_intensity(self, edge: float) -> Array:
        """Edge intensities lim sqrt(2 pi r) (D_y, B_y) [C m^-3/2, T m^1/2] at X = 1 or -1; (case, 2)."""
        intensities = self.output(outputs.INTENSITY)[:, (0, 2) if edge > 0 else (1, 3)]
        return np.asarray(np.sqrt(self.half_width)[:, None] * intensities / self.scale[2:])

    def edge_stress(self, edge: float) -> Array:
        """Stress sigma_xx on the free surface just outside a smooth edge X = 1 or -1 [Pa]; (case,)."""
        return np.asarray(self.output(outputs.EDGE_STRESS)[:, 0 if edge > 0 else 1] / self.scale[1])

    # -- response ------------------------------------------------------------------------------------------------------
    @cached_property
    def far(self) -> Array:
        """(Y_low)_oo log(L/b) / pi, the datum's displacements per total traction; (case or 1, 3, 3)."""
        system = self.table.system
        punch_length = self.datum if self.punch_datum is None else self.punch_datum
        body, punch = (np.log(length / system.kernel.width) for length in (self.datum, punch_length))
        far = lowest(system.kernel.stack)[1:, 1:] / np.pi * body[..., None, None]
        return np.asarray(far + system.coefficients.punch[0] / np.pi * punch[..., None, None] * _NORMAL)

    @cached_property
    def response(self) -> Array:
        """Depth [m], voltage [V] and magnetic potential [A] of the punch; (case, 3)."""
        displacement = self.half_width[:, None] * self.output(outputs.DISPLACEMENT)
        response = displacement - dot(self.far, self.loading.loads[:, None, :])
        response[:, 0] = rise(self.loading.slope, self.half_width, self.centre)[:, 0] - response[:, 0]
        return np.asarray(response * self.scale[1:])

    @cached_property
    def at_fixed_contact(self) -> Array:
        """d (depth, voltage, magnetic potential) / d (T, J) at a fixed width of the contact, SI; (case, 3, 2)."""
        slopes = self._by_load[..., 1:]
        if self.loading.order != -1:
            jacobian, right, by_edges = self._edges
            shift = right[:, 1, 1:] / jacobian[:, 1, 1, None]  # of the contact with its charges, under friction
            carried = jacobian[:, 0, 1, None] * shift - right[:, 0, 1:]  # load that the charges carry
            slopes = slopes - self.far[..., :1] * carried[:, None, :] + by_edges[..., 1:] * shift[:, None, :]
        return self._si(slopes, self.scale[2:])

    @property
    def _first_charge(self) -> int:
        """Index of T among the causes."""
        return len(self.table.system.powers)

    @cached_property
    def tangents(self) -> Array:
        """d (depth, voltage, magnetic potential) / d (P, T, J) as the edges move, SI; (case, 3, 3)."""
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
        """Jacobian, right sides and displacements of the system for smooth edges (log h, c/h), units of the stack."""
        h, causes, first = self.half_width, self.causes, self._first_charge
        read, rate = self._read(outputs.DISPLACEMENT), self._read(outputs.DISPLACEMENT, rate=True)
        rows = slice(outputs.LOAD, outputs.BALANCE + 1)
        values, value_rate = (r[:, :: outputs.BALANCE] for r in (self._read(rows), self._read(rows, rate=True)))
        carried = h[:, None] * _sum(values[:, :1], causes.values)
        jacobian = np.zeros((h.size, 2, 2))  # of load and balance by (log h, c/h)
        jacobian[:, 0, 0] = (carried + h[:, None] * _by_width(values[:, :1], value_rate[:, :1], causes))[:, 0]
        jacobian[:, 1, 1] = 1.0
        right = np.zeros((h.size, 2, 3))  # changes of load and balance by (P, T, J) that the edges undo
        right[:, 0, 0] = 1.0
        right[:, 0, 1:] = -values[:, 0, first : first + 2]
        if self.loading.order == 1:
            jacobian[:, 0, 1] = h * _sum(values[:, :1], causes.by_centre)[:, 0]
            jacobian[:, 1, 0] = causes.constant_by_width - _by_width(values[:, 1:], value_rate[:, 1:], causes)[:, 0]
            jacobian[:, 1, 1] = causes.constant_by_centre - _sum(values[:, 1:], causes.by_centre)[:, 0]
            right[:, 1, 1:] = values[:, 1, first : first + 2] / h[:, None]
        by_edges = np.empty((h.size, 3, 2))  # derivatives of (displacement, potentials) by (log h, c/h)
        by_edges[..., 0] = h[:, None] * (_sum(read, causes.values) + _by_width(read, rate, causes))
        by_edges[..., 1] = h[:, None] * _sum(read, causes.by_centre)
        by_edges[:, 0] -= rise(self.loading.slope, h, self.centre)[:, 1:]
        return jacobian, right, by_edges

    def _si(self, tangents: Array, loads: Array) -> Array:
        """Derivatives in SI by loads with units ``loads``; that of the displacement becomes the depth's, g - u_y."""
        scaled = tangents * self.scale[1:, None] * loads
        scaled[:, 0] *= -1
        return np.asarray(scaled)

    def part(self, cases: Indices) -> "FilmContact":
        """Return the contacts of the selected cases."""
        contacts = selected(self, cases, "load", "charges", "datum", "punch_datum")
        return replace(contacts, profile=self.profile.part(cases, self.load.shape))


def _sum(read: Array, causes: Array) -> Array:
    """Outputs (case, output) of outputs per cause (case, output, cause) and causes (case, cause)."""
    return np.asarray(np.einsum("coq,cq->co", read, causes))


def _by_width(read: Array, rate: Array, causes: Causes) -> Array:
    """Derivatives of outputs by log h at fixed loads; (case, output)."""
    return _sum(rate, causes.values) + _sum(read, causes.by_width)


def rise(slope: Array, half: Array, centre: Array) -> Array:
    """Mean of g with weight (1 - X^2)^(3/2), of g' (case, power), and its derivatives by log h and c/h; (case, 3)."""
    result = np.zeros((half.size, 3))
    for i, coefficient in enumerate(slope.T):
        size, mean = coefficient * half ** (i + 1), _mean_power(centre, i + 1)
        result += size[:, None] * np.stack([mean / (i + 1), mean, _mean_power(centre, i)], 1)
    return result


def _mean_power(centre: Array, n: int) -> Array:
    """Mean of (X + c/h)^n with weight (1 - X^2)^(3/2), by Gauss's rule; (case,)."""
    X, weights = mean_rule(n // 2 + 4)
    return np.asarray((X + centre[:, None]) ** n @ weights)
