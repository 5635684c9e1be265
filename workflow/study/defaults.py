"""Defaults of a study, without solving: points rest, a device is pressed by steel, films and devices are in air."""

from solver.body import airless, kind_of
from solver.names import AIR, ALL_PEAKS, ALL_QUANTITIES, BODY, CHOICES, LIMITED, OF_A_PUNCH, POINT_SLIDING, PROFILES
from workflow.language.constants import plain
from workflow.language.given import number
from workflow.study.contents import Contents
from workflow.study.solvable import check_fields, check_groups, hanging_on_datum

_FEEDBACK = ("feedback_capacitance", "feedback_resistance")
_INSULATED = CHOICES["surroundings"][0]
_PUNCH = "steel"
_STRENGTHS = ("tensile_strength", "yield_strength", "depoling_stress")
#: Capacitances by which a device is read without and with air: a study that learns the former alone is without air.
_READ = {"capacitance_per_length": "capacitance_at_load", "capacitance": "capacitance_at_force"}


def settle(study: Contents) -> None:
    """Complete a study by its defaults; `Contents.defaults` reports punch and surroundings."""
    rest(study)
    press(study)
    surround(study)
    discharge(study)
    remark(study)


def rest(study: Contents) -> None:
    """Give a study of points that asks for ``trailing_tension``, say, and names no friction, ``friction: 0``."""
    if study.kind.contact != "point" or "friction" in _named(study):
        return
    try:
        wanted = _asked(study)
    except ValueError:  # which the target's own check tells
        return
    if not POINT_SLIDING.keys().isdisjoint(wanted):
        study.fixed["friction"] = 0.0


def press(study: Contents) -> None:
    """Give a study with a device that names no punch one of steel, or leave it rigid where its groups need that."""
    if study.device is None or not _named(study).isdisjoint(OF_A_PUNCH):
        return
    study.fixed["punch"] = _PUNCH
    line = f"punch: {_PUNCH}, the default of a study with a device (fixed: {{punch: rigid}} for a rigid one)"
    try:
        hanging_on_datum(study)
    except ValueError:  # its groups do not decide its quantities under an elastic punch
        del study.fixed["punch"]
        line = f"punch: rigid, since its groups do not tell what one of {_PUNCH} makes of its surrogate.outputs"
    study.tell_default(line)


def surround(study: Contents) -> None:
    """Give a study on films, or with a device, the surroundings that it does not name: air, or insulated if need be."""
    around = study.kind.layered or study.kind.space
    if "surroundings" in _named(study) or not (study.device or (study.factors and around)):
        return
    _set_surroundings(study, AIR)
    line = "surroundings: air, the default of films and devices (fixed: {surroundings: insulated} leaves it out)"
    if study.kind.space:
        line = "surroundings: air, the default of contacts in space"
    elif lacking := _lacking(study):
        _set_surroundings(study, _INSULATED)
        line = f"surroundings: insulated, since {lacking}"
    study.tell_default(line)


def remark(study: Contents) -> None:
    """Report limits that compare a strength with a stress that the strength does not bound."""
    for key, target in study.design.items():
        try:
            limits = [limit for limit in target.limits if plain(limit.allowable) in _STRENGTHS]
        except ValueError:  # which the target's own check reports
            continue
        for limit in limits:
            known = study.kind.every_quantity.keys() | ALL_PEAKS
            bounded = [name for name in LIMITED[plain(limit.allowable)] if name in known]
            if {plain(name) for name in limit.expression.names()}.isdisjoint(bounded):
                study.tell_default(
                    f"design.{key}: {limit.allowable} is a limit of {' or '.join(bounded)}, "
                    f"and here bounds {limit.inner} as written"
                )


def discharge(study: Contents) -> None:
    """Fix the feedback of a device, in which charge decays, in a study of the heat of a touch."""
    amplifier = study.device.amplifier if study.device else None
    if amplifier is None or "touch_temperature" not in _named(study):
        return
    for name in _FEEDBACK:
        written = getattr(amplifier, name)
        if written is None:
            continue
        value = number(name, written)
        if name in study.factors or study.fixed.get(name, value) != value:
            part = "factors" if name in study.factors else "fixed"
            raise ValueError(f"device: amplifier: {name}: {written} is beside one of the {part}; give one of them")
        study.fixed[name] = value


def _named(study: Contents) -> set[str]:
    """Return the factors that a study names, with one value or several."""
    return {*study.fixed, *study.categories, *study.factors}


def _asked(study: Contents) -> list[str]:
    """Return the names in targets, outputs and read-outs; ValueError for a target that is no expression."""
    wanted = [name for target in study.design.values() for name in target.names()]
    measured = (name for readout in study.readout.values() for name in readout.measured)
    return [*wanted, *study.surrogate.outputs, *measured]


def _lacking(study: Contents) -> str:
    """Return the reason for which a study cannot be in air; empty where it can."""
    profiles = [PROFILES[name] for name in study.names("profile", CHOICES["profile"][0]) if name in PROFILES]
    if len({profile.contact for profile in profiles}) != 1:
        return "its punches are of more than one kind"
    factors: dict[str, object] = {**dict.fromkeys(study.factors), **study.fixed}
    reasons = (airless({**factors, **combination}) for combination in study.combinations)
    return next(filter(None, reasons), "") or _lacking_in_air(study)


def _lacking_in_air(study: Contents) -> str:
    """Return what the study asks for that contacts in air lack; empty where they lack nothing."""
    profile = study.names("profile", CHOICES["profile"][0])[0]
    in_air = kind_of({*study.factors, *study.fixed, *([BODY] if study.body else [])}, profile, AIR)
    try:
        wanted = _asked(study)
        if "positions" in study.dataset.model_fields_set or study.dataset.peaks:
            return "dataset: positions or peaks ask for fields, which take 50 ms a case in air, or seconds"
        check_fields(study)
        check_groups(study)
    except ValueError as error:
        return str(error)
    if study.device is not None:
        wanted += [_READ[name] for name in study.surrogate.outputs if name in _READ]
    for name in wanted:
        if name in {*ALL_QUANTITIES, *ALL_PEAKS} - {*in_air.quantities, *in_air.peaks}:
            return f"contacts in air have no {name}, which it asks for"
        if study.surrogate.outputs and name in ALL_QUANTITIES and name not in study.surrogate.outputs:
            return f"{name}, by which a device in air is read, is not one of surrogate.outputs"
    return ""


def _set_surroundings(study: Contents, name: str) -> None:
    study.fixed["surroundings"] = name
    for target in study.design.values():
        target.set_meeting(study.meeting)
