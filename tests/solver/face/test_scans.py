"""No point inside a body, of a net or of the curves that peaks follow from, is above its peak; the highest is near."""

from typing import Any

import numpy as np
import pytest

import solver
from solver.arrays import Array
from solver.curves import FOLLOWS, REGIONS, described
from verification.cases import half_length

LINE: dict[str, Any] = {"radius": 0.05, "magnetic": "insulating"}
BALL: dict[str, Any] = {"profile": "sphere", "radius": 5e-3, "magnetic": "insulating"}
BARE, AIR = {"surroundings": "insulated"}, {"surroundings": "air"}
#: A film on a soft base bends it far from the contact; friction pulls its base there, its bottom beside the contact.
FILMS: dict[str, dict[str, Any]] = {
    "BaTiO3 on steel": LINE | BARE | {
        "material": "BaTiO3", "base": "steel", "thickness": 2e-4, "friction": 0.2, "load": 5e5
    },
    "AlN on polyimide": LINE | BARE | {
        "material": "AlN", "base": "polyimide", "thickness": 2e-6, "friction": 0.1, "load": 1e2, "radius": 1e-3
    },
    "in air": LINE | AIR | {"material": "PZT-4", "base": "steel", "thickness": 2e-4, "friction": 0.2, "load": 2e4},
    "ball": BALL | BARE | {"material": "BaTiO3", "base": "steel", "thickness": 1e-4, "friction": 0.3, "force": 10.0},
    "PVDF on polyimide": LINE | BARE | {
        "material": "PVDF", "base": "polyimide", "thickness": 5e-5, "friction": 0.3, "load": 1e3
    },
    "PZT-4 on steel": LINE | BARE | {
        "material": "PZT-4", "base": "steel", "thickness": 5e-3, "friction": 0.3, "load": 1e3
    },
    "ball in air": BALL | AIR | {"material": "BaTiO3", "base": "steel", "thickness": 1e-4, "force": 37.0},
}  # fmt: skip

#: Points across, thicknesses beside the contact, depths and what the net may miss, of what takes longer inside.
NETS = {"in air": (61, 60.0, 12, 0.05), "ball": (31, 3.0, 12, 0.05), "ball in air": (31, 3.0, 12, 0.05)}


def scanned(edge: float, count: int, farthest: float) -> Array:
    """X under the contact and beside it as far as many thicknesses, over h."""
    outside = 1 + np.geomspace(1e-3 * min(edge, 1.0), farthest * edge, count)
    return np.unique(np.concatenate([-outside, np.linspace(-0.999, 0.999, count), outside]))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", FILMS)
def test_films(name: str) -> None:
    """Bare lines to sixty thicknesses beside the contact, the others to three."""
    case = FILMS[name]
    count, farthest, layers, within = NETS.get(name, (161, 60.0, 24, 0.02))
    computed = solver.solve(case, peaks=True)
    h = float(computed["contact_radius"] if "contact_radius" in computed else half_length(computed))
    deep = case["thickness"]
    X = scanned(deep / h, count, farthest)
    on = solver.solve_interior(case, X, [-deep / h], fields=["stress_xy", "stress_yy"])
    largest = {"interface_shear": float(abs(on["stress_xy"]).max()), "interface_tension": float(on["stress_yy"].max())}
    for body, top, bottom in (("film", 0.1 * h, deep), ("base", deep * (1 + 1e-9), 4 * (deep + h))):
        fields = ["von_mises", "principal_tension"]
        inside = solver.solve_interior(case, X, -np.geomspace(top, bottom, layers) / h, fields=fields)
        largest |= {f"{body}_peak_{field}": float(inside[field].max()) for field in fields}
    for peak, value in largest.items():
        assert max(value, 0.0) <= float(computed[peak]) * (1 + 1e-7), peak
        least = 1e-6 * float(computed["interface_shear"])  # far away some pull is left of nothing
        # the net's points lie beside the top
        assert max(value, 0.0) >= float(computed[peak]) * (1 - within) - least, peak
    if name == "BaTiO3 on steel":  # six thicknesses beside the contact; -0.46 MPa where two half-lengths were searched
        assert float(computed["base_peak_principal_tension"]) == pytest.approx(20.96e6, rel=5e-4)
    place = float(computed["interface_shear_position"])
    stress = abs(float(solver.solve_interior(case, [place], [-deep / h], fields=["stress_xy"])["stress_xy"].squeeze()))
    assert stress == pytest.approx(float(computed["interface_shear"]), rel=1e-6)


def test_half_planes_in_air() -> None:
    """Charges beside a contact that slides lower its von Mises stress and move it; tension is at the least depth."""
    case = LINE | AIR | {"material": "BaTiO3", "friction": 0.05, "load": 2e4}
    computed, fields = solver.solve(case, peaks=True), ["von_mises", "principal_tension"]
    inside = solver.solve_interior(case, np.linspace(-3.0, 3.0, 121) * 1.001, -np.linspace(0.1, 1.2, 23), fields=fields)
    for name in fields:
        largest = float(inside[name].max())
        assert largest <= float(computed[f"peak_{name}"]) * (1 + 1e-9) < largest * 1.01, name
    bare = solver.solve(case | BARE, peaks=["peak_von_mises"])
    assert float(computed["peak_von_mises"]) < 0.999 * float(bare["peak_von_mises"])


HALF_PLANE: dict[str, Any] = {"volume_fraction": [0.2, 0.7], "friction": [0.0, 0.25], "radius": 0.05, "load": 1e5}
CURVED: dict[str, Any] = {
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
                                              (CURVED | {"base": "rigid"}, [n for n in FOLLOWS if n[0] in "fi"]),
                                              pytest.param(CURVED, [n for n in FOLLOWS if n[0] == "b"],
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
    rigid = solver.solve_curves(CURVED | {"base": "rigid"}, ["interface", "base"])
    assert set(rigid) & {*described("interface"), *described("base")} == set(described("interface"))
    with pytest.raises(solver.FactorError, match="regions: 'lid' is not one of body, interface, film, base"):
        solver.solve_curves(HALF_PLANE, ["lid"])
