"""Films, in air too, against spectral finite elements of the whole coupled contact, edges included."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

import solver
from verification.cases import Case, constants, half_length
from verification.findings import Check, Curve, Findings, Sizes, check, off
from verification.oracles.fem_film import FilmContact, Layer, Punch
from verification.oracles.sample_materials import isotropic
from verification.oracles.spectral import ELECTRIC, FIELDS, MAGNETIC

Pairs = list[tuple[ArrayLike, ArrayLike]]  # of computed and expected values
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
#: Films in air, which the elements model as a gap outside the contact.
SLIDING: Case = {
    "material": "PZT-4", "thickness": 2e-4, "base": "steel", "radius": 0.05, "load": 2e4, "friction": 0.3,
    "charge": 1e-7, "magnetic": "insulating", "surroundings": "air",
}  # fmt: skip
AIR_CASES: dict[str, Case] = {
    "PZT-4 on steel, air": SLIDING,
    "PZT-4 on steel, air, elastic punch": SLIDING | {"punch_modulus": 210e9, "punch_poisson": 0.3},
}
FLUXES = ("electric_displacement_y", "magnetic_induction_y")
POTENTIALS = {"voltage": ELECTRIC, "magnetic_potential": MAGNETIC}
EXTREMES = ("interface_shear", "interface_tension")
X, BESIDE = np.array([-0.9, -0.5, 0.0, 0.5, 0.9]), np.array([-1.5, -1.2, 1.2, 1.5])
WHERE = np.sort(np.concatenate([X, BESIDE, [-1.0, 1.0]]))
_IN_AIR = 1.02, 5.0  # abs((x - c)/h) beside the contact, between which potentials are compared
_BY_UNIT = FIELDS[:3], FIELDS[3:5], FIELDS[5:]  # stress, electric displacement and magnetic induction
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
COMPARED_IN_AIR = {
    "load": ("load that the half-length needs", 3e-7),
    "centre": ("centre of the contact", 3e-6),
    "voltage": ("voltage against the grounded interface", 3e-6),
}
#: Compared fields under a rigid punch, where air has the largest effect.
FIELDS_IN_AIR = {
    "beside": ("potential of the surface beside the contact, over the voltage", 3e-6),
    "inside": (COMPARED["inside"][0], 1e-6),
}


def run(sizes: Sizes) -> Findings:
    """Every case at rising orders."""
    return Findings(
        "Films by finite elements",
        "Layers and base in spectral elements that shrink towards both edges, under the conditions of the contact "
        "itself: displacement and potentials below the punch, Coulomb's law, no singular pressure. They are given the "
        f"solver's half-length; load, centre and all else must come out. Order {_orders(sizes)[-1]}.",
        *_refined("film_elements", "load", CASES, sizes),
    )


def run_in_air(sizes: Sizes) -> Findings:
    """Every case in air at rising orders."""
    return Findings(
        "Air beside the contact by finite elements",
        "Layers, base and an elastic punch in spectral elements, the air a spring on the potentials of the surface "
        "beside the contact, as strong as the gap says that the solution has. They are given the solver's half-length; "
        "load, centre and voltage must come out, potentials beside the contact and fields inside the film. "
        f"Order {_orders(sizes)[-1]}.",
        *_refined("film_air", "voltage", AIR_CASES, sizes),
    )


def _orders(sizes: Sizes) -> list[int]:
    """Orders of the polynomials, rising."""
    return list(range(4, 3 + sizes.elements // 6, 2))


def _refined(figure: str, shown: str, cases: Mapping[str, Case], sizes: Sizes) -> tuple[list[Check], list[Curve]]:
    """Checks at the highest order, and curves of one error over all orders."""
    orders = _orders(sizes)
    slack = 10 ** ((10 - orders[-1]) / 2)
    checks, curves = list[Check](), list[Curve]()
    for name, case in cases.items():
        solution = solver.solve(case)
        rising = [Compared(case, solution, order) for order in orders]
        checks += [
            check(f"{what}: {name}", text, tolerance * slack, rising[-1].error, what)
            for what, (text, tolerance) in rising[-1].compared.items()
        ]
        errors = [contact.error(shown) for contact in rising]
        curves.append(Curve(figure, name, "order of the polynomials", orders, errors))
    return checks, curves


def layers_of(case: Case) -> list[tuple[solver.Material, float]]:
    """Material and thickness [m] of every layer."""
    if "body" in case:
        return [(layer.material, layer.thickness) for layer in case["body"].layers]
    if "material" in case:
        return [(solver.find(case["material"]), case["thickness"])]
    phases = solver.find("BaTiO3"), solver.find("CoFe2O4")
    return [(solver.fibrous(*phases, case["volume_fraction"]), case["thickness"])]


def elements(case: Case, half: float, order: int) -> FilmContact:
    """The finite elements of a case, at a half-length of the contact [m]."""
    base = None if case.get("base", "rigid") == "rigid" else constants(solver.find(case["base"]))
    usual = {"electric": "grounded", "magnetic": "grounded" if base is None else "bonded"}
    fields = dict(zip(usual, (ELECTRIC, MAGNETIC), strict=True))
    grounded = [number for k, number in fields.items() if case.get(f"interface_{k}", usual[k]) == "grounded"]
    conducted = [number for field, number in fields.items() if case.get(field) != "insulating"]
    layers = [Layer(constants(material), thickness, grounded=()) for material, thickness in layers_of(case)]
    layers[-1] = replace(layers[-1], grounded=tuple(grounded))
    elastic = isotropic(case["punch_modulus"], case["punch_poisson"]) if "punch_modulus" in case else None
    friction, charge, magnetic_charge = (case.get(name, 0.0) for name in ("friction", "charge", "magnetic_charge"))
    punch = Punch(case["radius"], friction, charge, magnetic_charge, tuple(conducted), elastic)
    return FilmContact(layers, base, punch, half, order, case.get("surroundings") == "air")


@dataclass(frozen=True, eq=False)
class Compared:
    """A case by both methods; each comparison returns pairs of the elements' and the solver's values."""

    case: Case
    solution: xr.Dataset  # Quantities of the solver
    order: int

    @property
    def compared(self) -> Mapping[str, tuple[str, float]]:
        """Description of each compared quantity, and its tolerance at order 10."""
        if not self.contact.air:
            return COMPARED
        return COMPARED_IN_AIR if self.contact.punch.elastic else COMPARED_IN_AIR | FIELDS_IN_AIR

    def error(self, what: str) -> float:
        """Return the largest error of a compared quantity."""
        return max(off(computed, expected) for computed, expected in getattr(self, what))

    @cached_property
    def contact(self) -> FilmContact:
        """The finite elements, at the solver's half-length."""
        return elements(self.case, float(half_length(self.solution)), self.order)

    @cached_property
    def quantities(self) -> xr.Dataset:
        """Quantities by the solver at the datum of the elements, with the largest tractions of the lowest interface."""
        return solver.solve(self.case | {"datum": self.contact.datum}, peaks=EXTREMES)

    @property
    def load(self) -> Pairs:
        """Load."""
        return [(self.contact.load, self.case["load"])]

    @property
    def ends(self) -> Pairs:
        """a and b."""
        ends = self.contact.half_length + self.contact.centre * np.array([1, -1])
        return [(ends, self._at_ends("contact"))]

    @property
    def centre(self) -> Pairs:
        """Centre of the contact."""
        return [(self.contact.centre, self.solution["contact_offset"])]

    @property
    def voltage(self) -> Pairs:
        """Voltage of the punch."""
        return [(self.contact.potential(ELECTRIC), self.solution["voltage"])]

    @property
    def response(self) -> Pairs:
        """Depth and potentials; psi over an insulated base has another reference and is left out."""
        potentials = self._potentials
        if self.case.get("interface_magnetic") == "insulated":
            potentials.pop("magnetic_potential", None)
        pairs: Pairs = [(self.contact.potential(number), self.quantities[name]) for name, number in potentials.items()]
        return [(self.contact.depth, self.quantities["depth"]), *pairs]

    @property
    def edges(self) -> Pairs:
        """Edge intensities."""
        names = {ELECTRIC: "electric_edge_intensity", MAGNETIC: "magnetic_edge_intensity"}
        return [(self.contact.edge_intensities(k), self._at_ends(names[k])) for k in self._potentials.values()]

    @property
    def surface(self) -> Pairs:
        """Tractions under the punch, and the stress outside the contact."""
        below, exterior = self.contact.fields(X, 0.0), self.contact.fields(BESIDE, 0.0)
        solved, solved_exterior = solver.solve(self.case, X), solver.solve(self.case, BESIDE)
        return [
            (-below["stress_yy"], solved["contact_pressure"]),
            *((below[name], solved[name]) for name in FLUXES),
            (exterior["stress_xx"], solved_exterior["stress_xx"]),
        ]

    @property
    def inside(self) -> Pairs:
        """Fields half way down each layer, above its lower side, and in the base.

        Fields of one unit are compared together, so that errors of small ones are relative to the large ones.
        """
        places, top = [], 0.0
        for number, (_, thickness) in enumerate(layers_of(self.case)):
            places += [(number, top + thickness / 2), (number, (top + thickness) * _ABOVE)]
            top += thickness
        if self.contact.base is not None:
            places.append((number + 1, 1.5 * top))
        rows = [self.contact.fields(WHERE, depth, layer) for layer, depth in places]
        Y = -np.array([depth for _, depth in places]) / self.contact.half_length
        solved = solver.solve_interior(self.case, WHERE, Y, fields=FIELDS)
        return [
            ([[row[name] for row in rows] for name in names], [solved[name] for name in names]) for names in _BY_UNIT
        ]

    @property
    def interface(self) -> Pairs:
        """Largest shear, and largest tension or 0."""
        tractions = self.contact.interface(len(self.contact.layers) - 1)
        extremes = [tractions["shear"], max(tractions["tension"], 0.0)]
        return [(extremes, [self.quantities[name] for name in EXTREMES])]

    @property
    def beside(self) -> Pairs:
        """Potential of the surface outside the contact, and the voltage that its error is relative to."""
        place, phi = self.contact.exterior(ELECTRIC)
        compared = np.flatnonzero((np.abs(place) > _IN_AIR[0]) & (np.abs(place) < _IN_AIR[1]))[::5]
        inside = solver.solve_interior(self.case, place[compared], [0.0], fields=["electric_potential"])
        potentials = phi[compared], inside["electric_potential"].values[0]
        computed, expected = (np.append(values, self.contact.potential(ELECTRIC)) for values in potentials)
        return [(computed, expected)]

    @property
    def _potentials(self) -> dict[str, int]:
        """Return the numbers of the potentials that the punch makes uniform, by name."""
        return {name: number for name, number in POTENTIALS.items() if number in self.contact.punch.conducted}

    def _at_ends(self, name: str) -> list[xr.DataArray]:
        """Return a quantity of the solver at the trailing and at the leading end."""
        return [self.quantities[f"{name}_{end}"] for end in ("trailing", "leading")]
