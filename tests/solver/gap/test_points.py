"""Points with air beside the contact, at rest and sliding: finite elements, the theorem, no air, twins."""

import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

import solver
from solver.gap.ringoperators import RingOperators
from solver.gap.rings import rings
from solver.line.windows import number_of
from solver.material.constants import VACUUM_PERMEABILITY, VACUUM_PERMITTIVITY, Material
from solver.point.kernel import normal_kernel
from solver.point.profile import Shape
from solver.point.sliding import FirstOrderWarning
from solver.point.table import PointKind, window
from solver.stack.wavenumbers import strip
from tests.solver.point.points import film
from verification.cases import constants
from verification.oracles.fem_film import Layer
from verification.oracles.fem_point import PointContact
from verification.oracles.spectral import ELECTRIC

BTO = solver.find("BaTiO3")
_POLYMER: dict[str, Any] = {
    "c11": 3.6e9, "c12": 1.6e9, "c13": 1.6e9, "c33": 1.7e9, "c44": 0.55e9, "e31": 0.024, "e33": -0.027,
    "eps11": 7 * VACUUM_PERMITTIVITY, "eps33": 7.5 * VACUUM_PERMITTIVITY, "name": "polymer",
}  # fmt: skip
POLYMER = Material(**_POLYMER)
SPHERE = {"profile": "sphere", "radius": 5e-3, "magnetic": "insulating", "surroundings": "air"}
FILM = SPHERE | {"material": BTO, "thickness": 1e-4, "base": "steel", "interface_electric": "grounded", "force": 37.0}
HALF = SPHERE | {"material": BTO, "force": 10.0}
COMPOSITE = SPHERE | {"composite": "fibrous", "volume_fraction": 0.6, "force": 10.0}


def answer(case: Mapping[str, Any]) -> dict[str, float]:
    """Every quantity of one case."""
    return {str(name): float(value) for name, value in solver.solve(case).data_vars.items()}


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("material", "thickness", "radius", "charge"), [(BTO, 1e-4, 1e-4, 1e-9), (POLYMER, 5e-5, 2e-4, 0.0)]
)
def test_elements_of_body_and_gap_agree(material: Material, thickness: float, radius: float, charge: float) -> None:
    """On a rigid base, order 8, single nodes good to 4e-5; on steel and half-spaces, in half a minute, as well."""
    constants_of_film = constants(material) | {"c12": float(material.c12)}
    other = PointContact([Layer(constants_of_film, thickness)], None, 5e-3, radius, charge)
    factors = {"material": material, "thickness": thickness, "base": "rigid", "total_charge": charge}
    solution = answer(SPHERE | factors | {"force": other.force})
    expected = [radius, other.depth, other.voltage]
    np.testing.assert_allclose([solution[name] for name in ("contact_radius", "depth", "voltage")], expected, rtol=1e-6)
    r, phi = other.exterior(ELECTRIC)
    compared = np.flatnonzero((r > 1.02) & (r < 6))[::7]
    inside = solver.solve_interior(
        SPHERE | factors | {"force": other.force}, r[compared], [0.0], fields=["electric_potential"]
    )
    np.testing.assert_allclose(inside["electric_potential"][0], phi[compared], rtol=0, atol=1e-4 * abs(other.voltage))
    assert np.max(np.abs(phi[compared] - other.voltage)) > 0.3 * abs(other.voltage)


@pytest.mark.soak
@pytest.mark.parametrize(("power", "tolerance"), [((1.0, 0.05), 1e-6), ((4.0, 1e9), 3e-8)])
def test_finite_elements_below_a_cone_and_a_power_agree(power: tuple[float, float], tolerance: float) -> None:
    """With the gap's end given; a cone's kinked apex is harder on the elements."""
    constants_of_film = constants(BTO) | {"c12": float(BTO.c12)}
    other = PointContact([Layer(constants_of_film, 1e-4)], None, 5e-3, 5e-5, power=power)
    profile = {"profile": "power", "exponent": power[0], "coefficient": power[1]}
    if power[0] == 1:
        profile = {"profile": "cone", "slope": power[1]}
    case = {name: value for name, value in FILM.items() if name not in ("radius", "interface_electric")}
    solution = answer(case | profile | {"base": "rigid", "gap_radius": 5e-3, "force": other.force})
    expected = [5e-5, other.depth, other.voltage]
    np.testing.assert_allclose(
        [solution[name] for name in ("contact_radius", "depth", "voltage")], expected, rtol=tolerance
    )
    assert ("peak_pressure" in solution) == ("peak_displacement" in solution) == (power[0] > 1)


def test_a_gap_s_end_is_a_sphere_s_radius_unless_it_is_said() -> None:
    """A power of 2 is a sphere; four times the end adds 4 pi eps0 R log 4 to the capacitance."""
    sphere = answer(HALF)
    bare = {name: value for name, value in HALF.items() if name != "radius"}
    power = answer(bare | {"profile": "power", "exponent": 2.0, "coefficient": 100.0, "gap_radius": 5e-3})
    for name, value in sphere.items():
        assert power[name] == pytest.approx(value, rel=1e-12), name
    wide = answer(HALF | {"gap_radius": 2e-2})
    difference = wide["capacitance"] - sphere["capacitance"]
    assert difference == pytest.approx(4 * np.pi * VACUUM_PERMITTIVITY * 5e-3 * np.log(4), rel=0.02)


def test_a_ball_that_hardly_touches_has_the_capacitance_of_one_that_touches_at_a_point() -> None:
    """A dielectric so thin that field lines cross it straight: the sum over r of two capacitors in series.

    Field lines spread over (h/L)^2 = 1e-5 of it, L = sqrt(2 R h/eps_r) being the distance as far as charges lie.
    """
    h, R, eps = 1e-5, 1.0, 3.0
    film: dict[str, Any] = {"c11": 3e9, "c12": 1e9, "c13": 1e9, "c33": 3e9, "c44": 1e9}
    film |= {f"eps{place}": eps * VACUUM_PERMITTIVITY for place in ("11", "33")}
    case = {"material": Material(**film), "thickness": h, "base": "rigid", "profile": "sphere", "radius": R}

    def per_log_r(log_r: float) -> float:
        r = np.exp(log_r)
        return float(2 * np.pi * r**2 * VACUUM_PERMITTIVITY / (r**2 / (2 * R) * (1 + (r / R) ** 2) + h / eps))

    touching = quad(per_log_r, np.log(1e-8), np.log(1e5), limit=200)[0]
    for force in (1e-13, 5e-18):  # contact radii of 3e-3 and 1.1e-4 thicknesses, 3e-8 and 1e-9 of the gap's end
        assert answer(case | {"force": force})["capacitance"] == pytest.approx(touching, rel=1e-5)


def test_a_gap_that_opens_slowly_leaves_its_equations_their_digits() -> None:
    """A power of 4 opens by 1e-20 m where it touches: the capacitance is that of the wide gap, whatever touches."""
    case = {"material": "PZT-4", "surroundings": "air", "profile": "power", "exponent": 4.0, "coefficient": 1e5}
    small, tiny = (answer(case | {"gap_radius": 1e-2, "force": force}) for force in (1e-8, 1e-17))
    for name in ("capacitance", "capacitance_at_force", "voltage_per_force"):
        assert tiny[name] == pytest.approx(small[name], rel=1e-6), name
    assert tiny["contact_stiffness"] == pytest.approx(small["contact_stiffness"] * 1e-9**0.2, rel=1e-6)


def test_a_gap_that_ends_too_far_away_or_within_the_contact_is_refused() -> None:
    with pytest.raises(solver.FactorError, match=r"^contact: narrower than 1e-12 of the distance at which"):
        answer(HALF | {"gap_radius": 1e10})
    radius = answer(HALF)["contact_radius"]
    assert answer(HALF | {"gap_radius": 1.1 * radius})["contact_radius"] == pytest.approx(radius, rel=1e-3)
    with pytest.raises(solver.FactorError, match=r"^gap_radius: .* is less than the contact's radius [0-9.e-]+ m: "):
        answer(HALF | {"gap_radius": 0.9 * radius})


@pytest.mark.parametrize("case", [HALF, HALF | {"punch": "steel"}, COMPOSITE | {"magnetic": "conducting"}])
def test_grounded_on_a_half_space_it_does_not_see_the_air(case: dict[str, Any]) -> None:
    """Theorem: the whole surface is at zero, and the charge per force is -r_1 whatever is beside the contact."""
    bare, air = answer(case | {"surroundings": "insulated"}), answer(case)
    for name in ("contact_radius", "charge_per_force", "stroke_per_volt", "peak_pressure", "contact_stiffness"):
        assert air[name] == pytest.approx(bare[name], rel=1e-11, abs=0)
    assert air["capacitance"] > 1.2 * bare["capacitance"]


def test_magnetic_gap_is_the_electric_one_s_twin() -> None:
    """Magnetic constants in the ratio of the vacuum's to the electric ones: the same contact in other units."""
    ratio = VACUUM_PERMEABILITY / VACUUM_PERMITTIVITY
    root = float(np.sqrt(ratio))
    electric_constants = constants(BTO)
    changed: dict[str, Any] = {name: electric_constants[name] for name in ("c11", "c13", "c33", "c44")}
    changed |= {f"f{place}": root * electric_constants[f"e{place}"] for place in ("31", "33", "15")}
    changed |= {f"mu{place}": ratio * electric_constants[f"eps{place}"] for place in ("11", "33")}
    twin = Material(**changed, eps11=np.array(1e-9), eps33=np.array(1e-9), name="twin")
    case = FILM | {"thickness": 2e-4, "base": "rigid", "interface_magnetic": "grounded"}
    electric = answer(case | {"friction": 0.2})
    magnetic = answer(case | {"friction": 0.2, "material": twin, "electric": "insulating", "magnetic": "conducting"})
    for name in ("contact_radius", "contact_offset"):
        assert magnetic[name] == pytest.approx(electric[name], rel=1e-11, abs=0)
    assert magnetic["flux_per_force"] == pytest.approx(root * electric["charge_per_force"], rel=1e-9)
    assert magnetic["magnetic_potential"] == pytest.approx(electric["voltage"] / root, rel=1e-9)
    assert magnetic["permeance"] == pytest.approx(ratio * electric["capacitance"], rel=1e-9)


def test_air_changes_what_theory_says_it_changes() -> None:
    """BaTiO3 of 0.1 mm on steel at a/h = 1: 1.05 % less charge; a half-space's voltage falls to two thirds."""
    bare, air = (answer(FILM | {"surroundings": surroundings}) for surroundings in ("insulated", "air"))
    assert air["charge_per_force"] / bare["charge_per_force"] == pytest.approx(135.02 / 136.46, rel=1e-4)
    assert air["nominal_field"] == pytest.approx(abs(air["voltage"]) / 1e-4, rel=1e-12)
    assert "electric_edge_intensity" not in air
    assert air["gap_field"] * VACUUM_PERMITTIVITY <= air["peak_displacement"] * (1 + 1e-12)
    oil = answer(FILM | {"gap_permittivity": 2.2})
    assert oil["capacitance"] > air["capacitance"] > bare["capacitance"]


@pytest.mark.parametrize(("ratio", "exponent"), [(0.3, 2.0), (40.0, 2.0), (0.3, 1.0), (3.0, 1.5)])
def test_loads_are_those_of_the_galerkin_tables(ratio: float, exponent: float) -> None:
    """Two discretisations, one in distances and Gauss's nodes, one in wavenumbers and Legendre functions."""
    kind = PointKind(film(BTO), (True, False), Shape(exponent))
    stack = kind.film
    operators = RingOperators(rings(), (0,), kind.compliance, kind.shape, normal_kernel(stack), strip(stack))
    loads = operators.matrix(ratio)[operators.rows.loads, : operators.rows.causes]
    read = kind.stiffness(window(kind, int(number_of(np.array([ratio]))[0])).read(np.log([ratio]))).loads[0]
    np.testing.assert_allclose(loads, read[np.ix_([0, 1], [0, 1, 3])], rtol=1e-10)


FIBROUS: dict[str, Any] = COMPOSITE | {"total_charge": 2e-10}
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
