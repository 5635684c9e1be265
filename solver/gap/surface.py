"""Fields along the surface of a contact with air beside it, on it and beside it (theory section 10)."""

import numpy as np

from solver.arrays import Array, ComplexArray
from solver.gap.state import State
from solver.gap.tractions import Solved
from solver.line.surface import local_fields, of_local


def surface_fields(state: State, positions: Array) -> dict[str, Array]:
    """Fields of one case at positions X = (x - c)/h, finite and never exactly +-1; (1, position) each.

    positions: (position,), X.
    """
    solved, X = Solved(state, positions), positions
    system, beyond = solved.system, np.abs(positions) > 1
    c, whole = system.coefficients, local_fields(solved.assembly)[0] @ solved.unknowns
    smooth = solved.assembly.gradients[0] @ solved.drawn + solved.carried(X)
    charges, H = np.zeros((2, 3, X.size))
    charges[1:, beyond], charges[1:, ~beyond] = solved.beside.at(X[beyond]), solved.beside.drawn(X[~beyond])
    on_it: ComplexArray = np.asarray(X[beyond], dtype=np.complex128)
    H[1:, beyond] = solved.beside.transforms(on_it).real  # within the contact it is zero
    whole[:3] += charges
    whole[3:] += smooth[1:]
    whole[3:5] += c.compliance[1:] @ H
    whole[5] -= c.coupling @ charges
    for f in c.fields:
        whole[3 + f, ~beyond] = 0.0  # an equipotential
    return of_local(system, whole[None])
