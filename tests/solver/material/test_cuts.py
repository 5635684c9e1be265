"""Cuts of crystals: names, rotations, tensors, and the refusals of what contacts along a line cannot take."""

import re
from typing import Any

import numpy as np
import pytest

import solver
from solver.material.cuts import canonical, of_family, rotation, split
from tests.refusals import assert_refused


@pytest.mark.parametrize(
    ("cut", "normal"),
    [
        ("Z", (0, 0, 1)), ("X", (1, 0, 0)), ("Y", (0, 1, 0)), ("90Y", (0, 0, 1)), ("tilt 30 deg", (-0.5, 0, 0.75**0.5)),
        ("36Y", (0, np.cos(np.radians(36)), np.sin(np.radians(36)))),
        ("-20.5Y", (0, np.cos(np.radians(20.5)), -np.sin(np.radians(20.5)))),
    ],
)  # fmt: skip
def test_the_normal_of_a_named_cut(cut: str, normal: tuple[float, float, float]) -> None:
    np.testing.assert_allclose(rotation(cut)[2], normal, atol=1e-15)
    assert np.linalg.det(rotation(cut)) == pytest.approx(1, abs=1e-14)
    if match := re.fullmatch(r"(tilt )?(-?\d+\.?\d*)(?:Y| deg)", cut):
        family = of_family("tilt" if match[1] else "rotated Y", np.radians(float(match[2])))
        np.testing.assert_allclose(rotation(family), rotation(cut), atol=1e-14)


@pytest.mark.parametrize("cut", ["X", "Y", "Z", "128Y", "tilt 10 deg", "euler 10 20 30", "euler 0 180 40"])
def test_rows_of_a_rotation_become_euler_angles(cut: str) -> None:
    np.testing.assert_allclose(rotation(canonical(rotation(cut))), rotation(cut), atol=1e-14)


@pytest.mark.parametrize(
    ("cut", "words"),
    [
        ("37W", "unknown"), ([1, 2], "unknown"), ([[1, 0, 0], [0, 1, 0], [0, 0, 2]], "no rotation"),
        ([[1, 0, 0], [0, 1, 0], [0, 0, -1]], "no rotation"), ("euler 0 inf 0", "finite"), ({"a": 1}, "unknown"),
    ],
)  # fmt: skip
def test_what_is_no_rotation_is_refused_in_one_line(cut: Any, words: str) -> None:
    mapping = {"name": "tilted", "E": 2e11, "nu": 0.3, "cut": cut}
    assert_refused(solver.MaterialError, f"^tilted: cut: .*{words}", solver.Material.from_mapping, mapping)


def test_names_of_cuts_are_found() -> None:
    crystal = solver.find("36Y LiNbO3")
    assert (crystal.cut, crystal.name, crystal.axial) == ("36Y", "36Y LiNbO3", False)
    assert solver.find("tilt 10 deg AlN").cut == "tilt 10 deg"
    assert split("X quartz") == ("X", "quartz")
    assert split("LiNbO3") is None
    assert solver.Material.from_mapping(crystal.plain()).cut == "36Y"
    assert_refused(solver.MaterialError, "has a cut already", solver.find, "36Y X quartz")


@pytest.mark.parametrize("name", ["LiNbO3", "LiTaO3", "quartz", "langasite"])
def test_the_energy_of_a_crystal_is_positive_and_symmetric(name: str) -> None:
    tensor = solver.find(name).stiffness_tensor("36Y")
    np.testing.assert_allclose(tensor, tensor.transpose(3, 2, 1, 0), rtol=0, atol=1e-15 * np.max(np.abs(tensor)))
    elastic = tensor[:, :3, :3].reshape(9, 9)
    assert np.linalg.eigvalsh(elastic)[3:].min() > 1e9  # rotations alone have no energy
    assert np.linalg.eigvalsh(-tensor[:, 3, 3]).min() > 0


LINE: dict[str, Any] = {"radius": 0.05, "load": 1e4}
STACK = solver.Stack([solver.Layer("X quartz", 1e-4)], "rigid")


@pytest.mark.parametrize(
    "body",
    [
        {"material": "36Y LiNbO3"}, {"material": "quartz"}, {"body": STACK},
        {"material": "PZT-4", "thickness": 1e-4, "base": "X quartz"},
    ],
)  # fmt: skip
def test_contacts_along_a_line_refuse_a_cut(body: dict[str, Any]) -> None:
    kinds = (solver.MaterialError, solver.FactorError)
    assert_refused(kinds, "contacts in space alone", solver.solve, LINE | body)
