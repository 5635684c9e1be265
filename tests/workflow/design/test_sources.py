"""The surrogate as a source of designs asks curves for no more than is needed."""

import numpy as np

from tests.surrogate import curved
from workflow.design.asking.sources import Predicted


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
