"""Films against spectral finite elements of the whole coupled contact, which find its edges as well."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
import xarray as xr

import solver
from verification.cases import Array, Case, constants, half_length
from verification.findings import Check, Curve, Findings, Sizes, check, off
from verification.oracles.fem_film import FilmContact, Layer, Punch
from verification.oracles.sample_materials import isotropic
from verification.oracles.spectral import ELECTRIC, FIELDS, MAGNETIC


def orders_of(sizes: Sizes) -> list[int]:
    """Orders of the polynomials, rising."""
    return list(range(4, 3 + sizes.elements // 6, 2))


def refined(
    figure: str, shown: str, contacts: Mapping[str, Callable[[int], "Compared"]], sizes: Sizes
) -> tuple[list[Check], list[Curve]]:
    """Checks at the highest order, and curves of one error over all orders."""
    orders = orders_of(sizes)
    slack = 10 ** ((10 - orders[-1]) / 2)
    checks, curves = list[Check](), list[Curve]()
    for name, of_order in contacts.items():
        rising = [of_order(order) for order in orders]
        checks += [
            check(f"{what}: {name}", text, tolerance * slack, rising[-1].error, what)
            for what, (text, tolerance) in rising[-1].compared.items()
        ]
        errors = [contact.error(shown) for contact in rising]
        curves.append(Curve(figure, name, "order of the polynomials", orders, errors))
    return checks, curves


Answers = dict[str, Array]
PUNCH: Case = {"radius": 0.05, "load": 1e5, "surroundings": "insulated"}
COMPOSITE: Case = {**PUNCH, "volume_fraction": 0.5, "thickness": 2e-4, "friction": 0.3}
STACK = solver.Stack([solver.Layer(solver.find("BaTiO3"), 1e-4), solver.Layer(solver.find("CoFe2O4"), 1.5e-4)], "rigid")
CASES: dict[str, Case] = {
    "half-plane, as a film on its material": {
        **PUNCH, "material": "BaTiO3", "thickness": 2e-4, "base": "BaTiO3", "interface_electric": "bonded",
        "friction": 0.3, "charge": 1e-6, "magnetic": "insulating",
    },
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
        **PUNCH, "body": STACK, "friction": 0.3, "charge": 1e-5,
    },
}  # fmt: skip
FLUXES = ("electric_displacement_y", "magnetic_induction_y")
RESPONSES = ("depth", "voltage", "magnetic_potential")
EXTREMES = ("interface_shear", "interface_tension")
INTENSITIES = ("electric_edge_intensity", "magnetic_edge_intensity")


@dataclass(frozen=True, eq=False)
class Solved:
    """A case, and the solver's answer for it."""

    case: Case

    @cached_property
    def layers(self) -> list[tuple[solver.Material, float]]:
        """Material and thickness [m] of every layer."""
        if "body" in self.case:
            return [(layer.material, layer.thickness) for layer in self.case["body"].layers]
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
        """Electric and magnetic condition of the lowest interface."""
        magnetic = "grounded" if self.base is None else "bonded"
        return self.case.get("interface_electric", "grounded"), self.case.get("interface_magnetic", magnetic)

    @cached_property
    def conducts(self) -> tuple[bool, bool]:
        """Electric and magnetic conduction of the punch."""
        return self.case.get("electric") != "insulating", self.case.get("magnetic") != "insulating"

    @cached_property
    def charges(self) -> tuple[float, float]:
        """T and J."""
        return self.case.get("charge", 0.0), self.case.get("magnetic_charge", 0.0)

    @property
    def elasticity(self) -> tuple[float, float] | None:
        """Young's modulus [Pa] and Poisson's ratio of an elastic punch."""
        return (self.case["punch_modulus"], self.case["punch_poisson"]) if "punch_modulus" in self.case else None

    @cached_property
    def solution(self) -> xr.Dataset:
        """Quantities of the solver."""
        return solver.solve(self.case)

    @property
    def half_length(self) -> float:
        """(a + b)/2 [m]."""
        return float(half_length(self.solution))

    def quantities(self, datum: float) -> Answers:
        """Quantities by name, the largest tractions of the lowest interface among them."""
        solution = solver.solve(self.case | {"datum": datum}, peaks=EXTREMES)
        return {str(name): value.values for name, value in solution.items()}

    def surface(self, positions: Array) -> Answers:
        """Surface fields by name."""
        solved = solver.solve(self.case, positions)
        return {name: solved[name].values for name in ("contact_pressure", "stress_xx", *FLUXES)}

    def inside(self, X: Array, Y: Array) -> Answers:
        """``FIELDS`` (depth, place).

        at: (place,), along the surface over the contact's half-width; Y: (depth,), depths over the same.
        """
        fields = solver.solve_interior(self.case, X, Y, fields=FIELDS)
        return {name: fields[name].values for name in FIELDS}


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

    @property
    def compared(self) -> Mapping[str, tuple[str, float]]:
        """Words of each compared quantity, and its tolerance at order 10."""
        return COMPARED

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
    def contact(self) -> FilmContact:
        """The finite elements, at the solver's half-length."""
        film, numbers = self.solved, np.array([ELECTRIC, MAGNETIC])
        *upper, (material, thickness) = film.layers
        grounded = numbers[[name == "grounded" for name in film.interface]]
        layers = [Layer(constants(above), thick, grounded=()) for above, thick in upper]
        layers.append(Layer(constants(material), thickness, tuple(grounded)))
        sliding = film.case["radius"], film.case.get("friction", 0.0)
        elastic = None if film.elasticity is None else isotropic(*film.elasticity)
        punch = Punch(*sliding, *film.charges, tuple(numbers[list(film.conducts)]), elastic)
        base = None if film.base is None else constants(film.base)
        air = float(film.case.get("surroundings") == "air")
        return FilmContact(layers, base, punch, film.half_length, self.order, air)

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
