"""Kinds of bodies: told by factors, split by the face, and each answered by what it says it has."""

import pytest

from solver.body import airless
from solver.curves import FOLLOWS, REGIONS
from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.solution import body_of
from solver.names import HEAT_QUANTITIES
from tests.solver.face.test_refused import REFUSED
from tests.solver.test_contract import BODIES
from tests.solver.test_contract import kind as named

READ = {"collector": 1, "patch_size": 1e-4, "patch_pitch": 2e-4}
#: A case of every kind; bare films have a patch besides.
CASES = {
    named(case).name: case | (READ if "thickness" in case and "air" not in case.values() else {})
    for case in BODIES.values()
}


def test_air_is_refused_by_the_rule_where_the_solver_refuses_it() -> None:
    refused = [
        case for message, case in REFUSED.items() if message.startswith(("surroundings: 'air'", "gap_radius: mi"))
    ]
    assert len(refused) == 5
    assert all(airless(case) for case in refused)
    assert all((airless(body) == "") == (not {*READ} & body.keys()) for body in CASES.values())
    assert airless({"profile": "cone", "slope": 0.1, "gap_radius": 1e-3}) == ""
    assert "electrode" in airless(CASES["film"] | {"electrode": "top"})


@pytest.mark.parametrize("name", CASES)
def test_a_body_answers_the_quantities_of_its_kind(name: str) -> None:
    options = {"magnetic": "conducting"} | ({"friction": 0.0} if "force" in CASES[name] else {})
    cases = Cases(checked(CASES[name] | options), {}, ("BaTiO3", "CoFe2O4"))
    followed = {FOLLOWS[peak].region for peak in cases.kind.peaks if peak in FOLLOWS}
    assert cases.kind.name == name
    assert not cases.kind.regions or followed <= set(cases.kind.regions) <= set(REGIONS)
    of_heat = HEAT_QUANTITIES.keys()  # which follow from a solved contact
    assert body_of(cases).quantities().keys() == cases.kind.quantities.keys() - of_heat
    assert float(cases.force) == CASES[name]["force" if "force" in CASES[name] else "load"]
    assert cases.charges.shape == (2,)
