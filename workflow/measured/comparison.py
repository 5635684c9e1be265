"""Published measurements beside the model: the verdict on each row, and the table and words of all rows."""

import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import hypot
from typing import Any, Literal

import numpy as np
import xarray as xr

import solver
from solver import Material
from solver.names import COMPOSITES
from solver.units import prefixed
from storage.described import described
from workflow.language.numbers import number
from workflow.study.reading import located
from workflow.study.sections import UNITS, Measurement, ModelQuantity, ModelValue

Case = Mapping[str, float | str]
_ROUNDING = 1e-12  # relative difference that is none
_COMPOSITION = {"material", "composite", *COMPOSITES.values()}  # factors that state the material
_FACTOR = 10.0  # of the force, and of the charge per force, by which responses are compared


@dataclass(frozen=True)
class Spread:
    """A value of the model, and its change by other published constants of the material."""

    value: float  # by the library's constants, SI
    deviation: float  # largest difference by an alternative set of constants, taken as a standard deviation
    sets: int  # number of alternative sets


def modelled(entry: ModelValue) -> Spread:
    """Return the model's value and its spread over the material's published alternatives."""
    material, answer = entry.material, _ANSWERS[entry.quantity]
    case = {name: value for name, value in entry.case.items() if name not in _COMPOSITION}
    try:
        nominal, *others = (answer(variant, case) for variant in (material, *material.variants()))
    except KeyError:  # of an insulating punch, or of a line where the rule is one of points
        raise ValueError(f"model: {entry.quantity}: not a quantity of this case") from None
    moved = max((abs(other - nominal) for other in others), default=0.0)
    return Spread(nominal, moved if moved > _ROUNDING * abs(nominal) else 0.0, len(others))


def _solved(material: Material, case: Case, **changed: float) -> xr.Dataset:
    return solver.solve({**case, **changed, "material": material})


def _charge_per_force(material: Material, case: Case) -> float:
    """Charge under a punch at zero volts over its force (real contacts, section 3: r_1 of a half-space)."""
    return abs(float(_solved(material, case)["charge_per_force"]))


def _pad_stroke_per_volt(material: Material, case: Case) -> float:
    """Stroke at the middle of a driven pad, by reciprocity its charge per force; positive as on a rigid base."""
    return -float(np.sign(material.e33)) * float(_solved(material, case)["patch_charge_per_force"])


def _clamped_d33(material: Material, _: Case) -> float:
    """e33 / c33: full electrodes, no strain along the film."""
    return abs(float(material.e33 / material.c33))


def _free_d33(material: Material, _: Case) -> float:
    """d33 of a body free of stress along the electrodes: e = d c, for e31 and e33."""
    stiffness = [[material.c11 + material.c12, material.c13], [2 * material.c13, material.c33]]
    return abs(float(np.linalg.solve(np.array(stiffness), np.array([material.e31, material.e33]))[1]))


def _indentation_exponent(material: Material, case: Case) -> float:
    """d log P / d log depth, at zero volts where the punch conducts."""
    at_rest = _solved(material, case)
    if "charge_per_force" in at_rest:
        charge = float(at_rest["charge_per_force"]) * float(case["force"])
        at_rest = _solved(material, case, total_charge=charge)
    return float(at_rest["contact_stiffness"] * at_rest["depth"]) / float(case["force"])


def _response_under_load(material: Material, case: Case) -> float:
    """Stroke per volt at ten times the force, over that at the force."""
    forces = (float(case["force"]), _FACTOR * float(case["force"]))
    low, high = (float(_solved(material, case, force=force)["stroke_per_volt"]) for force in forces)
    return high / low


def _stiffness_under_charge(material: Material, case: Case) -> float:
    """Contact stiffness of a charged punch over that of one at zero charge."""
    charge = _FACTOR * _charge_per_force(material, case) * float(case["force"])
    low, high = (float(_solved(material, case, total_charge=total)["contact_stiffness"]) for total in (0.0, charge))
    return high / low


def _layer_factor(material: Material, case: Case) -> float:
    """P (1 - nu) / (4 G a d) of a disc on an isotropic layer (Hayes et al. 1972)."""
    solved = _solved(material, case)
    poisson = float(material.c12 / (material.c11 + material.c12))
    size = 4 * float(material.c44) * float(solved["contact_radius"] * solved["depth"])
    return float(case["force"]) * (1 - poisson) / size


_ANSWERS: dict[ModelQuantity, Callable[[Material, Case], float]] = {
    "charge_per_force": _charge_per_force,
    "clamped_d33": _clamped_d33,
    "free_d33": _free_d33,
    "indentation_exponent": _indentation_exponent,
    "response_under_load": _response_under_load,
    "stiffness_under_charge": _stiffness_under_charge,
    "layer_factor": _layer_factor,
    "pad_stroke_per_volt": _pad_stroke_per_volt,
}


Row = dict[str, Any]
#: Standard deviations up to which a row agrees.
AGREES_WITHIN = 2.0
_SLIGHT = 0.01
_SAME = 1e-6  # relative difference up to which a row without an error says the same as the model

Word = Literal["agrees", "disagrees", "cannot be told", "predicted"]


def compared(measurements: Mapping[str, Measurement]) -> list[Row]:
    """Return the page's content of every row in plain values; lengths and charges are in the row's unit."""
    rows = []
    for label, row in measurements.items():
        with located(f"measurements: {label}"):
            model, rivals = (
                [valued(row, entry, modelled(entry)) for entry in part] for part in (row.model, row.rivals)
            )
        verdict, because = judged(row, model, rivals)
        rows.append(
            {
                "name": label,
                "short": row.short or textwrap.shorten(row.of, 40, placeholder="..."),
                **row.model_dump(
                    include={"of", "value", "error", "error_is", "unit", "note", "source", "read", "decides"}
                ),
                "model": model,
                "rivals": rivals,
                "verdict": verdict,
                "because": because,
            }
        )
    return rows


def valued(row: Measurement, entry: ModelValue, spread: Spread) -> Row:
    """Return a value of the model in the row's unit."""
    scale = UNITS[row.unit]
    value, deviation = spread.value / scale, spread.deviation / scale
    # over the standard deviation of both; None where no value or no error is published
    off = None if row.value is None or row.error is None else (value - row.value) / hypot(row.error, deviation)
    return {
        "quantity": quantity_name(entry),
        "material": _material_name(entry),
        "value": value,
        "deviation": deviation,
        "sets": spread.sets,
        "off": off,
    }


def quantity_name(entry: ModelValue) -> str:
    """Return the quantity in words, with the diameter of its pad."""
    words = entry.quantity.replace("_", " ")
    if "patch_size" not in entry.case:
        return words
    size, units = prefixed(float(entry.case["patch_size"]), "m")
    return f"{words} (pad of {number(float(entry.case['patch_size']) / size)} {units})"


def _material_name(entry: ModelValue) -> str:
    """Return the name of a material, or of an alloy with its composition."""
    if "material" in entry.case:
        return str(entry.case["material"])
    composite = str(entry.case["composite"])
    fraction = COMPOSITES[composite]
    return f"{composite}, {fraction.replace('_', ' ')} {number(float(entry.case[fraction]))}"


def dataset(rows: Sequence[Row]) -> xr.Dataset:
    """Return numbers and verdicts of the rows, SI; NaN without a number, and the first of several model values."""
    scale = np.array([UNITS[row["unit"]] for row in rows])
    first = [row["model"][0] if row["model"] else {} for row in rows]
    numbers = {
        "measured": scale * _column(rows, "value"),
        "measured_std": scale * _column(rows, "error"),
        "model": scale * _column(first, "value"),
        "model_std": scale * _column(first, "deviation"),
        "deviations": _column(first, "off"),
        "verdict": _column(rows, "verdict", object),
    }
    table = xr.Dataset(
        {name: ("row", values) for name, values in numbers.items()},
        {"row": _column(rows, "name", object), "unit": ("row", np.array([_SI[row["unit"]] for row in rows], object))},
    )
    return described(table, "Published measurements beside the model", _SOURCE, _MEANINGS)


def _column(rows: Sequence[Row], key: str, kind: type = float) -> np.ndarray[Any, Any]:
    """Return one entry of every row, (row,); NaN where there is no number."""
    return np.array([row.get(key) for row in rows], dtype=kind)


_SI = {"pC/N": "C N-1", "pm/V": "m V-1", "1": "1"}
_SOURCE = "literature beside meecontact's exact solver"
_MEANINGS = {
    "measured": "measured value, in the unit of its row; NaN of a prediction",
    "measured_std": "its standard deviation; NaN where none is published",
    "model": "value of the model, in the unit of the row",
    "model_std": "largest difference that other published constants make",
    "deviations": "model less measured over the standard deviation of both",
    "verdict": "agrees, disagrees, cannot be told, or predicted",
    "unit": "unit of the row",
}


def judged(row: Measurement, model: Sequence[Row], rivals: Sequence[Row] = ()) -> tuple[Word, str]:
    """Return the verdict on a row in a word, and its reason in a sentence without a full stop."""
    if row.value is None:
        return "predicted", "no measurement is known"
    if row.open:
        return "cannot be told", row.open
    if (off := model[0]["off"]) is not None:
        size = number(abs(off), 2) if abs(off) >= _SLIGHT else f"less than {_SLIGHT}"
        because = f"the model is {size} standard deviations off"
        if abs(off) <= AGREES_WITHIN:
            return "agrees", because + _ruled_out(rivals)
        return "disagrees", because + (f": {row.outside}" if row.outside else "")
    ratio = model[0]["value"] / row.value
    if abs(ratio - 1) <= _SAME:
        return "agrees", "the statement has no error, and the model says exactly the same"
    if row.outside:
        return "disagrees", row.outside
    return "cannot be told", f"no error is published; the model is {number(100 * (ratio - 1), 2)} % off"


def _ruled_out(rivals: Sequence[Row]) -> str:
    """Return the row's verdict on other rules."""
    fits = {rule["quantity"]: abs(rule["off"]) <= AGREES_WITHIN for rule in rivals if rule["off"] is not None}
    return "".join(f"; {name} {'fits too' if fit else 'does not fit'}" for name, fit in fits.items())
