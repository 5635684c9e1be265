"""Cases of films, and the solver's answers for them."""

from dataclasses import dataclass
from functools import cached_property

import solver
from verification.cases import Array, Case, half_length
from verification.oracles.fem import FIELDS

Answers = dict[str, Array]
PUNCH: Case = {"radius": 0.05, "load": 1e5, "surroundings": "insulated"}
COMPOSITE: Case = {**PUNCH, "volume_fraction": 0.5, "thickness": 2e-4, "friction": 0.3}
STACK = solver.Stack([solver.Layer(solver.find("BaTiO3"), 1e-4), solver.Layer(solver.find("CoFe2O4"), 1.5e-4)], "rigid")
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

    @cached_property
    def half_length(self) -> float:
        """(a + b)/2 [m]."""
        return float(half_length(solver.solve(self.case)))

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
