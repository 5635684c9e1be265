"""Sliding balls of the first order in friction: against a grid that knows every order, in air against collocation."""

from dataclasses import dataclass

import numpy as np

import solver
from verification.cases import Array, Case, constants
from verification.findings import off
from verification.oracles.sliding_gap import SlidingGap
from verification.oracles.sliding_point import SlidingSphere

TOLERANCE = 3e-3  # the grid of 128 x 128: half of it on 256 x 256
_ANGLES = 24  # nodes of the moments, in the angle whose sine is r/a
_BEYOND = 1.25  # half the side of the grid's square over the contact radius
MATERIAL = "BaTiO3"
BALL: Case = {
    "material": MATERIAL, "profile": "sphere", "radius": 5e-3, "force": 10.0, "magnetic": "insulating",
}  # fmt: skip
FILM: Case = BALL | {"thickness": 6e-5, "base": "rigid", "surroundings": "insulated"}
AIR_TOLERANCE = 5e-5  # three times the collocation's own
_AIR_RADIUS, _AIR_FRICTION = 7e-5, 0.3  # of the contact in air [m]
_AIR_PLACES = 0.05, 0.93, 1.02, 8.0  # r/a at which tractions are compared, below the contact and beside it


@dataclass(frozen=True)
class Difference:
    """Grid over first order, less 1, for a grounded ball at one depth."""

    # Without friction's first order, which has no part in them
    force: float
    charge: float
    # First moments about the axis of the ball, of the first order
    force_moment: float
    charge_moment: float


def difference(case: Case, friction: float, cells: int) -> Difference:
    """Differences for a ball on a half-space or a film, at the depth that its force has at rest.

    Force and charge are over those of the same grid at rest, so that only friction tells them apart.
    """
    grounded, a, (slid, still) = _on_grids(case, friction, cells)
    first = _moments(grounded | {"friction": friction}, a)
    return Difference(
        slid["force"] / still["force"] - 1,
        slid["charge"] / still["charge"] - 1,
        slid["force_moment"] / first[0] - 1,
        slid["charge_moment"] / first[1] - 1,
    )


def raised(case: Case, friction: float, cells: int) -> tuple[float, float]:
    """Relative rise of a grounded ball's largest pressure by friction: on the grid, and in first order."""
    grounded, _, (slid, still) = _on_grids(case, friction, cells)
    peaks = solver.solve(grounded | {"friction": np.array([friction, 0.0])})["peak_pressure"].values
    return slid["peak_pressure"] / still["peak_pressure"] - 1, float(peaks[0] / peaks[1]) - 1


def _on_grids(case: Case, friction: float, cells: int) -> tuple[Case, float, tuple[dict[str, float], dict[str, float]]]:
    """The case without voltage, its contact radius at rest [m], and grids at its depth: sliding and at rest."""
    grounded = case | {"total_charge": float(solver.solve(case)["charge_per_force"]) * case["force"]}
    at_rest = solver.solve(grounded)
    a, depth = float(at_rest["contact_radius"]), float(at_rest["depth"])
    base = None if case.get("base", "rigid") == "rigid" else constants(solver.find(case["base"]))
    body = case.get("thickness", np.inf), base
    material = constants(solver.find(case["material"]))
    slid, still = (
        SlidingSphere(material, case["radius"], depth, eta, _BEYOND * a, cells, *body).solved()
        for eta in (friction, 0.0)
    )
    return grounded, a, (slid, still)


def _moments(case: Case, a: float) -> tuple[float, float]:
    """First moments of pressure and charge about the axis of the ball [N m, C m]."""
    x, w = np.polynomial.legendre.leggauss(_ANGLES)
    angle, weights = np.pi / 4 * (1 + x), np.pi / 4 * w
    r = np.sin(angle)
    solved = solver.solve(case, np.concatenate([r, -r]))
    offset = float(solved["contact_offset"])

    def moment(name: str, total: float, sign: float) -> float:
        values = solved[name].values.squeeze()
        odd = (values[: r.size] - values[r.size :]) / 2
        return total * offset + sign * np.pi * a**3 * float(np.sum(weights * np.cos(angle) * r**2 * odd))

    charge = float(case["total_charge"])
    return moment("contact_pressure", case["force"], 1.0), moment("electric_displacement", charge, -1.0)


def first_order(case: Case) -> float:
    """Largest difference of the moments at little friction, where the second order is below the grid's error."""
    differences = difference(case, 0.05, 128)
    return max(abs(differences.force_moment), abs(differences.charge_moment))


@dataclass(frozen=True)
class AirDifference:
    """Solver over collocation, less 1, for the first order of a ball in air."""

    offset: float  # Of the contact
    # Of cos(angle), largest difference over the largest value, D_y below the contact and beside it
    charges: float
    pressures: float


def in_air(thickness: float = np.inf, charge: float = 0.0) -> AirDifference:
    """Differences for a ball on BaTiO3 in air."""
    material = solver.find(MATERIAL)
    other = SlidingGap(constants(material), BALL["radius"], _AIR_RADIUS, charge, thickness)
    case = BALL | {"force": other.force, "total_charge": charge, "friction": _AIR_FRICTION, "surroundings": "air"}
    case |= {"thickness": thickness, "base": "rigid"} if np.isfinite(thickness) else {}
    first, last, start, stop = _AIR_PLACES
    compared = np.flatnonzero(((other.r > first) & (other.r < last)) | ((other.r > start) & (other.r < stop)))[::3]
    r = other.r[compared]
    solution = solver.solve(case, np.concatenate([r, -r]))

    def missed(name: str, exact: Array) -> float:
        values = solution[name].values.ravel()
        return off(((values[: r.size] - values[r.size :]) / (2 * _AIR_FRICTION))[: exact.size], exact)

    pressures = other.pressures[1]
    return AirDifference(
        float(solution["contact_offset"]) / (_AIR_FRICTION * other.offset) - 1,
        missed("electric_displacement", other.charges[1][compared]),
        missed("contact_pressure", pressures[compared[compared < pressures.size]]),
    )


def first_order_in_air(thickness: float) -> float:
    """Largest of these differences."""
    differences = in_air(thickness)
    return max(abs(differences.offset), differences.charges, differences.pressures)
