"""Curves that peaks follow from: their measures are the stresses' own, their largest values the peaks of the search."""

from typing import Any

import numpy as np
import pytest

import solver
from solver.curves import FOLLOWS, REGIONS, described

HALF_PLANE: dict[str, Any] = {"volume_fraction": [0.2, 0.7], "friction": [0.0, 0.25], "radius": 0.05, "load": 1e5}
FILM: dict[str, Any] = {
    "volume_fraction": 0.5, "friction": 0.3, "thickness": 2e-4, "surroundings": "insulated",
    "base": "steel", "radius": 0.05, "load": 1e5,
    "charge": 2e-6,
}  # fmt: skip


def test_curves_are_the_fields_inside_at_their_points() -> None:
    """One case, every point of the panels: solve_interior shares only the formula of the fields."""
    case = HALF_PLANE | {"volume_fraction": 0.7, "friction": 0.25, "charge": 1e-6}
    curves = solver.solve_curves(case, ["body"])
    half = curves["half_length"].item()
    across, _ = REGIONS["body"].lines()
    X = np.where(np.abs(across) < 1, across, np.sign(across) * (1 + (np.abs(across) - 1) / (2 - np.abs(across))))
    y = -np.unique(curves["body_depth"]) / half
    assert y[[-1, 0]] == pytest.approx([-2.0, -0.1], abs=0.03)
    inside = solver.solve_interior(case, X, y, fields=REGIONS["body"].fields[:4])
    for name in REGIONS["body"].fields[:4]:
        whole = REGIONS["body"].panels.by_panel(inside[name].transpose("y", "x").values)
        assert curves[f"body_{name}"].values == pytest.approx(whole, rel=1e-9, abs=1e-9 * np.abs(whole).max())


@pytest.mark.parametrize(("case", "names"), [(HALF_PLANE, [n for n in FOLLOWS if n.startswith("peak")]),
                                              (FILM | {"base": "rigid"}, [n for n in FOLLOWS if n[0] in "fi"]),
                                              pytest.param(FILM, [n for n in FOLLOWS if n[0] == "b"],
                                                           marks=pytest.mark.soak)])  # fmt: skip
def test_largest_values_at_the_points_are_next_to_the_peaks(case: dict[str, Any], names: list[str]) -> None:
    """Points lie up to a tenth of a panel beside a maximum, and none is higher than the exact one."""
    curves, exact = solver.solve_curves(case), solver.solve(case, peaks=names)
    for name in names:
        peak = FOLLOWS[name]
        if peak.place:
            continue
        within = list(described(peak.region))[: len(peak.measure.linear[0])]
        largest = peak.measure.of(np.stack([curves[field].values for field in within], -1)).max(-1)
        true = exact[name].broadcast_like(curves[within[0]].isel({f"{peak.region}_point": 0}, drop=True)).values
        room = 1e-4 * true.max()
        assert (largest <= true * (1 + 2e-4) + room).all(), name
        assert (largest >= 0.9 * true - room).all(), name


def test_regions_are_those_of_the_case() -> None:
    rigid = solver.solve_curves(FILM | {"base": "rigid"}, ["interface", "base"])
    assert set(rigid) & {*described("interface"), *described("base")} == set(described("interface"))
    with pytest.raises(solver.FactorError, match="regions: 'lid' is not one of body, interface, film, base"):
        solver.solve_curves(HALF_PLANE, ["lid"])
