"""What finite elements need for a number of the solver: ``python docs/elements.py`` prints it, for docs/others.md."""

import time
from collections.abc import Sequence

import solver
from verification.cases import constants
from verification.oracles.fem_film import Layer
from verification.oracles.fem_point import PointContact

SPHERE, THICKNESS = 5e-3, 1e-4
ORDERS = (2, 3, 4, 6, 8)
_STEPS, _POWER = 12, 3.3  # the force goes with about this power of the radius
_CHARGE = 1e-9  # [C], of the second of two cases, in whose charge everything is linear


def row(order: int) -> tuple[int, float, float, float]:
    """Unknowns, charge per force [pC/N], its relative error and seconds of a processor, by elements of an order.

    A rigid conducting ball at zero volts on BaTiO3 on a rigid grounded base, in contact as wide as the film is thick.
    """
    began = time.process_time()
    material = solver.find("BaTiO3")
    layer = Layer(constants(material) | {"c12": float(material.c12)}, THICKNESS)
    idle, charged = (
        PointContact([layer], None, SPHERE, THICKNESS, charge, permittivity=0.0, order=order)
        for charge in (0.0, _CHARGE)
    )
    share = idle.voltage / (idle.voltage - charged.voltage)
    force = (1 - share) * idle.force + share * charged.force
    found = abs(share * _CHARGE / force)
    seconds = (time.process_time() - began) / 2  # of one of the cases
    return 4 * len(idle.body.places), found * 1e12, abs(found / exact() - 1), seconds


def exact() -> float:
    """Charge per force [C/N] by the solver, at zero volts and the force of that contact."""
    film = {"material": "BaTiO3", "thickness": THICKNESS, "base": "rigid", "surroundings": "insulated"}
    case = {"profile": "sphere", "radius": SPHERE, **film}
    force = 40.0
    for _ in range(_STEPS):
        charge = force * float(solver.solve(case | {"force": force})["charge_per_force"])
        at_zero_volts = solver.solve(case | {"force": force, "total_charge": charge})
        force *= float((THICKNESS / at_zero_volts["contact_radius"]) ** _POWER)
    return charge / force


def table(rows: Sequence[tuple[int, float, float, float]]) -> str:
    """The table of the page, without what is said beside it."""
    lines = [
        "| order | unknowns | charge per force, pC/N | relative error | seconds of a processor |",
        "|---|---|---|---|---|",
    ]
    lines += [
        f"| {order} | {unknowns:,} | {value:.6f} | {error:.0e} | {seconds:.1f} |"
        for order, (unknowns, value, error, seconds) in zip(ORDERS, rows, strict=True)
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    print(table([row(order) for order in ORDERS]))
