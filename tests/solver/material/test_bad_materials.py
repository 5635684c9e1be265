"""Malformed and inadmissible materials: an error that names the constant, its value, the condition, the likely fix."""

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import solver
from solver.material.constants import UNITS

TITANATE: dict[str, float] = {
    "c11": 166e9,
    "c12": 77e9,
    "c13": 78e9,
    "c33": 162e9,
    "c44": 43e9,
    "e31": -4.4,
    "e33": 18.6,
}
TITANATE |= {"e15": 11.6, "eps11": 11.2e-9, "eps33": 12.6e-9, "mu11": 5e-6, "mu33": 10e-6, "rho": 5800.0}
FERRITE: dict[str, float] = {"c11": 286e9, "c12": 173e9, "c13": 170.5e9, "c33": 269.5e9, "c44": 45.3e9, "f31": 580.3}
FERRITE |= {"f33": 699.7, "f15": 550.0, "eps11": 0.08e-9, "eps33": 0.093e-9, "mu11": 590e-6, "mu33": 157e-6}
CONTACT = {"radius": 0.05, "load": 1e5}


def material(entries: dict[str, float], name: str = "mine") -> solver.Material:
    """Built without the check of ``from_mapping``."""
    constants: dict[str, Any] = {key: np.array(value) for key, value in entries.items()}
    return solver.Material(**constants, name=name)


FIBRES, HOST = solver.find("BaTiO3"), solver.find("CoFe2O4")
LACKING = {name: value for name, value in TITANATE.items() if name != "c12"}
MIXTURES = (solver.fibrous, solver.laminate)
STIFF = {name: value for name, value in TITANATE.items() if name != "c33"}
MALFORMED: tuple[object, ...] = ("166e9", None, True, [166e9, 167e9], {})
#: Words of the refusal, and what is refused with them; the words are quoted as they stand.
REFUSED: list[tuple[str, Callable[[], object]]] = [
    *((f"{name}: {value} is not a finite number", lambda name=name, value=value: read({name: value}))
      for name, value in (("c11", np.nan), ("e31", np.inf), ("eps33", np.nan), ("mu11", np.inf), ("g33", np.nan))),
    *((f"{name}: ", lambda name=name: pressed({name: np.nan})) for name in ("c11", "e31", "eps33", "mu11", "g33")),
    *((repr(value), lambda value=value: read({"c11": value})) for value in MALFORMED),
    ("c11: ", lambda: read({"c11": 10**400})),
    ("mine: e13: unknown entry; ", lambda: read({"e13": -4.4})),
    ("c33: missing", lambda: solver.Material.from_mapping(STIFF)),
    ("arrays", lambda: solver.solve({"material": solver.fibrous(FIBRES, HOST, [0.2, 0.4]), **CONTACT})),
    *((f"volume_fraction: {value:g} is not", lambda mix=mix, value=value: mix(FIBRES, HOST, [0.5, value]))
      for mix in MIXTURES for value in (-0.1, 1.5, np.nan)),
    *((f"scandium_fraction: {value:g} is not within 0 to 0.5",
       lambda value=value: solver.aluminium_scandium_nitride([0.2, value])) for value in (-0.01, 0.51, np.nan)),
    ("mine: c12: missing", lambda: solver.fibrous(material(LACKING), HOST, 0.5)),
    *(("isotropic: ", lambda young=young, poisson=poisson: solver.Material.isotropic(young, poisson))
      for young, poisson in ((2e11, -1.0), (2e11, 0.6), (2e11, 0.5), (-1.0, 0.3), (0.0, 0.3), (np.nan, 0.3))),
]  # fmt: skip


def read(change: dict[str, Any]) -> solver.Material:
    return solver.Material.from_mapping({"name": "mine", **TITANATE, **change})


def pressed(change: dict[str, float]) -> object:
    return solver.solve({"material": material(TITANATE | change), **CONTACT})


@pytest.mark.parametrize(("words", "attempt"), REFUSED)
def test_refused(words: str, attempt: Callable[[], object]) -> None:
    with pytest.raises((solver.MaterialError, solver.FactorError)) as caught:
        attempt()
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"c11": -166e9}, ["c11 = -1.66e+11 Pa", "positive"]),
        ({"c33": 0.0}, ["c33 = 0 Pa", "positive"]),
        ({"c44": -1.0}, ["c44 = -1 Pa", "positive"]),
        ({"c13": 165e9}, ["c13 = 1.65e+11 Pa", "c13^2 < c11 c33"]),
        ({"c13": -165e9}, ["c13 = -1.65e+11 Pa", "c13^2 < c11 c33"]),
        ({"c13": 145e9}, ["c13 = 1.45e+11 Pa", "2 c13^2 < (c11 + c12) c33"]),
        ({"c12": 170e9}, ["c12 = 1.7e+11 Pa", "|c12| < c11"]),
        ({"eps11": -11.2e-9}, ["eps11 = -1.12e-08 F m-1", "positive"]),
        ({"eps33": 0.0}, ["eps33 = 0 F m-1", "positive"]),
        ({"mu33": -1e-6}, ["mu33 = -1e-06 N s2 C-2", "positive"]),
        ({"mu11": -590e-6}, ["mu11 = -0.00059 N s2 C-2", "positive", "mu11 = +590e-6", "wrong sign"]),
        ({"g11": 3e-7}, ["g11 = 3e-07 N s V-1 C-1", "g11^2 < eps11 mu11"]),
        ({"g33": -4e-7}, ["g33 = -4e-07 N s V-1 C-1", "g33^2 < eps33 mu33"]),
        ({"rho": 0.0}, ["rho = 0 kg m-3", "positive"]),
    ],
)
def test_inadmissible(change: dict[str, float], words: list[str]) -> None:
    entries = TITANATE | change
    with pytest.raises(solver.MaterialError) as from_mapping:
        solver.Material.from_mapping({"name": "mine", **entries})
    with pytest.raises(solver.MaterialError) as from_solve:
        solver.solve({"material": material(entries), **CONTACT})
    for word in ["mine: ", *words]:
        assert word in str(from_mapping.value)
        assert word in str(from_solve.value)


@pytest.mark.parametrize("mix", [solver.fibrous, solver.laminate])
@pytest.mark.parametrize("fraction", [0.0, 0.5, 0.999])
def test_composites_of_the_ferrite_as_published_are_refused_with_the_fix(mix: Any, fraction: float) -> None:
    """The mean of mu11 is positive at high fractions of titanate, so the phase itself is checked."""
    published = material(FERRITE | {"mu11": -590e-6}, "CoFe2O4 as published")
    with pytest.raises(solver.MaterialError, match=r"CoFe2O4 as published.*mu11 = .*use mu11 = \+590e-6"):
        mix(solver.find("BaTiO3"), published, fraction)


@pytest.mark.parametrize("name", ["c11", "c33", "eps11", "mu33"])
def test_constants_near_the_end_of_the_range_of_numbers_warn_of_nothing(name: str) -> None:
    constants = {"c11": 2.7e11, "c12": 1.2e11, "c13": 1.2e11, "c33": 2.7e11, "c44": 7.7e10, "eps11": 1e-8, "mu33": 1e-5}
    material = solver.Material.from_mapping(
        {"name": "mine", **constants, name: f"1.7976931348623157e308 {UNITS[name]}"}
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        material.check()  # admissible by the inequalities, whatever their products come to


#: Off-diagonal constants, and the two whose product bounds the square of each.
BOUNDED = {"c13": ("c11", "c33"), "c12": ("c11", "c11"), "g11": ("eps11", "mu11"), "g33": ("eps33", "mu33")}


@pytest.mark.parametrize("name", sorted(BOUNDED))
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_constant_is_accepted_just_within_its_bound_and_refused_just_beyond(name: str, sign: int) -> None:
    c = {"c11": 2e11, "c13": 0.0, "c33": 1.5e11, "c44": 5e10}
    c |= {"eps11": 5e-9, "eps33": 7e-9, "mu11": 1e-4, "mu33": 3e-4}
    first, second = BOUNDED[name]
    bound = sign * (c[first] * c[second]) ** 0.5
    solver.Material.from_mapping(c | {name: bound * (1 - 1e-12)})
    with pytest.raises(solver.MaterialError, match=f"{name} = "):
        solver.Material.from_mapping(c | {name: bound * (1 + 1e-12)})


def test_one_bad_case_of_many_is_named() -> None:
    steel, rubber = solver.find("steel"), solver.Material.isotropic(1e6, 0.45, name="rubber")
    broken = solver.Material(
        c11=np.array(1e9), c13=np.array(2e9), c33=np.array(1e9), c44=np.array(1e9), name="broken"
    )  # fmt: skip
    with pytest.raises(solver.MaterialError, match="broken: c13"):
        solver.solve({"material": [steel, broken, rubber], "radius": 0.1, "load": 1.0})
