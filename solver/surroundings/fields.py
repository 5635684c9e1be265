"""Fields of contacts with air beside them, on the surface and inside, case by case; their peaks and curves."""

from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np

from approximation.arrays import Indices
from solver.arrays import Array
from solver.fields import FIELDS
from solver.film.contact import FilmContact
from solver.film.inside import in_blocks
from solver.film.interior import Interior, fields_of
from solver.film.net import Net, Nets
from solver.film.peaks import PeakTable
from solver.film.quantities import curves_of, peaks_of, require_depth
from solver.film.similar import Films
from solver.halfplane.potentials import POTENTIALS
from solver.surroundings.charges import FAR, NEAR
from solver.surroundings.quantities import states
from solver.surroundings.surface import surface_fields
from solver.surroundings.tractions import AirTractions, Solved

_EDGES = np.array([1.0, -1.0])


def fields(films: Films, permittivity: Array, positions: Array) -> dict[str, Array]:
    """Surface fields of ``solver.fields.FIELDS`` at positions X, finite and never exactly +-1; (case, position) each.

    Parameters
    ----------
    films, permittivity
        As of :func:`solver.surroundings.quantities.quantities`.
    positions
        X; (position,).
    """
    out = {name: np.empty((films.load.size, positions.size)) for name in FIELDS}
    for place, state in states(films, permittivity):
        found = surface_fields(state, positions)
        for name, values in out.items():
            values[place] = getattr(found, name)[0]
    return out


def inside(films: Films, permittivity: Array, x: Array, y: Array, names: tuple[str, ...]) -> Array:
    """Fields of ``solver.fields.EVERY_INTERIOR`` at ((x - c)/h, y/h), NaN in a rigid base; (case, field, y, x).

    Raises
    ------
    StackError
        As of films without air.
    """
    out = np.empty((films.load.size, len(names), y.size, x.size))
    intervals = FAR if set(POTENTIALS) & set(names) else NEAR
    for place, state in states(films, permittivity):
        tractions, datum = Solved(state, _EDGES, intervals).tractions, state.of.contact.datum
        for rows, columns in in_blocks(x, y):
            out[place, :, rows, columns] = fields_of(tractions, x[columns], y[rows], names, datum)[0]
    for number, name in enumerate(names):
        if name in POTENTIALS:
            out[:, number] *= films.thickness[:, None, None]
    return out


def peaks(films: Films, permittivity: Array, asked: Set[str]) -> dict[str, Array]:
    """Quantities of ``solver.names.FILM_PEAKS`` that are asked for and the cases have, as without air; (case,) each."""
    return peaks_of(films, asked, _tables(films, permittivity))


def curves(films: Films, permittivity: Array, regions: Sequence[str]) -> dict[str, Array]:
    """Sizes of the contacts, and the curves of regions that the cases have, as without air; (case, ...) each."""
    return curves_of(films, regions, _tables(films, permittivity))


def _tables(films: Films, permittivity: Array) -> Iterator[tuple[Indices, PeakTable, FilmContact]]:
    """Cases with the stresses below them, one at a time."""
    for place, state in states(films, permittivity):
        half = np.array([state.half])
        require_depth(films.kind, half)
        table = replace(state.of.contact.table, lower=state.half, upper=state.half)
        c = state.of.contact
        extent = Extent(table, c.profile, c.load, c.charges, c.datum, c.punch_datum, half)
        nets = Nets(films.kind.stack(), state.half, state.half)
        widest = max(float(np.max(net.positions(half, net.line))) for net in (nets.interface, nets.film)) + 1.5
        tractions = replace(Solved(state, _EDGES).tractions, widest=widest * state.half)
        yield np.array([place]), AirPeaks(table, tractions), extent


@dataclass(frozen=True, eq=False)
class Extent(FilmContact):
    """A contact of a half-length that is known [m]; (case,)."""

    half: Array | None = None

    @property
    def half_width(self) -> Array:
        """h = (a + b)/2 [m]."""
        assert self.half is not None
        return self.half


@dataclass(frozen=True, eq=False)
class AirPeaks(PeakTable):
    """Stresses below one contact, on the nets of its very half-length.

    Parameters
    ----------
    tractions
        Those on the whole surface.
    """

    tractions: AirTractions

    def _series(self, net: Net, names: tuple[str, ...]) -> Array:
        """Stresses themselves; (1, stress, depth, x)."""
        h = self.tractions.half_lengths
        return Interior(self.tractions).fields(net.positions(h, net.line), -net.depths(h), names)[..., 0]

    def read(self, contact: FilmContact, series: Array, some: slice = slice(None)) -> Array:
        """The stresses of the one case."""
        return series
