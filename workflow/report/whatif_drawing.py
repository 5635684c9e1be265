"""Data of the panel's drawing: the punch on its body, and the fields under it."""

from typing import Any

from solver.fields import FIELDS
from solver.names import FACTORS, PROFILES
from surrogate import GaussianProcess
from surrogate.use.export import exported
from workflow.language.titles import title
from workflow.report import firstscreen
from workflow.study import coupling
from workflow.study.categories import Combination
from workflow.study.datum import inner
from workflow.study.model import Study

#: Quantities that give the contact pressure of a circular punch in closed form.
_PRESSURE = {"contact_trailing", "contact_leading", "pressure_exponent", "peak_pressure"}
#: What the means of a surrogate need; the rest is for intervals.
_OF_MEANS = ("inputs", "axes", "groups", "outputs", "order", "cores", "factors", "offset", "scale", "correction")


def drawable(study: Study) -> bool:
    """Return whether the panel knows the contact that its drawing shows."""
    return set(study.outputs) >= set(study.kind.ends)


def closed_pressure(study: Study, combination: Combination) -> bool:
    """Return whether the contact pressure of a combination of categories has a closed form."""
    profile = {**study.fixed, **combination}.get("profile", "cylinder")
    return set(study.outputs) >= _PRESSURE and profile == "cylinder" and not study.kind.tabled


def body(study: Study, combination: Combination) -> dict[str, Any]:
    """The punch and its body in a combination of the categories, as :class:`workflow.report.device.Device` has them.

    ``size`` and ``thickness`` are numbers, or names of the factors that give them.
    """
    case = {**study.fixed, **combination, **inner(study)}
    drawn = firstscreen.of_case(study, case, dict.fromkeys(study.kind.ends, 1.0))
    size, pressing = PROFILES[drawn.profile].needs[-1], study.kind.loads.force
    thickness: float | str | None = drawn.thickness
    if study.body:
        thickness = study.body[0].numbers["thickness"]
    elif "thickness" in study.factors:
        thickness = "thickness"
    below = {number for layer in study.body[1:] for number in layer.numbers.values()} | {"base_modulus"}
    return {
        "profile": drawn.profile,
        "corner": drawn.corner,
        "size": size if size in study.factors else drawn.size,
        "conducts": drawn.conducts,
        "thickness": thickness,
        "base": drawn.base if below.isdisjoint(study.factors) else "",  # words of what a slider moves would not follow
        "grounded": drawn.grounded,
        "exponent": "exponent" if "exponent" in study.factors else drawn.exponent,
        "slides": "friction" if "friction" in study.factors else float(drawn.slides),
        "point": drawn.point,
        "pressing": pressing,
        "units": FACTORS[pressing].units,
        "ends": study.kind.ends,
    }


def fields(study: Study, model: GaussianProcess | None) -> dict[str, Any]:
    """The charts under the punch, and the surrogate that feeds them where there is one in plain data.

    Without one, circular punches on half-planes have their pressure in closed form.
    """
    known = model is not None and not study.categories and "pressure_exponent" in study.outputs
    stored = exported(model) if known and model is not None else None
    pressure = any(closed_pressure(study, combination) for combination in study.combinations)
    names = ["contact_pressure"] if pressure else []
    if stored:
        names = [str(output["name"]) for output in stored["outputs"]]
    fields_of_study = coupling.fields(study)
    names = [name for name in names if coupling.fields_of(FIELDS[name].units) <= fields_of_study]
    return {
        "charts": [{"name": name, "title": title(name), "units": FIELDS[name].units} for name in names],
        "fields": None if stored is None else {key: stored[key] for key in _OF_MEANS if key in stored},
    }
