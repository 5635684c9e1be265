"""Contacts in space against closed forms, points and one another."""

import numpy as np
import pytest
from scipy.special import ellipe, ellipk

import solver
from solver.surface.contact import Slopes, SurfaceContact, solve_contact
from solver.surface.quantities import quantities
from solver.surface.response import SurfaceBody, SurfaceError
from solver.surface.shape import Cone, Disc, Ellipsoid, Map, Roller, RoughSphere, sphere
from tests.solver.surface.crystals import film, hexagonal, lithium_niobate, tilted, y_cut

PZT = SurfaceBody((), hexagonal("PZT-4"))
FILM = film(hexagonal("PZT-4"), 1e-4)


def modulus(body: SurfaceBody) -> float:
    """Effective modulus of contacts at zero potential [Pa]."""
    Y = body.multiplier(np.array([np.inf]), np.array([0.0]))[0, 0].real
    return float(2 / (Y[2, 2] - Y[2, 3] ** 2 / Y[3, 3]))


def per_force(contact: SurfaceContact) -> float:
    """Charge per force [pC/N]."""
    return 1e12 * contact.charge / float(contact.force[2])


def test_sphere_on_a_half_space_is_hertz() -> None:
    depth = 1e-6
    contact = solve_contact(PZT, sphere(5e-3), depth=depth, air=None, cells=64)
    load = 4 / 3 * modulus(PZT) * np.sqrt(5e-3) * depth**1.5
    assert contact.force[2] == pytest.approx(load, rel=2e-4)
    assert per_force(contact) == pytest.approx(250.10013, rel=1e-7)  # whatever the grid
    assert contact.area == pytest.approx(np.pi * 5e-3 * depth, rel=2e-3)
    np.testing.assert_allclose(contact.lengths, 2 * np.sqrt(5e-3 * depth), rtol=5e-3)


@pytest.mark.parametrize("ratio", [2, 10])
def test_ellipsoid_is_hertz(ratio: float) -> None:
    """Load and peak of an elliptic contact of semi-axes in this ratio."""
    a, e2 = 1e-4, 1 - 1 / ratio**2
    K, E = ellipk(e2), ellipe(e2)
    b, peak = a / ratio, 1e8
    Es = modulus(PZT)
    curvature_a = peak / Es * b / (a**2 * e2) * 2 * (K - E) / 2
    curvature_b = peak / Es * b / (a**2 * e2) * 2 * ((a / b) ** 2 * E - K) / 2
    contact = solve_contact(
        PZT, Ellipsoid(1 / (2 * curvature_a), 1 / (2 * curvature_b)), depth=peak / Es * b * K, air=None, cells=128
    )
    assert contact.force[2] == pytest.approx(2 / 3 * np.pi * a * b * peak, rel=2e-4)
    assert contact.peak_pressure == pytest.approx(peak, rel=5e-4)


@pytest.mark.parametrize("radius", [5e-3, 20e-3])
def test_sphere_on_a_film_has_the_charge_of_the_point(radius: float) -> None:
    point = solver.solve({
        "body": solver.Stack([solver.Layer("PZT-4", 1e-4)]), "profile": "sphere", "radius": radius, "force": 4.0,
        "surroundings": "insulated",
    })  # fmt: skip
    contact = solve_contact(FILM, sphere(radius), force=4.0, air=None)
    assert per_force(contact) == pytest.approx(1e12 * float(point["charge_per_force"].squeeze()), rel=1e-3)


@pytest.mark.parametrize(
    ("stiffness", "charge"),
    [
        (lithium_niobate(), 13.213),
        (lithium_niobate(y_cut(36)), 15.93),
        (lithium_niobate(y_cut(128)), 13.60),
        (hexagonal("PZT-4", tilted(30)), 222.0),
    ],
)
def test_charge_of_a_cut_is_its_stroke(stiffness: np.ndarray, charge: float) -> None:
    contact = solve_contact(SurfaceBody((), stiffness), sphere(1.0), depth=1e-4, cells=64)
    force, induced = contact.tangent
    stroke = -1e12 * force[1] / force[0]
    assert stroke == pytest.approx(charge, rel=4e-3)  # the reference's air ends at twice the contact
    assert per_force(contact) == pytest.approx(stroke, rel=4e-3)
    # a gap that closes at the edge takes charge, which linear reciprocity leaves out: up to 1 % where air is thin
    assert 1e12 * induced[0] / force[0] == pytest.approx(stroke, rel=1.2e-2)


def test_turning_the_crystal_turns_the_contact() -> None:
    loads = []
    for azimuth in (0.0, np.pi / 2):
        body = film(hexagonal("PZT-4", tilted(30, azimuth)), 1e-4)
        contact = solve_contact(body, sphere(5e-3), force=4.0, cells=32)
        loads.append(contact)
    assert loads[1].charge == pytest.approx(loads[0].charge, rel=1e-6)
    lever = 1e-4 * loads[0].lengths[0]  # of the contact's middle
    assert loads[1].moments[0] == pytest.approx(-loads[0].moments[1], abs=4.0 * lever)
    assert loads[1].moments[1] == pytest.approx(loads[0].moments[0], abs=4.0 * lever)


def test_sliding_sphere_loses_load_and_charge_to_the_second_order() -> None:
    body = SurfaceBody((), hexagonal("BaTiO3"))
    rest, slow, fast = (
        solve_contact(body, sphere(1.0), depth=1e-4, friction=eta, air=None, cells=64) for eta in (0.0, 0.3, 0.6)
    )
    # windows differ by 2 %, which changes forces by some 3e-5; grids of 128 and 192 cells give -7.70e-4 and -3.04e-3
    assert slow.force[2] / rest.force[2] - 1 == pytest.approx(-7.62e-4, abs=8e-5)
    assert fast.force[2] / rest.force[2] - 1 == pytest.approx(-2.99e-3, abs=8e-5)
    assert slow.charge / rest.charge - 1 == pytest.approx(-1.38e-3, rel=0.1)  # like its edge cells
    np.testing.assert_allclose(fast.force, [0.6 * fast.force[2], 0, fast.force[2]])


@pytest.mark.parametrize("thickness", [None, 1e-4])
def test_ball_in_air_has_the_quantities_of_the_point(thickness: float | None) -> None:
    layer = {"body": solver.Stack([solver.Layer("PZT-4", thickness or 1.0)])}
    punch = {"profile": "sphere", "radius": 5e-3, "force": 4.0, "surroundings": "air"}
    point = solver.solve(({"material": "PZT-4"} if thickness is None else layer) | punch)
    body = PZT if thickness is None else FILM
    contact = solve_contact(body, sphere(5e-3), force=4.0, charge=0.0, end=5e-3, slopes=Slopes.BY_LOAD, cells=64)
    values = quantities(contact, Slopes.BY_LOAD)
    # charge at the edge, over single cells, decides voltages and capacitances
    bounds = {
        "depth": 1e-3, "charge_per_force": 1e-3, "peak_pressure": 1e-3, "contact_stiffness": 2e-3,
        "contact_stiffness_open": 2e-3, "voltage": 4e-3, "stroke_per_volt": 2e-3, "blocked_force_per_volt": 2e-3,
        "capacitance": 4e-3, "capacitance_at_force": 4e-3, "voltage_per_force": 2e-2,
    }  # fmt: skip
    for name, bound in bounds.items():
        assert values[name] == pytest.approx(float(point[name].squeeze()), rel=bound), name
    assert values["contact_area"] == pytest.approx(np.pi * float(point["contact_radius"].squeeze()) ** 2, rel=1e-2)


def test_elastic_punch_softens_as_its_compliance_does() -> None:
    punch = (70e9, 0.33)
    depth = 1e-6
    contact = solve_contact(PZT, sphere(5e-3), depth=depth, punch=punch, air=None, cells=64)
    stiff = 1 / (1 / modulus(PZT) + (1 - punch[1] ** 2) / punch[0])
    assert contact.force[2] == pytest.approx(4 / 3 * stiff * np.sqrt(5e-3) * depth**1.5, rel=3e-4)


def test_cone_and_disc_have_their_closed_forms() -> None:
    Es = modulus(PZT)
    cone = solve_contact(PZT, Cone(0.01), force=1.0, air=None)
    assert cone.depth == pytest.approx(np.sqrt(np.pi * 0.01 / (2 * Es)), rel=1e-3)
    disc = solve_contact(PZT, Disc(1e-4), force=1.0, air=None)
    assert disc.depth == pytest.approx(1 / (2 * Es * 1e-4), rel=1e-3)


def test_map_of_a_sphere_is_the_sphere() -> None:
    x = (np.arange(81) - 40) * 4e-6
    heights = (x[:, None] ** 2 + x**2) / (2 * 5e-3)
    contact, exact = (
        solve_contact(PZT, shape, force=4.0, air=None, cells=64) for shape in (Map(heights, (4e-6, 4e-6)), sphere(5e-3))
    )
    assert contact.depth == pytest.approx(exact.depth, rel=1e-5)


def test_middle_of_a_long_roller_is_the_plane() -> None:
    """Depth and largest pressure against those of a line of the same load per length at zero voltage."""
    contact = solve_contact(FILM, Roller(5e-3, 2e-3), depth=1.2e-6, air=None, cells=64)
    middle = np.argsort(np.abs(contact.y))[:2]
    load = np.sum(np.mean(contact.pressure[:, middle], axis=1)) * (contact.x[1] - contact.x[0])
    line = {
        "body": solver.Stack([solver.Layer("PZT-4", 1e-4)]), "radius": 5e-3, "load": load, "surroundings": "insulated",
    }  # fmt: skip
    charge = load * float(solver.solve(line)["charge_per_force"].squeeze())
    plane = solver.solve(line | {"charge": charge})
    assert contact.depth == pytest.approx(float(plane["depth"].squeeze()), rel=1e-3)
    assert np.max(contact.pressure[:, middle]) == pytest.approx(float(plane["peak_pressure"].squeeze()), rel=1e-3)


def test_charge_varies_smoothly_with_the_load() -> None:
    forces = 4.0 * 1.03 ** np.arange(5)
    charges = np.log([per_force(solve_contact(FILM, sphere(5e-3), force=f, cells=64, end=5e-3)) for f in forces])
    assert np.ptp(np.diff(charges)) < 4e-4  # between neighbours that differ by 1e-3


def test_roughness_raises_the_pressure_and_leaves_the_charge() -> None:
    x = (np.arange(128) - 63.5) * 2e-6
    waves = np.random.default_rng(1).normal(size=(128, 128))
    k = np.hypot(*np.meshgrid(np.fft.fftfreq(128, 2e-6), np.fft.fftfreq(128, 2e-6)))
    rough = np.fft.ifft2(np.fft.fft2(waves) * np.exp(-((k * 12e-6) ** 2))).real
    ball = (x[:, None] ** 2 + x**2) / (2 * 5e-3)
    smooth, hilly = (
        solve_contact(FILM, Map(ball + rms * rough / np.std(rough), (2e-6, 2e-6)), force=4.0, cells=128)
        for rms in (0.0, 2e-8)
    )
    assert hilly.peak_pressure > 1.5 * smooth.peak_pressure
    assert per_force(hilly) == pytest.approx(per_force(smooth), rel=5e-3)


def test_tilted_roller_presses_harder_at_one_end() -> None:
    straight, tilted_roller = (
        solve_contact(FILM, Roller(5e-3, 1e-3, 5.0, tilt), force=50.0, cells=16) for tilt in (0.0, 1e-4)
    )
    assert abs(straight.moments[0]) < 1e-3 * 50 * 1e-3
    assert tilted_roller.moments[0] > 50 * 2e-5  # its lowest point lies at negative y
    floating = solve_contact(FILM, Roller(5e-3, 2e-3, 0.5), force=1.0, charge=0.0, end=5e-3, cells=16)
    assert floating.voltage < -1  # its contact is shorter than the roller, whose gap goes on beyond the window
    assert tilted_roller.peak_pressure > 1.05 * straight.peak_pressure


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"force": None}, "exactly one"),
        ({"force": -1.0}, "force: -1.0 is not allowed"),
        ({"friction": float("nan")}, "friction"),
        ({"cells": 10**6}, "cells"),
    ],
)
def test_bad_loading_is_refused_in_one_line(change: dict[str, float], message: str) -> None:
    with pytest.raises(SurfaceError, match=message) as caught:
        solve_contact(PZT, sphere(1e-3), **({"force": 1.0} | change))  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)


def test_maps_without_sense_are_refused() -> None:
    with pytest.raises(SurfaceError, match="height_map: not a finite number"):
        Map(np.where(np.arange(64) == 9, np.nan, 0.0).reshape(8, 8), (1e-6, 1e-6))
    with pytest.raises(SurfaceError, match="height_map: shape"):
        Map(np.zeros((1, 1)), (1e-6, 1e-6))
    x = (np.arange(41) - 20) * 1e-4
    coarse = Map((x[:, None] ** 2 + x**2) / (2 * 5e-3), (1e-4, 1e-4))
    with pytest.raises(SurfaceError, match=r"map_spacing: 0\.0001 m of the height map is too wide"):
        solve_contact(PZT, coarse, force=1.0)
    narrow = Map((x[:, None] ** 2 + x**2) / (2 * 50), (1e-6, 1e-6))
    with pytest.raises(SurfaceError, match="height_map: the contact reaches the edge"):
        solve_contact(PZT, narrow, force=10.0)


def test_insulated_surroundings_of_a_cut_are_refused() -> None:
    with pytest.raises(SurfaceError, match="surroundings: insulated"):
        solve_contact(SurfaceBody((), lithium_niobate()), sphere(1e-3), force=1.0, air=None)


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


def test_a_contact_at_a_sharp_end_has_no_largest_pressure() -> None:
    """As for points, what is infinite is no quantity: on a grid it would grow with the number of cells."""
    roller = {
        "material": "PZT-4",
        "profile": "roller",
        "radius": 0.02,
        "length": 5e-3,
        "force": 25.0,
        "grid_error": 0.03,
    }
    film = {"thickness": 1e-4, "base": "steel", "punch": "steel", "tilt": 1e-4}
    crowned, at_end = (solver.solve(roller | film | {"crown_radius": crown}) for crown in (3.0, 8.0))
    assert "peak_pressure" in crowned
    assert "peak_pressure" not in at_end
    assert "charge_per_force" in at_end
    assert float(crowned["contact_length_y"]) / 2 + 3.0 * 1e-4 < 2.5e-3
