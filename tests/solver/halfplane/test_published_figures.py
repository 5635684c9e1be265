"""The figures to hit at the end of theory section 8, and the constants of section 7."""

import numpy as np
import pytest

import solver
from verification.cases import SIH_SONG

AT = {"radius": 0.05, "load": 1e5}


@pytest.mark.parametrize(
    ("name", "friction", "half_width", "tension"),
    [
        (SIH_SONG, 0.0, 2.084514e-4, 0.0),
        (SIH_SONG, 0.3, 2.085993e-4, 202.1e6),
        (SIH_SONG, 0.5, 2.088614e-4, 345.4e6),
        ("steel", 0.3, 1.70447e-4, 237.0e6),
    ],
)
def test_half_width_and_trailing_tension(name: str, friction: float, half_width: float, tension: float) -> None:
    out = solver.solve({"material": name, "friction": friction, **AT})
    last_digit = 0.5e-10 if name == SIH_SONG else 0.5e-9
    assert (out.contact_trailing + out.contact_leading).item() / 2 == pytest.approx(half_width, abs=last_digit)
    assert out.trailing_tension.item() == pytest.approx(tension, abs=0.05e6)


@pytest.mark.parametrize(
    ("name", "lam", "ratio"),
    [(SIH_SONG, 1.365084e-11, 0.197388), ("BaTiO3", 1.548665e-11, 0.242993), ("CoFe2O4", 1.254404e-11, 0.177779)],
)
def test_reduced_constants_read_from_the_contact(name: str, lam: float, ratio: float) -> None:
    """Theory section 3 solved for lam and kap; the theory prints the size of a kap that is negative."""
    at_rest, sliding = (solver.solve({"material": name, "friction": friction, **AT}) for friction in (0.0, 1.0))
    width = (at_rest.contact_trailing + at_rest.contact_leading).item()
    assert np.pi * width**2 / (8 * AT["radius"] * AT["load"]) == pytest.approx(lam, abs=0.5e-17)
    assert 1 / np.tan(np.pi * sliding.pressure_exponent.item()) == pytest.approx(ratio, abs=0.5e-6)
