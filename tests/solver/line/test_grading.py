"""Graded films as twelve sublayers: the figures of exact kernels, films graded by nothing."""

import pytest

import solver
from tests.solver.cases import assert_alike

FILM: dict[str, object] = {"radius": 0.05, "friction": 0.3, "thickness": 2e-4, "surroundings": "insulated"}
LINEAR = FILM | {"volume_fraction": 0.2, "base_volume_fraction": 0.8}
FIGURES = ("contact_trailing", "peak_pressure", "depth", "voltage", "trailing_tension", "charge_per_force",
           "electric_edge_intensity_trailing")  # fmt: skip
#: What sublayers may miss, as docs/names.md says it.
MISSED = (2e-3, 1e-3, 1e-3, 3e-3, 1e-2, 2e-2, 6e-2)


@pytest.mark.parametrize(
    ("case", "figures"),
    [
        (LINEAR | {"base": "rigid", "load": 1e5},
         (1.668545e-4, 386.8830e6, 3.674432e-7, -384.5911, 304.0227e6, 40.39938e-12, 5.081281e-5)),
        (LINEAR | {"base": "rigid", "load": 1e3},
         (2.067729e-5, 31.72089e6, 1.158217e-8, -13.91201, 22.88186e6, 25.16839e-12, 1.239520e-6)),
        (LINEAR | {"base": "steel", "load": 1e5},
         (1.976442e-4, 335.2218e6, 2.906761e-6, -276.9999, 225.3815e6, 33.23028e-12, 3.683069e-5)),
        (FILM | {"volume_fraction": 0.9, "base_volume_fraction": 0.1, "grading_exponent": 2.0, "base": "steel",
                 "load": 1e5},
         (2.056976e-4, 326.2114e6, 2.925715e-6, -254.1020, 212.6021e6, 40.93139e-12, 1.355858e-4)),
    ],
    ids=["rigid", "narrow", "steel", "square"],
)  # fmt: skip
def test_figures_of_exact_kernels_are_met_to_the_stated_share(
    case: dict[str, object], figures: tuple[float, ...]
) -> None:
    """Contacts on kernels with their exact tails in k (release 0.2.0), resolved to 1e-7."""
    answer = solver.solve(case)
    for name, exact, share in zip(FIGURES, figures, MISSED, strict=True):
        assert float(answer[name]) == pytest.approx(exact, rel=share), name


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "options",
    [
        {"radius": 0.05, "load": 2e4, "friction": 0.3, "surroundings": "insulated", "charge": 2e-5},
        {"radius": 0.05, "load": 2e4, "friction": 0.3, "surroundings": "insulated", "magnetic": "insulating",
         "electrode": "top", "collector": 2, "patch_size": 1e-4, "patch_position": 3e-5},
        {"radius": 0.01, "force": 5.0, "profile": "sphere"},
    ],
    ids=["bare", "covered", "ball in air"],
)  # fmt: skip
def test_a_film_graded_by_nothing_is_the_homogeneous_film(options: dict[str, object]) -> None:
    film = {"thickness": 2e-4, "volume_fraction": 0.5, "base": "steel"} | options
    exact, computed = solver.solve(film), solver.solve(film | {"base_volume_fraction": 0.5})
    assert set(exact) == set(computed)
    assert_alike(computed, exact, 1e-8)
