"""Numbers of docs/theory-films.md, section 10: ``python docs/films.py`` prints them."""

import numpy as np

import solver
from solver.halfplane.contact import Contact
from solver.halfplane.profile import Profile
from solver.halfplane.sliding import Sliding
from solver.halfplane.surface import HalfPlane
from solver.line import outputs
from solver.line.contact import FilmContact
from solver.line.table import table
from solver.stack.layers import Layer, Stack
from solver.stack.reflection import sideways

MIXED = solver.fibrous(solver.find("BaTiO3"), solver.find("CoFe2O4"), 0.5)
SILICON = solver.find("silicon")
_CYLINDER = Profile.cylinder(np.array(0.05))


def numbers() -> dict[str, float]:
    """What the page says, by name; SI."""
    titanate = {f"{name}, BaTiO3": value for name, value in _thick(solver.find("BaTiO3")).items()}
    return _thick(MIXED) | titanate | _reciprocal() | _charged() | _insulated()


def _film(stack: Stack, friction: float = 0.0, load: float = 1e5, charge: float = 0.0) -> FilmContact:
    """A cylinder of 50 mm that conducts both fields."""
    of = table(stack, friction, least=0.3, most=4.0, nodes=20)
    return FilmContact(of, _CYLINDER, np.array([load]), np.array([[charge, 0.0]]), np.array(1.0))


def _thick(material: solver.Material) -> dict[str, float]:
    """Half-length on a film ten half-lengths thick over that of the half-plane of its material, less 1."""
    sliding = Sliding(HalfPlane(material), np.array(0.3), np.array([True, True]))
    load, charges = np.array([1e5]), np.zeros((1, 2))
    exact = float(np.ravel(Contact(sliding, _CYLINDER, load, charges).half_width)[0])
    stacks = {
        "rigid": Stack((Layer(material, 10 * exact),)),
        "bonded": Stack((Layer(material, 10 * exact, "bonded"),), SILICON),
        "grounded": Stack((Layer(material, 10 * exact, "grounded"),), SILICON),
    }
    errors = {}
    for name, stack in stacks.items():
        of = table(stack, 0.3, least=0.05, most=0.2, nodes=12)
        contact = FilmContact(of, _CYLINDER, load, charges, np.array(1.0))
        errors[f"thick film, {name}"] = float(contact.half_width[0]) / exact - 1
    return errors


def _reciprocal() -> dict[str, float]:
    """Reciprocity at a fixed contact and with edges that move."""
    film = _film(Stack((Layer(MIXED, 3e-4),)), load=2e5)
    read = np.einsum("n,noc->oc", film.table.polynomials(np.log(film.half_width))[0], film.table.series)
    T = len(film.table.system.powers)
    (load_T, u_T, _, psi_T), (load_J, u_J, V_J, _) = read[[outputs.LOAD, 3, 4, 5]][:, [T, T + 1]].T
    tangents = film.tangents[0]
    return {
        "V_J over Psi_T": V_J / psi_T - 1,
        "P_T u_J + V_J over P_J u_T + Psi_T": (load_T * u_J + V_J) / (load_J * u_T + psi_T) - 1,
        "d depth/dT": tangents[0, 1],
        "-dV/dP": -tangents[1, 0],
        "-V/P": -film.potential(0)[0] / 2e5,
    }


def _charged() -> dict[str, float]:
    """What a charge of 20 uC/m does to the half-length."""
    stack = Stack((Layer(MIXED, 2e-4),))
    wide, plain = (_film(stack, 0.3, charge=charge).half_width[0] for charge in (2e-5, 0.0))
    return {"half-length by charge": wide / plain - 1}


def _insulated() -> dict[str, float]:
    """Permeance on an insulated base, 0.1 mm thick, by the distance at which the far potential is read as zero."""
    stack = Stack((Layer(MIXED, 1e-4, magnetic="insulated"),))
    film, c_B = _film(stack), sideways(stack) * stack.scale[3] ** 2
    potential = film.at_fixed_contact[0, 2, 1]
    data = {"2H/pi": 2 / np.pi, "H": 1.0, "10 H": 10.0}
    return {
        f"permeance, datum {name}": 1 / (potential - c_B / 2 * (L - 2 / np.pi) * stack.thickness)
        for name, L in data.items()
    } | {"half-length over H": film.half_width[0] / stack.thickness}


if __name__ == "__main__":
    for name, value in numbers().items():
        print(f"{name:44s} {value:.4g}")
