"""Films of the calculator: what balls and discs on a few stacks answer, as Chebyshev series that a browser reads.

A series is in log(radius/thickness): `loads` of loads and edges by channel and cause, `pressures` by place and cause.
Materials that do not couple magnetically need two channels of three.
"""

from collections.abc import Iterable
from typing import Any

import numpy as np

from approximation.chebyshev import coefficients, mapped_points
from solver.arrays import Array
from solver.film.powerlaw import constants_of
from solver.film.windows import Coat, Kind, number_of
from solver.halfplane.punch import Punch
from solver.material.constants import Material
from solver.material.laws import made
from solver.material.library import find
from solver.material.punches import RIGID_PUNCH, find_punch
from solver.point.pressure import SAMPLES
from solver.point.profile import Shape
from solver.point.table import PointKind, window

#: Films by their title, with the factors that make them.
FILMS: dict[str, dict[str, Any]] = {
    "PZT-4 on steel": {"material": "PZT-4", "base": "steel"},
    "PZT-4 on silicon": {"material": "PZT-4", "base": "silicon"},
    "AlN on silicon": {"material": "AlN", "base": "silicon"},
    "AlScN (30 % Sc) on silicon": {"composite": "AlScN", "scandium_fraction": 0.3, "base": "silicon"},
    "PVDF on glass": {"material": "PVDF", "base": "glass"},
}
#: What presses on them.
PUNCHES = (RIGID_PUNCH, "steel", "tungsten_carbide")
#: Radius of the contact over the thickness of the film, from and to.
RANGE = 0.01, 10.0
_NODES = 48
_EXACT, _DRAWN = 1e-8, 1e-4  # of the largest coefficient of loads and pressures; smaller ones are left out
_CHANNELS = [0, 1]  # displacement and voltage
_CAUSES = [0, 1, 3]  # those and the profile
_SPHERE = Shape(2.0)
_SHOWN = np.arange(2, SAMPLES.size, 3)  # places at which the pressure is given, the centre among them


def top_of(film: dict[str, Any]) -> Material:
    """The material of a film."""
    if "material" in film:
        return find(str(film["material"]))
    return made(str(film["composite"]), (find("BaTiO3"), find("CoFe2O4")), film["scandium_fraction"])


def tables(names: Iterable[str] = FILMS) -> list[dict[str, Any]]:
    """Films under every punch as plain data; a series is a list of coefficients, rising.

    Examples
    --------
    >>> len(PUNCHES) * len(FILMS)
    15
    """
    return [_table(name, FILMS[name], punch) for name in names for punch in PUNCHES]


def _table(name: str, film: dict[str, Any], punch: str) -> dict[str, Any]:
    top = Coat(constants_of(top_of(film)))
    kind = Kind((top,), constants_of(find(str(film["base"]))), 0.0, (True, True), (True, True), 1)
    of = PointKind(kind, (True, True), _SPHERE, _compliance(punch))
    low, high = np.log(RANGE)
    found = [_entries(of, place) for place in mapped_points(_NODES, low, high)]
    loads, pressures = (coefficients(np.array(part)).T for part in zip(*found, strict=True))
    centre = len(pressures) - len(_CAUSES)  # where the pressure is largest; elsewhere it is drawn
    return {
        "film": name,
        "punch": punch,
        "range": [low, high],
        "units": of.scale[1:].tolist(),
        "samples": SAMPLES[_SHOWN].tolist(),
        "loads": [_short(one, _EXACT) for one in loads],
        "pressures": [_short(one, _EXACT if k >= centre else _DRAWN) for k, one in enumerate(pressures)],
    }


def _entries(of: PointKind, place: float) -> tuple[Array, Array]:
    """What the layers add at log(a/h): loads and edges (12,), and pressures (sample * 3,)."""
    at = window(of, int(number_of(np.exp(np.array([place])))[0]))
    read = at.read(np.array([place]))[0, :2][:, _CHANNELS][:, :, _CAUSES]
    pressures = at.pressures(np.full(len(_CAUSES), place), np.eye(4)[_CAUSES])[:, _SHOWN]
    return read.ravel(), pressures.T.ravel()


def _short(series: Array, kept: float) -> list[float]:
    """A series without its tail of coefficients below a share of the largest, to as many digits."""
    large = np.flatnonzero(np.abs(series) > kept * np.max(np.abs(series)))
    ends = int(large[-1]) + 1 if large.size else 0
    places = int(np.ceil(-np.log10(kept * np.max(np.abs(series))))) + 1 if ends else 0
    return [round(float(one), places) for one in series[:ends]]


def _compliance(punch: str) -> float:
    if punch == RIGID_PUNCH:
        return 0.0
    known = find_punch(punch)
    return float(Punch.isotropic(known.modulus, known.poisson).compliance)
