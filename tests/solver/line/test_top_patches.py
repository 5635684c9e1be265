"""Patches of an electrode on top: what they add up to, reciprocity, and the limit of a cover that grows thin."""

from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

import solver
from solver.arrays import Array
from solver.stack.electroded import beyond_local, local
from solver.stack.electrodes import Electrode, electrodes
from solver.stack.layers import Layer, Stack
from tests.solver.line.films import BTO, FIBROUS, SILICON

PZT, COPPER = solver.find("PZT-4"), solver.find("copper")
BALL: dict[str, Any] = {"profile": "sphere", "radius": 0.01, "force": 2.0, "magnetic": "insulating"}
CONE: dict[str, Any] = {"profile": "cone", "slope": 0.05, "force": 2.0, "magnetic": "insulating"}
DISC: dict[str, Any] = {"profile": "disc", "width": 2e-4, "force": 2.0, "magnetic": "insulating"}
ROLLER: dict[str, Any] = {"radius": 0.05, "load": 2e4, "friction": 0.3, "datum": 0.1, "magnetic": "insulating"}
TOP = {"electrode": "top", "collector": 1}


def charge(factors: dict[str, Any], name: str = "patch_charge_per_force") -> Array:
    return np.asarray(solver.solve(factors)[name].values)


@pytest.mark.parametrize(
    ("punch", "patch"),
    [(ROLLER, {}), (BALL, {}), (DISC, {"patch": "strip"}), (CONE, {})],
    ids=["roller", "ball", "disc", "cone"],
)
def test_a_patch_that_covers_all_has_the_charge_of_the_electrode(punch: dict[str, Any], patch: dict[str, Any]) -> None:
    """e33/c33 in closed form, of what is local and of waves together; magnetoelectric under a magnetic punch too."""
    for film, magnetic in ((PZT, {}), (FIBROUS, {"magnetic": "conducting"})):
        case = punch | TOP | magnetic | patch | {"body": Stack([Layer(film, 2e-4)]), "patch_size": 0.05}
        solution = solver.solve(case)
        whole = float(solution["electrode_charge_per_force"])
        assert float(solution["patch_charge_per_force"]) == pytest.approx(whole, rel=1e-10)
        if not magnetic:
            assert whole == pytest.approx(float(film.e33 / film.c33), rel=1e-12)


@pytest.mark.parametrize("punch", [ROLLER, BALL, DISC], ids=["roller", "ball", "disc"])
def test_patches_side_by_side_are_one_and_have_its_gradient(punch: dict[str, Any]) -> None:
    case = punch | TOP | {"body": Stack([Layer(PZT, 2e-4)], SILICON), "patch": "strip"}
    width = 5e-5
    parts = charge(case | {"patch_size": width, "patch_position": width * np.arange(-10, 11)})
    assert np.sum(parts) == pytest.approx(float(charge(case | {"patch_size": 21 * width})), rel=1e-10)
    step, pitch = 1e-8, 1.3e-4
    solution = solver.solve(case | {"patch_size": 1e-4, "patch_pitch": pitch})
    near = charge(case | {"patch_size": 1e-4, "patch_position": [0.0, pitch, pitch / 2 - step, pitch / 2 + step]})
    assert float(solution["crosstalk"]) == pytest.approx(near[1] / near[0], rel=1e-12)
    assert float(solution["patch_charge_gradient"]) == pytest.approx((near[2] - near[3]) / step, rel=1e-5)


def test_the_charge_is_reciprocal_to_what_its_voltage_moves() -> None:
    """u_y of the surface per phi of the electrode on it, by matrix exponentials of each layer."""
    body = Stack([Layer(BTO, 1e-4), Layer(FIBROUS, 2e-4)], SILICON, electroded=True)
    k = np.array([1e3, 3e3, 1e4])
    rows = local(body) + beyond_local(body, k)
    assert body.base_medium is not None
    for wave, row in zip(k, rows, strict=True):
        columns = np.concatenate([body.base_medium.compliance, np.eye(4)])
        grounded, columns = columns[2].copy(), np.concatenate([columns, np.eye(8)[:, [6]]], 1)
        grounded = np.append(grounded, 0.0)
        for layer, medium in zip(body.layers[::-1], body.media[::-1], strict=True):
            columns = expm(wave * layer.thickness * medium.system) @ columns
        # no stress and no B on top, phi of one there, and of zero at the electrode on the base
        moved = columns[1] @ np.linalg.solve([*columns[[4, 5, 7]], columns[2], grounded], np.eye(5)[3])
        assert abs(moved) > 1e-3
        assert moved == pytest.approx(row[1], rel=1e-8)


@pytest.mark.parametrize(("punch", "patch"), [(ROLLER, {}), (BALL, {"patch": "disc"})], ids=["strips", "discs"])
def test_a_cover_that_grows_thin_leads_there(punch: dict[str, Any], patch: dict[str, Any]) -> None:
    """Electrodes below 4 and 2 um of the same film, whose charge comes by waves alone, on a line to no cover at all."""
    read = punch | patch | {"collector": 1, "patch_size": 1e-4, "patch_position": np.array([-1e-4, 3e-5, 1.2e-4, 2e-4])}
    covered = [
        charge(read | {"electric": "insulating", "body": Stack([Layer(PZT, t, "grounded"), Layer(PZT, 2e-4)], SILICON)})
        for t in (4e-6, 2e-6)
    ]
    charges = charge(read | TOP | {"body": Stack([Layer(PZT, 2e-4)], SILICON)})
    size = np.max(np.abs(charges))
    assert np.max(np.abs(covered[1] - charges)) > 5e-3 * size  # that far away is the thinner one
    np.testing.assert_allclose(2 * covered[1] - covered[0], charges, atol=5e-3 * size)


def test_a_metal_on_top_is_the_electrode_that_is_asked_for_there() -> None:
    body = Stack([Layer(COPPER, 1e-5), Layer(PZT, 1e-4)], SILICON)
    assert electrodes(Stack(body.layers, SILICON, electroded=True)) == electrodes(body) == [(0,), (1,)]
    assert not Electrode(body, 1).on_top
    read = BALL | {"force": 0.1, "collector": 1, "patch_size": 1e-3, "body": body}
    assert charge(read | {"electrode": "top"}) == pytest.approx(charge(read), rel=1e-9)
