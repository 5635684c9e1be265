"""One point contact with air beside it: Newton's iteration on its radius, its place and the densities (points, 6).

Beside the contact D (profile - depth - u_y) (1 + r^2/end^2) = eps0 (phi - V), and the same with B, mu0 and psi. Unknown
are log a, u0 = (-depth, V, Psi) over C a^e, and the densities at the nodes over their size. Tangents follow from the
same linear system: the edge moves with them.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.gap.newton import is_open, iterated, opened, reopened, solved
from solver.gap.refusal import GapError, require_open
from solver.gap.ringoperators import RingsByRadius, Rows
from solver.gap.rings import Rings
from solver.point.profile import Shape


@dataclass(frozen=True, eq=False)
class AirPoint:
    """A punch with air beside it, in the units of the body; lengths over that of the body."""

    operators: RingsByRadius
    coefficient: float
    force: float
    prescribed: Array
    held: tuple[bool, ...]
    media: Array
    end: float
    start: float
    near: Array | None = None

    @property
    def rows(self) -> Rows:
        """Places of the outputs."""
        return self.operators.exact.rows

    @property
    def rings(self) -> Rings:
        """Panels beside the contact."""
        return self.operators.exact.rings

    @property
    def shape(self) -> Shape:
        """The punch."""
        return self.operators.exact.shape

    @cached_property
    def profile(self) -> Array:
        """Gap of the profile over C a^e where the surface is flat, which scales the law; (n,)."""
        return self.shape.rise * self.rings.power(self.shape.exponent)

    @cached_property
    def state(self) -> "PointState":
        """The solution."""
        result = self._solution
        if result is None:
            raise GapError("surroundings: no contact with air beside it is found for this force and these charges")
        result.require_gap()
        return result

    @property
    def within(self) -> "PointState | None":
        """The solution, where there is one and the operators were made for its radius."""
        result = self._solution
        return result if result and is_open(result) and self.operators.holds(float(result.unknowns[0])) else None

    @cached_property
    def _solution(self) -> "PointState | None":
        result = None if self.near is None else self._sought(PointState(self, self.near))
        if result is None or not is_open(result):  # from afar Newton's iteration may come to a gap that is closed
            result = self._sought(PointState(self, self._first))
        return opened(result, self._sought)

    def _sought(self, state: "PointState") -> "PointState | None":
        """Limit of Newton's iteration."""

        def step(state: PointState, _last: float) -> Array:
            return solved(state.jacobian, state.residual)

        return iterated(state, step, 1, quadratic=True)

    @property
    def _first(self) -> Array:
        """Unknowns of the contact without air, with the densities that its potentials make at its gap."""
        rows = self.rows
        unknowns = np.zeros(1 + len(rows.channels) + len(rows.fields) * rows.nodes)
        unknowns[0] = np.log(self.start)
        for _ in range(2):
            state = PointState(self, unknowns)
            # with force and gap fixed the equations are linear
            unknowns[1:] -= solved(state.frozen[1:, 1:], state.residual[1:])
        return unknowns


@dataclass(frozen=True, eq=False)
class PointState:
    """Residual, tangents and outputs of :class:`AirPoint` at unknowns (log a, u0 over C a^e, densities over size)."""

    problem: AirPoint
    unknowns: Array

    def moved(self, unknowns: Array) -> "PointState":
        """The same contact at other unknowns."""
        return PointState(self.problem, unknowns)

    @property
    def radius(self) -> float:
        """a."""
        return float(np.exp(self.unknowns[0]))

    @cached_property
    def size(self) -> float:
        """C a^e."""
        return float(self.problem.coefficient * self.radius**self.problem.shape.exponent)

    @property
    def displacement(self) -> Array:
        """(-depth, V, Psi) over C a^e of the channels; (channel,)."""
        return self.unknowns[1 : self.problem.rows.causes]

    @property
    def densities(self) -> Array:
        """D_y and B_y over C a^(e-1) at the nodes; (field, n)."""
        return self.over_size * self.problem.rings.size

    @property
    def over_size(self) -> Array:
        """The same over their size; (field, n)."""
        rows = self.problem.rows
        return self.unknowns[rows.causes :].reshape(len(rows.fields), rows.nodes)

    @property
    def columns(self) -> Array:
        """u0, the profile and the densities over their size: factors of the operators' columns; (column,)."""
        first = self.problem.rows.causes
        return np.concatenate([self.unknowns[1:first], [1.0], self.unknowns[first:]])

    @cached_property
    def _read(self) -> tuple[Array, Array]:
        return self.problem.operators.read(float(self.unknowns[0]))

    @cached_property
    def outputs(self) -> Array:
        """Rows of :mod:`solver.gap.ringoperators` up to the pressures; (row,)."""
        return np.asarray(self._read[0] @ self.columns)

    @cached_property
    def inside(self) -> Array:
        """The rows from the pressures on; (row,)."""
        return np.asarray(self.problem.operators.read_inside(float(self.unknowns[0])) @ self.columns)

    @cached_property
    def _rates(self) -> Array:
        """Derivatives of the rows in the unknowns; (row, unknown)."""
        value, rate = self._read
        first = self.problem.rows.causes
        return np.concatenate([(rate @ self.columns)[:, None], value[:, : first - 1], value[:, first:]], 1)

    def _exterior(self, rows: Array) -> tuple[Array, Array]:
        """u_y and the potentials beside the contact less those at the edge; (n, ...) and (field, n, ...)."""
        layout = self.problem.rows
        part = rows[layout.raised : layout.pressure.start].reshape(len(layout.channels), layout.nodes, *rows.shape[1:])
        return part[0], part[1:]

    @cached_property
    def gap(self) -> Array:
        """Gap over C a^e at the nodes; (n,)."""
        return np.asarray(self.problem.profile - self._exterior(self.outputs)[0])

    @cached_property
    def thinned(self) -> Array:
        """Factor 1/(1 + r^2/end^2) by which the finite punch weakens the gap's field; (n,)."""
        return 1 / (1 + (self.problem.rings.grid.distance * self.radius / self.problem.end) ** 2)

    @cached_property
    def conductance(self) -> Array:
        """Density over its size per potential, times the gap over the profile's; (field, n)."""
        share = self.thinned / (self.problem.rings.size * self.problem.profile) * self.radius / self.size
        return np.asarray(self.problem.media[:, None] * share)

    @cached_property
    def residual(self) -> Array:
        """Zero where it is a contact: force, smooth edge, charges or potentials, and the gap's law at the nodes."""
        rows, load = self.problem.rows, self.size * self.radius
        force = load * self.outputs[0] / self.problem.force + 1
        closings = [self._closing(place) for place in range(len(rows.fields))]
        law = self.over_size * self.gap / self.problem.profile - self.conductance * self._exterior(self.outputs)[1]
        return np.concatenate([[force, self.outputs[rows.edges][0], *closings], law.ravel()])

    def _closing(self, place: int) -> float:
        if self.problem.held[place]:
            return float(self.displacement[1 + place] - self.problem.prescribed[place] / self.size)
        return float(self.outputs[1 + place] + self.problem.prescribed[place] / (self.size * self.radius))

    @cached_property
    def jacobian(self) -> Array:
        """Derivatives of the residual; (unknown, unknown)."""
        return self._linearised(moved=True)

    @cached_property
    def frozen(self) -> Array:
        """The same where the gap does not follow."""
        return self._linearised(moved=False)

    def _linearised(self, *, moved: bool) -> Array:
        rows, e, load = self.problem.rows, self.problem.shape.exponent, self.size * self.radius
        matrix = np.zeros((self.unknowns.size, self.unknowns.size))
        matrix[0] = load * self._rates[0] / self.problem.force
        matrix[0, 0] += (e + 1) * load * self.outputs[0] / self.problem.force
        matrix[1] = self._rates[rows.edges][0]
        potentials = self._exterior(self._rates)[1]
        n, first = rows.nodes, rows.causes
        for place in range(len(rows.fields)):
            if self.problem.held[place]:
                matrix[2 + place, 2 + place] = 1.0
                matrix[2 + place, 0] = e * self.problem.prescribed[place] / self.size
            else:
                matrix[2 + place] = self._rates[1 + place]
                matrix[2 + place, 0] -= (e + 1) * self.problem.prescribed[place] / load
            block = slice(first + place * n, first + (place + 1) * n)
            conductance = self.conductance[place]
            law = -conductance[:, None] * potentials[place]
            law[:, 0] -= conductance * (1 - e - 2 * (1 - self.thinned)) * self._exterior(self.outputs)[1][place]
            if moved:
                law -= (self.over_size[place] / self.problem.profile)[:, None] * self._exterior(self._rates)[0]
            law[:, block][np.diag_indices(n)] += self.gap / self.problem.profile
            matrix[block] = law
        return matrix

    @cached_property
    def sizes(self) -> Array:
        """Scales of the unknowns, over which steps are measured; (unknown,)."""
        causes = np.maximum(np.abs(self.displacement), 1e-3 * np.max(np.abs(self.displacement)))
        largest = np.max(np.abs(self.over_size), 1, initial=1e-300)
        largest = np.maximum(largest, 1e-3 * self.problem.force / (self.size * self.radius))
        return np.concatenate([[1.0], causes, np.repeat(largest, self.problem.rows.nodes)])

    @property
    def reopened(self) -> Array:
        """Unknowns with densities that open a gap which is closed next to the edge; (unknown,)."""
        return np.concatenate([self.unknowns[: self.problem.rows.causes], reopened(self.over_size, self.gap).ravel()])

    def require_gap(self) -> None:
        """Refuse a gap that closes, as :func:`solver.gap.refusal.require_open`."""
        require_open(self.gap, self.problem.profile, self.problem.rings.grid.distance, "r/a")

    # -- outputs, in the units of the body -----------------------------------------------------------------------------
    @property
    def loads(self) -> Array:
        """P and the charges of the fields; (channel,)."""
        return np.asarray(-self.outputs[self.problem.rows.loads] * self.size * self.radius)

    @cached_property
    def flexibility(self) -> Array:
        """d (-depth, V, Psi) / d (P, T, J) of the channels with the edge moving; (channel, channel)."""
        matrix, load = self._with_charges_given, self.size * self.radius
        count = len(self.problem.rows.channels)
        right = np.zeros((self.unknowns.size, count))
        right[0, 0] = load * self.outputs[0] / self.problem.force**2
        right[2 + np.arange(count - 1), 1 + np.arange(count - 1)] = -1 / load
        return self._moved(solved(matrix, right))

    @cached_property
    def at_fixed_contact(self) -> Array:
        """d (V, Psi) / d (T, J) at a fixed radius, whose force and gap follow; (field, field)."""
        matrix, load = np.array(self._with_charges_given), self.size * self.radius
        matrix[0] = 0.0
        matrix[0, 0] = 1.0
        count = len(self.problem.rows.fields)
        right = np.zeros((self.unknowns.size, count))
        right[2 + np.arange(count), np.arange(count)] = -1 / load
        return self._moved(solved(matrix, right))[1:]

    def _moved(self, steps: Array) -> Array:
        """Changes of (-depth, V, Psi) for steps of the unknowns."""
        inner = self.problem.rows.causes
        return np.asarray(
            self.size * (steps[1:inner] + self.problem.shape.exponent * self.displacement[:, None] * steps[0])
        )

    @cached_property
    def _with_charges_given(self) -> Array:
        rows = self.problem.rows
        matrix = np.array(self.jacobian)
        for place in range(len(rows.fields)):
            matrix[2 + place] = self._rates[1 + place]
            matrix[2 + place, 0] += (self.problem.shape.exponent + 1) * self.outputs[1 + place]
        return matrix
