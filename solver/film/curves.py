"""Stresses of films, of their bases and on their interface on panels tied to the contact: what peaks follow from.

They are those of the tables in which the peaks are searched (module `peaks`), at fewer points in the bodies.
"""

import numpy as np

from approximation.arrays import Array
from approximation.chebyshev import interpolation
from solver.curves import REGIONS
from solver.film.contact import FilmContact
from solver.film.net import Net
from solver.film.peaks import PeakTable


def region_curves(of: PeakTable, contact: FilmContact, region: str) -> dict[str, Array]:
    """Fields of a region of contacts read from a table, by name; (case, point), SI.

    Parameters
    ----------
    of : PeakTable, that is read
    contact : FilmContact, of the cases
    region : str, of ``solver.curves.REGIONS``

    Raises
    ------
    StackError
        Stresses of a rigid base; contacts so wide that the film has no depth below 0.1 h.
    """
    here, (net, series) = REGIONS[region], _tabulated(of, region)
    across, down = here.lines()
    values = interpolation(net.down, down) @ of.read(contact, series) @ _along(net.across, across).T
    stresses = here.panels.by_panel(values)
    out = {f"{region}_{name}": stresses[:, k] for k, name in enumerate(here.fields[: stresses.shape[1]])}
    return out | ({"interface_position": net.positions(contact.half_width, across)} if region == "interface" else {})


def _tabulated(of: PeakTable, region: str) -> tuple[Net, Array]:
    """Net and series of a region."""
    if region == "interface":
        return of.interface_net, of.interface_series
    return (of.film_net, of.film_series) if region == "film" else (of.base_net, of.base_series)


def _along(counts: tuple[int, ...], places: Array) -> Array:
    """From values at the points of panels across to those at places; a panel is 2 wide. (place, point)."""
    whole = np.zeros((places.size, sum(counts)))
    panel = np.clip(np.floor((places + len(counts)) / 2).astype(int), 0, len(counts) - 1)
    ends = np.cumsum((0, *counts))
    for number, count in enumerate(counts):
        own = np.flatnonzero(panel == number)
        local = places[own] + len(counts) - 1 - 2 * number
        whole[own, ends[number] : ends[number + 1]] = interpolation(count, local)
    return whole
