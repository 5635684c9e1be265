"""Data-sheet constants: both forms against published sets, matrices of both orders, and every slip in one line."""

from typing import Any

import numpy as np
import pytest

from solver import Material, MaterialError, find
from solver.material.datasheet import strain_charge, stress_matrices

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


def test_a_vendors_sheet_gives_the_published_stiffness_form() -> None:
    material = Material.from_mapping(PZT_5A)
    # c11 120.3 GPa, e33 15.8 C/m2, e31 -5.4, e15 12.3 and 830 eps0: Berlincourt's PZT-5A, rounded to three digits
    assert float(material.c11) == pytest.approx(120.3e9, rel=1e-3)
    assert float(material.c33) == pytest.approx(110.9e9, rel=1e-3)
    assert float(material.e33) == pytest.approx(15.8, rel=2e-3)
    assert float(material.e31) == pytest.approx(-5.35, rel=2e-3)
    assert float(material.e15) == pytest.approx(12.3, rel=2e-3)
    assert float(material.eps33) == pytest.approx(7.32e-9, rel=1e-3)


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
    sheet = {name: value for name, value in {**PZT_5A, **change}.items() if value is not None}
    assert float(Material.from_mapping(sheet).e33) == pytest.approx(15.8, rel=1e-2)  # k33 has two digits and a half


@pytest.mark.parametrize("order", ["IEEE", "Abaqus"])
def test_matrices_of_both_orders_are_read(order: str) -> None:
    material = Material.from_mapping(matrices(order))
    assert [float(material.c44), float(material.c13), float(material.e15)] == [21e9, 74e9, 12.3]
    assert float(material.eps33) == 7.3e-9


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        (PZT_5A | {"s11": 16.4}, r"s11: 16.4 Pa-1 is of a size that no material has; did you mean 16.4e-12 m2/N\?"),
        (PZT_5A | {"d33": 374}, r"d33: 374 C N-1 .* did you mean 374 pC/N\?"),
        (PZT_5A | {"eps_r33": 15e-9}, "eps_r33: 1.5e-08 1 .*eps_T11"),
        (PZT_5A | {"s12": 25e-12}, "compliance is not positive definite"),
        (PZT_5A | {"k33": 0.3}, "k33 = 0.3 means"),
        (PZT_5A | {"k33": 70.5}, "k33: 70.5 is not within"),
        (PZT_5A | {"eps_r33": 300}, "eps_T33 = .* must exceed"),
        (PZT_5A | {"c11": 120e9}, "s11 and c11: two forms"),
        (PZT_5A | {"e33": 15.8}, "d31 and e33: two forms"),
        (PZT_5A | {"s66": 20e-12}, "s66 = 2e-11: with s11"),
        (PZT_5A | {"s33": "18.8 GPa"}, "s33: .*unit mismatch"),
        (PZT_5A | {"s33": True}, "s33: True is not a finite number"),
        ({"E": 70e9}, "nu: missing"),
        ({"E": 70e9, "nu": 0.6}, "nu: 0.6 is not within"),
        (matrices("Abaqus") | {"order": "IEEE"}, r"e, row 2, column 4: 0 where a body .* has 12.3"),
        (matrices("IEEE") | {"order": "ANSYS"}, "order: 'ANSYS' must be IEEE"),
        (matrices("IEEE") | {"c": [[1.0, 2.0]]}, "c: needs 6 rows of 6 numbers"),
        (matrices("IEEE") | {"eps": [8.1e-9, 9.9e-9, 7.3e-9]}, "eps, row 2, column 2"),
        (matrices("IEEE") | {"e33": 15.8}, "e and e33: two forms"),
    ],
)
def test_slips_are_refused_by_name(entries: dict[str, Any], message: str) -> None:
    with pytest.raises(MaterialError, match=message):
        Material.from_mapping(entries)
