"""The circular punch against the numerical solution of (2.2), which knows no closed form."""

import numpy as np
import pytest
from numpy.typing import NDArray

import solver
from tests.solver.cases import CHARGED
from verification.cases import SIH_SONG, constants
from verification.oracles import collocation, profile
from verification.oracles.surface_response import SurfaceResponse, surface_response

POSITIONS = np.array([-6.0, -1.01, -0.98, -0.3, 0.4, 0.98, 1.01, 2.5])


@pytest.mark.parametrize("friction", [0.0, 0.4, 2.0])
@pytest.mark.parametrize("name", [SIH_SONG, "CoFe2O4", "PZT-5H"])
def test_collocation_and_closed_form_agree(name: str, friction: float) -> None:
    surface = surface_response(constants(solver.find(name)))
    numerical = collocation.solve(
        collocation.Problem(
            N=surface.normal_compliance,
            k=surface.shear_coupling,
            profile=profile.cylinder(CHARGED["radius"]),
            friction=friction,
            load=CHARGED["load"],
            charge=CHARGED["charge"],
            magnetic_charge=CHARGED["magnetic_charge"],
        )
    )
    found = solver.solve({"material": name, **CHARGED, "friction": friction}, POSITIONS)
    expected = dict(
        zip(("depth", "voltage", "magnetic_potential"), numerical.punch_response(CHARGED["datum"]), strict=True)
    )
    expected |= {"contact_trailing": numerical.trailing, "contact_leading": numerical.leading}
    for quantity, value in expected.items():
        assert found[quantity].item() == pytest.approx(value, rel=1e-10), quantity
    for field, values in fields(numerical, surface).items():
        size = float(np.max(np.abs(values)))
        np.testing.assert_allclose(found[field], values, rtol=1e-10, atol=1e-11 * size, err_msg=field)


def fields(numerical: collocation.Contact, surface: SurfaceResponse) -> dict[str, NDArray[np.float64]]:
    tractions, transforms = numerical.tractions(POSITIONS), numerical.transforms(POSITIONS)
    friction = numerical.problem.friction
    t, transform = (np.vstack([friction * rows[0], rows]) for rows in (tractions, transforms))
    along = surface.along_surface(t, transform)
    return {
        "contact_pressure": -t[1],
        "shear_traction": t[0],
        "electric_displacement_y": t[2],
        "magnetic_induction_y": t[3],
        "stress_xx": along[0],
        "electric_displacement_x": along[2],
        "magnetic_induction_x": along[3],
    }
