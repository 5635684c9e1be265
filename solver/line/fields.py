"""Fields of films along the surface, tabulated over log h, and inside (films, sections 3 and 6; theory, section 5)."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from approximation.arrays import blocks
from approximation.chebyshev import coefficients
from solver.arrays import Array
from solver.cache import cached
from solver.fields import FIELDS
from solver.halfplane.interior import POTENTIALS
from solver.line.contact import FilmContact
from solver.line.interior import fields_of
from solver.line.kernel import kernel
from solver.line.outputs import Assembly
from solver.line.similar import Films
from solver.line.system import System
from solver.line.table import Table, batches
from solver.line.windows import Kind, traction_window, window

_TRACTIONS = slice(0, 3)  # sigma_yy, D_y, B_y
_GRADIENTS = slice(3, 6)  # d(phi, psi, u_x)/dx
_POSITIONS = 512  # at a time
_ON_SURFACE = 1 << 17  # positions times cases at a time: bounded memory
_ALONG, _POINTS = 256, 4096  # positions along x, and points, inside at a time
_INSIDE = 1 << 16  # points times cases inside at a time


@dataclass(frozen=True, eq=False)
class SurfaceTable:
    """Fields on the surface at fixed positions over the half-lengths of a table."""

    table: Table
    positions: Array  # X = (x - c)/h; (position,)

    @cached_property
    def series(self) -> Array:
        """Chebyshev coefficients in log h of tractions and gradients; (node, 6, position, cause)."""
        system, h = self.table.system, self.table.half_lengths
        farthest = float(np.max(np.abs(self.positions), initial=1.0)) + 1
        wide = System(
            kernel(system.kernel.stack, farthest * self.table.upper) if farthest > 2 else system.kernel,
            system.sliding, system.smooth, system.degree, system.accuracy,
        )  # fmt: skip
        values: Array = np.empty((h.size, 6, self.positions.size, system.causes))
        for basis, members in batches(wide, h, self.positions.size):
            assembly = Assembly(wide, basis, h[members], self.positions)
            values[members] = np.einsum("hfpu,huc->hfpc", local_fields(assembly), assembly.unknowns)
        return coefficients(values)

    def fields(self, contact: FilmContact) -> dict[str, Array]:
        """Fields like :func:`fields`, for contacts read from the same table."""
        local = self.table.interval.read(np.log(contact.half_width), self.series, contact.causes.values)
        return of_local(self.table.system, local)


def of_local(system: System, local: Array) -> dict[str, Array]:
    """Fields of ``FIELDS``, SI, from sums (case, 6, position) of :func:`local_fields`; (case, position) each."""
    half, scale = system.sliding.halfplane, system.kernel.stack.scale
    t = local[:, _TRACTIONS] / scale[1:, None]
    gradient = local[:, _GRADIENTS] * np.array([scale[2], scale[3], scale[0]])[:, None]
    shear = system.coefficients.friction * t[:, 0]
    flux = -np.einsum("fg,cgp->cfp", half.transverse_permittivity, gradient[:, :2])
    flux = flux + half.transverse_shear_share[:, None] * shear[:, None]
    stretch = half.in_plane_stiffness * gradient[:, 2] + np.einsum("f,cfp->cp", half.in_plane_share, t)
    return {
        "contact_pressure": -t[:, 0],
        "shear_traction": shear,
        "electric_displacement_y": t[:, 1],
        "magnetic_induction_y": t[:, 2],
        "stress_xx": stretch,
        "electric_displacement_x": flux[:, 0],
        "magnetic_induction_x": flux[:, 1],
    }


def local_fields(assembly: Assembly) -> Array:
    """(sigma_yy, D_y, B_y) and d(phi, psi, u_x)/dx of every unknown at the points; (half, 6, point, unknown)."""
    system, basis, X = assembly.system, assembly.basis, assembly.points
    c, inside = system.coefficients, np.abs(X) < 1
    count = system.unknowns(basis)
    t, H = np.zeros((3, X.size, count)), np.zeros((3, X.size, count))
    pressed, charged = np.zeros((2, X.size, basis.pressures)), np.zeros((2, X.size, basis.terms + 1))
    within, beyond = X[inside], X[~inside]
    angle = np.arccos(within)[:, None]
    orders = np.arange(basis.terms + 1)
    pressed[0, inside] = basis.weight(within)[:, None] * basis.pressure_factor(within)
    pressed[1, inside] = -np.tan(np.pi * c.delta) * pressed[0, inside] - basis.local(within)
    charged[0, inside] = np.cos(angle * orders) / np.sin(angle)
    charged[1, inside] = np.sin(angle * orders) / np.sin(angle)  # U_(n-1)
    pressed[1, ~inside], charged[1, ~inside] = basis.transforms(beyond)
    for columns, _, rule, carried in assembly.sources():
        source = pressed if rule.shape[1] == basis.pressures and columns.start == 0 else charged
        t[..., columns] = carried[:, None, None] * source[0]
        H[..., columns] = carried[:, None, None] * source[1]
    fields = np.empty((assembly.half_lengths.size, 6, X.size, count))
    fields[:, _TRACTIONS] = t
    smooth = assembly.gradients[:, 1:]
    source = np.tensordot(c.compliance[1:], H, 1) + c.friction * c.coupling[1:, None, None] * t[0]
    along = c.tangential * c.friction * H[0] - np.tensordot(c.coupling, t, 1)
    fields[:, _GRADIENTS] = smooth + np.concatenate([source, along[None]])
    for f in c.fields:
        fields[:, 3 + f, inside] = 0.0  # an equipotential
    return fields


@cached
def _surface_window(kind: Kind, number: int, positions: tuple[float, ...]) -> SurfaceTable:
    return SurfaceTable(window(kind, number), np.array(positions))


def fields(films: Films, positions: Array) -> dict[str, Array]:
    """Fields of ``solver.fields.FIELDS`` at X = (x - c)/h, finite and never exactly +-1; (case, position) each."""
    count = films.load.size
    out = {name: np.empty((count, positions.size)) for name in FIELDS}
    block = _ON_SURFACE // min(positions.size, _POSITIONS)
    for start in range(0, count, block):
        part = films.part(slice(start, start + block))
        for first in range(0, positions.size, _POSITIONS):
            X = positions[first : first + _POSITIONS]
            for cases, number, contact in part.parts:
                values = _surface_window(films.kind, number, tuple(X.tolist())).fields(contact)
                for name, field in out.items():
                    field[np.ix_(start + cases, np.arange(first, first + X.size))] = values[name]
    return out


def interior_fields(films: Films, x: Array, y: Array, names: tuple[str, ...]) -> Array:
    """Fields of ``LINEAR`` and potentials at ((x - c)/h, y/h), NaN in a rigid base; (case, field, y, x)."""
    pieces = list(in_blocks(x, y))
    together = max(_INSIDE // (y[pieces[0][0]].size * x[pieces[0][1]].size), 1)
    out = np.empty((films.load.size, len(names), y.size, x.size))
    for cases, number, contact in films.parts:
        tractions = traction_window(films.kind, number).read(contact)
        for block in blocks(cases.size, together):
            for rows, columns in pieces:
                values = fields_of(tractions.part(block), x[columns], y[rows], names, contact.datum[block])
                out[cases[block], :, rows, columns] = values
    for number, name in enumerate(names):
        if name in POTENTIALS:
            out[:, number] *= films.thickness[:, None, None]
    return out


def in_blocks(x: Array, y: Array) -> Iterator[tuple[slice, slice]]:
    """Yield rows and columns of blocks of a grid of positions x (x,) and y (y,)."""
    across = min(x.size, _ALONG)
    down = min(y.size, max(_POINTS // across, 1))
    for first in range(0, y.size, down):
        for left in range(0, x.size, across):
            yield slice(first, first + down), slice(left, left + across)
