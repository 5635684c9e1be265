"""The surrogate as a source of designs asks curves for no more than is needed."""

from pathlib import Path

import numpy as np
import pytest

from solver import Material
from tests.surrogate import curved
from workflow.design.asking.sources import Exact, Predicted
from workflow.study.contents import Origin
from workflow.study.model import Study, remade


def test_curves_are_asked_for_the_quantities_of_a_term_even_if_it_has_none() -> None:
    model = curved.fitted()
    source = Predicted(model)
    X = np.array([[0.2, 0.8], [-0.5, 1.3]])
    factors = {"a": X[:, 0], "b": X[:, 1]}
    for ask in (source.values, source.stds, source.reaches):
        assert ask(factors, []) == {}  # a goal that is a factor
    assert source.slopes(factors, [], ["a"]) == {}
    place = model.outputs_.index("place")
    np.testing.assert_allclose(source.values(factors, ["place"])["place"], model.predict_array(X)[:, place], rtol=1e-5)


def test_the_field_below_a_contact_is_what_charges_make_and_does_not_depend_on_the_datum() -> None:
    """A pure dielectric below a conducting strip: D_y = T / (pi h) in the middle, where the field is the largest."""
    load, charge, width, eps33 = 1e3, 2e-6, 1e-3, 1e-9
    plain = {"c11": 1e11, "c12": 4e10, "c13": 4e10, "c33": 1e11, "c44": 3e10}
    mine = Material.from_mapping({"name": "plain", **plain, "eps11": 4 * eps33, "eps33": eps33})
    text = {"title": "a strip", "fixed": {"profile": "flat", "material": "plain", "width": width, "charge": charge}}
    study = Study.model_validate(
        text | {"factors": {"load": {"low": 500, "high": 2000, "levels": 3}}},
        context=Origin(Path(), {"plain": mine}),
    )
    found = [
        Exact(remade(study, fixed={**study.fixed, "datum": datum})).field_below({"load": np.array([[load]])})
        for datum in (0.1, 10.0)
    ]
    assert found[0] == pytest.approx(charge / (np.pi * width / 2) / eps33, rel=1e-9)
    assert found[1] == pytest.approx(found[0], rel=1e-12)
