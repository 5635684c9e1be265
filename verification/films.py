"""Films against known results: limits (theory of films, section 8), balance, Betti, finer resolution."""

from collections.abc import Callable
from functools import cache, partial

import numpy as np
import xarray as xr

import solver
from solver.halfplane.sliding import Sliding
from solver.halfplane.surface import HalfPlane
from solver.line import outputs
from solver.line.kernel import kernel
from solver.line.system import System
from solver.line.table import at
from solver.stack.layers import RIGID, Layer, Stack
from verification.cases import SIH_SONG, Array, Case, half_length, own_base_error
from verification.findings import Check, Curve, Findings, Sizes, check, off, off_each

CHARGED: Case = {"load": 1e5, "friction": 0.4, "datum": 0.2}
CHARGES = {"electric": ("charge", 2e-6), "magnetic": ("magnetic_charge", -3e-3)}
PROFILES: dict[str, Case] = {
    "cylinder": {"radius": 0.05},
    "tilted flat punch": {"profile": "flat", "width": 4e-4, "slope": 1e-4},
    "wedge": {"profile": "wedge", "slope": 4e-3},
    "half cylinder": {"profile": "half_cylinder", "radius": 0.05},
}
COMPOSITE: Case = {"radius": 0.05, "load": 1e5, "volume_fraction": 0.5, "friction": 0.3}
SILICON: Case = {"surroundings": "insulated", "base": "silicon", "interface_electric": "bonded"}
#: Half-length of a film ten and a hundred half-lengths thick over the closed form's, less 1: theory of films, 9 and 10.
THICK: dict[str, tuple[Case, tuple[float, float]]] = {
    "rigid base": ({"surroundings": "insulated", "base": "rigid"}, (-3.6e-3, -3.7e-5)),
    "silicon": (SILICON, (-8.4e-4, -8.4e-6)),
}
RATIOS = np.array([0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0])
THIN = 1e-4  # thickness of thin films [m]
FINER = 1.5  # times as many terms


def run(_: Sizes) -> Findings:
    """Return the findings on films."""
    compared = "every quantity of a film of its own base, four kinds of conduction, and of the half-plane"
    checks = [
        *(check(f"Film of its own base: {name}", compared, 1e-11, _own_base, case) for name, case in PROFILES.items()),
        *(check(f"Thick film on a {name}", "half-length less the closed form's, and the theory's, at 10 and 100 "
                "half-lengths", 0.03, _thick, *arguments) for name, arguments in THICK.items()),
        check("Thin film, insulating punch", "P R h1/h^3, h1/h to 0, and 2/3 of the uniaxial modulus", 5e-4, _uniaxial),
        check("Thin film, conducting punch", "charge per load, h1/h to 0, and e33/c33", 1e-3, _thin_charge),
        check("Thin incompressible film", "P R h1^3/h^5, h1/h to 0, and 2/15 of the shear modulus (Johnson 1985)", 1e-2,
              _incompressible),
        check("Totals", "P, T, J and the integrals of p, D_y, B_y", 1e-12, _totals),
        check("Betti", "flat punch: d depth/dT and -dV/dP, d depth/dJ and -dPsi/dP, dV/dJ and dPsi/dT", 1e-12, _betti),
    ]  # fmt: skip
    resolution, curves = _resolved()
    return Findings(
        "Films",
        "Films through solver.solve against the half-plane's closed form, textbook limits, balance and reciprocity; "
        f"and their equations at the default resolution against {FINER} times as many terms, over half-lengths from "
        "0.01 to 30 thicknesses.",
        checks + resolution,
        curves,
    )


def _own_base(punch: Case) -> float:
    """Largest relative difference between the half-plane and a film of the same material on it."""
    worst = 0.0
    for fields in ((), ("electric",), ("magnetic",), ("electric", "magnetic")):
        case = {**CHARGED, **punch, "material": SIH_SONG}
        case |= dict.fromkeys(set(CHARGES) - set(fields), "insulating") | dict(CHARGES[kind] for kind in fields)
        worst = max(worst, own_base_error(case, 2e-4))
    return worst


def _thick(base: Case, expected: tuple[float, float]) -> float:
    """Largest relative error of the shortening of the contact by films of 10 and 100 half-lengths."""
    half = half_length(solver.solve(COMPOSITE))
    films = (solver.solve(COMPOSITE | base | {"thickness": ratio * half}) for ratio in (10.0, 100.0))
    return off_each([half_length(film) / half - 1 for film in films], expected)


def _uniaxial() -> float:
    """Error of the load of a thin film of BaTiO3 on a rigid base, under an insulating punch."""
    material = solver.find("BaTiO3")
    expected = 2 / 3 * float(material.c33 + material.e33**2 / material.eps33)
    return _modulus_error({"material": material, "electric": "insulating", "magnetic": "insulating"}, expected, 3)


def _thin_charge() -> float:
    """Error of the charge per load of a thin film of BaTiO3 on a rigid base at zero volts."""
    material = solver.find("BaTiO3")
    ratios, thin = _thin({"material": material}, 2 / 3 * float(material.c33), 3)
    return off(_limit(ratios, thin.charge_per_force.values), float(material.e33 / material.c33))


def _incompressible() -> float:
    """Error of the load of a thin incompressible film on a rigid base."""
    shear, poisson = 1e9, 0.4999999
    case = {"material": solver.Material.isotropic(2 * shear * (1 + poisson), poisson), "electric": "insulating"}
    return _modulus_error(case | {"magnetic": "insulating"}, 2 / 15 * shear, 5)


def _modulus_error(case: Case, modulus: float, power: int) -> float:
    """Error of the modulus P R h1^(power - 2)/h^power of a thin film on a rigid base."""
    ratios, solution = _thin(case, modulus, power)
    return off(_limit(ratios, solution["load"].values * 0.05 / THIN**2 / ratios**power), modulus)


def _thin(case: Case, modulus: float, power: int) -> tuple[Array, xr.Dataset]:
    """Return h/h1 of a film on a rigid base without friction, near 7.5, 15 and 30 by its modulus, and the solutions."""
    loads = [modulus * ratio**power * THIN**2 / 0.05 for ratio in (7.5, 15, 30)]
    solved = solver.solve(
        {"radius": 0.05, "base": "rigid", "surroundings": "insulated", "thickness": THIN, "load": loads, **case}
    )
    return half_length(solved) / THIN, solved


def _limit(ratios: Array, values: Array) -> float:
    """Return the limit at h1/h = 0 of a polynomial in h1/h through the values."""
    return float(np.polyfit(1 / ratios, values, len(values) - 1)[-1])


def _totals() -> float:
    """Largest relative error of the integrals of p, -D_y and -B_y, by Gauss panels in theta = acos X."""
    case: Case = COMPOSITE | {"base": "steel", "surroundings": "insulated", "thickness": 2e-4}
    case |= {"charge": 2e-5, "magnetic_charge": 1e-2}
    nodes, weights = np.polynomial.legendre.leggauss(24)
    ends = np.array([0, 1e-3, 0.03, 0.3, 1])  # crowded where the tractions are powers of theta
    ends = np.pi / 2 * np.concatenate([ends, 2 - ends[-2::-1]])
    middle, width = (ends[1:] + ends[:-1])[:, None] / 2, np.diff(ends)[:, None] / 2
    theta, weight = (middle + width * nodes).ravel(), (width * weights).ravel()
    solved = solver.solve(case, np.cos(theta), regular=True)
    half = half_length(solved)
    pressed = solved.contact_pressure.values * np.sin(theta)
    whole = (pressed, -solved.electric_displacement_y_regular.values, -solved.magnetic_induction_y_regular.values)
    loads = [case[name] for name in ("load", "charge", "magnetic_charge")]
    return off_each([half * float(weight @ values) for values in whole], loads)


def _betti() -> float:
    """Largest relative difference of both sides of Betti's law between states of a flat punch on a film."""
    case = {"profile": "flat", "width": 4e-4, "volume_fraction": 0.5, "thickness": 2e-4, "base": "steel"}
    loads = {"load": [1e5, 2e5], "charge": [0.0, 1e-5], "magnetic_charge": [0.0, 1e-2]}
    solved = solver.solve(case | loads)
    names = ("depth", "voltage", "magnetic_potential")
    by = {k: solved.diff(k).isel({other: 0 for other in loads if other != k}) / np.diff(v)[0] for k, v in loads.items()}
    tangent = np.array([[float(by[load][name].squeeze()) for load in loads] for name in names])
    return off_each([tangent[0, 1], tangent[0, 2], tangent[1, 2]], [-tangent[1, 0], -tangent[2, 0], tangent[2, 1]])


def _systems() -> dict[str, tuple[Stack, float]]:
    """Stacks and frictions whose equations are hardest to resolve."""
    titanate, ferrite, steel = (solver.find(name) for name in ("BaTiO3", "CoFe2O4", "steel"))
    mixed = Stack((Layer(solver.fibrous(titanate, ferrite, 0.5), 1.0),), RIGID)
    soft = Stack((Layer(titanate, 1.0),), solver.Material.isotropic(5e9, 0.35))
    contrast = Stack((Layer(titanate, 1.0), Layer(ferrite, 1.0)), steel)
    return {
        "composite, rigid base": (mixed, 0.0),
        "composite, rigid base, friction 1": (mixed, 1.0),
        "BaTiO3, base of 5 GPa": (soft, 0.3),
        "permittivities 140 times apart": (contrast, 1.0),
    }


def _resolved() -> tuple[list[Check], list[Curve]]:
    """Return the errors of outputs at the default resolution over half-lengths, and curves of the load's error."""
    kinds = {
        "load": (slice(0, 1), 1e-8),
        "depth, potentials": (outputs.DISPLACEMENT, 1e-8),
        "edge intensities": (outputs.INTENSITY, 3e-8),
        "edge stress": (outputs.EDGE_STRESS, 1e-6),
    }
    checks, curves = [], []
    for name, (stack, friction) in _systems().items():
        errors = cache(partial(_errors, stack, friction))  # timed in the first check

        def worst(which: slice, errors: Callable[[], Array] = errors) -> float:
            return float(np.max(errors()[:, which]))

        checks += [
            check(f"Resolution: {what}, {name}", f"default, and {FINER} times as many terms; h/h1 from 0.01 to 30",
                  tolerance, worst, which)
            for what, (which, tolerance) in kinds.items()
        ]  # fmt: skip
        shown = np.maximum(errors()[:, 0], np.finfo(float).eps)
        curves.append(Curve("film_resolution", name, "half-length over thickness", RATIOS.tolist(), shown.tolist()))
    return checks, curves


def _errors(stack: Stack, friction: float) -> Array:
    """Return each output's largest error for every cause, over its largest value, at ``RATIOS``: (ratio, output)."""
    sliding = Sliding(HalfPlane(stack.top.material), np.array(friction), np.array([True, True]))
    span = kernel(stack, 2.01 * RATIOS[-1] * stack.top.thickness)
    coarse, fine = (at(System(span, sliding, (True, True), 1, accuracy), RATIOS) for accuracy in (1.0, FINER))
    return np.asarray(np.abs(coarse - fine).max(axis=-1) / np.abs(fine).max(axis=-1))
