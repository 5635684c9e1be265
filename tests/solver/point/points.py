"""Point contacts that the tests of the room share."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import solver
from solver.arrays import Array
from solver.halfplane.surface import HalfPlane
from solver.line.windows import Coat, Kind, constants_of
from solver.material.constants import Material
from solver.point.body import Film, HalfSpace
from solver.point.contact import Pressed
from solver.point.profile import Shape
from solver.point.state import conducted
from solver.point.table import PointKind

BTO, CFO, PZT, STEEL = (solver.find(name) for name in ("BaTiO3", "CoFe2O4", "PZT-4", "steel"))
FIBROUS = solver.fibrous(BTO, CFO, 0.5)
Conducts = tuple[bool, bool]


def _cases(force: ArrayLike) -> Array:
    return np.atleast_1d(np.asarray(force, dtype=np.float64))


def _charges(charges: ArrayLike, force: Array) -> Array:
    return np.array(np.broadcast_to(np.asarray(charges, dtype=np.float64), (force.size, 2)))


def on_halfspace(
    material: Material,
    exponent: float,
    coefficient: float,
    force: ArrayLike,
    charges: ArrayLike = (0.0, 0.0),
    conducts: Conducts = (True, True),
    punch: float = 0.0,
) -> Pressed:
    """Contacts on a half-space; ``punch`` is N_p [1/Pa]."""
    half, P = HalfPlane(material), _cases(force)
    units = half.scale[1:]
    N = half.compliance / (units[:, None] * units)
    N[0, 0] += punch / units[0] ** 2
    N = np.broadcast_to(conducted(N, np.array(conducts)), (P.size, 3, 3))
    body = HalfSpace(N, Shape(exponent))
    return Pressed(body, half.scale, np.full(P.shape, coefficient), P, _charges(charges, P), np.array(conducts))


def film(material: Material, base: Material | None = None, **interface: Any) -> Kind:
    """One layer of unit thickness on a base, rigid without one."""
    coats = (Coat(constants_of(material), 1.0, **interface),)
    return of_coats(coats, base)


def of_coats(coats: tuple[Coat, ...], base: Material | None = None) -> Kind:
    """Layers on a base, rigid without one."""
    return Kind(coats, None if base is None else constants_of(base), 0.0, (True, True), (True, True), 1)


def on_film(
    layers: Kind,
    thickness: float,
    exponent: float,
    coefficient: float,
    force: ArrayLike,
    charges: ArrayLike = (0.0, 0.0),
    conducts: Conducts = (True, True),
    punch: float = 0.0,
) -> Pressed:
    """Contacts on films of a top layer's thickness [m]; ``punch`` is N_p [1/Pa]."""
    kind, P = PointKind(layers, conducts, Shape(exponent), punch), _cases(force)
    body = Film(kind, np.full(P.shape, thickness))
    return Pressed(body, kind.scale, np.full(P.shape, coefficient), P, _charges(charges, P), np.array(conducts))
