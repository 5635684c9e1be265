"""Films with air beside the contact that the tests share."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import solver
from solver.gap.airline import AirContacts
from solver.gap.operators import AirTable, farthest
from solver.halfplane.profile import Profile
from solver.halfplane.sliding import RIGID_PUNCH, Punch
from solver.line.contact import FilmContact
from solver.line.table import table
from solver.material.constants import VACUUM_PERMEABILITY, VACUUM_PERMITTIVITY, Material
from solver.stack.layers import Layer, Stack

BTO, CFO, PZT, STEEL = (solver.find(name) for name in ("BaTiO3", "CoFe2O4", "PZT-4", "steel"))
FIBROUS = solver.fibrous(BTO, CFO, 0.8)
THICKNESS, RADIUS = 3e-4, 0.1


def on_rigid(material: Material) -> Stack:
    """A film of unit thickness."""
    return Stack((Layer(material, 1.0),))


def on_steel(material: Material) -> Stack:
    """The same, grounded on steel."""
    return Stack((Layer(material, 1.0, "grounded"),), STEEL)


def half_plane(material: Material) -> Stack:
    """A film on a half-plane of its own."""
    return Stack((Layer(material, 1.0, "bonded", "bonded"),), material)


def airy(
    stack: Stack,
    load: float = 5e3,
    friction: float = 0.0,
    charges: Sequence[float] = (0.0, 0.0),
    conducts: tuple[bool, bool] = (True, True),
    permittivity: float = 1.0,
    punch: Punch = RIGID_PUNCH,
    nodes: int = 6,
) -> AirContacts:
    """A cylinder on a film of 0.3 mm; lengths over the thickness."""
    air_table = table(stack, friction, conducts, least=0.02, most=6.0, punch=punch)
    bare = FilmContact(
        air_table, Profile.cylinder(np.array([RADIUS / THICKNESS])), np.array([load / THICKNESS]),
        np.array([charges]) / THICKNESS, np.array([1.0]),
    )  # fmt: skip
    near = air_table.narrowed(float(bare.half_width[0]), 1.06, nodes)
    filled = permittivity * np.array([[VACUUM_PERMITTIVITY, VACUUM_PERMEABILITY]])
    contact = replace(bare, table=near)
    return AirContacts(AirTable(near, float(farthest(contact, filled)[0])), contact, filled)
