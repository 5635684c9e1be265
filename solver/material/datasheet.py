"""Constants as data sheets print them, converted to c^E, e and eps^S.

Data sheets print compliances s^E, charge constants d and free permittivities eps^T (IEEE Std 176-1987, strain-charge
form), finite-element decks 6 x 6 and 3 x 6 matrices: c = s^-1,   e = d c,   eps^S = eps^T - d e^T.
"""

import re
from collections.abc import Collection, Mapping
from difflib import get_close_matches

import numpy as np

from solver.arrays import Array, is_finite
from solver.material.usual import Usual
from solver.units import VACUUM_PERMITTIVITY, in_si

#: Unit of each entry that a data sheet has and `solver.material.constants.UNITS` lacks.
UNITS: dict[str, str] = {
    **dict.fromkeys(("s11", "s12", "s13", "s33", "s44", "s66"), "Pa-1"),
    "c66": "Pa",
    **dict.fromkeys(("d31", "d33", "d15"), "C N-1"),
    **dict.fromkeys(("eps_T11", "eps_T33"), "F m-1"),
    **dict.fromkeys(("eps_r11", "eps_r33", "k31", "k33", "k15"), "1"),
    "E": "Pa",
    "nu": "1",
}
MATRICES: dict[str, tuple[tuple[int, int], str]] = {
    "c": ((6, 6), "Pa"),
    "s": ((6, 6), "Pa-1"),
    "e": ((3, 6), "C m-2"),
    "d": ((3, 6), "C N-1"),
    "eps": ((3, 3), "F m-1"),
}
ENTRIES = (*UNITS, *MATRICES, "order")
#: Independent entries of each matrix of a transversely isotropic body, and their indices in the order of IEEE.
_ELASTIC = {"11": (0, 0), "12": (0, 1), "13": (0, 2), "33": (2, 2), "44": (3, 3)}
_COUPLED = {"31": (2, 0), "33": (2, 2), "15": (0, 4)}
_PLACES = {"c": _ELASTIC, "s": _ELASTIC, "e": _COUPLED, "d": _COUPLED, "eps": {"11": (0, 0), "33": (2, 2)}}

#: Sizes that bare entries have in any material (see `usual`).
_USUAL = {
    # diamond has 1e-12 Pa-1, hydrogels 1e-3
    **dict.fromkeys(("s11", "s12", "s13", "s33", "s44", "s66"), Usual(1e-14, 1e-2, above="{0:g}e-12 m2/N")),
    # quartz has 1e-13 C/N, relaxor crystals 5e-9, cellular polymers 1e-9
    **dict.fromkeys(("d31", "d33", "d15"), Usual(1e-15, 1e-7, above="{0:g} pC/N")),
    **dict.fromkeys(("eps_T11", "eps_T33"), Usual(1e-12, 1e-5, above="eps_r = {0:g}, or {0:g} nF/m")),
    **dict.fromkeys(("eps_r11", "eps_r33"), Usual(0.5, 1e6, "{0:g} F/m (eps_T11 and eps_T33 take it)")),
}
_ABAQUS = [0, 1, 2, 5, 4, 3]  # Abaqus counts shear 12, 13, 23; IEEE 23, 13, 12
_ROUNDED, _FLOOR = 5e-3, 1e-3  # deviations allowed: of an entry, rounded to three digits, and of the largest one
_DEPENDENT = 0.05  # of the largest entry, for 66: it follows from 11 and 12, but sheets print measured values
_DIFFERENT = 0.1  # allowed between a coupling factor and its value from the other constants


#: Names in data sheets, without blanks, _ and ^, and those of the same constants here.
_PRINTED = {
    r"([sc])E?(11|12|13|33|44|66)E?": r"\1\2",
    r"([sc])D?(11|12|13|33|44|66)D?": r"\1\2, which is at constant electric field",
    r"(?:K|epsilon|eps)r?T?([13])\1?T?": r"eps_r\1\1",
    r"YE?([13])\1?E?": r"s\1\1, which is 1/Y",
    r"(?i:density)": "rho",
    r"(?i:youngs?|youngs?modulus)": "E",
    r"(?i:poissons?|poissons?ratio)": "nu",
}


def meant(name: str, known: Collection[str]) -> str:
    """Return the probable meaning of an unknown name in a material's file, or all allowed names."""
    bare = re.sub(r"[\s_^']", "", name)
    printed = (match.expand(ours) for form, ours in _PRINTED.items() if (match := re.fullmatch(form, bare)))
    near = next(printed, None) or next(iter(get_close_matches(name, known, 1, 0.7)), None)
    return f"did you mean {near}?" if near else f"known are {', '.join(known)}"


def converted(mapping: Mapping[str, object]) -> dict[str, object]:
    """Return the mapping with data-sheet entries replaced by c, e and eps at constant field and strain."""
    sheet = {name for name in ENTRIES if name in mapping}
    if not sheet:
        return dict(mapping)
    values = {name: _number(name, mapping[name]) for name in (*UNITS, *_STRESS) if name in mapping}
    _check_relative(mapping)
    entries = _entries_of_matrices(mapping, values)
    if {"d", "s"} & mapping.keys():  # strain-charge form: the permittivity is that at constant stress
        entries = {name.replace("eps", "eps_T"): value for name, value in entries.items()}
    values |= entries
    _one_of(values, ("E", "nu"), ("s11", "s33", "s44"), ("c11", "c33", "c44"))
    _one_of(values, ("d31", "d33", "d15"), ("e31", "e33", "e15"))
    _one_of(values, ("eps_T33",), ("eps_r33",), ("eps33",))
    _one_of(values, ("eps_T11",), ("eps_r11",), ("eps11",))
    c = _stiffness(values)
    free = {
        axis: values.get(f"eps_T{axis}", values.get(f"eps_r{axis}", np.nan) * VACUUM_PERMITTIVITY)
        for axis in ("11", "33")
    }
    e = _coupling(values, c, free)
    if np.any(e) and not np.isfinite(c).all() and not np.isnan([*free.values()]).all():
        raise ValueError("c12: missing; a free permittivity needs it beside the piezoelectric constants")
    d = np.linalg.solve(c, e.T).T if np.any(e) and np.isfinite(c).all() else np.zeros((3, 6))
    clamped = {"11": free["11"] - d[0, 4] * e[0, 4], "33": free["33"] - d[2] @ e[2]}
    result = {name: value for name, value in mapping.items() if name not in ENTRIES}
    stiffness, coupling = _singles("c", c), _singles("e", e)
    result |= {name: value for name, value in stiffness.items() if name not in mapping and np.isfinite(value)}
    result |= {name: value for name, value in coupling.items() if name not in mapping and value}
    for axis, value in clamped.items():
        if np.isfinite(value):
            if value <= 0:
                raise ValueError(
                    f"eps_T{axis} = {free[axis]:.4g} F m-1: must exceed the {free[axis] - value:.4g} F m-1 that the "
                    "charge constants add at constant stress; check d and the relative permittivity"
                )
            result[f"eps{axis}"] = float(value)
        elif f"eps{axis}" in values:
            result[f"eps{axis}"] = values[f"eps{axis}"]
    return result


def _singles(letter: str, matrix: Array) -> dict[str, float]:
    """Single constants of a matrix by name, as ``c11``."""
    return {f"{letter}{axes}": float(matrix[place]) for axes, place in _PLACES[letter].items()}


def stress_matrices(values: Mapping[str, float]) -> tuple[Array, Array, Array]:
    """Return c (6, 6) [Pa], e (3, 6) [C/m2] and eps (3, 3) [F/m] of a material's constants by name."""
    c = transverse(*(values[f"c{axes}"] for axes in _PLACES["c"]), stiffness=True)
    e = piezo(values["e31"], values["e33"], values["e15"])
    return c, e, np.diag([values["eps11"], values["eps11"], values["eps33"]])


def strain_charge(c: Array, e: Array, eps: Array) -> dict[str, float]:
    """Return s^E, d, free permittivities and coupling factors of c (6, 6) [Pa], e (3, 6) [C/m2], eps (3, 3) [F/m]."""
    s = np.asarray(np.linalg.inv(c), dtype=np.float64)
    d = np.asarray(e @ s)
    free = eps + d @ e.T
    stiffened = c[2, 2] + e[2, 2] ** 2 / eps[2, 2]
    return {
        **_singles("s", s), **_singles("d", d),
        "eps_T11": free[0, 0], "eps_T33": free[2, 2],
        "eps_r11": free[0, 0] / VACUUM_PERMITTIVITY, "eps_r33": free[2, 2] / VACUUM_PERMITTIVITY,
        "k33": abs(d[2, 2]) / np.sqrt(s[2, 2] * free[2, 2]),
        "k31": abs(d[2, 0]) / np.sqrt(s[0, 0] * free[2, 2]),
        "k15": abs(d[0, 4]) / np.sqrt(s[3, 3] * free[0, 0]),
        "kt": abs(e[2, 2]) / np.sqrt(stiffened * eps[2, 2]),
    }  # fmt: skip


_STRESS = {
    **dict.fromkeys(("c11", "c12", "c13", "c33", "c44"), "Pa"),
    **dict.fromkeys(("e31", "e33", "e15"), "C m-2"),
    **dict.fromkeys(("eps11", "eps33"), "F m-1"),
}


def _number(name: str, value: object) -> float:
    """Return an entry in SI, or refuse a number whose size no material has with a question."""
    unit, usual = UNITS.get(name) or _STRESS[name], _USUAL.get(name)
    try:
        number = in_si(value, unit) if isinstance(value, str) else _cell(value, f" [{unit}]")
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    size = abs(number)
    if usual and size and not usual.low <= size <= usual.high:
        likely = (usual.above if size > usual.high else usual.below).format(number, number)
        as_written = not isinstance(value, str) or value.startswith(f"{number:g}")  # no prefix has changed it
        meant = f"; did you mean {likely}?" if likely and as_written else ""
        raise ValueError(f"{name}: {number:g} {unit} is of a size that no material has{meant}")
    return number


def _check_relative(mapping: Mapping[str, object]) -> None:
    """Refuse a relative permittivity beside charge constants as ``eps11`` or ``eps33``, at constant strain."""
    if {"d", "d31", "d33", "d15"}.isdisjoint(mapping):
        return
    for name in ("eps11", "eps33"):
        value = mapping.get(name)
        if isinstance(value, int | float) and value > _USUAL["eps_T33"].high:
            raise ValueError(
                f"{name}: {value:g} beside charge constants d: a sheet's relative permittivity, at constant stress, is "
                f"eps_r{name[-2:]}: {value:g}; {name} is in F/m at constant strain"
            )


def _one_of(values: Mapping[str, float], *forms: tuple[str, ...]) -> None:
    """Refuse two forms of the same constants."""
    used = [names for names in ([name for name in form if name in values] for form in forms) if names]
    if len(used) > 1:
        raise ValueError(f"{used[0][0]} and {used[1][0]}: two forms of the same constants; keep one")


def _stiffness(values: Mapping[str, float]) -> Array:
    """Stiffness matrix c^E in IEEE order, with NaN where c12 is unknown; (6, 6) [Pa]."""
    if "E" in values or "nu" in values:
        _all_of(values, ("E", "nu"))
        young, poisson = values["E"], values["nu"]
        if not -1 < poisson < 0.5:
            raise ValueError(f"nu: {poisson:g} is not within -1 < nu < 0.5")
        if young <= 0:
            raise ValueError(f"E: {young:g} Pa: must be positive")
        off = -poisson / young
        return np.asarray(np.linalg.inv(transverse(1 / young, off, off, 1 / young, 2 * (1 + poisson) / young)))
    if any(name in values for name in ("s11", "s33", "s44")):
        s12 = _transverse_entry(values, "s", 0.5)
        _all_of({**values, "s12": s12}, ("s11", "s12", "s13", "s33", "s44"))
        s = transverse(values["s11"], s12, values["s13"], values["s33"], values["s44"])
        if np.linalg.eigvalsh(s)[0] <= 0:
            raise ValueError(
                f"s11, s12, s13, s33 = {values['s11']:g}, {s12:g}, {values['s13']:g}, {values['s33']:g} Pa-1: "
                "the compliance is not positive definite; check the signs of s12 and s13, which are negative as a rule"
            )
        return np.asarray(np.linalg.inv(s))
    _all_of(values, ("c11", "c13", "c33", "c44"))
    c12 = _transverse_entry(values, "c", 2.0) if {"c12", "c66"} & values.keys() else np.nan
    return transverse(values["c11"], c12, values["c13"], values["c33"], values["c44"], stiffness=True)


def _transverse_entry(values: Mapping[str, float], letter: str, factor: float) -> float:
    """Entry 12 as stated or as entry 11 minus a factor times entry 66, which must agree."""
    stated, shear = values.get(f"{letter}12"), values.get(f"{letter}66")
    if shear is None or f"{letter}11" not in values:
        if stated is None:
            raise ValueError(f"{letter}12: missing; needed beside {letter}11 (or {letter}66)")
        return stated
    derived = values[f"{letter}11"] - factor * shear
    if stated is not None and abs(derived - stated) > 0.05 * abs(values[f"{letter}11"]):
        raise ValueError(
            f"{letter}66 = {shear:g}: with {letter}11 it makes {letter}12 = {derived:.4g}, and "
            f"{letter}12 = {stated:g}; the plane across the poling axis must be isotropic"
        )
    return derived if stated is None else stated


def transverse(a11: float, a12: float, a13: float, a33: float, a44: float, *, stiffness: bool = False) -> Array:
    """Stiffness or compliance matrix of a transversely isotropic body; (6, 6)."""
    a66 = (a11 - a12) / 2 if stiffness else 2 * (a11 - a12)
    matrix = np.diag([a11, a11, a33, a44, a44, a66])
    matrix[0, 1] = matrix[1, 0] = a12
    matrix[0, 2] = matrix[2, 0] = matrix[1, 2] = matrix[2, 1] = a13
    return matrix


def piezo(a31: float, a33: float, a15: float) -> Array:
    """Piezoelectric matrix of a transversely isotropic body; (3, 6)."""
    matrix = np.zeros((3, 6))
    matrix[2, :3], matrix[0, 4], matrix[1, 3] = (a31, a31, a33), a15, a15
    return matrix


def _coupling(values: Mapping[str, float], c: Array, free: Mapping[str, float]) -> Array:
    """Piezoelectric stress constants from e, from d, or from coupling factors; (3, 6) [C/m2]."""
    if any(name in values for name in ("e31", "e33", "e15")):
        return piezo(*(values.get(name, 0.0) for name in ("e31", "e33", "e15")))
    compliance = {"31": (0, "33", -1.0), "33": (2, "33", 1.0), "15": (3, "11", 1.0)}
    d: dict[str, float] = {}
    known = bool(np.isfinite(c).all())
    s = np.linalg.inv(c) if known else None
    for axes, (row, axis, sign) in compliance.items():
        charge, factor = values.get(f"d{axes}"), values.get(f"k{axes}")
        if factor is not None:
            if not 0 <= factor < 1:
                raise ValueError(f"k{axes}: {factor:g} is not within 0 <= k < 1")
            if s is None or np.isnan(free[axis]):
                raise ValueError(f"k{axes}: needs c12 (or s12) and eps_r{axis} beside it")
            implied = factor * float(np.sqrt(s[row, row] * free[axis]))
            if charge is None:
                charge = sign * implied
            elif abs(abs(charge) - implied) > _DIFFERENT * implied:
                raise ValueError(
                    f"k{axes} = {factor:g} means |d{axes}| = {implied:.4g} C/N, and d{axes} = {charge:g} C/N; "
                    "one of them, the compliance or the permittivity is wrong"
                )
        if charge is not None:
            d[axes] = charge
    if not d:
        return np.zeros((3, 6))
    if not known:
        raise ValueError("c12: missing; charge constants d need it (or s12) beside the stiffness")
    if not d.keys() >= {"31", "33"}:
        missing = ({"31", "33"} - d.keys()).pop()
        raise ValueError(f"d{missing}: missing; needed beside the other charge constants")
    return np.asarray(piezo(*(d.get(axes, 0.0) for axes in ("31", "33", "15"))) @ c)


def _all_of(values: Mapping[str, float], names: tuple[str, ...]) -> None:
    """Refuse a form without one of its entries."""
    if missing := [name for name in names if name not in values]:
        raise ValueError(f"{missing[0]}: missing; needed are {', '.join(names)}")


def _entries_of_matrices(mapping: Mapping[str, object], values: Mapping[str, float]) -> dict[str, float]:
    """Return the single constants of the matrices ``c``, ``s``, ``e``, ``d`` and ``eps``, or refuse their symmetry."""
    order = mapping.get("order", "IEEE")
    if not (isinstance(order, str) and order.lower() in ("ieee", "abaqus")):
        raise ValueError(f"order: {order!r} must be IEEE (11 22 33 23 13 12) or Abaqus (11 22 33 12 13 23)")
    columns = _ABAQUS if order.lower() == "abaqus" else list(range(6))
    entries: dict[str, float] = {}
    for name in (name for name in MATRICES if name in mapping):
        matrix = _matrix(name, mapping[name])
        if name in "cs":
            matrix = matrix[np.ix_(columns, columns)]
        elif name in "ed":
            matrix = matrix[:, columns]
        singles = _singles(name, matrix)
        _check_symmetry(name, matrix, singles, columns)
        if double := sorted(singles.keys() & values.keys()):
            raise ValueError(f"{name} and {double[0]}: two forms of the same constants; keep one")
        entries |= singles
    return entries


def _matrix(name: str, value: object) -> Array:
    """Return a matrix in SI from rows of numbers or texts with units, or ``{unit: GPa, rows: [...]}``."""
    shape, unit = MATRICES[name]
    scale = 1.0
    if isinstance(value, Mapping):
        if value.keys() != {"unit", "rows"}:
            raise ValueError(f"{name}: a matrix with a unit is written {{unit: ..., rows: [...]}}")
        try:
            scale = in_si(f"1 {value['unit']}", unit)
        except ValueError as error:
            raise ValueError(f"{name}: unit: {error}") from None
        value = value["rows"]
    if name == "eps" and isinstance(value, list | tuple) and len(value) == 3 and not any(map(_is_row, value)):
        value = [[value[k] if k == j else 0.0 for j in range(3)] for k in range(3)]  # the diagonal alone
    rows = [list(row) if _is_row(row) else [] for row in value] if isinstance(value, list | tuple) else []
    sizes = {(len(rows), len(row)) for row in rows}
    if sizes not in ({shape}, {shape[::-1]}):
        raise ValueError(f"{name}: needs {shape[0]} rows of {shape[1]} numbers [{unit}]")
    matrix = np.empty((len(rows), len(rows[0])))
    for i, row in enumerate(rows):
        for j, cell in enumerate(row):
            try:
                matrix[i, j] = in_si(cell, unit) if isinstance(cell, str) else scale * _cell(cell)
            except ValueError as error:
                raise ValueError(f"{name}, row {i + 1}, column {j + 1}: {error}") from None
    return matrix if matrix.shape == shape else matrix.T  # 6 x 3


def _is_row(row: object) -> bool:
    return isinstance(row, list | tuple)


def _cell(cell: object, unit: str = "") -> float:
    if not is_finite(cell):
        raise ValueError(f"{'empty' if cell is None else repr(cell)} is not a finite number{unit}")
    return float(cell)


def _check_symmetry(name: str, matrix: Array, singles: Mapping[str, float], columns: list[int]) -> None:
    """Refuse a matrix without isotropy about axis 3, by the entry that differs most."""
    values = list(singles.values())
    if name in "cs":
        symmetric = transverse(*values, stiffness=name == "c")
    elif name == "eps":
        symmetric = np.diag([values[0], values[0], values[1]])
    else:
        symmetric = piezo(*values)
    largest = np.max(np.abs(symmetric))
    allowed = _ROUNDED * np.abs(symmetric) + _FLOOR * largest
    if name in "cs":
        allowed[5, 5] = _DEPENDENT * largest
    excess = np.abs(matrix - symmetric) - allowed
    if np.max(excess) > 0:
        row, column = np.unravel_index(np.argmax(excess), matrix.shape)
        stated = np.argsort(columns)  # index in the user's order
        stated_row = stated[row] if name in "cs" else row
        stated_column = column if name == "eps" else stated[column]
        raise ValueError(
            f"{name}, row {stated_row + 1}, column {stated_column + 1}: {matrix[row, column]:g} "
            "where a body that is isotropic about axis 3 has "
            f"{symmetric[row, column]:.4g} (`order: IEEE` or `order: Abaqus` says how shears are counted)"
        )
