"""Contacts with air beside them against spectral finite elements of body, gap and punch."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import solver
from verification.cases import constants
from verification.findings import Curve, Findings, Sizes, check, off
from verification.oracles.fem_film import ELECTRIC, Layer, Punch
from verification.oracles.fem_gap import GapContact
from verification.oracles.sample_materials import isotropic

Case = dict[str, Any]
STEEL = 210e9, 0.3  # of the punch
SLIDING: Case = {
    "material": "PZT-4", "thickness": 2e-4, "base": "steel", "radius": 0.05, "load": 2e4, "friction": 0.3,
    "charge": 1e-7, "magnetic": "insulating", "surroundings": "air",
}  # fmt: skip
CASES: dict[str, Case] = {
    "PZT-4 on steel, air": SLIDING,
    "PZT-4 on steel, air, elastic punch": SLIDING | {"punch_modulus": STEEL[0], "punch_poisson": STEEL[1]},
}
#: What is compared, and the tolerance at order 10.
COMPARED = {
    "load": ("load that the half-length needs", 3e-7),
    "centre": ("centre of the contact", 3e-6),
    "voltage": ("voltage against the grounded interface", 3e-6),
}


def run(sizes: Sizes) -> Findings:
    """Every case at rising orders."""
    orders = range(4, 3 + sizes.elements // 6, 2)
    slack = 10 ** ((10 - orders[-1]) / 2)
    checks, curves = [], []
    for name, case in CASES.items():
        compared = [Compared(case, order) for order in orders]
        checks += [
            check(f"{what}: {name}", text, tolerance * slack, compared[-1].error, what)
            for what, (text, tolerance) in COMPARED.items()
        ]
        errors = [contact.error("voltage") for contact in compared]
        curves.append(Curve("film_air", name, "order of the polynomials", list(map(float, orders)), errors))
    return Findings(
        "Air beside the contact by finite elements",
        "Layers, base and an elastic punch in spectral elements, the air a spring on the potentials of the surface "
        "beside the contact, as strong as the gap says that the solution has. They are given the solver's half-length; "
        f"load, centre and voltage must come out. Order {orders[-1]}.",
        checks,
        curves,
    )


@dataclass(frozen=True, eq=False)
class Compared:
    """A case by both methods, the elements at the solver's half-length."""

    case: Case
    order: int

    def error(self, what: str) -> float:
        """Relative error of one of ``COMPARED``."""
        found, solved = self.contact, self.solved
        if what == "load":
            return off(found.load, self.case["load"])
        if what == "centre":
            return off(found.centre, solved["contact_offset"])
        return off(found.potential(ELECTRIC), solved["voltage"])

    @cached_property
    def solved(self) -> dict[str, float]:
        """Quantities of the solver."""
        return {str(name): float(value) for name, value in solver.solve(self.case).items()}

    @cached_property
    def contact(self) -> GapContact:
        """The finite elements."""
        case, half = self.case, (self.solved["contact_trailing"] + self.solved["contact_leading"]) / 2
        layer = Layer(constants(solver.find(case["material"])), case["thickness"], (ELECTRIC,))
        punch = Punch(case["radius"], case["friction"], case["charge"], 0.0, (ELECTRIC,))
        elastic = isotropic(case["punch_modulus"], case["punch_poisson"]) if "punch_modulus" in case else None
        return GapContact([layer], constants(solver.find(case["base"])), punch, half, order=self.order, elastic=elastic)
