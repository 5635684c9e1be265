"""The closed form against a numerical solution of the singular integral equations (2.2): Gauss-Jacobi collocation."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, partial
from itertools import product
from math import comb
from time import perf_counter

import numpy as np
import xarray as xr

import solver
from verification.cases import SIH_SONG, Array, Case, constants, half_length
from verification.findings import Check, Curve, Findings, Sizes, Timing, check, off
from verification.oracles import collocation
from verification.oracles.surface_response import SurfaceResponse, surface_response

RADIUS, WIDTH, SLOPE = 0.05, 4e-4, 2e-3
LOADS = {"load": 1e5, "friction": 0.5, "charge": 1e-6, "magnetic_charge": -2e-3, "datum": 0.2}
TOLERANCE = 1e-8


def _polynomial(*slope: float) -> solver.Profile:
    """Return a punch without corners whose slope has the given coefficients, in ascending powers of x."""
    return solver.Profile(tuple(map(np.array, slope)), (True, True))


#: Factors of each punch, and the same punch for the collocation.
PUNCHES: dict[str, tuple[Case, collocation.Profile]] = {
    "cylinder": ({"radius": RADIUS}, collocation.cylinder(RADIUS)),
    "flat": ({"profile": "flat", "width": WIDTH}, collocation.flat(WIDTH)),
    "tilted flat": ({"profile": "flat", "width": WIDTH, "slope": 1e-4}, collocation.flat(WIDTH, 1e-4)),
    "wedge": ({"profile": "wedge", "slope": SLOPE}, collocation.wedge(SLOPE)),
    "wedge, corner trailing": (
        {"profile": "wedge", "slope": SLOPE, "corner": "trailing"}, collocation.wedge(SLOPE, "trailing")
    ),
    "half-cylinder": ({"profile": "half_cylinder", "radius": RADIUS}, collocation.half_cylinder(RADIUS)),
    "half-cylinder, corner trailing": (
        {"profile": "half_cylinder", "radius": RADIUS, "corner": "trailing"},
        collocation.half_cylinder(RADIUS, "trailing"),
    ),
    "polynomial": (
        {"profile": _polynomial(0.0, 20.0, 4e4, 1e9)},
        collocation.Profile(lambda x: 20 * x + 4e4 * x**2 + 1e9 * x**3),
    ),
}  # fmt: skip
CONDUCTED = {(1, 2): "both", (1,): "electric", (2,): "magnetic", (): "neither"}
X = np.array([-6.0, -1.01, *np.cos(np.pi * (np.arange(40) + 0.5) / 40), 1.01, 2.5])
_TERMS = (3, 4, 6, 8)
_CIRCLE_TERMS = (4, 6, 8, 10, 12, 14, 16)
_CIRCLE_LOAD = 1e9  # presses the circle in to 0.4 of its radius, far from the parabola
_TAYLOR = 45  # degree of the slope of the circle, 0.4**46 = 5e-19
_TIMED = 10  # solutions by collocation of each punch


def run(sizes: Sizes) -> Findings:
    """Return findings for all punches and conductions at 8 terms, convergence and, if requested, times."""
    surface = surface_response(constants(solver.find(SIH_SONG)))
    compared = "ends, response and all surface fields; collocation with 8 terms"
    checks: list[Check] = [
        check(f"{name}, conducting: {fields}", compared, TOLERANCE, error, name, conducted, 8, surface)
        for (name, (conducted, fields)) in product(PUNCHES, CONDUCTED.items())
    ]  # fmt: skip
    checks.append(check("Moment", "flat punch given the moment of the collocated tilted one: its slope's response",
                        TOLERANCE, _moment, surface))  # fmt: skip
    curves = [
        Curve("collocation_terms", name, "terms", _TERMS, [error(name, (1, 2), n, surface) for n in _TERMS])
        for name in PUNCHES
    ]
    circle = cache(partial(_circle, surface))  # timed in the check
    compared = (
        f"half-width and pressure of the whole circle, and the closed form of its Taylor polynomial of degree {_TAYLOR}"
    )
    checks.append(check("Circle, 16 terms", compared, TOLERANCE, lambda: circle()[-1]))
    words = "circle pressed in to 0.4 of its radius"
    curves.append(Curve("collocation_circle", words, "terms", _CIRCLE_TERMS, circle()))
    return Findings(
        "Integral equations",
        "A numerical solution of the three coupled singular integral equations, for every punch and conduction. It "
        "shares no code with the closed form: even the constants of the half-plane are its own, by angular integrals.",
        checks,
        curves,
        [_timing(name, surface, sizes) for name in PUNCHES] if sizes.timed else [],
    )


def case_of(name: str, conducted: tuple[int, ...] = (1, 2)) -> Case:
    """Return the case of a named, charged punch on a magneto-electro-elastic half-plane."""
    case = {"material": SIH_SONG, **PUNCHES[name][0], **LOADS}
    for i, field, charge in ((1, "electric", "charge"), (2, "magnetic", "magnetic_charge")):
        if i not in conducted:
            case |= {field: "insulating", charge: 0.0}
    return case


def _problem(name: str, case: Case, terms: int, surface: SurfaceResponse) -> collocation.Problem:
    conducted = tuple(
        i for i, field in ((1, "electric"), (2, "magnetic")) if case.get(field, "conducting") == "conducting"
    )
    return collocation.Problem(
        surface.normal_compliance, surface.shear_coupling, PUNCHES[name][1], case["friction"], case["load"],
        case["charge"], case["magnetic_charge"], conducted, terms,
    )  # fmt: skip


def error(name: str, conducted: tuple[int, ...], terms: int, surface: SurfaceResponse) -> float:
    """Largest error of an end or a response over itself, or of a surface field over its largest value."""
    case = case_of(name, conducted)
    return _difference(solver.solve(case, X), collocated(name, case, terms, surface))


def collocated(name: str, case: Case, terms: int, surface: SurfaceResponse) -> dict[str, Array]:
    """Ends, response and surface fields of a case by collocation, by name."""
    return _answers(collocation.solve(_problem(name, case, terms, surface)), surface, case["datum"])


def _answers(numerical: collocation.Contact, surface: SurfaceResponse, datum: float) -> dict[str, Array]:
    """Quantities and fields of a case by collocation, by name."""
    response = zip(("depth", "voltage", "magnetic_potential"), numerical.punch_response(datum), strict=True)
    ends = {"contact_trailing": np.array(numerical.trailing), "contact_leading": np.array(numerical.leading)}
    return {**ends, **{name: np.array(value) for name, value in response}, **collocation.fields(numerical, surface, X)}


def _difference(solution: xr.Dataset, expected: dict[str, Array]) -> float:
    """Largest error; an end is compared over the half-width."""
    worst, half_width = 0.0, float(expected["contact_trailing"] + expected["contact_leading"]) / 2
    for name, value in expected.items():
        if name.startswith("contact_") and value.ndim == 0:
            worst = max(worst, abs(float(solution[name] - value)) / half_width)
        elif name in solution and np.any(value):
            worst = max(worst, off(solution[name], value))
    return worst


def _moment(surface: SurfaceResponse) -> float:
    """Relative error of the depth of a flat punch whose moment replaces its slope."""
    case = case_of("tilted flat")
    numerical = collocation.solve(_problem("tilted flat", case, 8, surface))
    right, left, weight = collocation.end_proof_nodes()
    pressure = -numerical._tractions(right, left)[0]
    moment = numerical.half_width**2 * float(np.sum(weight * pressure * (left - right) / 2))
    tilted = {name: value for name, value in case.items() if name != "slope"} | {"moment": moment}
    return _difference(solver.solve(tilted, X), _answers(numerical, surface, case["datum"]))


def _circle(surface: SurfaceResponse) -> list[float]:
    """Errors of half-width and pressure of the circle itself by the number of terms."""
    # x/sqrt(R^2 - x^2) = sum_k binomial(2k, k)/4^k (x/R)^(2k+1)
    slope = [0.0] * (_TAYLOR + 1)
    for k in range((_TAYLOR + 1) // 2):
        slope[2 * k + 1] = comb(2 * k, k) / 4**k / RADIUS ** (2 * k + 1)
    case = case_of("cylinder") | {"load": _CIRCLE_LOAD, "charge": 0.0, "magnetic_charge": 0.0}
    problem = replace(_problem("cylinder", case, 8, surface), profile=collocation.circle(RADIUS))
    del case["radius"]
    inside = X[np.abs(X) < 0.95]
    exact = solver.solve(case | {"profile": _polynomial(*slope)}, inside)
    half = half_length(exact)
    solutions = (collocation.solve(replace(problem, terms=terms)) for terms in _CIRCLE_TERMS)
    return [
        max(off(solution.half_width, half), off(-solution.tractions(inside)[0], exact.contact_pressure))
        for solution in solutions
    ]


def _timing(name: str, surface: SurfaceResponse, sizes: Sizes) -> Timing:
    """Return seconds per case with ends, response and surface fields at the same places and accuracy."""
    # the collocation gets the constants of the half-plane, which the closed form computes in every call
    terms = next(n for n in range(3, 9) if error(name, (1, 2), n, surface) <= TOLERANCE)
    random = np.random.default_rng(sizes.seed)
    varied = {
        "friction": random.uniform(0.05, 0.8, sizes.timed), "load": 10 ** random.uniform(4.5, 5.5, sizes.timed),
        "charge": random.uniform(-1e-6, 1e-6, sizes.timed), "magnetic_charge": random.uniform(-1e-3, 1e-3, sizes.timed),
    }  # fmt: skip
    case = case_of(name)
    batch = case | {key: xr.DataArray(values, dims="case") for key, values in varied.items()}
    singles = [
        case | {key: float(values[i]) for key, values in varied.items()} for i in range(min(_TIMED, sizes.timed))
    ]
    numerical = [partial(collocated, name, single, terms, surface) for single in singles]
    whole = solver.solve(batch, X)
    worst = max(_difference(whole.isel(case=i), run_one()) for i, run_one in enumerate(numerical))
    return Timing(
        name,
        worst,
        _seconds(numerical) / len(singles),
        _seconds([partial(solver.solve, single, X) for single in singles]) / len(singles),
        min(_seconds([partial(solver.solve, batch, X)]) for _ in range(3)) / sizes.timed,
    )


def _seconds(calls: Sequence[Callable[[], object]]) -> float:
    """Return the time of successive calls [s]."""
    start = perf_counter()
    for call in calls:
        call()
    return perf_counter() - start
