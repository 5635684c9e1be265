"""The finite elements of films against published figures, and what they must refuse or tell apart."""

import numpy as np
import pytest

from verification.oracles.fem_film import ELECTRIC, MAGNETIC, FilmContact, Layer, Punch
from verification.oracles.sample_materials import BARIUM_TITANATE, isotropic

#: Theory of films, section 9, case 1: half-length, depth, V, K_D.
FIGURES = (2.103852975e-04, 6.959044108e-07, -5.393112137e02, 6.164540932e-04)
FILM, PUNCH = Layer(BARIUM_TITANATE, 0.5e-3), Punch(0.05)


def test_a_coupling_that_is_one_per_cent_off_is_seen() -> None:
    other = Layer(BARIUM_TITANATE | {"e33": 1.01 * BARIUM_TITANATE["e33"]}, FILM.thickness)
    right, wrong = (
        FilmContact([layer], None, PUNCH, FIGURES[0], order=4).potential(ELECTRIC) for layer in (FILM, other)
    )
    assert right == pytest.approx(FIGURES[2], rel=1e-5)
    assert abs(wrong / right - 1) > 5e-3


def test_steel_on_steel_is_the_half_plane() -> None:
    """Guler and Erdogan's exponent (theory, section 8), under a film of 0.3 mm of the base's material."""
    young, poisson, load, friction = 200e9, 0.3, 1e5, 0.5
    alpha = np.arctan2(1, friction * (1 - 2 * poisson) / (2 * (1 - poisson))) / np.pi
    width = np.sqrt(4 * (1 - poisson**2) / young * PUNCH.radius * load / (np.pi * alpha * (1 - alpha)))
    steel = isotropic(young, poisson)
    contact = FilmContact(
        [Layer(steel, 3e-4, ())], steel, Punch(PUNCH.radius, friction, conducted=()), width / 2, order=5
    )
    assert contact.load == pytest.approx(load, rel=2e-5)
    assert contact.half_length + contact.centre == pytest.approx((1 - alpha) * width, rel=2e-5)
    assert contact.loads[:, 0].sum() == pytest.approx(friction * contact.loads[:, 1].sum(), rel=1e-12)


def test_charges_are_held() -> None:
    punch = Punch(0.05, 0.3, 1e-5, 2e-3)
    contact = FilmContact([FILM], None, punch, 2e-4, order=4)
    np.testing.assert_allclose(-contact.loads[:, [ELECTRIC, MAGNETIC]].sum(axis=0), (1e-5, 2e-3), rtol=1e-12)
