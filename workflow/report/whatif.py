"""What the what-if panel (whatif.html.j2) needs: the surrogate as plain data, ranges, and the designs with limits."""

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from markupsafe import Markup
from scipy.stats import qmc

from solver.names import ALL_QUANTITIES
from surrogate import GaussianProcess
from surrogate.gp.export import exported
from workflow.dataset import factorial
from workflow.design import answers, assessment, scenarios
from workflow.design.sources import Predicted
from workflow.language.expressions import Call, Expression, Name, Number, Operation, Power
from workflow.language.factors import FACTORS
from workflow.language.numbers import shown
from workflow.language.titles import title
from workflow.study.categories import Kinds, output
from workflow.study.datum import HANGING, meaning
from workflow.study.model import Study
from workflow.study.target import Target

#: Points of the box that tell the ranges of a surrogate in groups.
_POINTS = 4096
#: Quantities that give the contact pressure of a circular punch in closed form.
_PRESSURE = {"contact_trailing", "contact_leading", "pressure_exponent", "peak_pressure"}


def content(
    study: Study,
    model: GaussianProcess,
    quantities: xr.Dataset,
    designs: Sequence[xr.Dataset],
    hangs: frozenset[str] = HANGING,
) -> dict[str, Any] | None:
    """The panel's data; None where the browser cannot evaluate the surrogate.

    Parameters
    ----------
    study, model, quantities
        The study, its surrogate, and its factorial (for the ranges).
    designs
        Answers of the study's targets, in its order, offered as starting points.
    hangs
        Quantities that hang on the datum.
    """
    stored = exported(model)
    if stored is None:
        return None
    values = [{name: float(one["worst"].sel(factor=name)[0]) for name in model.box} for one in designs]
    kinds = [study.combinations.index({name: kind for name, kind, _ in answers.kinds(one)}) for one in designs]
    start = values[0] if values else {}
    return {
        "surrogate": stored,
        "quantities": [
            {"name": name, **ALL_QUANTITIES[name].attrs, "long_name": meaning(name, hangs), "title": title(name)}
            for name in study.outputs
        ],
        "categories": study.categories,
        "kinds": [_kind(study, model, kind) for kind in study.combinations],
        "ranges": _ranges(study, model, factorial.learned(study, quantities)),
        "fixed": {name: factor.default for name, factor in FACTORS.items() if factor.default is not None}
        | {name: value for name, value in study.fixed.items() if not isinstance(value, str)},
        "cases": [
            {"values": case, "kind": kind, **_target(name, target, one)}
            for (name, target), one, case, kind in zip(study.design.items(), designs, values, kinds, strict=True)
        ],
        "kind": kinds[0] if kinds else 0,
        "start": [
            float(np.clip(one.to_unit(start[name]), -1, 1)) if name in start else 0.1 for name, one in model.box.items()
        ],
    }


def _ranges(study: Study, model: GaussianProcess, learned: xr.Dataset) -> list[list[float]]:
    """Ends of every output over the box: of its factorial, or of the surrogate, where that is in groups."""
    if study.groups:
        t = 2 * qmc.Sobol(len(model.box), rng=0).random(_POINTS) - 1
        X = np.stack([one.from_unit(row) for one, row in zip(model.box.values(), t.T, strict=True)], axis=1)
        return [[float(row.min()), float(row.max())] for row in model.predict_array(X).T]
    return [[float(learned[name].min()), float(learned[name].max())] for name in model.outputs_]


def _kind(study: Study, model: GaussianProcess, kinds: Kinds) -> dict[str, Any]:
    """One combination of the categories: the surrogate's columns for it, and whether it shows a pressure."""
    profile = {**study.fixed, **kinds}.get("profile", "cylinder")
    return {
        "names": kinds,
        "allowances": assessment.allowances(study, Predicted(model, kinds), study.outputs),
        "columns": [model.outputs_.index(output(name, kinds)) for name in study.outputs],
        "pressure": set(study.outputs) >= _PRESSURE and profile == "cylinder" and not study.on_film,
    }


def as_json(data: dict[str, Any] | None) -> Markup:
    """JSON that may stand inside a script element."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return Markup(text.replace("<", "\\u003c").replace("&", "\\u0026"))


def _target(name: str, target: Target, answer: xr.Dataset) -> dict[str, Any]:
    """A target's limits with the verdict on its design, and the scenarios that they must stand anywhere else.

    What a limit counts as over distributions, and a deviation, are not judged elsewhere: no one point tells them.
    """
    corners = scenarios.corners(target, scenarios.SEARCHED)
    limits = []
    for limit in target.limits:
        one = answer.sel(term=str(limit))
        exact = float(one["exact"])
        limits.append(
            {
                "text": str(limit),
                "tree": _tree(limit.expression),
                "value": limit.value,
                "upper": limit.upper,
                "units": str(one["units"].values),
                "judged": limit.probability is None and not limit.deviation,
                "exact": exact if np.isfinite(exact) else None,
                "held": bool(one["margin"] >= -assessment.ROUNDING),
            }
        )
    ranges = target.worst_case | {factor: list(one.support) for factor, one in target.uncertain.items()}
    over = [
        f"{factor.replace('_', ' ')} {' to '.join(shown(end, FACTORS[factor].units, 4) for end in ends)}"
        for factor, ends in ranges.items()
    ]
    return {
        "name": name,
        "limits": limits,
        "over": " and ".join(over),
        "scenarios": {factor: values.tolist() for factor, values in corners.values.items()},
        "count": corners.count,
    }


def _tree(node: Expression) -> Any:
    """An expression as nested lists."""
    if isinstance(node, Number):
        return node.value
    if isinstance(node, Name):
        return node.name
    if isinstance(node, Operation):
        return [node.symbol, _tree(node.left), _tree(node.right)]
    if isinstance(node, Power):
        return ["^", _tree(node.base), node.exponent]
    if isinstance(node, Call):
        return [node.function, *map(_tree, node.arguments)]
    raise TypeError(f"unknown node {node!r}")
