"""The published BaTiO3-CoFe2O4 tables and where they come from; PMN-PT against the figures of its abstract."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import solver
from solver.material.constants import UNITS
from solver.material.library import published
from tests.solver import micromechanics

FRACTIONS = ("0.0", "0.2", "0.4", "0.6", "0.8", "1.0")
COUPLED = ("e31", "e33", "f31", "f33", "f15", "eps33", "g33", "mu33", "g11", "mu11")


@cache
def mori_tanaka(sign: float, fraction: float) -> dict[str, float]:
    """Constants of fibres of BaTiO3 in CoFe2O4 with mu11 = sign * 590e-6, by the full tensors."""
    fibre, host = (
        {constant: float(getattr(solver.find(name), constant)) for constant in UNITS} for name in ("BaTiO3", "CoFe2O4")
    )
    exact = micromechanics.fibrous(fibre, host | {"mu11": sign * host["mu11"]}, fraction)
    return {constant: float(value) for constant, value in exact.items()}


@pytest.mark.parametrize("name", COUPLED)
def test_published_tables_follow_from_mori_tanaka_with_the_wrong_sign(name: str) -> None:
    """Agreement is a tenth of the column's range, for e31 a sixth: the values were read from plots."""
    column = np.array([published()[fraction][name] for fraction in FRACTIONS])
    wrong, right = (np.array([mori_tanaka(s, float(f))[name] for f in FRACTIONS]) for s in (-1.0, 1.0))
    assert np.max(np.abs(column - wrong)) < (0.17 if name == "e31" else 0.1) * np.ptp(column)
    if name in ("g11", "mu11"):
        assert np.max(np.abs(column - right)) > np.ptp(column)
        assert np.all(np.sign(right[1:5]) == -np.sign(column[1:5]))


def test_the_sih_song_set_has_the_wrong_sign_in_g11() -> None:
    material = solver.find("BaTiO3-CoFe2O4 50:50")
    wrong, right = mori_tanaka(-1.0, 0.5), mori_tanaka(1.0, 0.5)
    assert float(material.g33) == pytest.approx(wrong["g33"], rel=6e-3)
    assert float(material.g11) == pytest.approx(wrong["g11"], rel=6e-3)
    assert right["g11"] == pytest.approx(-5.23e-12, rel=1e-3)


@pytest.mark.parametrize("fraction", FRACTIONS)
def test_a_table_as_published_is_refused_for_its_mu11(fraction: str) -> None:
    entry = published()[fraction]
    assert set(entry) <= set(UNITS)
    if fraction == "1.0":
        solver.Material.from_mapping(entry)
        return
    with pytest.raises(solver.MaterialError, match=r"mu11 = .* must be positive; published BaTiO3-CoFe2O4 tables"):
        solver.Material.from_mapping(entry)


@pytest.mark.parametrize("fraction", FRACTIONS[1:5])
def test_repaired_tables_differ_in_two_constants(fraction: str) -> None:
    material = solver.find(f"BaTiO3-CoFe2O4 {fraction}")
    expected = dict(published()[fraction]) | {n: mori_tanaka(1.0, float(fraction))[n] for n in ("mu11", "g11")}
    for name, value in expected.items():
        assert float(getattr(material, name)) == pytest.approx(value, rel=1e-3), name
    assert "repaired" in material.source
    assert "-590e-6" in material.note


def test_pmn_pt_has_the_figures_of_its_abstract() -> None:
    """Zhang, Jiang and Cao (2001): d33 about 2800 pC/N, k33 about 94 %, a shear mode of 880 m/s along [110]."""
    m = solver.find("PMN-PT 67:33")
    c = np.array([[m.c11, m.c12, m.c13], [m.c12, m.c11, m.c13], [m.c13, m.c13, m.c33]], dtype=float)
    s = np.linalg.inv(c)
    d = s @ np.array([m.e31, m.e31, m.e33], dtype=float)
    free = float(m.eps33) + float(d @ np.array([m.e31, m.e31, m.e33], dtype=float))
    assert d[2] == pytest.approx(2800e-12, rel=0.15)  # half a GPa of c13, where it is rounded, moves d33 by 12 %
    assert d[2] / np.sqrt(s[2, 2] * free) == pytest.approx(0.94, abs=0.03)
    assert float(np.sqrt((m.c11 - m.c12) / 2 / m.rho)) == pytest.approx(880, rel=0.03)


def test_doubts_in_the_entries_are_what_the_constants_say() -> None:
    pmn, film = solver.find("PMN-PT 67:33"), solver.find("P(VDF-TrFE) 75:25")
    c = np.array([[pmn.c11, pmn.c12, pmn.c13], [pmn.c12, pmn.c11, pmn.c13], [pmn.c13, pmn.c13, pmn.c33]], dtype=float)
    d33 = float((np.linalg.inv(c) @ np.array([pmn.e31, pmn.e31, pmn.e33], dtype=float))[2])
    assert d33 == pytest.approx(3170e-12, rel=1e-3)
    assert d33 / 2800e-12 == pytest.approx(1.13, abs=0.005)
    assert float(np.linalg.eigvalsh(c)[0]) == pytest.approx(5e9, rel=0.1)
    assert "3170 pC/N, 13 % above its 2800" in pmn.note
    shear = (film.c11 - film.c12) / 2
    assert float(shear / film.c44) == pytest.approx(10, rel=0.01)
    assert "c44 = 0.105 GPa is a tenth of what (c11 - c12)/2 = 1.05 GPa" in film.note
    stiffer = replace(film, c44=shear, name="stiffer")
    solution = solver.solve({"material": [film, stiffer], "radius": 0.05, "load": 1e3, "friction": 0.3})
    solution = solution.assign(width=solution["contact_trailing"] + solution["contact_leading"])
    for name, ratio in {"width": 0.6, "peak_pressure": 1.7, "trailing_tension": 0.6, "voltage": 0.7}.items():
        assert round(float(solution[name][1] / solution[name][0]), 1) == ratio


@pytest.mark.parametrize(
    ("name", "coupling", "compliances", "strains"),
    [
        ("Terfenol-D", "f", {"s11": 44e-12, "s33": 38e-12, "s13": -16.5e-12}, {"31": -4.3e-9, "33": 8.5e-9}),
        (
            "P(VDF-TrFE) 75:25",
            "e",
            {"s11": 333e-12, "s33": 300e-12, "s13": -87.5e-12},
            {"31": 10.4e-12, "33": -33.5e-12},
        ),
    ],
)
def test_compliances_and_strain_constants_of_the_source_come_back(
    name: str, coupling: str, compliances: dict[str, float], strains: dict[str, float]
) -> None:
    m = solver.find(name)
    stiffness = np.array([[m.c11, m.c12, m.c13], [m.c12, m.c11, m.c13], [m.c13, m.c13, m.c33]], dtype=float)
    s = np.linalg.inv(stiffness)
    axial, along = float(getattr(m, f"{coupling}31")), float(getattr(m, f"{coupling}33"))
    d = s @ np.array([axial, axial, along])
    computed = {"s11": s[0, 0], "s33": s[2, 2], "s13": s[0, 2]}
    for key, value in compliances.items():
        assert computed[key] == pytest.approx(value, rel=3e-3)
    assert d[[0, 2]] == pytest.approx([strains["31"], strains["33"]], rel=5e-3)
