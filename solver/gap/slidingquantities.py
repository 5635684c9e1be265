"""What friction adds to the quantities of a point contact with air beside it, to the first order in it (points, 8)."""

import warnings

import numpy as np

from solver.arrays import Array
from solver.gap.airpoint import PointState
from solver.gap.largest import peak_of_panels
from solver.gap.slidingpoint import SlidingPoint
from solver.point.body import Film, HalfSpace
from solver.point.friction import Rim, added_tension, edge_sums
from solver.point.sliding import FirstOrderWarning
from solver.point.slidingpressure import ray_of

_MOST_REACH = 1.1  # of the gap's field, beyond which a warning says that it is not reached


def largest_within(slid: SlidingPoint | None, field: int | None, at_rest: float) -> float:
    """Largest abs(D_y) (0), abs(B_y) (1) or pressure (None) below the contact, over C a^(e-1).

    What is singular at the edge is left out, as at rest; at the apex of exponents below 2 it is that at rest.
    """
    if slid is None or slid.friction == 0:
        return at_rest
    along, ray = slid.along(field), ray_of(slid.on.operators.shape)
    signs = (1.0,) if field is None else (1.0, -1.0)
    return max(at_rest, *(float(ray.top(*(sign * along[:, None]))[0]) for sign in signs))


def largest_beside(state: PointState, slid: SlidingPoint | None, place: int, *, gap: bool) -> float:
    """Largest density beside the contact, over C a^(e-1), or that which the gap's field would have at a plate.

    On the finite panels, along the sliding direction.
    """
    at_rest = state.densities[place] / (state.thinned if gap else 1.0)
    turned = np.zeros_like(at_rest) if slid is None else slid.beside[gap][place]
    panels = state.of.rings.grid.panels
    return max(peak_of_panels((at_rest + sign * turned).reshape(panels, -1)[:-1]) for sign in (1.0, -1.0))


def trailing_tension(slid: SlidingPoint, rim: Rim, body: HalfSpace | Film, units: Array) -> float:
    """sigma_xx just outside the trailing edge, where the surface carries charges [Pa].

    units: (3,), of the body.
    """
    unit = slid.on.unit / units
    first, third = (float(part[0] * slid.friction * unit[0]) for part in edge_sums(slid.pressed))
    found = rim.tension(slid.moments * unit, (np.array(first), np.array(third))) + rim.charged(slid.just_beside * unit)
    if isinstance(body, Film):
        b, plain, turned = slid.weighted
        added = added_tension(body.kind.film.stack(), rim, slid.on.state.radius, b, plain, turned)
        found = found + slid.on.unit * added
    return float(found)


def warn_of_charges(reach: float) -> None:
    """Warn by :class:`FirstOrderWarning` where the gap's field goes beyond what a surface carries."""
    if reach > _MOST_REACH:
        warnings.warn(
            f"friction: to its first order the field in the gap beside the edge is {reach:.2g} times that at which the "
            "surface gives way to charges: gap_field and peak_displacement are too large, trailing_tension errs by a "
            "part of what air adds to it",
            FirstOrderWarning,
            stacklevel=2,
        )
