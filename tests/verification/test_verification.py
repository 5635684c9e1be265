"""Every check of the verification page is green; and a wrong answer would not be."""

import json
from dataclasses import replace
from functools import cache
from itertools import product
from types import ModuleType
from typing import Any
from unittest import mock

import numpy as np
import pytest

import solver
from verification import GROUPS, Findings, Sizes, digits, film_elements, integral_equations, limits, points
from verification.cases import SIH_SONG, constants
from verification.findings import check
from verification.oracles.fem_film import Layer
from verification.oracles.fem_point import PointContact
from verification.oracles.surface_response import surface_response
from workflow.run.provenance import ROOT
from workflow.study.sections import CHECK_GROUPS

HALF_PLANE = "half-plane, as a film on its material"
SMALL = Sizes(cases=2, elements=12, timed=0)

#: Of groups of many cases, a few: `make soak` and `make run STUDY=verification` take all of them.
FEW: dict[str, tuple[ModuleType, dict[str, tuple[object, ...]]]] = {
    "digits": (digits, {"EXTREMES": ("coalescing roots",)}),
    "film_air": (film_elements, {"AIR_CASES": ("PZT-4 on steel, air",)}),
    "film_elements": (film_elements, {"CASES": (HALF_PLANE, "BaTiO3 on CoFe2O4 on a rigid base")}),
    "integral_equations": (integral_equations, {"PUNCHES": ("cylinder", "tilted flat")}),
    "points": (points, {"_BASES": ("rigid",), "SLIDING": ("half-space",)}),
}  # fmt: skip


@cache
def findings(group: str, whole: bool) -> Findings:
    if whole or group not in FEW:
        return GROUPS[group](SMALL)
    module, selection = FEW[group]
    few: dict[str, Any] = {name: {key: getattr(module, name)[key] for key in keys} for name, keys in selection.items()}
    with mock.patch.multiple(module, **few):
        return GROUPS[group](SMALL)


def test_the_study_knows_the_groups() -> None:
    assert tuple(GROUPS) == CHECK_GROUPS


@pytest.mark.parametrize(
    ("group", "whole"),
    [*product(GROUPS, [False]), *(pytest.param(group_name, True, marks=pytest.mark.soak) for group_name in FEW)],
)
def test_every_check_is_green(group: str, *, whole: bool) -> None:
    checks = findings(group, whole).checks
    red = [f"{result.name}: {result.error:.2e} > {result.tolerance:.0e}" for result in checks if not result.passed]
    assert not red
    assert len({result.name for result in checks}) == len(checks)


def test_finite_elements_of_points_converge_and_a_wrong_answer_is_red(monkeypatch: pytest.MonkeyPatch) -> None:
    """A stiffness of the film that is off by 1 % is seen by them."""
    for curve in findings("points", False).curves:
        assert curve.error[-1] < curve.error[0] / 100
    stiffer = constants(solver.find("PZT-4")) | {"c33": 1.01 * float(solver.find("PZT-4").c33)}
    monkeypatch.setattr(points, "constants", lambda _: stiffer)
    assert points.elements("rigid", 6) > 1e-3


def test_collocation_of_the_circle_converges_geometrically_to_the_closed_form() -> None:
    curves = {curve.figure: curve for curve in findings("integral_equations", False).curves}
    curve = curves["collocation_circle"]
    assert all(fine < coarse / 10 for coarse, fine in zip(curve.error, curve.error[1:], strict=False))


def test_a_wrong_coupling_turns_the_checks_red(monkeypatch: pytest.MonkeyPatch) -> None:
    m = constants(solver.find(SIH_SONG))
    other = surface_response(m | {"f31": 1.001 * m["f31"]})
    assert integral_equations.error("cylinder", (1, 2), 8, other) > 1e-5
    case = film_elements.CASES["BaTiO3 on a rigid base"]
    monkeypatch.setattr(film_elements, "constants", lambda material: constants(material) | {"e33": 18.8})
    assert film_elements.Compared(case, solver.solve(case), 4).error("response") > 5e-3
    monkeypatch.setattr(limits, "STEEL", (200e9, 0.31))
    monkeypatch.setattr(solver.Material, "isotropic", lambda *_: solver.find("steel"))
    assert limits.hertz() > 1e-3


def test_what_is_no_number_is_red() -> None:
    result = check("nothing", "nothing", 1.0, lambda: float(np.nan))
    assert not result.passed
    text = replace(findings("limits", False), checks=[result]).to_json()
    assert json.loads(text)["checks"][0] == {
        "name": "nothing", "compared": "nothing", "error": None, "tolerance": 1.0, "seconds": result.seconds,
        "passed": False,
    }  # fmt: skip


BTO = solver.find("BaTiO3")
LAYER = Layer(constants(BTO) | {"c12": float(BTO.c12)}, 1e-4)
SPHERE, RADIUS = 5e-3, 1e-4


def test_elements_of_order_two_are_as_good_as_the_page_on_other_codes_says() -> None:
    idle, charged = (PointContact([LAYER], None, SPHERE, RADIUS, T, air=False, order=2) for T in (0.0, 1e-9))
    share = idle.voltage / (idle.voltage - charged.voltage)  # of the charge that leaves zero volts
    charge_per_force = abs(share * 1e-9 / ((1 - share) * idle.force + share * charged.force))
    assert abs(charge_per_force / 142.205125e-12 - 1) == pytest.approx(1e-3, rel=0.2)
    page = " ".join((ROOT / "docs/others.md").read_text(encoding="utf-8").split())
    assert f"reach 1e-3 with {4 * len(idle.body.places):,} unknowns of order 2" in page
    assert "142.205125 pC/N" in page
