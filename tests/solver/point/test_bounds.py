"""Memory of point contacts is bounded by blocks, which change no answer; refusals come before the work."""

from typing import Any

import numpy as np
import pytest

import solver
from solver.point import electrodes, inside, sliding, slidingtable
from solver.stack.layers import Layer, Stack

BALL: dict[str, Any] = {"profile": "sphere", "radius": 5e-3, "friction": 0.2, "magnetic": "insulating"}
FILM: dict[str, Any] = BALL | {"material": "BaTiO3", "thickness": 1e-4, "surroundings": "insulated", "base": "steel"}
BODY = Stack([Layer(solver.find("glass"), 1e-4, "grounded"), Layer(solver.find("BaTiO3"), 1e-4)])


def answers() -> list[np.ndarray]:
    """Fields near the surface and deep, and charges of patches, of several cases."""
    x, y = [-1.2, 0.3, 0.8], [0.0, -1e-3, -0.02, -0.4, -1.5]
    fields = solver.solve_interior(FILM | {"force": [1.0, 2.0, 5.0]}, x, y, fields=["stress_xx", "electric_field_y"])
    patch = {"collector": 2, "patch_size": 2e-4, "patch_position": [5e-5, -1e-4], "patch_pitch": 3e-4}
    read = solver.solve(BALL | {"force": [1.0, 2.0], "body": BODY} | patch)
    names = ("patch_charge_per_force", "crosstalk", "patch_charge_gradient", "electrode_pressure")
    return [fields[name].values for name in fields.data_vars] + [read[name].values for name in names]


def test_blocks_of_any_size_give_the_same_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = answers()
    monkeypatch.setattr(electrodes, "_VALUES_AT_ONCE", 5000)
    for name, size in (("_ENTRIES", 512), ("_PLACES", 2), ("_COLUMNS", 2)):
        monkeypatch.setattr(inside, name, size)
    for small, large in zip(answers(), whole, strict=True):
        np.testing.assert_allclose(small, large, rtol=0, atol=1e-11 * float(np.abs(large).max()))


def test_peaks_of_too_wide_a_contact_are_refused_before_friction_is_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    def solved(*_: object) -> None:
        raise AssertionError("friction was solved for a case that is refused")

    monkeypatch.setattr(slidingtable.SlidingWindow, "_solved", property(solved))
    monkeypatch.setattr(sliding.Rubbed, "_added", property(solved))
    case = FILM | {"profile": "disc", "width": 3e-3, "force": 1.0}
    with pytest.raises(solver.FactorError, match=r"^contact: radius over thickness 15 is too wide for peaks"):
        solver.solve({name: value for name, value in case.items() if name != "radius"}, peaks=["film_peak_von_mises"])
