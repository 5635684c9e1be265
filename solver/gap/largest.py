"""Largest pressure, charge density and field of a contact with air beside it."""

import numpy as np

from solver.arrays import Array
from solver.gap.airline import State
from solver.gap.operators import ANGLES, FIRST, PRESSURE, WITHIN
from solver.line.peakpressure import largest
from solver.line.system import SAMPLES

_SAMPLES = 129  # of a panel


def peak_pressure(state: State) -> float:
    """Largest contact pressure [Pa]."""
    samples = state.outputs[PRESSURE]
    series = np.polynomial.chebyshev.chebfit(SAMPLES, samples, SAMPLES.size // 2)
    contact = state.problem.contact
    return float(largest(np.asarray(series[None], dtype=np.float64), contact.exponent)[0] / contact.scale[1])


def peak_density(state: State, field: int) -> float:
    """Largest abs(D_y) [C/m2] or abs(B_y) [T] on the contact and beside it."""
    place = state.problem.fields.index(field)
    start = FIRST + state.problem.nodes * (1 + len(state.problem.fields)) + place * ANGLES.size
    within = state.outputs[start : start + ANGLES.size]
    return max(peak_of_panels(within.reshape(-1, WITHIN)), _exterior(state, place)) / float(
        state.problem.contact.scale[2 + field]
    )


def gap_field(state: State, field: int) -> float:
    """Largest field in the gap [V/m, A/m]."""
    density = _exterior(state, state.problem.fields.index(field)) / float(state.problem.contact.scale[2 + field])
    return density / float(state.problem.permittivity[field])


def _exterior(state: State, place: int) -> float:
    grid = state.problem.table.operators.grid
    nodes = grid.count // grid.panels
    densities = state.densities[place].reshape(-1, grid.panels, nodes)
    at_edge = densities[:, 0] @ grid.edge[:nodes]
    return max(peak_of_panels(densities[:, :-1].reshape(-1, nodes)), float(np.max(np.abs(at_edge))))


def peak_of_panels(values: Array) -> float:
    """Largest absolute value of polynomials by their values at Gauss's nodes; (panel, node)."""
    count = values.shape[1]
    nodes = np.polynomial.legendre.leggauss(count)[0]
    series = np.linalg.solve(np.polynomial.legendre.legvander(nodes, count - 1), values.T)
    return _top(np.polynomial.legendre.legval(np.linspace(-1, 1, _SAMPLES), series))


def _top(samples: Array) -> float:
    """Largest absolute value of curves by samples at even distances, between them by parabolas; (curve, sample)."""
    sizes = np.abs(samples)
    before, middle, after = sizes[:, :-2], sizes[:, 1:-1], sizes[:, 2:]
    top = (middle >= before) & (middle >= after)
    bend = np.where(top, before - 2 * middle + after, -1.0)
    rise = (after - before)[top] ** 2 / (-8 * np.where(bend < 0, bend, -1.0)[top])
    return float(max(np.max(sizes), np.max(middle[top] + rise, initial=0.0)))
