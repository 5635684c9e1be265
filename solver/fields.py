"""Names, units and meanings of fields on the surface and inside a body."""

import re
from typing import Literal

from solver.described import Described, on_datum

#: Attributes of the positions of surface fields, along lines and across points.
ALONG = {"units": "1", "long_name": "surface position X = (x - c)/h"}
ACROSS = {"units": "1", "long_name": "surface position r/a from the middle of the contact"}

#: Surface fields over (case factors..., position).
FIELDS: dict[str, Described] = {
    "contact_pressure": Described("Pa", "contact pressure p = -sigma_yy"),
    "shear_traction": Described("Pa", "surface shear stress sigma_xy"),
    "electric_displacement_y": Described("C m-2", "normal electric displacement D_y"),
    "magnetic_induction_y": Described("T", "normal magnetic induction B_y"),
    "stress_xx": Described("Pa", "in-plane surface stress sigma_xx"),
    "electric_displacement_x": Described("C m-2", "tangential electric displacement D_x"),
    "magnetic_induction_x": Described("T", "tangential magnetic induction B_x"),
}

#: Fields with a square-root singularity at the edges, also given times sqrt|1 - X^2| as ``<name>_regular``.
SINGULAR = tuple(FIELDS)[2:]

#: Surface fields of point contacts over (case factors..., position), positions r/a; stresses need c12.
POINT_FIELDS: dict[str, Described] = {
    "contact_pressure": FIELDS["contact_pressure"],
    "electric_displacement": Described("C m-2", "normal electric displacement D_y at a point contact"),
    "magnetic_induction": Described("T", "normal magnetic induction B_y at a point contact"),
    "radial_stress": Described("Pa", "radial surface stress sigma_rr"),
    "hoop_stress": Described("Pa", "hoop stress of the surface sigma_tt"),
}

#: Fields of point contacts with a square-root singularity at the edge.
POINT_SINGULAR = tuple(POINT_FIELDS)[1:]

#: Regular forms of the singular fields.
REGULAR: dict[str, Described] = {
    f"{name}_regular": Described(field.units, f"{field.long_name}, times sqrt|1 - X^2|")
    for name, field in (FIELDS | POINT_FIELDS).items()
    if name in SINGULAR + POINT_SINGULAR
}

#: Every surface field.
EVERY_FIELD = FIELDS | POINT_FIELDS | REGULAR

#: Fields inside the body over (case factors..., y, x) that :func:`solver.solve_interior` returns by default.
INTERIOR: dict[str, Described] = {
    "stress_xx": Described("Pa", "stress sigma_xx"),
    "stress_yy": Described("Pa", "stress sigma_yy"),
    "stress_xy": Described("Pa", "shear stress sigma_xy"),
    "stress_zz": Described("Pa", "out-of-plane stress sigma_zz"),
    "von_mises": Described("Pa", "von Mises stress"),
    "electric_displacement_x": Described("C m-2", "electric displacement D_x"),
    "electric_displacement_y": Described("C m-2", "electric displacement D_y"),
    "magnetic_induction_x": Described("T", "magnetic induction B_x"),
    "magnetic_induction_y": Described("T", "magnetic induction B_y"),
    "electric_field_x": Described("V m-1", "electric field E_x"),
    "electric_field_y": Described("V m-1", "electric field E_y"),
    "magnetic_field_x": Described("A m-1", "magnetic field H_x"),
    "magnetic_field_y": Described("A m-1", "magnetic field H_y"),
}

#: The four stresses of plane strain in the order of the measures of ``solver.curves``.
STRESSES = tuple(INTERIOR)[:4]

#: Fields inside the body that are returned if named.
INTERIOR_ON_REQUEST: dict[str, Described] = {
    "electric_potential": on_datum("V", "electric potential relative to the datum"),
    "magnetic_potential": on_datum("A", "magnetic potential relative to the datum"),
    "principal_tension": Described("Pa", "largest principal stress"),
    "strain_xx": Described("1", "strain epsilon_xx"),
    "strain_yy": Described("1", "strain epsilon_yy"),
    "strain_xy": Described("1", "tensor shear strain epsilon_xy"),
}

#: Every field inside the body.
EVERY_INTERIOR = {**INTERIOR, **INTERIOR_ON_REQUEST}

#: Fields inside the body that need c12.
NEED_C12 = ("stress_zz", "von_mises", "principal_tension")

#: Fields inside the body that need c12 under point contacts, where the radial stress depends on the hoop strain.
POINT_NEED_C12 = ("stress_xx", *NEED_C12)

Field = Literal["electric", "magnetic"]

#: Symbols of units in which a field is measured.
_SYMBOLS: dict[Field, frozenset[str]] = {
    "electric": frozenset({"C", "V", "F"}),
    "magnetic": frozenset({"A", "T", "Wb", "H"}),
}
_SYMBOL = re.compile(r"[A-Za-z]+")


def fields_of(units: str) -> frozenset[Field]:
    """Return the fields that a unit measures, none for a length or a stress."""
    symbols = set(_SYMBOL.findall(units))
    return frozenset(field for field, field_symbols in _SYMBOLS.items() if symbols & field_symbols)
