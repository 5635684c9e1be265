"""Graded films and stacks of layers through the face: two ways to one number, what they leave out, refusals."""

from typing import Any

import solver
from solver.line.powerlaw import PowerLaw, constants_of
from solver.names import FILM_PEAKS, FILM_QUANTITIES, QUANTITIES
from tests.solver.cases import assert_alike
from tests.solver.line.films import BTO, CFO, STEEL

PUNCH: dict[str, Any] = {"radius": 0.05, "friction": 0.3, "load": 1e5}
BARE = PUNCH | {"surroundings": "insulated"}
PLAIN = BARE | {"material": "BaTiO3", "thickness": 0.2e-3, "base": "steel"}
GRADED = BARE | {"thickness": 0.2e-3, "base": "steel", "volume_fraction": 0.2}
LINEAR = GRADED | {"base_volume_fraction": 0.8}


def test_a_power_law_by_factors_is_the_profile_of_a_stack() -> None:
    by_factors = solver.solve(LINEAR)
    profile = solver.Graded(PowerLaw("fibrous", (constants_of(BTO), constants_of(CFO)), 0.2, 0.8, 1.0), 0.2e-3)
    body = solver.Stack([profile], base=STEEL)  # of the same law, so that both share tables
    assert_alike(solver.solve(BARE | {"body": body}), by_factors, 1e-12)
    assert set(by_factors.data_vars) == {*QUANTITIES, *FILM_QUANTITIES}


def test_a_stack_of_one_layer_is_a_film_and_a_layer_cut_in_two_is_one() -> None:
    whole = solver.Stack([solver.Layer(BTO, 0.2e-3)], base=STEEL)
    cut = solver.Stack([solver.Layer(BTO, 0.15e-3), solver.Layer(BTO, 0.05e-3)], base=STEEL)
    film = solver.solve(PLAIN, [0.5, 1.2], peaks=True)
    computed = solver.solve(BARE | {"body": [whole, cut]}, [0.5, 1.2])
    assert list(computed["body"].values) == [whole.name, cut.name]
    names = [name for name in map(str, film) if name in computed]
    assert {*QUANTITIES, *FILM_QUANTITIES, "stress_xx"} <= set(names)
    assert_alike(computed.isel(body=0), film, 1e-12, names)
    assert_alike(computed.isel(body=1), film, 3e-9, names)
    peaks = solver.solve(BARE | {"body": cut}, peaks=True)
    assert {name for name in FILM_PEAKS if not name.startswith("film")} <= set(peaks.data_vars)
    assert_alike(peaks, film, 1e-6, ["interface_shear", "base_peak_von_mises", "base_peak_principal_tension"])
    inside, alone = (solver.solve_interior(BARE | {"body": body}, [0.3], [-0.5, -0.95, -2.0]) for body in (cut, whole))
    assert_alike(inside, alone, 1e-8)


def test_an_electrode_between_layers_shields_and_counts_as_the_ground() -> None:
    """Below a grounded electrode a dielectric has no part in the voltage but by its stiffness."""
    upper = solver.Layer(BTO, 0.2e-3, electric="grounded")
    computed = solver.solve(BARE | {"body": solver.Stack([upper, solver.Layer(STEEL, 0.3e-3)], base=STEEL)})
    assert_alike(
        computed,
        solver.solve(PLAIN),
        1e-9,
        ["contact_trailing", "voltage", "capacitance_per_length", "nominal_field", "depth"],
    )
