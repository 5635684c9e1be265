"""What is beside the contacts of a study on films, or with a device, that does not say: air, where it can be."""

from solver.body import airless, kind_of
from solver.names import AIR, ALL_PEAKS, ALL_QUANTITIES, BODY, CHOICES, PROFILES
from workflow.study.atrest import asked
from workflow.study.contents import Contents
from workflow.study.solvable import check_fields, check_groups

_INSULATED = CHOICES["surroundings"][0]
#: What a device is read by without and with air: a study that learns the former alone was written for the former.
_READ = {"capacitance": "capacitance_at_load", "contact_capacitance": "contact_capacitance_at_force"}


def settle(study: Contents) -> None:
    """Give a study on films, or with a device, the surroundings that it does not name: air, or insulated if `_lacking`.

    Reads, beside no other contact than the study's, what its sections say alone: nothing is solved.
    """
    named = "surroundings" in {*study.fixed, *study.categories, *study.factors}
    if named or not (study.device or (study.factors and study.kind.layered)):
        return
    _place(study, AIR)
    study._why_insulated = _lacking(study)
    if study._why_insulated:
        _place(study, _INSULATED)
    study._settled = True


def told(study: Contents) -> str:
    """What was chosen, in a line; empty where the study said it itself or has neither film nor device."""
    if not study._settled:
        return ""
    if study._why_insulated:
        return f"surroundings: insulated, since {study._why_insulated}"
    return "surroundings: air, the default of films and devices (fixed: {surroundings: insulated} leaves it out)"


def _lacking(study: Contents) -> str:
    """Why a study, which is to be in air, cannot be; empty where it can."""
    profiles = _names(study, "profile")
    known = [PROFILES[name] for name in profiles if name in PROFILES]
    if len({kind.contact for kind in known}) != 1:
        return "its punches are of more than one kind"
    factors: dict[str, object] = {**dict.fromkeys(study.factors), **study.fixed}
    found = (airless({**factors, **kinds}) for kinds in study.combinations)
    return next(filter(None, found), "") or _asks_for_more(study)


def _asks_for_more(study: Contents) -> str:
    """Which of what a study asks for contacts in air do not have; empty of none."""
    has = kind_of({*study.factors, *study.fixed, *([BODY] if study.body else [])}, _names(study, "profile")[0], AIR)
    try:
        wanted = asked(study)
        if "positions" in study.dataset.model_fields_set or study.dataset.peaks:
            return "dataset: positions or peaks ask for fields, which take 50 ms a case in air, or seconds"
        check_fields(study)
        check_groups(study)
    except ValueError as error:
        return str(error)
    if study.device is not None:
        wanted += [_READ[name] for name in study.surrogate.outputs if name in _READ]
    for name in wanted:
        if name in {*ALL_QUANTITIES, *ALL_PEAKS} - {*has.quantities, *has.peaks}:
            return f"contacts in air have no {name}, which it asks for"
        if study.surrogate.outputs and name in ALL_QUANTITIES and name not in study.surrogate.outputs:
            return f"{name}, by which a device in air is read, is not one of surrogate.outputs"
    return ""


def _names(study: Contents, factor: str) -> list[str]:
    return study.categories.get(factor) or [str(study.fixed.get(factor, CHOICES[factor][0]))]


def _place(study: Contents, name: str) -> None:
    study.fixed["surroundings"] = name
    for target in study.design.values():
        target.meets(study.meeting)
