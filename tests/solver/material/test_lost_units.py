"""A bare constant whose size no material has asks for its unit; with its unit it is taken."""

from typing import Any

import numpy as np
import pytest

import solver
from solver.material.constants import UNITS
from solver.material.usual import USUAL

PZT = {name: float(getattr(solver.find("PZT-4"), name)) for name in UNITS}
CASE = {"radius": 0.05, "load": 1e4}
#: A constant as somebody wrote it, without its unit, and what the question proposes.
LOST = [
    ("eps33", 830, "830 eps0"), ("eps11", 5.62, "5.62 nF/m"), ("mu33", 1.0, "1 mu0"), ("mu11", 590, "590 mu0"),
    ("c11", 139, "139 GPa"), ("c13", 74.3, "74.3 GPa"), ("c12", 77.8, "77.8 GPa"), ("c33", 1.66e12, "dyn/cm2"),
    ("e33", 1510, "1510 uC/cm2"), ("e31", -520, "-5.2 C/m2"), ("e33", 374e-12, "d = 3.74e-10 C/N"),
    ("f33", 1.5e-8, "d = 1.5e-08 m/A"), ("g33", 3.0, "3 ps/m"), ("rho", 7.5, "7.5 g/cm3"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value", "meant"), LOST)
def test_a_constant_that_lost_its_unit_asks(name: str, value: float, meant: str) -> None:
    arrays: dict[str, Any] = {key: np.array(number) for key, number in (PZT | {name: value}).items()}
    entries = PZT | {name: value, "name": "mine"}
    with pytest.raises(solver.MaterialError, match=f"mine: {name}: .*did you mean") as error:
        solver.Material.from_mapping(entries)
    assert meant in str(error.value)
    with pytest.raises(solver.MaterialError, match=f"{name}: .*did you mean"):
        solver.solve({"material": solver.Material(**arrays), **CASE})
    with pytest.raises(solver.MaterialError, match=r"mine \(alternative 1\): .*did you mean"):
        solver.Material.from_mapping(PZT | {"name": "mine", "alternatives": [{name: value, "source": "a sheet"}]})


def test_stiffnesses_in_megapascals_couple_too_much() -> None:
    scaled = {name: PZT[name] / 1e6 for name in ("c11", "c12", "c13", "c33", "c44")}
    with pytest.raises(solver.MaterialError, match=r"e33 = 15.1 C m-2 couples c33 = 115000 Pa .* lose its unit"):
        solver.Material.from_mapping(PZT | scaled)


def test_youngs_moduli_and_limits_ask_too() -> None:
    with pytest.raises(solver.MaterialError, match="did you mean 210 GPa"):
        solver.Material.isotropic(210, 0.3)
    with pytest.raises(solver.MaterialError, match="did you mean 35 MPa"):
        solver.Material.from_mapping(PZT | {"limits": {"tensile_strength": {"value": 35, "source": "a sheet"}}})


def test_with_its_unit_any_value_is_taken_and_read_back() -> None:
    odd = {"eps33": "830 F/m", "rho": "7.5 kg m-3", "e31": "1e-9 C/m2"}
    others = [{"eps33": "830 F/m", "source": "a sheet"}]
    limits = {"tensile_strength": {"value": "35 Pa", "source": "a sheet"}}
    mine = solver.Material.from_mapping(PZT | odd | {"alternatives": others, "limits": limits})
    assert float(mine.eps33) == 830.0
    assert mine.plain()["limits"]["tensile_strength"]["value"] == "35.0 Pa"
    again = solver.Material.from_mapping(mine.plain())
    assert again.plain() == mine.plain()
    assert np.isfinite(solver.solve({"material": again.renamed("other"), **CASE})["voltage"])
    assert float(solver.Material.from_mapping(PZT | {"c11": "139 GPa"}).c11) == 139e9
    assert float(solver.Material.isotropic("210 GPa", 0.3).c44) == pytest.approx(210e9 / 2.6)


def test_usual_materials_and_what_is_computed_of_them_never_ask() -> None:
    for known in solver.materials().values():
        for variant in (known, *known.variants()):
            plain = variant.plain()
            assert not any(isinstance(plain.get(name), str) for name in USUAL)
    solver.fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), 1e-12).check()  # e33 is next to nothing


def test_a_constant_in_megapascals_is_told_by_its_coupling_also_beside_constants_with_units() -> None:
    """126 000 MPa without its unit is the stiffness of a gel; no gel couples by 23 C/m2."""
    soft = PZT | {"c11": 126e3, "c12": 79.5e3, "c13": 84.1e3, "c33": 117e3, "c44": 23e3}
    charged = {name: f"{PZT[name]:g} C/m2" for name in ("e31", "e33", "e15")}
    with pytest.raises(solver.MaterialError, match="more than any material does"):
        solver.Material.from_mapping({**soft, **charged})


@pytest.mark.parametrize("text", ["830 eps0", "830 ε0", "830 ε₀", "830 ϵ_0"])
def test_a_suggested_unit_can_be_written(text: str) -> None:
    material = solver.Material.from_mapping(PZT | {"eps33": text})
    assert material.eps33 == pytest.approx(830 * 8.8541878188e-12, rel=1e-12)
