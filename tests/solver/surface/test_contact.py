"""Contacts in space: closed forms, multipliers against a boundary value problem; names, maps, cuts and refusals."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipe, ellipk

import solver
from solver.arrays import Array
from solver.names import MAPS, SPACE_QUANTITIES
from solver.stack.layers import Layer, Stack
from solver.stack.reflection import waves
from solver.surface import contact
from solver.surface.contact import SurfaceContact, isotropic_half_space, solve_contact
from solver.surface.response import SurfaceBody, SurfaceLayer
from solver.surface.shape import Cone, Disc, Ellipsoid, RoughSphere, sphere
from tests.refusals import assert_refused
from tests.solver.cases import assert_alike, without
from verification.cases import constants
from verification.oracles import sample_materials, surface


def half_space(material: str, cut: str = "") -> SurfaceBody:
    return SurfaceBody((), solver.find(material).stiffness_tensor(cut)[:, :4, :4])


PZT = half_space("PZT-4")


def modulus(body: SurfaceBody) -> float:
    """Effective modulus of contacts at zero potential [Pa]."""
    Y = body.multiplier(np.array([np.inf]), np.array([0.0]))[0, 0].real
    return float(2 / (Y[2, 2] - Y[2, 3] ** 2 / Y[3, 3]))


def per_force(contact: SurfaceContact) -> float:
    """Charge per force [pC/N]."""
    return 1e12 * contact.charge / float(contact.force[2])


@pytest.mark.parametrize("punch", [None, (70e9, 0.33)])
def test_sphere_on_a_half_space_is_hertz(punch: tuple[float, float] | None) -> None:
    """The compliance of an elastic punch adds to that of the surface."""
    depth = 1e-6
    contact = solve_contact(PZT, sphere(5e-3), depth=depth, punch=punch, air=None, cells=64)
    stiff = modulus(PZT) if punch is None else 1 / (1 / modulus(PZT) + (1 - punch[1] ** 2) / punch[0])
    assert contact.force[2] == pytest.approx(4 / 3 * stiff * np.sqrt(5e-3) * depth**1.5, rel=2e-4)
    assert per_force(contact) == pytest.approx(250.10013, rel=1e-7)  # whatever the grid
    assert contact.area == pytest.approx(np.pi * 5e-3 * depth, rel=2e-3)
    np.testing.assert_allclose(contact.lengths, 2 * np.sqrt(5e-3 * depth), rtol=5e-3)


def test_ellipsoid_is_hertz() -> None:
    """Load and peak of an elliptic contact of semi-axes 10 to 1."""
    a, ratio, peak, Es = 1e-4, 10, 1e8, modulus(PZT)
    b, e2 = a / ratio, 1 - 1 / ratio**2
    K, E = ellipk(e2), ellipe(e2)
    factor = peak / Es * b / (a**2 * e2)
    radii = 1 / (2 * factor * (K - E)), 1 / (2 * factor * (ratio**2 * E - K))
    contact = solve_contact(PZT, Ellipsoid(*radii), depth=peak / Es * b * K, air=None, cells=128)
    assert contact.force[2] == pytest.approx(2 / 3 * np.pi * a * b * peak, rel=2e-4)
    assert contact.peak_pressure == pytest.approx(peak, rel=5e-4)


def test_cone_and_disc_have_their_closed_forms() -> None:
    Es = modulus(PZT)
    cone = solve_contact(PZT, Cone(0.01), force=1.0, air=None, cells=64)
    assert cone.depth == pytest.approx(np.sqrt(np.pi * 0.01 / (2 * Es)), rel=1e-3)
    disc = solve_contact(PZT, Disc(1e-4), force=1.0, air=None, cells=128)
    assert disc.depth == pytest.approx(1 / (2 * Es * 1e-4), rel=1e-3)


@pytest.mark.parametrize(
    ("material", "cut", "charge"),
    [("LiNbO3", "", 13.213), ("LiNbO3", "36Y", 15.93), ("LiNbO3", "128Y", 13.60), ("PZT-4", "tilt 30 deg", 222.0)],
)
def test_charge_of_a_cut_is_its_stroke(material: str, cut: str, charge: float) -> None:
    contact = solve_contact(half_space(material, cut), sphere(1.0), depth=1e-4, cells=48)
    force, induced = contact.tangent
    stroke = -1e12 * force[1] / force[0]
    assert stroke == pytest.approx(charge, rel=4e-3)  # the reference's air ends at twice the contact
    assert per_force(contact) == pytest.approx(stroke, rel=4e-3)
    # a gap that closes at the edge takes charge, which linear reciprocity leaves out: up to 1 % where air is thin
    assert 1e12 * induced[0] / force[0] == pytest.approx(stroke, rel=1.2e-2)


def test_a_sliding_sphere_loses_load_and_charge_to_the_second_order() -> None:
    rest, slow, fast = (
        solve_contact(half_space("BaTiO3"), sphere(1.0), depth=1e-4, friction=eta, air=None, cells=64)
        for eta in (0.0, 0.3, 0.6)
    )
    # windows differ by 2 %, which changes forces by some 3e-5; grids of 128 and 192 cells give -7.70e-4 and -3.04e-3
    assert slow.force[2] / rest.force[2] - 1 == pytest.approx(-7.62e-4, abs=8e-5)
    assert fast.force[2] / rest.force[2] - 1 == pytest.approx(-2.99e-3, abs=8e-5)
    assert slow.charge / rest.charge - 1 == pytest.approx(-1.38e-3, rel=0.1)  # like its edge cells


def test_charge_varies_smoothly_with_the_load_and_turns_with_the_crystal() -> None:
    film = SurfaceBody((SurfaceLayer(half_space("PZT-4").stiffnesses[0], 1e-4),))
    forces = 4.0 * 1.03 ** np.arange(5)
    charges = np.log([per_force(solve_contact(film, sphere(5e-3), force=f, cells=64, end=5e-3)) for f in forces])
    assert np.ptp(np.diff(charges)) < 4e-4  # between neighbours that differ by 1e-3
    along, across = (
        solve_contact(half_space("PZT-4", cut), sphere(5e-3), force=4.0, cells=32)
        for cut in ("tilt 30 deg", "euler -90 30 180")
    )
    assert across.charge == pytest.approx(along.charge, rel=1e-6)


def test_rough_spheres_have_their_roughness_on_every_grid_and_another_surface_each() -> None:
    deviations, lowest = [], []
    for number in range(8):
        rough = RoughSphere(20e-3, 10e-9, 1e-4, 1e-5, number)
        for cells in (200, 311):
            x = np.linspace(-1e-3, 1e-3, cells)
            deviations.append(np.std(rough.gap(x[:, None], x) - sphere(20e-3).gap(x[:, None], x)))
        lowest.append(rough.gap(np.zeros(1), np.zeros(1))[0] / 10e-9)
    # an area of 20 longest wavelengths a side holds some 400 hills, whose mean square scatters by 2/sqrt(400)
    np.testing.assert_allclose(deviations, 10e-9, rtol=0.1)
    assert np.std(lowest) > 0.3


HALF_SPACE = np.array([np.inf])
CRYSTALS: dict[str, Array] = {
    "PZT-4": sample_materials.hexagonal(constants(solver.find("PZT-4"))),
    "LiNbO3": sample_materials.lithium_niobate(None),
    "36Y LiNbO3": sample_materials.lithium_niobate(36.0),
    "X quartz": sample_materials.quartz(),
}


def stiffness(name: str) -> Array:
    """Generalised stiffness without magnetic fields, (3, 4, 4, 3)."""
    return solver.find(name).stiffness_tensor()[:, :4, :4]


@pytest.mark.parametrize("name", CRYSTALS)
def test_multipliers_are_those_of_the_oracle(name: str) -> None:
    units = np.array([1.0, 1.0, 1.0, 1e10])
    scale = units[:, None] * units / 1e11
    angles, depths = np.array([0.0, 0.7, np.pi / 2]), np.array([1e-3, 0.3, 1.0, 4.0])
    film = SurfaceBody((SurfaceLayer(stiffness(name), 1.0),)).multiplier(depths, angles) / scale
    half_space = SurfaceBody((), stiffness(name)).multiplier(HALF_SPACE, angles)[0] / scale
    for computed, exact in (
        (half_space, surface.half_space(CRYSTALS[name], angles)),
        (film, surface.film(CRYSTALS[name], depths, angles)),
    ):
        np.testing.assert_allclose(computed, exact, rtol=0, atol=2e-8 * np.max(np.abs(exact)))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("LiNbO3", [13.0611, 13.3693 - 0.9122j]),
        # 216.597 + 98.110i and 226.715 of the theory, with permittivities of 730 and 635 times vacuum's
        ("tilt 30 deg PZT-4", [216.593 + 98.112j, 226.712]),
    ],
)
def test_charge_of_a_plane_punch_along_x_and_y(name: str, expected: list[complex]) -> None:
    Y = SurfaceBody((), stiffness(name)).multiplier(HALF_SPACE, np.array([0.0, np.pi / 2]))[0]
    np.testing.assert_allclose(-1e12 * Y[:, 3, 2] / Y[:, 3, 3], expected, atol=1e-3)


@pytest.mark.parametrize(("name", "charge"), [("LiNbO3", 5.30612), ("36Y LiNbO3", 23.30671), ("X quartz", 1.97141)])
def test_thin_film_has_the_charge_of_a_uniform_strain(name: str, charge: float) -> None:
    film = SurfaceBody((SurfaceLayer(stiffness(name), 1.0),))
    Y = film.multiplier(np.array([1e-3]), np.array([0.3]))[0, 0]
    assert abs(1e12 * (Y[3, 2] / Y[3, 3]).real) == pytest.approx(charge, abs=1e-4)


@pytest.mark.parametrize("names", [("PZT-4", "rigid"), ("BaTiO3", "silicon"), ("PZT-4", "copper", "silicon")])
def test_multiplier_of_a_stack_isotropic_about_its_normal_is_that_of_the_plane(names: tuple[str, ...]) -> None:
    *layers, base = names
    stack = Stack([Layer(name, 1e-4 / (n + 1)) for n, name in enumerate(layers)], base)
    k = np.geomspace(1e-3, 50, 12) / 1e-4
    top = waves(stack, k)[0]
    plane = (top.medium.compliance + top.difference) * stack.scale[:, None] * stack.scale
    body = SurfaceBody(
        [
            SurfaceLayer(stiffness(name), 1e-4 / (n + 1), 2 in stack.grounded[n], stack.conductors[n])
            for n, name in enumerate(layers)
        ],
        None if base == "rigid" else stiffness(base),
        stack.conductors[-1],
    )
    Y = body.multiplier(k, np.array([0.3]))[:, 0, 2:4, 2:4]
    assert np.all(np.abs(Y.imag) < 1e-7 * np.abs(Y))
    # coincident roots of isotropic layers are split by 1e-5
    np.testing.assert_allclose(Y.real, plane[:, 1:3, 1:3], rtol=1e-7)


def test_isotropic_half_space_has_the_closed_form() -> None:
    modulus, poisson = 210e9, 0.3
    Y = isotropic_half_space(modulus, poisson).multiplier(HALF_SPACE, np.array([0.0]))[0, 0]
    assert Y[2, 2].real == pytest.approx(2 * (1 - poisson**2) / modulus, rel=1e-7)
    assert Y[2, 0].imag == pytest.approx((1 - 2 * poisson) * (1 + poisson) / modulus, rel=1e-7)


def test_only_bodies_isotropic_about_the_normal_count_as_such() -> None:
    assert [SurfaceBody((), stiffness(name)).isotropic for name in ("PZT-4", "tilt 1 deg PZT-4", "LiNbO3")] == [
        True, False, False,
    ]  # fmt: skip


Case = dict[str, Any]
COARSE = {"grid_error": 0.03}  # two grids of 16 and 32 cells, or 64
EGG: Case = {"material": "PZT-4", "profile": "ellipsoid", "radius_x": 5e-3, "radius_y": 1e-2, "force": 1.0} | COARSE
BALL: Case = {"material": "36Y LiNbO3", "profile": "sphere", "radius": 5e-3, "force": 1.0} | COARSE
FILM: Case = {"thickness": 1e-4, "base": "rigid"}


def test_an_ellipsoid_on_a_half_space_has_the_charge_of_any_shape() -> None:
    """The identity of half-spaces: charge per force is 250.104756 pC/N whatever the shape."""
    out = solver.solve(EGG, positions=[0.0, 0.5, 2.0])
    assert 1e12 * float(out["charge_per_force"]) == pytest.approx(250.104756, rel=2e-3)
    assert set(out.data_vars) == {*SPACE_QUANTITIES, "contact_pressure", "electric_displacement"}
    assert out["contact_area"].attrs["units"] == "m2"
    assert float(out["relative_error"]) <= 0.03
    assert out["surroundings"].item() == "air"
    pressure = out["contact_pressure"].values
    # Hertz: p(x) falls like the root of 1 - x^2; cells of a 64th of the window
    assert pressure[1] / pressure[0] == pytest.approx(np.sqrt(0.75), rel=0.02)
    assert pressure[2] == 0
    assert float(out["contact_length_y"]) > 1.3 * float(out["contact_length_x"])


def test_only_quantities_that_are_named_are_returned() -> None:
    whole = solver.solve(EGG)
    stroke = solver.solve(EGG, outputs=["stroke_per_volt", "depth"])
    assert list(stroke.data_vars) == ["depth", "stroke_per_volt"]
    charge = solver.solve(EGG, positions=[0.0], outputs={"charge_per_force"})
    assert list(charge.data_vars) == ["charge_per_force", "contact_pressure", "electric_displacement"]
    for name, part in {"depth": stroke, "stroke_per_volt": stroke, "charge_per_force": charge}.items():
        # another path of the same iteration, to a hundredth of the error
        assert float(part[name]) == pytest.approx(float(whole[name]), rel=0.01 * COARSE["grid_error"])
    ball = {"material": "PZT-4", "profile": "sphere", "radius": 5e-3, "force": 1.0}
    both = solver.solve(ball, peaks=["peak_principal_tension"], outputs=["voltage", "peak_von_mises"])
    assert set(both.data_vars) == {"voltage", "peak_von_mises", "peak_principal_tension"}
    assert_refused(solver.FactorError, "outputs: 'chrge' is not one of", solver.solve, EGG, outputs=["chrge"])


def test_the_map_carries_force_and_moment() -> None:
    """Of a roller that is tilted, whose lowest point lies at negative y."""
    roller = {"material": "PZT-4", "profile": "roller", "radius": 5e-3, "length": 2e-3, "tilt": 0.02, "force": 1.0}
    out, solved = solver.solve_map(roller | COARSE), solver.solve(roller | COARSE, outputs=["moment_x"])
    assert list(out.data_vars) == list(MAPS)
    pressed = out["contact_pressure"] * float(out.x[1] - out.x[0]) * float(out.y[1] - out.y[0])
    assert float(pressed.sum()) == pytest.approx(1.0, rel=1e-3)
    assert float(-(pressed * out["y"]).sum()) == pytest.approx(float(solved["moment_x"]), rel=1e-2)
    assert float(solved["moment_x"]) > 0.5e-3
    assert out["x"].attrs["units"] == "m"


def test_cuts_by_name_by_factor_and_by_material_are_one_case() -> None:
    named, turned, mine = (
        float(solver.solve(BALL | cut, outputs=["charge_per_force"])["charge_per_force"].item())
        for cut in (
            {},
            {"material": "LiNbO3", "cut": "rotated Y", "cut_angle": ["36 deg"]},
            {"material": solver.Material.from_mapping(solver.find("LiNbO3").plain() | {"cut": [0, -54, 0]})},
        )
    )
    assert [turned, mine] == pytest.approx([named, named], rel=1e-9)


def test_steel_couples_nothing_and_a_stack_of_cuts_is_solved() -> None:
    steel = solver.solve(EGG | {"material": "steel"}, outputs=["charge_per_force"])
    assert float(steel["charge_per_force"]) == 0.0
    stack = solver.Stack([solver.Layer("36Y LiNbO3", 1e-4)], "silicon")
    ball = {"body": stack, "profile": "sphere", "radius": 5e-3, "force": 1.0}
    out = solver.solve(ball | COARSE, outputs=["voltage", "nominal_field"])
    assert float(out["nominal_field"]) == pytest.approx(abs(float(out["voltage"])) / 1e-4, rel=1e-12)


def heights(count: int = 81) -> np.ndarray[Any, Any]:
    x = np.linspace(-1e-4, 1e-4, count)
    return np.asarray((x[:, None] ** 2 + x**2) / 1e-2)


def test_a_height_map_of_a_ball_is_the_ball(tmp_path: Path) -> None:
    np.savetxt(tmp_path / "ball.csv", heights(), delimiter=",")
    case = {"material": "PZT-4", "surroundings": "insulated", "force": 1.0} | COARSE
    as_map = case | {"profile": "map", "map_spacing": 2.5e-6}
    file, array = (solver.solve(as_map | {"height_map": map_}) for map_ in (str(tmp_path / "ball.csv"), heights()))
    ball = solver.solve(case | {"profile": "ellipsoid", "radius_x": 5e-3, "radius_y": 5e-3})
    assert float(file["depth"]) == float(array["depth"])
    assert_alike(array, ball, 1e-4, ("depth", "charge_per_force", "contact_stiffness", "peak_pressure"))


WITH_NAN = heights()
WITH_NAN[3, 4] = np.nan
MAP: Case = {"material": "PZT-4", "profile": "map", "height_map": heights(), "map_spacing": 2.5e-6, "force": 1.0}
ROUGH: Case = {"material": "PZT-4", "profile": "rough_sphere", "radius": 5e-3, "roughness": 1e-8, "force": 1.0}
ROUGH |= {"longest_wavelength": 1e-4, "shortest_wavelength": 2e-5}


@pytest.mark.parametrize(
    ("case", "words"),
    [
        (MAP | {"height_map": WITH_NAN}, "height_map: not a finite number"),
        (EGG | {"radius_y": 500.0, "surroundings": "insulated"}, "contact: .* times as long as wide"),
        (EGG | {"force": 1e-15}, "force: a depth of .* at least 1e-13 m"),
        (ROUGH | {"realisation": 1.5}, "realisation: 1.5 is not allowed; a whole number"),
        (MAP | {"height_map": [[1.0]]}, r"height_map: shape \(1, 1\)"),
        (MAP | {"height_map": heights()[35:45, 35:45]}, "edge of the map"),
        (MAP | {"height_map": heights(9), "map_spacing": 2.5e-5}, "too wide for a contact"),
        (MAP | {"height_map": "none.csv"}, "height_map: none.csv: No such file"),
        (without(MAP, "map_spacing"), "map_spacing: missing"),
        (without(MAP, "height_map"), "height_map: missing"),
        (BALL | {"surroundings": "insulated"}, "surroundings: insulated"),
        (BALL | {"cut": "X"}, "cut: 'X' beside 36Y LiNbO3"),
        (BALL | {"electric": "insulating"}, "electric: 'insulating' of a contact in space"),
        (BALL | {"total_flux": 1.0}, "total_flux: 1 of a contact in space"),
        (BALL | FILM | {"touch_temperature": 300.0, "hold": 1.0}, "touch_temperature: 300 of a contact in space"),
        (BALL | FILM | {"collector": 1.0}, "collector: 1 of a contact in space"),
        (EGG | {"cut": "tilt"}, "cut_angle: missing"),
        (EGG | {"cut_angle": 0.1}, "cut: missing"),
        (EGG | {"cut": "tilt", "cut_angle": 36}, r"cut_angle: 36 is not .* \[rad\]"),
        (EGG | {"material": "CoFe2O4"}, "magnetic: conducting on a magnetic body"),
        ({"material": "PZT-4", "radius": 0.05, "load": 1e4, "cut": "X"}, "cut: only contacts in space have it"),
        ({"material": "PZT-4", "radius": 0.05, "load": 1e4, "grid_error": 0.01}, "grid_error: only contacts in space"),
    ],
)
def test_what_is_not_there_is_refused_in_one_line(case: Case, words: str) -> None:
    assert_refused((solver.FactorError, solver.MaterialError), words, solver.solve, case)


def test_the_end_of_a_tilted_roller_presses_wherever_it_is() -> None:
    roller = {"material": "PZT-4", "profile": "roller", "radius": 5e-3, "tilt": 0.02, "force": 1.0} | COARSE
    names = ["contact_area", "contact_length_x", "contact_length_y", "charge_per_force"]
    short, long = (solver.solve(roller | {"length": length}, outputs=names) for length in (2e-4, 2e-3))
    # the air beside a longer one takes more charge, which sinks the punch, and leaves the edge where it is
    assert_alike(short, long, 1e-3, names)


def test_a_film_that_bends_on_a_soft_base_is_pressed_as_by_a_ball_of_the_point() -> None:
    film = {"material": "PZT-4", "thickness": 1e-4, "base": "PDMS", "force": 3.0}
    ball, names = solver.solve(film | {"profile": "sphere", "radius": 5e-3}), ["depth", "charge_per_force"]
    egg = {"profile": "ellipsoid", "radius_x": 5e-3, "radius_y": 5e-3, "grid_error": 0.1}
    space = solver.solve(film | egg, outputs=names)
    # the ball sinks by 0.3 mm, of which its own contact is 0.2 um
    assert float(space["depth"]) == pytest.approx(float(ball["depth"]), rel=2e-3)
    assert float(space["charge_per_force"]) == pytest.approx(float(ball["charge_per_force"]), rel=0.02)


def test_fields_inside_curves_and_peaks_are_refused() -> None:
    line = {"material": "PZT-4", "radius": 0.05, "load": 1e4}
    assert_refused(solver.FactorError, "fields: inside a contact in space", solver.solve_interior, BALL, [0.0], [-1.0])
    assert_refused(solver.FactorError, "curves: of a contact in space", solver.solve_curves, BALL)
    assert_refused(solver.FactorError, "peaks: of a contact in space", solver.solve, BALL, peaks=["peak_von_mises"])
    assert_refused(solver.FactorError, "several cases", solver.solve_map, EGG | {"force": [1.0, 2.0]})
    assert_refused(solver.FactorError, "only contacts in space have a map", solver.solve_map, line)


@pytest.mark.parametrize(
    ("body", "radius", "force"),
    [
        # the gap takes three quarters of the charge, most of it beyond 30 thicknesses
        ({"material": "AlN", "thickness": 1e-6, "base": "silicon"}, 2e-3, 0.2),
        ({"material": "PVDF", "thickness": 1e-5, "base": "rigid"}, 2.5e-3, 0.01),
        ({"material": "PZT-4", "thickness": 1e-6, "base": "steel"}, 5e-3, 0.01),
        ({"material": "PZT-4", "surroundings": "air"}, 5e-3, 1.0),
        ({"body": solver.Stack([solver.Layer("PZT-4", 1e-4), solver.Layer("copper", 1e-5)])}, 5e-3, 1.0),
        ({"material": "PZT-4", "thickness": 1e-4, "base": "rigid", "surroundings": "insulated"}, 5e-3, 4.0),
    ],
)
def test_the_stated_error_bounds_the_distance_to_balls(body: Case, radius: float, force: float) -> None:
    """Balls of the point solver, in air, share no code with the grid beyond the materials."""
    ball = solver.solve(body | {"profile": "sphere", "radius": radius, "force": force})
    shape = {"profile": "ellipsoid", "radius_x": radius, "radius_y": radius, "force": force}
    space = solver.solve(body | shape | {"grid_error": 0.02})
    error = float(space["relative_error"])
    assert error <= 0.02
    names = set(ball.data_vars) & set(SPACE_QUANTITIES) - {"voltage_per_force"}
    assert len(names) >= 9
    assert_alike(space, ball, 1.3 * error, map(str, names))


def test_cells_at_a_sliding_edge_that_open_and_close_for_ever_end_the_search() -> None:
    """Soft PZT that slides at 1: the loads about the force, which the open stiffness needs, never settle."""
    film = {"material": "PZT-5H", "thickness": 1e-4, "base": "steel", "friction": 1.0}
    egg = film | {"profile": "ellipsoid", "radius_x": 5e-3, "radius_y": 1e-2, "grid_error": 1e-2}
    stiffness = float(solver.solve(egg | {"force": 1.0}, outputs=["contact_stiffness_open"])["contact_stiffness_open"])
    low, high = (float(solver.solve(egg | {"force": force}, outputs=["depth"])["depth"]) for force in (0.9, 1.1))
    assert stiffness == pytest.approx(0.2 / (high - low), rel=0.02)  # measured: 5e-3


def test_an_error_that_the_finest_grid_does_not_reach_is_warned_of(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contact, "_REFINED", 32)
    monkeypatch.setattr(contact, "_SLOPED", 32)
    with pytest.warns(solver.PrecisionWarning, match="^grid_error: 0.0001 is not reached on the finest grid by 1 of 1"):
        out = solver.solve(BALL | {"grid_error": 1e-4})
    assert 1e-4 < float(out["relative_error"]) < 0.1


def test_the_middle_of_a_long_roller_in_air_is_a_line() -> None:
    """Between lengths of 3 and 6 mm the charge of a roller grows by that of a line: the ends' part is constant."""
    film = {"material": "PVDF", "thickness": 1.1e-4, "base": "steel", "radius": 1e-3}
    line = float(solver.solve(film | {"profile": "cylinder", "load": 2e4})["charge_per_force"])
    lengths, charges = (3e-3, 6e-3), []
    for length in lengths:
        roller = film | {"profile": "roller", "length": length, "force": 2e4 * length, "grid_error": 0.03}
        charges.append(float(solver.solve(roller, outputs=["charge_per_force"])["charge_per_force"]) * length)
    assert (charges[1] - charges[0]) / (lengths[1] - lengths[0]) == pytest.approx(line, rel=2e-3)  # measured: 4e-4


def test_a_contact_at_a_sharp_end_has_no_largest_pressure() -> None:
    """As for points, what is infinite is no quantity: on a grid it would grow with the number of cells."""
    roller = {"material": "PZT-4", "profile": "roller", "radius": 0.02, "length": 5e-3, "force": 25.0} | COARSE
    film = {"thickness": 1e-4, "base": "steel", "punch": "steel", "tilt": 1e-4}
    names = ["contact_length_y", "peak_pressure"]
    crowned, at_end = (solver.solve(roller | film | {"crown_radius": crown}, outputs=names) for crown in (3.0, 8.0))
    assert float(crowned["contact_length_y"]) / 2 + 3.0 * 1e-4 < 2.5e-3
    assert set(crowned.data_vars) == set(names)
    assert set(at_end.data_vars) == {"contact_length_y"}
