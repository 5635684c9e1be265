"""Refusals by name, in one line with value and what is allowed, for every kind of body, punch, film and electrode."""

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr

import solver
from solver.body import airless
from solver.halfplane.pressing import ContactError
from solver.stack.layers import Layer, Stack
from tests.refusals import assert_refused
from tests.solver.cases import BTO, CFO, FIBROUS, refused, without

GLASS = solver.find("glass")
Case = dict[str, Any]
BARE: Case = {"surroundings": "insulated"}
AIR: Case = {"surroundings": "air"}
LINE: Case = {"material": "BaTiO3", "radius": 0.05, "load": 1e5}
PRESSED = without(LINE, "radius")
FILM = LINE | BARE | {"thickness": 0.5e-3, "base": "rigid"}
MIX: Case = BARE | {"volume_fraction": 0.5, "thickness": 0.2e-3, "radius": 0.05, "friction": 0.3, "load": 1e5}
GRADED = MIX | {"volume_fraction": 0.2, "base": "steel", "base_volume_fraction": 0.5}
BALL: Case = {"material": "BaTiO3", "profile": "sphere", "radius": 5e-3, "force": 10.0}
ON_FILM = BALL | BARE | {"thickness": 1e-4, "base": "rigid"}
STACK = Stack([Layer(BTO, 1e-4)])
ON_STACK = LINE | BARE | {"body": STACK, "material": None}
READ: Case = {"body": Stack([Layer(GLASS, 1e-4, "grounded"), Layer(BTO, 1e-4)]), "collector": 1, "material": None}
PATCH = BALL | BARE | READ | {"patch_size": 1e-3}
SCANDIUM: Case = {"composite": "AlScN", "radius": 0.05, "load": 1e4}
STEEL: Case = {"punch_modulus": 210e9, "punch_poisson": 0.3}


def own(*slope: float) -> Case:
    return PRESSED | {"profile": solver.Profile.polynomial(slope, (True, True))}


#: By the beginning of the message.
REFUSED: dict[str, Case] = {
    # profiles of the half-plane
    "width: missing": PRESSED | {"profile": "flat"},
    "slope: missing": PRESSED | {"profile": "wedge"},
    "radius: the profile flat has none": LINE | {"profile": "flat", "width": 1e-3},
    "corner: the profile cylinder has none": LINE | {"corner": "leading"},
    "moment: give either": PRESSED | {"profile": "flat", "width": 1e-3, "slope": 0.0, "moment": 1.0},
    "contact: it would need tension": PRESSED | {"profile": "flat", "width": 4e-4, "slope": 0.01},
    "slope: the punch does not widen upwards": own(0.0, -1.0),
    "slope: an even power": own(0.0, 0.0, 1.0),
    # films
    "thickness: 0 is not a finite number > 0 [m]": FILM | {"thickness": 0.0},
    "base: 'stele' is unknown; did you mean 'steel'": FILM | {"base": "stele"},
    "base: '7.0' is no material; must be 'rigid' or": FILM | {"base": 7.0},
    "base: missing; must be 'rigid' or": without(FILM, "base"),
    "interface_electric: 'bonded' without a thickness": LINE | {"interface_electric": "bonded"},
    "base_modulus: 1e+11 beside a base": FILM | {"base_modulus": 1e11, "base_poisson": 0.3},
    "base_poisson: missing; must be": FILM | {"base": "", "base_modulus": 1e11},
    "interface_electric: 'bonded' is not allowed": FILM | {"interface_electric": "bonded"},
    "interface_magnetic: 'insulated' is allowed": FILM | {"base": "steel", "interface_magnetic": "insulated"},
    "interface_magnetic: 'open' is not one of grounded": FILM | {"interface_magnetic": "open"},
    "contact: wider than the resolved range": FILM | {"load": 1e12},
    "contact: narrower than the resolved range": FILM | {"load": 1e-6},
    "contact: it would need tension between punch and surface": MIX | {
        "base": "rigid", "radius": 50.0, "load": 1e3, "charge": 1e-5
    },
    # graded films and stacks
    "contact: radius over thickness 1": ON_FILM | {"base": "steel", "thickness": 4e-6},
    "base_volume_fraction: 1.2 is not a finite number": GRADED | {"base_volume_fraction": 1.2},
    "grading_exponent: 0.5 is": GRADED | {"grading_exponent": 0.5},
    "grading_exponent: 2 without a base_volume_fraction": MIX | {"base": "steel", "grading_exponent": 2.0},
    "base_volume_fraction: 0.5 without a thickness": without(GRADED, "thickness", "base"),
    "base_volume_fraction: 0.5 grades a film below a contact in space": without(
        GRADED, "radius", "load", "surroundings"
    ) | {"profile": "ellipsoid", "radius_x": 0.01, "radius_y": 0.02, "force": 1.0},
    "base_volume_fraction: 0.5 without a volume_fraction": FILM | {"base_volume_fraction": 0.5},
    "body: 'steel' is no solver.Stack": ON_STACK | {"body": "steel"},
    "material: beside a body": ON_STACK | {"material": "BaTiO3"},
    # speeds
    "speed: 1 m/s of what is no half-plane without air": FILM | {"speed": 1.0},
    # what is beside the contact
    "surroundings: 'water' is not one of insulated, air": LINE | {"surroundings": "water"},
    "surroundings: 'air' is not allowed: the punch conducts no field": LINE | AIR | {
        "electric": "insulating", "magnetic": "insulating"
    },
    "surroundings: 'air' is not allowed: no narrow gap with an end": PRESSED | AIR | {"profile": "flat", "width": 1e-3},
    "gap_permittivity: 0 is not a finite number > 0 and <= 1e+06 [1]": LINE | AIR | {"gap_permittivity": 0.0},
    "gap_permittivity: 2.2 without surroundings: air; only its gap has one": LINE | {"gap_permittivity": 2.2},
    "surroundings: the punch touches the surface beside the contact, at (x - c)/h = ": LINE | {
        "material": "PMN-PT 67:33", "thickness": 5.8e-5, "base": "steel", "load": 1e3, "friction": 0.3,
        "charge": 1.8e-4, "magnetic": "insulating",
    },
    "speed: 3000 m/s is not below the limiting speed 2903.13 m/s": LINE | {"material": "steel", "speed": [0.0, 3e3]},
    "speed: needs the density rho": LINE | {"material": solver.Material.isotropic(2e11, 0.3), "speed": 1.0},
    "surroundings: 'air' is not allowed: the punch conducts no fiel": BALL | AIR | {
        "electric": "insulating", "magnetic": "insulating"
    },
    "surroundings: 'air' is not allowed: no narrow gap with an en": without(BALL, "radius") | AIR | {
        "profile": "disc", "width": 1e-3
    },
    "gap_radius: missing; must be a finite number > 0 [m]: a cone or a power beside air says nowhere":
        without(BALL, "radius") | AIR | {"profile": "cone", "slope": 0.1},
    "gap_radius: 0.1 beside a contact along a line; only a point's gap has one": LINE | AIR | {"gap_radius": 0.1},
    # points
    "load: the profile sphere has none; give force [N]": BALL | {"load": 1e4},
    "charge: the profile sphere has none; give total_charge [C]": BALL | {"charge": 1e-9},
    "speed: the profile sphere has none; only contacts along a line have it": BALL | {"speed": 1.0},
    "force: 9.99989e-321 is too small for a number of full precision, 2.23e-308": BALL | {"force": 1e-320},
    "contact: wider than the resolved range, 0": ON_FILM | {"force": 1e12, "thickness": 1e-6},
    "total_flux: 1 on a punch that is magnetic insulating": BALL | {"total_flux": 1.0, "magnetic": "insulating"},
    "force: the profile cylinder has none; give load [N m-1], or a profile such as sphere": BALL
    | {"profile": "cylinder"},
    "slope: 1e+09 is 90 degrees from the surface; must be <= 1, 45 degrees": without(BALL, "radius") | {
        "profile": "cone", "slope": 1e9
    },
    # electrodes
    "collector: 3 is not one of the 2 electrodes of": BALL | BARE | READ | {"collector": 3},
    "patch_size: of the electrode on top; must be absent": PATCH | {"electrode": "top", "electric": "insulating"},
    "patch_pitch: 0.0009 is not more than patch_size: a patch would touch its neighbour": PATCH | {"patch_pitch": 9e-4},
    "patch_size: 1e+04 thicknesses of the top layer; the patch reaches farther ": PATCH | {"patch_size": 1.0},
    "collector: missing; patch_size needs it": ON_FILM | {"patch_size": 1e-3},
    "collector: 1 without a film": BALL | {"collector": 1},
    "touch_temperature: 303 without a film; heat needs its thickness": BALL | {"touch_temperature": 303.0, "hold": 1.0},
    "patch: 'disc' below a contact along": LINE | BARE | READ | {"patch_size": 1e-3, "patch": "disc"},
    "patch: 'ring' is not one of disc, strip": PATCH | {"patch": "ring"},
    "total_charge: 1e-09 of a punch on an electrode": ON_FILM | {"electrode": "top", "total_charge": 1e-9},
    "electrode: 'top' without a film in insulated surroundings": FILM | AIR | {"electrode": "top"},
    # composites
    "scandium_fraction: missing; must be a finite number >= 0 and <= 0.5 [1] (composite": SCANDIUM,
    "scandium_fraction: the composite fibrous has none; AlScN has it": without(SCANDIUM, "composite") | {
        "scandium_fraction": 0.2
    },
    "scandium_fraction: 0.6 is not a finite number >= 0 and <=": SCANDIUM | {"scandium_fraction": 0.6},
    "material: give either a material or a composite's scandium_": LINE | {"scandium_fraction": 0.2},
    # units
    "radius: '5 kg': unit mismatch: 'kg' does not measure what 'm' measures": BALL | {"radius": "5 kg"},
    "radius: 'five' is not a finite number > 0 [m], bare or with its unit": BALL | {"radius": "five"},
    # punches
    "punch: 'stel' is unknown; did you mean 'steel'? known are rigid, steel, stainless": LINE | {"punch": "stel"},
    "punch: '3.0' is no punch; must be 'rigid' or a material's name": BALL | {"punch": 3.0},
    "punch_modulus: 2.1e+11 beside a punch; give either": MIX | STEEL | {"base": "steel", "punch": "steel"},
    "punch_poisson: missing; must be a finite number > -1 and < 0.5 [1]": LINE | {"punch_modulus": 210e9},
    "punch_modulus: 0 is not a finite number > 0 [Pa]": BALL | STEEL | {"punch_modulus": 0.0},
    "punch_poisson: 0.5 is not a finite number > -1 and < 0.5 [1]": LINE | STEEL | {"punch_poisson": 0.5},
}  # fmt: skip


@pytest.mark.parametrize("message", REFUSED)
def test_it_is_refused(message: str) -> None:
    case = without(REFUSED[message])
    refused(case, message, peaks=message.startswith("contact: radius over thickness"))
    if message.startswith(("surroundings: 'air'", "gap_radius: missing")):
        assert airless(case)  # the rule by which studies fall back on insulated surroundings


MIXED: Case = {"volume_fraction": 0.5, "radius": 0.05, "load": 1e5}
OPTIONAL = ("friction", "charge", "magnetic_charge", "datum")
POSITIONS = (-2.0, 0.3, 1.5)
CHOSEN = ("composite", "profile", "electric", "magnetic")
TWO, THREE = xr.DataArray([1e4, 1e5], dims="case"), xr.DataArray([0.1, 0.2, 0.3], dims="case")

#: Beginning of the message, further words of it, and the case.
SINGLE: list[tuple[str, str, Case]] = [
    # names
    ("xyz: unknown factor", "known are", LINE | {"xyz": 0.3}),
    ("load: '2e4' is a text without a unit", "its unit [N m-1]", LINE | {"load": ["10 kN/m", "2e4"]}),
    ("material: ", "None", LINE | {"material": None}),
    *((f"{name}: '{word}' is not one of", "", MIXED | {name: word}) for name in CHOSEN for word in ("fibros", "")),
    *((f"{name}: ", "3", MIXED | {name: 3}) for name in CHOSEN),
    ("profile: ", "3", LINE | {"profile": np.array(["cylinder", 3], dtype=object)}),
    # what must be given, what may not be together
    ("material: missing", "volume_fraction", {"radius": 0.05, "load": 1e5}),
    ("volume_fraction", "", {"radius": 0.05, "load": 1e5, "composite": "laminate"}),
    ("factors: ", "case", LINE | {"load": TWO, "radius": THREE}),
    ("factors: ", "case", LINE | {"load": TWO.assign_coords(case=[0, 1]), "radius": TWO.assign_coords(case=[0, 2])}),
    ("", "position", LINE | {"load": xr.DataArray([1e4, 1e5, 1e6], dims="position")}),
    ("", "load", LINE | {"radius": xr.DataArray([0.1, 0.2], dims="load")}),
    *(("volume_fraction: ", "0 and <= 1", MIXED | {"volume_fraction": value}) for value in (-0.01, 1.01)),
    *((f"{name}: -inf is not", "finite", LINE | {name: -np.inf}) for name in OPTIONAL),
    *((f"{name}: ", "is not", LINE | {name: "half"}) for name in OPTIONAL),
    # the limits of floating point
    *(("", "", LINE | {name: 1e-320}) for name in ("radius", "load", "datum")),
    *(("", "", LINE | {name: 1e300}) for name in ("friction", "charge", "magnetic_charge")),
]


@pytest.mark.parametrize(("message", "words", "factors"), SINGLE)
def test_it_is_refused_with_these_words(message: str, words: str, factors: Case) -> None:
    refused(factors, message, words, positions=POSITIONS)


def test_bad_phases_and_unknown_names_of_the_caller_s_materials_are_refused() -> None:
    table = xr.Dataset({"radius": ("case", [0.1]), "lode": ("case", [1.0])}).assign(material="steel")
    refused(table, "lode: unknown factor; did you mean 'load'")
    refused(MIXED, "", "'stel' is unknown", phases=("steel", "stel"))
    refused(
        LINE | {"material": "wod"}, "", "did you mean 'wood'", materials={"wood": solver.Material.isotropic(1e10, 0.3)}
    )
    for phases in (("BaTiO3",), ("BaTiO3", "steel", "PZT-4"), (), ("steel", 3)):
        refused(MIXED, "phases: ", phases=phases)


def test_a_wrong_value_is_quoted_by_its_beginning() -> None:
    """The mapping of all materials in place of one is 9 kB of text."""
    everything = solver.materials()
    for factors in ({"material": everything}, {"profile": everything}, {"load": everything}, {"width": [everything]}):
        with pytest.raises(solver.FactorError) as caught:
            solver.solve(LINE | factors)
        assert str(caught.value).startswith(f'{next(iter(factors))}: "{str(everything)[:20]}')
        assert len(str(caught.value)) < 200
    refused(LINE | {"material": everything}, "", "give the name of one, or a Material")


CYLINDER = LINE | BARE | {"material": None, "body": Stack((Layer(BTO, 0.5e-3, magnetic="insulated"),))}
WIDE = PRESSED | BARE | {"material": None, "body": Stack((Layer(FIBROUS, 2e-4),), "steel"), "profile": "flat"}
#: Words of the refusal, and the layer, stack or field that is refused with them.
STACKS: dict[str, Callable[[], object]] = {
    "thickness: 0.0 is not allowed": lambda: Layer(BTO, 0.0),
    "interface_electric: 'floating' is unknown; allowed are grounded, bonded": lambda: Layer(BTO, 1.0, "floating"),
    "layers: none": lambda: Stack(()),
    "base: material: 'soft' is unknown": lambda: Stack((Layer(BTO, 1.0),), "soft"),
    "material: 'coper' is unknown; did you mean 'copper'": lambda: Layer("coper", 1e-6),
    "thickness: '20 V': unit mismatch": lambda: Layer(BTO, "20 V"),
    "thickness: -2e-05 is not allowed": lambda: Layer(BTO, "-20 um"),
    "interface_magnetic: 'bonded' is not allowed": lambda: Stack((Layer(BTO, 1.0, magnetic="bonded"),)),
    "has case axes": lambda: Layer(solver.fibrous(BTO, CFO, [0.1, 0.2]), 1.0),
    "beyond the range": lambda: solver.solve(without(CYLINDER), [1e7]),
    "x: 1e+06 is farther from the contact than the fields inside this film":
        lambda: solver.solve_interior(without(CYLINDER), [1e6], [0.0], fields=["stress_xx"]),
    "magnetic_potential: is not given inside a film on a base that insulates":
        lambda: solver.solve_interior(without(CYLINDER), [0.0], [0.0], fields=["magnetic_potential"]),
    "contact: half-length over thickness 11.1 is too wide for peaks; must be < 10":
        lambda: solver.solve(without(WIDE) | {"width": 22.2 * 2e-4, "load": 1e4}, peaks=True),
}  # fmt: skip


@pytest.mark.parametrize("words", STACKS)
def test_stacks_and_fields_inside_them_are_refused(words: str) -> None:
    assert_refused((solver.MaterialError, ContactError, solver.FactorError), re.escape(words), STACKS[words])
