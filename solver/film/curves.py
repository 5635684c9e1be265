"""Stresses of films, of their bases and on their interface on panels tied to the contact: what peaks follow from.

They are those of the tables in which the peaks are searched (module `peaks`), at fewer points in the bodies.
"""

import numpy as np

from approximation.arrays import Array
from approximation.chebyshev import gauss_points, interpolation
from solver.curves import REGIONS
from solver.film.contact import FilmContact
from solver.film.peaks import ACROSS, DOWN, PeakTable


def region_curves(of: PeakTable, contact: FilmContact, region: str) -> dict[str, Array]:
    """Fields of a region of contacts read from a table, by name; (case, point), SI.

    Raises
    ------
    StackError
        Stresses of a rigid base; contacts so wide that the film has no depth below 0.1 h.
    """
    if region == "interface":
        stresses = of.read(contact, of.interface_series)
    else:
        here = REGIONS[region]
        across, down = here.lines()
        found = of.read(contact, of.film_series if region == "film" else of.base_series)
        stresses = here.panels.by_panel(interpolation(DOWN, down) @ found @ _along(across).T)
    out = {f"{region}_{name}": stresses[:, k] for k, name in enumerate(REGIONS[region].fields[: stresses.shape[1]])}
    return out | ({"interface_position": _positions(of, contact)} if region == "interface" else {})


def _positions(of: PeakTable, contact: FilmContact) -> Array:
    """X of the points on the interface; (case, point)."""
    h = contact.half_width
    ends = np.array([of.spans(one) for one in h.tolist()]) / h[:, None, None]
    middle, half = ends.mean(2), (ends[..., 1] - ends[..., 0]) / 2
    panels = [
        middle[:, k, None] + half[:, k, None] * gauss_points(count)
        for k, count in enumerate(REGIONS["interface"].across)
    ]
    return np.concatenate(panels, axis=1)


def _along(places: Array) -> Array:
    """From values at the points of the tables across to those at places; a panel is 2 wide. (place, point)."""
    whole = np.zeros((places.size, sum(ACROSS)))
    panel = np.clip(np.floor((places + len(ACROSS)) / 2).astype(int), 0, len(ACROSS) - 1)
    ends = np.cumsum((0, *ACROSS))
    for number, count in enumerate(ACROSS):
        own = np.flatnonzero(panel == number)
        local = places[own] + len(ACROSS) - 1 - 2 * number
        whole[own, ends[number] : ends[number + 1]] = interpolation(count, local)
    return whole
