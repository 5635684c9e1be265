"""Constants of data sheets in every form; those that are malformed, inadmissible or of a lost unit are refused."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import solver
from solver import Material, MaterialError, find
from solver.material.datasheet import strain_charge, stress_matrices
from solver.material.usual import USUAL
from tests.refusals import assert_refused
from tests.solver.cases import BTO, CFO, without
from verification.cases import constants

TITANATE: dict[str, float] = {
    "c11": 166e9, "c12": 77e9, "c13": 78e9, "c33": 162e9, "c44": 43e9, "e31": -4.4, "e33": 18.6,
}  # fmt: skip
TITANATE |= {"e15": 11.6, "eps11": 11.2e-9, "eps33": 12.6e-9, "mu11": 5e-6, "mu33": 10e-6, "rho": 5800.0}
FERRITE: dict[str, float] = {"c11": 286e9, "c12": 173e9, "c13": 170.5e9, "c33": 269.5e9, "c44": 45.3e9, "f31": 580.3}
FERRITE |= {"f33": 699.7, "f15": 550.0, "eps11": 0.08e-9, "eps33": 0.093e-9, "mu11": 590e-6, "mu33": 157e-6}
CONTACT = {"radius": 0.05, "load": 1e5}


def material(entries: dict[str, float], name: str = "mine") -> solver.Material:
    """Built without the check of ``from_mapping``."""
    constants: dict[str, Any] = {key: np.array(value) for key, value in entries.items()}
    return solver.Material(**constants, name=name)


AS_PUBLISHED = material(FERRITE | {"mu11": -590e-6}, "CoFe2O4 as published")

MALFORMED: tuple[object, ...] = ("166e9", None, True, [166e9, 167e9], {}, 10**400)
#: Words of the refusal, and what is refused with them; the words are quoted as they stand.
REFUSED: list[tuple[str, Callable[[], object]]] = [
    *((f"{name}: {value} is not a finite number", lambda name=name, value=value: read({name: value}))
      for name, value in (("c11", np.nan), ("e31", np.inf), ("g33", np.nan))),
    *(("c11: ", lambda value=value: read({"c11": value})) for value in MALFORMED),
    ("g33: ", lambda: pressed({"g33": np.nan})),
    ("mine: e13: unknown entry; ", lambda: read({"e13": -4.4})),
    ("mine: conductor: 'yes' is not true or false", lambda: read({"conductor": "yes"})),
    ("mine: e33 = 18.6 C m-2: must be 0 in a conductor", lambda: read({"conductor": True, "e31": 0.0})),
    ("c33: missing", lambda: solver.Material.from_mapping(without(TITANATE, "c33"))),
    ("broken: c13", lambda: solver.solve({"material": ["steel", broken(), "PZT-4"], **CONTACT})),
    ("eps33: 830 F m-1 is of a size that no material has (1e-12 to 1e-05); did you mean 830 eps0 ",
     lambda: pressed({"eps33": 830})),
    ("did you mean 210 GPa", lambda: solver.Material.isotropic(210, 0.3)),
    ("arrays", lambda: solver.solve({"material": solver.fibrous(BTO, CFO, [0.2, 0.4]), **CONTACT})),
    *((f"volume_fraction: {value:g} is not", lambda mix=mix, value=value: mix(BTO, CFO, [0.5, value]))
      for mix, value in ((solver.fibrous, -0.1), (solver.laminate, np.nan))),
    *((f"scandium_fraction: {value:g} is not within 0 to 0.5",
       lambda value=value: solver.aluminium_scandium_nitride([0.2, value])) for value in (-0.01, 0.51)),
    ("mine: c12: missing", lambda: solver.fibrous(material(without(TITANATE, "c12")), CFO, 0.5)),
    ("CoFe2O4 as published: mu11 = -0.00059 N s2 C-2", lambda: solver.fibrous(BTO, AS_PUBLISHED, 0.999)),
    ("contacts in space alone", lambda: solver.fibrous(find("36Y LiNbO3"), CFO, 0.5)),
    ("use mu11 = +590e-6", lambda: solver.laminate(BTO, AS_PUBLISHED, 0.5)),
    *(("isotropic: ", lambda young=young, poisson=poisson: solver.Material.isotropic(young, poisson))
      for young, poisson in ((2e11, -1.0), (2e11, 0.5), (0.0, 0.3))),
]  # fmt: skip


def broken() -> solver.Material:
    return solver.Material(c11=np.array(1e9), c13=np.array(2e9), c33=np.array(1e9), c44=np.array(1e9), name="broken")


def read(change: dict[str, Any]) -> solver.Material:
    return solver.Material.from_mapping({"name": "mine", **TITANATE, **change})


def pressed(change: dict[str, float]) -> object:
    return solver.solve({"material": material(TITANATE | change), **CONTACT})


@pytest.mark.parametrize(("words", "attempt"), REFUSED)
def test_refused(words: str, attempt: Callable[[], object]) -> None:
    with pytest.raises((solver.MaterialError, solver.FactorError)) as caught:
        attempt()
    assert words in str(caught.value)


#: Entries of a material that are refused, and words of the refusal.
CHANGED: list[tuple[dict[str, Any], list[str]]] = [
    # inadmissible constants
    ({"c11": -166e9}, ["mine: c11 = -1.66e+11 Pa", "positive"]),
    ({"c33": 0.0}, ["mine: c33 = 0 Pa", "positive"]),
    ({"c13": 165e9}, ["mine: c13 = 1.65e+11 Pa", "c13^2 < c11 c33"]),
    ({"c13": 145e9}, ["mine: c13 = 1.45e+11 Pa", "2 c13^2 < (c11 + c12) c33"]),
    ({"c12": 170e9}, ["mine: c12 = 1.7e+11 Pa", "|c12| < c11"]),
    ({"mu11": -590e-6}, ["mine: mu11 = -0.00059 N s2 C-2", "positive", "mu11 = +590e-6", "wrong sign"]),
    ({"g11": 3e-7}, ["mine: g11 = 3e-07 N s V-1 C-1", "g11^2 < eps11 mu11"]),
    ({"g33": -4e-7}, ["mine: g33 = -4e-07 N s V-1 C-1", "g33^2 < eps33 mu33"]),
    # limits, constants for heat, alternatives
    ({"limits": 3}, ["limits: '3' is not a mapping of tensile_strength, "]),
    ({"limits": {"strength": {}}}, ["limits: 'strength': unknown entry; known are tensile_strength, "]),
    ({"limits": {"yield_strength": 3e7}}, ["limits: yield_strength: '30000000.0' is not a mapping of value, source"]),
    ({"thermal": {"conductivity": {"value": 0, "source": "x"}}}, ["thermal: conductivity: value: '0' is not a finite"]),
    ({"thermal": {"pyroelectric": {"value": -27, "source": "x"}}},
     ["thermal: pyroelectric: -27 C m-2 K-1 is of a size that no material has"]),
    ({"thermal": {"expansion": {"value": "3 ppm"}}}, ["thermal: expansion: value: '3 ppm': unit mismatch"]),
    ({"limits": {"coercive_field": {"value": -1, "source": "x"}}},
     ["limits: coercive_field: value: '-1' is not a finite number > 0 [V m-1]"]),
    ({"limits": {"yield_strength": {"value": 1e7}}}, ["limits: yield_strength: source: '' is not a text that says"]),
    ({"limits": {"yield_strength": {"value": 1e7, "unit": "Pa"}}}, ["limits: yield_strength: 'unit': unknown entry"]),
    ({"alternatives": {"c11": 1e9}}, ["alternatives: \"{'c11': 1000000000.0}\" is not a list of constants"]),
    ({"alternatives": [{"c11": 1.2e11}]}, ["alternatives: 1: source: '' is not a text that says where it comes"]),
    ({"alternatives": [{"e13": 1.0, "source": "x"}]}, ["alternatives: 1: 'e13': unknown entry; known are c11, "]),
    ({"alternatives": [{"c11": 1.3e11, "source": "x"}, {"c11": float("inf"), "source": "x"}]},
     ["alternatives: 2: c11: 'inf' is not a finite number [Pa]"]),
    ({"alternatives": [{"c33": 1e11, "source": "x"}, {"c12": 2e11, "source": "x"}]},
     ["(alternative 2): c12 = 2e+11 Pa: needs |c12| < c11"]),
    ({"alternatives": [{"c11": 1e11, "source": "x"}] * 21}, ["alternatives: 21 are more than 20"]),
    # constants as somebody wrote them, without their unit, and what the question proposes
    *(({name: value}, [f"mine: {name}: ", "did you mean", meant]) for name, value, meant in (
        ("eps33", 830, "830 eps0"), ("eps11", 5.62, "5.62 nF/m"), ("mu33", 1.0, "1 mu0"), ("mu11", 590, "590 mu0"),
        ("c11", 139, "139 GPa"), ("c13", 74.3, "74.3 GPa"), ("c12", 77.8, "77.8 GPa"), ("c33", 1.66e12, "dyn/cm2"),
        ("e33", 1510, "1510 uC/cm2"), ("e31", -520, "-5.2 C/m2"), ("e33", 374e-12, "d = 3.74e-10 C/N"),
        ("f33", 1.5e-8, "d = 1.5e-08 m/A"), ("g33", 3.0, "3 ps/m"), ("rho", 7.5, "7.5 g/cm3"),
    )),
    ({"alternatives": [{"eps33": 830, "source": "a sheet"}]}, ["mine (alternative 1): ", "did you mean"]),
    ({"limits": {"tensile_strength": {"value": 35, "source": "a sheet"}}}, ["did you mean 35 MPa"]),
]  # fmt: skip


@pytest.mark.parametrize(("change", "words"), CHANGED)
def test_entries_are_refused_by_name(change: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(solver.MaterialError) as refusal:
        read(change)
    assert all(word in str(refusal.value) for word in ["mine", *words])


#: PZT-5A as vendors print it: s^E [m2/N], d [C/N], free relative permittivities.
PZT_5A: dict[str, Any] = {
    "s11": "16.4e-12 m2/N", "s12": -5.74e-12, "s13": -7.22e-12, "s33": 18.8e-12, "s44": 47.5e-12,
    "d31": "-171 pC/N", "d33": "374 pC/N", "d15": "584 pC/N", "eps_r11": 1730, "eps_r33": 1700,
}  # fmt: skip


def matrices(order: str) -> dict[str, Any]:
    """Stiffness [GPa], e [C/m2] and clamped permittivity of a ceramic, shears counted by one of the orders."""
    turn = [0, 1, 2, 3, 4, 5] if order == "IEEE" else [0, 1, 2, 5, 4, 3]
    c = np.diag([120.0, 120.0, 110.0, 21.0, 21.0, 22.5])
    c[0, 1] = c[1, 0] = 75.0
    c[:2, 2] = c[2, :2] = 74.0
    e = np.zeros((3, 6))
    e[2, :3], e[0, 4], e[1, 3] = (-5.4, -5.4, 15.8), 12.3, 12.3
    return {
        "c": {"unit": "GPa", "rows": c[np.ix_(turn, turn)].tolist()},
        "e": e[:, turn].tolist(),
        "eps": ["8.1 nF/m", "8.1 nF/m", "7.3 nF/m"],
        "order": order,
    }


def slip(name: str, row: int, column: int, value: float) -> dict[str, Any]:
    """Matrices in the order of IEEE with one entry that breaks the symmetry."""
    entries = matrices("IEEE")
    rows = entries[name]["rows"] if name == "c" else entries[name]
    rows[row][column] = value
    return entries


def test_a_vendors_sheet_gives_the_published_stiffness_form() -> None:
    """Berlincourt's PZT-5A, rounded to three digits."""
    read = Material.from_mapping(PZT_5A)
    for name, known in {"c11": 120.3e9, "c33": 110.9e9, "eps33": 7.32e-9}.items():
        assert float(getattr(read, name)) == pytest.approx(known, rel=1e-3), name
    for name, known in {"e33": 15.8, "e31": -5.35, "e15": 12.3}.items():
        assert float(getattr(read, name)) == pytest.approx(known, rel=2e-3), name


def test_both_forms_lead_back_to_each_other() -> None:
    material = find("PZT-5H")
    sheet = strain_charge(*stress_matrices(material.plain()))
    assert sheet["d33"] == pytest.approx(593e-12, rel=5e-3)  # the vendor's 593, -274, 741 pC/N
    assert sheet["d31"] == pytest.approx(-274e-12, rel=5e-3)
    assert sheet["d15"] == pytest.approx(741e-12, rel=5e-3)
    names = ("s11", "s12", "s13", "s33", "s44", "d31", "d33", "d15", "eps_T11", "eps_T33")
    again = Material.from_mapping({name: sheet[name] for name in names})
    for name in ("c11", "c12", "c13", "c33", "c44", "e31", "e33", "e15", "eps11", "eps33"):
        # the stiffness is inverted twice: condition 10, rounding 1e-16
        assert float(getattr(again, name)) == pytest.approx(float(getattr(material, name)), rel=1e-12)


@pytest.mark.parametrize("change", [{"d33": None, "k33": 0.705}, {"s12": None, "s66": 44.28e-12}])
def test_what_a_sheet_leaves_out_follows_from_the_rest(change: dict[str, Any]) -> None:
    assert float(Material.from_mapping(without(PZT_5A | change)).e33) == pytest.approx(
        15.8, rel=1e-2
    )  # k33 has two digits and a half


@pytest.mark.parametrize("order", ["IEEE", "Abaqus"])
def test_matrices_of_both_orders_are_read(order: str) -> None:
    material = Material.from_mapping(matrices(order))
    assert [float(material.c44), float(material.c13), float(material.e15)] == [21e9, 74e9, 12.3]
    assert float(material.eps33) == 7.3e-9


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        (PZT_5A | {"eps33": 1700}, r"eps33: 1700 beside charge constants d: .* is eps_r33: 1700;"),
        (PZT_5A | {"d15": "584 uC/N"}, r"d15: 0\.000584 C N-1 is of a size that no material has$"),
        (PZT_5A | {"s11": 16.4}, r"s11: 16.4 Pa-1 is of a size that no material has; did you mean 16.4e-12 m2/N\?"),
        (PZT_5A | {"d33": 374}, r"d33: 374 C N-1 .* did you mean 374 pC/N\?"),
        (PZT_5A | {"eps_r33": 15e-9}, "eps_r33: 1.5e-08 1 .*eps_T11"),
        (PZT_5A | {"s12": 25e-12}, "compliance is not positive definite"),
        (PZT_5A | {"k33": 0.3}, "k33 = 0.3 means"),
        (PZT_5A | {"k33": 70.5}, "k33: 70.5 is not within"),
        (PZT_5A | {"eps_r33": 300}, "eps_T33 = .* must exceed"),
        (PZT_5A | {"c11": 120e9}, "s11 and c11: two forms"),
        (PZT_5A | {"s66": 20e-12}, "s66 = 2e-11: with s11"),
        (PZT_5A | {"s33": "18.8 GPa"}, "s33: .*unit mismatch"),
        ({"E": 70e9}, "nu: missing"),
        ({"E": 70e9, "nu": 0.6}, "nu: 0.6 is not within"),
        (matrices("Abaqus") | {"order": "IEEE"}, r"c, row 5, column 5: 2.1e\+10 where a body .* has 2.25e\+10"),
        (slip("c", 1, 0, 79.0), r"c, row 2, column 1: 7.9e\+10 where a body .* has 7.5e\+10"),
        (slip("e", 1, 3, 12.5), r"e, row 2, column 4"),
        (matrices("IEEE") | {"order": "ANSYS"}, "order: 'ANSYS' must be IEEE"),
        (matrices("IEEE") | {"c": [[1.0, 2.0]]}, "c: needs 6 rows of 6 numbers"),
        (matrices("IEEE") | {"eps": [8.1e-9, 9.9e-9, 7.3e-9]}, "eps, row 2, column 2"),
        (matrices("IEEE") | {"e33": 15.8}, "e and e33: two forms"),
    ],
)
def test_slips_are_refused_by_name(entries: dict[str, Any], message: str) -> None:
    assert_refused(MaterialError, message, Material.from_mapping, entries)


PZT = constants(find("PZT-4"))


def test_with_its_unit_any_value_is_taken_and_read_back() -> None:
    odd = {"eps33": "830 F/m", "rho": "7.5 kg m-3", "e31": "1e-9 C/m2"}
    others = [{"eps33": "830 F/m", "source": "a sheet"}]
    limits = {"tensile_strength": {"value": "35 Pa", "source": "a sheet"}}
    mine = solver.Material.from_mapping(PZT | odd | {"alternatives": others, "limits": limits})
    assert float(mine.eps33) == 830.0
    assert mine.plain()["limits"]["tensile_strength"]["value"] == "35.0 Pa"
    again = solver.Material.from_mapping(mine.plain())
    assert again.plain() == mine.plain()
    assert np.isfinite(solver.solve({"material": again.renamed("other"), **CONTACT})["voltage"])
    assert float(solver.Material.from_mapping(PZT | {"c11": "139 GPa"}).c11) == 139e9
    assert float(solver.Material.isotropic("210 GPa", 0.3).c44) == pytest.approx(210e9 / 2.6)


def test_usual_materials_and_what_is_computed_of_them_never_ask() -> None:
    for known in solver.materials().values():
        for variant in (known, *known.variants()):
            plain = variant.plain()
            assert not any(isinstance(plain.get(name), str) for name in USUAL)
    solver.fibrous(BTO, CFO, 1e-12).check()  # e33 is next to nothing


def test_a_constant_in_megapascals_is_told_by_its_coupling_also_beside_constants_with_units() -> None:
    """126 000 MPa without its unit is the stiffness of a gel; no gel couples by 23 C/m2."""
    soft = PZT | {"c11": 126e3, "c12": 79.5e3, "c13": 84.1e3, "c33": 117e3, "c44": 23e3}
    charged = {name: f"{PZT[name]:g} C/m2" for name in ("e31", "e33", "e15")}
    with pytest.raises(solver.MaterialError, match="more than any material does"):
        solver.Material.from_mapping({**soft, **charged})


@pytest.mark.parametrize("text", ["830 eps0", "830 ε₀", "830 ϵ_0"])
def test_a_suggested_unit_can_be_written(text: str) -> None:
    material = solver.Material.from_mapping(PZT | {"eps33": text})
    assert material.eps33 == pytest.approx(830 * 8.8541878188e-12, rel=1e-12)
