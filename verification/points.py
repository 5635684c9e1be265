"""Point contacts: textbook limits, 50 digits, finite elements, reciprocity, and sliding balls by nested punches."""

import numpy as np
import xarray as xr

import solver
from verification.cases import Case, constants, own_base_error
from verification.findings import Curve, Findings, Sizes, check, off, off_each
from verification.oracles import point
from verification.oracles.fem_film import Layer
from verification.oracles.fem_point import PointContact
from verification.oracles.sample_materials import hexagonal
from verification.oracles.surface import Press, body

_MODULUS, _POISSON = 210e9, 0.3
_PLANE = _MODULUS / (1 - _POISSON**2)
_BODY = solver.Material.isotropic(_MODULUS, _POISSON)
_BARE: Case = {"material": _BODY, "electric": "insulating", "magnetic": "insulating", "force": 10.0}
_BALL: Case = {"profile": "sphere", "radius": 5e-3}
_CONE: Case = {"profile": "cone", "slope": 0.05}
_DISC: Case = {"profile": "disc", "width": 1e-4}
_POWER: Case = {"profile": "power", "exponent": 4.0, "coefficient": 1e9}
#: Exponent and coefficient of each profile, in 50 digits.
PROFILES: tuple[tuple[Case, float, float], ...] = (
    (_BALL, 2.0, 100.0),
    (_CONE, 1.0, 0.05),
    (_DISC, 0.0, 5e-5),
    (_POWER, 4.0, 1e9),
)
_INSULATED = {"surroundings": "insulated"}
_FILM: Case = {"material": "PZT-4", "thickness": 1e-4, "magnetic": "insulating", "force": 10.0} | _BALL | _INSULATED
_BASES = {"rigid": "a rigid base", "silicon": "silicon"}
#: Thickness of the film on a rigid base [m], infinite for a half-space, and reach of the air's charge over the radius.
SLIDING = {
    "half-space": (np.inf, 1.0),
    "half-space in air": (np.inf, 20.0),
    "film": (1e-4, 1.0),
    "film in air": (1e-4, 4.0),
}
_SLOW = 0.05  # friction: the second order is below 3e-5
_TENSE = ("stress_xx", "stress_yy", "stress_zz")


def run(sizes: Sizes) -> Findings:
    """Return the findings on point contacts."""
    orders = range(4, max(7, 3 + sizes.elements // 6), 2)
    checks = [
        check("Hertz, sphere", "radius, depth, largest pressure and pressure", 1e-13, _hertz),
        check("Sneddon, cone and disc", "radius and depth; depth and pressure", 1e-13, _sneddon),
        check("Huber, inside", "stresses on the axis below a sphere (Johnson 1985, 3.4)", 1e-11, _huber),
        check("Hamilton, sliding sphere", "tension behind the trailing edge (1983)", 1e-12, _hamilton),
        *(check(f"50 digits: {punch['profile']}", "quantities of a charged half-space", 1e-12, _precise, punch, *power)
          for punch, *power in PROFILES),
        check("Film of its base's own material, points", "every quantity of a half-space", 1e-11, _own_base),
        check("Hayes, Keer, Herrmann and Mockros", "stiffness of a disc on a bonded layer", 4e-6, _hayes),
        check("Thin films below balls", "P R h/a^4 to (pi/4) c33, T/P to e33/c33, extrapolated", 5e-3, _thin),
        check("Charge per force of half-spaces", "-r_1 of every profile and force, and stroke per volt", 1e-12, _alike),
        check("Reciprocity, discs on films", "charge per force and stroke per volt", 1e-12, _fixed_edge),
        check("Tangents, film", "stroke per volt and stiffness against differences of solutions", 1e-7, _tangents),
        *(check(f"Sliding ball, {name}", "offset, and odd part of pressure and of D_y; nested punches", 1e-3, sliding,
                *contact) for name, contact in SLIDING.items()),
    ]  # fmt: skip
    curves = []
    for base, words in _BASES.items():
        errors = [elements(base, order) for order in orders]
        name, tolerance = f"Finite elements: a ball on a film on {words}", 3e-7 * 10 ** (0.75 * (10 - orders[-1]))
        checks.append(check(name, "force, depth and voltage, a/h = 0.76", tolerance, max, errors[-1:]))
        curves.append(Curve("points", words, "order of the polynomials", list(orders), errors))
    return Findings(
        "Points",
        "Balls, cones, discs and powers on half-spaces and films against closed forms, 50 digits, published values, "
        "limits, reciprocity, and axisymmetric spectral elements of body and contact, which are given the "
        f"solver's radius and must find its force. Order {orders[-1]}.",
        checks,
        curves,
    )


def _hertz() -> float:
    """Largest relative error."""
    r = np.array([0.0, 0.4, 0.9])
    solved = solver.solve(_BARE | _BALL, r)
    a = (3 * _BARE["force"] * _BALL["radius"] / (4 * _PLANE)) ** (1 / 3)
    p0 = 3 * _BARE["force"] / (2 * np.pi * a**2)
    names = ("contact_radius", "depth", "peak_pressure")
    numbers = off_each([solved[name] for name in names], [a, a**2 / _BALL["radius"], p0])
    return max(numbers, off(solved["contact_pressure"], p0 * np.sqrt(1 - r**2)))


def _sneddon() -> float:
    """Largest relative error."""
    cone, disc = solver.solve(_BARE | _CONE), solver.solve(_BARE | _DISC, [0.0, 0.7])
    force, a = _BARE["force"], _DISC["width"] / 2
    radius = np.sqrt(2 * force / (np.pi * _PLANE * _CONE["slope"]))
    pressure = force / (2 * np.pi * a**2 * np.sqrt(1 - np.array([0.0, 0.49])))
    numbers = [cone["contact_radius"], cone["depth"], disc["depth"]]
    exact = [radius, np.pi / 2 * radius * _CONE["slope"], force / (2 * a * _PLANE)]
    return max(off_each(numbers, exact), off(disc["contact_pressure"], pressure))


def _huber() -> float:
    """Largest error over the largest pressure."""
    z = np.array([0.04, 0.3, 0.48, 1.0, 6.0])
    inside = solver.solve_interior(_BARE | _BALL, [0.0], -z, fields=_TENSE)
    p0 = float(solver.solve(_BARE | _BALL)["peak_pressure"])
    radial = -(1 + _POISSON) * (1 - z * np.arctan(1 / z)) + 0.5 / (1 + z**2)
    exact = {"stress_xx": radial, "stress_yy": -1 / (1 + z**2), "stress_zz": radial}
    return max(float(np.abs(inside[name].values.ravel() / p0 - value).max()) for name, value in exact.items())


def _hamilton() -> float:
    """Largest relative error, of three frictions."""
    eta = np.array([0.0, 0.25, 0.5])
    solved = solver.solve(_BARE | _BALL | {"punch": _BODY, "friction": eta})
    share = (1 - 2 * _POISSON) / 3 + eta * np.pi * (4 + _POISSON) / 8
    return off_each(solved["trailing_tension"] / solved["peak_pressure"], share)


def precise(case: Case, exponent: float, coefficient: float) -> tuple[xr.Dataset, dict[str, float]]:
    """Return a charged half-space under coefficient r^exponent by the solver and in 50 digits."""
    charges, half_space = {"total_charge": 3e-10, "total_flux": -2e-8}, "BaTiO3-CoFe2O4 50:50"
    exact = point.quantities(
        constants(solver.find(half_space)), exponent=exponent, coefficient=coefficient, force=10.0,
        charge=charges["total_charge"], magnetic_charge=charges["total_flux"],
    )  # fmt: skip
    return solver.solve({"material": half_space, "force": 10.0} | charges | case), exact


def _precise(case: Case, exponent: float, coefficient: float) -> float:
    """Largest relative error over all quantities of the oracle, under coefficient r^exponent."""
    solved, exact = precise(case, exponent, coefficient)
    names = [name for name in exact if name in solved and (name != "peak_pressure" or exponent <= 2)]
    return off_each([solved[name] for name in names], [exact[name] for name in names])


def _own_base() -> float:
    """Largest relative difference, sphere and disc, both fields."""
    return max(own_base_error({"material": "BaTiO3", "force": 10.0} | punch, 1e-4) for punch in (_BALL, _DISC))


def _hayes() -> float:
    """Largest relative error of the stiffness of discs of 0.2 to 2 thicknesses."""
    ratios = np.array([0.2, 0.4, 1.0, 2.0])
    discs = _BARE | _DISC | {"thickness": 1e-3, "base": "rigid", "force": 1.0, "width": 2e-3 * ratios}
    stiffness = solver.solve(discs)["contact_stiffness"] / (_PLANE * discs["width"])
    return off_each(stiffness, [hayes(_POISSON, ratio) for ratio in ratios])


def hayes(poisson: float, ratio: float) -> float:
    """Return the stiffness of a disc of `ratio` layer thicknesses on a bonded elastic layer over that on a half-space.

    f(x) + (1/pi) int_0^1 f(s) [K(x + s) + K(x - s)] ds = 1, K(u) = ratio int_0^inf (M(k) - 1) cos(ratio k u) dk with M
    the layer's compliance over the half-space's; the ratio is the integral of f.
    """
    nodes, weights = np.polynomial.legendre.leggauss(400)
    k, rule = 15 * (1 + nodes), 15 * weights  # M - 1 falls like exp(-2 k)
    e = np.exp(-2 * k)
    top = (3 - 4 * poisson) * (1 - e**2) / 2 - 2 * k * e
    bottom = (3 - 4 * poisson) * (1 + e**2) / 2 + (2 * k**2 + 5 - 12 * poisson + 8 * poisson**2) * e
    missing = rule * (top / bottom - 1)
    nodes, weights = np.polynomial.legendre.leggauss(80)
    x, weights = (1 + nodes) / 2, weights / 2
    cosines = np.cos(ratio * np.multiply.outer(x, k))
    kernel = 2 * ratio * np.einsum("xk,k,sk->xs", cosines, missing, cosines)  # cos(x+s) + cos(x-s) = 2 cos x cos s
    f = np.linalg.solve(np.eye(len(x)) + kernel * weights / np.pi, np.ones(len(x)))
    return float(weights @ f)


def _thin() -> float:
    """Largest relative error of both limits, extrapolated from two radii to an error of (h/a)^2."""
    body, h, R, ratios = solver.find("PZT-4"), 1e-4, 10.0, np.array([20.0, 40.0])
    film: Case = {"profile": "sphere", "radius": R, "thickness": h, "base": "rigid"} | _INSULATED
    forces = np.pi / 4 * float(_BODY.c33) * (ratios * h) ** 4 / (R * h)
    stiff = solver.solve(_BARE | film | {"force": forces})
    charged = solver.solve({"material": body, "force": forces} | film)
    of_force = np.pi / 4 * float(_BODY.c33) * stiff["contact_radius"] ** 4 / (R * h * forces)
    of_charge = np.abs(charged["charge_per_force"]) * float(body.c33 / body.e33)
    pairs = ((of_force, stiff["contact_radius"]), (of_charge, charged["contact_radius"]))
    return max(abs(float(np.diff(ratio * width)[0] / np.diff(width)[0]) - 1) for ratio, width in pairs)


def _alike() -> float:
    """Largest relative difference from the material's own constant."""
    values = [
        solver.solve({"material": "BaTiO3", "force": force} | punch)[name]
        for punch, *_ in PROFILES
        for force in (1e-3, 10.0)
        for name in ("charge_per_force", "stroke_per_volt")
    ]
    return off_each(values, np.full(len(values), float(values[0])))


def _fixed_edge() -> float:
    """Relative difference of charge per force and stroke per volt of a disc on films of both bases."""
    disc = {key: value for key, value in _FILM.items() if key not in _BALL} | _DISC
    solutions = [solver.solve(disc | {"base": base}) for base in _BASES]
    return max(off_each(solution["charge_per_force"], solution["stroke_per_volt"]) for solution in solutions)


def _tangents() -> float:
    """Relative difference of stroke per volt and stiffness from differences of neighbouring solutions.

    On films the edge of a conductor is singular at V = 0 too and moves. The energy that it releases is no work of the
    force, so that the slopes of charge over force and of depth over voltage differ by some percent.
    """
    weights, steps = np.array([1, -8, 8, -1]) / 12, np.array([-2, -1, 1, 2]) * 1e-3
    case, charge = _FILM | {"base": "silicon"}, 1e-9
    solution = solver.solve(case | {"total_charge": charge})
    moved = solver.solve(case | {"total_charge": charge * (1 + steps)})
    stroke = np.sum(weights * moved["depth"].values) / np.sum(weights * moved["voltage"].values)
    pressed = solver.solve(case | {"total_charge": charge, "force": case["force"] * (1 + steps)})
    open_ = case["force"] * 1e-3 / np.sum(weights * pressed["depth"].values)
    return off_each([solution["stroke_per_volt"], solution["contact_stiffness_open"]], [stroke, open_])


def sliding(thickness: float, reach: float) -> float:
    """Largest relative error of offset and odd tractions of a ball on BaTiO3 against a contact of every order."""
    radius, force, material = _BALL["radius"], 10.0, solver.find("BaTiO3")
    surface = body(hexagonal(constants(material)), _SLOW, thickness)
    state = Press(surface, (1 / radius, 1 / radius), force, reach, radius, harmonics=2).contact()
    case = {"material": material, "magnetic": "insulating", "force": force, "friction": _SLOW} | _BALL
    case |= {"total_charge": state.charge, "surroundings": "air" if reach > 1 else "insulated"}
    case |= {"thickness": thickness, "base": "rigid"} if np.isfinite(thickness) else {}
    r, pressure, charge = state.odd_tractions
    compared = ((r > 0.05) & (r < 0.93)) | ((r > 1.02) & (reach > 1))
    solved = solver.solve(case, np.concatenate([r[compared], -r[compared]]))
    errors = [off(float(solved["contact_offset"]), -state.centre[0])]  # the oracle slides the other way
    pressure[r > 1] = 0.0
    for name, expected in (("electric_displacement", charge), ("contact_pressure", pressure)):
        trailing, leading = np.split(solved[name].values.ravel(), 2)
        errors.append(off((trailing - leading) / 2, -expected[compared]))
    return max(errors)


def by_elements(case: Case, order: int) -> tuple[xr.Dataset, PointContact]:
    """Return a charged ball on a film by the solver, and by elements of an order at the solver's radius."""
    solved, composite = solver.solve(case), "scandium_fraction" in case
    material = (
        solver.aluminium_scandium_nitride(case["scandium_fraction"]) if composite else solver.find(case["material"])
    )
    layers = [Layer(constants(material), case["thickness"])]
    radius = float(solved["contact_radius"])
    below = None if case["base"] == "rigid" else constants(solver.find(case["base"]))
    return solved, PointContact(layers, below, case["radius"], radius, case["total_charge"], False, order)


def elements(base: str, order: int) -> float:
    """Largest relative error of force, depth and voltage at the solver's radius."""
    case = _FILM | {"base": base, "total_charge": 2e-9}
    solved, other = by_elements(case, order)
    values = [other.force, other.depth, other.voltage]
    return off_each(values, [case["force"], float(solved["depth"]), float(solved["voltage"])])
