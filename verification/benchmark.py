"""The table of solved problems in docs/benchmark.md, with every number by the solver and by an independent method.

``python -m verification.benchmark > docs/benchmark.csv`` writes the table in two minutes.
"""

import csv
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from math import floor, log10
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import brentq, root

import solver
from solver.names import ALL_QUANTITIES, FACTORS
from solver.surface.response import NORMAL, PHI, SurfaceBody
from verification import integral_equations, points
from verification.cases import CHARGED, SIH_SONG, Array, Case, constants, half_length
from verification.film_elements import POTENTIALS, SLIDING, elements
from verification.oracles import precise, surface
from verification.oracles.fem_film import FilmContact, Layer, Punch
from verification.oracles.sample_materials import hexagonal, lithium_niobate, quartz
from verification.oracles.surface_response import surface_response

COLUMNS = ("problem", "quantity", "units", "value", "digits", "first", "second")
MOST_DIGITS, COUNTED = 10, 12  # printed digits, and digits of an agreement that are counted
#: Orders of the finite elements: of layers under lines, with air, above an electrode, and under balls.
LINE_ORDER, AIR_ORDER, ELECTRODE_ORDER, POINT_ORDER = 16, 10, 12, 14
HARMONICS, REACH = 4, 200.0  # of nested punches; the reach of the charge in air is in semi-axes
TERMS = 12  # of the collocation of integral equations

_CLOSED, _GALERKIN = "closed form", "integral equations in Fourier space"
_DIGITS, _COLLOCATED = "50 digits", "collocation of singular integral equations"
_ELEMENTS, _SERIES = "spectral finite elements", "Fredholm equation of a bonded elastic layer"
_GRID, _NESTED, _POLYNOMIAL = "grid of cells", "nested elliptical punches", "polynomials on an ellipse"
_LINE: Case = {"material": "PZT-4", "thickness": 1e-4, "base": "rigid", "radius": 0.05} | {
    "surroundings": "insulated", "magnetic": "insulating", "charge": 1e-6,
}  # fmt: skip
_BALL: Case = {"profile": "sphere", "surroundings": "insulated", "magnetic": "insulating"}


Answers = Mapping[str, Any] | xr.Dataset  # of a method, by quantity


@dataclass(frozen=True)
class Number:
    """One number by two methods."""

    quantity: str
    first: float
    second: float

    @property
    def digits(self) -> int:
        """Number of digits to which both agree, at most `COUNTED`."""
        difference = abs(self.first - self.second) / abs(self.first)
        return min(COUNTED, floor(-log10(2 * max(difference, 10.0**-COUNTED / 2))))

    @property
    def text(self) -> str:
        """The first method's value with the digits to which both agree."""
        return f"{self.first:.{min(MOST_DIGITS, max(self.digits, 1)) - 1}e}"


@dataclass(frozen=True)
class Problem:
    """One problem: the two methods and the function that computes its numbers."""

    name: str
    methods: tuple[str, str]
    numbers: Callable[[], list[Number]]

    def rows(self) -> Iterator[dict[str, str]]:
        """Yield the problem's rows of the table."""
        for number in self.numbers():
            quantity = number.quantity
            values = (self.name, quantity, units(quantity), number.text, str(number.digits), *self.methods)
            yield dict(zip(COLUMNS, values, strict=True))


def units(quantity: str) -> str:
    """Return the units of a factor or quantity of the solver."""
    return next(names[quantity].units for names in (ALL_QUANTITIES, FACTORS) if quantity in names)


def _paired(first: Answers, second: Answers, names: Iterable[str]) -> list[Number]:
    return [Number(name, float(first[name]), float(second[name])) for name in names]


def cylinder() -> list[Number]:
    """A charged conducting cylinder that slides on a magneto-electro-elastic half-plane."""
    exact = precise.solve(constants(solver.find(SIH_SONG)), **CHARGED)
    geometry = ("contact_trailing", "contact_leading", "peak_pressure", "depth", "voltage", "magnetic_potential")
    names = (*geometry, "trailing_tension", "charge_per_force", "stroke_per_volt")
    return _paired(solver.solve({"material": SIH_SONG} | CHARGED), exact.quantities, names)


def cornered(name: str) -> list[Number]:
    """A punch with corners on the same half-plane."""
    case, surface = integral_equations.case_of(name), surface_response(constants(solver.find(SIH_SONG)))
    answers = integral_equations.collocated(name, case, TERMS, surface)
    longest = max("contact_leading", "contact_trailing", key=lambda end: float(answers[end]))
    names = ("depth", "voltage", "magnetic_potential")
    return _paired(solver.solve(case), answers, names if name == "tilted flat" else (longest, *names))


def film(case: Case, half: float, order: int = LINE_ORDER) -> list[Number]:
    """A cylinder on a film, at a half-length of the contact [m], by elements of an order."""
    loaded = case | {"load": _pressed(case, "load", half)}
    solved = solver.solve(loaded)
    contact = elements(loaded, float(half_length(solved)), order)
    computed = {"load": contact.load}
    if loaded.get("friction"):
        computed["contact_trailing"] = contact.half_length + contact.centre
    if loaded["base"] == "rigid":  # on a half-plane the depth depends on its datum
        computed["depth"] = contact.depth
    computed |= {name: contact.potential(number) for name, number in POTENTIALS.items() if name in solved}
    return _paired(solved.assign(load=loaded["load"]), computed, computed)


def _pressed(case: Case, load: str, size: float) -> float:
    """Return the load or force at which the half-length or radius of the contact has a size [m]."""

    def excess(logarithm: float) -> float:
        solved = solver.solve(case | {load: float(np.exp(logarithm))})
        return float(half_length(solved) if load == "load" else solved["contact_radius"]) / size - 1

    first = np.log({"load": 1e3, "force": 1e-3}[load])  # small, since tables of long contacts take more time
    step = -np.copysign(np.log(3), excess(first))
    while np.sign(excess(first + step)) == np.sign(-step):
        first += step
    return float(np.exp(brentq(excess, first, first + step, xtol=1e-14, rtol=1e-14)))


def strips() -> list[Number]:
    """Strips of the electrode between a cover and a film, under an insulating cylinder that slides."""
    cover, film, base = solver.find("glass"), solver.find("PZT-4"), solver.find("silicon")
    thin, thick, half, size, place, pitch = 1e-4, 2e-4, 2e-4, 2e-4, 5e-5, 3e-4
    case: Case = {
        "body": solver.Stack([solver.Layer(cover, thin, "grounded"), solver.Layer(film, thick, "grounded")], base),
        "radius": 0.05, "friction": 0.3, "surroundings": "insulated", "electric": "insulating",
        "magnetic": "insulating", "collector": 1, "patch_size": size, "patch_position": place, "patch_pitch": pitch,
    }  # fmt: skip
    case["load"] = _pressed(case, "load", half)
    layers = [Layer(constants(cover), thin), Layer(constants(film), thick)]
    punch = Punch(case["radius"], case["friction"], conducted=())
    other = FilmContact(layers, constants(base), punch, half, ELECTRODE_ORDER)
    x, weights = np.polynomial.legendre.leggauss(40)

    def strip(middle: float) -> float:
        """Return the charge of a strip per load, from the jump of D_y over the electrode."""
        above, below = (
            other.fields((middle + size / 2 * x) / half, thin, layer)["electric_displacement_y"] for layer in (0, 1)
        )
        return float(weights @ (above - below) * size / 2 / other.load)

    answers = {
        "load": other.load,
        "contact_trailing": other.half_length + other.centre,
        "electrode_pressure": -float(other.fields([0.0], thin)["stress_yy"][0]),
        "patch_charge_per_force": strip(place),
        "crosstalk": strip(pitch) / strip(0.0),
    }
    return _paired(solver.solve(case).assign(load=case["load"]), answers, answers)


def ball() -> list[Number]:
    """A charged ball on a magneto-electro-elastic half-space."""
    names = ("contact_radius", "depth", "peak_pressure", "voltage", "magnetic_potential", "charge_per_force")
    return _paired(*points.precise(*points.PROFILES[0]), (*names, "contact_stiffness"))


def ball_on_film(case: Case, radius: float) -> list[Number]:
    """A charged ball on a film, at a radius of the contact [m]."""
    pressed = case | {"force": _pressed(case, "force", radius)}
    solved, other = points.by_elements(pressed, POINT_ORDER)
    answers = {"force": other.force, "depth": other.depth, "voltage": other.voltage}
    return _paired(solved.assign(force=pressed["force"]), answers, answers)


def disc() -> list[Number]:
    """A disc on an elastic layer bonded to a rigid base, nu = 0.3, a = h (Hayes et al., J. Biomech. 5 (1972) 541)."""
    modulus, poisson, width, h = 210e9, 0.3, 2e-3, 1e-3
    layer = {
        "material": solver.Material.isotropic(modulus, poisson),
        "electric": "insulating",
        "magnetic": "insulating",
    }
    case = layer | {"profile": "disc", "width": width, "thickness": h, "base": "rigid", "surroundings": "insulated"}
    stiffness = float(solver.solve(case | {"force": 1.0})["contact_stiffness"])
    half_space = modulus / (1 - poisson**2) * width
    return [Number("contact_stiffness", stiffness, half_space * points.hayes(poisson, width / 2 / h))]


def grounded(case: Case, body: surface.Body, curvatures: tuple[float, float], **air: float) -> list[Number]:
    """A punch at zero volts in space."""
    state = surface.Press(body, curvatures, case["force"], harmonics=HARMONICS, **air).contact()
    fine = case | {"magnetic": "insulating", "grid_error": 2e-4}
    charge = float(solver.solve(fine)["charge_per_force"])
    depth = float(solver.solve(fine | {"total_charge": charge * case["force"]})["depth"])
    numbers = {"charge_per_force": charge, "depth": depth}
    return _paired(numbers, {"charge_per_force": state.charge / case["force"], "depth": state.depth}, numbers)


def ellipsoid_on_film() -> list[Number]:
    """A grounded ellipsoid on a film, D_z = 0 outside the contact."""
    case = _FILM | {"profile": "ellipsoid", "radius_x": 5e-3, "radius_y": 20e-3, "force": 4.0}
    body = surface.body(hexagonal(constants(solver.find("PZT-4"))), thickness=case["thickness"])
    return grounded(case, body, (1 / case["radius_x"], 1 / case["radius_y"]))


def ball_on_niobate(cut: str, angle: float | None) -> list[Number]:
    """A grounded ball on a cut of lithium niobate in air."""
    case: Case = {"material": f"{cut} LiNbO3", "profile": "sphere", "radius": 5e-3, "force": 10.0}
    curvature = 1 / case["radius"]
    return grounded(case, surface.body(lithium_niobate(angle)), (curvature, curvature), reach=REACH, end=case["radius"])


def ellipsoid_on_quartz() -> list[Number]:
    """A grounded ellipsoid on an X cut of quartz, D_z = 0 outside the contact."""
    curvatures, force = (200.0, 50.0), 1.0
    state = surface.Press(surface.body(quartz()), curvatures, force, harmonics=HARMONICS).contact()
    answers = {
        "charge_per_force": state.charge / force,
        "depth": state.depth,
        "peak_pressure": state.central_pressure,
        "contact_area": np.pi * abs(np.linalg.det(state.axes)),
    }
    whole = SurfaceBody((), solver.find("quartz").stiffness_tensor("X"))
    return _paired(elliptic(whole, curvatures, force), answers, answers)


def elliptic(body: SurfaceBody, curvatures: tuple[float, float], force: float) -> dict[str, float]:
    """Solve a grounded punch of gap (x^2 curvatures[0] + y^2 curvatures[1])/2 on a half-space, no field outside it.

    On the ellipse x = A xi, pressure p (1 - |xi|^2)^(1/2) and charge density (q + xi.Q xi) (1 - |xi|^2)^(-1/2) have
    polynomials as Radon transforms. If the response Y to waves is real, displacement and potential are polynomials too.
    """
    angles = np.linspace(0.0, np.pi, 64, endpoint=False)  # Y(theta + pi) = Y(theta)
    response = body.multiplier(np.array([np.inf]), angles)[0][:, [[NORMAL], [PHI]], [NORMAL, PHI]].real
    normals = np.stack([np.cos(angles), np.sin(angles)])
    quadratic = np.array([1.0, -1.0, 0.0, -1.0])  # 1 - |xi|^2 in 1, xi_1^2, xi_1 xi_2, xi_2^2
    totals = 2 * np.pi * np.array([1.0, 1 / 3, 0.0, 1 / 3])  # integrals of these densities

    def fields(shape: Array) -> tuple[Array, float, Array, Array, Array]:
        """Return A, peak pressure, density of D_z, polynomials of u_z and of the punch's height over its apex."""
        axes = shape[[[0, 2], [2, 1]]]
        width = np.hypot(*(axes.T @ normals))
        c, s = axes.T @ normals / width
        along, across = np.stack([c**2, c * s, s**2]), np.stack([s**2, -c * s, c**2])
        radon = np.zeros((4, 4, angles.size))  # polynomial, by density
        radon[0, 0], radon[0, 1:] = np.pi, np.pi / 2 * across
        radon[1:, 1:] = (along * [[1], [2], [1]])[:, None] * (np.pi * along - np.pi / 2 * across)
        area = float(np.linalg.det(axes))
        whole = np.einsum("pda,aij->ijpd", radon * area / width, response) / (2 * angles.size)
        peak = 1.5 * force / np.pi / area
        density = np.linalg.solve(whole[1, 1], whole[1, 0] @ quadratic * peak)
        gap = axes.T @ (np.array(curvatures)[:, None] * axes) / 2
        heights = np.array([0.0, gap[0, 0], 2 * gap[0, 1], gap[1, 1]])
        return axes, peak, density, whole[0, 1] @ density - whole[0, 0] @ quadratic * peak, heights

    def misfit(shape: Array) -> Array:
        """Return the differences of the curvatures of surface and punch, over one of the punch's, (3,)."""
        *_, lowered, heights = fields(shape * size)
        return np.asarray((lowered - heights)[1:] / heights[1])

    size = (force * response[:, 0, 0].mean() / float(np.hypot(*curvatures))) ** (1 / 3)
    axes, peak, density, lowered, _ = fields(root(misfit, [1.0, 1.0, 0.0], tol=1e-14).x * size)
    area = float(np.linalg.det(axes))
    return {
        "charge_per_force": -area * float(totals @ density) / force,
        "depth": -float(lowered[0]),
        "peak_pressure": peak,
        "contact_area": np.pi * area,
    }


_POINT_FILM: Case = _BALL | {"material": "PZT-4", "thickness": 1e-4, "base": "rigid", "radius": 5e-3}
_FILM: Case = {"material": "PZT-4", "thickness": 1e-4, "base": "rigid", "surroundings": "insulated"}
_ALLOY: Case = _BALL | {
    "composite": "AlScN", "scandium_fraction": 0.3, "thickness": 1e-6, "base": "silicon", "radius": 1e-4,
}  # fmt: skip
_STEEL: Case = {
    "radius": 0.05, "surroundings": "insulated", "volume_fraction": 0.5, "thickness": 2e-4,
    "friction": 0.3, "base": "steel", "interface_magnetic": "grounded",
}  # fmt: skip

PROBLEMS: tuple[Problem, ...] = (
    Problem("cylinder-half-plane", (_CLOSED, _DIGITS), cylinder),
    Problem("tilted-flat-half-plane", (_CLOSED, _COLLOCATED), partial(cornered, "tilted flat")),
    Problem("wedge-half-plane", (_CLOSED, _COLLOCATED), partial(cornered, "wedge")),
    *(
        Problem(f"cylinder-film-{ratio}", (_GALERKIN, _ELEMENTS), partial(film, _LINE, float(ratio) * 1e-4))
        for ratio in ("0.2", "1", "5")
    ),
    Problem("composite-film-on-steel", (_GALERKIN, _ELEMENTS), partial(film, _STEEL, 2e-4)),
    Problem("film-in-air", (_GALERKIN, _ELEMENTS), partial(film, SLIDING, 1e-4, AIR_ORDER)),
    Problem("ball-half-space", (_CLOSED, _DIGITS), ball),
    Problem("ball-film", (_GALERKIN, _ELEMENTS), partial(ball_on_film, _POINT_FILM | {"total_charge": 2e-9}, 1e-4)),
    Problem(
        "ball-alscn-on-silicon", (_GALERKIN, _ELEMENTS), partial(ball_on_film, _ALLOY | {"total_charge": 1e-14}, 1e-6)
    ),
    Problem("disc-layer", (_GALERKIN, _SERIES), disc),
    Problem("strips-of-electrode", (_GALERKIN, _ELEMENTS), strips),
    Problem("ellipsoid-film", (_GRID, _NESTED), ellipsoid_on_film),
    Problem("ellipsoid-x-quartz", (_POLYNOMIAL, _NESTED), ellipsoid_on_quartz),
    Problem("ball-z-lithium-niobate", (_GRID, _NESTED), partial(ball_on_niobate, "Z", None)),
    Problem("ball-36y-lithium-niobate", (_GRID, _NESTED), partial(ball_on_niobate, "36Y", 36.0)),
)


def main() -> None:
    """Write the table to standard output."""
    table = csv.DictWriter(sys.stdout, COLUMNS, lineterminator="\n")
    table.writeheader()
    for problem in PROBLEMS:
        table.writerows(problem.rows())
        sys.stdout.flush()


if __name__ == "__main__":
    main()
