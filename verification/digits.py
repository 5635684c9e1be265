"""Every quantity and field of random and extreme cases against an evaluation in 50 digits."""

import numpy as np
from mpmath import isnan

import solver
from verification.cases import CHARGED, SIH_SONG, Case, constants
from verification.findings import Check, Findings, Sizes, check, off, off_each
from verification.oracles import interior, precise

X = (-1e4, -1.2, -0.999, 0.1, 0.8, 30.0)
X_TO_THE_EDGES = (-1e4, -3.0, -1 - 1e-7, -1 + 1e-7, -0.5, 0.7, 1 - 1e-7, 1 + 1e-7, 1e4)
X_INSIDE, Y_INSIDE = (-3.0, -0.9, 0.2), (-3.0, -1.0, -0.3)
TOLERANCE = 1e-11
_KINDS = ("conducting", "insulating")
_HUGE = {"radius": 1e6, "load": 1e6, "charge": -1e-5, "magnetic_charge": 2e-2, "datum": 3e5}
_TINY = {"radius": 1e-6, "load": 1e-6, "charge": -1e-17, "magnetic_charge": 2e-14, "datum": 3e5}
EXTREMES: dict[str, Case] = {
    "no friction": {"friction": 0.0},
    "next to no friction": {"friction": 1e-12},
    "steep friction": {"friction": 10.0},
    "huge": _HUGE,
    "tiny": _TINY,
    "charges that dwarf the load": {"load": 1e-6},
    "coalescing roots": {"material": "steel", "friction": 0.8},
    "nearly coalescing roots": {"material": "BaTiO3"},
    "moving": {"speed": 900.0},
}


def run(sizes: Sizes) -> Findings:
    """Random cases, extremes, interior fields."""
    random = np.random.default_rng(sizes.seed)
    cases = {_description(case): case for case in (_random(random) for _ in range(sizes.cases))}
    compared = "all quantities and surface fields, each over its own size"
    checks: list[Check] = [
        check(f"{kind}: {name}", compared, TOLERANCE, _surface_error, case, places)
        for kind, group, places in (("Random", cases, X), ("Extreme", _extremes(), X_TO_THE_EDGES))
        for name, case in group.items()
    ]
    checks += [
        check(f"Interior: {name}", "all fields inside, each over its largest", TOLERANCE,
              _interior_error, case)
        for name, case in _extremes().items()
    ]  # fmt: skip
    return Findings(
        "50 digits",
        "Every quantity and field against an evaluation in 50 digits (mpmath), on random cases and at the extremes. "
        "The tractions under the punch follow the theory's formula, which collocation and finite elements judge above; "
        "the constants come from angular integrals, and all that follows from the tractions from quadrature, a search, "
        "limits and differences.",
        checks,
    )


def _extremes() -> dict[str, Case]:
    return {name: {"material": SIH_SONG, **CHARGED, **change} for name, change in EXTREMES.items()}


def _random(random: np.random.Generator) -> Case:
    """Return a random case from the wide ranges of the solver's inputs."""
    electric, magnetic = (str(kind) for kind in random.choice(_KINDS, 2, p=(0.7, 0.3)))
    load = float(10 ** random.uniform(1, 6))
    return {
        "material": str(random.choice([name for name, material in solver.materials().items() if material.axial])),
        "radius": float(10 ** random.uniform(-3, 0)),
        "friction": float(random.choice([0.0, random.uniform(0, 1), random.uniform(1, 3)])),
        "load": load,
        "charge": load * float(random.uniform(-1e-10, 1e-10)) if electric == "conducting" else 0.0,
        "magnetic_charge": load * float(random.uniform(-1e-7, 1e-7)) if magnetic == "conducting" else 0.0,
        "datum": float(10 ** random.uniform(1, 2)),
        "electric": electric,
        "magnetic": magnetic,
    }


def _description(case: Case) -> str:
    numbers = ", ".join(f"{name} {case[name]:.2g}" for name in ("radius", "friction", "load"))
    return f"{case['material']}, {numbers}, {case['electric']}/{case['magnetic']}"


def _surface_error(case: Case, places: tuple[float, ...]) -> float:
    """Largest relative error of a quantity or of a surface field at a place."""
    solved = solver.solve(case, places)
    factors = {name: value for name, value in case.items() if name != "material"}
    exact = precise.solve(constants(solver.find(case["material"])), positions=places, **factors)
    known = {name: value for name, value in exact.quantities.items() if not isnan(value)}
    quantities = max(off_each(solved[name], float(value)) for name, value in known.items())
    return max(quantities, *(off_each(solved[name], np.array(v, float)) for name, v in exact.fields.items()))


def _interior_error(case: Case) -> float:
    """Largest error of a field inside, over its largest value."""
    material = solver.find(case["material"])
    points = [(x, y) for y in Y_INSIDE for x in X_INSIDE]
    factors = {name: value for name, value in case.items() if name not in ("material", "datum")}
    exact = interior.solve(constants(material), points, **factors)
    solved = solver.solve_interior(case, X_INSIDE, Y_INSIDE, fields=list(exact))
    return max(off(solved[name].values.ravel(), values) for name, values in exact.items())
