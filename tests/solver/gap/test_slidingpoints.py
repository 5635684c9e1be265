"""Points that slide with air beside them, to first order: by collocation, no air, no coupling, one body, the edge."""

import warnings
from typing import Any

import numpy as np
import pytest

import solver
from solver.material.constants import VACUUM_PERMEABILITY, VACUUM_PERMITTIVITY, Material
from solver.point.sliding import FirstOrderWarning
from tests.solver.gap.test_points import FILM, HALF, answer

FIBROUS: dict[str, Any] = {name: value for name, value in HALF.items() if name != "material"} | {
    "composite": "fibrous", "volume_fraction": 0.6, "total_charge": 2e-10,
}  # fmt: skip
SLID = {"friction": 0.3}


def test_a_dielectric_under_its_own_elasticity_feels_nothing_of_it() -> None:
    """Equal bodies do not shift, and no stress makes a charge: Hamilton's tension, and charges as at rest."""
    poisson = 0.3
    body = Material.isotropic(200e9, poisson, name="dielectric")
    case = HALF | {"material": body, "punch": body, "total_charge": 1e-10}
    still, slid = answer(case | {"friction": 0.0}), answer(case | SLID)
    for name in ("contact_radius", "peak_displacement", "gap_field"):
        assert slid[name] == pytest.approx(still[name], rel=1e-12)
    hamilton = slid["peak_pressure"] * ((1 - 2 * poisson) / 3 + 0.3 * np.pi * (4 + poisson) / 8)
    assert slid["trailing_tension"] == pytest.approx(hamilton, rel=1e-12)
    shifted = answer(case | SLID | {"punch": "rigid"})
    assert abs(shifted["contact_offset"]) > 1e-3 * shifted["contact_radius"]
    assert shifted["peak_displacement"] > still["peak_displacement"]


def test_layers_too_thick_for_the_tension_beside_the_edge_are_refused_before_they_are_solved() -> None:
    """15,000 times as thick as the top layer they took more than 25 s and gigabytes."""
    thin, thick = (solver.Layer(solver.find(name), h) for name, h in (("PZT-4", 1e-6), ("steel", 1.5e-2)))
    case = SLID | {"body": solver.Stack((thin, thick), "rigid"), "profile": "sphere", "radius": 5e-3, "force": 0.01}
    with pytest.raises(solver.FactorError, match=r"^friction: the layers are 1\.5e\+04 times as thick as the top one"):
        solver.solve(case)


def test_sliding_contacts_without_charge_are_similar() -> None:
    """A half-space in air has no length but the ball's, which tiny contacts do not see: lengths go with force^(1/3)."""
    small, tiny = (answer(HALF | SLID | {"force": force}) for force in (1e-13, 1e-19))
    for name, power in (("contact_offset", 2), ("peak_pressure", 2), ("trailing_tension", 2)):
        assert small[name] / tiny[name] == pytest.approx(10.0**power, rel=1e-5), name


@pytest.mark.parametrize("case", [HALF, FILM | {"base": "rigid"}, FIBROUS | {"magnetic": "conducting"}])
def test_tension_beside_the_trailing_edge_is_that_of_the_fields_inside(case: dict[str, Any]) -> None:
    """Sums over b and waves, extrapolated to the edge, against moments and rates."""
    gaps = np.array([4e-4, 8e-4, 1.6e-3, 3.2e-3, 6.4e-3])
    stresses = solver.solve_interior(case | SLID, 1 + gaps, [0.0], fields=["stress_xx"])["stress_xx"].values.ravel()
    rows = gaps[:, None] ** np.array([0.0, 0.5, 1.0, 1.5, 2.0])
    assert np.linalg.solve(rows, stresses)[0] == pytest.approx(answer(case | SLID)["trailing_tension"], rel=1e-3)


def test_electric_and_magnetic_charges_see_one_gap_that_friction_tilts() -> None:
    """D g = eps0 (phi - V) to the first order: what it says of g_1 from D and phi is what B and psi say."""
    case = FIBROUS | SLID | {"magnetic": "conducting", "total_flux": 1e-9}
    r = np.array([1.1, 1.6, 2.5, 5.0])
    punch, names = solver.solve(case), ["electric_potential", "magnetic_potential"]
    inside = solver.solve_interior(case, np.concatenate([r, -r]), [0.0], fields=names)
    surface, gaps = solver.solve(case, np.concatenate([r, -r])), []
    for potential, density, level, vacuum in (
        ("electric_potential", "electric_displacement", "voltage", VACUUM_PERMITTIVITY),
        ("magnetic_potential", "magnetic_induction", "magnetic_potential", VACUUM_PERMEABILITY),
    ):
        pairs = inside[potential].values.reshape(2, -1) - float(punch[level]), surface[density].values.reshape(2, -1)
        (phi, phi_1), (D, D_1) = (((pair[0] + pair[1]) / 2, (pair[0] - pair[1]) / 2) for pair in pairs)
        gap = vacuum * phi / D
        gaps.append((gap, (vacuum * phi_1 - D_1 * gap) / D))
    for electric, other in zip(*gaps, strict=True):
        np.testing.assert_allclose(electric, other, rtol=1e-5)
    assert np.all(np.abs(gaps[0][1]) > 1e-3 * gaps[0][0])


def test_largest_values_are_those_of_the_fields() -> None:
    """Beside the edge of a contact whose charge is below what the surface gives way to; inside the edge D is steep."""
    case = HALF | {"friction": 0.02, "total_charge": 1.6e-9}
    solution = answer(case)
    positions = np.concatenate(
        [np.linspace(-0.99, 0.99, 23), 1 + np.geomspace(1e-3, 3, 9), -1 - np.geomspace(1e-3, 3, 9)]
    )
    fields = solver.solve(case, positions)
    D = np.abs(fields["electric_displacement"].values.ravel())
    assert np.max(D) <= solution["peak_displacement"] * (1 + 1e-9)
    np.testing.assert_allclose(np.max(D), solution["peak_displacement"], rtol=0.1)


def test_a_field_beyond_what_the_surface_carries_is_told() -> None:
    grounded = HALF | {"total_charge": 1.68e-9}
    with pytest.warns(FirstOrderWarning, match=r"^friction: to its first order the field in the gap .* 4\.5 times"):
        answer(grounded | SLID)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        answer(grounded | {"friction": 0.05})
        answer(HALF | SLID)
