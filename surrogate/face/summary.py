"""What a model says of itself: its inputs and their box, its outputs, its cases and its calibration."""

from collections.abc import Mapping
from html import escape

from surrogate.face.physical import Physical

#: Outputs that a line names; of more it tells how many there are.
NAMED = 12


def text(model: Physical) -> str:
    """Return a few lines: kind and cases, a line an input, outputs, calibration."""
    wide = max(len(own.name) for own in model.inputs_)
    ranges = [f"  {own.name:<{wide}}  {own.range_text()}, {own.scale}" for own in model.inputs_]
    return "\n".join([_head(model), "inputs:", *ranges, f"outputs: {_outputs(model)}", f"intervals: {_held(model)}"])


def page(model: Physical) -> str:
    """Return the same as HTML, the box as a table."""
    import pandas as pd  # notebooks only

    rows = [(own.name, own.low, own.high, own.units, own.scale) for own in model.inputs_]
    box = pd.DataFrame(rows, columns=["input", "low", "high", "unit", "scale"])
    table = box.to_html(index=False, border=0)
    return f"<p><b>{_head(model)}</b>: {escape(_outputs(model))}; intervals {_held(model)}</p>{table}"


def _head(model: Physical) -> str:
    counts = f"{len(model.outputs_)} outputs over {len(model.inputs_)} inputs, trained on {model.cases_:,} cases"
    return f"{type(model).__name__} of {counts}"


def _outputs(model: Physical) -> str:
    named = [_with_unit(name, model.attrs_[name]) for name in model.outputs_[:NAMED]]
    more = len(model.outputs_) - NAMED
    return ", ".join(named) + (f" and {more} more" if more > 0 else "")


def _with_unit(name: str, attrs: Mapping[str, str]) -> str:
    return f"{name} [{attrs['units']}]" if attrs.get("units") else name


def _held(model: Physical) -> str:
    learnt = model.calibration_
    return "not calibrated" if learnt is None else f"calibrated on {learnt.distribution.cases:,} cases"
