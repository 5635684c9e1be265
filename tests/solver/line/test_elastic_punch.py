"""An elastic punch on films: the closed form where film and base are one, and one table of a stack for every punch."""

from unittest.mock import Mock

import numpy as np
import pytest

from solver.halfplane.profile import Profile
from solver.halfplane.sliding import Punch
from solver.line import kernel as kernels
from solver.line.contact import FilmContact
from solver.line.table import table
from solver.stack.layers import Layer, Stack
from tests.solver.line.films import FIBROUS, ON_STEEL, cases

STEEL = Punch.isotropic(210e9, 0.3)


def test_silicone_on_a_stiff_film_is_the_silicone_of_hertz() -> None:
    """The film is 1e5 times as stiff: it adds 1e-5 of the compliance."""
    soft, profile = Punch.isotropic(2e6, 0.49), Profile.cylinder(np.array(0.05))
    tabled = table(ON_STEEL, 0.0, least=0.3, most=4.0, punch=soft)
    computed = FilmContact(tabled, profile, cases(3.0), np.zeros((1, 2)), np.array(1.0))
    hertz = np.sqrt(2 * float(soft.compliance) * 0.05 * 3.0 / np.pi)
    assert float(computed.half_width[0]) == pytest.approx(hertz, rel=2e-5)


def test_one_table_of_a_stack_serves_every_punch(monkeypatch: pytest.MonkeyPatch) -> None:
    stack = Stack((Layer(FIBROUS, 2e-4),))
    computed = Mock(wraps=kernels._transforms)
    monkeypatch.setattr(kernels, "_transforms", computed)
    for punch in (Punch(), STEEL, Punch.isotropic(630e9, 0.22)):
        for friction in (0.0, 0.3):
            table(stack, friction, least=0.3, most=1.0, nodes=4, punch=punch)
    assert computed.call_count == 1
