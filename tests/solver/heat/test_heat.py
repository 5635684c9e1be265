"""Heat: temperatures in layers, and the charge that they make, against closed forms and finite volumes."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

import solver
from approximation.arrays import Array
from solver import Layer, Stack
from solver.heat.charge import HeatedStack, HeatError, conduction, film_coefficient, layer_weights
from solver.heat.conduction import Conduction
from solver.heat.touch import Patch, Spot, Warmed
from solver.material.evidence import Sourced
from solver.material.punches import punches
from solver.names import HEAT_QUANTITIES
from tests.refusals import assert_refused
from verification.oracles.heat import Slab, film_mean, spot_heat

PDMS, FILM, FR4 = (0.15, 970 * 1460.0), (0.2, 1880 * 1300.0), (0.3, 1850 * 1100.0)  # W/m/K, J/m3/K
PZT, STEEL = (1.2, 3.3e6), (50.0, 3.69e6)
RINGS = 5e-3  # rings have 2e-3, volumes 3e-3: both by meshes twice as fine
AT_ONCE = np.zeros(1)


def layered(thickness: list[float], *bodies: tuple[float, float]) -> Conduction:
    conductivity, capacity = np.array(bodies).T
    return Conduction(np.array(thickness), conductivity, capacity)


def copolymer() -> solver.Material:
    """The film of the page of theory, with the pyroelectric coefficient that its numbers were computed with."""
    film = solver.find("P(VDF-TrFE) 75:25 (alternative 1)")
    return replace(film, thermal={**film.thermal, "pyroelectric": Sourced(-35e-6, "theory page")})


def thin(body: tuple[float, float], depth: float = 1e-9) -> Conduction:
    """A half-space whose surface is a layer."""
    return layered([depth], body, body)


@pytest.mark.parametrize("shape", ["disc", "strip"])
def test_bodies_that_touch_meet_at_the_mean_of_their_effusivities(shape: Any) -> None:
    """Early; late the surface of a disc is at the mean of the conductivities, as in steady conduction."""
    b, b_punch = (np.sqrt(kappa * c) for kappa, c in (PZT, STEEL))
    early = Warmed.after(thin(PZT, 1e-11), np.ones(1), Spot(shape, 1e-2, STEEL), 1e-5)
    assert early.means[0] == pytest.approx(b_punch / (b + b_punch), rel=1e-4)
    if shape == "disc":
        late = Warmed.after(thin(PZT), np.ones(1), Spot(shape, 1e-5, STEEL), 100.0)
        assert late.means[0] == pytest.approx(STEEL[0] / (STEEL[0] + PZT[0]), rel=1e-3)


@pytest.mark.parametrize("film", [0, 1, 2])
def test_layers_warm_as_finite_volumes_do(film: int) -> None:
    slabs = [Slab(0.2e-3, *PDMS), Slab(20e-6, 400.0, 3.45e6), Slab(80e-6, *FILM)]
    base = Slab(np.inf, *FR4)
    body = layered([slab.thickness for slab in slabs], PDMS, (400.0, 3.45e6), FILM, FR4)
    means = body.means(AT_ONCE, 0.5)
    assert means[film, 0] == pytest.approx(film_mean(slabs, base, film, 0.5, 100), abs=1e-6)


@pytest.mark.parametrize(("radius", "collecting"), [(2e-3, 1e-3), (0.7e-3, 0.7e-3), (0.5e-3, 1.5e-3)])
def test_a_patch_below_a_cover_collects_as_axisymmetric_volumes_say(radius: float, collecting: float) -> None:
    warmed = Warmed.after(layered([0.5e-3, 50e-6], PDMS, FILM, FR4), np.array([0.0, 1.0]), Spot("disc", radius), 2.0)
    for distance in (0.0, 1e-3):
        patch = Patch("disc", collecting, distance)

        def share(r: Array, patch: Patch = patch) -> Array:
            return patch.share(r, line=False)

        volumes = spot_heat(
            [Slab(0.5e-3, *PDMS), Slab(50e-6, *FILM)], Slab(np.inf, *FR4), 1, 2.0, radius,
            share=share, marks=patch.ends,
        )  # fmt: skip
        assert warmed.over(patch) == pytest.approx(volumes, rel=RINGS), distance


HALF, RADIUS, FILM_GAP = 36e-6, 0.02, 9.3e-8  # a ball on a film, as in docs/heat.md: m


def height(r: Any) -> Any:
    """Ball above a half-space beside its contact: indented depth and profile, less the surface's displacement [m]."""
    x = np.maximum(r / HALF, 1.0)
    sunk = ((2 - x**2) * np.arcsin(1 / x) + np.sqrt(x**2 - 1)) / np.pi
    return HALF**2 / RADIUS * (x**2 / 2 - 1 + sunk)


@pytest.mark.parametrize(
    ("time", "shape", "punch"),
    [(1e-4, "disc", STEEL), (1.0, "disc", None), (1e-4, "strip", None), (1.0, "strip", STEEL), (1.0, "disc", STEEL)],
)
def test_a_bare_film_warms_below_and_beside_its_contact_as_volumes_do(time: float, shape: Any, punch: Any) -> None:
    """From two half-spaces (the contact over the diffusion length 6) to steady spreading (0.06)."""
    warmed = Warmed.after(layered([80e-6], PZT, STEEL), np.ones(1), Spot(shape, HALF, punch), time)
    for collected, share in (
        (warmed.over(None), np.ones_like),
        (warmed.over(Patch(shape, HALF)), lambda r: np.where(r < HALF, 1.0, 0.0)),
    ):
        volumes = spot_heat(
            [Slab(80e-6, *PZT)], Slab(np.inf, *STEEL), 0, time, HALF, share=share, line=shape == "strip",
            punch=Slab(np.inf, *punch) if punch else None,
        )  # fmt: skip
        assert collected == pytest.approx(volumes, rel=RINGS)
    assert warmed.over(Patch(shape, HALF)) == pytest.approx(warmed.on_punch(FILM_GAP), rel=1e-3)


def test_a_ball_warms_a_film_through_the_air_as_volumes_do() -> None:
    """Most of the charge of a ball in air comes from beside its contact."""
    spots = (Spot("disc", HALF, STEEL), Spot("disc", HALF, STEEL, RADIUS))
    alone, in_air = (Warmed.after(layered([80e-6], PZT, STEEL), np.ones(1), spot, 1.0) for spot in spots)
    volumes = spot_heat(
        [Slab(80e-6, *PZT)], Slab(np.inf, *STEEL), 0, 1.0, HALF, punch=Slab(np.inf, *STEEL),
        share=lambda r: FILM_GAP / (FILM_GAP + height(r)), gap=lambda r: height(r) + 2.7e-7,
    )  # fmt: skip
    assert in_air.on_punch(FILM_GAP) == pytest.approx(volumes, rel=2 * RINGS)  # volumes resolve the gap by 1e-2
    assert in_air.on_punch(FILM_GAP) > 10 * alone.on_punch(FILM_GAP)


def test_a_disc_aside_collects_its_part_of_each_ring() -> None:
    r = np.linspace(1e-5, 4e-3, 40_001)
    for half, distance in ((1e-3, 0.0), (1e-3, 0.4e-3), (1e-3, 2e-3)):
        area = np.trapezoid(2 * np.pi * r * Patch("disc", half, distance).share(r, line=False), r)
        assert area == pytest.approx(np.pi * half**2, rel=1e-3)


def test_a_circuit_that_forgets_shows_the_convolution() -> None:
    body, leak, time = layered([0.4e-3, 50e-6], PDMS, FILM, FR4), 0.3, 2.0

    def mean(elapsed: float) -> float:
        return float(body.means(AT_ONCE, elapsed)[1, 0])

    convolved = mean(time) - quad(lambda u: mean(time - u) * np.exp(-u / leak) / leak, 0, time, epsabs=1e-9)[0]
    assert body.means(AT_ONCE, time, leak)[1, 0] == pytest.approx(convolved, abs=1e-7)


def test_a_film_on_a_base_has_the_coefficient_of_the_full_law() -> None:
    film, base = copolymer(), solver.find("FR4")
    assert film_coefficient(film, base) == pytest.approx(-44.242447e-6, rel=1e-7)
    assert film_coefficient(film) == -35e-6
    for name in ("PZT-4", "BaTiO3", "AlN", "PVDF"):
        m, steel = solver.find(name), solver.find("steel")
        p, alpha = (m.thermal[key].value for key in ("pyroelectric", "expansion"))
        c = np.array([[m.c11, m.c12, m.c13], [m.c12, m.c11, m.c13], [m.c13, m.c13, m.c33]], dtype=float)
        e = np.array([m.e31, m.e31, m.e33], dtype=float)
        along = 3 * alpha  # any: it drops out
        free = np.array([alpha, alpha, along])
        stretch = np.full(2, steel.thermal["expansion"].value)
        upright = ((c @ free)[2] - c[2, :2] @ stretch) / c[2, 2]
        induction = p + e @ (np.array([*stretch, upright]) - free)
        assert film_coefficient(m, steel) == pytest.approx(induction, rel=1e-12)
    assert film_coefficient(solver.find("glass"), base) == 0.0
    assert_refused(HeatError, "heat: not known for PIC255: pyroelectric", film_coefficient, solver.find("PIC255"))


@pytest.mark.parametrize("name", ["PZT-4", "PVDF", "AlN"])
def test_signs_are_those_of_the_charge_per_force(name: str) -> None:
    """Heat on an electrode has the sign of -p e33 times that of the force, at every electrode of a stack."""
    bare = Stack([Layer(name, 20e-6)], "steel")
    pressed = {"profile": "disc", "width": 2e-3, "force": 1.0, "surroundings": "insulated", "magnetic": "insulating"}
    punch = float(solver.solve({"body": bare, **pressed})["charge_per_force"])
    film = Stack([Layer("glass", 20e-6, "grounded"), Layer(name, 20e-6)], "steel")
    read = {**pressed, "electric": "insulating", "collector": 2, "patch_size": 1e-3}
    patch = float(solver.solve({"body": film, **read})["patch_charge_per_force"])
    material = solver.find(name)
    sign = np.sign(material.e33) * -np.sign(film_coefficient(material, solver.find("steel")))
    for charge, heat in ((punch, layer_weights(bare)[0]), (patch, layer_weights(film, 2)[1])):
        assert np.sign(charge) * np.sign(heat) == sign
    assert layer_weights(film, 1)[1] == -layer_weights(film, 2)[1]


def test_layers_in_series_share_a_charge_and_opposite_poling_cancels() -> None:
    film = copolymer()
    flipped = replace(
        film, e31=-film.e31, e33=-film.e33, e15=-film.e15, name="flipped",
        thermal={**film.thermal, "pyroelectric": Sourced(35e-6, "turned over")},
    )  # fmt: skip
    twice = Stack([Layer(film, 25e-6), Layer(film, 25e-6)], "FR4")
    single = Stack([Layer(film, 50e-6)], "FR4")
    assert layer_weights(twice).sum() == pytest.approx(layer_weights(single)[0])
    pair = Stack([Layer(film, 25e-6), Layer(flipped, 25e-6)], "FR4")
    assert HeatedStack.of(pair).uniform == pytest.approx(0.0, abs=1e-18)
    assert_refused(HeatError, "base 'rigid'", conduction, Stack([Layer(film, 50e-6)]))


def test_heat_overtakes_a_force_when_its_charge_is_as_large() -> None:
    heated = HeatedStack.of(Stack([Layer("PDMS", 1e-3, "grounded"), Layer(copolymer(), 50e-6)], "FR4"), 2)
    spot, patch = Spot("disc", 2e-3), Patch("disc", 1e-3)
    time = heated.overtaken(spot, patch, 1e-13)
    assert abs(heated.collected(heated.warmed(spot, time), patch)) == pytest.approx(1e-13, rel=1e-5)
    assert np.isinf(heated.overtaken(spot, patch, 1e-3))


TOUCH: dict[str, Any] = {"touch_temperature": 306.15, "body_temperature": 295.15, "hold": [0.3, 10.0]}


def test_a_touched_film_has_its_heat_beside_the_quantities_of_its_contact() -> None:
    skin = {"profile": "sphere", "radius": "10 mm", "punch": "skin", "force": [5e-3, 50e-3], "magnetic": "insulating"}
    body = Stack([Layer("PDMS", 1e-3, "grounded"), Layer(copolymer(), 50e-6)], "FR4")
    read = {"body": body, **skin, "electric": "insulating", "collector": 2, "patch_size": "2 mm"}
    bare, out = solver.solve(read), solver.solve(read | TOUCH)
    for name in bare:  # over all dimensions, one of which changes nothing
        assert out[name].dims == ("force", "hold")
        np.testing.assert_array_equal(out[name].isel(hold=0), bare[name])
    thermal, heated = punches()["skin"].thermal, HeatedStack.of(body, 2)
    finger = thermal["conductivity"].value, thermal["heat_capacity"].value
    last = out.isel(force=1, hold=1)
    warmed = heated.warmed(Spot("disc", float(last["contact_radius"]), finger), TOUCH["hold"][1])
    warmth = 11.0 * heated.collected(warmed, Patch("disc", 1e-3))
    assert float(last["heat_charge"]) == pytest.approx(warmth)
    touch = abs(float(last["patch_charge_per_force"])) * 50e-3
    assert float(last["temperature_equal"]) == pytest.approx(11.0 * touch / abs(warmth), rel=1e-9)
    for share in (1.0, 0.1):
        light = read | TOUCH | {"force": 5e-3, "heat_share": share}
        overtaken = solver.solve(light)["heat_time"].values.max()
        lasting = solver.solve(light | {"hold": overtaken})
        assert float(lasting["temperature_equal"].squeeze()) == pytest.approx(11.0 / share, rel=1e-5)


@pytest.mark.parametrize("load", [{"profile": "sphere", "force": 0.1}, {"load": 1e3}])
@pytest.mark.parametrize("surroundings", ["air", "insulated"])
def test_neither_force_nor_heat_charges_silicone(load: dict[str, Any], surroundings: str) -> None:
    film = {"material": "PDMS", "thickness": 1e-3, "base": "FR4", "punch": "steel", "radius": 0.005, "hold": 1.0}
    out = solver.solve({**film, **load, "surroundings": surroundings, "touch_temperature": 294.15})
    charge = out["heat_charge" if "force" in load else "heat_charge_per_length"]
    assert (float(charge), float(out["temperature_equal"]), float(out["heat_time"])) == (0.0, 1e6, 1e6)


def test_a_decaying_read_out_loses_the_touch_before_the_heat() -> None:
    film = {"material": "PZT-4", "thickness": 50e-6, "base": "steel", "punch": "steel", "radius": 0.05, "load": 5e3}
    slow, fast = (
        solver.solve({**film, **TOUCH, "feedback_resistance": r, "feedback_capacitance": "10 pF"})
        for r in ("10 TOhm", "10 GOhm")
    )
    assert "heat_charge" not in slow
    assert abs(fast["heat_charge_per_length"][..., 1]).max() < abs(slow["heat_charge_per_length"][..., 1]).max()
    assert (fast["temperature_equal"] < slow["temperature_equal"]).all()


@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        ("conductivity", 0.0, "a finite number > 0 [W m-1 K-1]"),
        ("conductivity", np.nan, "a finite number > 0 [W m-1 K-1]"),
        ("heat_capacity", -1.0, "a finite number > 0 [J m-3 K-1]"),
        ("expansion", np.inf, "a finite number [K-1]"),
        ("pyroelectric", np.nan, "a finite number [C m-2 K-1]"),
    ],
)
def test_a_constant_that_no_material_has_is_refused(name: str, value: float, allowed: str) -> None:
    film = solver.find("PZT-4")
    film = replace(film, name="mine", thermal={**film.thermal, name: Sourced(value, "nobody")})
    case = {"material": "mine", "thickness": 50e-6, "base": "steel", "radius": 0.05, "load": 5e3, **TOUCH}
    with pytest.raises(solver.MaterialError, match=re.escape(f"mine: thermal: {name}: {value:g} is not {allowed}")):
        solver.solve(case, materials={"mine": film})


def test_a_film_without_a_constant_has_no_heat_and_says_why() -> None:
    film = {"thickness": 50e-6, "base": "steel", "radius": 0.05, "load": 5e3, **TOUCH}
    out = solver.solve({"material": "PIC255", **film})
    assert not HEAT_QUANTITIES.keys() & set(out)
    assert "charge_per_force" in out
    assert out.attrs["heat"] == "not known for PIC255: pyroelectric"
    assert "rigid" in solver.solve({"material": "PZT-4", **film, "base": "rigid"}).attrs["heat"]
