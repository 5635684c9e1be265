"""Effects of contacts in space: maps on one window, random surfaces, and the charge over the angle of a cut."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from solver.body import KINDS
from tests.studies import edited, made, refusal
from workflow.dataset.effects import maps, spread
from workflow.report import device, firstscreen
from workflow.report.figures import contact_maps, style
from workflow.report.svg import element

ROUGH = """\
title: Rough
effects:
  baseline:
    {material: PZT-4, profile: rough_sphere, radius: 20 mm, roughness: 10 nm, force: 200 mN,
     longest_wavelength: 100 um, shortest_wavelength: 30 um, grid_error: 0.1}
  realisations: 2
  positions: {inside: 10, outside: 10}
  vary: {force: [0.1, 0.4]}
"""


def test_random_surfaces_are_solved_each_and_drawn_with_their_band() -> None:
    data = spread(made(ROUGH), "force")
    each = data["peak_pressure"].transpose("force", "realisation")
    assert each.shape == (2, 2)
    # 1.8 and 8.3 % on grids of 0.005 as well
    np.testing.assert_allclose(np.ptp(each.values, axis=1) / each.values.mean(1), [0.018, 0.083], rtol=0.1)
    figure = contact_maps.spread(data)
    assert [ax.get_ylabel() for ax in figure.axes if ax.get_visible()] == [
        "contact pressure [MPa]", "charge per force [pC/N]", "depth [nm]",
    ]  # fmt: skip


def test_maps_share_a_window_that_holds_every_contact(tmp_path: Path) -> None:
    data = maps(made(ROUGH), "force")
    pressure = data["contact_pressure"].transpose("force", "x", "y")
    cell = float(np.diff(data["x"])[0] * np.diff(data["y"])[0])
    # a map of 121 points reads a grid of 64 cells: the sum of the pressure is the force to some percent
    np.testing.assert_allclose(pressure.sum(("x", "y")) * cell, [0.1, 0.4], rtol=0.05)
    assert float(abs(pressure[:, [0, -1]]).max()) < 1e-6 * float(pressure.max())
    style.save(contact_maps.maps(data), tmp_path / "map.svg")
    assert (tmp_path / "map.svg").stat().st_size > 10_000


def test_polar_plot_shows_both_signs_over_a_whole_turn() -> None:
    angle = np.linspace(0.01, np.pi - 0.01, 40)
    charge = xr.DataArray(1e-11 * np.sin(2 * angle), {"cut_angle": angle}, attrs={"units": "C N-1"})
    (ax,) = contact_maps.polar(xr.Dataset({"charge_per_force": charge})).axes
    shown = [np.isfinite(line.get_ydata()).sum() for line in ax.get_lines()]
    assert shown == pytest.approx([180, 180, 180, 180], abs=2)  # of 361 angles, half have each sign
    assert max(np.nanmax(line.get_ydata()) for line in ax.get_lines()) == pytest.approx(10, rel=1e-3)


def test_effects_that_contacts_in_space_lack_are_refused() -> None:
    ellipsoid = "profile: ellipsoid, radius_x: 1 mm, radius_y: 2 mm"
    assert "realisations: only a rough_sphere" in refusal(edited(ROUGH, "profile: rough_sphere", ellipsoid))
    assert "interior: of a contact in space" in refusal(edited(ROUGH, "realisations: 2", "interior: {}"))


@pytest.mark.parametrize(
    ("case", "words"),
    [
        (
            {"profile": "roller", "radius": 0.02, "length": 5e-3, "crown_radius": 3.0, "punch": "steel"},
            "PZT-4, 100 µm on steel; steel roller, R = 20 mm, 5 mm long, crown of 3 m, in air",
        ),
        (
            {"profile": "sphere", "radius": 5e-3, "cut": "tilt", "cut_angle": np.pi / 6},
            "PZT-4, tilt cut of 30 deg, 100 µm on steel; ball, R = 5 mm, in air",
        ),
    ],
)
def test_cards_name_and_draw_punches_in_space(case: dict[str, float | str], words: str) -> None:
    study = made(ROUGH)
    whole = {"material": "PZT-4", "thickness": 1e-4, "base": "steel", "surroundings": "air", "force": 1.0, **case}
    film = SimpleNamespace(**{name: getattr(study, name) for name in ("device", "phases", "own_materials")})
    film.body, film.kind, film.surroundings = [], KINDS["space", True, True], ["air"]
    assert firstscreen.in_words(film, whole) == words  # type: ignore[arg-type]
    drawn = firstscreen.of_case(film, whole, {"contact_length_x": 2e-4})  # type: ignore[arg-type]
    assert (drawn.contact, drawn.size) == (2e-4, case.get("radius", 5e-3))
    assert "<svg" in str(element(device.draw(drawn, "a punch"), "punch", "a punch"))
