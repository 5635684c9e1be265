"""Linear operators of line contacts in air and of their exterior charges, tabulated over log h (theory section 10).

The half-plane's part is closed (:mod:`solver.gap.grid`); the layers' smooth kernels give the contact's system a right
side. Powers of the half-length are taken out; units are those of the stack.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from approximation.chebyshev import gauss_points, interpolation
from solver.arrays import Array
from solver.gap.densities import enough, far, sampled
from solver.gap.grid import CLOSE, GROWING, LEVEL, Grid, gauss
from solver.gap.newton import SplitOutputs
from solver.halfplane.pressing import ContactError
from solver.line import outputs
from solver.line.basis import Basis
from solver.line.contact import FilmContact
from solver.line.kernel import Kernel, kernel
from solver.line.outputs import Assembly, mixing
from solver.line.system import System
from solver.line.table import Table, batches
from solver.stack.reflection import low

_REACH = 8e4  # strip widths to which kernels are tabulated: beyond, they are their logarithm
_SIGNS = np.array([-1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0])  # of mirror images: gradients of (y, phi, psi) are odd
_NEGLIGIBLE = 1e-13  # kernel over the compliance of a stack that is a half-plane
#: Rows: load, balance, displacements, exterior displacements; then edge stresses and pressures over their weight.
LOAD, BALANCE, DISPLACEMENT = 0, 1, slice(2, 5)
SOLVING: int = DISPLACEMENT.stop
_EDGE = slice(SOLVING, SOLVING + 2)  # among the contact's rows alone
#: Angles within the contact, X = cos(angle), at which densities are output: panels graded to both edges.
_ENDS = (0.004, 0.012, 0.035, 0.1, 0.25, 0.55, 1.0)
WITHIN = 8  # nodes of a panel
_HALF = gauss(np.array([*_ENDS, np.pi / 2]), WITHIN)[0]
ANGLES = np.concatenate([_HALF, np.pi - _HALF])
_CONTACT_ROWS = [outputs.LOAD, outputs.BALANCE, *range(*outputs.DISPLACEMENT.indices(99)),
                 *range(*outputs.EDGE_STRESS.indices(99)), *range(*outputs.PRESSURE.indices(999))]  # fmt: skip


@dataclass(frozen=True, eq=False)
class Operators:
    """Operators of one system at any half-length."""

    system: System
    grid: Grid
    even: bool  # Whether both sides have the same densities

    @property
    def sides(self) -> int:
        """Number of sides whose densities are unknowns."""
        return 1 if self.even else 2

    @property
    def density_nodes(self) -> int:
        """Number of nodes whose densities are unknowns."""
        return self.sides * self.grid.count

    @property
    def positions(self) -> Array:
        """Return X of the nodes whose densities are unknowns; (n,)."""
        return np.concatenate([self.grid.distance, -self.grid.distance])[: self.density_nodes]

    @property
    def columns(self) -> int:
        """Number of causes and densities."""
        return self.system.causes + len(self.system.fields) * self.density_nodes

    @property
    def rows(self) -> int:
        """Number of outputs."""
        return self.solving + len(_CONTACT_ROWS) - SOLVING + ANGLES.size * len(self.system.fields)

    @property
    def solving(self) -> int:
        """Number of leading outputs that the equations need."""
        return SOLVING + self.density_nodes * (1 + len(self.system.fields))

    @cached_property
    def _wide(self) -> Kernel | None:
        """Kernels up to the farthest charges; None for a stack that is a half-plane."""
        stack, narrow = self.system.kernel.stack, self.system.kernel
        if np.max(np.abs(narrow.positive.series)) < _NEGLIGIBLE:
            return None
        return kernel(stack, float(max(_REACH * narrow.width, narrow.reach)), by_distance=True)

    def matrices(self, half_lengths: Array) -> Array:
        """Outputs of every cause and density at half-lengths [m]; (half, row, column)."""
        result = np.empty((half_lengths.size, self.rows, self.columns))
        for basis, members in batches(self.system, half_lengths):
            result[members] = _Assembled(self, basis, half_lengths[members]).outputs
        return result

    def folded(self, values: Array) -> Array:
        """Sum columns of densities on both sides, (..., field side n), to those of the unknown densities."""
        sides = values.reshape(*values.shape[:-1], -1, 2, self.grid.count)
        return sides.sum(-2).reshape(*values.shape[:-1], -1) if self.even else values


@dataclass(frozen=True, eq=False)
class _Assembled:
    """Operators at half-lengths that share a basis."""

    operators: Operators
    basis: Basis
    half_lengths: Array

    @property
    def _fields(self) -> tuple[int, ...]:
        return self.operators.system.fields

    @cached_property
    def _assembly(self) -> Assembly:
        return Assembly(self.operators.system, self.basis, self.half_lengths)

    @cached_property
    def _induced(self) -> Array:
        """Coefficients of T_n / sqrt(1 - X^2) in the charge that the right and left sides induce; (M + 1, 2 n)."""
        right = self.operators.grid.induced_terms(self.basis.terms + 1)
        return np.concatenate([right, (-1.0) ** np.arange(len(right))[:, None] * right], 1)

    @property
    def outputs(self) -> Array:
        """Outputs at every half-length; (half, row, column)."""
        operators, system, assembly, basis = self.operators, self.operators.system, self._assembly, self.basis
        direct = [self._direct(number) for number in range(self.half_lengths.size)]
        gradients, displacement, edge, outside = (np.stack(parts) for parts in zip(*direct, strict=True))
        c, half, scale = system.coefficients, system.sliding.halfplane, system.kernel.stack.scale
        grid, count, fields = operators.grid, operators.grid.count, [1 + f for f in self._fields]
        green = np.block([[grid.green[0], grid.green[1]], [grid.green[1], grid.green[0]]]) / np.pi
        at_edges = np.zeros((2, 2 * count))
        at_edges[0, :count] = at_edges[1, count:] = grid.edge
        stiffness = float(half.in_plane_stiffness) * scale[0] ** 2
        for row, (f, start) in enumerate(system.starts(basis).items()):
            part, block = slice(2 * row * count, 2 * (row + 1) * count), slice(start, start + basis.terms + 1)
            gradients[..., part] += assembly.at_nodes[..., block] @ self._induced
            of_contact = assembly.displacements[..., block] @ self._induced
            displacement[..., part] += of_contact - c.compliance[:, 1 + f, None] / np.pi * np.tile(grid.rises, 2)
            strain = edge[..., part] + assembly.gradients[:, 3, :, block] @ self._induced - c.coupling[1 + f] * at_edges
            share = half.in_plane_share[1 + f] * scale[1] / scale[2 + f]
            edge[..., part] = stiffness * strain + share * at_edges
            outside[..., part] += self._from_contact[..., block] @ self._induced
            outside[:, fields, :, part] += c.compliance[fields, 1 + f][:, None, None] * green
            outside[:, 0, :, part] += (c.screening[list(self._fields)] @ c.compliance[fields, 1 + f]) * green
        unknowns = system.solve(basis, assembly.at_nodes, sources=operators.folded(gradients))
        contact = outputs.functionals(assembly)[:, _CONTACT_ROWS] @ unknowns
        exterior, charges = self._exterior(unknowns), slice(system.causes, None)
        contact[:, DISPLACEMENT, charges] += operators.folded(displacement)
        contact[:, _EDGE, charges] += operators.folded(edge)
        exterior[..., charges] += operators.folded(outside[:, [0, *fields], : operators.density_nodes])
        shape = (self.half_lengths.size, -1, contact.shape[-1])
        parts = (part.reshape(shape) for part in (exterior, contact[:, SOLVING:], self._within(unknowns)))
        return np.concatenate([contact[:, :SOLVING], *parts], 1)

    def _within(self, unknowns: Array) -> Array:
        """D_y and B_y of the conducted fields at ``ANGLES``; (half, field, angle, column)."""
        system, basis, operators = self.operators.system, self.basis, self.operators
        X, sine = np.cos(ANGLES), np.sin(ANGLES)
        normal = basis.weight(X)[:, None] * basis.pressure_factor(X)
        series = np.cos(ANGLES[:, None] * np.arange(basis.terms + 1)) / sine[:, None]
        induced = np.concatenate([operators.grid.induced(X), operators.grid.induced(-X)], 1) / sine[:, None]
        result = []
        for row, (f, start) in enumerate(system.starts(basis).items()):
            density = series @ unknowns[:, start : start + basis.terms + 1]
            density += system.coefficients.follower[f] * normal @ unknowns[:, : basis.pressures]
            first = system.causes + row * operators.density_nodes
            density[..., first : first + operators.density_nodes] += operators.folded(induced)
            result.append(density)
        return np.stack(result, 1)

    # -- densities -----------------------------------------------------------------------------------------------------
    def _direct(self, number: int) -> tuple[Array, Array, Array, Array]:
        """Kernel integrals of the densities, c columns of fields and sides.

        Gradients at the contact's nodes (3, M, c), mean displacements (3, c), du_x/dx at the edges (2, c), exterior
        displacements less those at the edge (3, 2 n, c).
        """
        grid, nodes, count = self.operators.grid, self.basis.nodes, self.operators.grid.count
        size, h, wide = len(self._fields), float(self.half_lengths[number]), self.operators._wide
        if wide is None:
            zero = np.zeros((3, 2 * count, 2 * count * size))
            return zero[:, : nodes.size], zero[:, 0], zero[0, :2], zero
        points, interpolated = self._samples(number)
        samples, distant = sampled(wide, grid, self._fields, h, points)
        samples = samples.reshape(-1, size, 7, count)
        if interpolated is None:
            near, mirrored = np.split(samples, 2)
        else:
            near, mirrored = np.tensordot(interpolated, samples, 1), np.tensordot(interpolated[:, ::-1], samples, 1)
        near = np.concatenate([near, _SIGNS[:, None] * mirrored], -1)  # (target, field, 7, 2 n)
        distant = distant.reshape(2, -1, size, 3, count)
        differences = self._less_edges(near[..., 4:, :], np.concatenate([distant, distant[::-1]], -1))
        inside, edges = near[-nodes.size :], near[2 * grid.close : 2 * grid.close + 2]
        slopes = h * near[self._next_to_edges, :, :3]
        return (
            h * _flat(inside[:, :, :3]),
            _flat(np.tensordot(self.basis.mean, inside[:, :, 4:], 1)[None])[:, 0],
            h * edges[:, :, 3].reshape(2, -1),
            self._from_edge(_flat(differences), _flat(slopes)),
        )

    def _samples(self, number: int) -> tuple[tuple[float, ...], Array | None]:
        """Points X that resolve the kernels near the contact, and the interpolation matrix from them to the targets.

        Targets: nodes close to the right and left edge, the edges, the contact's nodes. None: points are the targets,
        then their mirror images.
        """
        wide, X = self.operators._wide, self.operators.grid.distance[: self.operators.grid.close]
        assert wide is not None
        targets = np.concatenate([X, -X, [1.0, -1.0], self.basis.nodes])
        count = enough(wide.smoothness / float(self.half_lengths[number]), 2 * CLOSE)
        if count < targets.size:  # a narrow contact
            return tuple((CLOSE * gauss_points(count)).tolist()), interpolation(count, targets / CLOSE)
        return (*targets.tolist(), *(-targets).tolist()), None

    def _less_edges(self, near: Array, distant: Array) -> Array:
        """Displacements at all nodes less those at their edges, from ``near`` targets and (side, node, ...)."""
        close = self.operators.grid.close
        sides = [
            np.concatenate([near[side * close : (side + 1) * close], distant[side]]) - near[2 * close + side]
            for side in (0, 1)
        ]
        return np.concatenate(sides)

    @property
    def _next_to_edges(self) -> NDArray[np.intp]:
        """Indices of the nodes next to the edges among the targets of ``_samples``."""
        near = np.arange(self.operators.grid.near)
        return np.concatenate([near, self.operators.grid.close + near])

    # -- exterior ------------------------------------------------------------------------------------------------------
    def _exterior(self, unknowns: Array) -> Array:
        """Exterior u_y and potentials less those at the edge; (half, 1 + field, n, column)."""
        count = self.operators.density_nodes
        rows = self._local + self._from_contact[:, [0, *(1 + f for f in self._fields)], :count]
        return np.asarray((rows.reshape(rows.shape[0], -1, rows.shape[-1]) @ unknowns).reshape(*rows.shape[:3], -1))

    @cached_property
    def _local(self) -> Array:
        """Half-plane's part of exterior u_y and potentials less those at the edge; (1 + field, n, unknown)."""
        system, basis, operators = self.operators.system, self.basis, self.operators
        c, count, X = system.coefficients, operators.grid.count, operators.positions
        signed = np.sinh(np.tile(operators.grid.theta, operators.sides)) * np.sign(X)
        pressed = (basis.transforms(X)[0] * signed[:, None]).reshape(operators.sides, count, -1)
        orders, theta = np.arange(basis.terms + 1), operators.grid.theta[:, None]
        with np.errstate(invalid="ignore"):
            charged = np.where(orders, np.expm1(-orders * theta) / np.maximum(orders, 1), -theta)
        fields = np.array(self._fields, dtype=int)
        M = c.compliance[np.ix_(1 + fields, 1 + fields)]
        result = np.zeros((1 + fields.size, operators.density_nodes, system.unknowns(basis)))
        normal = (operators.grid.cumulative @ pressed).reshape(operators.density_nodes, -1)
        result[1:, :, : basis.pressures] = (c.lam / c.kap * (M @ c.friction_screening[fields]))[:, None, None] * normal
        both_sides = np.concatenate([charged, (-1.0) ** orders * charged])[: operators.density_nodes]
        for row, start in enumerate(system.starts(basis).values()):
            result[1:, :, start : start + basis.terms + 1] = M[:, row, None, None] * both_sides
        result[0] = np.tensordot(c.screening[fields], result[1:], 1)
        result[0, :, : basis.pressures] += c.lam * normal
        return result

    @cached_property
    def _from_contact(self) -> Array:
        """Layers' part of exterior (u_y, phi, psi) / h less those at the edge; (half, 3, 2 n, unknown)."""
        operators, grid, wide = self.operators, self.operators.grid, self.operators._wide
        result = np.zeros((self.half_lengths.size, 3, 2 * grid.count, operators.system.unknowns(self.basis)))
        if wide is None:
            return result
        distant_X = np.concatenate([grid.distance[grid.close :], -grid.distance[grid.close :]])
        sources = self._assembly.sources()
        for group in (sources[:1], sources[1:]):  # the charges of all fields lie at the same nodes
            nodes, rule = group[0][1], group[0][2]
            friction, channels = operators.system.coefficients.friction, [0, 1, 2, 4, 5, 6]
            mix = np.stack([mixing(friction, source[3])[:, channels] for source in group], 1)
            for number, h in enumerate(self.half_lengths.tolist()):
                points, interpolated = self._samples(number)
                targets = np.array(points if interpolated is not None else points[: len(points) // 2])
                near = far(wide, h * (targets[:, None] - nodes), mix.reshape(19, -1))
                near = near if interpolated is None else np.tensordot(interpolated, near, 1)
                near = np.tensordot(near, rule, (1, 0)).reshape(-1, len(group), 6, rule.shape[1])
                distant = far(wide, h * (distant_X[:, None] - nodes), mix[..., 3:].reshape(19, -1))
                distant = np.tensordot(distant, rule, (1, 0)).reshape(2, -1, len(group), 3, rule.shape[1])
                differences = np.moveaxis(self._less_edges(near[:, :, 3:], distant), 0, 2)
                slopes = h * np.moveaxis(near[self._next_to_edges, :, :3], 0, 2)
                for (columns, *_), displaced in zip(group, self._from_edge(differences, slopes), strict=True):
                    result[number, ..., columns] = displaced
        return result

    def _from_edge(self, differences: Array, slopes: Array) -> Array:
        """Displacements of both sides less those at the edges, by du/dX next to the edges; (..., 2 n, c)."""
        grid = self.operators.grid
        right, left = slopes[..., : grid.near, :], -slopes[..., grid.near :, :]
        sides = (differences[..., : grid.count, :], right), (differences[..., grid.count :, :], left)
        return np.concatenate([grid.from_edge(*side) for side in sides], -2)


def _flat(values: Array) -> Array:
    """Rearrange (target, field, channel, n) as (channel, target, field n)."""
    return np.moveaxis(values, 2, 0).reshape(values.shape[2], values.shape[0], -1)


_LARGEST = 0.5e9  # bytes of a table, of which some copies exist while it is made; usual ones take 0.01 to 0.2 GB
_MARGIN, _MARGIN_OF_BASE = 10.0, 3.0  # start of the last panel over the distances of ``farthest``


@dataclass(frozen=True, eq=False)
class AirTable:
    """Operators at the half-lengths of a table, interpolated by Chebyshev polynomials in log h."""

    table: Table
    farthest: float = 0.0  # Least X at which the infinite panel starts
    clipped: bool = True  # Whether half-lengths beyond the table have the outputs of its end

    @cached_property
    def operators(self) -> Operators:
        """Operators at any half-length of the table."""
        system = self.table.system
        even = system.coefficients.friction == 0 and system.degree == 1
        return Operators(system, grid_of(system, self.table.lower, self.table.upper, self.farthest), even)

    @cached_property
    def outputs(self) -> SplitOutputs:
        """Outputs at the half-lengths; edge stresses, pressures over weight and densities are only reported."""
        operators = self.operators
        size = 8.0 * self.table.half_lengths.size * operators.rows * operators.columns
        if size > _LARGEST:
            raise ContactError(
                "surroundings: charges spread so far beside the contact that their table would take "
                f"{size / 1e9:.3g} GB; at most {_LARGEST / 1e9:g} GB; must be insulated"
            )
        values, interval = operators.matrices(self.table.half_lengths), self.table.interval
        return SplitOutputs.of(values, operators.solving, interval, clipped=self.clipped)

    @cached_property
    def powers(self) -> Array:
        """Integrals of X^m from the edge to the nodes of the unknown densities; (n, degree + 1)."""
        operators = self.operators
        m = np.arange(1, operators.system.degree + 2)
        right = np.expm1(m * np.log1p(2 * np.sinh(operators.grid.theta / 2) ** 2)[:, None]) / m
        return np.concatenate([right, (-1.0) ** m * right])[: operators.density_nodes]

    @cached_property
    def size(self) -> Array:
        """Densities over the unknowns at the nodes; (n,)."""
        return np.tile(self.operators.grid.size, self.operators.sides)


def grid_of(system: System, shortest: float, longest: float, farthest: float = 0.0) -> Grid:
    """Exterior panels for contacts of half-lengths between two [m], as far as the film's thickness matters."""
    stack = system.kernel.stack
    distance = max(30.0, 40 * stack.thickness / shortest, min(300.0, 2e3 * system.kernel.width / longest), farthest)
    growing = bool(np.any(np.diagonal(low(stack))[2:]))
    return Grid.up_to(distance, GROWING if growing else LEVEL)


def farthest(contact: FilmContact, permittivity: Array) -> Array:
    """Return X beyond which exterior charges are those of a wide gap, 0 or a power of four; (case,)."""
    # permittivity: electric and magnetic, of the gas in the gaps, (case, 2)
    # Over a film it is where the gap passes less than the film, D = eps0 V/(g + eps0 thickness/eps): the last panel,
    # whose terms are powers of 1/X, starts at ten times that distance, which errs by 1e-6 of the charges. Over a base
    # whose potential grows it is where the gap is x eps0/eps, and the panel has the logarithms of that.
    system, scale = contact.table.system, contact.scale
    stack, slope = system.kernel.stack, np.abs(contact.loading.slope[:, 1:])
    below, reach = np.diagonal(low(stack)), np.zeros(len(slope))
    order = 1 + np.arange(slope.shape[1])
    positive = np.where(slope > 0, slope, np.nan)  # powers that the profile has
    for f in system.fields:
        medium = (permittivity[:, f] * scale[2 + f] ** 2 / scale[1])[:, None]
        film = medium * abs(float(system.coefficients.compliance[1 + f, 1 + f])) * stack.thickness
        base = medium * abs(float(below[2 + f]))
        over_film = np.nanmin(((order + 1) * film / positive) ** (1 / (order + 1)), 1)
        over_base = np.nanmin(((order + 1) * base / positive) ** (1 / order), 1)
        reach = np.maximum(reach, np.maximum(_MARGIN * over_film, _MARGIN_OF_BASE * over_base))
    needed = reach / contact.half_width
    return np.where(needed > 1, 4.0 ** np.ceil(np.log(np.maximum(needed, 1.0)) / np.log(4.0)), 0.0)
