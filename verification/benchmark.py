"""A table of solved problems for other codes: every number by the solver and by a method that shares no code with it.

``python -m verification.benchmark > docs/benchmark.csv`` makes the table anew, in two minutes. The problems
stand in docs/benchmark.md. A number has the digits that both methods support.
"""

import csv
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import floor, log10
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import brentq

import solver
from solver.names import FACTORS, POINT_QUANTITIES, QUANTITIES
from verification import film_air, integral_equations
from verification.cases import CHARGED, SIH_SONG, Case, constants, half_length
from verification.film_elements import Compared, Solved
from verification.oracles import collocation, point, precise
from verification.oracles.fem_film import ELECTRIC, MAGNETIC, Layer
from verification.oracles.fem_point import PointContact
from verification.oracles.surface_response import surface_response

COLUMNS = ("problem", "quantity", "units", "value", "digits", "first", "second")
#: Digits that are printed, and that an agreement counts to.
MOST_DIGITS, COUNTED = 10, 12
#: Orders of the finite elements: of layers under lines, with air, and under balls.
LINE_ORDER, AIR_ORDER, POINT_ORDER = 16, 10, 14
#: Terms of the collocation of integral equations.
TERMS = 12

_CLOSED, _GALERKIN = "closed form", "integral equations in Fourier space"
_DIGITS, _COLLOCATED = "50 digits", "collocation of singular integral equations"
_ELEMENTS, _SERIES = "spectral finite elements", "Fredholm equation of a bonded elastic layer"
_LINE: Case = {"material": "PZT-4", "thickness": 1e-4, "base": "rigid", "radius": 0.05} | {
    "surroundings": "insulated", "magnetic": "insulating", "charge": 1e-6,
}  # fmt: skip
_BALL: Case = {"profile": "sphere", "surroundings": "insulated", "magnetic": "insulating"}


#: Answers of a method by name.
Answers = Mapping[str, Any] | xr.Dataset


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
        """The first method's value with the digits that the second supports."""
        return f"{self.first:.{min(MOST_DIGITS, max(self.digits, 1)) - 1}e}"


@dataclass(frozen=True)
class Problem:
    """One problem: the two methods, and how to find its numbers."""

    name: str
    methods: tuple[str, str]
    numbers: Callable[[], list[Number]]

    def rows(self) -> Iterator[dict[str, str]]:
        """Rows of the table."""
        for number in self.numbers():
            values = (
                self.name,
                number.quantity,
                units(number.quantity),
                number.text,
                str(number.digits),
                *self.methods,
            )
            yield dict(zip(COLUMNS, values, strict=True))


def units(quantity: str) -> str:
    """Return the units of a factor or quantity of the solver."""
    return next(names[quantity].units for names in (QUANTITIES, POINT_QUANTITIES, FACTORS) if quantity in names)


def _paired(first: Answers, second: Answers, names: Sequence[str]) -> list[Number]:
    return [Number(name, float(first[name]), float(second[name])) for name in names]


def cylinder() -> list[Number]:
    """A charged conducting cylinder that slides on a magneto-electro-elastic half-plane."""
    exact = precise.solve(constants(solver.find(SIH_SONG)), **CHARGED)
    geometry = ("contact_trailing", "contact_leading", "peak_pressure", "depth", "voltage", "magnetic_potential")
    names = (*geometry, "trailing_tension", "charge_per_force", "stroke_per_volt")
    return _paired(solver.solve({"material": SIH_SONG} | CHARGED), exact.quantities, names)


def cornered(name: str) -> list[Number]:
    """A punch with corners on the same half-plane."""
    case, shape = integral_equations.PUNCHES[name]
    loads = integral_equations.LOADS
    surface = surface_response(constants(solver.find(SIH_SONG)))
    charges = loads["charge"], loads["magnetic_charge"]
    problem = collocation.Problem(
        surface.normal_compliance,
        surface.shear_coupling,
        shape,
        loads["friction"],
        loads["load"],
        *charges,
        (1, 2),
        TERMS,
    )
    contact = collocation.solve(problem)
    names = ("depth", "voltage", "magnetic_potential")
    answers = dict(zip(names, contact.punch_response(loads["datum"]), strict=True))
    answers |= {"contact_trailing": contact.trailing, "contact_leading": contact.leading}
    ends = (
        ()
        if name == "tilted flat"
        else ("contact_leading" if contact.leading > contact.trailing else "contact_trailing",)
    )
    return _paired(solver.solve({"material": SIH_SONG} | case | loads), answers, (*ends, *names))


def film(case: Case, half: float) -> list[Number]:
    """A cylinder on a film, at a half-length of the contact [m]."""
    loaded = case | {"load": _pressed(case, "load", half)}
    contact, solved = Compared(Solved(loaded), LINE_ORDER).contact, solver.solve(loaded)
    numbers = [Number("load", float(loaded["load"]), contact.load)]
    if loaded.get("friction"):
        numbers.append(
            Number("contact_trailing", float(solved["contact_trailing"]), contact.half_length + contact.centre)
        )
    if loaded["base"] == "rigid":  # on a half-plane it depends on where it is measured from
        numbers.append(Number("depth", float(solved["depth"]), contact.depth))
    potentials = {ELECTRIC: "voltage", MAGNETIC: "magnetic_potential"}
    computed = {name: contact.potential(number) for number, name in potentials.items() if name in solved}
    return [*numbers, *_paired(solved, computed, list(computed))]


def _pressed(case: Case, load: str, size: float) -> float:
    """Load or force at which the half-length or radius of the contact has a size [m]."""

    def excess(logarithm: float) -> float:
        solved = solver.solve(case | {load: float(np.exp(logarithm))})
        return float(half_length(solved) if load == "load" else solved["contact_radius"]) / size - 1

    first = np.log({"load": 1e3, "force": 1e-3}[load])  # tables of contacts far longer would take their time
    step = -np.copysign(np.log(3), excess(first))
    while np.sign(excess(first + step)) == np.sign(-step):
        first += step
    return float(np.exp(brentq(excess, first, first + step, xtol=1e-14, rtol=1e-14)))


def air() -> list[Number]:
    """A cylinder that slides on a film with air beside the contact, at a half-length of 0.1 mm."""
    case = film_air.SLIDING | {"load": _pressed(film_air.SLIDING, "load", 1e-4)}
    compared = film_air.Compared(case, AIR_ORDER)
    contact, solved = compared.contact, compared.solved
    ends = Number("contact_trailing", float(solved["contact_trailing"]), contact.half_length + contact.centre)
    voltage = Number("voltage", float(solved["voltage"]), contact.potential(ELECTRIC))
    return [Number("load", float(case["load"]), contact.load), ends, voltage]


def ball() -> list[Number]:
    """A charged ball on a magneto-electro-elastic half-space."""
    charges = {"total_charge": 3e-10, "total_flux": -2e-8}
    solved = solver.solve({"material": SIH_SONG, "force": 10.0, "profile": "sphere", "radius": 5e-3} | charges)
    exact = point.quantities(
        constants(solver.find(SIH_SONG)),
        exponent=2.0,
        coefficient=100.0,
        force=10.0,
        charge=3e-10,
        magnetic_charge=-2e-8,
    )
    names = ("contact_radius", "depth", "peak_pressure", "voltage", "magnetic_potential", "charge_per_force")
    return _paired(solved, exact, (*names, "contact_stiffness"))


def ball_on_film(case: Case, radius: float) -> list[Number]:
    """A charged ball on a film, at a radius of the contact [m]."""
    pressed = case | {"force": _pressed(case, "force", radius)}
    solved, alloyed = solver.solve(pressed), "scandium_fraction" in case
    fraction = case.get("scandium_fraction", 0.0)
    material = solver.aluminium_scandium_nitride(fraction) if alloyed else solver.find(case["material"])
    base = None if case["base"] == "rigid" else constants(solver.find(case["base"]))
    layers = [Layer(constants(material), case["thickness"])]
    other = PointContact(layers, base, case["radius"], radius, case["total_charge"], 0.0, order=POINT_ORDER)
    numbers = [Number("force", float(pressed["force"]), other.force)]
    return [*numbers, *_paired(solved, {"depth": other.depth, "voltage": other.voltage}, ("depth", "voltage"))]


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
    return [Number("contact_stiffness", stiffness, half_space * hayes(poisson, width / 2 / h))]


def hayes(poisson: float, ratio: float, points: int = 80) -> float:
    """Stiffness of a disc on a bonded elastic layer over that on a half-space, at a radius of `ratio` thicknesses.

    f(x) + (1/pi) int_0^1 f(s) [K(x + s) + K(x - s)] ds = 1, K(u) = ratio int_0^inf (M(k) - 1) cos(ratio k u) dk with M
    the layer's compliance over the half-space's; the ratio is the integral of f.
    """
    nodes, weights = np.polynomial.legendre.leggauss(400)
    k, rule = 15 * (1 + nodes), 15 * weights  # M - 1 falls like exp(-2 k)
    e = np.exp(-2 * k)
    top = (3 - 4 * poisson) * (1 - e**2) / 2 - 2 * k * e
    bottom = (3 - 4 * poisson) * (1 + e**2) / 2 + (2 * k**2 + 5 - 12 * poisson + 8 * poisson**2) * e
    missing = rule * (top / bottom - 1)
    nodes, weights = np.polynomial.legendre.leggauss(points)
    x, weights = (1 + nodes) / 2, weights / 2
    cosines = np.cos(ratio * np.multiply.outer(x, k))
    kernel = 2 * ratio * np.einsum("xk,k,sk->xs", cosines, missing, cosines)  # cos(x+s) + cos(x-s) = 2 cos x cos s
    f = np.linalg.solve(np.eye(points) + kernel * weights / np.pi, np.ones(points))
    return float(weights @ f)


_POINT_FILM: Case = _BALL | {"material": "PZT-4", "thickness": 1e-4, "base": "rigid", "radius": 5e-3}
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
    Problem("film-in-air", (_GALERKIN, _ELEMENTS), air),
    Problem("ball-half-space", (_CLOSED, _DIGITS), ball),
    Problem("ball-film", (_GALERKIN, _ELEMENTS), partial(ball_on_film, _POINT_FILM | {"total_charge": 2e-9}, 1e-4)),
    Problem(
        "ball-alscn-on-silicon", (_GALERKIN, _ELEMENTS), partial(ball_on_film, _ALLOY | {"total_charge": 1e-14}, 1e-6)
    ),
    Problem("disc-layer", (_GALERKIN, _SERIES), disc),
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
