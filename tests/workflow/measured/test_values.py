"""Every value of the model against closed formulas and published digits, with constants that stand here."""

from typing import Any, get_args

import numpy as np
import pytest

from workflow.measured import comparison
from workflow.measured.comparison import modelled
from workflow.study.sections import ModelQuantity, ModelValue

TIP: dict[str, Any] = {"profile": "sphere", "radius": 1e-6, "force": 1e-4}
ELASTIC: dict[str, Any] = {"electric": "insulating", "magnetic": "insulating", "base": "rigid"}


def value(quantity: ModelQuantity, **case: Any) -> float:
    return modelled(ModelValue(quantity=quantity, case=case)).value


def test_every_quantity_of_a_row_has_an_answer() -> None:
    assert set(comparison._ANSWERS) == set(get_args(ModelQuantity))


@pytest.mark.parametrize(
    ("material", "expected", "digits"), [("PZT-4", 250.1001e-12, 1e-6), ("BaTiO3", 168.2812e-12, 1e-6)]
)
def test_a_tip_has_the_charge_of_the_theory_of_points(material: str, expected: float, digits: float) -> None:
    assert value("charge_per_force", material=material, **TIP) == pytest.approx(expected, rel=digits)


def test_lithium_niobate_and_its_spread() -> None:
    """13.517 and 13.444: Barnett and Lothe's integrals of `verification.oracles.surface` give both."""
    spread = modelled(ModelValue(quantity="charge_per_force", case={"material": "LiNbO3", **TIP}))
    assert 1e12 * spread.value == pytest.approx(13.517, abs=1e-3)
    assert 1e12 * spread.deviation == pytest.approx(13.517 - 13.444, abs=1e-3)
    assert spread.sets == 1


def test_clamped_films() -> None:
    spread = modelled(ModelValue(quantity="clamped_d33", case={"material": "AlN"}))
    assert 1e12 * spread.value == pytest.approx(1550 / 389, rel=1e-12)
    assert 1e12 * spread.deviation == pytest.approx(1550 / 389 - 1460 / 385, rel=1e-9)
    assert 1e12 * value("clamped_d33", material="LiNbO3") == pytest.approx(5.3, abs=0.1)


@pytest.mark.parametrize(("material", "expected"), [("LiNbO3", 6.0), ("PZT-4", 291.3), ("PZT-5H", 594.2)])
def test_d33_of_a_free_body(material: str, expected: float) -> None:
    """LiNbO3 from d33 = 6 pC/N, of which its e were made; the others by Voigt's matrices (materials, 2)."""
    assert 1e12 * value("free_d33", material=material) == pytest.approx(expected, abs=0.05)


def test_alloys_by_their_composition() -> None:
    """d33 by the inverse of the stiffness matrix, of constants written out by hand at a tenth of scandium."""
    c11, c12, c13, c33 = 379.783, 142.449, 119.741, 334.994
    stiffness = np.array([[c11, c12, c13], [c12, c11, c13], [c13, c13, c33]])
    d33 = (np.array([-0.67155, -0.67155, 1.60122]) @ np.linalg.inv(stiffness))[2] * 1e3
    assert 1e12 * value("free_d33", composite="AlScN", scandium_fraction=0.1) == pytest.approx(d33, abs=1e-3)


def test_the_front_of_a_pad() -> None:
    """e33/c33 of a wide pad on a rigid base; on silicon the sign changes at a pad of 0.14 mm."""
    film: dict[str, Any] = {
        "material": "AlN", "thickness": 1e-6, "electrode": "top", "collector": 2, "profile": "sphere", "radius": 1e-5,
        "force": 1e-6, "electric": "insulating", "magnetic": "insulating",
    }  # fmt: skip
    rigid = value("pad_stroke_per_volt", **film, base="rigid", patch_size=1e-4)
    assert rigid == pytest.approx(1.55 / 389e9, rel=1e-6)
    narrow, wide = (value("pad_stroke_per_volt", **film, base="silicon", patch_size=size) for size in (1.3e-4, 1.5e-4))
    assert narrow > 0 > wide


def test_a_ball_s_exponents_on_half_spaces_and_films() -> None:
    assert value("indentation_exponent", material="PZT-4", **TIP) == pytest.approx(1.5, abs=1e-12)
    wide = {"profile": "sphere", "radius": 1.0, "force": 1e7, "thickness": 1e-3, **ELASTIC}
    assert value("indentation_exponent", material="polyimide", **wide) == pytest.approx(2.0, abs=1e-3)
    narrow = {**wide, "force": 1.0, "thickness": "1 m"}
    assert value("indentation_exponent", material="polyimide", **narrow) == pytest.approx(1.5, abs=1e-3)


def test_linear_theory_knows_no_dependence_on_load_or_charge() -> None:
    assert value("response_under_load", material="PZT-4", **TIP) == pytest.approx(1, abs=1e-12)
    charged = value("stiffness_under_charge", material="PMN-PT 67:33", **TIP)
    assert charged == pytest.approx(1, abs=1e-9)


def test_the_layers_of_hayes() -> None:
    ratios, expected = np.array([0.2, 0.4, 1.0, 2.0]), [1.20656, 1.47261, 2.48352, 4.35324]
    disc = {"material": "steel", "profile": "disc", "force": 1.0, "thickness": 1e-3, **ELASTIC}
    factors = [value("layer_factor", width=2e-3 * ratio, **disc) for ratio in ratios.tolist()]
    np.testing.assert_allclose(factors, expected, atol=6e-6)
