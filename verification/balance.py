"""Interior fields against the equations that they must satisfy, and against the far field."""

from collections.abc import Callable
from functools import partial

import numpy as np

import solver
from solver.fields import FIELDS as SURFACE_FIELDS
from verification.cases import CHARGED, SIH_SONG, Array, Case, constants, half_length
from verification.findings import Check, Findings, Sizes, check, off
from verification.oracles.fem import FIELDS, constitutive_matrix

CASES: dict[str, Case] = {
    "cylinder": {"material": SIH_SONG, **CHARGED},
    "tilted flat punch": {
        "material": SIH_SONG, "profile": "flat", "width": 4e-4, "slope": 1e-4, "load": 1e5, "friction": 0.3,
        "charge": 1e-6, "magnetic_charge": -2e-3,
    },
    "insulating wedge on PZT-4": {
        "material": "PZT-4", "profile": "wedge", "slope": 2e-3, "load": 1e5, "friction": 0.5, "electric": "insulating",
        "magnetic": "insulating",
    },
}  # fmt: skip
#: Components along x and along y of the conserved quantities.
FLOWS = (
    ("stress_xx", "stress_xy"),
    ("stress_xy", "stress_yy"),
    ("electric_displacement_x", "electric_displacement_y"),
    ("magnetic_induction_x", "magnetic_induction_y"),
)
POTENTIAL_FIELDS = (("electric_field_x", "electric_field_y"), ("magnetic_field_x", "magnetic_field_y"))
X, Y = np.array([-3.0, -1.1, -0.7, 0.0, 0.4, 0.95, 2.0]), np.array([-6.0, -1.0, -0.2, -0.01])
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)


def run(sizes: Sizes) -> Findings:
    """Every balance of every case."""
    measures: dict[str, tuple[str, float, Callable[[Case], float]]] = {
        "Equilibrium": (
            "resultants of stress, D and B on closed boxes inside, over those of their sides", 1e-11,
            partial(_closed_boxes, seed=sizes.seed),
        ),
        "Potentials": (
            "work of E and of H around closed boxes inside, over that along their sides", 1e-11,
            partial(_circulation, seed=sizes.seed),
        ),
        "Totals": ("resultants of stress, D and B on a box about the contact, and Q, P, T, J", 1e-10, _totals),
        "Constitutive law": ("fluxes, and those of strains, E and H by equations (1a)-(1c)", 1e-12, _constitutive),
        "Surface": ("interior fields at y = 0, and the surface solution", 1e-11, _at_surface),
        "Far field": ("r times the fields at 1e7 half-widths, and at 1e8", 1e-5, _far_field),
    }  # fmt: skip
    checks: list[Check] = [
        check(f"{what}: {name}", compared, tolerance, measure, case)
        for what, (compared, tolerance, measure) in measures.items()
        for name, case in CASES.items()
    ]
    checks.append(check("Far field: cylinder on steel", "stresses at 1e6 half-widths, and Flamant's", 1e-5, _flamant))
    return Findings(
        "Balance inside the half-plane",
        "Interior fields against equations (1) to (3), the loads, the surface solution and the far field.",
        checks,
    )


def _closed_boxes(case: Case, seed: int) -> float:
    """Largest resultant over closed boxes in the body, over the sum of the sizes of its sides' resultants."""
    worst = 0.0
    for box in _boxes(seed):
        for along_x, along_y in FLOWS:
            left, right, bottom, top = _sides(case, box, along_x, along_y)
            parts = np.concatenate([right, -left, top, -bottom])
            worst = max(worst, _remainder(parts))
    return worst


def _circulation(case: Case, seed: int) -> float:
    """Largest work around closed boxes in the body, over the sum of the sizes of its sides'."""
    worst = 0.0
    for box in _boxes(seed):
        for along_x, along_y in POTENTIAL_FIELDS:
            left, right, bottom, top = _sides(case, box, along_y, along_x)
            parts = np.concatenate([bottom, right, -top, -left])
            worst = max(worst, _remainder(parts))
    return worst


def _remainder(parts: Array) -> float:
    """Size of a sum over that of its terms; 0 where all are."""
    return float(np.abs(parts.sum()) / np.maximum(np.abs(parts).sum(), np.finfo(float).tiny))


def _boxes(seed: int) -> Array:
    """Random boxes (left, right, bottom, top) in the body, each as far below the surface as it is large."""
    random = np.random.default_rng(seed)
    size, place = 10 ** random.uniform(-1, 0.5, 12), random.uniform(-1.5, 1.5, 12)
    return np.stack([place - size / 2, place + size / 2, -2 * size, -size], axis=1)


def _sides(case: Case, box: Array, across: str, along: str) -> tuple[Array, Array, Array, Array]:
    """``across`` on the left and right sides and ``along`` on the bottom and top ones, times Gauss weights."""
    left, right, bottom, top = box
    x, y = (low + (high - low) * (_NODES + 1) / 2 for low, high in ((left, right), (bottom, top)))
    upright = solver.solve_interior(case, [left, right], y, fields=[across])[across].values
    horizontal = solver.solve_interior(case, x, [bottom, top], fields=[along])[along].values
    heights, widths = _WEIGHTS * (top - bottom) / 2, _WEIGHTS * (right - left) / 2
    return upright[:, 0] * heights, upright[:, 1] * heights, horizontal[0] * widths, horizontal[1] * widths


def _totals(case: Case) -> float:
    """Resultants on a box about the contact against Q, P, T, J; over the sum of the sizes of its sides' resultants."""
    solution = solver.solve(case)
    half = half_length(solution)
    charges = [case.get("charge", 0.0), case.get("magnetic_charge", 0.0)]
    loads = np.array([case["friction"] * case["load"], case["load"], *charges])
    worst = 0.0
    for (along_x, along_y), load in zip(FLOWS, loads, strict=True):
        parts = [np.array([load / half])]
        for top in range(-4, 0):  # panels of the sides, and of the bottom at y = -4
            left, right, _, _ = _sides(case, np.array([-4, 4, top, top + 1]), along_x, along_x)
            _, _, bottom, _ = _sides(case, np.array([2 * top + 4, 2 * top + 6, -4, -3]), along_y, along_y)
            parts += [left, -right, bottom]
        worst = max(worst, _remainder(np.concatenate(parts)))
    return worst


def _constitutive(case: Case) -> float:
    """Largest error of a flux over its largest value."""
    fields = [name for pair in (*FLOWS, *POTENTIAL_FIELDS) for name in pair]
    inside = solver.solve_interior(case, X, Y, fields=[*fields, "strain_xx", "strain_yy", "strain_xy"])
    state = [inside.strain_xx, inside.strain_yy, 2 * inside.strain_xy]
    state += [-inside[name] for pair in POTENTIAL_FIELDS for name in pair]
    material = constants(solver.find(case["material"]))
    fluxes = np.einsum("ij,jkl->ikl", constitutive_matrix(material), np.stack([part.values for part in state]))
    return max(off(inside[name], flux) for name, flux in zip(FIELDS, fluxes, strict=True))


def _at_surface(case: Case) -> float:
    """Largest error of a field on the surface over its largest value."""
    surface = solver.solve(case, X)
    names = [name for name in SURFACE_FIELDS if name not in ("contact_pressure", "shear_traction")]
    inside = solver.solve_interior(case, X, [0.0], fields=[*names, "stress_yy", "stress_xy"]).isel(y=0)
    traction = max(off(-inside.stress_yy, surface.contact_pressure), off(inside.stress_xy, surface.shear_traction))
    return max(traction, *(off(inside[name], surface[name]) for name in names))


def _far_field(case: Case) -> float:
    """Largest change of r times a field, over its largest value, from 1e7 to 1e8 half-widths."""
    names = [name for pair in FLOWS for name in pair]
    near, far = (solver.solve_interior(case, r * X, r * Y[:-1], fields=names) * r for r in (1e7, 1e8))
    return max(off(near[name], far[name]) for name in names if np.any(far[name]))


def _flamant() -> float:
    """Largest error over the largest stress of the force (-Q, -P) on a half-plane: sigma_rr = -2 F.e_r/(pi r)."""
    load, friction, r = 1e5, 0.3, 1e6
    material = solver.Material.isotropic(200e9, 0.3)
    case = {"material": material, "radius": 0.05, "load": load, "friction": friction}
    half = half_length(solver.solve(case))
    fields = solver.solve_interior(case, r * X, r * Y, fields=["stress_xx", "stress_yy", "stress_xy"])
    x, y = np.meshgrid(r * half * X, r * half * Y)
    distance = np.hypot(x, y)
    radial = 2 * (friction * load * x + load * y) / (np.pi * distance**2)
    expected = {"stress_xx": x * x, "stress_yy": y * y, "stress_xy": x * y}
    size = float(np.max(np.abs(radial)))
    return max(float(np.max(np.abs(fields[k] - radial * v / distance**2))) / size for k, v in expected.items())
