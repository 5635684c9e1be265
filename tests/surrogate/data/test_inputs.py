"""Ranges, scales and Chebyshev-Gauss levels."""

import numpy as np
import pytest

from surrogate import Input


@pytest.mark.parametrize(("scale", "middle"), [("linear", 0.46), ("log", 0.018**0.5), ("logit", 3 / 10)])
def test_a_scale_maps_there_and_back_with_its_slope(scale: str, middle: float) -> None:
    input_ = Input("x", 0.02, 0.9, scale)  # type: ignore[arg-type]  # parametrised by plain strings
    x, step = np.linspace(0.05, 0.85, 7), 1e-7
    difference = (input_.to_unit(x + step) - input_.to_unit(x - step)) / (2 * step)
    np.testing.assert_allclose(input_.unit_slope(x), difference, rtol=1e-6)
    np.testing.assert_allclose(input_.from_unit(input_.to_unit(x)), x, rtol=1e-14)
    assert input_.from_unit(-1) == 0.02
    assert input_.from_unit(1) == 0.9
    assert input_.from_unit(0.0) == pytest.approx(middle, rel=1e-13)  # of odds 1/49 and 9: 3/7


@pytest.mark.parametrize(
    ("low", "high", "scale", "says"),
    [
        (1, 1, "linear", "low 1 must be less than high 1"),
        (0, 1, "log", "log scale needs low > 0"),
        (0, 0.9, "logit", r"a logit scale needs 0 < low and high < 1, got \[0, 0.9\]"),
        (float("nan"), 1, "linear", "finite"),
        (0, 1, "cubic", "'cubic' is none of linear, log"),
    ],
)
def test_a_bad_range_is_refused_by_name(low: float, high: float, scale: str, says: str) -> None:
    with pytest.raises(ValueError, match=says) as caught:
        Input("radius", low, high, scale)  # type: ignore[arg-type]  # bad on purpose
    assert "'radius'" in str(caught.value)
    assert "\n" not in str(caught.value)
