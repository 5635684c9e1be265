"""Cuts of a crystal: names, rotations, and the generalised stiffness tensor in the axes of the surface.

The surface has the axes x, y and its outward normal z, the crystal X, Y and its axis of poling Z. Rows of a rotation
are the surface's axes in the crystal. Euler angles turn about Z, the new X and the new Z (as for surface acoustic
waves): ``nY`` has (0, n - 90 deg, 0), so x along X and the normal turned from Y by n degrees about X towards Z.
"""

import re
import warnings
from collections.abc import Mapping, Sequence

import numpy as np
import scipy  # scipy.spatial, slow to import, and few jobs turn a crystal

from solver.arrays import Array, is_finite, shown
from solver.material.datasheet import piezo, transverse
from solver.names import ANGLED_CUTS

ALLOWED = (
    "X, Y, Z, a rotated Y as 36Y, a tilt of the axis as 'tilt 10 deg', three Euler angles in degrees, or a rotation's "
    "three rows"
)
_NUMBER = r"-?[0-9]+(?:\.[0-9]*)?"
_NAMED = re.compile(rf"(?P<plain>[XYZ])|(?P<turned>{_NUMBER})Y|tilt (?P<tilt>{_NUMBER}) ?(?:deg|°)")
_EULER = re.compile(r"euler (\S+) (\S+) (\S+)")
_ROUNDED = 1e-3  # largest entry of R R^T - 1: rows are printed with four digits
_PLAIN = {"X": (90.0, 90.0, 0.0), "Y": (0.0, -90.0, 0.0), "Z": (0.0, 0.0, 0.0)}
_VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


def canonical(cut: object) -> str:
    """Return a cut as text, its name or ``euler`` and three angles in degrees; ValueError if it is no rotation."""
    if isinstance(cut, str):
        _angles(cut)
        return cut
    rows = cut.tolist() if isinstance(cut, np.ndarray) else cut
    entries = list(rows) if isinstance(rows, Sequence) else []
    if len(entries) == 3 and all(is_finite(entry) for entry in entries):
        return "euler " + " ".join(repr(float(angle)) for angle in entries)
    flat = [e for row in entries if isinstance(row, Sequence) and not isinstance(row, str) for e in row]
    if len(entries) != 3 or len(flat) != 9 or not all(is_finite(entry) for entry in flat):
        raise ValueError(f"cut: {shown(cut)} is unknown; allowed are {ALLOWED}")
    matrix = np.array(flat, dtype=np.float64).reshape(3, 3)
    if np.max(np.abs(matrix @ matrix.T - np.eye(3))) > _ROUNDED or np.linalg.det(matrix) < 0:
        raise ValueError(f"cut: {shown(cut)} is no rotation; its rows must be orthonormal and right-handed")
    return "euler " + " ".join(repr(angle) for angle in _angles_of(matrix))


def rotation(cut: str) -> Array:
    """Rotation from the crystal's axes to the surface's, which are its rows; an empty cut is Z; (3, 3)."""
    return np.asarray(scipy.spatial.transform.Rotation.from_euler("ZXZ", _angles(cut), degrees=True).as_matrix().T)


def of_family(family: str, angle: float) -> str:
    """Return the text of a cut by its family in the factor ``cut`` and, where it has one, its angle [rad]."""
    if family not in ANGLED_CUTS:
        return family
    degrees = repr(round(float(np.degrees(angle)), 12))
    return f"euler -90.0 {degrees} 90.0" if family == "tilt" else f"euler 0.0 {float(degrees) - 90!r} 0.0"


def split(name: str) -> tuple[str, str] | None:
    """Split a name such as ``36Y LiNbO3`` into cut and material; None if it does not start with a cut."""
    match = re.fullmatch(rf"(?P<cut>{_NAMED.pattern}) (?P<material>\S.*)", name)
    return (match["cut"], match["material"]) if match else None


def generalised_stiffness(constants: Mapping[str, float], cut: str) -> Array:
    """E[i, J, K, l] with T_iJ = E_iJKl U_K,l for U = (u, phi, psi) and T = (sigma, D, B); (3, 5, 5, 3), SI."""
    turn = rotation(cut)
    c, e, f, eps, g, mu = _matrices(constants)
    elastic, coupling = np.zeros((3, 3, 3, 3)), np.zeros((2, 3, 3, 3))
    for row, (i, j) in enumerate(_VOIGT):
        for column, (k, m) in enumerate(_VOIGT):
            elastic[[i, j, i, j], [j, i, j, i], [k, k, m, m], [m, m, k, k]] = c[row, column]
        for field, matrix in enumerate((e, f)):
            coupling[field, :, i, j] = coupling[field, :, j, i] = matrix[:, row]
    tensor = np.zeros((3, 5, 5, 3))
    tensor[:, :3, :3] = np.einsum("ia,jb,kc,ld,abcd->ijkl", turn, turn, turn, turn, elastic)
    turned = np.einsum("ia,jb,kc,fabc->fijk", turn, turn, turn, coupling)
    for field in range(2):
        tensor[:, 3 + field, :3] = turned[field]
        tensor[:, :3, 3 + field] = np.moveaxis(turned[field], 0, 2)
    for (row, column), values in {(3, 3): eps, (3, 4): g, (4, 3): g, (4, 4): mu}.items():
        tensor[:, row, column] = -turn @ values @ turn.T
    return tensor


def _matrices(v: Mapping[str, float]) -> tuple[Array, ...]:
    """c (6, 6), e and f (3, 6), eps, g and mu (3, 3) in the crystal's axes, trigonal classes 3m and 32 included."""
    c = transverse(*(v[name] for name in ("c11", "c12", "c13", "c33", "c44")), stiffness=True)
    for (i, j), value in {(0, 3): v["c14"], (1, 3): -v["c14"], (4, 5): v["c14"]}.items():
        c[i, j] = c[j, i] = value
    e, f = (piezo(v[f"{letter}31"], v[f"{letter}33"], v[f"{letter}15"]) for letter in "ef")
    e[0, [0, 1, 3, 5]] += v["e11"], -v["e11"], v["e14"], -v["e22"]
    e[1, [0, 1, 4, 5]] += -v["e22"], v["e22"], -v["e14"], -v["e11"]
    fields = (np.diag([v[f"{name}11"], v[f"{name}11"], v[f"{name}33"]]) for name in ("eps", "g", "mu"))
    return c, e, f, *fields


def _angles(cut: str) -> tuple[float, float, float]:
    """Euler angles of a cut in degrees."""
    if not cut:
        return _PLAIN["Z"]
    if match := _NAMED.fullmatch(cut):
        if match["plain"]:
            return _PLAIN[match["plain"]]
        return (-90.0, float(match["tilt"]), 90.0) if match["tilt"] else (0.0, float(match["turned"]) - 90, 0.0)
    euler = _EULER.fullmatch(cut)
    try:
        first, second, third = map(float, euler.groups() if euler else ())
    except ValueError:
        raise ValueError(f"cut: {shown(cut)} is unknown; allowed are {ALLOWED}") from None
    if not np.all(np.isfinite([first, second, third])):
        raise ValueError(f"cut: {shown(cut)} is no rotation; its angles must be finite")
    return first, second, third


def _angles_of(matrix: Array) -> list[float]:
    """Euler angles of a rotation in degrees."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # if the axis is the normal, only the sum of two angles is defined
        turn = scipy.spatial.transform.Rotation.from_matrix(matrix.T)
        angles: list[float] = turn.as_euler("ZXZ", degrees=True).tolist()
    return angles
