"""Stacks and contacts that the tests of films share."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import expm

import solver
from solver.arrays import Array
from solver.halfplane.interior import with_derived
from solver.halfplane.profile import Profile
from solver.line.contact import FilmContact
from solver.line.fields import SurfaceTable
from solver.line.interior import fields_of
from solver.line.table import Table, table
from solver.line.tractions import TractionTable
from solver.stack.layers import Layer, Stack

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
    tabled: Table, profile: Profile, load: float, charges: ArrayLike = (0.0, 0.0), datum: float = 1.0
) -> FilmContact:
    """One contact by a table of its own about its half-length: as exact as the system."""
    charge = np.asarray(charges, dtype=np.float64)[None]
    half = FilmContact(tabled, profile, cases(load), charge, np.array(datum)).half_width
    return FilmContact(tabled.narrowed(float(half[0])), profile, cases(load), charge, np.array(datum))


def cylinder(
    stack: Stack,
    friction: float = 0.0,
    load: float = 1e5,
    charges: ArrayLike = (0.0, 0.0),
    datum: float = 1.0,
    accuracy: float = 1.0,
) -> FilmContact:
    """A cylinder of radius 50 mm that conducts both fields."""
    tabled = table(stack, friction, least=0.05, most=12.0, nodes=24, accuracy=accuracy)
    return contact(tabled, Profile.cylinder(np.array(0.05)), load, charges, datum)


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


def by_exponentials(stack: Stack, wave: float) -> tuple[Array, Array]:
    """[k u; t] on top, and k phi of every electrode below a layer, the lowest first; (8, n) and (electrode, n).

    The n columns are of the base's tractions (4) and of the charges of the electrodes, the lowest first.
    """
    assert stack.base_medium is not None
    columns, phi = np.concatenate([stack.base_medium.compliance, np.eye(4)]), list[Array]()
    for layer, medium in zip(stack.layers[::-1], stack.media[::-1], strict=True):
        if not phi or layer.electric == "grounded":
            columns = np.concatenate([columns, np.eye(8)[:, [6]]], 1)
            phi.append(columns[2])
        columns = expm(wave * layer.thickness * medium.system) @ columns
    return columns, np.array([np.pad(row, (0, columns.shape[1] - row.size)) for row in phi])
