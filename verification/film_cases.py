"""Cases of films and the solver's answers: through its face, but stacks and the tractions of interfaces by its room."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

import solver
from solver.film.contact import FilmContact
from solver.film.interior import fields_of
from solver.film.peaks import PeakTable
from solver.film.stack import RIGID, Layer, Stack
from solver.film.surface import SurfaceTable
from solver.film.table import table
from solver.film.tractions import TractionTable
from solver.halfplane.profile import Profile
from verification.cases import Array
from verification.oracles.fem import FIELDS

Case = dict[str, Any]
Answers = dict[str, Array]
PUNCH: Case = {"radius": 0.05, "load": 1e5, "surroundings": "insulated"}
COMPOSITE: Case = {**PUNCH, "volume_fraction": 0.5, "thickness": 2e-4, "friction": 0.3}
CASES: dict[str, Case] = {
    "BaTiO3 on a rigid base": {**PUNCH, "material": "BaTiO3", "thickness": 5e-4, "base": "rigid"},
    "composite on a rigid base, charged": {**COMPOSITE, "base": "rigid", "charge": 2e-5, "magnetic_charge": 1e-2},
    "composite on steel": {**COMPOSITE, "base": "steel", "interface_magnetic": "grounded"},
    "insulating punch on a rigid base": {
        **COMPOSITE, "base": "rigid", "thickness": 1e-4, "friction": 0.8, "electric": "insulating",
        "magnetic_charge": 2e-3,
    },
    "composite on an insulated base": {
        **COMPOSITE, "base": "rigid", "friction": 0.0, "interface_magnetic": "insulated", "charge": 1e-5,
        "magnetic_charge": 2e-3,
    },
    "BaTiO3 bonded to CoFe2O4": {
        **PUNCH, "material": "BaTiO3", "thickness": 2e-4, "base": "CoFe2O4", "interface_electric": "bonded",
        "friction": 0.3, "charge": 1e-5,
    },
    "BaTiO3 on CoFe2O4 on a rigid base": {
        **PUNCH, "layers": (("BaTiO3", 1e-4), ("CoFe2O4", 1.5e-4)), "friction": 0.3, "charge": 1e-5,
    },
}  # fmt: skip
FLUXES = ("electric_displacement_y", "magnetic_induction_y")
RESPONSES = ("depth", "voltage", "magnetic_potential")
INTENSITIES = ("electric_edge_intensity", "magnetic_edge_intensity")


@dataclass(frozen=True, eq=False)
class Solved:
    """A case by the solver: stacks, and peaks of interfaces, by its room of films, the rest through its face."""

    case: Case

    @property
    def stacked(self) -> bool:
        """Whether there are several layers."""
        return "layers" in self.case

    @cached_property
    def layers(self) -> list[tuple[solver.Material, float]]:
        """Material and thickness [m] of every layer."""
        if self.stacked:
            return [(solver.find(name), thickness) for name, thickness in self.case["layers"]]
        if "material" in self.case:
            return [(solver.find(self.case["material"]), self.case["thickness"])]
        phases = solver.find("BaTiO3"), solver.find("CoFe2O4")
        return [(solver.fibrous(*phases, self.case["volume_fraction"]), self.case["thickness"])]

    @cached_property
    def base(self) -> solver.Material | None:
        """Half-plane below; None: rigid."""
        name = self.case.get("base", "rigid")
        return None if name == "rigid" else solver.find(name)

    @cached_property
    def interface(self) -> tuple[str, str]:
        """What the lowest interface is to the electric and to the magnetic field."""
        magnetic = "grounded" if self.base is None else "bonded"
        return self.case.get("interface_electric", "grounded"), self.case.get("interface_magnetic", magnetic)

    @cached_property
    def conducts(self) -> tuple[bool, bool]:
        """Whether the punch conducts the electric and the magnetic field."""
        return self.case.get("electric") != "insulating", self.case.get("magnetic") != "insulating"

    @cached_property
    def charges(self) -> tuple[float, float]:
        """T and J."""
        return self.case.get("charge", 0.0), self.case.get("magnetic_charge", 0.0)

    @cached_property
    def contact(self) -> FilmContact:
        """The contact by a table of its own about the half-length."""
        *upper, lowest = self.layers
        layers = *(Layer(*layer) for layer in upper), Layer(*lowest, *self.interface)
        profile, load = Profile.cylinder(np.array(self.case["radius"])), np.array([self.case["load"]])
        stack = Stack(layers, self.base or RIGID)
        wide = table(stack, self.case.get("friction", 0.0), self.conducts, least=0.05, most=12.0, nodes=24)
        solved = FilmContact(wide, profile, load, np.array([self.charges]), np.array(1.0))
        return replace(solved, table=wide.narrowed(float(solved.half_width[0])))

    def quantities(self, datum: float) -> Answers:
        """Quantities by name, the largest tractions of the lowest interface among them."""
        contact = self.contact
        peaks = PeakTable(contact.table).interface(contact)
        extremes = {"interface_shear": peaks.shear[0], "interface_tension": peaks.tension[0]}
        if not self.stacked:
            found = solver.solve(self.case | {"datum": datum})
            return {str(name): value.values for name, value in found.items()} | extremes
        out = dict(zip(RESPONSES, contact.response[0], strict=True)) | extremes
        for end, side in (("trailing", 1.0), ("leading", -1.0)):
            out |= zip((f"{name}_{end}" for name in INTENSITIES), contact.edge_intensity(side)[0], strict=True)
        return out | {"contact_trailing": contact.trailing[0], "contact_leading": contact.leading[0]}

    def surface(self, at: Array) -> Answers:
        """Surface fields by name."""
        names = ("contact_pressure", "stress_xx", *FLUXES)
        if self.stacked:
            found = SurfaceTable(self.contact.table, at).fields(self.contact)
            return {name: found[name][0] for name in names}
        solved = solver.solve(self.case, at)
        return {name: solved[name].values for name in names}

    def inside(self, at: Array, Y: Array) -> Answers:
        """``FIELDS`` (depth, place).

        Parameters
        ----------
        at : ndarray, shape (place,), along the surface over the contact's half-width
        Y : ndarray, shape (depth,), depths over the same
        """
        if not self.stacked:
            found = solver.solve_interior(self.case, at, Y, fields=FIELDS)
            return {name: found[name].values for name in FIELDS}
        tractions = TractionTable(self.contact.table).read(self.contact)
        return dict(zip(FIELDS, fields_of(tractions, at, Y, FIELDS, self.contact.datum)[0], strict=True))
