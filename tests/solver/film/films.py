"""Stacks and contacts that the tests of films share."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

import solver
from solver.arrays import Array
from solver.film.contact import FilmContact
from solver.film.interior import fields_of
from solver.film.quantities import driven
from solver.film.stack import Layer, Stack
from solver.film.surface import SurfaceTable
from solver.film.table import Table, table
from solver.film.tractions import TractionTable
from solver.halfplane.contact import Contact
from solver.halfplane.interior import with_derived
from solver.halfplane.profile import Profile
from solver.halfplane.response import Response

BTO, CFO, STEEL = solver.find("BaTiO3"), solver.find("CoFe2O4"), solver.find("steel")
SILICON = solver.find("silicon")
#: As stiff as steel, but a dielectric: isotropic, its roots coincide.
ELASTIC = solver.Material.isotropic(200e9, 0.3)
FIBROUS = solver.fibrous(BTO, CFO, 0.5)
ON_STEEL = Stack((Layer(FIBROUS, 0.2e-3, magnetic="grounded"),), STEEL)


def cases(values: ArrayLike) -> Array:
    """Values of cases (case,)."""
    return np.atleast_1d(np.asarray(values, dtype=np.float64))


def contact(
    of: Table, profile: Profile, load: float, charges: ArrayLike = (0.0, 0.0), datum: float = 1.0
) -> FilmContact:
    """One contact by a table of its own about its half-length: as exact as the system."""
    charge = np.asarray(charges, dtype=np.float64)[None]
    half = FilmContact(of, profile, cases(load), charge, np.array(datum)).half_width
    return FilmContact(of.narrowed(float(half[0])), profile, cases(load), charge, np.array(datum))


def cylinder(
    stack: Stack,
    friction: float = 0.0,
    load: float = 1e5,
    charges: ArrayLike = (0.0, 0.0),
    datum: float = 1.0,
    accuracy: float = 1.0,
) -> FilmContact:
    """A cylinder of radius 50 mm that conducts both fields."""
    of = table(stack, friction, least=0.05, most=12.0, nodes=24, accuracy=accuracy)
    return contact(of, Profile.cylinder(np.array(0.05)), load, charges, datum)


def surface_fields(contact: FilmContact, positions: Array) -> dict[str, Array]:
    """Fields of ``solver.fields.FIELDS``; (case, position) each."""
    return SurfaceTable(contact.table, positions).fields(contact)


def interior_fields(contact: FilmContact, X: Array, Y: Array, names: tuple[str, ...]) -> Array:
    """Fields inside films and bases; (case, field, y, x)."""
    tractions = TractionTable(contact.table).read(contact)

    def linear(names: tuple[str, ...]) -> dict[str, Array]:
        return dict(zip(names, np.moveaxis(fields_of(tractions, X, Y, names, contact.datum), 1, 0), strict=True))

    values = with_derived(names, linear)
    return np.stack([values[name] for name in names], 1)


def require_closed_form(film: FilmContact, exact: Contact, response: Response) -> None:
    """All that a film which lies on its own material answers, beside the closed form."""
    pairs = [(film.trailing, exact.trailing), (film.leading, exact.leading), (film.depth, response.depth)]
    for edge, smooth in zip((1.0, -1.0), exact.profile.smooth, strict=True):
        if smooth:
            pairs.append((film.edge_intensity(edge)[0], exact.edge_intensity(edge).ravel()))
            pairs.append((film.edge_stress(edge), exact.edge_stress(edge)))
    idle = replace(film, charges=np.zeros_like(film.charges))
    for field in np.flatnonzero(exact.sliding.conducts).tolist():
        j, short = 1 + field, np.zeros_like(film.charges)
        short[:, field] = response.short_circuit(field) * film.load
        moved = idle.potential(field) - replace(film, charges=short).potential(field)
        pairs += [(film.potential(field), response.potential(field)), (moved, idle.potential(field))]
        tangents = idle.tangents[:, j, 0], *driven(film.tangents, j)
        closed = response.sensitivity(field), response.stroke(field), response.blocked_load(field)
        pairs += zip(tangents, closed, strict=True)
    for one, other in pairs:
        np.testing.assert_allclose(np.ravel(one), np.ravel(other), rtol=1e-11)
