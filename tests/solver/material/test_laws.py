"""Composites by name: every name has its law, and what has none is refused instead of taken for another."""

import numpy as np
import pytest

import solver
from solver import MaterialError
from solver.material import laws
from solver.material.constants import UNITS
from solver.names import COMPOSITES, MIXTURES
from workflow.study.layered import BodyLayer

PHASES = solver.find("BaTiO3"), solver.find("CoFe2O4")
EXPECTED = {
    "fibrous": solver.fibrous(*PHASES, 0.3),
    "laminate": solver.laminate(*PHASES, 0.3),
    "AlScN": solver.aluminium_scandium_nitride(0.3),
}


@pytest.mark.parametrize("name", COMPOSITES)
def test_every_name_has_its_own_law(name: str) -> None:
    mixture = laws.compose(name, PHASES, 0.3)
    for constant in UNITS:
        np.testing.assert_array_equal(getattr(mixture, constant), getattr(EXPECTED[name], constant))
    assert (name in MIXTURES) == (mixture.c11 != laws.compose(name, PHASES[::-1], 0.3).c11)


def test_a_name_without_law_is_refused_and_a_new_law_serves_the_layers_of_a_study(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(MaterialError, match="'woven' is not one of fibrous, laminate, AlScN"):
        laws.compose("woven", PHASES, 0.3)
    layer = BodyLayer(composite="laminate", volume_fraction=0.3, thickness=1e-4)
    woven = layer.model_copy(update={"composite": "woven"})
    monkeypatch.setitem(COMPOSITES, "woven", "volume_fraction")

    with pytest.raises(MaterialError, match="woven"):  # a third law is no laminate
        woven.compose({}, {}, ("BaTiO3", "CoFe2O4"))
    monkeypatch.setitem(laws._LAWS, "woven", lambda phases, fraction: phases[0])
    assert woven.compose({}, {}, ("BaTiO3", "CoFe2O4")).material == PHASES[0]
