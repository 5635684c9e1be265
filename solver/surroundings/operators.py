"""What charges beside a contact do to it and to the surface beside it, at given half-lengths (theory section 10).

Everything is linear in the causes of the contact (:mod:`solver.film.causes`) and in the densities at the nodes of both
sides: the smooth kernels of a stack make a right side of them for the contact's own system, the half-plane's part is
closed (:mod:`solver.surroundings.grid`). Powers of the half-length are taken out; units are those of the stack.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.film import outputs
from solver.film.assembly import Assembly, mixing
from solver.film.basis import Basis
from solver.film.kernel import Kernel, kernel
from solver.film.reflection import low
from solver.film.system import SAMPLES, System
from solver.film.table import batches
from solver.surroundings.densities import Densities
from solver.surroundings.grid import GROWING, LEVEL, Grid, gauss

_REACH = 8e4  # widths of the strip at which kernels are cut: beyond, they are their logarithm
_NOTHING = 1e-13  # of the compliance: kernels of a stack that is a half-plane
#: Rows: load, balance, displacements, edge stresses and pressures over their weight; then those beside the contact.
LOAD, BALANCE, DISPLACEMENT, EDGE, PRESSURE = 0, 1, slice(2, 5), slice(5, 7), slice(7, 7 + SAMPLES.size)
FIRST = PRESSURE.stop
#: Angles of the places X = cos(angle) within the contact at which densities are told: panels, graded to both edges.
_ENDS = (0.004, 0.012, 0.035, 0.1, 0.25, 0.55, 1.0)
WITHIN = 8  # of them a panel
_HALF = gauss(np.array([*_ENDS, np.pi / 2]), WITHIN)[0]
ANGLES = np.concatenate([_HALF, np.pi - _HALF])
_FROM = [outputs.LOAD, outputs.BALANCE, *range(*outputs.DISPLACEMENT.indices(99)),
         *range(*outputs.EDGE_STRESS.indices(99)), *range(*outputs.PRESSURE.indices(999))]  # fmt: skip


@dataclass(frozen=True, eq=False)
class Operators:
    """Operators of one system at any half-length.

    Parameters
    ----------
    system
        Contacts of one stack, friction, conduction and punch, between smooth edges.
    grid
        Panels beside the contact.
    even
        Whether both sides are mirror images: without friction, the left side is then the right one.
    """

    system: System
    grid: Grid
    even: bool

    @property
    def sides(self) -> int:
        """Number of sides whose densities are unknowns."""
        return 1 if self.even else 2

    @property
    def beside(self) -> int:
        """Number of nodes whose densities are unknowns."""
        return self.sides * self.grid.count

    @property
    def rows(self) -> int:
        """Number of outputs."""
        return FIRST + self.beside * (1 + len(self.system.fields)) + ANGLES.size * len(self.system.fields)

    @cached_property
    def _wide(self) -> Kernel | None:
        """Kernels as far as charges lie; none of a stack that is a half-plane."""
        stack, own = self.system.kernel.stack, self.system.kernel
        if np.max(np.abs(own.coefficients)) < _NOTHING:
            return None
        return kernel(stack, float(max(_REACH * own.width, own.reach)), by_distance=True)

    def at(self, half_lengths: Array) -> Array:
        """Outputs of every cause and density at half-lengths [m]; (half, row, column)."""
        columns = self.system.causes + len(self.system.fields) * self.beside
        found = np.empty((half_lengths.size, self.rows, columns))
        for basis, members in batches(self.system, half_lengths):
            found[members] = _Assembled(self, basis, half_lengths[members]).outputs
        return found

    def folded(self, values: Array) -> Array:
        """Of columns (..., both sides) those of the unknowns."""
        count = self.grid.count
        return values[..., :count] + values[..., count:] if self.even else values

    def far(self, x: Array, mix: Array) -> Array:
        """Sums of channels at distances x [m], by the logarithm beyond the reach."""
        wide = self._wide
        assert wide is not None
        near = np.clip(x, -wide.reach, wide.reach)
        values = wide.at(near, mix)
        beyond = np.abs(x) > wide.reach
        if np.any(beyond):
            stack = wide.stack
            growth = (stack.media[0].compliance - low(stack))[1:, 1:] / np.pi
            channels = np.zeros((19,))
            pairs = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
            channels[10:16] = [growth[pair] for pair in pairs]
            values[beyond] += np.log(np.abs(x[beyond]) / wide.reach)[:, None] * (channels @ mix)
        return values


@dataclass(frozen=True, eq=False)
class _Assembled:
    """Operators at half-lengths that share a basis."""

    of: Operators
    basis: Basis
    half_lengths: Array

    @property
    def _fields(self) -> tuple[int, ...]:
        return self.of.system.fields

    @cached_property
    def _assembly(self) -> Assembly:
        return Assembly(self.of.system, self.basis, self.half_lengths)

    @cached_property
    def _induced(self) -> Array:
        """Terms T_n / sqrt(1 - X^2) that charges of the right and of the left side induce; (M + 1, 2 n)."""
        orders = np.arange(self.basis.terms + 1)
        moments = self.of.grid.moments(orders.size) * np.where(orders, 2, 1)[:, None] / -np.pi
        return np.concatenate([moments, (-1.0) ** orders[:, None] * moments], 1)

    @cached_property
    def _positions(self) -> Array:
        """X of the nodes on the right, then on the left, then of both edges; (2 n + 2,)."""
        X = self.of.grid.distance
        return np.concatenate([X, -X, [1.0, -1.0]])

    @property
    def outputs(self) -> Array:
        """(half, row, column)."""
        of, system, grid = self.of, self.of.system, self.of.grid
        starts, count = system.starts(self.basis), 2 * grid.count
        direct = [self._direct(number) for number in range(self.half_lengths.size)]
        gradients = np.stack([part[0] for part in direct])
        for place, f in enumerate(self._fields):
            part = slice(place * count, (place + 1) * count)
            own = slice(starts[f], starts[f] + self.basis.terms + 1)
            gradients[..., part] += self._assembly.at_nodes[..., own] @ self._induced
        sources = np.concatenate(
            [of.folded(gradients[..., p * count : (p + 1) * count]) for p in range(len(self._fields))], -1
        )
        unknowns = system.solve(self.basis, self._assembly.at_nodes, sources=sources)
        functionals = outputs.functionals(self._assembly)[:, _FROM]
        contact = functionals @ unknowns
        beside = self._beside(unknowns)
        first = system.causes
        for number, (_, displacement, edge, outside) in enumerate(direct):
            for place, f in enumerate(self._fields):
                columns = slice(first + place * of.beside, first + (place + 1) * of.beside)
                part = slice(place * count, (place + 1) * count)
                contact[number, DISPLACEMENT, columns] += of.folded(self._mean(number, f, displacement[:, part]))
                contact[number, EDGE, columns] += of.folded(self._edge(number, f, edge[:, part]))
                beside[number, :, :, columns] += of.folded(self._outside(number, f, outside[..., part]))
        shape = (self.half_lengths.size, -1, contact.shape[-1])
        return np.concatenate([contact, beside.reshape(shape), self._within(unknowns).reshape(shape)], 1)

    def _within(self, unknowns: Array) -> Array:
        """D_y and B_y of the conducted fields at ``ANGLES``; (half, field, angle, column)."""
        system, basis, of = self.of.system, self.basis, self.of
        X, sine = np.cos(ANGLES), np.sin(ANGLES)
        pressures, charges = system.split(basis, np.swapaxes(unknowns, 1, 2))
        normal = basis.weight(X)[:, None] * basis.pressure_factor(X)
        series = np.cos(ANGLES[:, None] * np.arange(basis.terms + 1)) / sine[:, None]
        induced = np.concatenate([of.grid.induced(X), of.grid.induced(-X)], 1) / sine[:, None]
        found = []
        for place, f in enumerate(self._fields):
            own = np.einsum("xj,hqj->hxq", series, charges[:, :, f])
            own += system.coefficients.follower[f] * np.einsum("xj,hqj->hxq", normal, pressures)
            first = system.causes + place * of.beside
            own[..., first : first + of.beside] += of.folded(induced)
            found.append(own)
        return np.stack(found, 1)

    # -- densities -----------------------------------------------------------------------------------------------------
    def _direct(self, number: int) -> tuple[Array, Array, Array, Array]:
        """What the kernels make of the densities of each field, both sides; c columns, the fields times both sides.

        Gradients at the contact's nodes (3, M, c), mean displacements (3, c), du_x/dx at the edges (2, c),
        displacements beside the contact less those at its edge (3, 2 n, c).
        """
        grid, nodes, fields = self.of.grid, self.basis.nodes, self._fields
        count, width = grid.count, 2 * grid.count
        if self.of._wide is None:
            zero = np.zeros((3, 2 * count, width * len(fields)))
            return zero[:, : nodes.size], zero[:, 0], zero[0, :2], zero
        X, h = np.concatenate([self._positions, nodes, -nodes]), float(self.half_lengths[number])
        mix = np.concatenate([mixing(0.0, np.eye(3)[1 + f]) for f in fields], 1)
        values = Densities(grid, self.of._wide, self.of.far).integrals(h, X, mix)
        found = []
        for place in range(len(fields)):
            part = values[:, 7 * place : 7 * place + 7]
            out, edges = part[: 2 * count], part[2 * count : 2 * count + 2]
            inside, mirrored = part[2 * count + 2 : -nodes.size], part[-nodes.size :]
            mirror = np.r_[count : 2 * count, :count]
            sign = np.array([-1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0])[:, None]  # gradients are odd, displacements even
            inside = np.concatenate([inside, sign * mirrored], -1)
            edges = np.concatenate([edges, sign * edges[::-1]], -1)
            out = np.concatenate([out, sign * out[mirror]], -1)
            moved = np.moveaxis(out[:, 4:] - np.repeat(edges[:, 4:], count, 0), 0, 1)
            slopes = h * np.moveaxis(out[:, :3], 0, 1)
            found.append((
                np.moveaxis(inside[:, :3], 0, 1),
                np.einsum("m,moc->oc", self.basis.mean, inside[:, 4:]),
                edges[:, 3],
                self._from_edge(moved, slopes[:, self._near]),
            ))  # fmt: skip
        gradients, mean, edge, outside = (np.concatenate([part[k] for part in found], -1) for k in range(4))
        return h * gradients, mean, h * edge, outside

    def _mean(self, number: int, f: int, smooth: Array) -> Array:
        """Displacements of the contact by densities of a field; (3, 2 n)."""
        c = self.of.system.coefficients
        start = self.of.system.starts(self.basis)[f]
        rises = np.tile(self.of.grid.rises, 2)
        own = self._assembly.displacements[number][:, start : start + self.basis.terms + 1] @ self._induced
        return np.asarray(smooth + own - c.compliance[:, 1 + f, None] / np.pi * rises)

    def _edge(self, number: int, f: int, smooth: Array) -> Array:
        """sigma_xx just outside the edges by densities of a field; (2, 2 n)."""
        system = self.of.system
        c, half, scale = system.coefficients, system.sliding.halfplane, system.kernel.stack.scale
        start, count = system.starts(self.basis)[f], self.of.grid.count
        strain = smooth + self._assembly.gradients[number][3][:, start : start + self.basis.terms + 1] @ self._induced
        here = np.zeros((2, 2 * count))
        here[0, :count] = here[1, count:] = self.of.grid.edge
        strain = strain - c.coupling[1 + f] * here
        share = half.in_plane_share[1 + f] * scale[1] / scale[2 + f]
        return np.asarray(float(half.in_plane_stiffness) * scale[0] ** 2 * strain + share * here)

    # -- beside the contact --------------------------------------------------------------------------------------------
    def _beside(self, unknowns: Array) -> Array:
        """u_y and the potentials of the fields, less those at the edge, per column; (half, 1 + field, n, column)."""
        system, basis, of = self.of.system, self.basis, self.of
        c, count = system.coefficients, of.grid.count
        X = self._positions[: of.beside]
        pressures, charges = system.split(basis, np.swapaxes(unknowns, 1, 2))
        signed = np.sinh(np.tile(of.grid.theta, of.sides)) * np.sign(X)
        pressed = basis.transforms(X)[0] * signed[:, None]
        integrated = np.concatenate(
            [of.grid.cumulative @ pressed[s * count : (s + 1) * count] for s in range(of.sides)]
        )
        normal = np.einsum("nj,hqj->hnq", integrated, pressures)
        orders = np.arange(basis.terms + 1)
        theta = of.grid.theta[:, None]
        with np.errstate(invalid="ignore"):
            charged = np.where(orders, np.expm1(-orders * theta) / np.maximum(orders, 1), -theta)
        charged = np.concatenate([charged, (-1.0) ** orders * charged])[: of.beside]
        carried = np.einsum("nj,hqfj->hfnq", charged, charges)
        smooth = self._smooth(unknowns)
        fields = np.array(self._fields, dtype=int)
        M = c.compliance[np.ix_(1 + fields, 1 + fields)]
        follow = c.lam / c.kap * (M @ c.friction_screening[fields])
        own = follow[:, None, None] * normal[:, None] + np.einsum("fg,hgnq->hfnq", M, carried[:, fields])
        raised = c.lam * normal + np.einsum("f,hfnq->hnq", c.screening[fields], own) + smooth[:, 0]
        return np.concatenate([raised[:, None], own + smooth[:, 1 + fields]], 1)

    def _smooth(self, unknowns: Array) -> Array:
        """(u_y, phi, psi) / h beside the contact less those at its edge, by the kernels; (half, 3, n, column)."""
        return np.asarray(
            np.einsum("honu,huq->honq", self._from_contact[:, :, : self.of.beside], unknowns, optimize=True)
        )

    @cached_property
    def _from_contact(self) -> Array:
        """The same of every unknown, both sides; (half, 3, 2 n, unknown)."""
        of, count = self.of, self.of.grid.count
        found = np.zeros((self.half_lengths.size, 3, 2 * count, of.system.unknowns(self.basis)))
        if of._wide is None:
            return found
        for columns, nodes, rule, carried in self._assembly.sources():
            mix = mixing(of.system.coefficients.friction, carried)
            for number, h in enumerate(self.half_lengths):
                u, slopes = (
                    np.einsum("tno,nz->otz", of.far(h * (X[:, None] - nodes), channels), rule, optimize=True)
                    for X, channels in ((self._positions, mix[:, 4:]), (self._positions[self._near], h * mix[:, :3]))
                )
                ends = np.repeat(u[:, -2:], count, 1)
                found[number, ..., columns] = self._from_edge(u[:, :-2] - ends, slopes)
        return found

    @property
    def _near(self) -> NDArray[np.intp]:
        """The nodes next to the edges, of both sides."""
        near = np.arange(self.of.grid.near)
        return np.concatenate([near, self.of.grid.count + near])

    def _from_edge(self, differences: Array, slopes: Array) -> Array:
        """Displacements less those at the edges, of both sides, from du/dX at ``_near``; (..., 2 n, c)."""
        grid = self.of.grid
        right, left = slopes[..., : grid.near, :], -slopes[..., grid.near :, :]
        sides = (differences[..., : grid.count, :], right), (differences[..., grid.count :, :], left)
        return np.concatenate([grid.from_edge(*side) for side in sides], -2)

    def _outside(self, number: int, f: int, smooth: Array) -> Array:
        """u_y and the potentials beside the contact by densities of a field; (1 + field, n, 2 n)."""
        system, of = self.of.system, self.of
        c, start = system.coefficients, system.starts(self.basis)[f]
        same, across = of.grid.green
        green = np.block([[same, across], [across, same]]) / np.pi
        fields = np.array(self._fields, dtype=int)
        own = c.compliance[1 + fields, 1 + f][:, None, None] * green
        induced = self._from_contact[number][..., start : start + self.basis.terms + 1] @ self._induced
        whole = smooth + induced
        raised = np.einsum("f,fnc->nc", c.screening[fields], own) + whole[0]
        return np.concatenate([raised[None], own + whole[1 + fields]])[:, : of.beside]


def operators(system: System, shortest: float, longest: float, farthest: float = 0.0) -> Operators:
    """Operators for half-lengths between two [m], with panels as far as the film's thickness matters.

    Parameters
    ----------
    system, shortest, longest
        As in :class:`Operators`.
    farthest
        X as far as which charges are not yet those of the open gap.
    """
    stack = system.kernel.stack
    whole = stack.thickness
    distance = max(30.0, 40 * whole / shortest, min(300.0, 2e3 * system.kernel.width / longest), farthest)
    even = system.coefficients.friction == 0 and system.degree == 1
    growing = bool(np.any(np.diagonal(low(stack))[2:]))
    return Operators(system, Grid.up_to(distance, GROWING if growing else LEVEL), even)
