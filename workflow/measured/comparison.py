"""All rows of a study beside the model: what is written, drawn and told."""

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from storage.described import described
from workflow.measured.values import Spread, modelled
from workflow.measured.verdict import judged
from workflow.study.measurement import UNITS, Measurement, ModelValue
from workflow.study.reading import InputError

Row = dict[str, Any]


def compared(measurements: Mapping[str, Measurement]) -> list[Row]:
    """Return the page's content of every row in plain values; lengths and charges are in the row's unit."""
    return [_row(label, measurement) for label, measurement in measurements.items()]


def _row(label: str, row: Measurement) -> Row:
    try:
        model, rivals = ([modelled(entry) for entry in group] for group in (row.model, row.rivals))
    except ValueError as error:
        raise InputError(f"measurements: {label}: {error}") from None
    verdict = judged(row, model, rivals)
    return {
        "name": label,
        "short": row.short or textwrap.shorten(row.of, 40, placeholder="..."),
        **row.model_dump(include={"of", "value", "error", "error_is", "unit", "note", "source", "read", "decides"}),
        "model": _values(row, row.model, model, verdict.deviations),
        "rivals": _values(row, row.rivals, rivals, verdict.rivals),
        "verdict": verdict.word,
        "because": verdict.because,
    }


def _values(
    row: Measurement, models: Sequence[ModelValue], values: Sequence[Spread], off: Sequence[float | None]
) -> list[Row]:
    scale = UNITS[row.unit]
    return [
        {
            "quantity": row.quantity,
            "material": row.case["material"],
            "value": value.value / scale,
            "deviation": value.deviation / scale,
            "sets": value.sets,
            "off": deviations,
        }
        for row, value, deviations in zip(models, values, off, strict=True)
    ]


def dataset(rows: Sequence[Row]) -> xr.Dataset:
    """Numbers and verdicts of the rows, SI; NaN where a row has none, of several values of the model the first."""
    scale = np.array([UNITS[row["unit"]] for row in rows])
    first = [row["model"][0] if row["model"] else {} for row in rows]
    numbers = {
        "measured": scale * _numbers(row["value"] for row in rows),
        "measured_std": scale * _numbers(row["error"] for row in rows),
        "model": scale * _numbers(row.get("value") for row in first),
        "model_std": scale * _numbers(row.get("deviation") for row in first),
        "deviations": _numbers(row.get("off") for row in first),
    }
    table = xr.Dataset(
        {name: ("row", values) for name, values in numbers.items()}
        | {"verdict": ("row", np.array([row["verdict"] for row in rows], dtype=object))},
        {"row": np.array([row["name"] for row in rows], dtype=object),
         "unit": ("row", np.array([_SI[row["unit"]] for row in rows], dtype=object))},
    )  # fmt: skip
    return described(table, "Published measurements beside the model", _SOURCE, _MEANINGS)


def _numbers(values: Any) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


_SI = {"pC/N": "C N-1", "pm/V": "m V-1", "1": "1"}
_SOURCE = "literature beside meecontact's exact solver"
_MEANINGS = {
    "measured": "measured value, in the unit of its row",
    "measured_std": "its standard deviation; NaN where none is published",
    "model": "value of the model, in the unit of the row",
    "model_std": "largest difference that other published constants make",
    "deviations": "model less measured over the standard deviation of both",
    "verdict": "agrees, disagrees, or cannot be told",
    "unit": "unit of the row",
}
