"""Kinds of bodies: told by factors, split by the face, and each answered by what it says it has."""

import numpy as np
import pytest
import xarray as xr

import solver
from solver.body import (
    FILM,
    FILM_IN_AIR,
    HALF_PLANE,
    HALF_PLANE_IN_AIR,
    HALF_SPACE,
    HALF_SPACE_IN_AIR,
    KINDS,
    POINT_FILM,
    POINT_FILM_IN_AIR,
    Kind,
    airless,
    kind_of,
)
from solver.curves import FOLLOWS, REGIONS
from solver.face.bodies import body_of
from solver.face.cases import Cases
from solver.face.factors import checked
from solver.face.filmfactors import kinds_of
from solver.names import ALL_PEAKS, ALL_QUANTITIES, CONTACTS, FACTORS, PROFILES

READ = {"collector": 1, "patch_size": 1e-4, "patch_pitch": 2e-4}
CASES = {
    HALF_PLANE.name: {"material": "PZT-4", "radius": 0.05, "load": 1e5},
    FILM.name: {"material": "PZT-4", "radius": 0.05, "load": 1e5, "thickness": 5e-4, "base": "steel", **READ},
    HALF_PLANE_IN_AIR.name: {"material": "PZT-4", "radius": 0.05, "load": 1e5, "surroundings": "air"},
    FILM_IN_AIR.name: {
        "material": "PZT-4", "radius": 0.05, "load": 1e5, "surroundings": "air", "thickness": 5e-4, "base": "steel",
    },
    HALF_SPACE.name: {"material": "PZT-4", "profile": "sphere", "radius": 0.05, "force": 1e5, "friction": 0.0},
    POINT_FILM.name: {
        "material": "PZT-4", "profile": "sphere", "radius": 0.05, "force": 1e5, "friction": 0.0,
        "thickness": 5e-4, "base": "steel",
        **READ,
    },
}  # fmt: skip
CASES |= {
    HALF_SPACE_IN_AIR.name: CASES[HALF_SPACE.name] | {"surroundings": "air"},
    POINT_FILM_IN_AIR.name: {name: first for name, first in CASES[POINT_FILM.name].items() if name not in READ}
    | {"surroundings": "air"},
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


@pytest.mark.parametrize(
    "own",
    [
        {"electric": "insulating", "magnetic": "insulating"},
        {"electrode": "top"},
        {"profile": "flat", "width": 1e-3},
        {"profile": "disc", "width": 1e-3},
        {"profile": "cone", "slope": 0.1},
        {"composite": "fibrous", "volume_fraction": 0.5, "base_volume_fraction": 0.2},
    ],
)
def test_where_air_cannot_be_the_solver_refuses_it(own: dict[str, object]) -> None:
    case = {name: value for name, value in CASES[FILM.name].items() if name not in READ} | own | {"surroundings": "air"}
    if PROFILES[str(own.get("profile", "cylinder"))].contact == "point":
        case["force"] = case.pop("load")
    dropped = {"flat": "radius", "disc": "radius", "cone": "radius"}.get(str(own.get("profile"))) or "material" * (
        "composite" in own
    )
    case.pop(dropped, None)
    assert airless(case)
    with pytest.raises((solver.FactorError, solver.MaterialError), match=r"surroundings|gap_radius"):
        solver.solve(case)
    assert all((airless(first) == "") == (not {*READ} & first.keys()) for first in CASES.values())
    assert airless({"profile": "cone", "slope": 0.1, "gap_radius": 1e-3}) == ""


def test_every_kind_names_what_exists() -> None:
    for kind in KINDS.values():
        assert kind.every_quantity.keys() <= ALL_QUANTITIES.keys()
        assert set(kind.peaks) <= set(ALL_PEAKS)
        assert {kind.loads.force, *kind.loads.charges} <= FACTORS.keys()
        assert set(kind.tabled) <= FACTORS.keys()
        followed = {FOLLOWS[name].region for name in kind.peaks if name in FOLLOWS}
        assert not kind.regions or followed <= set(kind.regions) <= set(REGIONS)
        assert kind.contact in CONTACTS


@pytest.mark.parametrize("kind", KINDS.values(), ids=lambda kind: kind.name)
def test_a_body_answers_what_its_kind_says_it_has(kind: Kind) -> None:
    cases = Cases(checked(CASES[kind.name]), {}, ("BaTiO3", "CoFe2O4"))
    assert cases.kind is kind
    body = body_of(cases)
    assert body.quantities().keys() == kind.quantities.keys()
    assert float(cases.force) == 1e5
    assert cases.charges.shape == (2,)
