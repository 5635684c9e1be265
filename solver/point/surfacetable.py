"""What the layers of a film add to the stresses in its surface, over windows of radii (points, 5).

The half-space of the top answers the tractions at their place; what the layers below add is smooth in the place and in
log a: sums over wavenumbers at the nodes of a window, once for each set of places.
"""

from functools import lru_cache

import numpy as np

from approximation.chebyshev import coefficients
from solver.arrays import Array
from solver.point.body import Film
from solver.point.inside import Inside
from solver.point.pressed import Contact
from solver.point.table import PointKind, window
from solver.point.tractions import Tractions

_STRESSES = ("stress_xx", "stress_zz")
_KEPT = 16  # of a hundred places 0.1 MB each


def added_stresses(contact: Contact, positions: Array) -> Array:
    """What the layers add to sigma_rr and sigma_tt at r/a, SI; (case, 2, position)."""
    body = contact.pressed.body
    if not isinstance(body, Film):
        return np.zeros((contact.radius.size, 2, 1))
    places = tuple(positions.tolist())
    read = body.gathered(contact.radius, lambda of, at, _: of.polynomials(at) @ _series(of.kind, of.number, places))
    causes = contact.state.causes * (contact.size / contact.radius)[:, None]
    return np.asarray(np.einsum("ckd,cd->ck", read.reshape(len(read), -1, 4), causes)).reshape(len(read), 2, -1)


@lru_cache(_KEPT)
def _series(kind: PointKind, number: int, positions: tuple[float, ...]) -> Array:
    """Chebyshev coefficients per (u0, g) over C a^e; (node, stress and position and cause)."""
    of, inside, places = window(kind, number), Inside(kind.film.stack()), np.array(positions)
    found = [
        inside.of_layers(Tractions(np.full(4, ratio), of.density(number, np.eye(4)), np.zeros(4)), places, _STRESSES)
        for number, ratio in enumerate(np.exp(of.nodes).tolist())
    ]
    return coefficients(np.moveaxis(np.stack(found), 1, -1).reshape(len(found), -1))
