"""Films and stacks under a long punch: electrodes, capacitances, kernels, fields inside and their largest values."""

from dataclasses import replace
from itertools import cycle, product
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import quad_vec
from scipy.interpolate import BarycentricInterpolator
from scipy.linalg import expm
from scipy.optimize import brentq

import solver
from solver.arrays import Array
from solver.line import outputs
from solver.line.fields import local_fields
from solver.line.kernel import ENTRIES, Kernel, kernel
from solver.line.outputs import Assembly
from solver.line.table import SlowWarning, at, table
from solver.names import FILM_PEAKS
from solver.stack.electrodes import Electrode, electrodes
from solver.stack.layers import RIGID, Layer, Stack
from solver.stack.reflection import waves
from tests.solver.cases import AXIAL, BTO, CFO, FIBROUS, SILICON, STEEL, assert_alike

PVDF, PZT, PDMS, GLASS, COPPER = (solver.find(name) for name in ("PVDF", "PZT-4", "PDMS", "glass", "copper"))
BARE: dict[str, Any] = {"surroundings": "insulated"}
BALL = BARE | {"profile": "sphere", "radius": 0.01, "force": 0.3, "magnetic": "insulating"}
ROLLER = BARE | {"radius": 0.05, "load": 2e4, "friction": 0.3, "datum": 0.1}
COVERS = {"rubber": Layer(PDMS, 1e-3, "grounded"), "ceramic": Layer(FIBROUS, 2e-4, "grounded")}
ACTIVE = Stack([Layer(GLASS, 1e-4, "grounded"), Layer(BTO, 1e-4, "grounded"), Layer(FIBROUS, 2e-4)], SILICON)
BURIED = {"collector": 2, "body": Stack([Layer(GLASS, 1e-4, "grounded"), Layer(BTO, 1e-4)])}


def charge(solution: xr.Dataset, name: str = "electrode_charge_per_force") -> Array:
    return np.asarray(solution[name].values)


def patch_charge(factors: dict[str, Any]) -> Array:
    return charge(solver.solve(factors), "patch_charge_per_force")


@pytest.mark.parametrize("cover", COVERS)
@pytest.mark.parametrize("punch", [BALL, ROLLER], ids=["ball", "roller"])
def test_full_electrodes_have_e33_over_c33_under_any_cover(cover: str, punch: dict[str, Any]) -> None:
    case = punch | ({"load": 1e3} if cover == "rubber" and "load" in punch else {})
    body = Stack([COVERS[cover], Layer(PVDF, 5e-5)])
    solution = solver.solve(case | {"body": body, "collector": [1, 2]}).transpose(..., "collector")
    exact = float(PVDF.e33 / PVDF.c33)
    assert charge(solution).size
    np.testing.assert_allclose(charge(solution) / [exact, -exact], 1.0, rtol=1e-12)


def test_electrodes_and_punch_have_no_charge_together() -> None:
    body = Stack([Layer(GLASS, 1e-4, "grounded"), Layer(BTO, 1e-4), Layer(COPPER, 2e-5), Layer(PZT, 1e-4)], SILICON)
    assert electrodes(body) == [(0,), (1, 2), (3,)]
    for case, name in ((BALL | {"force": 1.0}, "total_charge"), (ROLLER, "charge")):
        q = 1e-11 * float(case.get("load", 1.0))
        charges = charge(solver.solve(case | {name: q, "body": body, "collector": [1, 2, 3]}))
        assert np.sum(charges) == pytest.approx(-1e-11, rel=1e-10)
        assert np.min(np.abs(charges)) > 1e-13


@pytest.mark.parametrize(
    ("case", "patch"),
    [(ROLLER | BURIED, "strip"), (BALL | BURIED, "strip"), (BALL | BURIED, "disc")],
    ids=["roller", "ball", "ball, disc"],
)
def test_patches_add_up_to_the_electrode_and_differ_by_its_gradient(case: dict[str, Any], patch: str) -> None:
    endless = patch_charge(case | {"patch": patch, "patch_size": 0.05})
    assert endless == pytest.approx(charge(solver.solve(case)), rel=1e-10)
    case, width = case | {"patch": patch}, 5e-5
    if patch == "strip":
        parts = patch_charge(case | {"patch_size": width, "patch_position": width * np.arange(-10, 11)})
        assert np.sum(parts) == pytest.approx(patch_charge(case | {"patch_size": 21 * width}), rel=1e-10)
    step, pitch = 1e-7, 1.7e-4
    solution = solver.solve(case | {"patch_size": 1e-4, "patch_pitch": pitch})
    near = patch_charge(case | {"patch_size": 1e-4, "patch_position": [0.0, pitch, pitch / 2 - step, pitch / 2 + step]})
    assert float(solution["crosstalk"]) == pytest.approx(near[1] / near[0], rel=1e-12)
    assert float(solution["patch_charge_gradient"]) == pytest.approx((near[2] - near[3]) / step, rel=1e-5)


def by_exponentials(stack: Stack, wave: float) -> tuple[Array, Array]:
    """[k u; t] on top, and k phi of every electrode below a layer, the lowest first; (8, n) and (electrode, n).

    The n columns are of the base's tractions (4) and of the charges of the electrodes, the lowest first.
    """
    assert stack.base_medium is not None
    columns, phi = np.concatenate([stack.base_medium.compliance, np.eye(4)]), list[Array]()
    for layer, medium in zip(stack.layers[::-1], stack.media[::-1], strict=True):
        if not phi or layer.electric == "grounded":
            columns = np.concatenate([columns, np.eye(8)[:, [6]]], 1)
            phi.append(columns[2])
        columns = expm(wave * layer.thickness * medium.system) @ columns
    return columns, np.array([np.pad(row, (0, columns.shape[1] - row.size)) for row in phi])


def test_the_charge_is_reciprocal_to_what_the_voltage_moves() -> None:
    """u_y of the surface per phi of an electrode, by matrix exponentials of each layer, is the charge per sigma_yy."""
    k = np.array([1e3, 3e3, 1e4])
    for wave, row in zip(k.tolist(), Electrode(ACTIVE, 2).rows(k)[:, 0], strict=True):
        columns, phi = by_exponentials(ACTIVE, wave)
        # no traction on top, then phi of the electrodes below
        system = np.concatenate([columns[4:], phi])
        driven = np.eye(len(system))[5]  # k phi of one electrode in these units
        moved = columns[1] @ np.linalg.solve(system, driven)
        assert abs(moved) > 1e-6
        assert moved == pytest.approx(row[1], rel=1e-8)


def test_strips_below_a_roller_collect_the_jump_of_the_field_inside() -> None:
    plain = solver.solve(ROLLER | {"body": ACTIVE})
    half = float(plain["contact_trailing"] + plain["contact_leading"]) / 2
    nodes, weights = np.polynomial.legendre.leggauss(24)
    for depth, number in ((1e-4, 1), (2e-4, 2)):
        size, place = 2e-4, 5e-5
        along = (place + size / 2 * nodes) / half
        sides = [-(depth - 1e-13) / half, -(depth + 1e-13) / half]
        inside = solver.solve_interior(ROLLER | {"body": ACTIVE}, along, sides, fields=["electric_displacement_y"])
        above, below = inside["electric_displacement_y"].values
        read = {"collector": number, "patch_size": size, "patch_position": place}
        solution = solver.solve(ROLLER | {"body": ACTIVE} | read)
        expected = weights @ (above - below) * size / 2 / 2e4
        assert float(solution["patch_charge_per_force"]) == pytest.approx(expected, rel=1e-7)
        middle = solver.solve_interior(ROLLER | {"body": ACTIVE}, [0.0], sides[:1], fields=["stress_yy"])
        assert float(solution["electrode_pressure"]) == pytest.approx(-float(middle["stress_yy"].squeeze()), rel=1e-7)


def test_discs_below_a_ball_that_slides_collect_the_jump_of_the_field_inside() -> None:
    """D_y of the plane of symmetry at x and -x, whose mean is even about the middle and whose difference turns."""
    ball = {"profile": "sphere", "radius": 2e-3, "force": 4.0, "friction": 0.4, "magnetic": "insulating"}
    plain, number, size, place = solver.solve(ball | {"body": ACTIVE}), 2, 1.2e-4, 7e-5
    radius = float(plain["contact_radius"])
    x, w = np.polynomial.legendre.leggauss(16)
    turn = 2 * np.pi * (np.arange(32) + 0.5) / 32
    ring = size / 4 * (1 + x)
    across = np.hypot(place + ring[:, None] * np.cos(turn), ring[:, None] * np.sin(turn))
    cosine = (place + ring[:, None] * np.cos(turn)) / across
    ends = np.linspace(place - size / 2, place + size / 2, 2)
    r = (ends[1] + ends[0]) / 2 + (ends[1] - ends[0]) / 2 * np.cos(np.pi * (np.arange(14) + 0.5) / 14)
    along = np.concatenate([-r[::-1], r[::-1]])
    sides = [-(number * 1e-4 - 1e-13) / radius, -(number * 1e-4 + 1e-13) / radius]
    inside = solver.solve_interior(
        ball | {"body": ACTIVE}, np.sort(along) / radius, sides, fields=["electric_displacement_y"]
    )
    above, below = inside["electric_displacement_y"].values
    behind, ahead = np.split(above - below, 2)
    even, odd = (ahead + behind[::-1]) / 2, (ahead - behind[::-1]) / 2
    radii = np.sort(r)
    density = sum(BarycentricInterpolator(radii, part)(across) * share for part, share in ((even, 1.0), (odd, cosine)))
    expected = np.sum(w[:, None] * ring[:, None] * density) * size / 4 * 2 * np.pi / 32 / 4.0
    read = {"collector": number, "patch_size": size, "patch_position": [place, -place]}
    charges = charge(solver.solve(ball | {"body": ACTIVE} | read), "patch_charge_per_force")
    assert abs(charges[0] / charges[1] - 1) > 1e-3
    assert charges[0] == pytest.approx(expected, rel=1e-6)


def test_a_metal_on_top_is_the_electrode_that_is_asked_for_there() -> None:
    body = Stack([Layer(COPPER, 1e-5), Layer(PZT, 1e-4)], SILICON)
    assert electrodes(Stack(body.layers, SILICON, electroded=True)) == electrodes(body) == [(0,), (1,)]
    assert not Electrode(body, 1).on_top
    read = BALL | {"force": 0.1, "collector": 1, "patch_size": 1e-3, "body": body}
    assert patch_charge(read | {"electrode": "top"}) == pytest.approx(patch_charge(read), rel=1e-9)


def test_what_a_base_stretches_leads_on_to_the_free_slab_s_d33() -> None:
    """The charge goes straight with the stretch along the film, k_1 of its base: on to that of a slab nothing holds.

    A half-space widens by -1/(c11 + c12) per pressure (isotropic), a rigid one by nothing, the free slab by -2 s13.
    """
    # of stresses along and across by strains along, both alike, and across
    compliance = np.linalg.inv([[PZT.c11 + PZT.c12, PZT.c13], [2 * PZT.c13, PZT.c33]])
    along, across = compliance @ [0.0, 1.0]
    free = float(2 * PZT.e31 * along + PZT.e33 * across)
    assert free == pytest.approx(291e-12, rel=2e-3)  # of the printed set
    stiff = [Stack([Layer(PZT, 1e-4)], base, electroded=True) for base in ("rigid", GLASS, solver.find("polyimide"))]
    charges = [-float(Electrode(body, 2).whole[0]) * body.scale[1] / body.scale[2] for body in stiff]
    stretch = np.array([0.0, *(-1 / float(base.c11 + base.c12) for base in (GLASS, solver.find("polyimide")))])
    slopes = np.diff(charges) / np.diff(stretch)
    assert slopes[1] == pytest.approx(slopes[0], rel=1e-9)
    reached = charges[0] + slopes[0] * float(-2 * along)
    assert abs(reached) == pytest.approx(free, rel=1e-9)


@pytest.mark.parametrize("punch", [BALL, ROLLER], ids=["ball", "roller"])
def test_a_volt_moves_aluminium_nitride_on_silicon_as_little_as_a_newton_charges_it(punch: dict[str, Any]) -> None:
    """e33/c33 less what the film's pull along itself, e31 - e33 c13/c33, does to a half-space: 1/(c11 + c12) of it."""
    film, case = solver.find("AlN"), {"material": "AlN", "thickness": 1e-4, "base": "silicon", "electrode": "top"}
    read = solver.solve(punch | case | {"collector": 1, "magnetic": "insulating"})
    pull = float(film.e31 - film.e33 * film.c13 / film.c33)
    exact = float(film.e33 / film.c33) + pull / float(SILICON.c11 + SILICON.c12)
    for name in ("electrode_stroke_per_volt", "electrode_charge_per_force"):
        assert float(read[name]) == pytest.approx(exact, rel=1e-10)
    assert 1e12 * exact == pytest.approx(-0.26, abs=0.005)


PRESSED_BALL = BARE | {"profile": "sphere", "radius": 0.01, "force": 0.1}
LINE = BARE | {"radius": 0.05, "load": 1e4}


@pytest.mark.parametrize("punch", [PRESSED_BALL, LINE], ids=["ball", "roller"])
def test_a_nanometre_of_steel_is_a_grounded_interface(punch: dict[str, Any]) -> None:
    """The share of its stiffness falls with its thickness."""
    grounded = solver.solve(punch | {"body": Stack([Layer(PZT, 2e-4, "grounded")], SILICON)})
    for thickness, off in ((1e-7, 5e-6), (1e-9, 5e-8)):
        coated = solver.solve(punch | {"body": Stack([Layer(PZT, 2e-4), Layer(STEEL, thickness)], SILICON)})
        assert_alike(coated, grounded, 20 * off, ("charge_per_force", "voltage", "peak_pressure", "stroke_per_volt"))


def test_no_field_is_inside_a_metal() -> None:
    stack = Stack([Layer(PZT, 1e-4), Layer(solver.find("copper"), 1e-4)], STEEL)
    inside = solver.solve_interior(LINE | {"body": stack}, [0.3], [-0.1, -2.0, -4.0])
    half = float(solver.solve(LINE | {"body": stack})["contact_trailing"])
    assert 0.1 * half < 1e-4 < 2.0 * half < 2e-4 < 4.0 * half
    field = np.abs(inside["electric_field_y"].values).ravel()
    assert field[0] > 1e3
    np.testing.assert_allclose(field[1:], 0, atol=1e-9 * field[0])


def test_flux_passes_through_a_metal_by_its_permeability() -> None:
    """Steel of a hundred times vacuum's lets pass what air would not; of one, it is what it was."""
    as_air = solver.Material(**{**vars(STEEL), "mu11": np.array(4e-7 * np.pi), "mu33": np.array(4e-7 * np.pi)})
    bodies = (Stack([Layer(FIBROUS, 2e-4)], base) for base in (STEEL, as_air, solver.Material.isotropic(200e9, 0.3)))
    case = LINE | {"magnetic": "conducting", "datum": 0.1}
    steel, air, dielectric = (abs(float(solver.solve(case | {"body": body})["flux_per_force"])) for body in bodies)
    assert air == pytest.approx(dielectric, rel=0.05)
    assert steel / air > 10


def test_a_metal_on_top_has_the_potential_itself() -> None:
    """A conducting punch on the metal acts as an insulating one: it presses, and nothing more."""
    stack = Stack([Layer(solver.find("aluminium"), 1e-6), Layer(PZT, 2e-5)], SILICON)
    kinds = ("conducting", "insulating")
    pair = [solver.solve(PRESSED_BALL | {"body": stack, "electric": kind}) for kind in kinds]
    assert "voltage" not in pair[0]
    np.testing.assert_array_equal(pair[0]["contact_radius"], pair[1]["contact_radius"])
    for case in (PRESSED_BALL | {"total_charge": 1e-12}, LINE | {"charge": 1e-9}):
        with pytest.raises(solver.FactorError, match="charge: 1e-"):
            solver.solve(case | {"body": stack})


FILM = BARE | {"thickness": 0.7e-3, "radius": 0.05}
#: A bonded active base, whose far field carries load and charge alike.
ACTIVE_BASE = FILM | {"material": "BaTiO3", "base": "PZT-5H", "interface_electric": "bonded"}
MAGNETIC = FILM | {"composite": "fibrous", "volume_fraction": 0.6, "base": "CoFe2O4", "interface_magnetic": "bonded"}


@pytest.mark.parametrize(
    ("body", "load", "charge", "potential", "store", "size"),
    [
        (ACTIVE_BASE | {"friction": 0.3}, 3e6, "charge", "voltage", "capacitance_per_length", 1e-6),
        (MAGNETIC, 1e5, "magnetic_charge", "magnetic_potential", "permeance_per_length", 1e-7),
    ],
    ids=["electric, friction", "magnetic"],
)
def test_stores_are_those_between_two_states_of_one_width(
    body: dict[str, float], load: float, charge: str, potential: str, store: str, size: float
) -> None:
    """The potential is affine in the charge at one width: a secant is the tangent but for rounding.

    That is 1e-8, as the secant is of potentials that are a thousand times larger than what they differ by.
    """

    def width(load: float, charged: float) -> float:
        computed = solver.solve({**body, "load": load, charge: charged})
        return float(computed["contact_trailing"] + computed["contact_leading"])

    required = width(load, 0.0)
    other = brentq(lambda load: width(load, size) / required - 1, 0.9 * load, 1.1 * load, xtol=1e-9 * load, rtol=1e-13)
    first = solver.solve({**body, "load": load})
    two = solver.solve({**body, "load": other, charge: size})
    secant = size / float(two[potential] - first[potential])
    assert float(first[store]) == pytest.approx(secant, rel=1e-7, abs=0)


@pytest.mark.parametrize(("thin", "load"), [(10e-6, 1e4), (50e-6, 1e3)])
def test_permeance_above_an_insulated_base_is_that_of_a_strip(thin: float, load: float) -> None:
    """One permeability throughout: (J / pi mu) log|2 sinh(pi x / 2H)|, and Chebyshev's terms, are the potential.

    Far away it is a straight line that is 0 at |x| = 0, the solver's is 0 at 2H/pi. Layers a thousand times less
    dielectric lie below: what long waves lose was 9e-4.
    """
    body = Stack((Layer(solver.find("PZT-5H"), thin), Layer(solver.find("polyimide"), 0.2e-3, magnetic="insulated")))
    computed = solver.solve({"surroundings": "insulated", "body": body, "radius": 0.05, "load": load})
    thickness, mu = body.thickness, float(solver.find("PZT-5H").mu11)
    n, count, half = np.arange(60), 60, float(computed["contact_trailing"])
    angle = np.pi * (n + 0.5) / count
    phase = np.pi * half / (2 * thickness) * (np.cos(angle)[:, None] - np.cos(angle))
    np.fill_diagonal(phase, 1e-9)  # the smooth part is 0 there
    terms = np.cos(angle[:, None] * n)
    logs = -np.pi / np.maximum(n, 1) * terms
    logs[:, 0] = np.pi * np.log(np.pi * half / (2 * thickness))
    smooth = np.log(np.sinh(phase) / phase) @ terms * np.pi / count
    charge = np.pi * np.linalg.solve(logs + smooth, np.ones(count))[0]
    assert float(computed["permeance_per_length"]) == pytest.approx(-np.pi * mu * charge / (1 - charge), rel=1e-6)


#: Roots with a large real part put singularities beside the first panels.
STEEP = ["PMN-PT 67:33", "PMN-PT 67:33 (alternative 1)"]


def of(material: solver.Material, base: str, ratio: float) -> Kernel:
    """Kernel of a film of unit thickness, for contacts of a half-length over it."""
    stack = Stack((Layer(material, 1.0, "grounded"),), RIGID if base == "rigid" else solver.find(base))
    return kernel(stack, 2.1 * ratio)


@pytest.mark.sampled(10)
@pytest.mark.parametrize(
    ("name", "base"), [*product(STEEP, ["rigid", "steel"]), *zip(AXIAL, cycle(["rigid", "steel"]))]
)
def test_no_built_in_material_is_refused(name: str, base: str) -> None:
    for ratio in (1e-3, 1.0, 30.0):
        table = of(solver.find(name), base, ratio)
        size = np.max(np.abs(table.positive.series[..., :10]))
        assert np.max(np.abs(table.positive.series[:, -2:])) < 1e-11 * size


def test_no_composition_is_refused() -> None:
    assert of(solver.aluminium_scandium_nitride(0.5), "steel", 30.0).reach > 60


def test_values_are_the_integrals() -> None:
    """Adaptive quadrature of the whole integrals; 1e-10 of the largest: its own tolerance is 1e-12."""
    table, x = of(solver.find(STEEP[0]), "steel", 1.0), 0.9
    size = np.max(np.abs(table.positive.series[..., :10]))

    def density(k: float) -> Array:
        difference = waves(table.stack, np.array([k]))[0].difference[0]
        return np.array([difference[i, j] * (np.sin(k * x) if j or not i else np.cos(k * x)) for i, j in ENTRIES])

    whole = quad_vec(density, 1e-12, 40 / table.width, epsabs=1e-12 * size, norm="max")[0]
    np.testing.assert_allclose(table.at(np.array([x]))[0, :10], -whole / np.pi, rtol=0, atol=1e-10 * size)


@pytest.mark.filterwarnings("ignore::solver.line.table.SlowWarning")
@pytest.mark.sampled(1)
@pytest.mark.parametrize("most", [3.0, 30.0])
def test_default_tables_are_read_to_1e_8(most: float) -> None:
    """Between the half-lengths of the table, against the system itself; load to 1e-9, the others over their range."""
    tabled = table(Stack((Layer(FIBROUS, 1.0),)), 0.3, most=most)
    half = np.exp(np.linspace(np.log(0.0102), np.log(0.98 * most), 7))
    read = tabled.interval.read(np.log(half), tabled.series)
    exact = at(tabled.system, half)
    size = np.max(np.abs(exact), axis=0)
    assert np.all(np.abs(read - exact)[:, : outputs.EDGE_STRESS.start] <= 3e-8 * size[: outputs.EDGE_STRESS.start])
    assert np.max(np.abs(read[:, 0, 0] / exact[:, 0, 0] - 1)) < 1e-9


@pytest.mark.parametrize(("material", "half"), [("PMN-PT 67:33", 9.0), ("PMN-PT 67:33", 30.0), ("LiNbO3", 30.0)])
def test_tractions_of_wide_contacts_are_those_of_many_more_terms(material: str, half: float) -> None:
    """D_y and the pressure at 1e-8 of the largest, whatever the roots of the film's material."""
    tabled = table(Stack((Layer(solver.find(material), 1.0),), STEEL), 0.2, least=half / 2, most=half, accuracy=1.25)
    X: Array = np.array([-0.97, -0.6, 0.0, 0.3, 0.8, 0.99])
    tractions = []
    for system in (tabled.system, replace(tabled.system, accuracy=2 * tabled.system.accuracy)):
        assembly = Assembly(system, system.basis(half), np.array([half]), X)
        tractions.append(np.einsum("hfpu,huc->fpc", local_fields(assembly)[:, :2], assembly.unknowns)[..., 0])
    few, many = tractions
    np.testing.assert_array_less(np.max(np.abs(few - many), 1), 1.5e-8 * np.max(np.abs(many), 1))


def test_tables_that_take_long_say_so_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("solver.line.table._LONG", 0.0)
    monkeypatch.setattr("solver.line.table.at", lambda *_: np.zeros(()))
    with pytest.warns(SlowWarning, match=r"a table of half-lengths from 1 to 2 thicknesses of this film takes about"):
        _ = table(Stack((Layer(BTO, 1.0),)), least=1.0, most=2.0, nodes=4).at_nodes


K = np.geomspace(0.01, 10.0, 25)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.49])
def test_isotropic_layer_on_a_rigid_base_is_the_closed_multiplier(poisson: float) -> None:
    stack = Stack((Layer(solver.Material.isotropic(7e10, poisson), 1.0),))
    compliance = stack.media[0].compliance[1, 1]
    computed = 1 + waves(stack, K)[0].difference[:, 1, 1] / compliance
    kappa, u = 3 - 4 * poisson, K
    exact = (2 * kappa * np.sinh(2 * u) - 4 * u) / (2 * kappa * np.cosh(2 * u) + 1 + kappa**2 + 4 * u**2)
    np.testing.assert_allclose(computed, exact, rtol=1e-11)


def test_stacks_are_equal_by_their_content() -> None:
    film = Stack([Layer("PZT-4", "20 um", "grounded")], "steel")
    stated = Stack([Layer(solver.find("PZT-4"), 20e-6, "grounded")], STEEL)
    assert (film, film.name) == (stated, stated.name)
    others = [
        Stack([Layer("PZT-4", "21 um", "grounded")], "steel"),
        Stack([Layer("PZT-4", "20 um", "bonded")], "steel"),
        Stack([Layer("PZT-4", "20 um", "grounded")]),
    ]
    assert len({film, *others}) == 1 + len(others)


ON_STEEL = Stack((Layer(FIBROUS, 2e-4, magnetic="grounded"),), "steel")
BONDED = Stack((Layer(FIBROUS, 2e-4, "bonded", "bonded"),), CFO)
BETWEEN = Stack((Layer(BTO, 1e-4, "grounded"), Layer(FIBROUS, 1e-4), Layer(CFO, 1e-4)), CFO)


@pytest.mark.parametrize("stack", [ON_STEEL, BONDED, BETWEEN], ids=["grounded", "bonded", "electrode between"])
def test_potentials_are_the_punch_s_on_it_meet_at_interfaces_and_have_the_fields_as_gradients(stack: Stack) -> None:
    case = {"body": stack, "radius": 0.05, "friction": 0.3, "load": 1e5, "surroundings": "insulated"}
    case |= {"charge": 2e-5, "magnetic_charge": 1e-2, "datum": 0.01}
    punch, potentials = solver.solve(case), ["electric_potential", "magnetic_potential"]
    h, X, step = float(punch["contact_trailing"] + punch["contact_leading"]) / 2, np.array([-0.9, 0.0, 0.5]), 1e-3

    def fields(x: Array, y: Array, names: list[str]) -> Array:
        """Fields inside, (name, y, x)."""
        inside = solver.solve_interior(case, x, y, fields=names)
        return np.stack([inside[name].values.squeeze() for name in names])

    within = fields(X, np.array([0.0, -0.1 * stack.thickness / h]), potentials)
    for potential, strength in zip(within, (punch["voltage"], punch["magnetic_potential"]), strict=True):
        np.testing.assert_allclose(potential[0], float(strength), rtol=1e-9)
    size = np.max(np.abs(within), axis=(1, 2))
    ends = np.cumsum([layer.thickness for layer in stack.layers]) / h
    for end in ends:
        above, below = np.moveaxis(fields(X, -end * np.array([1.0, 1 + 1e-9]), potentials), 1, 0)
        assert np.all(np.max(np.abs(above - below), axis=1) < 1e-8 * size)
    stencil, offsets = np.array([1, -8, 0, 8, -1]) / (12 * step), np.linspace(-2 * step, 2 * step, 5)
    for y in (-0.4 * ends[0], -(ends[-1] + 0.4)):
        around = fields(0.4 + offsets, y + offsets, potentials) / h
        for k, kind in enumerate(("electric", "magnetic")):
            field = fields(np.array([0.4]), np.array([y]), [f"{kind}_field_x", f"{kind}_field_y"])
            gradient = np.array([around[k, 2] @ stencil, around[k, :, 2] @ stencil])
            np.testing.assert_allclose(gradient, -field, atol=1e-7 * size[k] / h)


THIN = BARE | {"thickness": 2e-4, "radius": 0.05}


def test_of_two_hills_of_the_pressure_the_higher_is_given() -> None:
    case = THIN | {"material": "PZT-5H", "base": "polyimide", "friction": 0.1, "load": 2.495e5}
    assert float(solver.solve(case)["peak_pressure"]) == pytest.approx(69.682e6, abs=5e2)


def test_a_sweep_of_the_load_has_no_steps_where_tables_change() -> None:
    """Loads about the change of tables at a half-length of one thickness: third differences are steps."""
    case = THIN | {"material": "BaTiO3", "base": "steel", "thickness": 1e-4, "friction": 0.2}
    coarse = np.geomspace(1e2, 1e5, 50)
    trial = solver.solve(case | {"load": coarse})
    half = ((trial["contact_trailing"] + trial["contact_leading"]) / 2).values.ravel()
    load = np.interp(0.0, np.log(half / 1e-4), np.log(coarse))
    swept = solver.solve(case | {"load": np.exp(load + 0.001 * np.linspace(-1, 1, 50))}, peaks=True)
    half = ((swept["contact_trailing"] + swept["contact_leading"]) / 2).values.ravel()
    assert half[0] < 1e-4 < half[-1]
    for name in ("peak_pressure", *FILM_PEAKS):
        if not name.endswith("position"):
            values = swept[name].values.ravel()
            assert np.max(np.abs(np.diff(values, 3))) <= 1e-8 * np.max(values), name


@pytest.mark.parametrize(
    ("case", "largest"),
    [
        ({"load": 1e6}, 6.22e6),  # 5.3 half-lengths from the middle: the base bends with the width of the contact
        ({"load": 1e4, "friction": 0.01, "base": "steel"}, None),  # 220 half-lengths from the middle
    ],
)
def test_the_base_is_searched_as_far_as_its_tension_rises(case: dict[str, Any], largest: float | None) -> None:
    factors = {"material": "BaTiO3", "thickness": 1e-4, "base": "aluminium oxide", "radius": 0.05, "friction": 0.05}
    factors |= {"surroundings": "insulated", "magnetic": "insulating"} | case
    answer = solver.solve(factors, peaks=["base_peak_principal_tension"])
    half = float(answer["contact_trailing"] + answer["contact_leading"]) / 2
    far = 1 + np.geomspace(0.01, 400.0, 120)
    x: Array = np.concatenate([-far[::-1], np.linspace(-0.99, 0.99, 21), far])
    x = x[np.abs(x) * half < 500e-4]  # fields inside end some hundred thicknesses away
    top = 1e-4 / half
    depths = np.geomspace(top * (1 + 1e-9), 2 + 2 * top, 8)
    inside = solver.solve_interior(factors, x, -depths, fields=["principal_tension"])
    tension = inside["principal_tension"].values.squeeze()
    computed = float(answer["base_peak_principal_tension"])
    assert np.max(tension) * (1 - 1e-6) <= computed <= np.max(tension) * 1.03
    if largest is not None:
        assert computed == pytest.approx(largest, rel=1e-3)
