"""Contacts with air beside them against spectral finite elements of body, gap and punch."""

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
import xarray as xr

import solver
from verification.cases import Case, constants, half_length
from verification.film_elements import orders_of, refined
from verification.findings import Findings, Sizes, off
from verification.oracles.fem_film import ELECTRIC, Layer, Punch
from verification.oracles.fem_gap import GapContact
from verification.oracles.sample_materials import isotropic

STEEL = 210e9, 0.3  # of the punch
_FROM, _TO = 1.02, 5.0  # abs((x - c)/h) beside the contact, at which potentials are compared
SLIDING: Case = {
    "material": "PZT-4", "thickness": 2e-4, "base": "steel", "radius": 0.05, "load": 2e4, "friction": 0.3,
    "charge": 1e-7, "magnetic": "insulating", "surroundings": "air",
}  # fmt: skip
CASES: dict[str, Case] = {
    "PZT-4 on steel, air": SLIDING,
    "PZT-4 on steel, air, elastic punch": SLIDING | {"punch_modulus": STEEL[0], "punch_poisson": STEEL[1]},
}
#: Compared quantities, and the tolerance at order 10.
COMPARED = {
    "load": ("load that the half-length needs", 3e-7),
    "centre": ("centre of the contact", 3e-6),
    "voltage": ("voltage against the grounded interface", 3e-6),
}
#: Compared fields, each over its largest value, under a rigid punch, where air has the largest effect.
FIELDS_COMPARED = {
    "beside": ("potential of the surface beside the contact, over the voltage", 3e-6),
    "inside": ("stresses and D half way down the film, below the contact and beside it", 1e-6),
}
X = np.array([-1.6, -0.6, 0.3, 1.4])
INSIDE = ("stress_xx", "stress_yy", "stress_xy", "electric_displacement_x", "electric_displacement_y")


def run(sizes: Sizes) -> Findings:
    """Every case at rising orders."""
    contacts = {name: partial(Compared, case) for name, case in CASES.items()}
    return Findings(
        "Air beside the contact by finite elements",
        "Layers, base and an elastic punch in spectral elements, the air a spring on the potentials of the surface "
        "beside the contact, as strong as the gap says that the solution has. They are given the solver's half-length; "
        "load, centre and voltage must come out, potentials beside the contact and fields inside the film. "
        f"Order {orders_of(sizes)[-1]}.",
        *refined("film_air", "voltage", contacts, sizes),
    )


@dataclass(frozen=True, eq=False)
class Compared:
    """A case by both methods, the elements at the solver's half-length."""

    case: Case
    order: int

    @property
    def compared(self) -> dict[str, tuple[str, float]]:
        """Compared quantities: the words of each, and its tolerance at order 10."""
        return COMPARED if "punch_modulus" in self.case else COMPARED | FIELDS_COMPARED

    def error(self, what: str) -> float:
        """Relative error of one of ``COMPARED`` or ``FIELDS_COMPARED``."""
        contact, solved = self.contact, self.solved
        if what in FIELDS_COMPARED:
            return self._exterior_error() if what == "beside" else self._interior_error()
        if what == "load":
            return off(contact.load, self.case["load"])
        if what == "centre":
            return off(contact.centre, solved["contact_offset"])
        return off(contact.potential(ELECTRIC), solved["voltage"])

    def _exterior_error(self) -> float:
        place, phi = self.contact.exterior(ELECTRIC)
        compared = np.flatnonzero((np.abs(place) > _FROM) & (np.abs(place) < _TO))[::5]
        inside = solver.solve_interior(self.case, place[compared], [0.0], fields=["electric_potential"])
        difference = inside["electric_potential"].to_numpy()[0] - phi[compared]
        return float(np.max(np.abs(difference)) / abs(self.contact.potential(ELECTRIC)))

    def _interior_error(self) -> float:
        depth = self.case["thickness"] / 2
        expected, y = self.contact.fields(X, depth), -depth / self.contact.half_length
        inside = solver.solve_interior(self.case, X, [y], fields=INSIDE)
        return max(off(inside[name][0], expected[name]) for name in INSIDE)

    @cached_property
    def solved(self) -> xr.Dataset:
        """Quantities of the solver."""
        return solver.solve(self.case)

    @cached_property
    def contact(self) -> GapContact:
        """The finite elements."""
        case, half = self.case, float(half_length(self.solved))
        layer = Layer(constants(solver.find(case["material"])), case["thickness"], (ELECTRIC,))
        punch = Punch(case["radius"], case["friction"], case["charge"], 0.0, (ELECTRIC,))
        elastic = isotropic(case["punch_modulus"], case["punch_poisson"]) if "punch_modulus" in case else None
        return GapContact([layer], constants(solver.find(case["base"])), punch, half, order=self.order, elastic=elastic)
