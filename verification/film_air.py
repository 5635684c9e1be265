"""Contacts with air beside them against spectral finite elements of body, gap and punch."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

import solver
from verification import film_elements
from verification.cases import Case
from verification.film_elements import Answers, Solved, orders_of, refined
from verification.findings import Findings, Sizes
from verification.oracles.spectral import ELECTRIC

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


def run(sizes: Sizes) -> Findings:
    """Every case at rising orders."""
    contacts = {name: partial(Compared, Solved(case)) for name, case in CASES.items()}
    return Findings(
        "Air beside the contact by finite elements",
        "Layers, base and an elastic punch in spectral elements, the air a spring on the potentials of the surface "
        "beside the contact, as strong as the gap says that the solution has. They are given the solver's half-length; "
        "load, centre and voltage must come out, potentials beside the contact and fields inside the film. "
        f"Order {orders_of(sizes)[-1]}.",
        *refined("film_air", "voltage", contacts, sizes),
    )


@dataclass(frozen=True, eq=False)
class Compared(film_elements.Compared):
    """A case in air by both methods, the elements at the solver's half-length."""

    @property
    def compared(self) -> Mapping[str, tuple[str, float]]:
        """Words of each compared quantity, and its tolerance at order 10."""
        return COMPARED if self.solved.elasticity else COMPARED | FIELDS_COMPARED

    @property
    def centre(self) -> tuple[Answers, Answers]:
        """Centre of the contact; like the others below by the elements and by the solver."""
        return {"centre": np.array(self.contact.centre)}, {"centre": self.solved.solution["contact_offset"].values}

    @property
    def voltage(self) -> tuple[Answers, Answers]:
        """Voltage of the punch."""
        return {"voltage": np.array(self.contact.potential(ELECTRIC))}, {
            "voltage": self.solved.solution["voltage"].values
        }

    @property
    def beside(self) -> tuple[Answers, Answers]:
        """Potential of the surface beside the contact, and the voltage, which it is compared with."""
        place, phi = self.contact.exterior(ELECTRIC)
        compared = np.flatnonzero((np.abs(place) > _FROM) & (np.abs(place) < _TO))[::5]
        inside = solver.solve_interior(self.solved.case, place[compared], [0.0], fields=["electric_potential"])
        potentials = phi[compared], inside["electric_potential"].values[0]
        computed, expected = (np.append(values, self.contact.potential(ELECTRIC)) for values in potentials)
        return {"potential": computed}, {"potential": expected}

    @property
    def inside(self) -> tuple[Answers, Answers]:
        """Fields half way down the film."""
        depth = self.solved.case["thickness"] / 2
        return self.contact.fields(X, depth), self.solved.inside(X, np.array([-depth / self.contact.half_length]))
