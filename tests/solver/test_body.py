"""Kinds of bodies: told by factors, split by the face, and each answered by what it says it has."""

import numpy as np
import pytest
import xarray as xr

import solver
from solver.body import FILM, FILM_IN_AIR, HALF_PLANE, HALF_PLANE_IN_AIR, KINDS, airless, kind_of
from solver.curves import FOLLOWS, REGIONS
from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.filmfactors import kinds_of
from solver.face.solution import body_of
from solver.names import ALL_PEAKS, ALL_QUANTITIES, CONTACTS, FACTORS, HEAT_QUANTITIES, PROFILES
from tests.solver.face.test_refused import REFUSED
from tests.solver.test_contract import BODIES
from tests.solver.test_contract import kind as named

READ = {"collector": 1, "patch_size": 1e-4, "patch_pitch": 2e-4}
#: A case of every kind; bare films have a patch besides.
CASES = {
    named(case).name: case | (READ if "thickness" in case and "air" not in case.values() else {})
    for case in BODIES.values()
}


@pytest.mark.parametrize("profile", PROFILES)
def test_a_profile_says_which_contact_a_case_is_and_a_thickness_which_body(profile: str) -> None:
    assert kind_of(("load", "radius"), profile).contact == PROFILES[profile].contact
    assert kind_of(("thickness",), profile).layered
    assert kind_of(("body",)) is FILM
    assert kind_of(("body",), surroundings="air") is FILM_IN_AIR
    assert kind_of((), solver.Profile.cylinder(np.array(0.05))) is HALF_PLANE


def test_cases_of_a_table_are_told_apart_one_by_one() -> None:
    arrays = {"thickness": xr.DataArray([np.nan, 5e-4], dims="case"), "base": xr.DataArray(["", "steel"], dims="case")}
    assert kinds_of(arrays).values.tolist() == ["half-plane", "film"]
    air = {"surroundings": xr.DataArray(["air", "insulated"], dims="case")}
    assert kinds_of(arrays | air).values.tolist() == [HALF_PLANE_IN_AIR.name, "film"]


def test_air_is_refused_by_the_rule_where_the_solver_refuses_it() -> None:
    refused = [
        case for message, case in REFUSED.items() if message.startswith(("surroundings: 'air'", "gap_radius: mi"))
    ]
    assert len(refused) == 5
    assert all(airless(case) for case in refused)
    assert all((airless(body) == "") == (not {*READ} & body.keys()) for body in CASES.values())
    assert airless({"profile": "cone", "slope": 0.1, "gap_radius": 1e-3}) == ""
    assert "electrode" in airless(CASES["film"] | {"electrode": "top"})


def test_every_kind_names_what_exists() -> None:
    for kind in KINDS.values():
        assert kind.every_quantity.keys() <= ALL_QUANTITIES.keys()
        assert set(kind.peaks) <= set(ALL_PEAKS)
        assert {kind.loads.force, *kind.loads.charges} <= FACTORS.keys()
        assert set(kind.tabled) <= FACTORS.keys()
        followed = {FOLLOWS[name].region for name in kind.peaks if name in FOLLOWS}
        assert not kind.regions or followed <= set(kind.regions) <= set(REGIONS)
        assert kind.contact in CONTACTS


@pytest.mark.parametrize("name", CASES)
def test_a_body_answers_the_quantities_of_its_kind(name: str) -> None:
    options = {"magnetic": "conducting"} | ({"friction": 0.0} if "force" in CASES[name] else {})
    cases = Cases(checked(CASES[name] | options), {}, ("BaTiO3", "CoFe2O4"))
    assert cases.kind.name == name
    of_heat = HEAT_QUANTITIES.keys()  # which follow from a solved contact
    assert body_of(cases).quantities().keys() == cases.kind.quantities.keys() - of_heat
    assert float(cases.force) == CASES[name]["force" if "force" in CASES[name] else "load"]
    assert cases.charges.shape == (2,)
