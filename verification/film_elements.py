"""Films against spectral finite elements of the whole coupled contact, which find its edges as well."""

from dataclasses import dataclass
from functools import cached_property, partial
from typing import ClassVar

import numpy as np

from verification.cases import constants
from verification.film_cases import CASES, EXTREMES, FLUXES, INTENSITIES, RESPONSES, Answers, Solved
from verification.findings import Findings, Sizes, off
from verification.oracles import fem_film
from verification.oracles.fem import FIELDS
from verification.oracles.fem_film import ELECTRIC, MAGNETIC
from verification.orders import orders_of, refined

X, BESIDE = np.array([-0.9, -0.5, 0.0, 0.5, 0.9]), np.array([-1.5, -1.2, 1.2, 1.5])
WHERE = np.sort(np.concatenate([X, BESIDE, [-1.0, 1.0]]))
_BY_UNIT = {"stress": FIELDS[:3], "electric displacement": FIELDS[3:5], "magnetic induction": FIELDS[5:]}
_ENDS = ("trailing", "leading")
_ABOVE = 1 - 1e-9  # of the depth of an interface: its upper side
#: Compared quantities, and the tolerance at order 10.
COMPARED = {
    "load": ("load that the half-length needs", 1e-6),
    "ends": ("a and b over the half-length", 1e-6),
    "response": ("depth and potentials, each over itself", 5e-6),
    "edges": ("edge intensities of D_y and B_y, over the larger of each", 1e-5),
    "surface": ("p, D_y, B_y below the punch, sigma_xx beside it; each over its largest", 1e-5),
    "inside": ("stress, D, B half way down, above interfaces and in the base; each over its largest", 1e-5),
    "interface": ("largest shear and tension above the interface, over the shear", 1e-5),
}


def run(sizes: Sizes) -> Findings:
    """Every case at rising orders."""
    contacts = {name: partial(Compared, Solved(case)) for name, case in CASES.items()}
    return Findings(
        "Films by finite elements",
        "Layers and base in spectral elements that shrink towards both edges, under the conditions of the contact "
        "itself: displacement and potentials below the punch, Coulomb's law, no singular pressure. They are given the "
        f"solver's half-length; load, centre and all else must come out. Order {orders_of(sizes)[-1]}.",
        *refined("film_elements", "load", contacts, sizes),
    )


@dataclass(frozen=True, eq=False)
class Compared:
    """A case by both methods."""

    solved: Solved
    order: int
    compared: ClassVar[dict[str, tuple[str, float]]] = COMPARED

    def error(self, what: str) -> float:
        """Largest error of one of ``COMPARED``."""
        if what == "load":
            return self.load
        computed, expected = getattr(self, what)
        return max(off(computed[name], value) for name, value in expected.items())

    @property
    def load(self) -> float:
        """Relative error of the load."""
        return off(self.contact.load, self.solved.case["load"])

    @cached_property
    def contact(self) -> fem_film.FilmContact:
        """The finite elements, at the solver's half-length."""
        film, numbers = self.solved, np.array([ELECTRIC, MAGNETIC])
        *upper, (material, thickness) = film.layers
        grounded = numbers[[name == "grounded" for name in film.interface]]
        layers = [fem_film.Layer(constants(above), thick, grounded=()) for above, thick in upper]
        layers.append(fem_film.Layer(constants(material), thickness, tuple(grounded)))
        sliding = film.case["radius"], film.case.get("friction", 0.0)
        punch = fem_film.Punch(*sliding, *film.charges, tuple(numbers[list(film.conducts)]))
        base = None if film.base is None else constants(film.base)
        return fem_film.FilmContact(layers, base, punch, film.half_length, self.order)

    @cached_property
    def quantities(self) -> Answers:
        """Quantities by the solver, with the datum of the elements."""
        return self.solved.quantities(self.contact.datum)

    @property
    def ends(self) -> tuple[Answers, Answers]:
        """a and b; like the others below by the elements and by the solver."""
        contact = self.contact
        ends = np.array([contact.half_length + contact.centre, contact.half_length - contact.centre])
        return {"ends": ends}, {"ends": np.array([self.quantities[f"contact_{end}"] for end in _ENDS])}

    @property
    def response(self) -> tuple[Answers, Answers]:
        """Depth and potentials; psi over an insulated base is seen from a place of its own and left out."""
        names = ["depth", *(name for _, name, _ in self._potentials)]
        if self.solved.interface[1] == "insulated":
            names.remove("magnetic_potential")
        numbers = {name: number for number, name, _ in self._potentials}
        computed = {k: self.contact.potential(numbers[k]) if k in numbers else self.contact.depth for k in names}
        return {k: np.array(value) for k, value in computed.items()}, {k: self.quantities[k] for k in names}

    @property
    def edges(self) -> tuple[Answers, Answers]:
        """Edge intensities."""
        computed = {name: np.array(self.contact.edge_intensities(number)) for number, _, name in self._potentials}
        return computed, {k: np.array([self.quantities[f"{k}_{end}"] for end in _ENDS]) for k in computed}

    @property
    def surface(self) -> tuple[Answers, Answers]:
        """Tractions below the punch and the stress beside it."""
        below, exterior = self.contact.fields(X, 0.0), self.contact.fields(BESIDE, 0.0)
        solved = self.solved.surface(X)
        computed = {"contact_pressure": -below["stress_yy"], **{name: below[name] for name in FLUXES}}
        expected = {name: solved[name] for name in computed}
        name = "stress_xx"
        return computed | {name: exterior[name]}, expected | {name: self.solved.surface(BESIDE)[name]}

    @property
    def inside(self) -> tuple[Answers, Answers]:
        """Fields half way down each layer, above its lower side, and in the base."""
        places, top = [], 0.0
        for number, (_, thickness) in enumerate(self.solved.layers):
            places += [(number, top + thickness / 2), (number, (top + thickness) * _ABOVE)]
            top += thickness
        if self.contact.base is not None:
            places.append((len(self.solved.layers), 1.5 * top))
        rows = [self.contact.fields(WHERE, depth, layer) for layer, depth in places]
        Y = -np.array([depth for _, depth in places]) / self.contact.half_length
        computed = {name: np.array([row[name] for row in rows]) for name in FIELDS}
        return _by_unit(computed), _by_unit(self.solved.inside(WHERE, Y))

    @property
    def interface(self) -> tuple[Answers, Answers]:
        """Largest shear, and largest tension or 0."""
        tractions = self.contact.interface(len(self.solved.layers) - 1)
        expected = [self.quantities[name] for name in EXTREMES]
        return {"extremes": np.array([tractions["shear"], max(tractions["tension"], 0.0)])}, {
            "extremes": np.array(expected)
        }

    @cached_property
    def _potentials(self) -> list[tuple[int, str, str]]:
        """Number, name and edge intensity of the potentials that the punch makes uniform."""
        triples = zip((ELECTRIC, MAGNETIC), RESPONSES[1:], INTENSITIES, strict=True)
        return [potential for potential, conducts in zip(triples, self.solved.conducts, strict=True) if conducts]


def _by_unit(fields: Answers) -> Answers:
    """Fields of one unit together, so that small ones count by the large."""
    return {unit: np.stack([fields[name] for name in names]) for unit, names in _BY_UNIT.items()}
